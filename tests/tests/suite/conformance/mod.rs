//! The conformance checklist of the drive profile: every line of the sample that concerns an AKD, a VLT, a Vacon, the
//! parameter channel (PKW) or the Danfoss FC protocol, each under its number.
//!
//! | section | lines | how |
//! |---|---|---|
//! | A to E, H: parameter channel, profile parameters, state machine, dialects | [`lines`] | our controller's raw requests and frames on a segment with the virtual drive |
//! | F: positioning | [`positioning`] | the same with telegram 9 of an AKD |
//! | G: parameter channel in process data, FC protocol | [`channel`] | PPO 1 of a VLT on a segment; raw telegrams at a serial line |
//!
//! Beside the checklist, [`statements`] walks the tables of the vendors' manuals: requests, replies and error numbers
//! of the FC parameter block, headers and addresses of VLT and Vacon.
//!
//! [`SAMPLE`] says for whom each line is; a line that is not walked for one of them is an error.

mod bench;
mod channel;
mod lines;
mod positioning;
mod statements;

use bench::Vendor::{self, Akd, Vacon, Vlt};
use bench::{AKD, Bench, DeviceUnderTest, VACON, VLT};

/// The lines of the sample and for whom they are. Line 64 is one of the standard device; a VLT keeps it too.
const SAMPLE: [(u16, &[Vendor]); 45] = [
    // A. Parameter access, block level
    (1, &[Akd, Vlt, Vacon]),
    (4, &[Akd, Vlt, Vacon]),
    (7, &[Akd, Vlt, Vacon]),
    (10, &[Akd, Vlt, Vacon]),
    (13, &[Akd, Vacon]),
    (16, &[Akd, Vlt, Vacon]),
    (19, &[Akd, Vlt, Vacon]),
    (22, &[Vlt, Vacon]),
    (25, &[Akd, Vlt, Vacon]),
    (28, &[Akd, Vacon]),
    (31, &[Akd]),
    (34, &[Akd, Vlt, Vacon]),
    (37, &[Vacon]),
    // B. Transport and timing
    (40, &[Akd, Vlt, Vacon]),
    (43, &[Akd, Vacon]),
    // C. Description and text
    (46, &[Akd, Vlt, Vacon]),
    (49, &[Vlt]),
    (52, &[Akd, Vacon]),
    // D. Profile parameters
    (55, &[Akd, Vlt, Vacon]),
    (58, &[Akd, Vlt, Vacon]),
    (61, &[Akd, Vlt, Vacon]),
    (64, &[Vlt]),
    (67, &[Akd, Vacon]),
    (70, &[Akd]),
    (73, &[Vacon]),
    // E. State machine
    (76, &[Akd, Vlt, Vacon]),
    (79, &[Akd, Vlt, Vacon]),
    (82, &[Akd, Vlt, Vacon]),
    (85, &[Akd, Vlt, Vacon]),
    (88, &[Akd, Vlt, Vacon]),
    (91, &[Akd, Vlt, Vacon]),
    (94, &[Akd, Vlt, Vacon]),
    (97, &[Akd, Vlt, Vacon]),
    (100, &[Vlt, Vacon]),
    // F. Positioning
    (103, &[Akd]),
    (106, &[Akd]),
    (109, &[Akd]),
    // G. Parameter channel, PPO, FC protocol: `channel` walks them one by one
    (112, &[Vlt]),
    (115, &[Vlt]),
    (118, &[Vlt]),
    (121, &[Vlt]),
    (124, &[Vlt]),
    // H. Dialects
    (127, &[Vacon]),
    (130, &[Vlt]),
    (133, &[Akd]),
];

/// Walks all lines of one vendor; every number of the sample must come.
fn walk(dut: &'static DeviceUnderTest) {
    let mut failed = Vec::new();
    let mut walked = Vec::new();
    let mut take = |number, check: &mut dyn FnMut()| {
        walked.push(number);
        let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(check));
        if caught.is_err() {
            failed.push(number);
        }
    };
    for line in lines::LINES
        .iter()
        .filter(|line| line.vendors.contains(&dut.vendor))
    {
        take(line.number, &mut || (line.check)(&mut Bench::new(dut)));
    }
    if dut.vendor == Akd {
        for (number, check) in positioning::LINES {
            take(number, &mut || check());
        }
    }
    if dut.vendor == Vlt {
        for (number, check) in channel::LINES {
            take(number, &mut || check());
        }
    }
    walked.sort_unstable();
    walked.dedup();
    let model = dut.model.catalogue.model;
    assert!(failed.is_empty(), "{model}: lines {failed:?}");
    let mine = SAMPLE.iter().filter(|(_, vendors)| vendors.contains(&dut.vendor));
    let expected: Vec<u16> = mine.map(|(number, _)| *number).collect();
    assert_eq!(walked, expected, "{model}");
    bench::judged(model);
}

#[test]
fn the_akd_keeps_every_line() {
    walk(&AKD);
}

#[test]
fn the_vlt_keeps_every_line() {
    walk(&VLT);
}

#[test]
fn the_vacon_keeps_every_line() {
    walk(&VACON);
}
