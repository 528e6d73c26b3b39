//! From octets to text: encoding, limits before anything is built, positions.

use alloc::borrow::Cow;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use crate::problem::{Position, Problem, Rule, Severity};

/// Largest file in octets.
pub const MOST_OCTETS: usize = 32 << 20;
/// Deepest nesting of elements.
pub const MOST_DEPTH: usize = 32;
/// Most elements and texts of a file.
pub const MOST_NODES: u32 = 1_000_000;
/// Most attributes of one element.
const MOST_ATTRIBUTES: usize = 128;
/// Longest part of a line in which characters are counted; behind it octets are.
const COUNTED: usize = 1 << 16;

/// The text of a file.
#[derive(Debug)]
pub(crate) struct Source<'a> {
    pub text: Cow<'a, str>,
    /// First octet of each line.
    lines: Vec<usize>,
    /// First octet of the innermost mark or element that is not finished when the file ends.
    unfinished: Option<usize>,
}

impl<'a> Source<'a> {
    /// Decodes the octets and goes through all marks once.
    pub fn new(octets: &'a [u8]) -> Result<Self, Problem> {
        let text = decode(octets)?;
        let starts = text.bytes().enumerate().filter(|(_, octet)| *octet == b'\n');
        let lines = core::iter::once(0).chain(starts.map(|(at, _)| at + 1)).collect();
        let mut source = Self {
            text,
            lines,
            unfinished: None,
        };
        source.unfinished =
            scan(&source.text).map_err(|(at, rule, message)| source.problem(at, rule, message))?;
        Ok(source)
    }

    /// Returns the problem for a truncated file: its position and the unfinished element.
    pub fn cut_off(&self) -> Problem {
        let end = self.text.trim_end().len();
        let message = match self.unfinished {
            None => "the file ends here, and there is no element in it".into(),
            Some(at) => {
                let rest = self.text.get(at..).unwrap_or_default();
                let name = rest.get(1..).unwrap_or_default();
                let length = name.find(|c: char| c.is_whitespace() || "<>/=".contains(c));
                let name = name.get(..length.unwrap_or(name.len())).unwrap_or_default();
                let name = crate::value::shortened(name);
                let begin = self.position(at);
                format!("the file ends here, but `<{name}` of {begin} is not finished: it may be cut off")
            }
        };
        self.problem(end, Rule::Xml, message)
    }

    /// Returns the place of an octet.
    pub fn position(&self, at: usize) -> Position {
        let line = self.lines.partition_point(|start| *start <= at).max(1);
        let start = self.lines.get(line - 1).copied().unwrap_or(0);
        let before = self.text.get(start..at).unwrap_or_default();
        let column = if before.len() > COUNTED {
            before.len()
        } else {
            before.chars().count()
        };
        let number = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Position {
            line: number(line),
            column: number(column + 1),
        }
    }

    fn problem(&self, at: usize, rule: Rule, message: String) -> Problem {
        Problem {
            severity: Severity::Unusable,
            rule,
            position: self.position(at),
            message,
        }
    }
}

/// UTF-8, or ISO-8859-1 where it is declared.
fn decode(octets: &[u8]) -> Result<Cow<'_, str>, Problem> {
    let unusable = |rule, message| Problem {
        severity: Severity::Unusable,
        rule,
        position: Position { line: 1, column: 1 },
        message,
    };
    if octets.len() > MOST_OCTETS {
        let message = format!("{} octets; at most {MOST_OCTETS} are read", octets.len());
        return Err(unusable(Rule::Limit, message));
    }
    if octets.starts_with(&[0xFE, 0xFF]) || octets.starts_with(&[0xFF, 0xFE]) {
        let message = "the encoding is UTF-16; GSDML is UTF-8 or ISO-8859-1".into();
        return Err(unusable(Rule::Encoding, message));
    }
    let octets = octets.strip_prefix(&[0xEF, 0xBB, 0xBF]).unwrap_or(octets);
    let named = encoding(octets).unwrap_or("utf-8");
    match &*named.to_ascii_lowercase() {
        "utf-8" | "us-ascii" => match core::str::from_utf8(octets) {
            Ok(text) => Ok(Cow::Borrowed(text)),
            Err(error) => {
                let good = octets.get(..error.valid_up_to()).unwrap_or_default();
                let good = core::str::from_utf8(good).unwrap_or_default();
                let line = good.matches('\n').count() + 1;
                let column = good.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
                let number = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
                Err(Problem {
                    position: Position {
                        line: number(line),
                        column: number(column),
                    },
                    ..unusable(
                        Rule::Encoding,
                        "an octet is not valid UTF-8, the declared encoding of the file".into(),
                    )
                })
            }
        },
        "iso-8859-1" | "iso8859-1" | "latin1" => {
            if octets.is_ascii() {
                return core::str::from_utf8(octets)
                    .map(Cow::Borrowed)
                    .map_err(|_| unusable(Rule::Encoding, "no text".into()));
            }
            Ok(Cow::Owned(
                octets.iter().map(|octet| char::from(*octet)).collect(),
            ))
        }
        _ => Err(unusable(
            Rule::Encoding,
            format!(
                "encoding `{}`; GSDML is UTF-8 or ISO-8859-1",
                crate::value::shortened(named)
            ),
        )),
    }
}

/// Returns the encoding the XML declaration names.
fn encoding(octets: &[u8]) -> Option<&str> {
    let head = octets.strip_prefix(b"<?xml")?;
    let end = head.iter().take(400).position(|octet| *octet == b'>')?;
    let head = core::str::from_utf8(head.get(..end)?).ok()?;
    let (_, after) = head.split_once("encoding")?;
    let after = after.trim_start().strip_prefix('=')?.trim_start();
    let quote = after.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    after.get(1..)?.split(quote).next()
}

type Found = (usize, Rule, String);

/// Goes over the marks once: no document type, not too deep, not too many attributes. What else is wrong with the XML
/// the reader behind it says. Gives what is not finished at the end.
fn scan(text: &str) -> Result<Option<usize>, Found> {
    let bytes = text.as_bytes();
    let mut open = Vec::new();
    let mut at = 0;
    while let Some(found) = find(bytes, at, b"<") {
        let rest = bytes.get(found..).unwrap_or_default();
        let behind = |end: &[u8]| find(bytes, found, end).map(|place| place + end.len());
        let next = if rest.starts_with(b"<!--") {
            find(bytes, found + 4, b"-->").map(|place| place + 3)
        } else if rest.starts_with(b"<![CDATA[") {
            behind(b"]]>")
        } else if rest.starts_with(b"<?") {
            behind(b"?>")
        } else if rest.starts_with(b"<!") {
            return Err((
                found,
                Rule::Entity,
                "a document type: entities and document types are not taken from a device description".into(),
            ));
        } else if rest.starts_with(b"</") {
            open.pop();
            behind(b">")
        } else {
            let (end, attributes, empty) = tag(bytes, found);
            if attributes > MOST_ATTRIBUTES {
                return Err((
                    found,
                    Rule::Limit,
                    format!("{attributes} attributes; at most {MOST_ATTRIBUTES} are read"),
                ));
            }
            if !empty {
                open.push(found);
            }
            if open.len() > MOST_DEPTH {
                return Err((
                    found,
                    Rule::Limit,
                    format!("nested deeper than {MOST_DEPTH} elements"),
                ));
            }
            end
        };
        match next {
            Some(next) => at = next,
            None => return Ok(Some(found)),
        }
    }
    Ok(open.pop())
}

/// End of a start tag, its attributes, and whether it is an end tag too.
fn tag(bytes: &[u8], start: usize) -> (Option<usize>, usize, bool) {
    let mut quote = None;
    let mut attributes = 0;
    let mut last = b' ';
    for (offset, octet) in bytes.iter().enumerate().skip(start + 1) {
        match quote {
            Some(open) if *octet == open => quote = None,
            Some(_) => {}
            None => match octet {
                b'"' | b'\'' => {
                    attributes += 1;
                    quote = Some(*octet);
                }
                b'>' => return (Some(offset + 1), attributes, last == b'/'),
                _ => {}
            },
        }
        last = *octet;
    }
    (None, attributes, true)
}

fn find(bytes: &[u8], from: usize, wanted: &[u8]) -> Option<usize> {
    let rest = bytes.get(from..)?;
    rest.windows(wanted.len())
        .position(|window| window == wanted)
        .map(|place| from + place)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &[u8]) -> (Rule, Position) {
        let problem = Source::new(text).unwrap_err();
        (problem.rule, problem.position)
    }

    #[test]
    fn encodings() {
        let latin = b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><a b=\"\xFC\"/>";
        assert!(Source::new(latin).unwrap().text.contains('ü'));
        let marked = "\u{feff}<a b=\"ü\"/>".as_bytes();
        assert!(Source::new(marked).unwrap().text.starts_with("<a"));
        assert_eq!(refused(b"\xFF\xFE<\0").0, Rule::Encoding);
        assert_eq!(
            refused(b"<?xml version='1.0' encoding = 'utf-7' ?><a/>").0,
            Rule::Encoding
        );
        let (rule, position) = refused(b"<a>\n <b c=\"\xFC\"/></a>");
        assert_eq!((rule, position.line, position.column), (Rule::Encoding, 2, 8));
    }

    #[test]
    fn hostile_marks_are_refused_before_a_tree_is_built() {
        let (rule, position) =
            refused(b"<?xml version=\"1.0\"?>\n <!DOCTYPE x [<!ENTITY a \"b\">]><x>&a;</x>");
        assert_eq!((rule, position.line, position.column), (Rule::Entity, 2, 2));
        let deep = "<a>".repeat(MOST_DEPTH + 1);
        assert_eq!(refused(deep.as_bytes()).0, Rule::Limit);
        let wide = format!("<a {}/>", "b='c' ".repeat(MOST_ATTRIBUTES + 1));
        assert_eq!(refused(wide.as_bytes()).0, Rule::Limit);
        assert_eq!(refused(&alloc::vec![b' '; MOST_OCTETS + 1]).0, Rule::Limit);
    }

    #[test]
    fn what_is_quoted_or_commented_is_no_mark() {
        for text in [
            "<a b=\"<!DOCTYPE\"/>",
            "<a><!-- <!DOCTYPE x> --><![CDATA[<!DOCTYPE]]></a>",
            "<a b='>' c=\"'\"/>",
            "<a",
            "<!--",
            "",
        ] {
            assert!(Source::new(text.as_bytes()).is_ok(), "{text}");
        }
        let flat = "<a><b/></a>".repeat(MOST_DEPTH * 3);
        assert!(Source::new(flat.as_bytes()).is_ok());
    }

    #[test]
    fn what_is_not_finished_at_the_end() {
        for (text, place, name) in [
            ("<a>\n<bc d='1'>\n</bc>\n <e>x", (4, 6), "`<e` of 4:2"),
            ("<a>\n<bc d='1", (2, 9), "`<bc` of 2:1"),
            ("<a>\n<b/>\n\n", (2, 5), "`<a` of 1:1"),
            ("<a><!-- b", (1, 10), "`<!--` of 1:4"),
            (" ", (1, 1), "no element"),
        ] {
            let problem = Source::new(text.as_bytes()).unwrap().cut_off();
            assert_eq!((problem.position.line, problem.position.column), place, "{text}");
            assert!(problem.message.contains(name), "{text}: {}", problem.message);
        }
    }

    #[test]
    fn positions_count_characters() {
        let source = Source::new("<a>\n<ü b=\"1\"/>\n</a>".as_bytes()).unwrap();
        let at = source.text.find("b=").unwrap();
        assert_eq!(source.position(at), Position { line: 2, column: 4 });
        assert_eq!(source.position(0), Position { line: 1, column: 1 });
        assert_eq!(source.position(usize::MAX).line, 3);
    }
}
