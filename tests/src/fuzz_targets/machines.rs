//! Machine files.

use std::collections::BTreeSet;

use profidrive::machine::{Machine, MachineProblem};

/// A machine file: a mistake is reported with a line of the text; of what is accepted each drive has a name of its own, its line,
/// and no bound above its own highest speed.
pub fn machine(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let lines = 1 + text.bytes().filter(|octet| *octet == b'\n').count();
    let machine = match text.parse::<Machine>() {
        Ok(machine) => machine,
        Err(MachineProblem { line, message }) => {
            assert!((1..=lines).contains(&line), "{line} of {lines} lines: {message}");
            return;
        }
    };
    let names: BTreeSet<&str> = machine.drives.iter().map(|drive| drive.name.as_str()).collect();
    assert_eq!(names.len(), machine.drives.len());
    for drive in &machine.drives {
        assert!((1..=lines).contains(&drive.line), "{drive:?}");
        if let (Some(own), Some(bound)) = (drive.max_speed, machine.bound(&drive.name)) {
            assert!(bound.rpm <= own.rpm, "{drive:?}");
        }
    }
}
