//! The text form of settings that are kept in a file: backups, way-back files, saved states of a drive, notes.
//!
//! ```text
//! profidrive backup 1
//! model: AKD
//! # a remark
//!
//! p2108 DRV.ACC = 3000 rpm/s  # what stands behind the mark is for people
//! checksum 5b1c2d3e
//! ```
//!
//! The first line has the kind of the file and the version of its form. Then follow, one a line and in any order, head
//! lines `key: value`, settings `NAME = value` and words without a mark. What stands behind `#` is a comment, empty lines
//! mean nothing. Characters that have a meaning here, and those that control a terminal, are escaped: `\u{23}`. The
//! last line is terminated; where a form is sealed, or where there is such a line, it has the CRC-32 of everything before it.
//! So a text that was cut is recognised, but for an unsealed one that was cut between two lines.
//!
//! ```
//! use profidrive_profile::notation::setting::{Cause, Entry, Form};
//!
//! const NOTES: Form = Form {
//!     kind: "note",
//!     oldest: 1,
//!     version: 1,
//!     sealed: true,
//!     comment_column: 0,
//!     comment_gap: 1,
//! };
//! let mut text = NOTES.begin(1);
//! text.head("model", "AKD", "");
//! text.setting("DRV.ACC", "3000.000", "rpm/s");
//! let text = text.finish();
//! assert!(text.starts_with("profidrive note 1\nmodel: AKD\nDRV.ACC = 3000.000 # rpm/s\nchecksum "));
//!
//! let settings = NOTES.read(text.as_bytes())?;
//! assert_eq!(settings.lines[1].number, 3);
//! let Entry::Setting { name, value } = &settings.lines[1].entry else { panic!() };
//! assert_eq!((name.as_str(), value.as_str()), ("DRV.ACC", "3000.000"));
//!
//! let cut = NOTES.read(&text.as_bytes()[..40]).unwrap_err();
//! assert_eq!(cut.cause, Cause::NoLineBreak);
//! assert_eq!(cut.to_string(), "line 3: the last line has no line break, so its value may be cut");
//! # Ok::<(), profidrive_profile::notation::setting::Problem>(())
//! ```

#[cfg(test)]
mod tests;

use alloc::borrow::ToOwned;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt::{self, Write as _};

/// Longest text that is read, in octets: far more than any drive needs.
pub const LONGEST: usize = 4 << 20;
/// First word of every file.
const MAGIC: &str = "profidrive ";
/// First word of the last line.
const CHECKSUM: &str = "checksum ";
/// Most characters of a text that a message quotes.
const QUOTED: usize = 60;

/// What the files of one kind have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// Second word of the first line: `backup`.
    pub kind: &'static str,
    /// Oldest version that is read.
    pub oldest: u32,
    /// Newest version that is read.
    pub version: u32,
    /// The checksum is written, and has to be there.
    pub sealed: bool,
    /// Column where comments begin, if the line is not longer.
    pub comment_column: usize,
    /// Fewest blanks before a comment.
    pub comment_gap: usize,
}

/// Contents of a text without its comments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Settings {
    /// Version of its form.
    pub version: u32,
    /// The lines with content, in their order.
    pub lines: Vec<Line>,
}

/// A line with content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Counted from 1.
    pub number: usize,
    /// Its content.
    pub entry: Entry,
    /// What stands behind the mark of a comment.
    pub comment: String,
}

/// Content of a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Entry {
    /// `key: value`
    Head {
        /// Before the colon.
        key: String,
        /// Behind it.
        value: String,
    },
    /// `NAME = value`
    Setting {
        /// Before the first equals sign.
        name: String,
        /// Behind it.
        value: String,
    },
    /// Neither mark.
    Words(String),
}

/// One mistake in a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Line, counted from 1.
    pub line: usize,
    /// What is wrong.
    pub cause: Cause,
}

/// What is wrong with a text.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cause {
    /// Longer than [`LONGEST`].
    TooLong {
        /// The kind that was expected.
        kind: &'static str,
    },
    /// The octets are not UTF-8.
    NotText {
        /// The kind that was expected.
        kind: &'static str,
    },
    /// The first line is not that of this kind of file.
    OtherKind {
        /// The form that was expected: its kind and newest version.
        form: (&'static str, u32),
        /// The first line, shortened.
        found: String,
    },
    /// The version of its form is not known, so another edition of the program wrote it.
    OtherVersion {
        /// The form that was expected: its kind and newest version.
        form: (&'static str, u32),
        /// The version, shortened.
        found: String,
    },
    /// The last line has no line break: its value may be cut.
    NoLineBreak,
    /// The checksum is missing, and with it the end of the text.
    NoChecksum,
    /// The checksum is not that of the text.
    Changed {
        /// The checksum in the text.
        found: String,
        /// The checksum of the text.
        computed: u32,
    },
    /// The line has content that this kind of file does not support, or not in this form.
    Line(String),
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong { kind } => write!(f, "longer than {LONGEST} octets, not a {kind}"),
            Self::NotText { kind } => write!(f, "not text (UTF-8), not a {kind}"),
            Self::OtherKind {
                form: (kind, newest),
                found,
            } => write!(
                f,
                "not a {kind}: the first line is `{MAGIC}{kind} {newest}`, not `{found}`"
            ),
            Self::OtherVersion {
                form: (kind, newest),
                found,
            } => write!(f, "a {kind} of form {found}, this program reads form {newest}"),
            Self::NoLineBreak => f.write_str("the last line has no line break, so its value may be cut"),
            Self::NoChecksum => {
                f.write_str("the end of the text is missing: the last line is not a checksum")
            }
            Self::Changed { found, computed } => write!(
                f,
                "the text was changed: the checksum is {found}, computed {computed:08x}"
            ),
            Self::Line(what) => f.write_str(what),
        }
    }
}

impl Problem {
    /// What is wrong in a line.
    pub fn new(line: usize, what: impl Into<String>) -> Self {
        Self::of(line, Cause::Line(what.into()))
    }

    const fn of(line: usize, cause: Cause) -> Self {
        Self { line, cause }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // text of an untrusted file must not move the cursor
        let clean = |c: char| if c.is_control() { '.' } else { c };
        let what: String = self.cause.to_string().chars().map(clean).collect();
        write!(f, "line {}: {what}", self.line)
    }
}

impl core::error::Error for Problem {}

impl Form {
    /// Begins a text of a version.
    #[must_use]
    pub fn begin(&self, version: u32) -> Text {
        Text {
            form: *self,
            text: format!("{MAGIC}{} {version}\n", self.kind),
        }
    }

    /// Reads a text, which is untrusted: edited, cut, or written by another program.
    ///
    /// # Errors
    /// When it is not text, of another kind or version, cut, or when its checksum does not match.
    pub fn read(&self, octets: &[u8]) -> Result<Settings, Problem> {
        let kind = self.kind;
        if octets.len() > LONGEST {
            return Err(Problem::of(1, Cause::TooLong { kind }));
        }
        let text = core::str::from_utf8(octets).map_err(|error| {
            let before = octets.get(..error.valid_up_to()).unwrap_or_default();
            let line = 1 + before.iter().filter(|octet| **octet == b'\n').count();
            Problem::of(line, Cause::NotText { kind })
        })?;
        let version = self.version_of(text.lines().next().unwrap_or_default())?;
        let lines = self
            .unsealed(text)?
            .lines()
            .zip(1..)
            .skip(1)
            .filter_map(|(text, number)| line(text, number).transpose());
        Ok(Settings {
            version,
            lines: lines.collect::<Result<_, _>>()?,
        })
    }

    fn version_of(&self, line: &str) -> Result<u32, Problem> {
        let line = line.trim_start_matches('\u{feff}').trim();
        let rest = line
            .strip_prefix(MAGIC)
            .and_then(|rest| rest.strip_prefix(self.kind));
        let form = (self.kind, self.version);
        let of = |cause| Problem::of(1, cause);
        let found = rest.map(str::trim).ok_or_else(|| {
            let found = shorten(line);
            of(Cause::OtherKind { form, found })
        })?;
        let mut versions = self.oldest..=self.version;
        versions
            .find(|version| version.to_string() == found)
            .ok_or_else(|| {
                let found = shorten(found);
                of(Cause::OtherVersion { form, found })
            })
    }

    /// Returns the text without its checksum, which matches, or is not there and need not be.
    fn unsealed<'t>(&self, text: &'t str) -> Result<&'t str, Problem> {
        let of = |cause| Problem::of(text.lines().count().max(1), cause);
        let whole = text.strip_suffix('\n').ok_or_else(|| of(Cause::NoLineBreak))?;
        let (body, last) = text.split_at(whole.rfind('\n').map_or(0, |at| at + 1));
        let found = last.strip_prefix(CHECKSUM).map(str::trim_end);
        match found.filter(|found| found.len() == 8 && found.bytes().all(|octet| octet.is_ascii_hexdigit())) {
            Some(found) => {
                let computed = crc32(body.as_bytes());
                if found == format!("{computed:08x}") {
                    return Ok(body);
                }
                let found = found.to_owned();
                Err(of(Cause::Changed { found, computed }))
            }
            None if self.sealed => Err(of(Cause::NoChecksum)),
            None => Ok(text),
        }
    }
}

/// A line of a text; `None` where it has no content.
fn line(text: &str, number: usize) -> Result<Option<Line>, Problem> {
    let (text, comment) = text.split_once('#').unwrap_or((text, ""));
    let text = text.trim();
    if let Some(wrong) = text.chars().find(|&c| c.is_control() && c != '\t') {
        return Err(Problem::new(number, format!("{wrong:?} is not text")));
    }
    let plain = |text: &str| unescape(text.trim());
    let entry = if text.is_empty() {
        return Ok(None);
    } else if let Some((name, value)) = text.split_once('=').filter(|(name, _)| !name.contains(':')) {
        let (name, value) = (plain(name), plain(value));
        Entry::Setting { name, value }
    } else if let Some((key, value)) = text.split_once(':') {
        let (key, value) = (plain(key), plain(value));
        Entry::Head { key, value }
    } else {
        Entry::Words(plain(text))
    };
    let comment = plain(comment);
    Ok(Some(Line {
        number,
        entry,
        comment,
    }))
}

/// A text that is being written.
#[derive(Debug, Clone)]
pub struct Text {
    form: Form,
    text: String,
}

impl Text {
    /// Adds a line `key: value`, with a comment where that is not empty.
    pub fn head(&mut self, key: &str, value: &str, comment: &str) {
        let (key, value) = (escape(key, "#=:"), escape(value, "#"));
        self.line(format!("{key}: {value}"), comment);
    }

    /// Adds a line `NAME = value`, with a comment where that is not empty.
    pub fn setting(&mut self, name: &str, value: &str, comment: &str) {
        let (name, value) = (escape(name, "#=:"), escape(value, "#"));
        self.line(format!("{name} = {value}"), comment);
    }

    /// Adds a line without a mark; it must not be empty.
    pub fn words(&mut self, words: &str) {
        // what looks like a checksum is none
        let reserved = if words.starts_with(CHECKSUM) {
            "#=: "
        } else {
            "#=:"
        };
        self.line(escape(words, reserved), "");
    }

    /// Adds a comment on a line of its own.
    pub fn comment(&mut self, comment: &str) {
        self.line(format!("# {}", one_line(comment)), "");
    }

    /// Adds an empty line.
    pub fn blank(&mut self) {
        self.line(String::new(), "");
    }

    fn line(&mut self, line: String, comment: &str) {
        self.text += &line;
        let comment = one_line(comment);
        if !comment.is_empty() {
            let space = self.form.comment_column.saturating_sub(line.chars().count());
            // writing into a String does not fail
            let _ = write!(
                self.text,
                "{:1$}# {comment}",
                "",
                space.max(self.form.comment_gap)
            );
        }
        self.text.push('\n');
    }

    /// Returns the whole text.
    #[must_use]
    pub fn finish(mut self) -> String {
        if self.form.sealed {
            let checksum = crc32(self.text.as_bytes());
            let _ = writeln!(self.text, "{CHECKSUM}{checksum:08x}");
        }
        self.text
    }
}

/// Returns text of a file as a message quotes it: no control characters, not endless.
#[must_use]
pub fn shorten(text: &str) -> String {
    let clean = |c: char| if c.is_control() { '.' } else { c };
    let more = if text.chars().count() > QUOTED { ".." } else { "" };
    text.chars().take(QUOTED).map(clean).chain(more.chars()).collect()
}

/// Returns true for what controls a terminal (C0, DEL, C1), and for what is not seen but changes what is: bidirectional
/// controls, characters without width, separators of lines, tags.
///
/// Source: Unicode, general category Cc, and the default ignorable code points that are not letters of a script.
#[must_use]
pub fn is_unsafe(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{AD}' | '\u{34F}' | '\u{61C}' | '\u{115F}' | '\u{1160}' | '\u{17B4}' | '\u{17B5}'
            | '\u{180B}'..='\u{180F}' | '\u{200B}'..='\u{200F}' | '\u{2028}'..='\u{202E}' | '\u{2060}'..='\u{206F}'
            | '\u{3164}' | '\u{FE00}'..='\u{FE0F}' | '\u{FEFF}' | '\u{FFA0}' | '\u{FFF0}'..='\u{FFFB}'
            | '\u{1BCA0}'..='\u{1BCA3}' | '\u{1D173}'..='\u{1D17A}' | '\u{E0000}'..='\u{E0FFF}')
}

/// Escapes such characters, those of `reserved`, the backslash, and blanks at the ends, which a reader would cut off.
fn escape(text: &str, reserved: &str) -> String {
    let start = text.len() - text.trim_start().len();
    let inner = start..start + text.trim().len();
    let mut escaped = String::with_capacity(text.len());
    for (at, c) in text.char_indices() {
        if c == '\\' || is_unsafe(c) || reserved.contains(c) || !inner.contains(&at) {
            let _ = write!(escaped, "{}", c.escape_unicode());
        } else {
            escaped.push(c);
        }
    }
    escaped
}

/// Returns the text before [`escape`]; what is not such an escape stays as it is.
fn unescape(text: &str) -> String {
    let mut pieces = text.split("\\u{");
    let mut plain = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let escaped = piece.split_once('}').and_then(|(digits, rest)| {
            let number = u32::from_str_radix(digits, 16).ok()?;
            Some((char::from_u32(number)?, rest))
        });
        if let Some((c, rest)) = escaped {
            plain.push(c);
            plain += rest;
        } else {
            plain += "\\u{";
            plain += piece;
        }
    }
    plain
}

/// A comment ends with its line, and moves no cursor where the text is shown.
fn one_line(text: &str) -> String {
    escape(text.replace(['\n', '\r', '\t'], " ").trim(), "")
}

/// CRC-32 as in Ethernet and ZIP (reflected, 0xEDB88320).
#[must_use]
pub fn crc32(octets: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for octet in octets {
        crc ^= u32::from(*octet);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                (crc >> 1) ^ 0xEDB8_8320
            } else {
                crc >> 1
            };
        }
    }
    !crc
}
