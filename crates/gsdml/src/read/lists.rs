//! Texts, value texts, diagnoses, pictures and categories.

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::String;

use roxmltree::Node;

use super::references::Kind;
use super::{Reader, child, is};
use crate::model::{Category, ChannelDiagnosis, Graphic, ValueItem};
use crate::problem::{Rule, Severity};
use crate::text::{Language, TextId, Texts};
use crate::value::shortened;

/// Namespace of `xml:lang`.
const XML: &str = "http://www.w3.org/XML/1998/namespace";

impl Reader<'_> {
    pub(super) fn texts(&mut self, process: Node<'_, '_>) -> Texts {
        let Some(list) = child(process, "ExternalTextList") else {
            self.at(
                Severity::Error,
                Rule::Element,
                process,
                "ApplicationProcess has no ExternalTextList",
            );
            return Texts::default();
        };
        let primary = match child(list, "PrimaryLanguage") {
            Some(node) => self.language(node, Kind::Text),
            None => {
                self.at(
                    Severity::Error,
                    Rule::Element,
                    list,
                    "ExternalTextList has no PrimaryLanguage",
                );
                Language::new()
            }
        };
        let mut languages: BTreeMap<String, Language> = BTreeMap::new();
        for node in list.children().filter(|node| is(*node, "Language")) {
            let Some(tag) = node.attribute((XML, "lang")) else {
                self.at(
                    Severity::Error,
                    Rule::Attribute,
                    node,
                    "Language has no attribute xml:lang",
                );
                continue;
            };
            let texts = self.translation(node, &primary);
            if languages.insert(tag.into(), texts).is_some() {
                let message = format!("language `{}` is there twice", shortened(tag));
                self.at(Severity::Error, Rule::Identifier, node, message);
            }
        }
        Texts { primary, languages }
    }

    fn language(&mut self, node: Node<'_, '_>, kind: Kind) -> Language {
        let mut language = Language::new();
        for node in node.children().filter(|node| is(*node, "Text")) {
            if let Some((id, text)) = self.text_item(node) {
                self.declare(node, "TextId", kind, &id);
                language.insert(TextId(id), text);
            }
        }
        language
    }

    /// Texts of another language: each must be one of the primary language, and only once.
    fn translation(&mut self, node: Node<'_, '_>, primary: &Language) -> Language {
        let mut language = Language::new();
        for node in node.children().filter(|node| is(*node, "Text")) {
            let Some((id, text)) = self.text_item(node) else {
                continue;
            };
            let id = TextId(id);
            if !primary.contains_key(&id) {
                let message = format!("text `{}` is not in the primary language", shortened(&id.0));
                self.at(Severity::Error, Rule::Text, node, message);
            }
            if language.contains_key(&id) {
                let message = format!("text `{}` is there twice", shortened(&id.0));
                self.at(Severity::Unusable, Rule::Identifier, node, message);
            }
            language.insert(id, text);
        }
        language
    }

    fn text_item(&mut self, node: Node<'_, '_>) -> Option<(String, String)> {
        let id = self.needed_string(node, "TextId");
        let text = self.string(node, "Value").unwrap_or_default();
        Some((id?, text))
    }

    pub(super) fn value_item(&mut self, node: Node<'_, '_>) -> Option<ValueItem> {
        let id = self.id(node, Kind::Value)?;
        let assignments = self.list(node, "Assignments", "Assign", |reader, node| {
            let content = reader.needed_string(node, "Content");
            let text = reader.text_of(node, "TextId");
            Some((content?, text?))
        });
        Some(ValueItem { id, assignments })
    }

    pub(super) fn graphic(&mut self, node: Node<'_, '_>) -> Option<Graphic> {
        let id = self.id(node, Kind::Graphic)?;
        Some(Graphic {
            id,
            file: self.string(node, "GraphicFile").unwrap_or_default(),
        })
    }

    pub(super) fn category(&mut self, node: Node<'_, '_>) -> Option<Category> {
        let id = self.id(node, Kind::Category)?;
        Some(Category {
            id,
            text: self.text_of(node, "TextId"),
        })
    }

    pub(super) fn channel_diagnosis(&mut self, node: Node<'_, '_>) -> Option<ChannelDiagnosis> {
        let error_type = self.needed_number(node, "ErrorType");
        let name = self.text_of_child(node, "Name");
        let help = self.text_of_child(node, "Help");
        Some(ChannelDiagnosis {
            error_type: error_type?,
            name,
            help,
        })
    }
}
