//! A running axis: overwritten in place on a terminal, a line per change elsewhere, a document per change as JSON.

use std::time::Duration;

use client::AxisStatus;
use client::axis::SpeedUnit;
use profidrive::motion::AxisState;
use profidrive::report::Quantity;
use profile::notation::fixed;
use profile::state::{Mode, bits};
use profile::value::Beyond;

use super::{hex16, nibbles, words};
use crate::output::{Colour, Output};

/// Shortest time between two pictures on a terminal.
const PICTURE: Duration = Duration::from_millis(100);
/// Shortest time between two lines while only the speed changes.
const LINE: Duration = Duration::from_millis(1000);

/// What a view shows.
#[derive(Debug, Clone, Copy, PartialEq)]
struct AxisView {
    /// What the drive is for: decides over the words.
    mode: Mode,
    /// Since control was taken.
    time: Duration,
    /// Control word being sent, in the bits of the profile.
    stw1: u16,
    /// Status word in the bits of the profile, once there is one.
    zsw1: Option<u16>,
    /// Control word and status word as they are on the wire: a model may have words of its own.
    wire: (u16, Option<u16>),
    /// Control word that the status word answers.
    answered: u16,
    /// The connection is lost: the values are the last received ones.
    lost: bool,
    /// What the speeds are in.
    unit: SpeedUnit,
    /// Speed requested.
    speed_set: Option<f64>,
    /// Speed of the motor.
    speed_actual: Option<f64>,
    /// The motor may turn faster than that: its signal has no higher number.
    speed_beyond: Option<Beyond>,
    /// Position in the drive's unit, if it is read.
    position: Option<f64>,
    /// Where a move leads, in turns.
    target: Option<f64>,
    /// Where the axis is, in turns.
    turns: Option<f64>,
    /// Position command minus position, in turns.
    following_error: Option<f64>,
}

impl AxisView {
    /// Converts the status of an axis, with a position that was read beside it.
    fn of(status: &AxisStatus, position: Option<f64>) -> Self {
        Self {
            mode: status.view.mode,
            time: status.time,
            stw1: status.view.command.stw1.0,
            zsw1: status.view.seen.map(|seen| seen.zsw1.0),
            wire: (status.view.sent, status.view.seen.map(|seen| seen.word)),
            answered: status.view.answered.0,
            lost: status.lost,
            unit: status.unit,
            speed_set: status.speed_set,
            speed_actual: status.speed_actual,
            speed_beyond: status.speed_beyond,
            position,
            target: status.target,
            turns: status.position,
            following_error: status.following_error,
        }
    }

    /// Returns the values whose change is worth a line.
    const fn words(&self) -> (u16, Option<u16>, u16, bool) {
        (self.stw1, self.zsw1, self.answered, self.lost)
    }

    fn state(&self) -> String {
        let Some(zsw1) = self.zsw1 else {
            return if self.lost {
                "connection lost"
            } else {
                "no data yet"
            }
            .into();
        };
        let state = words::state(zsw1, Some(self.answered));
        if self.lost {
            return format!("connection lost, was in {state}");
        }
        // what was sent a moment ago is not a state of the drive
        if words::state(zsw1, Some(self.stw1)) == state {
            return state;
        }
        let order = if words::sends_on(self.stw1) { "ON" } else { "OFF" };
        format!("{state}, {order} commanded")
    }

    /// Returns the short name of the state that the drive reported.
    fn state_number(&self) -> Option<&'static str> {
        self.zsw1
            .map(|zsw1| words::state_number(zsw1, Some(self.answered)))
    }
}

/// Shows an axis while it moves.
#[derive(Debug)]
pub struct LiveView {
    output: Output,
    last: Option<AxisView>,
    /// Lines of the picture on the terminal.
    drawn: usize,
}

impl LiveView {
    /// Creates a view for a command.
    pub const fn new(output: Output) -> Self {
        Self {
            output,
            last: None,
            drawn: 0,
        }
    }

    /// Shows what is new; leaves out what would only flicker. `position` is one that was read beside the telegram, in
    /// counts.
    pub fn show(&mut self, status: &AxisStatus, position: Option<f64>) {
        let view = &AxisView::of(status, position);
        let words_changed = self.last.is_none_or(|last| last.words() != view.words());
        let since = self
            .last
            .map_or(Duration::MAX, |last| view.time.saturating_sub(last.time));
        let due = if self.output.live() { PICTURE } else { LINE };
        if !words_changed && since < due {
            return;
        }
        self.last = Some(*view);
        if self.output.json() {
            let beside = position.map(|counts| Quantity::new(counts, "counts"));
            let state = AxisState::from(status);
            self.output.json_event(&AxisState {
                position: state.position.or(beside),
                ..state
            });
        } else if self.output.live() {
            self.picture(view);
        } else {
            self.output.line(&line(view));
        }
    }

    /// As [`show`](Self::show), but prints a line only for new text: for incomplete views that another source
    /// completes.
    pub fn show_words(&mut self, status: &AxisStatus, position: Option<f64>) {
        let view = AxisView::of(status, position);
        let same = self.last.is_some_and(|last| last.words() == view.words());
        if self.output.live() || !same {
            self.show(status, position);
        }
    }

    /// Goes below the picture, so that other lines can follow.
    pub fn leave(&mut self) {
        self.drawn = 0;
    }

    fn picture(&mut self, view: &AxisView) {
        let lines = picture(view, &self.output);
        self.output.picture(self.drawn, &lines);
        self.drawn = lines.len();
    }
}

/// One line for a log.
fn line(view: &AxisView) -> String {
    let zsw1 = view.wire.1.map_or_else(|| "-".into(), hex16);
    let mut text = format!(
        "{:>7.2} s  {:<46}  STW1 {}  ZSW1 {zsw1}",
        view.time.as_secs_f64(),
        view.state(),
        hex16(view.wire.0),
    );
    for (name, value, unit) in [
        ("set", view.speed_set, view.unit.symbol()),
        ("actual", view.speed_actual, view.unit.symbol()),
        ("target", view.target, "rev"),
        ("at", view.turns, "rev"),
        ("error", view.following_error, "rev"),
    ] {
        if let Some(value) = value {
            let digits = if unit == "rev" { 3 } else { 2 };
            let end = if name == "actual" {
                beyond(view)
            } else {
                String::new()
            };
            text.push_str(&format!("  {name} {end}{value:>8.digits$} {unit}"));
        }
    }
    if let Some(position) = view.position {
        text.push_str(&format!("  position {position:.0}"));
    }
    text
}

/// Returns `> ` where the speed is at least the reported one.
fn beyond(view: &AxisView) -> String {
    view.speed_beyond
        .map_or_else(String::new, |end| format!("{} ", end.sign()))
}

fn picture(view: &AxisView, output: &Output) -> Vec<String> {
    let zsw1 = view.zsw1.unwrap_or(0);
    let (mark, colour) = match zsw1 {
        fault if words::has_fault(fault) => ("#", Colour::Fault),
        warning if words::has_warning(warning) => ("!", Colour::Warning),
        _ if view.state_number() == Some("S4") => ("»", Colour::Normal),
        _ => ("·", Colour::Faint),
    };
    let speed = |name: &str, rpm: f64| {
        let reference = view.speed_set.unwrap_or(0.0);
        let unit = view.unit.symbol();
        format!("  {name} {:>9} {unit}  {}", fixed(rpm, 2), scale(rpm, reference))
    };
    let (stw1_bits, zsw1_bits) = (bits::stw1(view.mode), bits::zsw1(view.mode));
    let mut lines = vec![
        output.paint(
            colour,
            &format!("{mark} {:>6.1} s  {}", view.time.as_secs_f64(), view.state()),
        ),
        format!(
            "  STW1 {}  {} {}",
            digits(view.wire.0, view.stw1),
            words::stw1_meaning_in(view.mode, view.stw1),
            words::set(stw1_bits, view.stw1)
        ),
        view.zsw1.zip(view.wire.1).map_or_else(
            || "  ZSW1 -".into(),
            |(zsw1, wire)| format!("  ZSW1 {}  {}", digits(wire, zsw1), words::set(zsw1_bits, zsw1)),
        ),
    ];
    lines.extend(view.speed_set.map(|rpm| speed("set   ", rpm)));
    let actual = format!("actual{}", beyond(view));
    lines.extend(view.speed_actual.map(|rpm| speed(actual.trim_end(), rpm)));
    for (name, turns) in [
        ("target", view.target),
        ("actual", view.turns),
        ("error ", view.following_error),
    ] {
        lines.extend(turns.map(|turns| format!("  {name} {:>9} rev", fixed(turns, 3))));
    }
    if let Some(position) = view.position {
        lines.push(format!("  position {position:>12.0}"));
    }
    lines
}

/// Returns a word on the wire with its bits, as far as they are those that are named behind it.
fn digits(wire: u16, profile: u16) -> String {
    if wire == profile {
        format!("{}  {}", hex16(wire), nibbles(wire))
    } else {
        hex16(wire)
    }
}

/// Returns a bar as long as the speed is.
fn scale(rpm: f64, reference: f64) -> String {
    const LENGTH: f64 = 30.0;
    let full = reference.abs().max(60.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and 40"
    )]
    let marks = (rpm.abs() / full * LENGTH).clamp(0.0, 40.0).round() as usize;
    let sign = if rpm < 0.0 { "-" } else { "" };
    format!("{sign}{}", "=".repeat(marks))
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: AxisView = AxisView {
        mode: Mode::Velocity,
        time: Duration::from_millis(1234),
        stw1: 0x047F,
        zsw1: Some(0x0337),
        wire: (0x047F, Some(0x0337)),
        answered: 0x047F,
        lost: false,
        unit: SpeedUnit::Rpm,
        speed_set: Some(60.06),
        speed_actual: Some(59.7),
        speed_beyond: None,
        position: None,
        target: None,
        turns: None,
        following_error: None,
    };

    #[test]
    fn one_line_has_everything() {
        assert_eq!(
            line(&VIEW),
            "   1.23 s  S4 operation                                    STW1 0x047F  ZSW1 0x0337  set    60.06 rpm  actual    59.70 rpm"
        );
        assert!(line(&AxisView { zsw1: None, ..VIEW }).contains("no data yet"));
        // a VLT with the FC profile: the words that travel
        let converter = AxisView {
            wire: (0x047C, Some(0x0F07)),
            ..VIEW
        };
        assert!(
            line(&converter).contains(" S4 operation  ")
                && line(&converter).contains("STW1 0x047C  ZSW1 0x0F07"),
            "{}",
            line(&converter)
        );
        let text = picture(&converter, &Output::new(false, false)).join("\n");
        assert!(
            text.contains("STW1 0x047C  run") && !text.contains("0000 0100"),
            "{text}"
        );
        let fast = AxisView {
            speed_actual: Some(11996.7),
            speed_beyond: Some(Beyond::Above),
            ..VIEW
        };
        assert!(
            line(&fast).ends_with("  actual > 11996.70 rpm"),
            "{}",
            line(&fast)
        );
    }

    #[test]
    fn a_move_shows_target_and_position() {
        let view = AxisView {
            mode: Mode::Position,
            stw1: 0x043F,
            zsw1: Some(0x4F37),
            wire: (0x043F, Some(0x4F37)),
            speed_set: None,
            speed_actual: None,
            target: Some(10.0),
            turns: Some(1.2345),
            ..VIEW
        };
        let text = line(&view);
        assert!(
            text.ends_with("ZSW1 0x4F37  target   10.000 rev  at    1.234 rev")
                || text.ends_with("ZSW1 0x4F37  target   10.000 rev  at    1.235 rev"),
            "{text}"
        );
        let text = picture(&view, &Output::new(false, false)).join("\n");
        assert!(text.contains("operation, a traversing task may run"), "{text}");
        assert!(text.contains("TASK_ACTIVE"), "{text}");
        assert!(text.contains("  target    10.000 rev"), "{text}");
    }

    #[test]
    fn the_control_word_distinguishes_ramp_stop_from_switched_on() {
        let turning = AxisView {
            stw1: 0x047E,
            answered: 0x047E,
            zsw1: Some(0x0233),
            ..VIEW
        };
        assert!(line(&turning).contains(" S5 switching off, ramp stop  "));
        let starting = AxisView {
            stw1: 0x047F,
            answered: 0x047F,
            ..turning
        };
        assert!(line(&starting).contains(" S3 switched on  "));
    }

    #[test]
    fn a_command_is_no_state() {
        let off = AxisView {
            stw1: 0x047E,
            zsw1: Some(0x0737),
            ..VIEW
        };
        assert!(
            line(&off).contains(" S4 operation, OFF commanded  "),
            "{}",
            line(&off)
        );
        assert_eq!(off.state_number(), Some("S4"));
        let lost = AxisView { lost: true, ..off };
        assert!(
            line(&lost).contains(" connection lost, was in S4 operation  "),
            "{}",
            line(&lost)
        );
    }

    #[test]
    fn the_picture_shows_bits_and_speed() {
        let output = Output::new(false, false);
        let text = picture(&VIEW, &output).join("\n");
        assert!(
            text.contains("0000 0100 0111 1111  run: follows the setpoint"),
            "{text}"
        );
        assert!(
            text.contains("[READY_ON, READY_OP, OPERATION, IN_TOLERANCE, CTRL_REQ]"),
            "{text}"
        );
        let text = picture(
            &AxisView {
                zsw1: None,
                wire: (0x047F, None),
                ..VIEW
            },
            &output,
        )
        .join("\n");
        assert!(text.contains("\n  ZSW1 -\n"), "{text}");
    }
}
