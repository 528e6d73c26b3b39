//! The one place that prints: data on stdout, talk on stderr. Everything is cleaned here, so that no text from a network,
//! a file or another program moves the cursor, hides or turns what is beside it, or passes for a line of this program.
//! `clippy.toml` forbids all other ways to print.

mod clean;
mod progress;
mod shared;

use std::hash::{BuildHasher, RandomState};
use std::io::{self, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use serde::Serialize;
use serde_json::{Map, Value};

use self::clean::{clean_json, clean_lines, clean_styled};
use crate::advice;
use crate::failure::Failure;
use crate::render::Page;
use crate::render::table::Table;

pub use self::clean::clean;
pub use self::progress::{bar, bytes, spinner, steps};
pub use self::shared::Shared;

/// Name and version of the JSON form.
pub use profidrive::report::SCHEMA;

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
    const ALL: [Self; 6] = [
        Self::Fault,
        Self::Warning,
        Self::Normal,
        Self::Action,
        Self::Faint,
        Self::Strong,
    ];

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

/// Whether output has colours.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Colours {
    /// On a terminal.
    #[default]
    Auto,
    /// Also in files and pipes.
    Always,
    /// Nowhere.
    Never,
}

/// Where and how to print.
#[derive(Debug, Clone)]
pub struct Output {
    json: bool,
    quiet: bool,
    verbose: bool,
    colour_out: bool,
    colour_err: bool,
    live: bool,
    /// Stands before each colour in text that is not printed yet. It is random, so that no foreign text has it.
    mark: Arc<str>,
    held: Arc<Mutex<Held>>,
    /// Stdout is closed or cannot be written.
    closed: Arc<AtomicBool>,
    /// The command that reports: `read`, `gsdml show`.
    command: String,
    /// The drive as the person called it, for advice.
    drive: Option<String>,
}

/// The JSON that a command collects until it ends.
#[derive(Debug, Default)]
struct Held {
    /// Its document.
    document: Option<Map<String, Value>>,
    /// What went wrong beside the failure that ends it.
    problems: Vec<Map<String, Value>>,
    /// Why what should have been printed was not.
    lost: Option<String>,
}

impl Output {
    /// From the options, the environment and what stdout and stderr are.
    #[expect(clippy::disallowed_methods, reason = "asks only what stdout and stderr are")]
    pub fn new(json: bool, quiet: bool) -> Self {
        let colour = Self::may_colour();
        Self {
            json,
            quiet,
            verbose: false,
            colour_out: colour && io::stdout().is_terminal(),
            colour_err: colour && io::stderr().is_terminal(),
            live: io::stdout().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb"),
            mark: format!("\u{1b}{:016x}", RandomState::new().hash_one("mark")).into(),
            held: Arc::default(),
            closed: Arc::default(),
            command: String::new(),
            drive: None,
        }
    }

    /// Returns the same with the colours of the configuration. NO_COLOR and a terminal that has none come first.
    #[must_use]
    pub fn coloured(mut self, colours: Colours) -> Self {
        let (out, err) = match colours {
            Colours::Auto => (self.colour_out, self.colour_err),
            Colours::Always => (Self::may_colour(), Self::may_colour()),
            Colours::Never => (false, false),
        };
        (self.colour_out, self.colour_err) = (out, err);
        self
    }

    /// Whether the environment permits colours.
    fn may_colour() -> bool {
        std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
            && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
    }

    /// Returns the same for a command, which its documents then name.
    #[must_use]
    pub fn of_command(mut self, command: String) -> Self {
        self.command = command;
        self
    }

    /// The same for a command on `drive`, which advice then names.
    #[must_use]
    pub fn about(mut self, drive: Option<&str>) -> Self {
        self.drive = drive.map(str::to_owned);
        self
    }

    /// The same, which also prints how drives are reached if `verbose`.
    #[must_use]
    pub const fn with_details(mut self, verbose: bool) -> Self {
        self.verbose = verbose;
        self
    }

    /// True when details are printed.
    pub const fn verbose(&self) -> bool {
        self.verbose
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
    #[expect(clippy::disallowed_methods, reason = "asks only what stderr is")]
    pub fn progress(&self) -> bool {
        !self.quiet && !self.json && io::stderr().is_terminal()
    }

    /// `text` in `colour` for stdout, plain where colour is off.
    pub fn paint(&self, colour: Colour, text: &str) -> String {
        if self.colour_out {
            let mark = &self.mark;
            format!("{mark}{};{text}{mark}0;", colour.code())
        } else {
            text.to_owned()
        }
    }

    /// Prints one line of data; a line break in it is shown as `\n`.
    pub fn line(&self, text: &str) {
        self.write_out(&format!("{}\n", self.rendered(text)));
    }

    /// Prints a table; nothing where it has no row.
    pub fn table(&self, table: &Table) {
        if !table.is_empty() {
            for line in table.lines() {
                self.line(&line);
            }
        }
    }

    /// Prints data that ends its own lines.
    pub fn raw(&self, text: &str) {
        self.write_out(&clean_lines(text));
    }

    /// Prints candidates for the completion of a line. Some shells have them divided by vertical tabs.
    pub fn candidates(&self, text: &str) {
        let parts: Vec<String> = text.split('\u{b}').map(clean_lines).collect();
        self.write_out(&parts.join("\u{b}"));
    }

    /// Prints a view that replaces the `drawn` lines before; lines longer than the terminal are cut, not wrapped, so that
    /// the view keeps its height.
    pub fn picture(&self, drawn: usize, lines: &[String]) {
        let up = if drawn > 0 {
            format!("\x1b[{drawn}A")
        } else {
            String::new()
        };
        let lines = lines
            .iter()
            .map(|line| format!("\r\x1b[K{}\n", self.rendered(line)));
        self.write_out(&format!("{up}\x1b[?7l{}\x1b[?7h", lines.collect::<String>()));
    }

    /// Prints text of the reader of the command line: help and version.
    pub fn styled(&self, text: &clap::builder::StyledStr) {
        self.write_out(&styled(text, self.colour_out));
    }

    /// Prints text of the reader of the command line that is a mistake.
    pub fn styled_error(&self, text: &clap::builder::StyledStr) {
        write_err(&styled(text, self.colour_err));
    }

    /// Cleans a line and puts in the colours that [`paint`](Self::paint) marked.
    fn rendered(&self, text: &str) -> String {
        let mut pieces = text.split(&*self.mark);
        let mut line = clean(pieces.next().unwrap_or_default());
        for piece in pieces {
            let Some((code, rest)) = piece.split_once(';') else {
                continue;
            };
            if code == "0" || Colour::ALL.iter().any(|colour| colour.code() == code) {
                line += &format!("\x1b[{code}m");
            }
            line += &clean(rest);
        }
        line
    }

    /// Prints the one report of a command: as lines, or as a JSON document when the command ends, with its error in it.
    pub fn report(&self, report: &impl Page) {
        self.json_report(report);
        if !self.json {
            report.print(self);
        }
    }

    /// Prints the one report of a command that prints the same as text.
    pub fn json_report(&self, report: &impl Serialize) {
        if self.json {
            self.document(&self.command, members(report));
        }
    }

    /// Prints one of the reports of a command that has many, at once: as lines, or as a JSON document in a line of its own
    /// (JSON Lines).
    pub fn report_event(&self, report: &impl Page) {
        self.json_event(report);
        if !self.json {
            report.print(self);
        }
    }

    /// Prints a report for programs only, as a JSON document in a line of its own.
    pub fn json_event(&self, report: &impl Serialize) {
        if self.json {
            self.event(&self.command, members(report));
        }
    }

    /// Takes the one JSON document of a command. It is printed when the command ends, with what went wrong in it.
    pub fn document(&self, command: &str, fields: Map<String, Value>) {
        let earlier = self.held().document.replace(with_schema(command, fields));
        // nothing that was printed is lost
        if let Some(earlier) = earlier {
            self.write_json(&Value::Object(earlier).to_string());
        }
    }

    /// Prints one JSON document of a command that has many, at once and on a line of its own (JSON Lines).
    pub fn event(&self, command: &str, fields: Map<String, Value>) {
        self.write_json(&document(command, fields));
    }

    /// Prints a failure while the command continues; it ends with another failure.
    pub fn problem(&self, failure: &Failure) {
        self.error(failure);
        if self.json {
            self.held().problems.push(failure.json(self.drive()));
        }
    }

    /// Ends the command: prints the failure, unless it was printed already, and the document.
    pub fn end(&self, failure: Option<&Failure>) {
        let failure = failure.filter(|failure| !failure.message.is_empty());
        if self.json
            && let Some(whole) = self.ending(failure)
        {
            self.write_json(&Value::Object(whole).to_string());
        }
        if let Some(failure) = failure {
            self.error(failure);
        }
    }

    /// Prints the document of a failure that the person was shown already.
    pub fn fail(&self, failure: &Failure) {
        if self.json
            && let Some(whole) = self.ending(Some(failure))
        {
            self.write_json(&Value::Object(whole).to_string());
        }
    }

    /// The last document: that of the command with its failure, or that of the failure alone.
    fn ending(&self, failure: Option<&Failure>) -> Option<Map<String, Value>> {
        let (document, problems) = {
            let mut held = self.held();
            (held.document.take(), std::mem::take(&mut held.problems))
        };
        let Some(failure) = failure else { return document };
        let mut whole = document.unwrap_or_else(|| with_schema(&self.command, Map::new()));
        let error = failure.json(self.drive());
        whole.insert("error".into(), error.clone().into());
        if !problems.is_empty() {
            let all = problems.into_iter().chain([error]);
            whole.insert("errors".into(), all.map(Value::Object).collect());
        }
        Some(whole)
    }

    /// The drive in advice.
    fn drive(&self) -> &str {
        self.drive.as_deref().unwrap_or("DRIVE")
    }

    fn held(&self) -> std::sync::MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Why the output is not complete: the disk is full, for example. A reader who had enough (`| head`) is no reason.
    pub fn lost(&self) -> Option<Failure> {
        let lost = self.held().lost.take()?;
        Some(Failure::new(
            client::ErrorKind::Local,
            format!("the output cannot be written: {lost}"),
        ))
    }

    /// Returns true once stdout is closed (`| head`) or cannot be written. Motion without visible output must not
    /// continue: waiting calls treat it as a stop.
    pub fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Relaxed)
    }

    fn write_json(&self, json: &str) {
        self.write_out(&format!("{}\n", clean_json(json)));
    }

    #[expect(clippy::disallowed_methods, reason = "the one place that writes to stdout")]
    fn write_out(&self, text: &str) {
        let mut out = io::stdout().lock();
        let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) else {
            return;
        };
        drop(out);
        self.closed.store(true, Ordering::Relaxed);
        if error.kind() != io::ErrorKind::BrokenPipe {
            self.held().lost.get_or_insert_with(|| error.to_string());
        }
    }

    /// Says something to the person, not to a program that reads along.
    pub fn say(&self, text: &str) {
        if !self.quiet {
            write_err(&format!("{}\n", clean(text)));
        }
    }

    /// Prints a detail, with `--verbose` only.
    pub fn detail(&self, text: &str) {
        if self.verbose {
            write_err(&format!("{}\n", clean(text)));
        }
    }

    /// Asks the person, who answers on the same line.
    pub fn ask(&self, question: &str) {
        write_err(&format!("{} ", clean(question)));
    }

    /// Says something that must be seen, also with `--quiet`.
    pub fn warn(&self, text: &str) {
        write_err(&format!(
            "{} {}\n",
            paint(self.colour_err, Colour::Warning, "warning:"),
            clean(text)
        ));
    }

    /// Prints an error and what to do about it.
    pub fn error(&self, failure: &Failure) {
        for line in self.error_lines(failure) {
            write_err(&(line + "\n"));
        }
    }

    /// The message and the hint are one line each, so that nothing in them can pass for a line of this program.
    fn error_lines(&self, failure: &Failure) -> Vec<String> {
        let sign = paint(self.colour_err, Colour::Fault, "error:");
        let mut lines = vec![format!("{sign} {}", clean(&failure.message))];
        lines.extend(
            failure
                .details
                .iter()
                .map(|detail| format!("    {}", clean(detail))),
        );
        if !failure.hint.is_empty() {
            let sign = paint(self.colour_err, Colour::Action, "hint:");
            let hint = advice::text(&failure.hint, self.drive());
            lines.push(format!("  {sign} {}", clean(&hint)));
        }
        lines
    }
}

/// The fields of a report.
pub fn members(report: &impl Serialize) -> Map<String, Value> {
    match serde_json::to_value(report) {
        Ok(Value::Object(fields)) => fields,
        // no report is anything else
        Ok(other) => Map::from_iter([("value".to_owned(), other)]),
        Err(error) => Map::from_iter([("value".to_owned(), error.to_string().into())]),
    }
}

/// A JSON document as one line of text.
pub fn document(command: &str, fields: Map<String, Value>) -> String {
    Value::Object(with_schema(command, fields)).to_string()
}

fn with_schema(command: &str, fields: Map<String, Value>) -> Map<String, Value> {
    let head = [("schema", SCHEMA), ("command", command)];
    let head = head.map(|(name, text)| (name.to_owned(), Value::from(text)));
    head.into_iter().chain(fields).collect()
}

fn paint(on: bool, colour: Colour, text: &str) -> String {
    if on {
        format!("\x1b[{}m{text}\x1b[0m", colour.code())
    } else {
        text.to_owned()
    }
}

fn styled(text: &clap::builder::StyledStr, colour: bool) -> String {
    if colour {
        clean_styled(&text.ansi().to_string())
    } else {
        clean_lines(&text.to_string())
    }
}

#[expect(clippy::disallowed_methods, reason = "the one place that writes to stderr")]
fn write_err(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(name: &str) -> Map<String, Value> {
        Map::from_iter([(name.to_owned(), Value::Array(Vec::new()))])
    }

    #[test]
    fn documents_carry_their_schema_first() {
        let text = document("scan", list("stations"));
        assert!(text.contains(r#""schema":"profidrive/1""#), "{text}");
        assert!(text.contains(r#""command":"scan""#), "{text}");
    }

    #[test]
    fn a_command_prints_one_document_with_its_error() {
        use client::ErrorKind;
        let output = Output::new(true, true).of_command("read".into());
        output.document("read", list("parameters"));
        output.problem(&Failure::usage("no such name"));
        let failure = Failure::new(ErrorKind::Refused, "it said no").hint("ask again");
        let whole = output.ending(Some(&failure)).unwrap();
        assert_eq!(
            (&whole["command"], &whole["error"]["kind"]),
            (&"read".into(), &"refused".into())
        );
        assert_eq!(whole["error"]["hint"], "ask again");
        assert_eq!(whole["errors"].as_array().map(Vec::len), Some(2));
        assert_eq!(whole["errors"][0]["message"], "no such name");
        assert_eq!(output.ending(None), None);
        let single = output.ending(Some(&failure)).unwrap();
        assert_eq!(
            (&single["command"], single.contains_key("errors")),
            (&"read".into(), false)
        );
    }

    #[test]
    fn an_error_is_one_line_whatever_names_are_in_it() {
        let output = Output::new(false, true);
        let mut failure = Failure::usage("bad\nerror: forged").hint("see\nerror: forged");
        failure.details = vec!["line 3: no\nerror: forged".into()];
        let lines = output.error_lines(&failure);
        assert!(!lines.iter().any(|line| line.contains('\n')), "{lines:?}");
        let plain = |line: &str| line.replace(|c: char| !c.is_ascii_graphic(), "");
        assert!(plain(&lines[0]).ends_with("bad\\nerror:forged"), "{lines:?}");
        assert_eq!(lines[1], "    line 3: no\\nerror: forged");
        assert!(lines[2].ends_with("see\\nerror: forged"), "{lines:?}");
    }

    #[test]
    fn own_colours_reach_the_terminal_and_foreign_ones_do_not() {
        let mut output = Output::new(false, false);
        output.colour_out = true;
        let name = "x\x1b[31m\u{1b}0123456789abcdef31;y\n";
        let line = format!("{} {name}", output.paint(Colour::Fault, name));
        let shown = "x\\u{1b}[31m\\u{1b}0123456789abcdef31;y\\n";
        assert_eq!(output.rendered(&line), format!("\x1b[31m{shown}\x1b[0m {shown}"));
        let other = Output::new(false, false);
        assert_ne!(output.mark, other.mark);
        assert!(!other.rendered(&line).contains('\x1b'));
    }

    #[test]
    fn paint_is_plain_when_off() {
        assert_eq!(paint(false, Colour::Fault, "F702"), "F702");
        assert_eq!(paint(true, Colour::Fault, "F702"), "\x1b[31mF702\x1b[0m");
    }
}
