// Generated from data/vlt/meanings.csv by `cargo run -p xtask -- gen`.

use crate::catalogue::Word;

#[rustfmt::skip]
pub static WORDS: &[Word] = &[
];

#[rustfmt::skip]
pub static NOT_NOW: &[(u16, &str)] = &[
];
