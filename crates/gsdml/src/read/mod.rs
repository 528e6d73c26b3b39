//! From text to types.

mod access_point;
mod attributes;
mod lists;
mod references;
mod submodule;

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::{String, ToString as _};
use alloc::vec::Vec;

use roxmltree::{Document, Node, ParsingOptions};

use crate::model::{DeviceIdentity, Family, Gsdml};
use crate::problem::{Position, Problem, Problems, Rule, Severity};
use crate::source::{MOST_NODES, Source};
use crate::text::TextId;
use crate::value::{SchemaVersion, shortened};
use references::{Kind, Reference};

/// Namespace of all elements.
pub const NAMESPACE: &str = "http://www.profibus.com/GSDML/2003/11/DeviceProfile";
/// Namespace of `schemaLocation`.
const INSTANCE: &str = "http://www.w3.org/2001/XMLSchema-instance";
/// Name of the root element.
const ROOT: &str = "ISO15745Profile";

/// Returns the XML tree of a file, or why there is none.
pub(crate) fn document<'a>(source: &'a Source<'_>) -> Result<Document<'a>, Problem> {
    let options = ParsingOptions {
        allow_dtd: false,
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(&source.text, options).map_err(|error| {
        let place = error.pos();
        let (rule, message) = match error {
            // these have no place of their own
            roxmltree::Error::UnexpectedEndOfStream
            | roxmltree::Error::UnclosedRootNode
            | roxmltree::Error::NoRootNode => return source.cut_off(),
            roxmltree::Error::NodesLimitReached => {
                (Rule::Limit, format!("more than {MOST_NODES} elements and texts"))
            }
            roxmltree::Error::UnknownEntityReference(ref name, _) => (
                Rule::Entity,
                format!("entity `&{};` is not one of the five of XML", shortened(name)),
            ),
            ref other => (Rule::Xml, shortened_words(&other.to_string())),
        };
        Problem {
            severity: Severity::Unusable,
            rule,
            position: Position {
                line: place.row,
                column: place.col,
            },
            message,
        }
    })
}

/// Returns the library's own words without the position, which stands in front already.
fn shortened_words(text: &str) -> String {
    let words = text.split(" at ").next().unwrap_or(text);
    words.chars().take(200).collect()
}

/// Goes through the tree once.
pub(crate) struct Reader<'s> {
    source: &'s Source<'s>,
    pub problems: Problems,
    /// Identifiers that may be named, with their kind.
    ids: BTreeMap<(Kind, String), ()>,
    references: Vec<Reference>,
    /// First octet of what is read now, for attributes that are not there.
    place: usize,
}

impl<'s> Reader<'s> {
    pub fn new(source: &'s Source<'s>) -> Self {
        Self {
            source,
            problems: Problems::default(),
            ids: BTreeMap::new(),
            references: Vec::new(),
            place: 0,
        }
    }

    /// Records a problem at an octet. Line and column are only computed for recorded problems, as this takes time.
    pub fn problem(&mut self, severity: Severity, rule: Rule, at: usize, message: impl Into<String>) {
        if self.problems.wants(severity) {
            self.problems.list.push(Problem {
                severity,
                rule,
                position: self.source.position(at),
                message: message.into(),
            });
        }
    }

    /// A problem at an element.
    fn at(&mut self, severity: Severity, rule: Rule, node: Node<'_, '_>, message: impl Into<String>) {
        self.problem(severity, rule, node.range().start, message);
    }

    /// Reads the whole description. It may be used only if no problem is [`Severity::Unusable`].
    pub fn gsdml(&mut self, document: &Document<'_>) -> Option<Gsdml> {
        let root = document.root_element();
        if root.tag_name().name() != ROOT {
            let found = shortened(root.tag_name().name());
            self.at(
                Severity::Unusable,
                Rule::Root,
                root,
                format!("no GSDML: the root element is `{found}`, not `{ROOT}`"),
            );
            return None;
        }
        if root.tag_name().namespace() != Some(NAMESPACE) {
            self.at(
                Severity::Error,
                Rule::Root,
                root,
                format!("the namespace of the file is not {NAMESPACE}"),
            );
        }
        let schema_version = self.schema_version(root);
        let body = self.needed(root, "ProfileBody")?;
        let identity = self.identity(body)?;
        let family = self.family(body);
        let process = self.needed(body, "ApplicationProcess")?;
        // texts, values and pictures first: what follows names them
        let texts = self.texts(process);
        let values = self.list(process, "ValueList", "ValueItem", Self::value_item);
        let graphics = self.list(process, "GraphicsList", "GraphicItem", Self::graphic);
        let categories = self.list(process, "CategoryList", "CategoryItem", Self::category);
        let channel_diagnoses = self.list(
            process,
            "ChannelDiagList",
            "ChannelDiagItem",
            Self::channel_diagnosis,
        );
        let submodules = self.list(process, "SubmoduleList", "SubmoduleItem", |reader, node| {
            reader.submodule(node, Kind::Submodule)
        });
        let modules = self.list(process, "ModuleList", "ModuleItem", Self::module);
        let points = self.needed(process, "DeviceAccessPointList")?;
        let access_points = self.children(points, "DeviceAccessPointItem", Self::access_point);
        if access_points.is_empty() {
            self.at(
                Severity::Unusable,
                Rule::Element,
                points,
                "no DeviceAccessPointItem: a device has at least one",
            );
        }
        let gsdml = Gsdml {
            schema_version,
            identity,
            family,
            access_points,
            modules,
            submodules,
            values,
            channel_diagnoses,
            graphics,
            categories,
            texts,
        };
        self.resolve();
        Some(gsdml)
    }

    fn schema_version(&mut self, root: Node<'_, '_>) -> Option<SchemaVersion> {
        let location = root.attribute((INSTANCE, "schemaLocation"))?;
        let file = location.split_ascii_whitespace().last()?;
        let (_, version) = file.rsplit_once("GSDML-DeviceProfile-")?;
        let version = version.get(..version.len().checked_sub(4)?)?;
        version.parse().ok()
    }

    fn identity(&mut self, body: Node<'_, '_>) -> Option<DeviceIdentity> {
        let node = self.needed(body, "DeviceIdentity")?;
        let vendor_id = self.needed_number(node, "VendorID");
        let device_id = self.needed_number(node, "DeviceID");
        let info = child(node, "InfoText").and_then(|node| self.text_of(node, "TextId"));
        let vendor = child(node, "VendorName").and_then(|node| self.string(node, "Value"));
        Some(DeviceIdentity {
            vendor_id: vendor_id?,
            device_id: device_id?,
            info,
            vendor: vendor.unwrap_or_default(),
        })
    }

    fn family(&mut self, body: Node<'_, '_>) -> Family {
        let family = child(body, "DeviceFunction").and_then(|node| child(node, "Family"));
        let Some(node) = family else {
            return Family::default();
        };
        Family {
            main: self.string(node, "MainFamily").unwrap_or_default(),
            product: self.string(node, "ProductFamily"),
        }
    }

    /// Returns a child without which nothing can be read.
    fn needed<'a, 'i>(&mut self, node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
        let found = child(node, name);
        if found.is_none() {
            let parent = node.tag_name().name();
            self.at(
                Severity::Unusable,
                Rule::Element,
                node,
                format!("{parent} has no {name}"),
            );
        }
        found
    }

    /// Applies `read` to the children with a name.
    fn children<T>(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        mut read: impl FnMut(&mut Self, Node<'_, '_>) -> Option<T>,
    ) -> Vec<T> {
        node.children()
            .filter(|child| is(*child, name))
            .filter_map(|child| {
                self.place = child.range().start;
                read(self, child)
            })
            .collect()
    }

    /// Applies `read` to the items of a list; empty when the list is missing.
    fn list<T>(
        &mut self,
        node: Node<'_, '_>,
        list: &str,
        item: &str,
        read: impl FnMut(&mut Self, Node<'_, '_>) -> Option<T>,
    ) -> Vec<T> {
        match child(node, list) {
            Some(list) => self.children(list, item, read),
            None => Vec::new(),
        }
    }

    /// Returns a text that an attribute names.
    fn text_of(&mut self, node: Node<'_, '_>, attribute: &str) -> Option<TextId> {
        let id = self.string(node, attribute)?;
        self.name(node, attribute, Kind::Text, &id);
        Some(TextId(id))
    }

    /// Returns the text that a child names, as in `<Name TextId="..."/>`.
    fn text_of_child(&mut self, node: Node<'_, '_>, name: &str) -> Option<TextId> {
        child(node, name).and_then(|node| self.text_of(node, "TextId"))
    }
}

/// Returns whether a node is an element with this name.
pub(crate) fn is(node: Node<'_, '_>, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

/// Returns the first child with this name.
pub(crate) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| is(*child, name))
}
