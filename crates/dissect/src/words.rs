//! Control and status words, states: bits as readable text.

use profile::state::bits::{self, Bit};
use profile::state::{
    Correction, Mode, PositionMachine, PositionState, Profile, Setpoint, SetpointChannel, SpeedCommand,
    State, Stw1, Zsw1,
};

use crate::meaning::{WordBit, WordBits};
use crate::{hex16, nibbles};

/// Returns a word as it is shown everywhere: hexadecimal with at least four digits.
pub fn hex(octets: &[u8]) -> String {
    let word = octets
        .iter()
        .fold(0_u64, |number, &octet| number << 8 | u64::from(octet));
    format!("0x{word:04X}")
}

/// Returns the names of the bits that are set, to stand behind the digits: `[ON, EN_OP, CTRL_PLC]`.
pub fn bracketed(texts: &[String]) -> String {
    match texts {
        [] => "[no bit set]".into(),
        texts => format!("[{}]", joined(texts)),
    }
}

/// Returns the same without the brackets; empty when no bit has a text.
pub fn joined(texts: &[String]) -> String {
    let comma = texts.iter().any(|text| text.contains(", "));
    texts.join(if comma { "; " } else { ", " })
}

/// A control or status word as it is shown everywhere: `0x043F [ON, EN_OP, CTRL_PLC]`.
pub fn shown(table: &'static [Bit; 16], word: u16) -> String {
    format!("{} {}", hex16(word), set(table, word))
}

/// The bits of a control or status word behind its digits: `[ON, EN_OP, CTRL_PLC]`.
pub fn set(table: &'static [Bit; 16], word: u16) -> String {
    bracketed(&names(table, word))
}

fn names(table: &'static [Bit; 16], word: u16) -> Vec<String> {
    bits::texts(table, word).map(str::to_owned).collect()
}

/// Names of the set bits without the inverse ones: `ON, EN_OP, CTRL_PLC`.
fn set_names(table: &[Bit; 16], word: u16) -> String {
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

/// Returns the effect of the whole control word in this mode.
pub fn stw1_meaning_in(mode: Mode, word: u16) -> &'static str {
    let stw1 = Stw1(word);
    if !stw1.has(Stw1::CONTROL_BY_PLC) {
        "no control by the PLC: the drive ignores the word"
    } else if !stw1.has(Stw1::NO_COAST_STOP) {
        "coast stop (OFF2)"
    } else if !stw1.has(Stw1::NO_QUICK_STOP) {
        "quick stop (OFF3)"
    } else if stw1.has(Stw1::ACKNOWLEDGE_FAULT) {
        "acknowledge fault"
    } else if !stw1.has(Stw1::ON) {
        "ready: OFF, ramp stop if turning (OFF1)"
    } else if !stw1.has(Stw1::ENABLE_OPERATION) {
        "switched on, operation not enabled"
    } else {
        match mode {
            Mode::Velocity => velocity_meaning(stw1),
            Mode::Position => position_meaning(stw1),
        }
    }
}

const TWO_JOGS: &str = "two jog commands at once: no jog";

/// Bits 4 to 6, 8 and 9 in operation, velocity mode.
fn velocity_meaning(stw1: Stw1) -> &'static str {
    let channel = Stw1::ENABLE_RAMP | Stw1::UNFREEZE_RAMP | Stw1::ENABLE_SETPOINT;
    match SetpointChannel::default().step(State::S4, stw1, true) {
        command @ (SpeedCommand::Jog1 | SpeedCommand::Jog2) => speed_meaning(command),
        _ if stw1 & channel == channel => "run: follows the setpoint",
        _ if stw1 & channel != Stw1(0) => "operation with the setpoint held or at 0",
        _ if stw1.jogs_at_once(Mode::Velocity) => TWO_JOGS,
        _ => "operation with the setpoint channel closed (jog permitted)",
    }
}

/// Bits 4 to 6, 8, 9 and 11 to 13 in operation, position mode: what they command an axis at rest, else what they do to a
/// task that runs.
fn position_meaning(stw1: Stw1) -> &'static str {
    match PositionMachine::commanded(stw1) {
        PositionState::Homing => "homing",
        PositionState::Task => "starts the traversing task",
        PositionState::Jog1 => speed_meaning(SpeedCommand::Jog1),
        PositionState::Jog2 => speed_meaning(SpeedCommand::Jog2),
        PositionState::RealTimeJog => "real-time jog",
        _ if stw1.jogs_at_once(Mode::Position) => TWO_JOGS,
        _ if !stw1.has(Stw1::NO_REJECT) => "rejects the traversing task (jog permitted)",
        _ if !stw1.has(Stw1::NO_INTERMEDIATE_STOP) => "intermediate stop",
        _ => "operation, a traversing task may run",
    }
}

/// Returns the effect of the whole control word of a profile on a running drive.
pub fn control_meaning(profile: Profile, mode: Mode, word: u16) -> String {
    if profile == Profile::Profidrive {
        return stw1_meaning_in(mode, word).to_owned();
    }
    let orders = profile.orders(word, State::S4);
    let stw1 = orders.stw1;
    let runs = stw1.has(Stw1::CONTROL_BY_PLC | Stw1::NO_COAST_STOP | Stw1::NO_QUICK_STOP)
        && stw1.has(Stw1::ON | Stw1::ENABLE_OPERATION)
        && !stw1.has(Stw1::ACKNOWLEDGE_FAULT);
    let means = match orders.speed {
        Some(speed) if runs && !orders.dc_brake => speed_meaning(speed),
        _ if stw1.has(Stw1::CONTROL_BY_PLC) && orders.dc_brake => "stop with direct current (DC brake)",
        _ => stw1_meaning_in(Mode::Velocity, stw1.0),
    };
    let mut text = means.to_owned();
    for (set, what) in [
        (orders.reverse, "reverse".to_owned()),
        (orders.second_ramp, "ramp 2".to_owned()),
        (
            orders.correction == Correction::SlowDown,
            "slowed down".to_owned(),
        ),
        (orders.correction == Correction::CatchUp, "caught up".to_owned()),
        (
            orders.preset.is_some_and(|number| number > 0),
            format!("preset reference {}", orders.preset.unwrap_or_default()),
        ),
        (
            orders.set_up.is_some_and(|number| number > 0),
            format!("set-up {}", orders.set_up.unwrap_or_default() + 1),
        ),
    ] {
        if set {
            text = format!("{text}, {what}");
        }
    }
    text
}

fn speed_meaning(speed: SpeedCommand) -> &'static str {
    match speed {
        SpeedCommand::Channel(Setpoint::Follow) => "run: follows the setpoint",
        SpeedCommand::Channel(Setpoint::Freeze) => "holds the speed",
        SpeedCommand::Channel(Setpoint::RampToZero) => "ramp stop",
        SpeedCommand::Channel(Setpoint::ZeroAtLimits) => "quick stop",
        SpeedCommand::Jog1 => "jog",
        SpeedCommand::Jog2 => "jog 2",
        SpeedCommand::JogStop => "end of jog",
    }
}

/// State of the drive out of the status word of a profile and the control word it was sent.
pub fn status_meaning(profile: Profile, status: u16, sent: Option<u16>) -> String {
    if profile == Profile::Profidrive {
        return state(status, sent);
    }
    let fault = if profile.zsw1(status, sent.unwrap_or(0)).has(Zsw1::FAULT) {
        ", with a fault"
    } else {
        ""
    };
    profile
        .state(status, sent.unwrap_or(0))
        .map_or_else(|| "not ready".into(), |state| format!("{state}{fault}"))
}

/// State of the drive out of ZSW1 and the control word it was sent: `S4 operation`. Without the control word, S3 and a
/// ramp stop cannot be distinguished.
pub fn state(zsw1: u16, sent: Option<u16>) -> String {
    let fault = if has_fault(zsw1) { ", with a fault" } else { "" };
    match (profile_state(zsw1, sent), sent) {
        (Some(State::S3), None) => format!("{} (or S5 ramp stop while turning)", State::S3),
        (Some(state), _) => format!("{state}{fault}"),
        (None, _) => "not ready".into(),
    }
}

/// Returns true when STW1 commands ON.
pub const fn sends_on(stw1: u16) -> bool {
    Stw1(stw1).has(Stw1::ON)
}

/// Returns true when ZSW1 reports a fault.
pub const fn has_fault(zsw1: u16) -> bool {
    Zsw1(zsw1).has(Zsw1::FAULT)
}

/// Returns true when ZSW1 reports a warning.
pub const fn has_warning(zsw1: u16) -> bool {
    Zsw1(zsw1).has(Zsw1::WARNING)
}

/// Short name of the state: `S4`.
pub fn state_number(zsw1: u16, sent: Option<u16>) -> &'static str {
    profile_state(zsw1, sent).map_or("--", |state| match state {
        State::S1 => "S1",
        State::S2 => "S2",
        State::S3 => "S3",
        State::S4 => "S4",
        State::S5Ramp | State::S5Quick => "S5",
    })
}

fn profile_state(zsw1: u16, sent: Option<u16>) -> Option<State> {
    Zsw1(zsw1).state(Stw1(sent.unwrap_or(0)))
}

/// Everything about a control or status word as lines.
pub fn word_lines(title: &str, table: &[Bit; 16], word: u16, means: &str) -> Vec<String> {
    let mut lines = vec![word_title(title, word)];
    lines.extend(bit_lines(table, table.iter(), word, means));
    lines
}

/// Returns the word as a heading: `STW1 0x047F   0000 0100 0111 1111`.
pub fn word_title(title: &str, word: u16) -> String {
    format!("{title} {}   {}", hex16(word), nibbles(word))
}

/// Returns the lines below the heading: what the word means, the bits that are set, then `shown` of the bits one by one.
pub fn bit_lines<'a>(
    table: &[Bit; 16],
    shown: impl Iterator<Item = &'a Bit>,
    word: u16,
    means: &str,
) -> Vec<String> {
    let mut lines = vec![
        format!("  means  {means}"),
        format!("  set    {}", set_names(table, word)),
        format!("  stops  {}", inverse_meanings(table, word)),
    ];
    lines.push("  bit".into());
    for bit in shown {
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
pub fn word_bits(table: &'static [Bit; 16], word: u16) -> WordBits {
    let bits = table.iter().map(|bit| WordBit {
        bit: bit.number,
        name: bit.name,
        set: is_set(word, bit),
        meaning: meaning(word, bit),
    });
    WordBits {
        number: word,
        hex: hex16(word),
        binary: nibbles(word),
        bits: bits.collect(),
    }
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
        for table in [bits::stw1(Mode::Velocity), bits::zsw1(Mode::Velocity)] {
            for (at, bit) in table.iter().enumerate() {
                assert_eq!(usize::from(bit.number), at);
            }
        }
    }

    #[test]
    fn common_control_words_decode() {
        for (word, means) in [
            (0x047E, "ready: OFF, ramp stop if turning (OFF1)"),
            (0x047F, "run: follows the setpoint"),
            (0x04FE, "acknowledge fault"),
            (0x050F, "jog"),
            (0x060F, "jog 2"),
            (0x070F, "two jog commands at once: no jog"),
            (0x150F, "jog"),
            (
                0x040F,
                "operation with the setpoint channel closed (jog permitted)",
            ),
            (0x041F, "operation with the setpoint held or at 0"),
            (0x047D, "coast stop (OFF2)"),
            (0x047B, "quick stop (OFF3)"),
            (0x0000, "no control by the PLC: the drive ignores the word"),
        ] {
            assert_eq!(stw1_meaning_in(Mode::Velocity, word), means, "{word:#06x}");
        }
        for (word, means) in [
            (0x043E, "ready: OFF, ramp stop if turning (OFF1)"),
            (0x043F, "operation, a traversing task may run"),
            (0x047F, "starts the traversing task"),
            (0x041F, "intermediate stop"),
            (0x040F, "rejects the traversing task (jog permitted)"),
            (0x0C3F, "homing"),
            (0x143F, "real-time jog"),
            (0x050F, "jog"),
            (0x060F, "jog 2"),
            // bits 12 and 13 jog without bits 4 to 6
            (0x140F, "real-time jog"),
            (0x340F, "real-time jog"),
            // the edge of bit 6 goes before the level of bit 12
            (0x147F, "starts the traversing task"),
            (0x070F, "two jog commands at once: no jog"),
            (0x150F, "two jog commands at once: no jog"),
            (0x160F, "two jog commands at once: no jog"),
            // homing goes before everything
            (0x0D0F, "homing"),
            (0x0C7F, "homing"),
            (0x044F, "rejects the traversing task (jog permitted)"),
            (0x051F, "intermediate stop"),
        ] {
            assert_eq!(stw1_meaning_in(Mode::Position, word), means, "{word:#06x}");
        }
        assert_eq!(
            set_names(bits::stw1(Mode::Velocity), 0x047F),
            "ON, EN_OP, EN_RAMP, UNFREEZE, EN_SETPOINT, CTRL_PLC"
        );
        assert_eq!(
            inverse_meanings(bits::stw1(Mode::Velocity), 0x047F),
            "OFF2 not active, OFF3 not active"
        );
        assert_eq!(
            inverse_meanings(bits::zsw1(Mode::Velocity), 0x0213),
            "OFF2 not active, OFF3 active: quick stop"
        );
    }

    #[test]
    fn states_of_the_typical_words() {
        let (off, on) = (Some(0x047E), Some(0x047F));
        for (zsw1, sent, number, words) in [
            (0x0240, None, "S1", "S1 switching on inhibited"),
            (0x0278, None, "S1", "S1 switching on inhibited, with a fault"),
            (0x0231, None, "S2", "S2 ready for switching on"),
            (
                0x0233,
                None,
                "S3",
                "S3 switched on (or S5 ramp stop while turning)",
            ),
            (0x0233, on, "S3", "S3 switched on"),
            (0x0233, off, "S5", "S5 switching off, ramp stop"),
            (0x023B, on, "S5", "S5 switching off, ramp stop, with a fault"),
            (0x0237, None, "S4", "S4 operation"),
            (0x0237, on, "S4", "S4 operation"),
            (0x0217, None, "S5", "S5 switching off, quick stop"),
            (0x0213, on, "S5", "S5 switching off, quick stop"),
            (0x0238, None, "S1", "S1 switching on inhibited, with a fault"),
            (0x0000, None, "--", "not ready"),
        ] {
            assert_eq!(
                (state_number(zsw1, sent), state(zsw1, sent).as_str()),
                (number, words),
                "{zsw1:#06x}"
            );
        }
        for state in State::ALL {
            let number = state_number(0x0200 | state_bits(state), on);
            assert!(state.to_string().starts_with(number), "{state}");
        }
    }

    /// ZSW1 of a state, as the profile's machine gives it under STW1 0x047F.
    fn state_bits(state: State) -> u16 {
        match state {
            State::S1 => 0x70,
            State::S2 => 0x31,
            State::S3 => 0x33,
            State::S4 => 0x37,
            State::S5Ramp => 0x3B,
            State::S5Quick => 0x13,
        }
    }
}
