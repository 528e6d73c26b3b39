//! What all commands that move an axis share: the words for what happens on the way.

use std::time::Duration;

use client::axis::Room;
use client::{Drive, FaultEntry, LossAction, LossReaction, Rest, Wait, WarningEntry};
use profidrive::motion::{
    Arrival, Control, End, Ended, Event, Message, MotionError, Observer, Setting, Start, TelegramChange,
};
use profile::notation::Quantity;
use profile::state::Mode;
use profinet::cyclic::{CyclicStatistics, Timing};

use crate::advice::{self, Commands};
use crate::args::{Cyclic, Enabling, InMode, Target};
use crate::connect::{self, Live, Need};
use crate::failure::{self, Failure};
use crate::output::Output;
use crate::render::live::LiveView;
use crate::render::{number, value};

/// Longest wait of a command that ends with Ctrl-C only.
pub const UNLIMITED: Duration = Duration::from_secs(100 * 365 * 24 * 3600);

pub fn rpm(quantity: &Quantity, what: &str) -> Result<f64, Failure> {
    in_unit(quantity, "rpm", what)
}

pub fn in_unit(quantity: &Quantity, unit: &str, what: &str) -> Result<f64, Failure> {
    quantity
        .in_unit(unit)
        .map_err(|error| Failure::usage(format!("{what}: {error}")))
}

/// The settings that all motions have in common. An update time that no connection can have is refused before anything is
/// opened.
pub fn control(cyclic: &Cyclic) -> Result<Control, Failure> {
    if let Some(cycle) = cyclic
        .cycle
        .filter(|&cycle| Timing::for_interval(cycle).is_none())
    {
        return Err(Failure::usage(format!(
            "--cycle: an update time of {} ms does not exist",
            cycle.as_secs_f64() * 1000.0
        ))
        .hint("use 1, 2, 4, 8 .. 512 ms; left out it is at least 16 ms, as the drive allows it"));
    }
    Ok(Control {
        cycle: cyclic.cycle,
        watchdog: cyclic.watchdog,
        ..Control::default()
    })
}

/// The same for a command that enables the axis.
pub fn enabling(args: &Enabling) -> Result<Control, Failure> {
    Ok(Control {
        may_run_on: args.may_run_on,
        ..control(&args.cyclic)?
    })
}

/// The same for a command that needs the drive in one mode.
pub fn in_mode(args: &InMode) -> Result<Control, Failure> {
    Ok(Control {
        set_mode: args.set_mode,
        ..enabling(&args.enabling)?
    })
}

/// Connects to a drive and moves it; closes the connection after a motion that went well.
pub fn with_drive<T>(
    target: &Target,
    need: Need,
    output: &Output,
    work: impl FnOnce(&mut Live, &mut Drive) -> Result<T, MotionError>,
) -> Result<T, Failure> {
    let (mut session, mut drive) = connect::drive(target, need, output)?;
    let done = work(&mut session, &mut drive)?;
    session.close().wait()?;
    Ok(done)
}

/// A motion that failed, in the words of this program.
impl From<MotionError> for Failure {
    fn from(error: MotionError) -> Self {
        let (kind, advice) = (error.kind(), error.advice().unwrap_or_default());
        let message = match error {
            MotionError::Client(error) => return error.into(),
            MotionError::Failed { error, findings, .. } => {
                let of_carrier = failure::of_carrier(&error);
                let mut failure = Self::from(*error).hint(advice.then(of_carrier));
                for finding in findings {
                    failure.message = format!("{}; {finding}", failure.message);
                }
                return failure;
            }
            MotionError::Stopped { drive, end, .. } => {
                let how = match end {
                    End::Open | End::Time => "stopped before the end by Ctrl-C or a signal".to_owned(),
                    other => format!("stopped by Ctrl-C or a signal, {}", other.missing()),
                };
                format!("{drive}: {how}")
            }
            other => other.to_string(),
        };
        Self::new(kind, message).hint(advice)
    }
}

/// What begins, in words: `turns at 60 rpm for 1 s`. Without any it is not a motion.
pub type StartText = Box<dyn Fn(&Start, u16) -> Option<String> + Send>;

/// Shows a motion on the way: the axis as it moves, everything else as messages, and both as documents for programs.
pub fn observer(drive: &str, start: StartText, output: &Output) -> Observer {
    let mut view = LiveView::new(output.clone());
    let (drive, output) = (drive.to_owned(), output.clone());
    Observer::new(move |event| {
        if let Event::Sample(status) = event {
            view.show(status, None);
            return;
        }
        view.leave();
        if let Some(message) = Message::of(event, &Commands(&drive)) {
            output.json_event(&message);
        }
        match event {
            Event::Starting {
                start: Start::Acknowledge,
                ..
            } => output.say("acknowledging by an edge of STW1 bit 7"),
            Event::Starting {
                telegram,
                start: what,
            } => {
                if let Some(text) = start(what, *telegram) {
                    output.say(&format!("this moves the axis: {drive} {text}; Ctrl-C stops it"));
                }
            }
            Event::RunsOn(loss) => controller_loss(loss, &drive, &output),
            Event::Strained(strained) => output.warn(&format!("{strained}; {}", calmer(strained.room()))),
            Event::Warnings { warnings, .. } => report_warnings(warnings, &output),
            Event::TelegramChanged(change) => telegram_changed(*change, &output),
            Event::Ended(ended) => end(ended, &output),
            other => words(other, &drive, &output),
        }
    })
}

/// The events that are a message and nothing else.
fn words(event: &Event, drive: &str, output: &Output) {
    match event {
        Event::ModeChanged { before, now } => output.say(&match before {
            Some(before) => format!(
                "PNU 930: {} -> {} for this command",
                mode_number(*before),
                mode_number(*now)
            ),
            None => format!(
                "PNU 930 is {} now; what it was is none of 1 and 2 and is not put back",
                mode_number(*now)
            ),
        }),
        Event::ModeWouldChange(mode) => output.say(&format!(
            "PNU 930 would be set to {} mode for this and put back; the telegram is chosen then",
            match mode {
                Mode::Position => "position",
                Mode::Velocity => "velocity",
            }
        )),
        Event::PutBack(setting) => {
            let (name, value) = setting_text(setting);
            output.say(&format!("{name} is {value} again"));
        }
        Event::NotPutBack { setting, cause } => output.warn(&match setting.as_ref().map(setting_text) {
            Some((name, value)) => format!("{name} was not put back to {value}: {cause}"),
            None => format!("mode and telegram were not put back (PNU 930, 922): {cause}"),
        }),
        Event::LeftOver(left) => output.warn(&left.note().sentence),
        Event::NoteUnreadable(note) => {
            let note = note.note();
            let next = advice::text(&note.next.unwrap_or_default(), drive);
            output.warn(&format!("{}; {next}", note.sentence));
        }
        Event::NotNoted { setting, cause } => {
            let (name, value) = setting_text(setting);
            output.warn(&format!(
                "if this program is killed, {name} stays changed; it was {value}: {cause}"
            ));
        }
        Event::AtSwitch => {
            output.warn("the limit switch in this direction is hit: the drive may not turn");
        }
        Event::Rounded { asked, sent, unit } => {
            let (asked, sent) = (number(*asked), number(*sent));
            // a step too fine for the figures shown is no news
            if asked != sent {
                output.say(&format!(
                    "{asked} {unit} -> {sent} {unit}, rounded to the nearest representable value"
                ));
            }
        }
        Event::LongRamp { time, by } => {
            let by = by.as_ref().map_or_else(String::new, |by| format!(" ({by})"));
            output.say(&format!(
                "the ramp up takes about {:.0} s{by}, the time counts from its end",
                time.as_secs_f64()
            ));
        }
        Event::LongStop => output.say(
            "still stopping along the ramp; Ctrl-C for a quick stop (OFF3), after a second if it was pressed before",
        ),
        Event::SpeedNotReached {
            wanted,
            actual,
            unit,
        } => {
            let actual = actual.map_or_else(String::new, |actual| format!(", it was {actual:.1} {unit}"));
            output.warn(&format!("{wanted} {unit} was not reached when the stop came{actual}"));
        }
        Event::HeldBack(evidence) => {
            output.warn(&format!("the axis stood at the end of the jog: {evidence}"));
        }
        Event::Arrived {
            arrival,
            position,
            counts,
            left_to,
        } => {
            output.say(&arrival_text(*arrival, position.zip(*counts)));
            if let Some(now) = left_to {
                let place = match arrival {
                    Arrival::Home => "that place",
                    Arrival::Target | Arrival::Task(_) => "the target",
                };
                output.warn(&format!(
                    "it has left {place} since: it is at {} rev now",
                    number(rounded(*now))
                ));
            }
        }
        Event::Faults(faults) => {
            for fault in faults {
                output.say(&fault_text(fault));
            }
        }
        Event::Clearing { parameter, pnu } => output.say(&format!("acknowledging with {parameter} (p{pnu})")),
        Event::FaultsUnreadable(cause) => {
            output.warn(&format!("which fault there is cannot be read: {cause}"));
        }
        _ => {}
    }
}

const fn mode_number(mode: Mode) -> u8 {
    match mode {
        Mode::Velocity => 1,
        Mode::Position => 2,
    }
}

/// A setting and its value.
fn setting_text(setting: &Setting) -> (String, String) {
    match setting {
        Setting::Number { pnu, value } => (format!("PNU {pnu}"), value.to_string()),
        Setting::Reading { parameter, reading } => (parameter.clone(), value::full(reading)),
        Setting::Noted { parameter, value } => (parameter.clone(), value.to_string()),
    }
}

/// Where a motion came to, in turns and counts.
fn arrival_text(arrival: Arrival, at: Option<(f64, f64)>) -> String {
    match arrival {
        Arrival::Home => {
            let at = at.map_or_else(String::new, |(turns, _)| {
                format!(", the axis is at {} rev", number(rounded(turns)))
            });
            format!("homed (ZSW1 bit 11){at}")
        }
        Arrival::Task(number) => format!("task {number} at its target (ZSW1 bit 10)"),
        Arrival::Target => {
            let at = at.map_or_else(String::new, |(turns, counts)| {
                format!(
                    ": {} rev ({:.0} counts)",
                    number(rounded(turns)),
                    counts.round() + 0.0
                )
            });
            format!("target reached (ZSW1 bit 10){at}")
        }
    }
}

/// Turns to three digits; a zero has no sign.
pub fn rounded(turns: f64) -> f64 {
    (turns * 1000.0).round() / 1000.0 + 0.0
}

/// The drive may run on when this program is gone.
fn controller_loss(loss: &LossReaction, drive: &str, output: &Output) {
    let does = match loss.action {
        LossAction::KeepsTurning => "the drive goes on",
        _ => "it is not known whether the drive stops",
    };
    let setting = match (&loss.parameter, &loss.setting) {
        (Some(parameter), Some(setting)) => format!("{parameter} is {setting}: "),
        _ => String::new(),
    };
    let remedy = loss.remedy.as_ref();
    let advice = remedy.map_or_else(String::new, |remedy| {
        format!("; {}", advice::text(&remedy.sentence(), drive))
    });
    output.warn(&format!(
        "{setting}should this program be killed or the line break, {does}{advice}"
    ));
}

fn telegram_changed(TelegramChange { before, now, kept }: TelegramChange, output: &Output) {
    let after = if kept {
        "it remains selected"
    } else {
        "it is put back afterwards"
    };
    output.say(&format!("telegram {before} -> {now} (PNU 922) for this; {after}"));
}

/// The options of a cycle with more room, or the advice of one that is as long as it gets.
fn calmer(room: Option<Room>) -> String {
    match room {
        Some(Room::DefaultWatchdog) => "leave out --watchdog".to_owned(),
        Some(Room::Default) => "leave out --cycle and --watchdog".to_owned(),
        Some(Room::Cycle { interval, watchdog }) => {
            format!("use `--cycle {}ms --watchdog {watchdog}`", interval.as_millis())
        }
        None => "close the programs that keep it busy".to_owned(),
    }
}

/// Warnings in words, at the time they come.
fn report_warnings(warnings: &[WarningEntry], output: &Output) {
    if warnings.is_empty() {
        output.warn("the drive has a warning (ZSW1 bit 7) and no number for it");
    }
    for warning in warnings {
        let remedy = warning
            .remedy
            .map_or_else(String::new, |remedy| format!("; {remedy}"));
        output.warn(&format!("{}{remedy}", warned(warning)));
    }
}

/// Reports how a motion ended.
fn end(ended: &Ended, output: &Output) {
    if ended.interrupted && output.is_closed() {
        output.say("the output has no reader any more: stopped");
    }
    if let Some(statistics) = &ended.statistics {
        output.say(&frames(statistics));
    }
    let report = &ended.report;
    if !report.released {
        return;
    }
    output.say(match report.rest {
        Rest::Unknown => return,
        Rest::Stands => "axis at rest, control released",
        Rest::Coasts => {
            "control released; the axis turns with its power stage off: it coasts, or something moves it"
        }
        Rest::Runs => "control released; the axis still turns with its power stage on",
    });
}

/// Summary of the cyclic connection. Missing frames come from the cycle counter; the longest gap is measured by this
/// computer, which may have been suspended.
fn frames(statistics: &CyclicStatistics) -> String {
    format!(
        "{} cyclic frames received, {} lost between them, longest time without one {:.1} ms",
        statistics.received,
        statistics.missed,
        statistics.longest_gap.as_secs_f64() * 1000.0
    )
}

/// `F702 Fieldbus communication lost`
pub fn fault_text(fault: &FaultEntry) -> String {
    format!(
        "F{} {}",
        fault.number,
        fault.meaning.unwrap_or("not in the tables")
    )
}

/// `n107 Positive limit reached: limit switch or software limit`
pub fn warned(warning: &WarningEntry) -> String {
    format!(
        "n{} {}",
        warning.number,
        warning.meaning.unwrap_or("not in the tables")
    )
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use client::axis::Cycle;

    use super::*;

    #[test]
    fn a_strained_cycle_comes_with_options_that_have_room() {
        let millis = Duration::from_millis;
        let advice = |cycle, count, delay| {
            let cycle = Cycle::choose(&[], millis(1), Some(millis(cycle)), Some(count)).unwrap();
            calmer(cycle.judge(millis(delay)).unwrap().room())
        };
        assert_eq!(advice(4, 3, 6), "leave out --cycle and --watchdog");
        assert_eq!(advice(16, 1, 0), "leave out --watchdog");
        assert_eq!(advice(16, 7, 17), "use `--cycle 64ms --watchdog 7`");
        assert_eq!(advice(16, 7, 400), "close the programs that keep it busy");
    }

    #[test]
    fn a_silence_is_no_contradiction_to_frames_that_are_all_there() {
        let slept = CyclicStatistics {
            received: 40,
            longest_gap: Duration::from_micros(1_161_200),
            ..CyclicStatistics::default()
        };
        assert_eq!(
            frames(&slept),
            "40 cyclic frames received, 0 lost between them, longest time without one 1161.2 ms"
        );
    }

    #[test]
    fn a_motion_that_is_stopped_before_its_end_fails() {
        let failure = |end| {
            Failure::from(MotionError::Stopped {
                drive: "akd-1".into(),
                end,
                report: Box::default(),
            })
        };
        assert_eq!(
            failure(End::Target).message,
            "akd-1: stopped by Ctrl-C or a signal, the target was not reached"
        );
        let time = failure(End::Time);
        assert!(
            time.message.contains("before the end") && time.kind == client::ErrorKind::Interrupted,
            "{time:?}"
        );
    }
}
