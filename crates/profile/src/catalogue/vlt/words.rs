// Generated from data/vlt/meanings.csv by `cargo run -p xtask -- gen`.

use super::meanings::*;
use crate::catalogue::{Word, WordKind};

#[rustfmt::skip]
pub static WORDS: &[Word] = &[
    Word { pnu: 590, base: None, kind: WordKind::Own, bits: &[], fields: &[] },
    Word { pnu: 953, base: None, kind: WordKind::Own, bits: &[], fields: &[] },
    Word { pnu: 967, base: None, kind: WordKind::Control, bits: &[], fields: &[] },
    Word { pnu: 968, base: None, kind: WordKind::Status, bits: &[], fields: &[] },
    Word { pnu: 1600, base: None, kind: WordKind::Control, bits: &[], fields: &[] },
    Word { pnu: 1603, base: None, kind: WordKind::Status, bits: &[], fields: &[] },
    Word { pnu: 1660, base: None, kind: WordKind::Own, bits: &[], fields: &[] },
    Word { pnu: 1666, base: None, kind: WordKind::Own, bits: &[], fields: &[] },
    Word { pnu: 1671, base: None, kind: WordKind::Own, bits: &[], fields: &[] },
    Word { pnu: 1680, base: None, kind: WordKind::Control, bits: &[], fields: &[] },
    Word { pnu: 1684, base: None, kind: WordKind::Status, bits: &[], fields: &[] },
    Word { pnu: 1685, base: None, kind: WordKind::Own, bits: &[], fields: &[] },
    Word { pnu: 1690, base: None, kind: WordKind::Own, bits: P1690_BITS, fields: &[] },
    Word { pnu: 1692, base: None, kind: WordKind::Own, bits: P1692_BITS, fields: &[] },
    Word { pnu: 1694, base: None, kind: WordKind::Own, bits: &[], fields: &[] },
];

#[rustfmt::skip]
pub static NOT_NOW: &[(u16, &str)] = &[
];
