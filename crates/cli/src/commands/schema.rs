//! `profidrive schema`, for `docs/schema/`: the JSON schemas of all commands.

use profidrive::report::schema;
use serde_json::{Map, Value};

use crate::output::{Output, SCHEMA};

/// Prints one JSON object: the schema of each file by the name of the file.
pub fn run(output: &Output) {
    let files: Map<String, Value> = schema::files(SCHEMA).into_iter().collect();
    output.line(&Value::Object(files).to_string());
}
