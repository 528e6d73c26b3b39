//! What all commands that move an axis share: the words for what happens on the way.

use std::time::Duration;

use client::axis::Room;
use client::{Drive, Wait};
use profidrive::machine::{Machine, UserUnit};
use profidrive::motion::{self, Control, End, Event, Message, MotionError, Observer, Remark};
use profile::notation::Quantity;
use profinet::cyclic::Timing;

use crate::advice::{self, Commands};
use crate::args::{Cyclic, Enabling, InMode, Target};
use crate::connect::{self, Live, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::live::LiveView;
use crate::render::number;

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

/// Connects to a drive and works on its axis; closes the connection after what went well.
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

/// Converts quantities in the unit of the load, which the machine file has for the drive, into those of the motor, and says so.
pub fn in_motor_units<'a>(
    target: &Target,
    quantities: impl IntoIterator<Item = &'a mut Quantity>,
    output: &Output,
) -> Result<Option<UserUnit>, Failure> {
    let machine = connect::machine(&target.options, output)?;
    let unit = machine
        .as_ref()
        .and_then(|machine| machine.user_unit(&target.drive));
    let Some(unit) = unit else { return Ok(None) };
    for quantity in quantities {
        if let Some(motor) = unit.to_motor(quantity) {
            output.say(&format!("{quantity} is {} ({unit})", shown(&motor)));
            *quantity = motor;
        }
    }
    Ok(Some(unit.clone()))
}

/// Shows where the axis is, or how far it went, in the unit of its load.
pub fn show_travel(unit: Option<&UserUnit>, report: &motion::Report, output: &Output) {
    let Some(unit) = unit else { return };
    let result = &report.result;
    let load = |quantity: &Option<profidrive::report::Quantity>| {
        let load = unit.of_motor(quantity.as_ref()?)?;
        Some(format!(
            "{} {}",
            number((load.value * 1e3).round() / 1e3),
            load.unit
        ))
    };
    match (load(&result.position), load(&result.distance)) {
        (Some(position), _) => output.say(&format!("the load is at {position}")),
        (None, Some(distance)) => output.say(&format!("the load went {distance}")),
        (None, None) => {}
    }
}

fn shown(quantity: &Quantity) -> String {
    let unit = quantity.unit.as_deref().unwrap_or_default();
    format!("{} {unit}", number(quantity.number.as_f64()))
}

/// Connects to a drive and moves it, within the limit that the machine file has for its speed.
pub fn moving<T>(
    target: &Target,
    need: Need,
    output: &Output,
    work: impl FnOnce((&mut Live, &mut Drive), Observer) -> Result<T, MotionError>,
) -> Result<T, Failure> {
    let machine = connect::machine(&target.options, output)?;
    let mut of_machine = false;
    let done = with_drive(target, need, output, |session, drive| {
        session.bound_speeds(machine.as_ref().map_or_else(Vec::new, Machine::bounds));
        let observer = observer(&drive.label(), output);
        let done = work((session, drive), observer);
        of_machine = matches!(
            done,
            Err(MotionError::AboveBound { .. } | MotionError::NotBounded { .. })
        );
        done
    });
    let path = machine.and_then(|machine| machine.path).filter(|_| of_machine);
    done.map_err(|failure| match path {
        Some(path) => failure.and_hint(format!("the machine file is {}", path.display())),
        None => failure,
    })
}

/// A motion that failed. What stops one is this program's own.
impl From<MotionError> for Failure {
    fn from(error: MotionError) -> Self {
        let failure = Self::explained(&error);
        let MotionError::Stopped { drive, end, .. } = error else {
            return failure;
        };
        let message = match end {
            End::Open | End::Time => format!("{drive}: stopped before the end by Ctrl-C or a signal"),
            other => format!("{drive}: stopped by Ctrl-C or a signal, {}", other.missing()),
        };
        Self { message, ..failure }
    }
}

/// Shows a motion on the way: the axis as it moves, everything else as messages, and both as documents for programs.
pub fn observer(drive: &str, output: &Output) -> Observer {
    let mut view = LiveView::new(output.clone());
    let (drive, output) = (drive.to_owned(), output.clone());
    Observer::new(move |event| {
        if let Event::Sample(status) = event {
            view.show(status, None);
            return;
        }
        view.leave();
        for message in Message::of(event, &Commands(&drive)) {
            output.json_event(&message);
        }
        if matches!(event, Event::Ended(ended) if ended.interrupted) && output.is_closed() {
            output.say("the output has no reader any more: stopped");
        }
        for Remark {
            sentence,
            is_warning,
            next,
        } in event.remarks()
        {
            let next = next.map(|next| format!("; {}", advice::text(&next, &drive)));
            let text = format!("{sentence}{}", next.unwrap_or_default());
            match event {
                Event::LongStop => output.say(&format!(
                    "{text}; Ctrl-C makes it a quick stop (OFF3), at least 1 s after the last one"
                )),
                _ if is_warning => output.warn(&text),
                _ => output.say(&text),
            }
        }
        match event {
            Event::Starting { telegram, start } => {
                if let Some(text) = start.sentence(*telegram) {
                    output.say(&format!("this moves the axis: {drive} {text}; Ctrl-C stops it"));
                }
            }
            Event::Strained(strained) => output.warn(&format!("{strained}; {}", calmer(strained.room()))),
            _ => {}
        }
    })
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
