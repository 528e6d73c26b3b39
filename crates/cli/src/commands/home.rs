//! `profidrive home`

use std::time::Duration;

use clap::Args;
use client::axis::Purpose;
use client::{Drive, Error, Wait};
use profile::state::Mode;

use super::axis::{self, End, SetMode};
use crate::args::{Consent, Cyclic, Interface, duration};
use crate::connect::Live;
use crate::failure::Failure;
use crate::fields;
use crate::output::Output;
use crate::render::{number, value};

/// What decides over the procedure.
const SETTINGS: [&str; 4] = ["HOME.MODE", "HOME.DIR", "HOME.V", "HOME.ACC"];

#[derive(Debug, Args)]
pub struct Home {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Stop if homing takes longer
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration)]
    pub timeout: Duration,
    #[command(flatten)]
    pub mode: SetMode,
    #[command(flatten)]
    pub consent: Consent,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

pub fn run(args: &Home, interface: &Interface, output: &Output) -> Result<(), Failure> {
    axis::checked(&args.cyclic)?;
    let needed = (Mode::Position, &args.mode);
    axis::with_drive(interface, &args.drive, needed, output, |session, drive| {
        go(args, session, drive, output)
    })
}

fn go(args: &Home, session: &mut Live, drive: &mut Drive, output: &Output) -> Result<(), Failure> {
    const END: End = End::Target("the axis is not homed");
    axis::report_controller_loss(session, drive, &args.consent, "home", output)?;
    let procedure = procedure(session, drive)?;
    let settings = axis::settings(&args.cyclic, &args.consent, Purpose::Home, f64::INFINITY);
    let mut axis = session.take_axis(drive, settings).wait()?;
    output.say(&format!(
        "this moves the axis: {} homes{procedure}, telegram {}; Ctrl-C stops it",
        drive.label(),
        axis.telegram()
    ));
    axis::watch(&mut axis, "home", args.mode.set_mode, output);
    let mut place = None;
    let result = axis.enable().wait().and_then(|mut enabled| {
        let result = enabled.home(Some(args.timeout)).wait();
        place = enabled.status().and_then(|status| status.position);
        result
    });
    let now = axis.status().and_then(|status| status.position);
    let left = axis::left(place, now).filter(|_| result.is_ok());
    if result.is_ok() {
        let at = place.map_or_else(String::new, |position| {
            format!(", the axis is at {} rev", number(axis::rounded(position)))
        });
        output.say(&format!("homed (ZSW1 bit 11){at}"));
    }
    if let Some(now) = left {
        output.warn(&format!(
            "it has left that place since: it is at {} rev now",
            number(axis::rounded(now))
        ));
    }
    let more = fields! { "homed": result.is_ok(), "position": place, "left_to": left };
    axis::finish(axis, result, END, "home", more, output)
        .map_err(|error| axis::explained(error, END, session, drive))
}

/// Returns the procedure, ` by HOME.MODE 1 (To a limit switch), HOME.DIR 1, HOME.V 60 rpm`, as far as the drive reports
/// it.
fn procedure(session: &mut Live, drive: &mut Drive) -> Result<String, Error> {
    let mut parts = Vec::new();
    for name in SETTINGS {
        let Ok(selection) = drive.select(name) else {
            continue;
        };
        match session.read_one(drive, &selection).wait() {
            Ok(reading) => parts.push(format!("{name} {}", value::full(&reading))),
            Err(Error::Refused { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(if parts.is_empty() {
        String::new()
    } else {
        format!(" by {}", parts.join(", "))
    })
}
