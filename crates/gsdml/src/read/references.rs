//! Identifiers and what names them.

use alloc::borrow::ToOwned as _;
use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use roxmltree::Node;

use super::Reader;
use super::attributes::attribute;
use crate::model::{Menu, MenuEntry};
use crate::problem::{Rule, Severity};
use crate::value::shortened;

/// What an identifier stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    AccessPoint,
    Module,
    Submodule,
    /// Virtual, interface and port submodules: they have no references.
    Own,
    Value,
    Graphic,
    Category,
    Text,
}

impl Kind {
    const fn word(self) -> &'static str {
        match self {
            Self::AccessPoint => "access point",
            Self::Module => "module",
            Self::Submodule => "submodule",
            Self::Own => "item",
            Self::Value => "value item",
            Self::Graphic => "graphic",
            Self::Category => "category",
            Self::Text => "text",
        }
    }
}

/// Something that is named.
#[derive(Debug)]
pub(super) struct Reference {
    kind: Kind,
    id: String,
    at: usize,
}

impl Reader<'_> {
    /// Returns the identifier of an item, which must be the only one of its kind.
    pub(super) fn id(&mut self, node: Node<'_, '_>, kind: Kind) -> Option<String> {
        let id = self.needed_string(node, "ID")?;
        self.declare(node, "ID", kind, &id);
        Some(id)
    }

    /// Registers an identifier. A second one of an item that nothing refers to leaves the description usable: only the
    /// check reports it.
    pub(super) fn declare(&mut self, node: Node<'_, '_>, attribute_name: &str, kind: Kind, id: &str) {
        let known = self.ids.insert((kind, id.to_owned()), ()).is_some();
        if known && kind != Kind::Own {
            let at = attribute(node, attribute_name).map_or(0, |attribute| attribute.range().start);
            let message = format!("{} `{}` is there twice", kind.word(), shortened(id));
            self.problem(Severity::Unusable, Rule::Identifier, at, message);
        }
    }

    /// Records that an identifier is referenced.
    pub(super) fn name(&mut self, node: Node<'_, '_>, attribute_name: &str, kind: Kind, id: &str) {
        let at = attribute(node, attribute_name).map_or(0, |attribute| attribute.range().start);
        self.references.push(Reference {
            kind,
            id: id.to_owned(),
            at,
        });
    }

    /// Looks for what is named but not there. A missing text or picture does not make a device description unusable, a
    /// missing module does.
    pub(super) fn resolve(&mut self) {
        for Reference { kind, id, at } in core::mem::take(&mut self.references) {
            let key = (kind, id);
            if self.ids.contains_key(&key) {
                continue;
            }
            let (severity, rule) = match kind {
                Kind::Text => (Severity::Error, Rule::Text),
                Kind::Module | Kind::Submodule => (Severity::Unusable, Rule::Reference),
                _ => (Severity::Error, Rule::Reference),
            };
            let message = format!("there is no {} `{}`", kind.word(), shortened(&key.1));
            self.problem(severity, rule, at, message);
        }
    }

    /// Menus may name menus, but not in a circle.
    pub(super) fn menus_end(&mut self, node: Node<'_, '_>, menus: &[Menu]) {
        let places: BTreeMap<&str, usize> = menus
            .iter()
            .enumerate()
            .map(|(at, menu)| (menu.id.as_str(), at))
            .collect();
        // menus that nothing unfinished names are taken away until none is left; what stays names itself
        let targets: Vec<Vec<usize>> = menus
            .iter()
            .map(|menu| {
                let named = menu.entries.iter().filter_map(|entry| match entry {
                    MenuEntry::Menu(id) => places.get(id.as_str()).copied(),
                    MenuEntry::Parameter(_) => None,
                });
                named.collect()
            })
            .collect();
        let mut named = alloc::vec![0_usize; menus.len()];
        for target in targets.iter().flatten() {
            if let Some(count) = named.get_mut(*target) {
                *count += 1;
            }
        }
        let mut free: Vec<usize> = (0..menus.len()).filter(|at| named.get(*at) == Some(&0)).collect();
        let mut done = 0;
        while let Some(at) = free.pop() {
            done += 1;
            for target in targets.get(at).into_iter().flatten() {
                if let Some(count) = named.get_mut(*target) {
                    *count -= 1;
                    if *count == 0 {
                        free.push(*target);
                    }
                }
            }
        }
        if done < menus.len() {
            self.at(
                Severity::Unusable,
                Rule::Loop,
                node,
                "menus name each other in a circle",
            );
        }
    }
}
