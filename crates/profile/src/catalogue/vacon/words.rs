// Generated from data/vacon/meanings.csv by `cargo run -p xtask -- gen`.

use crate::catalogue::{Word, WordKind};

#[rustfmt::skip]
pub static WORDS: &[Word] = &[
    Word { pnu: 10001, base: Some(15), kind: WordKind::Own, bits: &[], fields: &[] },
    Word { pnu: 10001, base: Some(16), kind: WordKind::Own, bits: &[], fields: &[] },
    Word { pnu: 10001, base: Some(43), kind: WordKind::Own, bits: &[], fields: &[] },
    Word { pnu: 10001, base: Some(864), kind: WordKind::Status, bits: &[], fields: &[] },
    Word { pnu: 10001, base: Some(874), kind: WordKind::Control, bits: &[], fields: &[] },
    Word { pnu: 10001, base: Some(2001), kind: WordKind::Control, bits: &[], fields: &[] },
    Word { pnu: 10001, base: Some(2002), kind: WordKind::Own, bits: &[], fields: &[] },
    Word { pnu: 10001, base: Some(2101), kind: WordKind::Status, bits: &[], fields: &[] },
    Word { pnu: 10001, base: Some(2102), kind: WordKind::Own, bits: &[], fields: &[] },
];

#[rustfmt::skip]
pub static NOT_NOW: &[(u16, &str)] = &[
];
