//! Rules beyond the schema: what values must agree with each other.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use roxmltree::Node;

use crate::data::Consistency;
use crate::file_name::FileName;
use crate::model::{AccessPoint, Gsdml, Interface, MAIN_FAMILIES, Module, ModuleRef, Submodule};
use crate::problem::{Rule, Severity};
use crate::read::{Reader, child, is};
use crate::value::{SchemaVersion, ValueList, shortened};
use crate::write::{HEADER, REFERENCE};

/// API of PROFIdrive.
const PROFIDRIVE: u32 = 0x3A00;
/// Shortest record length every controller may request.
const RECORD: u32 = 4068;
/// Most octets of cyclic data in one frame.
const FRAME: u16 = 1440;
/// Elements whose identifiers are those of objects, each unique in the file. The `ID` of other elements has a scope of its
/// own: parameters and menus in their record, modes and measurements of PROFIenergy are numbers in their list.
const OBJECTS: [&str; 9] = [
    "DeviceAccessPointItem",
    "ModuleItem",
    "VirtualSubmoduleItem",
    "SubmoduleItem",
    "InterfaceSubmoduleItem",
    "PortSubmoduleItem",
    "ValueItem",
    "GraphicItem",
    "CategoryItem",
];
/// First octet of each element with an identifier.
type Places<'a> = BTreeMap<(&'a str, &'a str), usize>;

/// The check in progress.
struct Check<'r, 's, 'a> {
    reader: &'r mut Reader<'s>,
    places: Places<'a>,
    /// Modules with the octets they need, by their identifiers.
    modules: BTreeMap<&'a str, (u32, u32)>,
    /// Modules that an access point names.
    used: BTreeSet<&'a str>,
}

pub(super) fn check<'a>(reader: &mut Reader<'_>, root: Node<'a, 'a>, gsdml: &'a Gsdml) {
    let mut places = Places::new();
    let mut seen: BTreeMap<&str, &str> = BTreeMap::new();
    for node in root.descendants().filter(Node::is_element) {
        let name = node.tag_name().name();
        let Some(id) = node.attribute("ID") else { continue };
        if !OBJECTS.contains(&name) {
            continue;
        }
        let at = node.range().start;
        places.entry((name, id)).or_insert(at);
        if let Some(other) = seen.insert(id, name) {
            let message = format!("identifier `{}` is that of a {other} too", shortened(id));
            reader.problem(Severity::Error, Rule::Identifier, at, message);
        }
    }
    let modules = gsdml.modules.iter();
    let references = gsdml.access_points.iter().flat_map(|point| &point.modules);
    let mut check = Check {
        reader,
        places,
        modules: modules
            .map(|module| (module.id.as_str(), module.own_octets()))
            .collect(),
        used: references.map(|reference| reference.target.as_str()).collect(),
    };
    check.header(root);
    check.whole(root, gsdml);
    for point in &gsdml.access_points {
        check.access_point(gsdml, point);
    }
    for module in &gsdml.modules {
        check.module(module);
    }
    for submodule in &gsdml.submodules {
        check.submodule("SubmoduleItem", submodule);
    }
    check.pictures(gsdml);
}

impl Check<'_, '_, '_> {
    fn at(&self, element: &str, id: &str) -> usize {
        self.places.get(&(element, id)).copied().unwrap_or(0)
    }

    fn error(&mut self, rule: Rule, at: usize, message: impl Into<String>) {
        self.reader.problem(Severity::Error, rule, at, message);
    }

    fn warning(&mut self, rule: Rule, at: usize, message: impl Into<String>) {
        self.reader.problem(Severity::Warning, rule, at, message);
    }

    /// The fixed texts.
    fn header(&mut self, root: Node<'_, '_>) {
        let Some(header) = child(root, "ProfileHeader") else {
            return;
        };
        let reference = child(header, "ISO15745Reference");
        let wanted = HEADER.iter().map(|row| (Some(header), row));
        let wanted = wanted.chain(REFERENCE.iter().map(|row| (reference, row)));
        for (parent, (name, text)) in wanted {
            let Some(node) = parent.and_then(|parent| child(parent, name)) else {
                continue;
            };
            let found = node.text().unwrap_or_default().trim();
            // the name of the organisation is written in several ways
            if found != *text && *name != "ProfileSource" {
                let message = format!("{name} is `{}`; it must be `{text}`", shortened(found));
                self.error(Rule::Value, node.range().start, message);
            }
        }
    }

    fn whole(&mut self, root: Node<'_, '_>, gsdml: &Gsdml) {
        let at = root.range().start;
        match gsdml.schema_version {
            None => self.error(
                Rule::Version,
                at,
                "xsi:schemaLocation does not end in GSDML-DeviceProfile-Vx.yy.xsd",
            ),
            Some(version) if version.major() != 2 => {
                let message = format!("schema {version}; this program knows versions 2.x");
                self.warning(Rule::Version, at, message);
            }
            Some(_) => {}
        }
        let function = root
            .descendants()
            .find(|node| is(*node, "Family") && node.attribute("MainFamily").is_some());
        let known = MAIN_FAMILIES.contains(&gsdml.family.main.as_str());
        if let Some(node) = function
            && !known
        {
            let message = format!(
                "MainFamily `{}` is not one of the standard",
                shortened(&gsdml.family.main)
            );
            self.error(Rule::Value, node.range().start, message);
        }
    }

    fn access_point(&mut self, gsdml: &Gsdml, point: &AccessPoint) {
        let at = self.at("DeviceAccessPointItem", &point.id);
        let physical = merged(&point.physical_slots);
        for (first, last) in point.fixed_in_slots.ranges() {
            if !covers(&physical, *first, *last) {
                let message = format!("FixedInSlots {first}..{last} is not within PhysicalSlots");
                self.error(Rule::Value, at, message);
            }
        }
        if let Some(name) = &point.dns_name
            && !is_station_name(name)
        {
            let message = format!(
                "DNS_CompatibleName `{}` is not a valid station name",
                shortened(name)
            );
            self.error(Rule::Value, at, message);
        }
        if point.min_device_interval == 0 {
            self.error(Rule::Value, at, "MinDeviceInterval is 0");
        }
        if point.max_record.is_some_and(|most| most < RECORD) {
            let message = format!("MaxSupportedRecordSize is below {RECORD}; tools refuse that");
            self.error(Rule::Value, at, message);
        }
        if !point.address_assignment.iter().any(|way| way == "DCP") {
            self.error(Rule::Value, at, "AddressAssignment has no DCP");
        }
        self.versions(gsdml, point, at);
        self.lengths(point, at);
        for reference in &point.modules {
            self.module_slots(&physical, reference, at);
        }
        self.subslots(&point.virtual_submodules, at);
        for submodule in &point.virtual_submodules {
            self.submodule("VirtualSubmoduleItem", submodule);
        }
        if let Some(interface) = &point.interface {
            self.interface(point, interface);
        }
        let mut subslots = BTreeSet::new();
        for port in &point.ports {
            let at = self.at("PortSubmoduleItem", &port.id);
            if !(0x8001..=0x8FFF).contains(&port.subslot) {
                let message = format!("subslot {:#06x} is none of a port", port.subslot);
                self.error(Rule::Value, at, message);
            }
            if !subslots.insert(port.subslot) {
                let message = format!("two ports in subslot {:#06x}", port.subslot);
                self.error(Rule::Value, at, message);
            }
        }
    }

    /// Versions, and what PNIO version 2.31 makes mandatory.
    fn versions(&mut self, gsdml: &Gsdml, point: &AccessPoint, at: usize) {
        let Some(schema) = gsdml.schema_version else {
            return;
        };
        for (name, version) in [
            ("PNIO_Version", point.pnio_version),
            ("RequiredSchemaVersion", point.required_schema),
        ] {
            if let Some(version) = version.filter(|version| !schema.at_least(*version)) {
                let message = format!("{name} {version} is newer than the schema of the file, {schema}");
                self.error(Rule::Version, at, message);
            }
        }
        let new = |version: SchemaVersion| version.at_least(SchemaVersion::V2_31);
        if !point.pnio_version.is_some_and(new) {
            return;
        }
        let interface = point.interface.as_ref();
        let needed = [
            (point.features.multiple_write, "MultipleWriteSupported=\"true\""),
            (point.features.lldp_nod, "LLDP_NoD_Supported=\"true\""),
            (point.reset_modes.contains(2), "ResetToFactoryModes with mode 2"),
            (point.certification.is_some(), "CertificationInfo"),
            (
                interface.is_none_or(|interface| interface.ptp_boundary),
                "PTP_BoundarySupported=\"true\"",
            ),
            (
                interface.is_none_or(|interface| interface.dcp_boundary),
                "DCP_BoundarySupported=\"true\"",
            ),
        ];
        for (kept, what) in needed {
            if !kept {
                let message = format!("from PNIO_Version V2.31 on there must be {what}");
                self.error(Rule::Version, at, message);
            }
        }
    }

    /// The most octets of cyclic data are enough for each module.
    fn lengths(&mut self, point: &AccessPoint, at: usize) {
        let limits = point.io_limits;
        for (name, most) in [
            ("MaxInputLength", limits.input),
            ("MaxOutputLength", limits.output),
        ] {
            if most > FRAME {
                let message = format!("{name} {most}; a frame has at most {FRAME} octets");
                self.error(Rule::Length, at, message);
            }
        }
        let own = point.own_octets();
        for reference in &point.modules {
            let Some(octets) = self.modules.get(reference.target.as_str()) else {
                continue;
            };
            let needed = (own.0.saturating_add(octets.0), own.1.saturating_add(octets.1));
            if needed.0 > u32::from(limits.input) || needed.1 > u32::from(limits.output) {
                let message = format!(
                    "module `{}` needs {} octets of input and {} of output with all status octets, IOConfigData allows {} and {}",
                    shortened(&reference.target),
                    needed.0,
                    needed.1,
                    limits.input,
                    limits.output
                );
                self.error(Rule::Length, at, message);
            }
        }
    }

    fn module_slots(&mut self, physical: &[(u32, u32)], reference: &ModuleRef, at: usize) {
        let lists = [&reference.allowed, &reference.used, &reference.fixed];
        if lists.iter().all(|list| list.is_empty()) {
            let message = format!("module `{}` fits nowhere", shortened(&reference.target));
            self.error(Rule::Value, at, message);
        }
        for (first, last) in lists.iter().flat_map(|list| list.ranges()) {
            if !covers(physical, *first, *last) {
                let message = format!(
                    "module `{}` in slots {first}..{last}, which are not within PhysicalSlots",
                    shortened(&reference.target)
                );
                self.error(Rule::Value, at, message);
            }
        }
    }

    fn interface(&mut self, point: &AccessPoint, interface: &Interface) {
        let at = self.at("InterfaceSubmoduleItem", &interface.id);
        if !(0x8000..=0x8F00).contains(&interface.subslot) {
            let message = format!("subslot {:#06x} is none of an interface", interface.subslot);
            self.error(Rule::Value, at, message);
        }
        if !interface.rt_classes.iter().any(|class| class == "RT_CLASS_1") {
            self.error(Rule::Value, at, "SupportedRT_Classes has no RT_CLASS_1");
        }
        for mode in &interface.start_up {
            if !matches!(mode.as_str(), "Legacy" | "Advanced") {
                let message = format!("StartupMode `{}` is not known", shortened(mode));
                self.error(Rule::Value, at, message);
            }
        }
        if !interface.start_up.iter().any(|mode| mode == "Legacy") {
            self.warning(
                Rule::Value,
                at,
                "StartupMode without Legacy: controllers without the advanced start-up cannot connect",
            );
        }
        let slowest = interface.send_clocks.max().unwrap_or(0);
        let slowest = slowest.saturating_mul(interface.reduction_ratios.max().unwrap_or(0));
        if slowest < u32::from(point.min_device_interval) {
            let message = format!(
                "no send clock and reduction ratio reach MinDeviceInterval {}",
                point.min_device_interval
            );
            self.error(Rule::Value, at, message);
        }
        if !interface.send_clocks.contains(32) {
            self.error(Rule::Value, at, "SendClock has no 32 (1 ms), which is mandatory");
        }
    }

    fn module(&mut self, module: &Module) {
        let at = self.at("ModuleItem", &module.id);
        self.subslots(&module.virtual_submodules, at);
        let mut apis = module.virtual_submodules.iter().map(|submodule| submodule.api);
        let first = apis.next();
        if first.is_some_and(|first| apis.any(|api| api != first)) {
            self.error(
                Rule::Value,
                at,
                "submodules of different API in one module: a slot belongs to one API",
            );
        }
        if module.virtual_submodules.is_empty() && module.submodules.is_empty() {
            self.warning(Rule::Element, at, "a module without any submodule");
        }
        if !self.used.contains(module.id.as_str()) {
            self.warning(Rule::Reference, at, "no access point names this module");
        }
        for submodule in &module.virtual_submodules {
            self.submodule("VirtualSubmoduleItem", submodule);
        }
    }

    fn submodule(&mut self, element: &str, submodule: &Submodule) {
        let at = self.at(element, &submodule.id);
        for record in &submodule.records {
            if record.index > 0x7FFF {
                let message = format!("record {}: parameter records end at 32767", record.index);
                self.error(Rule::Value, at, message);
            }
            if record.length == 0 {
                let message = format!("record {} has no octets", record.index);
                self.error(Rule::Length, at, message);
            }
        }
        let data = [&submodule.io.input, &submodule.io.output];
        let loose = |data: &crate::data::DataDescription| {
            data.consistency == Consistency::Item && data.items.len() > 1
        };
        if submodule.api == PROFIDRIVE && data.into_iter().flatten().any(loose) {
            self.warning(
                Rule::Value,
                at,
                "a telegram without \"All items consistency\": words of different cycles may mix",
            );
        }
        if submodule
            .writable_im
            .ranges()
            .iter()
            .any(|(first, last)| *first == 0 || *last > 15)
        {
            self.error(
                Rule::Value,
                at,
                "Writeable_IM_Records: I&M1 to I&M15 may be writable",
            );
        }
    }

    /// No two submodules in one subslot.
    fn subslots(&mut self, submodules: &[Submodule], at: usize) {
        let ranges = submodules.iter().flat_map(|submodule| {
            let ranges = submodule.fixed_in_subslots.ranges();
            ranges.iter().map(move |range| (*range, submodule.id.as_str()))
        });
        let mut ranges: Vec<((u32, u32), &str)> = ranges.collect();
        ranges.sort();
        for pair in ranges.windows(2) {
            if let [((_, end), _), ((first, _), id)] = pair
                && first <= end
            {
                let id = shortened(id);
                let message = format!("submodule `{id}` in subslot {first}, where another one is");
                self.error(Rule::Value, at, message);
            }
        }
    }

    fn pictures(&mut self, gsdml: &Gsdml) {
        let identity = &gsdml.identity;
        let prefix = FileName::picture(identity.vendor_id, identity.device_id, "");
        for graphic in &gsdml.graphics {
            let at = self.at("GraphicItem", &graphic.id);
            let starts = graphic
                .file
                .get(..prefix.len())
                .is_some_and(|start| start.eq_ignore_ascii_case(&prefix));
            if !starts {
                let message = format!(
                    "GraphicFile `{}` does not begin with {prefix}",
                    shortened(&graphic.file)
                );
                self.warning(Rule::FileName, at, message);
            }
            if graphic.file.contains(['/', '\\', ':']) {
                self.error(Rule::FileName, at, "GraphicFile is a name without folder");
            }
        }
    }
}

/// Returns the ranges of a list in order, those that touch put together.
fn merged(list: &ValueList) -> Vec<(u32, u32)> {
    let mut ranges = list.ranges().to_vec();
    ranges.sort_unstable();
    let mut merged: Vec<(u32, u32)> = Vec::new();
    for (first, last) in ranges {
        match merged.last_mut() {
            Some((_, end)) if first <= end.saturating_add(1) => *end = last.max(*end),
            _ => merged.push((first, last)),
        }
    }
    merged
}

/// Returns whether all numbers of a range are in merged ranges.
fn covers(merged: &[(u32, u32)], first: u32, last: u32) -> bool {
    let at = merged.partition_point(|(_, end)| *end < first);
    merged
        .get(at)
        .is_some_and(|(start, end)| *start <= first && last <= *end)
}

/// Returns whether a name of station is valid: labels of a-z, 0-9 and hyphens inside, between dots.
fn is_station_name(name: &str) -> bool {
    let label = |label: &str| {
        (1..=63).contains(&label.len())
            && label
                .bytes()
                .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'-')
            && !label.starts_with('-')
            && !label.ends_with('-')
    };
    name.len() <= 240 && name.split('.').all(label)
}
