//! Runs of campaigns as a table.

use std::collections::HashMap;
use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

use arrow_array::builder::{BooleanBuilder, Float64Builder, Int64Builder, ListBuilder, StringBuilder};
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type, UInt64Type};
use arrow_array::{Array, ArrayRef, RecordBatch, UInt64Array, new_null_array};
use arrow_ipc::reader::StreamReader;
use arrow_ipc::writer::StreamWriter;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use arrow_select::concat::concat_batches;
use arrow_select::take::take_record_batch;
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use plant::{Campaign, CampaignRun, ValueForm, number_of};
use serde_json::{Map, Value, json};

use super::batch::{FORM, PLANT};

/// What a field is, in its metadata.
const KIND: &str = "kind";
const VARIABLE: &str = "variable";
const MEASURE: &str = "measure";

/// A run with what was measured of it.
#[derive(Debug, Clone)]
pub struct MeasuredRun {
    /// The run.
    pub run: CampaignRun,
    /// Numbers that the caller made of it, by name, beside those of the campaign.
    pub measures: Vec<(String, f64)>,
    /// Seconds of a computer that it took.
    pub wall: f64,
}

/// Runs in columns: `seed`, one for each value that varied (by its path, with its `unit`), `passed`, `failed` (names of the
/// expectations that failed), the measures, `digest`, `wall`, and `results`, a JSON list of the expectations that failed.
#[derive(Debug, Clone)]
pub struct Runs(RecordBatch);

/// Collects the values of a variable.
enum Values {
    Flag(BooleanBuilder),
    Integer(Int64Builder),
    Number(Float64Builder),
    Text(StringBuilder),
}

impl Values {
    fn new(form: &ValueForm) -> Self {
        match form {
            ValueForm::Flag => Self::Flag(BooleanBuilder::new()),
            ValueForm::Integer => Self::Integer(Int64Builder::new()),
            ValueForm::Number(_) => Self::Number(Float64Builder::new()),
            ValueForm::Text => Self::Text(StringBuilder::new()),
        }
    }

    fn push(&mut self, value: Option<&toml::Value>) {
        match self {
            Self::Flag(builder) => builder.append_option(value.and_then(toml::Value::as_bool)),
            Self::Integer(builder) => builder.append_option(value.and_then(toml::Value::as_integer)),
            Self::Number(builder) => {
                builder.append_option(value.and_then(number_of).map(|(number, _)| number))
            }
            Self::Text(builder) => builder.append_option(value.map(|value| match value {
                toml::Value::String(text) => text.clone(),
                other => other.to_string(),
            })),
        }
    }

    fn finish(self) -> ArrayRef {
        match self {
            Self::Flag(mut builder) => Arc::new(builder.finish()),
            Self::Integer(mut builder) => Arc::new(builder.finish()),
            Self::Number(mut builder) => Arc::new(builder.finish()),
            Self::Text(mut builder) => Arc::new(builder.finish()),
        }
    }
}

fn field(name: &str, array: &ArrayRef, facts: &[(&str, &str)]) -> Field {
    let facts = facts.iter().filter(|(_, text)| !text.is_empty());
    let facts = facts.map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
    Field::new(name, array.data_type().clone(), true).with_metadata(facts.collect::<HashMap<_, _>>())
}

impl Runs {
    /// Returns runs of one campaign as columns. The types of the variables are those of the campaign, so that the columns of two
    /// parts of it fit together.
    ///
    /// # Errors
    /// When two columns have the same name.
    pub fn new(campaign: &Campaign, runs: &[MeasuredRun]) -> Result<Self, ArrowError> {
        let mut columns: Vec<(Field, ArrayRef)> = Vec::new();
        let mut add = |name: &str, array: ArrayRef, facts: &[(&str, &str)]| {
            columns.push((field(name, &array, facts), array));
        };
        let seeds = runs.iter().map(|one| one.run.seed);
        add("seed", Arc::new(UInt64Array::from_iter_values(seeds)), &[]);
        for (path, how) in campaign.varied() {
            let form = how.form();
            let mut values = Values::new(&form);
            for one in runs {
                let found = one.run.variables.iter().find(|(name, _)| name == path);
                values.push(found.map(|(_, value)| value));
            }
            let unit = if let ValueForm::Number(unit) = &form {
                unit
            } else {
                ""
            };
            add(path, values.finish(), &[(KIND, VARIABLE), ("unit", unit)]);
        }
        let (mut passed, mut failed) = (BooleanBuilder::new(), ListBuilder::new(StringBuilder::new()));
        let (mut digests, mut results) = (StringBuilder::new(), StringBuilder::new());
        for MeasuredRun { run, .. } in runs {
            let lost: Vec<_> = run.results.iter().filter(|result| !result.is_met()).collect();
            passed.append_value(lost.is_empty());
            failed.append_value(lost.iter().map(|result| Some(&result.name)));
            digests.append_value(&run.digest);
            results.append_option((!lost.is_empty()).then(|| json!(lost).to_string()));
        }
        add("passed", Arc::new(passed.finish()), &[]);
        add("failed", Arc::new(failed.finish()), &[]);
        for (place, (name, measure)) in campaign.measured().enumerate() {
            let mut values = Float64Builder::new();
            for one in runs {
                let found = one.run.measures.get(place);
                values.append_option(found.and_then(|(_, number)| *number));
            }
            let facts = [(KIND, MEASURE), ("unit", measure.unit())];
            add(name, Arc::new(values.finish()), &facts);
        }
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in runs.iter().flat_map(|one| &one.measures) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        for name in names {
            let mut values = Float64Builder::new();
            for one in runs {
                let found = one.measures.iter().find(|(other, _)| other == name);
                values.append_option(found.map(|(_, number)| *number));
            }
            add(name, Arc::new(values.finish()), &[(KIND, MEASURE)]);
        }
        let wall = arrow_array::Float64Array::from_iter_values(runs.iter().map(|one| one.wall));
        add("digest", Arc::new(digests.finish()), &[]);
        add("wall", Arc::new(wall), &[("unit", "s")]);
        add("results", Arc::new(results.finish()), &[]);
        of_columns(columns, campaign.source().plan().fingerprint()).map(Self)
    }

    /// Returns the columns.
    #[must_use]
    pub const fn columns(&self) -> &RecordBatch {
        &self.0
    }

    /// Returns the seeds in the order of the rows.
    #[must_use]
    pub fn seeds(&self) -> Vec<u64> {
        let seeds = self.0.column_by_name("seed");
        let seeds = seeds.and_then(|seeds| seeds.as_primitive_opt::<UInt64Type>());
        seeds.map_or_else(Vec::new, |seeds| seeds.values().to_vec())
    }

    /// Returns the numbers of the rows in which an expectation failed.
    #[must_use]
    pub fn failures(&self) -> Vec<usize> {
        let passed = self
            .0
            .column_by_name("passed")
            .and_then(|passed| passed.as_boolean_opt());
        let passed = passed.map(|passed| passed.values().iter());
        let rows = passed.into_iter().flatten().enumerate();
        rows.filter_map(|(row, passed)| (!passed).then_some(row))
            .collect()
    }

    /// Returns a row as a JSON object: `seed`, `variables` and `measures` by name, `failed`, `digest`, `wall` and `results`. A
    /// variable with a unit is a text, as changes of a plant have it. `None` behind the last row.
    #[must_use]
    pub fn row(&self, row: usize) -> Option<Value> {
        if row >= self.0.num_rows() {
            return None;
        }
        let mut document = Map::new();
        let (mut variables, mut measures) = (Map::new(), Map::new());
        for (field, array) in self.0.schema_ref().fields().iter().zip(self.0.columns()) {
            let value = value(array, row);
            let name = field.name().clone();
            let fact = |fact: &str| field.metadata().get(fact).map(String::as_str);
            match (fact(KIND), fact("unit")) {
                (Some(VARIABLE), Some(unit)) if !value.is_null() => {
                    // as a draw writes it
                    let number = value.as_f64().unwrap_or(f64::NAN);
                    variables.insert(name, format!("{number}{unit}").into());
                }
                (Some(VARIABLE), _) => _ = variables.insert(name, value),
                (Some(_), _) if value.is_null() => {}
                (Some(_), _) => _ = measures.insert(name, value),
                (None, _) => _ = document.insert(name, value),
            }
        }
        let results = document.get("results").and_then(Value::as_str);
        let results = results
            .and_then(|text| serde_json::from_str(text).ok())
            .unwrap_or(json!([]));
        document.insert("results".to_owned(), results);
        document.insert("variables".to_owned(), variables.into());
        document.insert("measures".to_owned(), measures.into());
        Some(document.into())
    }

    /// Returns chosen rows of many parts, in this order: their numbers as if all parts were one. A column that some parts do not have
    /// is null there.
    ///
    /// # Errors
    /// When columns of one name have different types.
    pub fn of_parts(parts: &[Self], rows: &[u64]) -> Result<Self, ArrowError> {
        let schemas = parts.iter().map(|part| part.0.schema_ref().as_ref().clone());
        let schema = Arc::new(Schema::try_merge(schemas)?);
        let whole = |part: &Self| {
            let columns = schema.fields().iter().map(|field| {
                let own = part.0.column_by_name(field.name()).cloned();
                own.unwrap_or_else(|| new_null_array(field.data_type(), part.0.num_rows()))
            });
            RecordBatch::try_new(Arc::clone(&schema), columns.collect())
        };
        let parts: Vec<_> = parts.iter().map(whole).collect::<Result<_, _>>()?;
        let all = concat_batches(&schema, &parts)?;
        take_record_batch(&all, &UInt64Array::from(rows.to_vec())).map(Self)
    }

    /// Returns the runs as an Arrow IPC stream.
    ///
    /// # Errors
    /// When they cannot be encoded.
    pub fn to_ipc(&self) -> Result<Vec<u8>, ArrowError> {
        let mut writer = StreamWriter::try_new(Vec::new(), self.0.schema_ref())?;
        writer.write(&self.0)?;
        writer.into_inner()
    }

    /// Returns the runs of an Arrow IPC stream.
    ///
    /// # Errors
    /// When these octets are none.
    pub fn from_ipc(octets: &[u8]) -> Result<Self, ArrowError> {
        let reader = StreamReader::try_new(octets, None)?;
        let schema = reader.schema();
        let batches: Vec<_> = reader.collect::<Result<_, _>>()?;
        concat_batches(&schema, &batches).map(Self)
    }

    /// Writes the runs to a new Parquet file.
    ///
    /// # Errors
    /// When the file exists or cannot be written.
    pub fn write(&self, file: &Path) -> io::Result<()> {
        let out = File::create_new(file)?;
        let mut writer = ArrowWriter::try_new(out, self.0.schema(), None).map_err(io::Error::other)?;
        writer.write(&self.0).map_err(io::Error::other)?;
        writer.close().map(drop).map_err(io::Error::other)
    }

    /// Reads the runs of a Parquet file.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn read(file: &Path) -> io::Result<Self> {
        let reader = ParquetRecordBatchReaderBuilder::try_new(File::open(file)?).map_err(io::Error::other)?;
        let schema = Arc::clone(reader.schema());
        let batches = reader.build().map_err(io::Error::other)?;
        let batches: Vec<_> = batches.collect::<Result<_, _>>().map_err(io::Error::other)?;
        concat_batches(&schema, &batches)
            .map(Self)
            .map_err(io::Error::other)
    }
}

fn of_columns(columns: Vec<(Field, ArrayRef)>, plant: u64) -> Result<RecordBatch, ArrowError> {
    let (fields, arrays): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
    for (place, field) in fields.iter().enumerate() {
        if fields
            .iter()
            .take(place)
            .any(|other| other.name() == field.name())
        {
            let text = format!("two columns are named `{}`", field.name());
            return Err(ArrowError::SchemaError(text));
        }
    }
    let plant = format!("{plant:016x}");
    let facts = [
        ("schema", FORM),
        ("version", env!("CARGO_PKG_VERSION")),
        (PLANT, &plant),
    ];
    let facts = facts.map(|(name, text)| (name.to_owned(), text.to_owned()));
    let schema = Schema::new_with_metadata(fields, HashMap::from(facts));
    RecordBatch::try_new(schema.into(), arrays)
}

/// One value of a column as JSON.
fn value(array: &ArrayRef, row: usize) -> Value {
    if array.is_null(row) {
        return Value::Null;
    }
    match array.data_type() {
        DataType::Boolean => array.as_boolean().value(row).into(),
        DataType::Int64 => array.as_primitive::<Int64Type>().value(row).into(),
        DataType::UInt64 => array.as_primitive::<UInt64Type>().value(row).into(),
        DataType::Float64 => array.as_primitive::<Float64Type>().value(row).into(),
        DataType::Utf8 => array.as_string::<i32>().value(row).into(),
        DataType::List(_) => {
            let inner = array.as_list::<i32>().value(row);
            (0..inner.len()).map(|place| value(&inner, place)).collect()
        }
        _ => Value::Null,
    }
}

#[cfg(test)]
mod tests {
    use plant::{Bounds, Distribution, PlantSource};

    use super::*;

    fn campaign(place: usize) -> Campaign {
        let plant: PlantSource = r#"
            duration = "200ms"
            expect = [{ name = "still", at = "100ms", drive = "akd-1", speed = "600rpm", tolerance = "1rpm" }]
            [[drive]]
            name = "akd-1"
            event = [{ at = "50ms", do = "warning=107" }]
        "#
        .parse()
        .unwrap();
        let time = Bounds::new(&"10ms".parse().unwrap(), &"90ms".parse().unwrap()).unwrap();
        let inertia = vec![1.into(), 0.5.into()];
        Campaign::new(plant)
            .vary("drive.akd-1.event.1.at", Distribution::Uniform(time))
            .vary(
                "drive.akd-1.load.inertia",
                Distribution::Listed {
                    values: inertia,
                    place,
                },
            )
    }

    fn runs(place: usize, seeds: impl IntoIterator<Item = u64>, measure: &str) -> Runs {
        let campaign = campaign(place);
        let measured = |seed| MeasuredRun {
            run: campaign.run(seed).unwrap(),
            measures: vec![(measure.to_owned(), seed as f64)],
            wall: 0.5,
        };
        let measured: Vec<_> = seeds.into_iter().map(measured).collect();
        Runs::new(&campaign, &measured).unwrap()
    }

    #[test]
    fn columns_have_the_types_of_their_values_in_each_part() {
        let parts = [runs(0, 0..3, "first"), runs(1, [7], "second")];
        let kind = |part: &Runs, name: &str| {
            part.columns()
                .column_by_name(name)
                .map(|found| found.data_type().clone())
        };
        for part in &parts {
            assert_eq!(kind(part, "seed"), Some(DataType::UInt64));
            assert_eq!(kind(part, "drive.akd-1.load.inertia"), Some(DataType::Float64));
        }
        let whole = Runs::of_parts(&parts, &[3, 0, 2]).unwrap();
        assert_eq!((whole.seeds(), whole.failures()), (vec![7, 0, 2], vec![0, 1, 2]));
        let schema = whole.columns().schema();
        let time = schema.field_with_name("drive.akd-1.event.1.at").unwrap();
        assert_eq!(
            (time.data_type(), time.metadata()["unit"].as_str()),
            (&DataType::Float64, "ms")
        );
        let row = whole.row(0).unwrap();
        assert_eq!(row["seed"], 7);
        assert_eq!(row["failed"], json!(["still"]));
        assert_eq!(row["results"][0]["name"], "still");
        assert_eq!(row["measures"], json!({ "second": 7.0 }));
        // what a change of the plant takes
        let drawn = campaign(1).run(7).unwrap().variables;
        assert_eq!(row["variables"]["drive.akd-1.event.1.at"], json!(drawn[0].1));
        assert!(whole.row(3).is_none());
    }

    #[test]
    fn streams_and_files_have_the_same_runs() {
        let part = runs(0, 0..3, "drive");
        let same = Runs::from_ipc(&part.to_ipc().unwrap()).unwrap();
        assert_eq!(same.columns(), part.columns());
        assert!(Runs::from_ipc(b"x").is_err());
        let file = std::env::temp_dir().join(format!("runs-{}.parquet", std::process::id()));
        part.write(&file).unwrap();
        let again = Runs::read(&file).unwrap();
        std::fs::remove_file(&file).unwrap();
        assert_eq!(again.columns(), part.columns());
        assert_eq!(again.row(1), part.row(1));
    }

    #[test]
    fn what_a_campaign_measures_is_a_column_with_its_unit() {
        let campaign = campaign(0);
        let plan = campaign.source().plan();
        let peak = plan.measure("max speed of akd-1").unwrap();
        let trip = plan.measure("time of { fault = \"any\" }").unwrap();
        let campaign = campaign.clone().measure("peak", peak).measure("trip", trip);
        let measured = |seed| MeasuredRun {
            run: campaign.run(seed).unwrap(),
            measures: Vec::new(),
            wall: 0.0,
        };
        let runs = Runs::new(&campaign, &[measured(1), measured(2)]).unwrap();
        let schema = runs.columns().schema();
        assert_eq!(schema.field_with_name("peak").unwrap().metadata()["unit"], "rpm");
        assert_eq!(schema.metadata()[PLANT].len(), 16);
        // the fault never came
        assert_eq!(runs.columns().column_by_name("trip").unwrap().null_count(), 2);
        assert_eq!(runs.row(1).unwrap()["measures"], json!({ "peak": 0.0 }));
    }

    #[test]
    fn a_measure_cannot_have_the_name_of_another_column() {
        let campaign = campaign(0);
        let measured = MeasuredRun {
            run: campaign.run(1).unwrap(),
            measures: vec![("seed".to_owned(), 1.0)],
            wall: 0.0,
        };
        let error = Runs::new(&campaign, &[measured]).unwrap_err().to_string();
        assert!(error.contains("`seed`"), "{error}");
    }
}
