//! What all commands that move an axis share: how it begins, how it is shown, how it ends.

use std::time::Duration;

use clap::Args;
use client::axis::{Cycle, Goal, MotionFacts, Purpose, SpeedUnit, Strained, Trouble};
use client::status::{Cause, Note, Verdict, diagnose, switched_off_beside};
use client::{
    AxisSettings, AxisStatus, Drive, Error, FaultEntry, LossAction, ModeBefore, PutBack, Rest, Session, Wait,
    WarningEntry,
};
use profile::notation::Quantity;
use profile::state::Mode;
use profinet::cyclic::{CyclicStatistics, Timing};
use serde_json::{Map, Value};

use crate::advice;
use crate::args::{Consent, Cyclic, Interface};
use crate::connect::{self, Live, Need};
use crate::failure::{self, Exit, Failure};
use crate::fields;
use crate::output::{Output, Shared};
use crate::render::live::{AxisView, LiveView};
use crate::render::number;

pub type Axis = client::Axis;

pub type Enabled<'a> = client::Enabled<'a>;

/// Longest wait of a motion that ends with Ctrl-C only.
pub const FOR_EVER: Duration = Duration::from_secs(100 * 365 * 24 * 3600);

/// Options of commands that need the drive in one mode.
#[derive(Debug, Args)]
pub struct SetMode {
    /// Put the drive into the mode this needs (PNU 930) and put mode and telegram (PNU 922) back afterwards; without it
    /// the command refuses a drive in another mode
    #[arg(long)]
    pub set_mode: bool,
}

pub fn rpm(quantity: &Quantity, what: &str) -> Result<f64, Failure> {
    in_unit(quantity, "rpm", what)
}

pub fn in_unit(quantity: &Quantity, unit: &str, what: &str) -> Result<f64, Failure> {
    quantity
        .in_unit(unit)
        .map_err(|error| Failure::usage(format!("{what}: {error}")))
}

/// Rejects an unsupported update time before anything is opened.
pub fn checked(cyclic: &Cyclic) -> Result<(), Failure> {
    match cyclic.cycle {
        Some(cycle) if Timing::for_interval(cycle).is_none() => Err(Failure::usage(format!(
            "--cycle: an update time of {} ms does not exist",
            cycle.as_secs_f64() * 1000.0
        ))
        .hint("use 1, 2, 4, 8 .. 512 ms; left out it is at least 16 ms, as the drive allows it")),
        _ => Ok(()),
    }
}

/// Reports the rounding of a speed; differences below the printed digits are not reported.
pub fn report_rounding(asked: f64, rounded: f64, unit: &str, output: &Output) {
    let (asked, rounded) = (number(asked), number(rounded));
    if asked != rounded {
        output.say(&format!(
            "{asked} {unit} -> {rounded} {unit}, rounded to the nearest representable value"
        ));
    }
}

/// Turns to three digits; a zero has no sign.
pub fn rounded(turns: f64) -> f64 {
    (turns * 1000.0).round() / 1000.0 + 0.0
}

/// Where the axis is once the power stage is off, if it has left its place since.
pub fn left(place: Option<f64>, now: Option<f64>) -> Option<f64> {
    now.zip(place)
        .filter(|(now, place)| (now - place).abs() > LEFT)
        .map(|(now, _)| now)
}

/// Distance from the former position that is reported, turns.
const LEFT: f64 = 0.01;

/// The settings of an axis.
pub fn settings(cyclic: &Cyclic, consent: &Consent, purpose: Purpose, limit: f64) -> AxisSettings {
    AxisSettings {
        purpose,
        cycle: cyclic.cycle,
        watchdog: cyclic.watchdog,
        speed_limit: limit,
        may_run_on: consent.may_run_on,
        ..AxisSettings::default()
    }
}

/// Warns of an active limit switch in the direction of motion.
pub fn warn_switch(speed: f64, facts: &MotionFacts, output: &Output) {
    if facts.is_at_switch(speed) {
        output.warn("the limit switch in this direction is hit: the drive may not turn");
    }
}

/// Above the limit nothing is sent at all.
pub fn within(speed: f64, limit: f64, unit: SpeedUnit) -> Result<(), Failure> {
    if speed.abs() > limit {
        return Err(Error::SpeedLimit {
            wanted: speed,
            limit,
            unit: unit.symbol(),
        }
        .into());
    }
    Ok(())
}

/// Connects to a drive, does something with it in the mode that is needed, and lets it go.
pub fn with_drive(
    interface: &Interface,
    name: &str,
    (needed, wanted): (Mode, &SetMode),
    output: &Output,
    work: impl FnOnce(&mut Live, &mut Drive) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(interface, Need::Cyclic, name, output)?;
    in_mode(&mut session, &mut drive, needed, wanted, output, work)?;
    Ok(session.close().wait()?)
}

/// Does something with the drive in the mode that is needed: put into it, if that was requested, and back afterwards,
/// whatever happened.
pub fn in_mode(
    session: &mut Live,
    drive: &mut Drive,
    needed: Mode,
    wanted: &SetMode,
    output: &Output,
    work: impl FnOnce(&mut Live, &mut Drive) -> Result<(), Failure>,
) -> Result<(), Failure> {
    drive.check_able(Some(needed))?;
    if !wanted.set_mode {
        return work(session, drive);
    }
    let before = session.enter_mode(drive, needed).wait()?;
    report_mode(&before, needed, output);
    let result = work(session, drive);
    leave_mode(session, drive, &before, output);
    result
}

/// Reports the mode that the drive was put into.
fn report_mode(before: &ModeBefore, needed: Mode, output: &Output) {
    let needed = mode_number(needed);
    match before.mode {
        _ if !before.changed => {}
        Some(present) => output.say(&format!(
            "PNU 930: {} -> {needed} for this command",
            mode_number(present)
        )),
        None => output.say(&format!(
            "PNU 930 is {needed} now; what it was is none of 1 and 2 and is not put back"
        )),
    }
}

/// Puts mode and telegram back and reports it.
fn leave_mode(session: &mut Live, drive: &mut Drive, before: &ModeBefore, output: &Output) {
    let done = match session.leave_mode(drive, before).wait() {
        Ok(done) => done,
        Err(error) => {
            output.warn(&format!(
                "mode and telegram were not put back (PNU 930, 922): {error}"
            ));
            return;
        }
    };
    for PutBack {
        number,
        value,
        result,
    } in done
    {
        match result {
            Ok(()) => output.say(&format!("PNU {number} is {value} again")),
            Err(error) => output.warn(&format!("PNU {number} was not put back to {value}: {error}")),
        }
    }
}

const fn mode_number(mode: Mode) -> u8 {
    match mode {
        Mode::Velocity => 1,
        Mode::Position => 2,
    }
}

/// Refuses a drive that may run on when this program is gone, unless that is consented to; then it is a warning.
pub fn report_controller_loss(
    session: &mut Live,
    drive: &mut Drive,
    consent: &Consent,
    command: &str,
    output: &Output,
) -> Result<(), Failure> {
    let loss = session.loss_reaction(drive).wait()?;
    loss.permit(drive, consent.may_run_on)?;
    if loss.action.stops() {
        return Ok(());
    }
    let label = drive.label();
    let remedy = loss.remedy.as_ref();
    if output.json() {
        let command_line = remedy.and_then(|action| advice::command(action, &label));
        let reaction = fields! {
            "parameter": loss.parameter.as_deref(), "setting": loss.setting.as_deref(), "action": loss.action.id(),
            "advice": command_line,
        };
        output.event(command, fields! { "goes_on_alone": reaction });
    }
    let does = match loss.action {
        LossAction::KeepsTurning => "the drive goes on",
        _ => "it is not known whether the drive stops",
    };
    let setting = match (&loss.parameter, &loss.setting) {
        (Some(parameter), Some(setting)) => format!("{parameter} is {setting}: "),
        _ => String::new(),
    };
    let advice = remedy
        .and_then(|action| advice::sentence(action, &label))
        .map_or_else(String::new, |advice| format!("; {advice}"));
    output.warn(&format!(
        "{setting}should this program be killed or the line break, {does}{advice}"
    ));
    Ok(())
}

/// Shows the axis from now on, and says what taking it has changed at the drive; with `--set-mode` that is put back.
pub fn watch(axis: &mut Axis, command: &'static str, set_mode: bool, output: &Output) {
    if let Some(before) = axis.telegram_before() {
        let after = if set_mode {
            "it is put back afterwards"
        } else {
            "it remains selected"
        };
        output.say(&format!(
            "telegram {before} -> {} (PNU 922) for this; {after}",
            axis.telegram()
        ));
        if output.json() {
            let change = fields! { "before": before, "now": axis.telegram(), "kept": !set_mode };
            output.event(command, fields! { "telegram_changed": change });
        }
    }
    if let Some(strained) = axis.strained() {
        warn_strained(&strained, command, output);
    }
    let view = Shared::new(LiveView::new(output.clone(), command));
    let mut stop = LongStop::default();
    let (above, printer) = (view.clone(), output.clone());
    axis.watch_warnings(move |status, warnings| {
        above.lock().leave();
        report_warnings(command, status, warnings, &printer);
    });
    let output = output.clone();
    axis.watch(move |status| {
        view.lock().show(&AxisView::of(status));
        if stop.is_due(status) {
            view.lock().leave();
            output.say("still stopping along the ramp; Ctrl-C for a quick stop (OFF3), after a second if it was pressed before");
        }
    });
}

/// Warns that this computer does not keep to the cycle of the connection, before anything is enabled.
fn warn_strained(strained: &Strained, command: &str, output: &Output) {
    if output.json() {
        let millis = |time: Duration| time.as_secs_f64() * 1000.0;
        let cycle = strained.cycle;
        let values = fields! {
            "cycle_ms": millis(cycle.interval()), "watchdog_ms": millis(cycle.hold_time()),
            "longest_delay_ms": millis(strained.delay),
        };
        output.event(command, fields! { "cycle_strained": values });
    }
    output.warn(&format!("{strained}; {}", calmer(strained)));
}

/// The options of a cycle with more room, or the advice of one that is as long as it gets.
fn calmer(strained: &Strained) -> String {
    if strained.is_watchdog_too_short() {
        return "leave out --watchdog".to_owned();
    }
    let needed = Cycle::CALM.max(strained.delay * 2);
    let cycle = [16_u16, 32, 64, 128].map(|millis| Duration::from_millis(millis.into()));
    match cycle.into_iter().find(|&cycle| cycle >= needed) {
        Some(Cycle::CALM) => "leave out --cycle and --watchdog".to_owned(),
        Some(cycle) => format!("use `--cycle {}ms --watchdog 7`", cycle.as_millis()),
        None => "close the programs that keep it busy".to_owned(),
    }
}

/// Warnings in words, at the time they come.
fn report_warnings(command: &str, status: &AxisStatus, warnings: &[WarningEntry], output: &Output) {
    if output.json() {
        let list: Vec<Value> = warnings
            .iter()
            .map(|warning| Value::Object(super::faults::warning_json(warning)))
            .collect();
        output.event(
            command,
            fields! { "time": status.time.as_secs_f64(), "warnings": list },
        );
    }
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

/// Reports a long ramp once.
#[derive(Debug, Default)]
struct LongStop {
    since: Option<Duration>,
    reported: bool,
}

impl LongStop {
    /// From which time on a stop is a long one.
    const LONG: Duration = Duration::from_millis(1000);

    fn is_due(&mut self, status: &AxisStatus) -> bool {
        if status.view.goal != Goal::Stop || status.view.at_rest || status.view.quick_stop || status.lost {
            self.since = None;
            return false;
        }
        let since = *self.since.get_or_insert(status.time);
        if self.reported || status.time.saturating_sub(since) < Self::LONG {
            return false;
        }
        self.reported = true;
        true
    }
}

/// How a motion ends by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// With Ctrl-C: that is how it was meant.
    Open,
    /// When its time is over: Ctrl-C before is a failure.
    Time,
    /// At its target: Ctrl-C before is a failure.
    Target(&'static str),
}

/// Stops and releases in any case, then reports the result.
pub fn finish(
    axis: Axis,
    result: Result<(), Error>,
    end: End,
    command: &str,
    more: Map<String, Value>,
    output: &Output,
) -> Result<(), Error> {
    let statistics = axis.statistics();
    // a ramp that was under way may have ended meanwhile, by a trip for example
    let released = axis.release_and_look().wait();
    let rest = *released.as_ref().unwrap_or(&Rest::Stands);
    let interrupted = matches!(result, Err(Error::Interrupted));
    if interrupted && output.is_closed() {
        output.say("the output has no reader any more: stopped");
    }
    let result = match (result, end) {
        (Err(Error::Interrupted), End::Open) => Ok(()),
        (other, _) => other,
    };
    let stopped = released.is_ok() && (result.is_ok() || interrupted);
    if let Some(statistics) = statistics {
        output.say(&frames(&statistics));
    }
    if stopped {
        output.say(match rest {
            Rest::Stands => "axis at rest, control released",
            Rest::Coasts => {
                "control released; the axis turns with its power stage off: it coasts, or something moves it"
            }
            Rest::Runs => "control released; the axis still turns with its power stage on",
        });
    }
    if output.json() && stopped {
        let counts = statistics.map_or_else(Default::default, |counts| {
            fields! { "received": counts.received, "missed": counts.missed }
        });
        let unfinished = interrupted && end != End::Open;
        let mut document = fields! { "end": true, "released": true, "coasts": rest == Rest::Coasts, "interrupted": unfinished, "frames": counts };
        document.extend(more);
        output.event(command, document);
    }
    result.and(released.map(|_| ()))
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

/// How a motion ended that was not to end so.
fn unfinished(end: End) -> Option<String> {
    match end {
        End::Open => None,
        End::Time => Some("stopped before the end by Ctrl-C or a signal".to_owned()),
        End::Target(what) => Some(format!("stopped by Ctrl-C or a signal, {what}")),
    }
}

/// Adds the status of the drive to a failed motion: fault by number and text, warnings, and the cause that prevents
/// operation.
pub fn explained(error: Error, end: End, session: &mut Live, drive: &mut Drive) -> Failure {
    if matches!(error, Error::Interrupted)
        && let Some(how) = unfinished(end)
    {
        return Failure::new(Exit::Failed, format!("{}: {how}", drive.label()));
    }
    // the evidence read while the drive was still in operation is reported already
    let asked = matches!(
        error,
        Error::Axis { .. }
            | Error::NotInTime { .. }
            | Error::Held { .. }
            | Error::SpeedNotReached { .. }
            | Error::NotMoved { .. }
            | Error::SpeedLost { .. }
    );
    let held = matches!(error, Error::Held { .. });
    let left_operation = matches!(
        error,
        Error::Axis {
            trouble: Trouble::LeftOperation { .. },
            ..
        }
    );
    let hint = failure::hint(&error, error.advice_for(drive));
    let mut failure = Failure::from(error);
    failure.hint = hint;
    if !asked {
        return failure;
    }
    let status = session.uninterrupted(async |session: &mut Session| session.status(drive).await);
    let Ok(status) = status.wait() else {
        return failure;
    };
    for fault in &status.faults {
        failure.message = format!("{}; {}", failure.message, fault_text(fault));
    }
    for warning in &status.warnings {
        failure.message = format!("{}; warning {}", failure.message, warned(warning));
    }
    let diagnosis = diagnose(&status);
    // the axis is released by now, so a missing controller is expected
    if diagnosis.verdict == Verdict::Held && status.faults.is_empty() && !held {
        failure.message = format!("{}; {}", failure.message, diagnosis.sentence);
        failure.hint = advice::next(&diagnosis, &drive.label()).or(failure.hint);
    }
    // by now it is off: what turns it then no command of ours holds, and a fault that comes of it stays
    let turns = |note: &Note| note.id == Cause::MovedExternally.id();
    let moved = diagnosis.notes.into_iter().find(turns);
    let beside = switched_off_beside(&status).filter(|_| left_operation);
    for note in moved.into_iter().chain(beside) {
        failure.message = format!("{}; {}", failure.message, note.sentence);
        failure.hint = note
            .next
            .map(|next| advice::text(&next, &drive.label()))
            .or(failure.hint);
    }
    failure
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
    use super::*;

    #[test]
    fn a_strained_cycle_comes_with_options_that_have_room() {
        let millis = Duration::from_millis;
        let advice = |cycle, count, delay| {
            let cycle = Cycle::choose(&[], millis(1), Some(millis(cycle)), Some(count)).unwrap();
            calmer(&cycle.judge(millis(delay)).unwrap())
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
    fn only_what_has_no_end_of_its_own_ends_well_by_a_signal() {
        assert_eq!(unfinished(End::Open), None);
        assert!(unfinished(End::Time).is_some_and(|how| how.contains("before the end")));
        assert!(
            unfinished(End::Target("the target was not reached"))
                .is_some_and(|how| how.contains("not reached"))
        );
    }
}
