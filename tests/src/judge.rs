//! An independent dissector (tshark) checks every frame.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use profinet::MacAddress;

use crate::compare;

/// Severity numbers of the dissector's expert notes. Its filter engine takes numbers only.
const ERROR: &str = "8388608";
const WARNING: &str = "6291456";

/// Findings of the dissector in a capture.
#[derive(Debug, Clone, Default)]
pub struct Verdict {
    /// Frames read.
    pub frames: usize,
    /// Frames of each innermost protocol.
    pub protocols: BTreeMap<String, usize>,
    /// Malformed frames and error-level notes: frame number, info column, notes.
    pub errors: Vec<String>,
    /// Warning-level notes that are not among the known false alarms.
    pub warnings: Vec<String>,
    /// Frames with an objection that does not count: they have a pad octet, which the dissector does not expect.
    pub exempted: BTreeSet<usize>,
}

impl Verdict {
    /// Fails the test when a frame is malformed or carries an error-level note.
    #[track_caller]
    pub fn clean(&self) -> &Self {
        println!(
            "{} frames, {} with a pad octet not held against them",
            self.frames,
            self.exempted.len()
        );
        assert!(
            self.errors.is_empty(),
            "the dissector objects:\n{}",
            self.errors.join("\n")
        );
        self
    }

    /// Fails the test unless at least `count` frames of `protocol` were seen (`pn_dcp`, `pn_io`, `pn_rt`, ...).
    #[track_caller]
    pub fn saw(&self, protocol: &str, count: usize) -> &Self {
        let seen = self.protocols.get(protocol).copied().unwrap_or(0);
        assert!(
            seen >= count,
            "{seen} frames of {protocol}, expected {count}: {:?}",
            self.protocols
        );
        self
    }
}

/// Checks every frame of a capture.
#[must_use]
pub fn judge(capture: &Path) -> Verdict {
    let mut verdict = Verdict::default();
    for row in fields(capture, "frame", &["frame.protocols"]) {
        verdict.frames += 1;
        for protocol in row[0].split(':').collect::<BTreeSet<_>>() {
            *verdict.protocols.entry(protocol.to_owned()).or_default() += 1;
        }
    }
    let columns = ["frame.number", "_ws.col.Info", "_ws.expert.message"];
    let misread = compare::misread(capture);
    let mut remaining = |filter: &str| -> Vec<String> {
        let mut rows = fields(capture, filter, &columns);
        rows.retain(|row| {
            let number: usize = row[0].parse().unwrap();
            let padded = misread.padded.contains(&number) && out_of_step(&row[2]);
            if padded {
                verdict.exempted.insert(number);
            }
            let akd_written = row[1].contains("[Long frame (2 bytes)]") && row[2].starts_with("Long frame");
            !(padded || misread.written.contains(&number) && akd_written)
        });
        rows.into_iter().map(|row| row.join(" | ")).collect()
    };
    let errors = remaining(&format!("_ws.malformed || _ws.expert.severity=={ERROR}"));
    let warnings = remaining(&format!("_ws.expert.severity=={WARNING}"));
    verdict.errors = errors;
    verdict.warnings = warnings;
    verdict
}

/// Judges only frames that this station sent; those sent to it may be wrong on purpose.
#[must_use]
pub fn judge_of(capture: &Path, station: MacAddress) -> Verdict {
    let mut verdict = judge(capture);
    let sent: BTreeSet<String> = fields(capture, &format!("eth.src == {station}"), &["frame.number"])
        .into_iter()
        .flatten()
        .collect();
    let by_it = |note: &String| {
        note.split(" | ")
            .next()
            .is_some_and(|number| sent.contains(number))
    };
    verdict.errors.retain(by_it);
    verdict.warnings.retain(by_it);
    verdict
}

/// Returns whether all notes of the frame are of the kind that follows when the dissector takes a pad octet for the
/// next block: an unknown format, octets left over, or the end of the data before the end of the blocks.
fn out_of_step(notes: &str) -> bool {
    !notes.is_empty()
        && notes.split(',').all(|note| {
            note == "Long frame"
                || note.starts_with("Long frame (")
                || note.starts_with("Not supported or invalid format ")
                || note.starts_with("Malformed Packet")
        })
}

/// Returns the chosen fields of all frames that pass the filter; repeated fields are joined by commas.
#[must_use]
pub fn fields(capture: &Path, filter: &str, names: &[&str]) -> Vec<Vec<String>> {
    let mut command = Command::new("tshark");
    command
        .arg("-n")
        .arg("-r")
        .arg(capture)
        .args(["-Y", filter, "-T", "fields", "-E", "separator=/t"]);
    for name in names {
        command.args(["-e", name]);
    }
    let output = command
        .output()
        .unwrap_or_else(|e| panic!("cannot run tshark ({e}): run `make setup`"));
    assert!(
        output.status.success(),
        "tshark on {}: {}",
        capture.display(),
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8_lossy(&output.stdout)
        .lines()
        .map(|line| {
            let mut row: Vec<String> = line.split('\t').map(str::to_owned).collect();
            row.resize(names.len(), String::new());
            row
        })
        .collect()
}

/// One PROFIdrive parameter request or answer as the dissector reads it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParameterFrame {
    /// Frame number in the capture.
    pub frame: usize,
    /// Request reference.
    pub reference: u8,
    /// Request identifier, in a request.
    pub request_id: Option<u8>,
    /// Response identifier, in an answer.
    pub response_id: Option<u8>,
    /// Axis or drive object.
    pub axis: u8,
    /// Number of parameters.
    pub count: u8,
    /// Attribute, number of elements, PNU and subindex of each address.
    pub addresses: Vec<(u8, u8, u16, u16)>,
    /// Format and number of values of each value block.
    pub blocks: Vec<(u8, u8)>,
}

/// Returns all PROFIdrive parameter frames of a capture as the dissector reads them.
#[must_use]
pub fn parameter_frames(capture: &Path) -> Vec<ParameterFrame> {
    let names = [
        "frame.number",
        "pn_io.profidrive.parameter.request_reference",
        "pn_io.profidrive.parameter.request_id",
        "pn_io.profidrive.parameter.response_id",
        "pn_io.profidrive.parameter.do",
        "pn_io.profidrive.parameter.no_of_parameters",
        "pn_io.profidrive.parameter.attribute",
        "pn_io.profidrive.parameter.no_of_elems",
        "pn_io.profidrive.parameter.number",
        "pn_io.profidrive.parameter.index",
        "pn_io.profidrive.parameter.format",
        "pn_io.profidrive.parameter.no_of_values",
    ];
    fields(capture, "pn_io.profidrive.parameter.request_reference", &names)
        .into_iter()
        .map(|row| {
            let numbers = |i: usize| -> Vec<u16> {
                row[i]
                    .split(',')
                    .filter(|text| !text.is_empty())
                    .map(number)
                    .collect()
            };
            let octet = |i: usize| numbers(i).first().map(|n| u8::try_from(*n).unwrap());
            let octets =
                |i: usize| -> Vec<u8> { numbers(i).into_iter().map(|n| u8::try_from(n).unwrap()).collect() };
            let addresses = octets(6)
                .into_iter()
                .zip(octets(7))
                .zip(numbers(8).into_iter().zip(numbers(9)))
                .map(|((attribute, elements), (pnu, subindex))| (attribute, elements, pnu, subindex))
                .collect();
            ParameterFrame {
                frame: row[0].parse().unwrap(),
                reference: octet(1).unwrap(),
                request_id: octet(2),
                response_id: octet(3),
                axis: octet(4).unwrap(),
                count: octet(5).unwrap(),
                addresses,
                blocks: octets(10).into_iter().zip(octets(11)).collect(),
            }
        })
        .collect()
}

fn number(text: &str) -> u16 {
    let parsed = match text.strip_prefix("0x") {
        Some(hex) => u16::from_str_radix(hex, 16),
        None => text.parse(),
    };
    parsed.unwrap_or_else(|_| panic!("not a number from the dissector: {text:?}"))
}
