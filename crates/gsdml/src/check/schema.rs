//! Elements and attributes: what may stand where, in which order, and what must be there.
//!
//! Source: the tree of GSDML V2.3x as documents of PI and vendors' files show it. Elements this table does not know are
//! passed over: later versions have more.

use alloc::format;
use alloc::string::String;

use roxmltree::Node;

use crate::problem::{Rule, Severity};
use crate::read::Reader;
use crate::value::shortened;
use Times::{Any, One, Optional, Several};

/// How often an element may stand in its parent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Times {
    /// Exactly once.
    One,
    /// At most once.
    Optional,
    /// At least once.
    Several,
    /// Any number of times.
    Any,
}

/// An element: its children in their order, and the attributes it must have.
struct Element {
    name: &'static str,
    children: &'static [(&'static str, Times)],
    attributes: &'static [&'static str],
}

/// Returns a row of the table.
const fn element(
    name: &'static str,
    attributes: &'static [&'static str],
    children: &'static [(&'static str, Times)],
) -> Element {
    Element {
        name,
        children,
        attributes,
    }
}

const SUBMODULE: &[(&str, Times)] = &[
    ("IOData", One),
    ("RecordDataList", Optional),
    ("ModuleInfo", One),
    ("Graphics", Optional),
];
const ITEMS: &[(&str, Times)] = &[("DataItem", Several)];
const TEXTS: &[(&str, Times)] = &[("Text", Any)];

const ELEMENTS: &[Element] = &[
    element(
        "ISO15745Profile",
        &[],
        &[("ProfileHeader", One), ("ProfileBody", One)],
    ),
    element(
        "ProfileHeader",
        &[],
        &[
            ("ProfileIdentification", One),
            ("ProfileRevision", One),
            ("ProfileName", One),
            ("ProfileSource", One),
            ("ProfileClassID", One),
            ("ISO15745Reference", Several),
        ],
    ),
    element(
        "ISO15745Reference",
        &[],
        &[
            ("ISO15745Part", One),
            ("ISO15745Edition", One),
            ("ProfileTechnology", One),
        ],
    ),
    element(
        "ProfileBody",
        &[],
        &[
            ("DeviceIdentity", One),
            ("DeviceFunction", One),
            ("ApplicationProcess", One),
        ],
    ),
    element(
        "DeviceIdentity",
        &["VendorID", "DeviceID"],
        &[("InfoText", One), ("VendorName", One)],
    ),
    element("DeviceFunction", &[], &[("Family", One)]),
    element("Family", &["MainFamily"], &[]),
    element("InfoText", &["TextId"], &[]),
    element("Name", &["TextId"], &[]),
    element("VendorName", &["Value"], &[]),
    element("OrderNumber", &["Value"], &[]),
    element("HardwareRelease", &["Value"], &[]),
    element("SoftwareRelease", &["Value"], &[]),
    element(
        "ApplicationProcess",
        &[],
        &[
            ("DeviceAccessPointList", One),
            ("ModuleList", Optional),
            ("SubmoduleList", Optional),
            ("ValueList", Optional),
            ("ChannelDiagList", Optional),
            ("LogBookEntryList", Optional),
            ("GraphicsList", Optional),
            ("CategoryList", Optional),
            ("ExternalTextList", One),
        ],
    ),
    element(
        "DeviceAccessPointList",
        &[],
        &[("DeviceAccessPointItem", Several)],
    ),
    element(
        "DeviceAccessPointItem",
        &[
            "ID",
            "PNIO_Version",
            "PhysicalSlots",
            "ModuleIdentNumber",
            "MinDeviceInterval",
            "DNS_CompatibleName",
            "ObjectUUID_LocalIndex",
        ],
        &[
            ("ModuleInfo", One),
            ("CertificationInfo", Optional),
            ("SubslotList", Optional),
            ("IOConfigData", One),
            ("UseableModules", Optional),
            ("VirtualSubmoduleList", One),
            ("SystemDefinedSubmoduleList", Optional),
            ("Graphics", Optional),
        ],
    ),
    element(
        "ModuleInfo",
        &[],
        &[
            ("Name", One),
            ("InfoText", One),
            ("Family", Optional),
            ("VendorName", Optional),
            ("OrderNumber", Optional),
            ("HardwareRelease", Optional),
            ("SoftwareRelease", Optional),
        ],
    ),
    element(
        "CertificationInfo",
        &["ConformanceClass", "ApplicationClass"],
        &[],
    ),
    element("SubslotList", &[], &[("SubslotItem", Several)]),
    element("SubslotItem", &["SubslotNumber", "TextId"], &[]),
    element("IOConfigData", &["MaxInputLength", "MaxOutputLength"], &[]),
    element("UseableModules", &[], &[("ModuleItemRef", Several)]),
    element("ModuleItemRef", &["ModuleItemTarget"], &[]),
    element("UseableSubmodules", &[], &[("SubmoduleItemRef", Several)]),
    element("SubmoduleItemRef", &["SubmoduleItemTarget"], &[]),
    element("VirtualSubmoduleList", &[], &[("VirtualSubmoduleItem", Several)]),
    element("VirtualSubmoduleItem", &["ID", "SubmoduleIdentNumber"], SUBMODULE),
    element(
        "SystemDefinedSubmoduleList",
        &[],
        &[("InterfaceSubmoduleItem", Optional), ("PortSubmoduleItem", Any)],
    ),
    element(
        "InterfaceSubmoduleItem",
        &["ID", "SubmoduleIdentNumber", "TextId"],
        &[("RecordDataList", Optional), ("ApplicationRelations", Optional)],
    ),
    element("ApplicationRelations", &[], &[("TimingProperties", Optional)]),
    element("TimingProperties", &[], &[]),
    element(
        "PortSubmoduleItem",
        &["ID", "SubmoduleIdentNumber", "TextId"],
        &[("RecordDataList", Optional), ("MAUTypeList", Optional)],
    ),
    element("MAUTypeList", &[], &[("MAUTypeItem", Several)]),
    element("MAUTypeItem", &["Value"], &[]),
    element("ModuleList", &[], &[("ModuleItem", Several)]),
    element(
        "ModuleItem",
        &["ID", "ModuleIdentNumber"],
        &[
            ("ModuleInfo", One),
            ("SubslotList", Optional),
            ("UseableSubmodules", Optional),
            ("VirtualSubmoduleList", Optional),
            ("SystemDefinedSubmoduleList", Optional),
            ("Graphics", Optional),
        ],
    ),
    element("SubmoduleList", &[], &[("SubmoduleItem", Any)]),
    element("SubmoduleItem", &["ID", "SubmoduleIdentNumber"], SUBMODULE),
    element("IOData", &[], &[("Input", Optional), ("Output", Optional)]),
    element("Input", &[], ITEMS),
    element("Output", &[], ITEMS),
    element("DataItem", &["DataType", "TextId"], &[("BitDataItem", Any)]),
    element("BitDataItem", &["BitOffset", "TextId"], &[]),
    element("RecordDataList", &[], &[("ParameterRecordDataItem", Any)]),
    element(
        "ParameterRecordDataItem",
        &["Index", "Length"],
        &[
            ("Name", Optional),
            ("Const", Any),
            ("Ref", Any),
            ("MenuList", Optional),
        ],
    ),
    element("Const", &["Data"], &[]),
    element("Ref", &["DataType", "ByteOffset", "TextId"], &[]),
    element("MenuList", &[], &[("MenuItem", Several)]),
    element("MenuItem", &["ID"], &[("Name", One)]),
    element("ParameterRef", &["ParameterTarget"], &[]),
    element("MenuRef", &["MenuTarget"], &[]),
    element("ValueList", &[], &[("ValueItem", Several)]),
    element(
        "ValueItem",
        &["ID"],
        &[("Help", Optional), ("Assignments", Optional)],
    ),
    element("Assignments", &[], &[("Assign", Several)]),
    element("Assign", &["TextId", "Content"], &[]),
    element("ChannelDiagList", &[], &[("ChannelDiagItem", Any)]),
    element(
        "ChannelDiagItem",
        &["ErrorType"],
        &[
            ("Name", One),
            ("Help", Optional),
            ("ExtChannelDiagList", Optional),
        ],
    ),
    element("GraphicsList", &[], &[("GraphicItem", Several)]),
    element("GraphicItem", &["ID", "GraphicFile"], &[]),
    element("Graphics", &[], &[("GraphicItemRef", Several)]),
    element("GraphicItemRef", &["Type", "GraphicItemTarget"], &[]),
    element("CategoryList", &[], &[("CategoryItem", Several)]),
    element("CategoryItem", &["ID", "TextId"], &[]),
    element(
        "ExternalTextList",
        &[],
        &[("PrimaryLanguage", One), ("Language", Any)],
    ),
    element("PrimaryLanguage", &[], TEXTS),
    element("Language", &[], TEXTS),
    element("Text", &["TextId", "Value"], &[]),
];

/// Elements of the schema that are not looked at: their content and place are the business of what they are for.
const PASSED_OVER: &[&str] = &[
    "ARVendorBlock",
    "AdditionalInformation",
    "AvailableRecordDataList",
    "ChannelProcessAlarmList",
    "CIR_Support",
    "DataItemTextList",
    "DeviceManager",
    "DynamicReconfiguration",
    "Embedded",
    "ExtChannelDiagList",
    "ExternalProfileHandle",
    "F_ParameterRecordDataItem",
    "FieldbusIntegrationModule",
    "FieldbusIntegrationModuleList",
    "General",
    "IASInterfaceType",
    "IsochroneMode",
    "MediaRedundancy",
    "MrpInterconnection",
    "PROFIenergy",
    "ProfileChannelDiagItem",
    "ProfileDate",
    "ProfileUnitDiagTypeItem",
    "RT_Class3Properties",
    "RT_Class3TimingProperties",
    "ReportingSystemEvents",
    "SlotCluster",
    "SlotGroups",
    "SlotList",
    "SynchronisationMode",
    "SystemDefinedChannelDiagItem",
    "SystemRedundancy",
    "TimeSynchronisation",
    "UnitDiagTypeList",
];

/// Checks every element that the table contains.
pub(super) fn check(reader: &mut Reader<'_>, root: Node<'_, '_>) {
    for node in root.descendants().filter(Node::is_element) {
        let name = node.tag_name().name();
        let Some(rule) = ELEMENTS.iter().find(|rule| rule.name == name) else {
            continue;
        };
        attributes(reader, node, rule);
        if !rule.children.is_empty() {
            children(reader, node, rule);
        }
        let text = node
            .children()
            .find(|child| child.is_text() && child.text().is_some_and(|text| !text.trim().is_empty()));
        if let Some(text) = text
            && !rule.children.is_empty()
        {
            let message = format!("text in {name}, which has only elements");
            problem(reader, Severity::Error, Rule::Element, text, message);
        }
    }
}

fn problem(
    reader: &mut Reader<'_>,
    severity: Severity,
    rule: Rule,
    node: Node<'_, '_>,
    message: impl Into<String>,
) {
    reader.problem(severity, rule, node.range().start, message);
}

fn attributes(reader: &mut Reader<'_>, node: Node<'_, '_>, rule: &Element) {
    for wanted in rule.attributes {
        let has = |same: &dyn Fn(&str) -> bool| node.attributes().find(|found| same(found.name()));
        if has(&|name| name == *wanted).is_some() {
            continue;
        }
        let message = match has(&|name| name.eq_ignore_ascii_case(wanted)) {
            Some(near) => format!(
                "{} has no attribute {wanted}, but {}: case matters",
                rule.name,
                near.name()
            ),
            None => format!("{} has no attribute {wanted}", rule.name),
        };
        problem(reader, Severity::Error, Rule::Attribute, node, message);
    }
}

fn children(reader: &mut Reader<'_>, node: Node<'_, '_>, rule: &Element) {
    let place = |name: &str| rule.children.iter().position(|(known, _)| *known == name);
    let elements = || node.children().filter(Node::is_element);
    let mut last = 0;
    for child in elements() {
        let name = child.tag_name().name();
        match place(name) {
            Some(at) if at < last => {
                let (before, _) = rule.children.get(last).copied().unwrap_or(("", Any));
                let message = format!(
                    "{name} stands behind {before} in {}; the order is fixed",
                    rule.name
                );
                problem(reader, Severity::Error, Rule::Order, child, message);
            }
            Some(at) => last = at,
            None => misplaced(reader, child, rule),
        }
    }
    for (name, times) in rule.children {
        let mut found = elements().filter(|child| child.tag_name().name() == *name);
        let (first, second) = (found.next(), found.next());
        if first.is_none() && matches!(times, One | Several) {
            let message = format!("{} has no {name}", rule.name);
            problem(reader, Severity::Error, Rule::Element, node, message);
        }
        if let Some(second) = second
            && matches!(times, One | Optional)
        {
            let message = format!("a second {name} in {}", rule.name);
            problem(reader, Severity::Error, Rule::Element, second, message);
        }
    }
}

/// An element that the parent's rule does not name: one of a later schema, a misspelled one, or one at a wrong place.
fn misplaced(reader: &mut Reader<'_>, child: Node<'_, '_>, parent: &Element) {
    let name = child.tag_name().name();
    let near = parent
        .children
        .iter()
        .find(|(known, _)| known.eq_ignore_ascii_case(name));
    if let Some((near, _)) = near {
        let message = format!("{name} in {}: it is written {near}", parent.name);
        problem(reader, Severity::Error, Rule::Element, child, message);
    } else if !PASSED_OVER.contains(&name) && !ELEMENTS.iter().any(|rule| rule.name == name) {
        let message = format!("{} in {} is not known here", shortened(name), parent.name);
        problem(reader, Severity::Warning, Rule::Element, child, message);
    }
}
