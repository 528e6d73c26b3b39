//! `profidrive run`

use std::time::Duration;

use clap::Args;
use drive_client::axis::{MotionFacts, Purpose};
use drive_client::{Drive, Error};
use profidrive::notation::Quantity;
use profidrive::state::Mode;

use super::axis::{self, End, SetMode};
use crate::args::{Cyclic, Interface, duration};
use crate::connect::Live;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::number;

/// A ramp that takes longer than this is told beforehand.
const LONG_RAMP: Duration = Duration::from_secs(2);

#[derive(Debug, Args)]
pub struct Run {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Speed: 60rpm, -1rps; a bare number is in rpm
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub velocity: Quantity,
    /// How long to run at the speed, counted from when it is reached; until Ctrl-C when left out
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub time: Option<Duration>,
    /// Refuse any speed above this
    #[arg(long, value_name = "SPEED", default_value = "3000rpm")]
    pub limit: Quantity,
    #[command(flatten)]
    pub mode: SetMode,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

pub fn run(args: &Run, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let speed = axis::rpm(&args.velocity, "--velocity")?;
    let limit = axis::rpm(&args.limit, "--limit")?.abs();
    axis::within(speed, limit)?;
    axis::checked(&args.cyclic)?;
    let needed = (Mode::Velocity, &args.mode);
    axis::with_drive(interface, &args.drive, needed, output, |session, drive| {
        go(args, speed, limit, session, drive, output)
    })
}

fn go(
    args: &Run,
    speed: f64,
    limit: f64,
    session: &mut Live,
    drive: &mut Drive,
    output: &Output,
) -> Result<(), Failure> {
    let time = args.time.map_or_else(
        || "until Ctrl-C".into(),
        |time| format!("for {} s", time.as_secs_f64()),
    );
    session.check_speed(drive, speed)?;
    let facts = session.motion_facts(drive)?;
    if let Some(warning) = above(speed, &facts) {
        output.warn(&warning);
    }
    let end = if args.time.is_some() { End::Time } else { End::Open };
    let settings = axis::settings(&args.cyclic, Purpose::Speed, limit);
    let mut taken = session.take_axis(drive, settings)?;
    output.say(&format!(
        "this moves the axis: {} turns at {} rpm {time}; Ctrl-C stops it",
        drive.label(),
        number(speed)
    ));
    axis::watch(&mut taken, "run", output);
    let result = taken.enable().and_then(|mut enabled| match args.time {
        Some(time) => {
            let ramp = enabled.speed_time(speed);
            if ramp > LONG_RAMP {
                output.say(&format!(
                    "the ramp up takes about {:.0} s (DRV.ACC), the time counts from its end",
                    ramp.as_secs_f64()
                ));
            }
            enabled.reach_speed(speed, None)?;
            enabled.keep_speed(speed, time)
        }
        None => {
            match enabled.reach_speed(speed, None) {
                Err(Error::Interrupted) => {
                    let actual = enabled.status().and_then(|status| status.speed_actual);
                    output.warn(&unreached(speed, actual));
                    return Err(Error::Interrupted);
                }
                other => other?,
            }
            enabled.keep_speed(speed, axis::FOR_EVER)
        }
    });
    axis::finish(taken, result, end, "run", serde_json::Map::new(), output)
        .map_err(|error| axis::explained(error, end, session, drive))
}

/// A run that ended before it was at its speed.
fn unreached(speed: f64, actual: Option<f64>) -> String {
    let actual = actual.map_or_else(String::new, |actual| format!(", it was {actual:.1} rpm"));
    format!("{} rpm was not reached when the stop came{actual}", number(speed))
}

/// What the drive will make of a speed that is above its own limit, or that leads into a limit switch.
fn above(speed: f64, facts: &MotionFacts) -> Option<String> {
    let (limit, name, hit) = if speed < 0.0 {
        (facts.backward_limit, "VL.LIMITN", facts.negative_switch)
    } else {
        (facts.forward_limit, "VL.LIMITP", facts.positive_switch)
    };
    if hit == Some(true) && speed != 0.0 {
        return Some("the limit switch in this direction is hit: the drive may not turn".into());
    }
    let limit = limit.filter(|&limit| speed.abs() > limit)?;
    Some(format!(
        "the drive limits itself to {} rpm ({name})",
        number(limit)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_the_drive_are_told() {
        let facts = MotionFacts {
            forward_limit: Some(1000.0),
            backward_limit: Some(500.0),
            ..MotionFacts::default()
        };
        assert_eq!(above(1000.0, &facts), None);
        assert_eq!(
            above(-600.0, &facts).as_deref(),
            Some("the drive limits itself to 500 rpm (VL.LIMITN)")
        );
        let hit = MotionFacts {
            positive_switch: Some(true),
            ..facts
        };
        assert!(above(10.0, &hit).is_some() && above(-10.0, &hit).is_none());
    }
}
