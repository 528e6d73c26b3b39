//! From types to text.

mod parts;

pub(crate) use parts::{HEADER, REFERENCE};

use alloc::format;
use alloc::string::{String, ToString as _};
use core::fmt::Display;

use crate::model::Gsdml;
use crate::read::NAMESPACE;
use crate::value::SchemaVersion;

/// Builds an XML text with indented elements.
#[derive(Debug)]
struct Writer {
    out: String,
    depth: usize,
    /// The start tag of the last element is still open for attributes.
    open: bool,
}

impl Writer {
    fn new() -> Self {
        Self {
            out: String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"),
            depth: 0,
            open: false,
        }
    }

    /// An element with what `inside` writes: attributes first, then elements.
    fn element(&mut self, name: &str, inside: impl FnOnce(&mut Self)) {
        self.begin(name);
        inside(self);
        self.end(name);
    }

    fn begin(&mut self, name: &str) {
        self.close_tag("\n");
        self.indent();
        self.out.push('<');
        self.out.push_str(name);
        self.open = true;
        self.depth += 1;
    }

    fn end(&mut self, name: &str) {
        self.depth -= 1;
        if self.open {
            self.out.push_str("/>\n");
            self.open = false;
        } else {
            self.indent();
            self.out.push_str("</");
            self.out.push_str(name);
            self.out.push_str(">\n");
        }
    }

    /// An element with text.
    fn words(&mut self, name: &str, text: &str) {
        self.begin(name);
        self.close_tag("");
        escape(&mut self.out, text);
        self.depth -= 1;
        self.out.push_str("</");
        self.out.push_str(name);
        self.out.push_str(">\n");
    }

    /// An element that stands for something only by an attribute; none without value.
    fn single(&mut self, name: &str, attribute: &str, value: Option<impl Display>) {
        if let Some(value) = value {
            self.element(name, |w| w.attribute(attribute, value));
        }
    }

    fn attribute(&mut self, name: &str, value: impl Display) {
        self.out.push(' ');
        self.out.push_str(name);
        self.out.push_str("=\"");
        escape(&mut self.out, &value.to_string());
        self.out.push('"');
    }

    fn optional(&mut self, name: &str, value: Option<impl Display>) {
        if let Some(value) = value {
            self.attribute(name, value);
        }
    }

    /// A list of numbers, left out when empty.
    fn values(&mut self, name: &str, values: &crate::value::ValueList) {
        if !values.is_empty() {
            self.attribute(name, values);
        }
    }

    /// Words between semicolons.
    fn tokens(&mut self, name: &str, tokens: &[String]) {
        self.attribute(name, tokens.join(";"));
    }

    fn ident(&mut self, name: &str, ident: u32) {
        self.attribute(name, format_args!("0x{ident:08X}"));
    }

    fn close_tag(&mut self, behind: &str) {
        if self.open {
            self.out.push('>');
            self.out.push_str(behind);
            self.open = false;
        }
    }

    fn indent(&mut self) {
        for _ in 0..self.depth {
            self.out.push_str("  ");
        }
    }
}

/// The five characters of XML, and those that a reader would change in an attribute. What XML cannot hold becomes a
/// replacement character.
fn escape(out: &mut String, text: &str) {
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&apos;"),
            '\t' | '\n' | '\r' => out.push_str(&format!("&#{};", u32::from(c))),
            '\0'..='\x1F' | '\u{FFFE}' | '\u{FFFF}' => out.push('\u{FFFD}'),
            _ => out.push(c),
        }
    }
}

impl Gsdml {
    /// Returns the description as a file. The same description gives the same octets every time.
    ///
    /// Reading it back ([`parse`](crate::parse)) gives an equal description when its identifiers are sound, its
    /// texts have no characters that XML cannot hold, and it names its schema.
    #[must_use]
    pub fn to_xml(&self) -> String {
        let version = self.schema_version.unwrap_or(SchemaVersion::WRITTEN);
        let mut w = Writer::new();
        w.element("ISO15745Profile", |w| {
            w.attribute("xmlns", NAMESPACE);
            w.attribute("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance");
            w.attribute(
                "xsi:schemaLocation",
                format_args!("{NAMESPACE} ..\\xsd\\GSDML-DeviceProfile-{version}.xsd"),
            );
            parts::header(w);
            w.element("ProfileBody", |w| {
                parts::identity(w, self);
                w.element("ApplicationProcess", |w| parts::process(w, self));
            });
        });
        w.out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::description;
    use crate::parse;
    use proptest::prelude::*;

    #[test]
    fn what_is_written_is_read_back() {
        let written = description().to_xml();
        assert_eq!(parse(written.as_bytes()), Ok(description()));
        assert_eq!(description().to_xml(), written);
    }

    #[test]
    fn what_xml_cannot_hold_is_replaced() {
        let mut description = description();
        let id = description.texts.add("T_INFO", "a\0b\u{1b}c\u{fffe}");
        let read = parse(description.to_xml().as_bytes()).unwrap();
        assert_eq!(read.texts.get(&id), Some("a\u{fffd}b\u{fffd}c\u{fffd}"));
    }

    /// Any text XML can hold.
    fn text() -> impl Strategy<Value = String> {
        let sign = prop_oneof![
            prop::sample::select(alloc::vec![
                '&', '<', '>', '"', '\'', '\t', '\n', '\r', ' ', ';', ']', '#', 'ü'
            ]),
            any::<char>().prop_filter("XML cannot hold it", |c| {
                !matches!(c, '\0'..='\x08' | '\x0B'..='\x0C' | '\x0E'..='\x1F' | '\u{FFFE}' | '\u{FFFF}')
            }),
        ];
        prop::collection::vec(sign, 0..20).prop_map(|signs| signs.into_iter().collect())
    }

    proptest! {
        #[test]
        fn texts_come_back_as_they_were(
            words in text(), other in text(), vendor in text(), order in prop::option::of(text()),
            id in "[A-Za-z_][A-Za-z0-9_.]{0,20}", tag in "[a-z]{2}(-[A-Z]{2})?",
        ) {
            let mut description = description();
            let id = description.texts.add(alloc::format!("X{id}"), words);
            description.texts.translate(&tag, &id, other);
            description.identity.vendor = vendor;
            description.modules[0].info.order_number = order;
            description.modules[0].info.name = Some(id);
            prop_assert_eq!(parse(description.to_xml().as_bytes()), Ok(description));
        }

        #[test]
        fn a_truncated_file_is_reported_at_its_end(at: prop::sample::Index) {
            let mut text = description().to_xml();
            // the declaration is complete, the last element is not
            let (first, last) = (text.find('\n').unwrap(), text.trim_end().len() - 1);
            let at = first + at.index(last - first);
            text.truncate((0..=at).rev().find(|at| text.is_char_boundary(*at)).unwrap());
            let problem = parse(text.as_bytes()).unwrap_err();
            let lines = text.trim_end().matches('\n').count() + 1;
            prop_assert_eq!(problem.position.line as usize, lines, "{}: {}", problem, text.len());
        }

        #[test]
        fn any_damage_is_reported_or_harmless(at: prop::sample::Index, octet: u8, cut: bool) {
            let mut octets = description().to_xml().into_bytes();
            let at = at.index(octets.len());
            if cut {
                octets.truncate(at);
            } else {
                octets[at] = octet;
            }
            let report = crate::check(&octets, Some(crate::fixtures::NAME));
            match parse(&octets) {
                Ok(read) => {
                    prop_assert_eq!(report.description.as_ref(), Some(&read));
                    let mut again = read.clone();
                    // a missing schema version becomes that of the writer
                    again.schema_version = Some(again.schema_version.unwrap_or(SchemaVersion::WRITTEN));
                    prop_assert_eq!(parse(again.to_xml().as_bytes()), Ok(again));
                }
                Err(problem) => {
                    prop_assert!(report.description.is_none());
                    prop_assert!(problem.position.line > 0 && problem.position.column > 0);
                    prop_assert!(report.problems.contains(&problem), "{problem} not in {report:?}");
                }
            }
        }
    }
}
