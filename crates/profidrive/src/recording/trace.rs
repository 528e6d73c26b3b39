//! A run of a plant that was kept, as a table.

use arrow_array::RecordBatch;
use arrow_schema::ArrowError;
use plant::{Observed as _, ObservedQuantity, PlantPlan, Snapshot, Trace};

use super::batch::{Batch, PLANT};
use super::table::{Column, Kind, Row, Table, Value};

/// Words of a drive, before its quantities.
const WORDS: [&str; 3] = ["state", "stw1", "zsw1"];

/// Returns the columns of a trace of a plant: the state (1 to 5), both words, and each quantity that an expectation can look at. The
/// drives are all drives of the plant, the facts its fingerprint and the seed of the run.
#[must_use]
pub fn trace_table(trace: &Trace, plan: &PlantPlan) -> Table {
    let column = |name: String, kind: Kind, unit: &str| Column {
        name,
        kind,
        unit: unit.to_owned(),
        parameter: String::new(),
        scaling: String::new(),
    };
    let words = WORDS.map(|name| column(name.to_owned(), Kind::Word, ""));
    let quantities = ObservedQuantity::ALL.map(|(quantity, key)| {
        let name = key.replace(['.', '-'], "_");
        column(name, Kind::Number, quantity.unit())
    });
    Table {
        drives: trace.drives().map(|drive| drive.name().to_owned()).collect(),
        columns: words.into_iter().chain(quantities).collect(),
        facts: vec![
            ("seed", trace.seed().to_string()),
            (PLANT, format!("{:016x}", plan.fingerprint())),
        ],
    }
}

/// Returns a row for each tick at which something of a drive changed, in the order of time; of one drive where its name is
/// given. Between two rows the drive was as the first says.
#[must_use]
pub fn trace_rows(trace: &Trace, drive: Option<&str>) -> Vec<Row> {
    let chosen = trace.drives().enumerate();
    let chosen = chosen.filter(|(_, found)| drive.is_none_or(|drive| drive == found.name()));
    let mut rows: Vec<Row> = chosen
        .flat_map(|(number, drive)| {
            drive.snapshots().map(move |(time, snapshot)| Row {
                time,
                wall: None,
                drive: number,
                gap: false,
                values: values(snapshot),
            })
        })
        .collect();
    rows.sort_by_key(|row| row.time);
    rows
}

fn values(snapshot: &Snapshot) -> Vec<Option<Value>> {
    let state = u16::from(snapshot.state().number());
    let words = [state, snapshot.stw1().0, snapshot.zsw1().0].map(Value::Word);
    let quantities = ObservedQuantity::ALL.map(|(quantity, _)| Value::Number(snapshot.quantity(quantity)));
    words.into_iter().chain(quantities).map(Some).collect()
}

/// Returns the [rows](trace_rows) of a trace of a plant as columns.
///
/// # Errors
/// When the columns do not fit together, which is an error in this program.
pub fn trace_columns(
    trace: &Trace,
    plan: &PlantPlan,
    drive: Option<&str>,
) -> Result<RecordBatch, ArrowError> {
    let mut batch = Batch::new(&trace_table(trace, plan));
    for row in trace_rows(trace, drive) {
        batch.push(&row);
    }
    batch.take()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use plant::World;
    use profinet::Instant;

    use super::*;

    #[test]
    fn a_trace_is_a_table_in_the_order_of_time() {
        let text = "seed = 9\n[[drive]]\nname = \"akd-1\"\nevent = [{ at = \"1s\", do = \"fault=439\" }]\n[[drive]]\nname = \"akd-2\"";
        let plan: PlantPlan = text.parse().unwrap();
        let mut world = World::new(&plan).unwrap();
        world.keep_trace(Trace::USUAL_LIMIT);
        world.run_until(Instant::from_millis(2000), &mut drop);
        let trace = world.take_trace().unwrap();
        let rows = trace_rows(&trace, None);
        assert!(rows.is_sorted_by_key(|row| row.time));
        let one = trace_rows(&trace, Some("akd-1"));
        assert!(one.iter().all(|row| row.drive == 0) && one.len() < rows.len());
        let fault = one.iter().find(|row| row.time >= Duration::from_secs(1)).unwrap();
        let Some(Value::Word(zsw1)) = fault.values[2] else {
            panic!("{fault:?}");
        };
        assert_eq!(zsw1 & 8, 8, "bit 3 of ZSW1 is the fault");
        let columns = trace_columns(&trace, &plan, None).unwrap();
        assert_eq!(columns.num_rows(), rows.len());
        assert_eq!(columns.schema().metadata()["seed"], "9");
        // a hash of what the plant is, whatever its seed and its comments
        let hash = |text: &str| {
            let plan: PlantPlan = text.parse().unwrap();
            trace_table(&trace, &plan).facts.swap_remove(1)
        };
        let own = hash(text);
        assert_eq!(own, (PLANT, columns.schema().metadata()[PLANT].clone()));
        assert_eq!(own.1.len(), 16);
        assert_eq!(hash(&text.replace("seed = 9", "# seeds\nseed=10")), own);
        assert_ne!(hash(&text.replace("1s", "2s")), own);
        assert_eq!(
            columns.schema().field_with_name("load_speed").unwrap().metadata()["unit"],
            "rpm"
        );
    }
}
