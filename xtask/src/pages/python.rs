//! The data classes of the Python package, from the JSON schemas: events of plants and results of expectations.

mod methods;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use serde_json::Value;

use crate::Outcome;

use methods::{IMPORTS, METHODS};

/// The files below the workspace folder, each with the documents that it has.
pub const FILES: [(&str, &[&str]); 3] = [
    ("python/profidrive/events.py", &["Event", "ExpectationResult"]),
    (
        "python/profidrive/frames.py",
        &["CaptureEvent", "DeviceSummary", "FrameNode"],
    ),
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

/// Fields that a representation leaves out, by class: what is long and seldom looked at.
const UNSHOWN: [(&str, &str); 1] = [("ExpectationResult", "last_events")];

const NOT_IN_REPR: &str = " = field(repr=False)";

/// What names the kind of a document among many.
const TAGS: [&str; 2] = ["event", "problem"];

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
    let functions = writer
        .written
        .values()
        .filter(|made| made.ends_with("_of") && !made.contains('.'));
    let functions: Vec<String> = functions.cloned().collect();
    let names: BTreeSet<String> = writer.written.into_keys().chain(functions).collect();
    let mut text = writer.text;
    if text.contains(NOT_IN_REPR) {
        text = text.replacen("import dataclass\n", "import dataclass, field\n", 1);
    }
    for (what, plain, more) in IMPORTS {
        if text.contains(what) {
            text = text.replacen(plain, more, 1);
        }
    }
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

    /// The same of a field that may be left out: an empty list, or nothing.
    fn or_absent(self, is_list: bool) -> Self {
        let absent = if is_list { ", ()" } else { "" };
        let name = match self.name.as_str() {
            "object" => self.name,
            name if is_list || name.ends_with("| None") => self.name,
            name => format!("{name} | None"),
        };
        Self {
            name,
            made: Box::new(move |value| {
                let field = value.replacen("data[", "data.get(", 1).replace(']', "");
                (self.made)(&format!("{field}{absent})"))
            }),
        }
    }
}

struct Writer<'d> {
    definitions: &'d Value,
    text: String,
    /// The names that are defined, each with the function that makes a value of it; empty where the value stays as it is.
    written: BTreeMap<String, String>,
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
        let has = |key: &str, variant: &Value| variant["properties"][key].is_object();
        match definition["oneOf"].as_array() {
            Some(variants) if variants.iter().all(|variant| has("data", variant)) => {
                self.holder(name, definition, variants)
            }
            Some(variants) => match TAGS
                .iter()
                .find(|tag| variants.iter().all(|variant| has(tag, variant)))
            {
                Some(tag) => self.union(name, definition, variants, tag),
                None => self.choice(name, definition, variants),
            },
            None if definition["anyOf"].is_array() => {
                // the types of its parts alone
                self.written.insert(name.to_owned(), String::new());
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
                self.class(
                    name,
                    text(&definition["description"]),
                    &[(definition, fields)],
                    None,
                )
            }
        }
    }

    fn name_of(&mut self, schema: &Value) -> Outcome<String> {
        Ok(self.field(schema, "", "")?.name)
    }

    /// An event: a class for each kind of it, and their union.
    fn union(&mut self, name: &str, definition: &Value, variants: &[Value], tag: &str) -> Outcome<()> {
        let common = fields(definition);
        let mut classes = Vec::new();
        for variant in variants {
            let key = text(&variant["properties"][tag]["const"]);
            let class = camel(key);
            let own = match target(variant) {
                Some(target) => &self.definitions[target],
                None => variant,
            };
            let own_fields = fields(own).into_iter().filter(|field| field != tag).collect();
            let parts = [(definition, common.clone()), (own, own_fields)];
            self.class(&class, text(&variant["description"]), &parts, None)?;
            classes.push((key.to_owned(), class));
        }
        let names: Vec<_> = classes.iter().map(|(_, class)| class.as_str()).collect();
        let doc = text(&definition["description"]);
        let functions = format!("_{}S", snake(name).to_uppercase());
        writeln!(
            self.text,
            "\n{name}: TypeAlias = (\n    {}\n)\n\"\"\"{doc}\"\"\"\n\n{functions}: dict[str, Any] = {{",
            names.join("\n    | ")
        )?;
        for (key, class) in &classes {
            writeln!(self.text, "    {key:?}: {class},")?;
        }
        let function = format!("{}_of", snake(name));
        writeln!(
            self.text,
            "}}\n\n\ndef {function}(data: Mapping[str, Any]) -> {name}:\n    \"\"\"Returns it from its JSON document.\"\"\"\n    made: {name} = {functions}[data[{tag:?}]]._of(data)\n    return made\n"
        )?;
        self.written.insert(name.to_owned(), function);
        Ok(())
    }

    /// A class whose `data` is a document of the `kind` beside it.
    fn holder(&mut self, name: &str, definition: &Value, variants: &[Value]) -> Outcome<()> {
        let mut kinds = Vec::new();
        for variant in variants {
            let properties = &variant["properties"];
            let class = target(&properties["data"])
                .ok_or("a document without a name")?
                .to_owned();
            self.define(&class)?;
            let made = self.written.get(&class).cloned().unwrap_or_default();
            kinds.push((text(&properties["kind"]["const"]).to_owned(), class, made));
        }
        let functions = format!("_{}S", snake(name).to_uppercase());
        writeln!(self.text, "\n{functions}: dict[str, Any] = {{")?;
        for (kind, _, made) in &kinds {
            writeln!(self.text, "    {kind:?}: {made},")?;
        }
        writeln!(self.text, "}}\n")?;
        let mut classes: Vec<_> = kinds.iter().map(|(_, class, _)| class.as_str()).collect();
        classes.dedup();
        writeln!(
            self.text,
            "\n{name}Data: TypeAlias = (\n    {}\n)\n\"\"\"What happened, in numbers.\"\"\"\n",
            classes.join("\n    | ")
        )?;
        let data = Type {
            name: format!("{name}Data"),
            made: Box::new(move |value| format!("{functions}[data[\"kind\"]]({value})")),
        };
        let parts = [(definition, fields(definition))];
        self.class(name, text(&definition["description"]), &parts, Some(data))
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
        self.written.insert(name.to_owned(), name.to_owned());
        Ok(())
    }

    /// A data class with the fields of one or more schemas, and with `kind` and `data` where there are documents of many kinds.
    fn class(
        &mut self,
        name: &str,
        doc: &str,
        parts: &[(&Value, Vec<String>)],
        data: Option<Type>,
    ) -> Outcome<()> {
        // a part of it may be of the same class
        self.written.insert(name.to_owned(), format!("{name}._of"));
        let doc = doc.replace("\n\n", "\n\n    ");
        let mut rows = Vec::new();
        for (schema, fields) in parts {
            for field in fields {
                let property = &schema["properties"][field.as_str()];
                let mut kind = self.field(property, name, field)?;
                if !list(&schema["required"]).any(|required| required == field.as_str()) {
                    kind = kind.or_absent(property["type"] == "array");
                }
                rows.push((field.as_str(), text(&property["description"]), kind));
            }
            if schema["additionalProperties"] == true {
                let kind = Type {
                    name: "Mapping[str, object]".to_owned(),
                    made: Box::new(|_| "data".to_owned()),
                };
                rows.push(("document", "Its JSON document, with all that it has.", kind));
            }
        }
        if let Some(data) = data {
            rows.push(("kind", "What `data` is.", Type::plain("str")));
            rows.push(("data", "What happened, in numbers.", data));
        }
        writeln!(
            self.text,
            "\n@dataclass(frozen=True, slots=True)\nclass {name}:\n    \"\"\"{doc}\"\"\"\n"
        )?;
        for (field, doc, kind) in &rows {
            let value = match UNSHOWN.contains(&(name, field)) {
                true => NOT_IN_REPR,
                false => "",
            };
            let field = attribute(field);
            writeln!(
                self.text,
                "    {field}: {}{value}\n    \"\"\"{doc}\"\"\"",
                kind.name
            )?;
        }
        writeln!(
            self.text,
            "\n    @classmethod\n    def _of(cls, data: Mapping[str, Any]) -> {name}:\n        return cls("
        )?;
        for (field, _, kind) in &rows {
            // by place: names cost a third of the time of a long list
            writeln!(
                self.text,
                "            {},",
                (kind.made)(&format!("data[{field:?}]"))
            )?;
        }
        writeln!(self.text, "        )")?;
        for (_, method) in METHODS.iter().filter(|(class, _)| *class == name) {
            self.text.push_str(method);
        }
        writeln!(self.text)?;
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
        if let Some(name) = target(schema) {
            let name = name.to_owned();
            self.define(&name)?;
            let made = self.written.get(&name).cloned().unwrap_or_default();
            return Ok(Type {
                name,
                made: Box::new(move |value| match made.as_str() {
                    "" => value.to_owned(),
                    made => format!("{made}({value})"),
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
        if schema["type"].is_null() {
            // whatever JSON has
            return Ok(Type::plain("object"));
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

/// The fields of an object in the order of its struct, then those that may be left out.
fn fields(schema: &Value) -> Vec<String> {
    let required: Vec<_> = list(&schema["required"]).map(text).collect();
    let properties = schema["properties"].as_object().into_iter().flatten();
    let optional = properties
        .map(|(name, _)| name.as_str())
        .filter(|name| !required.contains(name));
    required
        .iter()
        .copied()
        .chain(optional)
        .map(str::to_owned)
        .collect()
}

/// The name of the definition that a schema refers to.
fn target(schema: &Value) -> Option<&str> {
    schema["$ref"].as_str()?.rsplit('/').next()
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// `StateChanged` as `state_changed`.
fn snake(name: &str) -> String {
    let mut words = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !words.is_empty() {
            words.push('_');
        }
        words.extend(letter.to_lowercase());
    }
    words
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
            "cls(\n            _number(data[\"time\"]),\n            data[\"why\"],\n",
            "\"link_lost\": LinkLost,",
            "class Kind(str, Enum):",
            "events: tuple[Event, ...]\n",
            // by place, so in the order of the fields
            "    events: tuple[Event, ...]\n    \"\"\"\"\"\"\n    kind: Kind | None\n",
            "cls(\n            tuple(event_of(item) for item in data[\"events\"]),\n            None if data[\"kind\"] is None else Kind(data[\"kind\"]),\n",
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
