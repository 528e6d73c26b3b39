//! Control and status words, states: what the bits say to a person.

use serde_json::{Value, json};

use super::{hex16, nibbles};

/// One bit of a word.
#[derive(Debug, Clone, Copy)]
pub struct Bit {
    /// Number, 0 to 15.
    pub number: u8,
    /// Short name; for an inverse bit the name of what it holds off.
    pub name: &'static str,
    /// Meaning of 1.
    pub on: &'static str,
    /// Meaning of 0.
    pub off: &'static str,
    /// 1 is the quiet state: shown by its meaning, never as a negative name.
    pub inverse: bool,
}

const fn bit(number: u8, name: &'static str, on: &'static str, off: &'static str) -> Bit {
    Bit {
        number,
        name,
        on,
        off,
        inverse: false,
    }
}

const fn inverse(number: u8, name: &'static str, on: &'static str, off: &'static str) -> Bit {
    Bit {
        number,
        name,
        on,
        off,
        inverse: true,
    }
}

/// Control word 1 in speed control mode (profile reference 2.2).
pub const STW1: [Bit; 16] = [
    bit(0, "ON", "ON", "OFF (OFF1): ramp stop, then S2"),
    inverse(
        1,
        "OFF2",
        "OFF2 not active",
        "OFF2: coast stop, pulses off at once",
    ),
    inverse(2, "OFF3", "OFF3 not active", "OFF3: quick stop"),
    bit(3, "EN_OP", "operation enabled", "operation disabled"),
    bit(
        4,
        "EN_RAMP",
        "ramp generator enabled",
        "ramp generator output forced to 0",
    ),
    bit(5, "UNFREEZE", "ramp generator runs", "ramp generator frozen"),
    bit(
        6,
        "EN_SETPOINT",
        "setpoint enabled",
        "setpoint 0: brakes along the ramp",
    ),
    bit(
        7,
        "ACK",
        "acknowledge fault (the 0 to 1 edge counts)",
        "no acknowledge",
    ),
    bit(8, "JOG1", "jog 1", "no jog 1"),
    bit(9, "JOG2", "jog 2", "no jog 2"),
    bit(
        10,
        "CTRL_PLC",
        "control by PLC: process data valid",
        "process data not valid, the drive ignores them",
    ),
    bit(11, "BIT11", "device specific (positioning: start homing)", "-"),
    bit(12, "BIT12", "device specific", "-"),
    bit(13, "BIT13", "device specific", "-"),
    bit(14, "BIT14", "device specific", "-"),
    bit(15, "BIT15", "device specific", "-"),
];

/// Status word 1 in speed control mode (profile reference 2.3).
pub const ZSW1: [Bit; 16] = [
    bit(
        0,
        "READY_ON",
        "ready for switching on",
        "not ready for switching on",
    ),
    bit(1, "READY_OP", "ready for operation", "not ready for operation"),
    bit(
        2,
        "OPERATION",
        "operation enabled, the drive follows the setpoint",
        "operation disabled",
    ),
    bit(3, "FAULT", "fault present", "no fault"),
    inverse(4, "OFF2", "OFF2 not active", "OFF2 active: coast stop"),
    inverse(5, "OFF3", "OFF3 not active", "OFF3 active: quick stop"),
    bit(
        6,
        "INHIBIT",
        "switching on inhibited: OFF first, then ON",
        "switching on not inhibited",
    ),
    bit(7, "WARNING", "warning present", "no warning"),
    bit(
        8,
        "IN_TOLERANCE",
        "speed error within tolerance",
        "speed error out of tolerance",
    ),
    bit(
        9,
        "CTRL_REQ",
        "control requested from the PLC",
        "no control requested: local operation",
    ),
    bit(
        10,
        "REACHED",
        "comparison speed reached",
        "comparison speed not reached",
    ),
    bit(
        11,
        "BIT11",
        "device specific (positioning: home position set)",
        "-",
    ),
    bit(12, "BIT12", "device specific", "-"),
    bit(13, "BIT13", "device specific", "-"),
    bit(14, "BIT14", "device specific", "-"),
    bit(15, "BIT15", "device specific", "-"),
];

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
        for table in [STW1, ZSW1] {
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
            set_names(&STW1, 0x047F),
            "ON, EN_OP, EN_RAMP, UNFREEZE, EN_SETPOINT, CTRL_PLC"
        );
        assert_eq!(
            inverse_meanings(&STW1, 0x047F),
            "OFF2 not active, OFF3 not active"
        );
        assert_eq!(
            inverse_meanings(&ZSW1, 0x0213),
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
