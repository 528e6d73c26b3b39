//! JSON schemas of all documents, one for each command, with shared definitions.

use dissect::meaning::Meaning;
use dissect::report::DecodeReport;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::{
    BackupReport, BlinkReport, BundleReport, CommissionReport, DemoEvent, DescribeReport, DiffReport,
    DoctorReport, Drives, Error, FaultsReport, GsdmlCheckReport, GsdmlExportReport, GsdmlShowReport,
    InfoReport, InjectReport, IpReport, ListReport, MonitorReading, MonitorSilence, NameReport, PageReport,
    ParametersReport, RecordReport, ResetReport, RestoreReport, ScanReport, ServeReport, SimulationReport,
    StationChange, StatusReport, StepReport, WriteReport,
};
use crate::motion::{self, JogPlan, Message, MoveReport, RunPlan, StopReport};

/// Name of the file with the shared definitions.
pub const DEFINITIONS: &str = "definitions.json";

/// Adds what a command reports to the shared definitions and returns its schema.
type Describe = fn(&mut SchemaGenerator) -> Value;

/// What each command reports.
const COMMANDS: &[(&str, Describe)] = &[
    ("scan", of::<Scan>),
    ("info", each::<InfoReport, InfoReport>),
    ("read", each::<ParametersReport, ParametersReport>),
    ("list", of::<ListReport>),
    ("describe", of::<DescribeReport>),
    ("write", each::<WriteReport, WriteReport>),
    ("backup", each::<BackupReport, BackupReport>),
    ("restore", of::<RestoreReport>),
    ("diff", of::<Diff>),
    ("commission", each::<CommissionReport, BackupReport>),
    ("replace", of::<CommissionReport>),
    ("gsdml check", of::<GsdmlCheckReport>),
    ("gsdml show", of::<GsdmlShowReport>),
    ("gsdml export", of::<GsdmlExportReport>),
    ("name", of::<NameReport>),
    ("ip", of::<IpReport>),
    ("blink", of::<BlinkReport>),
    ("reset", of::<ResetReport>),
    ("explain", of::<Meaning>),
    ("decode", of::<DecodeReport<'_>>),
    #[cfg(feature = "simulate")]
    ("simulate", of::<SimulationReport>),
    ("serve", of::<ServeReport>),
    ("demo", of::<DemoEvent>),
    ("inject", of::<InjectReport>),
    ("doctor", of::<DoctorReport>),
    ("bundle", of::<BundleReport>),
    ("report", of::<PageReport>),
    ("status", each::<StatusReport, StatusReport>),
    ("faults", each::<FaultsReport, FaultsReport>),
    ("monitor", of::<Monitored>),
    ("record", of::<RecordReport>),
    ("run", motion::<RunPlan>),
    ("step", motion::<StepReport>),
    ("jog", motion::<JogPlan>),
    ("move", motion::<MoveReport>),
    ("task", of::<Message>),
    ("home", of::<Message>),
    ("ack", each::<Message, motion::Report>),
    ("stop", each::<StopReport, StopReport>),
];

/// The stations that answered, or one document for each that comes, goes or changes.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
enum Scan {
    Stations(ScanReport),
    Change(Box<StationChange>),
}

/// A drive that is watched: what it reports, or that it does not answer.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
enum Monitored {
    Reading(Box<MonitorReading>),
    Silence(MonitorSilence),
}

/// What two sets of settings differ in, many drives from their backups, or the drives of a machine from its file.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
enum Diff {
    Settings(DiffReport),
    Drives(Drives<DiffReport>),
    Machine(CommissionReport),
}

/// What a motion reports while it goes on and at its end, or its plan in a dry run.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
enum Motion<P> {
    Done(Message),
    Plan(P),
}

/// What a command reports for one drive, or for each of many.
fn each<O: JsonSchema, M: JsonSchema>(generator: &mut SchemaGenerator) -> Value {
    let mut one = of::<O>(generator);
    let many = generator.subschema_for::<Drives<M>>().to_value();
    let description = take_heading(&mut one).get("description").cloned();
    json!({ "description": description, "anyOf": [one, many] })
}

fn motion<P: JsonSchema>(generator: &mut SchemaGenerator) -> Value {
    of::<Motion<P>>(generator)
}

fn of<T: JsonSchema>(generator: &mut SchemaGenerator) -> Value {
    generator.root_schema_for::<T>().to_value()
}

/// Returns the files with the schemas: their names and what they contain. `version` is the value of `schema` in every
/// document.
#[must_use]
pub fn files(version: &str) -> Vec<(String, Value)> {
    let mut generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let mut files: Vec<(String, Value)> = COMMANDS
        .iter()
        .map(|(command, describe)| {
            let report = describe(&mut generator);
            let file = format!("{}.json", command.replace(' ', "-"));
            (file, document(version, command, report))
        })
        .collect();
    generator.subschema_for::<Error>();
    // what other programs make classes of is defined by its name
    generator.subschema_for::<DescribeReport>();
    generator.subschema_for::<ListReport>();
    generator.subschema_for::<BlinkReport>();
    generator.subschema_for::<GsdmlCheckReport>();
    generator.subschema_for::<GsdmlShowReport>();
    let definitions = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": format!("{version}: shared definitions"),
        "$defs": generator.take_definitions(true),
    });
    files.push((DEFINITIONS.to_owned(), definitions));
    files
}

/// Returns the schema of every document of a command: a report, an error, or both.
fn document(version: &str, command: &str, mut report: Value) -> Value {
    let parts = take_heading(&mut report);
    outward(&mut report);
    let error = json!({ "$ref": format!("{DEFINITIONS}#/$defs/Error") });
    let mut whole = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": format!("{version}: report of {command}"),
        "type": "object",
        "properties": {
            "schema": { "const": version },
            "command": { "const": command },
            "error": error,
            "errors": { "type": "array", "items": error },
        },
        "required": ["schema", "command"],
        "anyOf": [report, { "required": ["error"] }],
    });
    if let Value::Object(fields) = &mut whole {
        fields.extend(parts);
    }
    whole
}

/// Removes what only a whole schema has, and returns its description.
fn take_heading(schema: &mut Value) -> Map<String, Value> {
    let mut parts = Map::new();
    if let Value::Object(fields) = schema {
        for name in ["$schema", "title", "$defs"] {
            fields.remove(name);
        }
        if let Some(description) = fields.remove("description") {
            parts.insert("description".into(), description);
        }
    }
    parts
}

/// Makes references to definitions lead to the file that has them.
fn outward(schema: &mut Value) {
    match schema {
        Value::Object(fields) => {
            for (name, value) in fields {
                match value {
                    Value::String(target) if name == "$ref" && target.starts_with('#') => {
                        *target = format!("{DEFINITIONS}{target}");
                    }
                    other => outward(other),
                }
            }
        }
        Value::Array(values) => values.iter_mut().for_each(outward),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reference_leads_to_a_definition_and_no_name_is_used_twice() {
        let files = files("profidrive/1");
        let text = Value::from_iter(files.iter().map(|(_, schema)| schema.clone())).to_string();
        let definitions = &files.last().unwrap().1["$defs"];
        for target in text.split("#/$defs/").skip(1) {
            let name = target.split('"').next().unwrap();
            assert!(definitions.get(name).is_some(), "{name}");
        }
        // the generator numbers a second type of the same name
        for name in definitions.as_object().unwrap().keys() {
            assert!(!name.ends_with(|c: char| c.is_ascii_digit()), "{name}");
        }
    }
}
