//! `profidrive stop`

use std::time::Duration;

use clap::Args;
use client::status::moved_advice;
use client::{StopOutcome, StopWay, Wait};

use crate::args::{Interface, duration};
use crate::connect::{self, Need};
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::Output;
use crate::render::table::clean;

#[derive(Debug, Args)]
pub struct Stop {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Switch the power stage off too (AKD: DRV.DIS; all others are always switched off); its controller needs OFF and ON
    /// afterwards
    #[arg(long)]
    pub disable: bool,
    /// How long the axis may take to come to rest. A drive that is taken over gets this beside the time of its ramp, as far as
    /// it reports that; then it is stopped by the quick stop (OFF3)
    #[arg(long, value_name = "TIME", default_value = "10s", value_parser = duration)]
    pub timeout: Duration,
}

pub fn run(args: &Stop, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(interface, Need::Stop, &args.drive, output)?;
    let way = if args.disable {
        StopWay::Disable
    } else {
        StopWay::Stop
    };
    // the command first: everything else can be asked while it slows down
    let outcome = session.stop_drive(&mut drive, way, args.timeout).wait()?;
    let owner = session.owner(&drive).wait()?;
    session.close().wait()?;
    let label = drive.label();
    let command = outcome.command(way, &drive);
    // of a drive that is stopped by its control word there is nothing stronger
    let has_disable = drive
        .model
        .catalogue
        .is_some_and(|tables| tables.part(StopWay::Disable.part()).is_some());
    if output.json() {
        output.document(
            "stop",
            fields! {
                "drive": label.as_str(), "sent": outcome.sent.then_some(command),
                "speed_before": outcome.speed_before, "speed": outcome.speed,
                "speed_before_percent": outcome.percent_before, "speed_percent": outcome.percent, "enabled": outcome.enabled,
                "at_rest": outcome.at_rest, "controller": owner.clone().flatten(), "unread": outcome.unread.as_deref(),
            },
        );
    } else {
        output.line(&summary(&label, command, &outcome));
    }
    if let Some(cause) = &outcome.unread {
        output.warn(&format!(
            "parameters of {label} cannot be read ({}): what they say was not taken into account",
            clean(cause)
        ));
    }
    let owned = owner.flatten().filter(|_| outcome.sent);
    if let Some(name) = &owned {
        output.warn(&format!(
            "controller \"{}\" goes on commanding {label}: what it sends next may move the axis again",
            clean(name)
        ));
    }
    if outcome.at_rest {
        return Ok(());
    }
    if outcome.enabled == Some(false) && outcome.speed.is_some() {
        let speed = outcome.speed.unwrap_or_default();
        let message =
            format!("{label} turns at {speed:.1} rpm with its power stage off: something outside moves it");
        return Err(Failure::new(Exit::Safety, message).hint(moved_advice(drive.model.name)));
    }
    Err(Failure::new(
        Exit::Failed,
        format!(
            "{label} is not at rest {} s after {}",
            args.timeout.as_secs_f64(),
            command
        ),
    )
    .hint(if args.disable || !has_disable {
        "stop it at its controller or with its safety circuit; this command is not an emergency stop"
    } else {
        "--disable switches the power stage off; this command is not an emergency stop"
    }))
}

/// Returns what was done, in one line.
fn summary(drive: &str, command: &str, outcome: &StopOutcome) -> String {
    let speed = |rpm: Option<f64>, percent: Option<f64>| match (rpm, percent) {
        (Some(rpm), _) => format!("{rpm:.1} rpm"),
        (None, Some(percent)) => format!("{percent:.1} % of its reference"),
        (None, None) => "an unknown speed".into(),
    };
    let before = speed(outcome.speed_before, outcome.percent_before);
    let after = speed(outcome.speed, outcome.percent);
    let stage = match outcome.enabled {
        Some(true) => "the power stage is still on",
        Some(false) => "the power stage is off",
        None => "the drive does not report whether its power stage is on",
    };
    if !outcome.sent && outcome.speed_before.is_some_and(|speed| speed.abs() >= 1.0) {
        let end = if outcome.at_rest {
            "came to rest"
        } else {
            "turns on"
        };
        return format!(
            "{drive} turned at {before} with its power stage off, so nothing was sent: it {end} ({after})"
        );
    }
    if !outcome.sent {
        return format!("{drive} is at rest, {stage}: nothing was sent");
    }
    let end = if outcome.at_rest {
        "it stands"
    } else {
        "it still turns or is still on"
    };
    format!("{command} sent to {drive} at {before}: {end} ({after}), {stage}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn help_describes_what_the_timeout_bounds() {
        let help = Stop::augment_args(clap::Command::new("stop"))
            .render_long_help()
            .to_string();
        let words: Vec<&str> = help.split_whitespace().collect();
        let text = words.join(" ");
        assert!(
            text.contains("beside the time of its ramp") && text.contains("quick stop"),
            "{text}"
        );
    }

    #[test]
    fn summary_describes_the_stop() {
        let outcome = StopOutcome {
            sent: true,
            speed_before: Some(60.02),
            speed: Some(0.0),
            percent_before: None,
            percent: None,
            by_word: false,
            enabled: Some(true),
            at_rest: true,
            unread: None,
        };
        assert_eq!(
            summary("akd-1", "DRV.STOP", &outcome),
            "DRV.STOP sent to akd-1 at 60.0 rpm: it stands (0.0 rpm), the power stage is still on"
        );
        let nothing = StopOutcome {
            sent: false,
            speed_before: Some(0.0),
            enabled: Some(false),
            ..outcome.clone()
        };
        assert_eq!(
            summary("akd-1", "DRV.STOP", &nothing),
            "akd-1 is at rest, the power stage is off: nothing was sent"
        );
        let pulled = StopOutcome {
            speed_before: Some(60.02),
            speed: Some(-480.5),
            at_rest: false,
            ..nothing
        };
        assert_eq!(
            summary("akd-1", "DRV.STOP", &pulled),
            "akd-1 turned at 60.0 rpm with its power stage off, so nothing was sent: it turns on (-480.5 rpm)"
        );
        let slave = StopOutcome {
            speed_before: None,
            speed: None,
            percent_before: Some(60.02),
            percent: Some(0.0),
            enabled: Some(false),
            ..outcome.clone()
        };
        assert_eq!(
            summary("vacon", "OFF1", &slave),
            "OFF1 sent to vacon at 60.0 % of its reference: it stands (0.0 % of its reference), the power stage is off"
        );
        let turning = StopOutcome {
            speed: None,
            at_rest: false,
            ..outcome
        };
        assert!(summary("akd-1", "DRV.DIS", &turning).starts_with("DRV.DIS sent to akd-1"));
    }
}
