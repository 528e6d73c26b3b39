//! Control and status words, states: what the bits say to a person.

use profidrive::state::Mode;
use profidrive::state::bits::{self, Bit};
use serde_json::{Value, json};

use super::{hex16, nibbles};

/// The bits of control word 1 in speed control mode.
pub fn stw1_bits() -> &'static [Bit; 16] {
    bits::stw1(Mode::Velocity)
}

/// The bits of status word 1 in speed control mode.
pub fn zsw1_bits() -> &'static [Bit; 16] {
    bits::zsw1(Mode::Velocity)
}

/// Names of the set bits without the inverse ones: `ON, EN_OP, CTRL_PLC`.
pub fn set_names(table: &[Bit; 16], word: u16) -> String {
    let names: Vec<_> = table
        .iter()
        .filter(|bit| !bit.inverse && is_set(word, bit))
        .map(|bit| bit.name)
        .collect();
    if names.is_empty() {
        "none".into()
    } else {
        names.join(", ")
    }
}

/// The inverse bits by their meaning: `OFF2 not active, OFF3 not active`.
pub fn inverse_meanings(table: &[Bit; 16], word: u16) -> String {
    let inverse = table.iter().filter(|bit| bit.inverse);
    inverse
        .map(|bit| meaning(word, bit))
        .collect::<Vec<_>>()
        .join(", ")
}

/// What the whole control word does.
pub fn stw1_meaning(word: u16) -> &'static str {
    let bit = |n: u16| word & (1 << n) != 0;
    if !bit(10) {
        "no control by the PLC: the drive ignores the word"
    } else if !bit(1) {
        "coast stop (OFF2)"
    } else if !bit(2) {
        "quick stop (OFF3)"
    } else if bit(7) {
        "acknowledge fault"
    } else if !bit(0) {
        "ready: OFF, ramp stop if turning (OFF1)"
    } else if !bit(3) {
        "switched on, operation not enabled"
    } else if word & 0x70 == 0 && (bit(8) || bit(9)) {
        "jog"
    } else if word & 0x70 == 0 {
        "operation with the setpoint channel closed (jog permitted)"
    } else if word & 0x70 == 0x70 {
        "run: follows the setpoint"
    } else {
        "operation with the setpoint held or at 0"
    }
}

/// State of the drive out of ZSW1 (profile reference 2.1), with S3 and a ramp stop told apart only as far as ZSW1 does.
pub fn state(zsw1: u16) -> &'static str {
    let bit = |n: u16| zsw1 & (1 << n) != 0;
    match (bit(6), bit(3), bit(2), bit(1), bit(0)) {
        (true, true, ..) => "S1 switching on inhibited, with a fault",
        (true, ..) => "S1 switching on inhibited",
        (_, true, false, false, _) => "fault",
        (_, _, true, true, true) if bit(5) => "S4 operation",
        (_, _, _, true, true) if !bit(5) => "S5 switching off, quick stop",
        (_, true, _, true, true) => "S5 switching off, stop after a fault",
        (_, _, false, true, true) => "S3 switched on (or S5 ramp stop while turning)",
        (_, _, false, false, true) => "S2 ready for switching on",
        (_, _, false, false, false) => "not ready",
        _ => "no state of the profile",
    }
}

/// Short name of the state: `S4`.
pub fn state_number(zsw1: u16) -> &'static str {
    match state(zsw1) {
        "fault" => "S1",
        "not ready" | "no state of the profile" => "--",
        words => words.get(..2).unwrap_or(words),
    }
}

/// Everything about a control or status word as lines.
pub fn word_lines(title: &str, table: &[Bit; 16], word: u16, means: &str) -> Vec<String> {
    let mut lines = vec![
        format!("{title} {}   {}", hex16(word), nibbles(word)),
        format!("  means  {means}"),
        format!("  set    {}", set_names(table, word)),
        format!("  stops  {}", inverse_meanings(table, word)),
    ];
    lines.push("  bit".into());
    for bit in table {
        let value = u8::from(is_set(word, bit));
        lines.push(
            format!(
                "  {:>3}  {value}  {:<12}  {}",
                bit.number,
                bit.name,
                meaning(word, bit)
            )
            .trim_end()
            .into(),
        );
    }
    lines
}

/// The same for programs.
pub fn word_json(table: &[Bit; 16], word: u16) -> Value {
    let bits: Vec<Value> = table
        .iter()
        .map(|bit| {
            json!({ "bit": bit.number, "name": bit.name, "set": is_set(word, bit), "meaning": meaning(word, bit) })
        })
        .collect();
    json!({ "raw": word, "hex": hex16(word), "binary": nibbles(word), "bits": bits })
}

const fn is_set(word: u16, bit: &Bit) -> bool {
    word & (1 << bit.number) != 0
}

const fn meaning(word: u16, bit: &Bit) -> &'static str {
    if is_set(word, bit) { bit.on } else { bit.off }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_in_order() {
        for table in [stw1_bits(), zsw1_bits()] {
            for (at, bit) in table.iter().enumerate() {
                assert_eq!(usize::from(bit.number), at);
            }
        }
    }

    #[test]
    fn the_words_every_drive_engineer_knows() {
        for (word, means) in [
            (0x047E, "ready: OFF, ramp stop if turning (OFF1)"),
            (0x047F, "run: follows the setpoint"),
            (0x04FE, "acknowledge fault"),
            (0x050F, "jog"),
            (0x047D, "coast stop (OFF2)"),
            (0x047B, "quick stop (OFF3)"),
            (0x0000, "no control by the PLC: the drive ignores the word"),
        ] {
            assert_eq!(stw1_meaning(word), means, "{word:#06x}");
        }
        assert_eq!(
            set_names(stw1_bits(), 0x047F),
            "ON, EN_OP, EN_RAMP, UNFREEZE, EN_SETPOINT, CTRL_PLC"
        );
        assert_eq!(
            inverse_meanings(stw1_bits(), 0x047F),
            "OFF2 not active, OFF3 not active"
        );
        assert_eq!(
            inverse_meanings(zsw1_bits(), 0x0213),
            "OFF2 not active, OFF3 active: quick stop"
        );
    }

    #[test]
    fn states_of_the_typical_words() {
        for (zsw1, number, words) in [
            (0x0240, "S1", "S1 switching on inhibited"),
            (0x0278, "S1", "S1 switching on inhibited, with a fault"),
            (0x0231, "S2", "S2 ready for switching on"),
            (0x0233, "S3", "S3 switched on (or S5 ramp stop while turning)"),
            (0x0237, "S4", "S4 operation"),
            (0x0217, "S5", "S5 switching off, quick stop"),
            (0x0213, "S5", "S5 switching off, quick stop"),
            (0x0238, "S1", "fault"),
            (0x0000, "--", "not ready"),
        ] {
            assert_eq!((state_number(zsw1), state(zsw1)), (number, words), "{zsw1:#06x}");
        }
    }
}
