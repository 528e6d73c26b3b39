//! Attributes of a type.

use alloc::borrow::ToOwned as _;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use roxmltree::{Attribute, Node};

use super::Reader;
use crate::problem::{Rule, Severity};
use crate::value::{SchemaVersion, ValueList, number, shortened};

/// Returns the attribute with this name and without namespace.
pub(crate) fn attribute<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Attribute<'a, 'i>> {
    node.attributes()
        .find(|attribute| attribute.name() == name && attribute.namespace().is_none())
}

impl Reader<'_> {
    /// A value that is not of its type.
    fn no_value(&mut self, attribute: Attribute<'_, '_>, severity: Severity, expected: &str) {
        let message = format!(
            "{}=\"{}\": {expected}",
            attribute.name(),
            shortened(attribute.value())
        );
        self.problem(severity, Rule::Value, attribute.range().start, message);
    }

    /// Returns the text of an attribute.
    pub(super) fn string(&mut self, node: Node<'_, '_>, name: &str) -> Option<String> {
        attribute(node, name).map(|attribute| attribute.value().to_owned())
    }

    /// Returns the text of an attribute without which the element cannot be used.
    pub(super) fn needed_string(&mut self, node: Node<'_, '_>, name: &str) -> Option<String> {
        let found = self.string(node, name);
        if found.is_none() {
            self.missing(node, name);
        }
        found
    }

    fn missing(&mut self, node: Node<'_, '_>, name: &str) {
        let element = node.tag_name().name();
        self.at(
            Severity::Unusable,
            Rule::Attribute,
            node,
            format!("{element} has no attribute {name}"),
        );
    }

    /// Returns a number; one that is none, or too large, makes the file unusable.
    pub(super) fn number<T: TryFrom<u32> + Bounded>(&mut self, node: Node<'_, '_>, name: &str) -> Option<T> {
        let attribute = attribute(node, name)?;
        let value = number(attribute.value().trim()).and_then(|number| T::try_from(number).ok());
        if value.is_none() {
            let expected = format!("expected a number from 0 to {}", T::LARGEST);
            self.no_value(attribute, Severity::Unusable, &expected);
        }
        value
    }

    /// Returns a number without which the element cannot be used.
    pub(super) fn needed_number<T: TryFrom<u32> + Bounded>(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
    ) -> Option<T> {
        if attribute(node, name).is_none() {
            self.missing(node, name);
        }
        self.number(node, name)
    }

    /// Returns a list of numbers.
    pub(super) fn values(&mut self, node: Node<'_, '_>, name: &str) -> ValueList {
        let Some(attribute) = attribute(node, name) else {
            return ValueList::EMPTY;
        };
        attribute.value().parse().unwrap_or_else(|_| {
            self.no_value(
                attribute,
                Severity::Unusable,
                "expected a list of numbers as `0..4 7`",
            );
            ValueList::EMPTY
        })
    }

    /// Returns a list of numbers with another default than none.
    pub(super) fn values_or(&mut self, node: Node<'_, '_>, name: &str, default: &str) -> ValueList {
        if attribute(node, name).is_some() {
            self.values(node, name)
        } else {
            default.parse().unwrap_or_default()
        }
    }

    /// Reads a boolean; false if absent.
    pub(super) fn flag(&mut self, node: Node<'_, '_>, name: &str) -> bool {
        self.flag_or(node, name, false)
    }

    /// Yes or no, where it is given.
    pub(super) fn given_flag(&mut self, node: Node<'_, '_>, name: &str) -> Option<bool> {
        attribute(node, name)?;
        Some(self.flag(node, name))
    }

    /// Yes or no.
    pub(super) fn flag_or(&mut self, node: Node<'_, '_>, name: &str, default: bool) -> bool {
        let Some(attribute) = attribute(node, name) else {
            return default;
        };
        match attribute.value().trim() {
            "true" | "1" => true,
            "false" | "0" => false,
            _ => {
                self.no_value(attribute, Severity::Error, "expected true or false");
                default
            }
        }
    }

    /// Words between semicolons.
    pub(super) fn tokens(&mut self, node: Node<'_, '_>, name: &str) -> Vec<String> {
        let text = attribute(node, name).map_or("", |attribute| attribute.value());
        text.split(';')
            .map(str::trim)
            .filter(|token| !token.is_empty())
            .map(str::to_owned)
            .collect()
    }

    /// Returns a version as `V2.35`.
    pub(super) fn version(&mut self, node: Node<'_, '_>, name: &str) -> Option<SchemaVersion> {
        let attribute = attribute(node, name)?;
        let version = attribute.value().trim().parse().ok();
        if version.is_none() {
            self.no_value(attribute, Severity::Error, "expected a version as V2.35");
        }
        version
    }
}

/// Types of numbers with their largest value, for messages.
pub(super) trait Bounded {
    const LARGEST: u32;
}

impl Bounded for u8 {
    const LARGEST: u32 = Self::MAX as u32;
}

impl Bounded for u16 {
    const LARGEST: u32 = Self::MAX as u32;
}

impl Bounded for u32 {
    const LARGEST: u32 = Self::MAX;
}
