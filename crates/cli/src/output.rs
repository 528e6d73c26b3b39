//! The one place that decides what may be printed: data on stdout, talk on stderr.

use std::io::{self, IsTerminal, Write};

use serde_json::{Map, Value};

/// Name and version of the JSON form; changes only when a field changes its meaning or goes.
pub const SCHEMA: &str = "profidrive/1";

/// A colour with its meaning. Colour is never the only sign: words or a mark stand beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// A fault or an error.
    Fault,
    /// A warning.
    Warning,
    /// Normal operation.
    Normal,
    /// The user has to do something.
    Action,
    /// Less important.
    Faint,
    /// A heading.
    Strong,
}

impl Colour {
    const fn code(self) -> &'static str {
        match self {
            Self::Fault => "31",
            Self::Warning => "33",
            Self::Normal => "32",
            Self::Action => "34",
            Self::Faint => "2",
            Self::Strong => "1",
        }
    }
}

/// Where and how to print.
#[derive(Debug, Clone)]
pub struct Output {
    json: bool,
    quiet: bool,
    colour_out: bool,
    colour_err: bool,
    live: bool,
}

impl Output {
    /// From the options, the environment and what stdout and stderr are.
    pub fn new(json: bool, quiet: bool) -> Self {
        let colour = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
            && std::env::var_os("TERM").is_none_or(|term| term != "dumb");
        Self {
            json,
            quiet,
            colour_out: colour && io::stdout().is_terminal(),
            colour_err: colour && io::stderr().is_terminal(),
            live: io::stdout().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb"),
        }
    }

    /// True when data goes out as JSON.
    pub const fn json(&self) -> bool {
        self.json
    }

    /// True when a view may overwrite itself: a terminal, people reading.
    pub const fn live(&self) -> bool {
        self.live && !self.json && !self.quiet
    }

    /// True when progress may be drawn on stderr.
    pub fn progress(&self) -> bool {
        !self.quiet && !self.json && io::stderr().is_terminal()
    }

    /// `text` in `colour` for stdout, plain where colour is off.
    pub fn paint(&self, colour: Colour, text: &str) -> String {
        paint(self.colour_out, colour, text)
    }

    /// Prints one line of data.
    pub fn line(&self, text: &str) {
        write_out(&format!("{text}\n"));
    }

    /// Prints data that ends its own lines.
    pub fn raw(&self, text: &str) {
        write_out(text);
    }

    /// Prints one JSON document with the schema in front, on one line.
    pub fn document(&self, command: &str, fields: Map<String, Value>) {
        write_out(&format!("{}\n", document(command, fields)));
    }

    /// Says something to the person, not to a program that reads along.
    pub fn say(&self, text: &str) {
        if !self.quiet {
            write_err(&format!("{text}\n"));
        }
    }

    /// Says something that must be seen, also with `--quiet`.
    pub fn warn(&self, text: &str) {
        write_err(&format!(
            "{} {text}\n",
            paint(self.colour_err, Colour::Warning, "warning:")
        ));
    }

    /// Prints an error and what to do about it.
    pub fn error(&self, message: &str, hint: Option<&str>) {
        write_err(&format!(
            "{} {message}\n",
            paint(self.colour_err, Colour::Fault, "error:")
        ));
        if let Some(hint) = hint {
            write_err(&format!(
                "  {} {hint}\n",
                paint(self.colour_err, Colour::Action, "hint:")
            ));
        }
    }
}

/// A JSON document as one line of text.
pub fn document(command: &str, fields: Map<String, Value>) -> String {
    let mut all = Map::new();
    all.insert("schema".into(), SCHEMA.into());
    all.insert("command".into(), command.into());
    all.extend(fields);
    Value::Object(all).to_string()
}

/// Makes a JSON object from fields.
#[macro_export]
macro_rules! fields {
    ($($name:literal : $value:expr),* $(,)?) => {{
        #[allow(unused_mut)]
        let mut map = serde_json::Map::new();
        $( map.insert($name.into(), serde_json::Value::from($value)); )*
        map
    }};
}

fn paint(on: bool, colour: Colour, text: &str) -> String {
    if on {
        format!("\x1b[{}m{text}\x1b[0m", colour.code())
    } else {
        text.to_owned()
    }
}

/// A reader that went away (`| head`) ends the program quietly; the drive is stopped by the command's own end.
fn write_out(text: &str) {
    let mut out = io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

fn write_err(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn documents_carry_their_schema_first() {
        let text = document("scan", fields! { "stations": Vec::<Value>::new() });
        assert!(text.contains(r#""schema":"profidrive/1""#), "{text}");
        assert!(text.contains(r#""command":"scan""#), "{text}");
    }

    #[test]
    fn paint_is_plain_when_off() {
        assert_eq!(paint(false, Colour::Fault, "F702"), "F702");
        assert_eq!(paint(true, Colour::Fault, "F702"), "\x1b[31mF702\x1b[0m");
    }
}
