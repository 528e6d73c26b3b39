// Generated from data/akd/meanings.csv by `cargo run -p xtask -- gen`.

use super::meanings::*;
use crate::catalogue::{Field, Word, WordKind};

#[rustfmt::skip]
pub static WORDS: &[Word] = &[
    Word { pnu: 1, base: None, kind: WordKind::Control, bits: &[], fields: &[] },
    Word { pnu: 2, base: None, kind: WordKind::Status, bits: &[], fields: &[] },
    Word { pnu: 32, base: None, kind: WordKind::Own, bits: SATZANW_BITS, fields: &[Field { first: 0, last: 14, name: "Motion task", choices: &[] }, ] },
    Word { pnu: 33, base: None, kind: WordKind::Own, bits: AKTSATZ_BITS, fields: &[Field { first: 0, last: 14, name: "Motion task that runs", choices: AKTSATZ_CHOICE_0_14 }, ] },
    Word { pnu: 38, base: None, kind: WordKind::Own, bits: MDI_MOD_BITS, fields: &[] },
    Word { pnu: 105, base: None, kind: WordKind::Own, bits: DRV_MOTIONSTAT_BITS, fields: &[] },
    Word { pnu: 106, base: None, kind: WordKind::Own, bits: DRIVE_INPUTS_BITS, fields: &[] },
    Word { pnu: 2120, base: None, kind: WordKind::Own, bits: DRV_DISSOURCES_BITS, fields: &[] },
    Word { pnu: 2134, base: None, kind: WordKind::Own, bits: DRV_MOTIONSTAT_BITS, fields: &[] },
    Word { pnu: 2158, base: None, kind: WordKind::Own, bits: FBUS_PARAM02_BITS, fields: &[] },
    Word { pnu: 2266, base: None, kind: WordKind::Own, bits: MT_CNTL_BITS, fields: &[Field { first: 0, last: 3, name: "Task type", choices: MT_CNTL_CHOICE_0_3 }, Field { first: 5, last: 9, name: "Start of the following task", choices: MT_CNTL_CHOICE_5_9 }, Field { first: 10, last: 11, name: "Acceleration type", choices: MT_CNTL_CHOICE_10_11 }, ] },
    Word { pnu: 2387, base: None, kind: WordKind::Own, bits: SWLS_STATE_BITS, fields: &[] },
    Word { pnu: 2891, base: None, kind: WordKind::Own, bits: &[], fields: &[] },
];

#[rustfmt::skip]
pub static NOT_NOW: &[(u16, &str)] = &[
    (5, "a controller is connected, and only its telegram gives this setpoint: change it there, or write it while none is"),
    (32, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (34, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (35, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (36, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (37, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (38, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (100, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (101, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (102, "a controller is connected, and only its telegram gives this setpoint: change it there, or write it while none is"),
    (103, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (108, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (109, "the controller's telegram carries it: change it there, or write it while no controller exchanges data"),
    (915, "the telegram in use has a fixed mapping: select telegram 0 or 400 with PNU 922 first, while no controller exchanges data"),
    (916, "the telegram in use has a fixed mapping: select telegram 0 or 400 with PNU 922 first, while no controller exchanges data"),
    (922, "the telegram changes only while no controller exchanges data: stop it first ({status} shows which it is)"),
    (2008, "a virtual drive does not simulate this command"),
    (2023, "a virtual drive has no excitation of the motor: 0 (off) is its only value"),
    (2028, "a virtual drive has no capture engine: 0 (off) is its only value"),
    (2041, "a virtual drive has no capture engine: 0 (off) is its only value"),
    (2127, "the drive enables itself only without a fault and a hardware disable, and only while no controller commands it (DRV.CMDSOURCE 0); {status} shows what prevents it, {run} takes it as its controller"),
    (2139, "a virtual drive has no commutation procedure: 0 (off) is its only value"),
    (2149, "a virtual drive has no search of the commutation angle: 0 (off) is its only value"),
    (2189, "a virtual drive does not simulate this command"),
    (2272, "a task starts only in position mode while the drive is enabled (S4)"),
    (2327, "a virtual drive has no position limit switches of PLS.*: PLS.STATE is always 0"),
    (2360, "a virtual drive does not simulate this command"),
    (2376, "a virtual drive has no service motion: {jog} and {move} turn the motor"),
    (2445, "a virtual drive does not simulate this command"),
    (2629, "a virtual drive does not simulate this command"),
    (2836, "a controller is connected, and another address would end its connection: stop it first ({status} shows which it is)"),
    (2842, "a virtual drive does not simulate this command"),
    (2843, "a virtual drive does not simulate this command"),
    (2879, "a virtual drive does not simulate this command"),
    (2914, "a virtual drive has no compare engine: 0 (off) is its only value"),
    (2915, "a virtual drive has no compare engine: 0 (off) is its only value"),
    (2951, "a virtual drive does not simulate this command"),
];
