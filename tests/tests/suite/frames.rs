//! The tree of a frame against the dissector's: the same fields at the same octets.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use dissect::capture::Walker;
use dissect::tree::Node;
use network::pcap::Reader;
use system_tests::{built, capture_files, memory};

/// The dissector's name of a field and those of the tree.
const NAMES: &[(&str, &[&str])] = &[
    ("pn_dcp.service_id", &["DCP ServiceID"]),
    ("pn_dcp.service_type", &["DCP ServiceType"]),
    ("pn_dcp.xid", &["DCP Xid"]),
    ("pn_dcp.data_length", &["DCPDataLength"]),
    ("pn_dcp.block_length", &["DCPBlockLength"]),
    ("pn_io.block_type", &["BlockType", "alarm BlockType"]),
    ("pn_io.block_length", &["BlockLength", "alarm BlockLength"]),
    ("pn_io.api", &["API", "alarm API"]),
    ("pn_io.slot_nr", &["SlotNumber", "alarm slot"]),
    ("pn_io.subslot_nr", &["SubslotNumber", "alarm subslot"]),
    (
        "pn_io.module_ident_number",
        &["ModuleIdentNumber", "alarm ModuleIdentNumber"],
    ),
    ("pn_io.index", &["Index"]),
    ("pn_io.record_data_length", &["RecordDataLength"]),
    ("pn_io.ar_uuid", &["ARUUID"]),
    ("pn_io.session_key", &["SessionKey"]),
    ("pn_io.iocr_type", &["IOCRType"]),
    ("pn_io.iocr_reference", &["IOCRReference"]),
    ("pn_io.watchdog_factor", &["WatchdogFactor"]),
    ("pn_io.number_of_io_data_objects", &["NumberOfIODataObjects"]),
    (
        "pn_io.cminitiator_station_name",
        &["CMInitiatorStationName", "CMResponderStationName"],
    ),
    ("pn_io.alarm_type", &["AlarmType"]),
    ("pn_rt.cycle_counter", &["CycleCounter"]),
    ("pn_rt.ds", &["DataStatus"]),
    ("pn_rt.transfer_status", &["TransferStatus"]),
    ("pn_io.profidrive.parameter.request_reference", &["reference"]),
    ("pn_io.profidrive.parameter.attribute", &["attribute"]),
    ("pn_io.profidrive.parameter.no_of_elems", &["number of elements"]),
    ("pn_io.profidrive.parameter.number", &["PNU"]),
    ("pn_io.profidrive.parameter.index", &["subindex"]),
    ("pn_dcp.suboption_device_nameofstation", &["name of station"]),
    ("lldp.tlv.type", &["type and length"]),
];

/// Fields by the dissector's name: first octet, number of octets and value of each.
type Fields = BTreeMap<&'static str, BTreeSet<(usize, usize, String)>>;

/// Fields whose value is a number or a name on both sides.
const VALUES: &[&str] = &[
    "pn_dcp.xid",
    "pn_dcp.suboption_device_nameofstation",
    "pn_io.slot_nr",
    "pn_io.session_key",
    "pn_io.watchdog_factor",
    "pn_io.record_data_length",
    "pn_io.cminitiator_station_name",
    "pn_io.ar_uuid",
    "pn_rt.cycle_counter",
    "pn_io.profidrive.parameter.number",
    "pn_io.profidrive.parameter.index",
];

fn add(fields: &mut Fields, name: &'static str, start: usize, length: usize, value: &str) {
    let value = if VALUES.contains(&name) {
        plain(value)
    } else {
        String::new()
    };
    fields.entry(name).or_default().insert((start, length, value));
}

/// `18 (0x0012)`, `0x0012`, `"akd-1"`: the number in decimal, or the text.
fn plain(value: &str) -> String {
    let number = value.split_once(" (0x").map_or(value, |(number, _)| number);
    match number.strip_prefix("0x").map(|hex| u64::from_str_radix(hex, 16)) {
        Some(Ok(number)) => number.to_string(),
        _ => number.trim_matches('"').to_owned(),
    }
}

fn of_tree(node: &Node, fields: &mut Fields) {
    if let Some((name, _)) = NAMES.iter().find(|(_, ours)| ours.contains(&node.name.as_str())) {
        add(fields, name, node.start, node.end - node.start, &node.value);
    }
    for child in &node.children {
        assert!(node.start <= child.start && child.end <= node.end, "{node:?}");
        assert!(child.weight <= node.weight, "{node:?}");
        of_tree(child, fields);
    }
}

/// Returns the fields of one `<packet>`; `None` where the frame reports another one inside of it (ICMP).
fn of_packet(packet: &str) -> Option<Fields> {
    let mut fields = Fields::default();
    for element in packet.split("<field ").skip(1) {
        let attribute = |name: &str| {
            let value = element.split_once(name)?.1;
            Some(value.split_once('"')?.0)
        };
        let number = |name| attribute(name).and_then(|text| text.parse().ok());
        let theirs = attribute("name=\"");
        let known = NAMES.iter().find(|(name, _)| theirs == Some(name));
        // the dissector gives what it concludes from other frames no octets
        if let (Some((name, _)), Some(start), Some(1..)) = (known, number("pos=\""), number("size=\"")) {
            let (size, shown) = (number("size=\"").unwrap_or_default(), attribute("show=\""));
            add(&mut fields, name, start, size, shown.unwrap_or_default());
        }
    }
    (!packet.contains("<proto name=\"icmp\"")).then_some(fields)
}

fn dissected(file: &Path) -> Vec<Option<Fields>> {
    let output = Command::new("tshark")
        .args(["-n", "-T", "pdml", "-r"])
        .arg(file)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8_lossy(&output.stdout);
    text.split("<packet>").skip(1).map(of_packet).collect()
}

/// Compares each frame and returns how many fields of each name were equal.
fn compare(file: &Path) -> BTreeMap<&'static str, usize> {
    let mut equal = BTreeMap::new();
    let mut walker = Walker::new(None);
    let captured = Reader::new(std::fs::File::open(file).unwrap()).unwrap();
    let theirs = dissected(file);
    let mut frames = 0;
    for (captured, theirs) in captured.zip(&theirs) {
        let frame = captured.unwrap().frame;
        frames += 1;
        walker.frame(Duration::ZERO, &frame);
        let mut ours = Fields::default();
        of_tree(&walker.tree(&frame), &mut ours);
        let Some(theirs) = theirs else { continue };
        assert_eq!(&ours, theirs, "{} frame {frames}", file.display());
        for (name, places) in ours {
            *equal.entry(name).or_default() += places.len();
        }
    }
    assert_eq!(frames, theirs.len());
    equal
}

#[test]
fn every_field_is_where_the_dissector_has_it() {
    let demo = memory::scratch("fields.pcapng");
    let _ = std::fs::remove_file(&demo);
    let made = Command::new(built("profidrive"))
        .args(["demo", "--fast", "--pcap"])
        .arg(&demo)
        .output()
        .unwrap();
    assert!(made.status.success());
    let mut equal = compare(&demo);
    for file in capture_files() {
        for (name, count) in compare(&file) {
            *equal.entry(name).or_default() += count;
        }
    }
    let missing: Vec<&str> = NAMES
        .iter()
        .map(|(name, _)| *name)
        .filter(|name| !equal.contains_key(name))
        .collect();
    assert_eq!(missing, Vec::<&str>::new(), "no capture has them");
}
