//! The data classes of the Python package, from the JSON schemas: events of plants and results of expectations.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use serde_json::Value;

use crate::Outcome;

/// The files below the workspace folder, each with the documents that it has.
pub const FILES: [(&str, &[&str]); 2] = [
    ("python/profidrive/events.py", &["Event", "ExpectationResult"]),
    (
        "python/profidrive/reports.py",
        &[
            "ParametersReport",
            "StatusReport",
            "FaultsReport",
            "WriteReport",
            "StopReport",
            "MotionReport",
            "AxisState",
            "DescribeReport",
            "ListReport",
            "InfoReport",
            "ScanReport",
            "NameReport",
            "IpReport",
            "BlinkReport",
            "BackupReport",
            "DiffReport",
            "RestoreReport",
            "GsdmlCheckReport",
            "GsdmlShowReport",
        ],
    ),
];

/// Numbers that are states of the general state machine: class and fields.
const STATES: (&str, [&str; 2]) = ("StateChanged", ["old", "new"]);

const HEAD: &str = r#"# Generated from docs/schema by `cargo run -p xtask -- pages`. Do not edit.
"""Documents of the library as frozen data classes; their JSON schemas are in docs/schema."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, TypeAlias

from profidrive.types import State as State


def _number(value: float | None) -> float:
    """JSON has no NaN: it is null there."""
    return float("nan") if value is None else value

"#;

/// Returns the file with these documents, from the shared definitions of all schemas.
pub fn file(definitions: &Value, roots: &[&str]) -> Outcome<String> {
    let mut writer = Writer {
        definitions,
        text: HEAD.to_owned(),
        written: BTreeMap::new(),
    };
    for root in roots {
        writer.define(root)?;
    }
    let functions = writer.written.values().filter(|how| **how == "event_of");
    let functions: Vec<String> = functions.map(|name| (*name).to_owned()).collect();
    let names: BTreeSet<String> = writer.written.into_keys().chain(functions).collect();
    let mut text = writer.text;
    text.push_str("\n__all__ = [\n");
    for name in names {
        writeln!(text, "    {name:?},")?;
    }
    text.push_str("]\n");
    Ok(text)
}

/// How a value is written in Python.
struct Type {
    /// Its annotation.
    name: String,
    /// The value of this expression, made of that of the document.
    made: Box<dyn Fn(&str) -> String>,
}

impl Type {
    fn plain(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            made: Box::new(str::to_owned),
        }
    }
}

struct Writer<'d> {
    definitions: &'d Value,
    text: String,
    /// The names that are defined, each with what makes a value of it.
    written: BTreeMap<String, &'static str>,
}

impl Writer<'_> {
    fn define(&mut self, name: &str) -> Outcome<()> {
        if self.written.contains_key(name) {
            return Ok(());
        }
        let definition = &self.definitions[name];
        if !definition.is_object() {
            return Err(format!("the schemas define no {name}").into());
        }
        let is_event = |variant: &Value| variant["properties"]["event"].is_object();
        match definition["oneOf"].as_array() {
            Some(variants) if variants.iter().all(is_event) => self.union(name, definition, variants),
            Some(variants) => self.choice(name, definition, variants),
            None if definition["anyOf"].is_array() => {
                // the types of its parts alone
                self.written.insert(name.to_owned(), "");
                let parts: Vec<_> = list(&definition["anyOf"])
                    .map(|part| self.name_of(part))
                    .collect();
                let parts: Outcome<Vec<_>> = parts.into_iter().collect();
                let doc = text(&definition["description"]);
                let parts = parts?.join(" | ");
                writeln!(self.text, "\n{name}: TypeAlias = {parts}\n\"\"\"{doc}\"\"\"\n")?;
                Ok(())
            }
            None => {
                let fields = fields(definition);
                self.class(name, text(&definition["description"]), &[(definition, fields)])
            }
        }
    }

    fn name_of(&mut self, schema: &Value) -> Outcome<String> {
        Ok(self.field(schema, "", "")?.name)
    }

    /// An event: a class for each kind of it, and their union.
    fn union(&mut self, name: &str, definition: &Value, variants: &[Value]) -> Outcome<()> {
        let common = fields(definition);
        let mut classes = Vec::new();
        for variant in variants {
            let key = text(&variant["properties"]["event"]["const"]);
            let class = camel(key);
            let own = match variant["$ref"]
                .as_str()
                .and_then(|target| target.rsplit('/').next())
            {
                Some(target) => &self.definitions[target],
                None => variant,
            };
            let own_fields = fields(own).into_iter().filter(|field| field != "event").collect();
            let parts = [(definition, common.clone()), (own, own_fields)];
            self.class(&class, text(&variant["description"]), &parts)?;
            classes.push((key.to_owned(), class));
        }
        let names: Vec<_> = classes.iter().map(|(_, class)| class.as_str()).collect();
        let doc = text(&definition["description"]);
        writeln!(
            self.text,
            "\n{name}: TypeAlias = (\n    {}\n)\n\"\"\"{doc}\"\"\"\n\n_CLASSES: dict[str, Any] = {{",
            names.join("\n    | ")
        )?;
        for (key, class) in &classes {
            writeln!(self.text, "    {key:?}: {class},")?;
        }
        writeln!(
            self.text,
            "}}\n\n\ndef event_of(data: Mapping[str, Any]) -> {name}:\n    \"\"\"Returns an event from its JSON document.\"\"\"\n    event: {name} = _CLASSES[data[\"event\"]]._of(data)\n    return event\n"
        )?;
        self.written.insert(name.to_owned(), "event_of");
        Ok(())
    }

    fn choice(&mut self, name: &str, definition: &Value, variants: &[Value]) -> Outcome<()> {
        writeln!(
            self.text,
            "\nclass {name}(str, Enum):\n    \"\"\"{}\"\"\"\n",
            text(&definition["description"])
        )?;
        for variant in variants {
            let value = text(&variant["const"]);
            writeln!(
                self.text,
                "    {} = {value:?}\n    \"\"\"{}\"\"\"",
                value.to_uppercase(),
                text(&variant["description"])
            )?;
        }
        writeln!(self.text)?;
        self.written.insert(name.to_owned(), "enum");
        Ok(())
    }

    /// A data class with the fields of one or more schemas.
    fn class(&mut self, name: &str, doc: &str, parts: &[(&Value, Vec<String>)]) -> Outcome<()> {
        let mut rows = Vec::new();
        for (schema, fields) in parts {
            for field in fields {
                let schema = &schema["properties"][field.as_str()];
                rows.push((
                    field,
                    text(&schema["description"]),
                    self.field(schema, name, field)?,
                ));
            }
        }
        writeln!(
            self.text,
            "\n@dataclass(frozen=True, slots=True)\nclass {name}:\n    \"\"\"{doc}\"\"\"\n"
        )?;
        for (field, doc, kind) in &rows {
            let field = attribute(field);
            writeln!(self.text, "    {field}: {}\n    \"\"\"{doc}\"\"\"", kind.name)?;
        }
        writeln!(
            self.text,
            "\n    @classmethod\n    def _of(cls, data: Mapping[str, Any]) -> {name}:\n        return cls("
        )?;
        for (field, _, kind) in &rows {
            let made = (kind.made)(&format!("data[{field:?}]"));
            let field = attribute(field);
            writeln!(self.text, "            {field}={made},")?;
        }
        writeln!(self.text, "        )\n")?;
        self.written.insert(name.to_owned(), "class");
        Ok(())
    }

    /// Returns the type of a field; what it refers to is defined before.
    fn field(&mut self, schema: &Value, class: &str, field: &str) -> Outcome<Type> {
        if class == STATES.0 && STATES.1.contains(&field) {
            return Ok(Type {
                name: "State".to_owned(),
                made: Box::new(|value| format!("State({value})")),
            });
        }
        if let Some(target) = schema["$ref"].as_str() {
            let name = target.rsplit('/').next().unwrap_or_default().to_owned();
            self.define(&name)?;
            let how = self.written.get(&name).copied().unwrap_or_default();
            let made = name.clone();
            return Ok(Type {
                name,
                made: Box::new(move |value| match how {
                    "" => value.to_owned(),
                    "class" => format!("{made}._of({value})"),
                    "enum" => format!("{made}({value})"),
                    function => format!("{function}({value})"),
                }),
            });
        }
        let nullable = |inner: Type| Type {
            name: format!("{} | None", inner.name),
            made: Box::new(move |value| match (inner.made)(value) {
                same if same == value => same,
                made => format!("None if {value} is None else {made}"),
            }),
        };
        if let [inner, null] = &list(&schema["anyOf"]).collect::<Vec<_>>()[..]
            && null["type"] == "null"
        {
            return Ok(nullable(self.field(inner, "", "")?));
        }
        if let [inner, null] = &list(&schema["type"]).collect::<Vec<_>>()[..]
            && *null == "null"
        {
            if *inner != "array" {
                return Ok(nullable(basic(text(inner), false)?));
            }
            let mut whole = schema.clone();
            whole["type"] = (*inner).clone();
            return Ok(nullable(self.field(&whole, "", "")?));
        }
        if schema["type"] == "array" {
            let item = self.field(&schema["items"], "", "")?;
            return Ok(Type {
                name: format!("tuple[{}, ...]", item.name),
                made: Box::new(move |value| format!("tuple({} for item in {value})", (item.made)("item"))),
            });
        }
        if schema["type"] == "object" {
            let item = self.field(&schema["additionalProperties"], "", "")?;
            return Ok(Type {
                name: format!("Mapping[str, {}]", item.name),
                made: Box::new(move |value| {
                    format!(
                        "{{key: {} for key, item in {value}.items()}}",
                        (item.made)("item")
                    )
                }),
            });
        }
        basic(text(&schema["type"]), true)
    }
}

/// The name of a field in Python, in which these are words of the language.
fn attribute(field: &str) -> String {
    match field {
        "from" | "in" | "is" | "for" | "not" | "class" | "import" => format!("{field}_"),
        other => other.to_owned(),
    }
}

fn basic(name: &str, always: bool) -> Outcome<Type> {
    Ok(match name {
        "integer" => Type::plain("int"),
        "string" => Type::plain("str"),
        "boolean" => Type::plain("bool"),
        "number" if always => Type {
            name: "float".to_owned(),
            made: Box::new(|value| format!("_number({value})")),
        },
        "number" => Type::plain("float"),
        other => return Err(format!("no Python type for a value of type `{other}`").into()),
    })
}

/// The fields of an object in the order of its struct.
fn fields(schema: &Value) -> Vec<String> {
    list(&schema["required"])
        .map(|field| text(field).to_owned())
        .collect()
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// `state_changed` as `StateChanged`.
fn camel(key: &str) -> String {
    let words = key.split('_').map(|word| {
        let (first, rest) = word.split_at(word.len().min(1));
        first.to_uppercase() + rest
    });
    words.collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_document_becomes_data_classes_in_the_order_of_its_fields() {
        let definitions = json!({
            "Event": {
                "description": "It happened.",
                "required": ["time"],
                "properties": { "time": { "type": "number", "description": "Seconds." } },
                "oneOf": [{
                    "description": "Gone.",
                    "required": ["event", "why"],
                    "properties": { "event": { "const": "link_lost" }, "why": { "type": ["string", "null"] } },
                }],
            },
            "Kind": { "oneOf": [{ "const": "good" }] },
            "ExpectationResult": {
                "required": ["events", "kind"],
                "properties": {
                    "kind": { "anyOf": [{ "$ref": "#/$defs/Kind" }, { "type": "null" }] },
                    "events": { "type": "array", "items": { "$ref": "#/$defs/Event" } },
                },
            },
        });
        let file = file(&definitions, &["Event", "ExpectationResult"]).unwrap();
        for expected in [
            "class LinkLost:\n    \"\"\"Gone.\"\"\"\n\n    time: float\n    \"\"\"Seconds.\"\"\"\n    why: str | None\n",
            "time=_number(data[\"time\"]),\n            why=data[\"why\"],",
            "\"link_lost\": LinkLost,",
            "class Kind(str, Enum):",
            "events: tuple[Event, ...]\n",
            "events=tuple(event_of(item) for item in data[\"events\"]),",
            "kind=None if data[\"kind\"] is None else Kind(data[\"kind\"]),",
        ] {
            assert!(file.contains(expected), "{expected}\n{file}");
        }
        assert!(
            super::file(&json!({}), &["Event"])
                .unwrap_err()
                .to_string()
                .contains("Event")
        );
    }
}
