//! Parses a backup. The text is untrusted: edited, truncated, or written by another program.

use std::collections::HashMap;
use std::fmt;

use profile::catalogue::{Parameter, Scaling};
use profile::notation::setting::{Entry, Problem, Settings, shorten};
use profile::notation::{Elements, ParameterReference, Quantity, Target};
use profile::parameter::{CodeSpace, Format};
use profile::unit::UnitChoice;

use super::header::Header;
use super::nearest::nearest;
use super::print::{FORM, plain};
use super::task::{self, Name};
use super::{Backup, Task, key};
use profile::value::{Interpretation, ParameterProblem, Parameters, Reading, Selection};

/// Most mistakes that are reported at once.
const MOST_PROBLEMS: usize = 20;
/// Most octets of one value.
const MAX_VALUE: usize = 240;

/// Why a text is not a backup; nothing of it is used then.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BackupError {
    /// The mistakes in the order of the lines, at most 20.
    pub problems: Vec<Problem>,
}

impl From<Problem> for BackupError {
    fn from(problem: Problem) -> Self {
        Self {
            problems: vec![problem],
        }
    }
}

impl fmt::Display for BackupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, problem) in self.problems.iter().enumerate() {
            if at > 0 {
                f.write_str("; ")?;
            }
            problem.fmt(f)?;
        }
        Ok(())
    }
}

impl std::error::Error for BackupError {}

/// A line `PARAM = VALUE`, not looked at yet.
struct Line {
    number: usize,
    what: String,
    value: String,
}

impl Backup {
    /// Reads the text or the octets of a file.
    ///
    /// # Errors
    /// Every line that is wrong, with its number. A backup with a mistake in it is not used at all.
    pub fn read(file: impl AsRef<[u8]>) -> Result<Self, BackupError> {
        Self::of(FORM.read(file.as_ref())?)
    }

    /// What the lines of a text say.
    pub(crate) fn of(settings: Settings) -> Result<Self, BackupError> {
        let mut header = Header::default();
        let mut scaling = None;
        let mut lines = Vec::new();
        let mut units = None;
        let mut problems = Vec::new();
        for line in settings.lines {
            let number = line.number;
            match line.entry {
                Entry::Setting { name: what, value } => lines.push(Line { number, what, value }),
                Entry::Head { key, value } => {
                    let taken = header.take(&key, &value, &mut scaling, &mut units);
                    problems.extend(taken.err().map(|what| Problem::new(number, what)));
                }
                Entry::Words(words) => {
                    let words = shorten(&words);
                    let what = format!("`{words}` is neither PARAM = VALUE nor a line of the head");
                    problems.push(Problem::new(number, what));
                }
            }
            if problems.len() >= MOST_PROBLEMS {
                return Err(BackupError { problems });
            }
        }
        let parameters = Parameters {
            catalogue: header.known().catalogue,
            scaling: Scaling {
                unit: units.unwrap_or(UnitChoice::DELIVERED),
                ..scaling.unwrap_or_default()
            },
        };
        let (of_tasks, lines): (Vec<_>, Vec<_>) = lines
            .into_iter()
            .partition(|line| Name::parse(&line.what).is_some());
        let readings = read_lines(&lines, &parameters, scaling.is_some(), &mut problems);
        let mut problems_of_tasks = Vec::new();
        let tasks = read_tasks(&of_tasks, &parameters, scaling.is_some(), &mut problems_of_tasks);
        problems.append(&mut problems_of_tasks);
        if !problems.is_empty() {
            problems.sort_by_key(|problem| problem.line);
            problems.truncate(MOST_PROBLEMS);
            return Err(BackupError { problems });
        }
        let mut backup = Self::new(header, parameters, readings.into_iter().map(Ok));
        for (number, task) in tasks {
            backup.put_task(number, task);
        }
        Ok(backup)
    }
}

fn read_lines(
    lines: &[Line],
    parameters: &Parameters,
    scaled: bool,
    problems: &mut Vec<Problem>,
) -> Vec<Reading> {
    let mut readings = Vec::new();
    let mut seen: HashMap<(u16, Option<u16>), usize> = HashMap::new();
    for line in lines {
        let read = read_line(line, parameters, scaled).and_then(|reading| {
            match seen.insert(key(&reading), line.number) {
                Some(before) => Err(format!("{} stands in line {before} already", line.what)),
                None => Ok(reading),
            }
        });
        match read {
            Ok(reading) => readings.push(reading),
            Err(what) => problems.push(Problem::new(line.number, what)),
        }
        if problems.len() >= MOST_PROBLEMS {
            break;
        }
    }
    readings
}

fn read_tasks(
    lines: &[Line],
    parameters: &Parameters,
    scaled: bool,
    problems: &mut Vec<Problem>,
) -> Vec<(u16, Task)> {
    let mut seen: HashMap<u16, usize> = HashMap::new();
    let mut tasks = Vec::new();
    for line in lines {
        let number = Name::parse(&line.what).unwrap_or_else(|| Err(String::new()));
        let read = number.and_then(|number| {
            let task = task::parse(number, &line.value, parameters, |text, parameter| {
                self::number(text, parameter, parameter.name, parameters, scaled)
            })?;
            match seen.insert(number, line.number) {
                Some(before) => Err(format!("{} stands in line {before} already", line.what)),
                None => Ok((number, task)),
            }
        });
        match read {
            Ok(task) => tasks.push(task),
            Err(what) => problems.push(Problem::new(line.number, what)),
        }
        if problems.len() >= MOST_PROBLEMS {
            break;
        }
    }
    tasks
}

fn read_line(line: &Line, parameters: &Parameters, scaled: bool) -> Result<Reading, String> {
    let selection = select(&line.what, parameters)?;
    let Some(parameter) = selection.parameter else {
        let octets = hex_octets(&line.value)?;
        let format = format_of(octets.len());
        return Ok(reading(parameters, &selection, format, octets));
    };
    let label = selection.label();
    if parameter.length > 0 {
        let octets = hex_octets(&line.value)?;
        return Ok(reading(parameters, &selection, parameter.format, octets));
    }
    let raw = number(&line.value, parameter, &label, parameters, scaled)?;
    let width = parameter.octets();
    let octets = raw.to_be_bytes();
    let octets = octets.get(octets.len() - width..).unwrap_or_default().to_vec();
    Ok(reading(
        parameters,
        &selection,
        Format(parameter.size.format_code()),
        octets,
    ))
}

fn reading(parameters: &Parameters, selection: &Selection, format: Format, octets: Vec<u8>) -> Reading {
    let interpretation = Interpretation::of(format, CodeSpace::V4);
    parameters.reading(selection, 0, format.0, interpretation, &octets)
}

/// `p2108 DRV.ACC`, `p2108`, `DRV.ACC`, `p0915[3]`: number and name, where both stand there, mean the same.
fn select(text: &str, parameters: &Parameters) -> Result<Selection, String> {
    let (first, rest) = number_and_name(text);
    let by_number = first
        .parse::<ParameterReference>()
        .ok()
        .filter(|reference| matches!(reference.target, Target::Number(_)));
    let (reference, name) = match by_number {
        Some(reference) => (reference, rest.trim()),
        None => (named(text)?, ""),
    };
    let mut selection = parameters
        .select(&reference)
        .map_err(|problem| explained(&problem))?;
    let array = selection.indexed && selection.parameter.is_none_or(Parameter::is_array);
    if selection.count != 1 || (array && reference.elements.is_none()) {
        return Err(format!("{}: one element in each line", selection.label()));
    }
    // an element of a parameter that is not an array is the parameter itself
    if selection
        .parameter
        .is_some_and(|parameter| !parameter.is_array() && parameter.base.is_none())
    {
        selection.indexed = false;
    }
    let known = selection.parameter.map(|parameter| parameter.name);
    match known {
        Some(known) if !name.is_empty() && !plain(known).eq_ignore_ascii_case(name) => Err(format!(
            "{} is {known}, not {}: one of number and name is wrong",
            selection.shown(0),
            shorten(name)
        )),
        _ => Ok(selection),
    }
}

/// Returns the number in front and what follows it: `p2108`, `1-20`, `ID 103`.
fn number_and_name(text: &str) -> (&str, &str) {
    let blank = |text: &str| text.find(char::is_whitespace).unwrap_or(text.len());
    let (first, rest) = text.split_at(blank(text));
    if !first.eq_ignore_ascii_case("id") {
        return (first, rest);
    }
    let start = first.len() + (rest.len() - rest.trim_start().len());
    let id = text.get(start..).unwrap_or_default();
    text.split_at(start + blank(id))
}

/// Returns a name that may have blanks in it, and its element.
fn named(text: &str) -> Result<ParameterReference, String> {
    let (name, elements) = match text.strip_suffix(']').and_then(|text| text.rsplit_once('[')) {
        Some((name, element)) => {
            let first = element
                .trim()
                .parse()
                .map_err(|_| format!("`{}` is not a valid array element", shorten(element)))?;
            (name.trim(), Some(Elements { first, count: 1 }))
        }
        None => (text, None),
    };
    if name.is_empty() {
        return Err("a value without a parameter".to_owned());
    }
    Ok(ParameterReference {
        target: Target::Name(shorten(name)),
        elements,
        prefix: None,
    })
}

fn explained(problem: &ParameterProblem) -> String {
    match problem.hint() {
        Some(hint) => format!("{problem}; {hint}"),
        None => problem.to_string(),
    }
}

/// Returns the number on the wire: out of the value in its unit, or the raw one where that stands there too and agrees.
fn number(
    text: &str,
    parameter: &'static Parameter,
    label: &str,
    parameters: &Parameters,
    scaled: bool,
) -> Result<i64, String> {
    let problem_text = |problem: &dyn fmt::Display| format!("{label}: {problem}");
    let (text, raw) = match text.strip_suffix(')').and_then(|text| text.rsplit_once("(raw ")) {
        Some((text, raw)) => (
            text.trim(),
            Some(raw_number(raw.trim(), parameter).map_err(|e| problem_text(&e))?),
        ),
        None => (text, None),
    };
    if text.starts_with("0x") || text.starts_with("0X") {
        return raw_number(text, parameter).map_err(|error| problem_text(&error));
    }
    if !scaled && !parameter.scale.is_fixed() {
        return Err(problem_text(
            &"the line `scaling:` of the head is needed to read it",
        ));
    }
    let quantity: Quantity = text.parse().map_err(|error| problem_text(&error))?;
    let value = parameter
        .quantity(&quantity, &parameters.scaling)
        .map_err(|error| problem_text(&error))?;
    let nearest = nearest(value, parameter, &parameters.scaling).map_err(|error| problem_text(&error))?;
    match raw {
        None => Ok(nearest),
        Some(raw) if raw == nearest => Ok(raw),
        Some(raw) => Err(problem_text(&format!(
            "{text} is not the raw value beside it, which is {}: remove the one that is wrong",
            parameter.engineering(raw, &parameters.scaling)
        ))),
    }
}

fn raw_number(text: &str, parameter: &Parameter) -> Result<i64, String> {
    let digits = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let raw = digits
        .filter(|digits| digits.bytes().all(|b| b.is_ascii_hexdigit()))
        .and_then(|digits| u64::from_str_radix(digits, 16).ok())
        .ok_or_else(|| format!("`{}` is not a raw value such as 0x002D", shorten(text)))?;
    if let (true, true, Ok(low)) = (
        parameter.wide,
        digits.is_some_and(|d| d.len() <= 8),
        u32::try_from(raw),
    ) {
        return Ok(parameter.low_word(low)); // of a drive that knows the low half only
    }
    let bits = 8 * u32::try_from(parameter.octets()).unwrap_or(8);
    if bits < 64 && raw >> bits != 0 {
        return Err(format!("0x{raw:X} does not fit its {} octets", bits / 8));
    }
    let shift = 64 - bits;
    Ok(if parameter.signed {
        (raw << shift).cast_signed() >> shift
    } else {
        raw.cast_signed() // the octets are meant
    })
}

/// Returns the octets of a value of which nothing is known.
fn hex_octets(text: &str) -> Result<Vec<u8>, String> {
    let form = || {
        format!(
            "`{}`: nothing is known about this parameter, its value is written as octets: 0x002D",
            shorten(text)
        )
    };
    let digits = text.strip_prefix("0x").ok_or_else(form)?;
    if digits.len() % 2 != 0 || digits.len() / 2 > MAX_VALUE || !digits.bytes().all(|b| b.is_ascii_hexdigit())
    {
        return Err(form());
    }
    let octet = |pair: &[u8]| {
        std::str::from_utf8(pair)
            .ok()
            .and_then(|pair| u8::from_str_radix(pair, 16).ok())
    };
    digits
        .as_bytes()
        .chunks(2)
        .map(|pair| octet(pair).ok_or_else(form))
        .collect()
}

/// Byte, word, double word or octets: what the drive says counts when it is written.
const fn format_of(octets: usize) -> Format {
    match octets {
        1 => Format::BYTE,
        2 => Format::WORD,
        4 => Format::DOUBLE_WORD,
        _ => Format::OCTET_STRING,
    }
}
