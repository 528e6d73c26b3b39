//! `profidrive task`

use client::Wait;
use std::time::Duration;

use clap::Args;
use client::Drive;
use client::axis::Purpose;
use profile::state::Mode;

use super::axis::{self, End, SetMode};
use crate::args::{Consent, Cyclic, Interface, duration};
use crate::connect::Live;
use crate::failure::Failure;
use crate::fields;
use crate::output::Output;

#[derive(Debug, Args)]
pub struct Task {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Number of the motion task in the table of the drive
    #[arg(value_name = "NUMBER", value_parser = clap::value_parser!(u16).range(1..=128))]
    pub number: u16,
    /// Stop if the task, or the last one of its chain, is not at its target in this time
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration)]
    pub timeout: Duration,
    #[command(flatten)]
    pub mode: SetMode,
    #[command(flatten)]
    pub consent: Consent,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

pub fn run(args: &Task, interface: &Interface, output: &Output) -> Result<(), Failure> {
    axis::checked(&args.cyclic)?;
    let needed = (Mode::Position, &args.mode);
    axis::with_drive(interface, &args.drive, needed, output, |session, drive| {
        go(args, session, drive, output)
    })
}

fn go(args: &Task, session: &mut Live, drive: &mut Drive, output: &Output) -> Result<(), Failure> {
    const END: End = End::Target("the task was not finished");
    session.check_mode(drive, Mode::Position).wait()?;
    session.check_control(drive).wait()?;
    session.check_task(drive, args.number).wait()?;
    axis::report_controller_loss(session, drive, &args.consent, "task", output)?;
    let settings = axis::settings(&args.cyclic, &args.consent, Purpose::Task, f64::INFINITY);
    let mut axis = session.take_axis(drive, settings).wait()?;
    output.say(&format!(
        "this moves the axis: {} carries out its motion task {}, telegram {}; Ctrl-C stops it",
        drive.label(),
        args.number,
        axis.telegram()
    ));
    axis::watch(&mut axis, "task", args.mode.set_mode, output);
    let mut status = None;
    let result = axis.enable().wait().and_then(|mut enabled| {
        enabled.start_task(args.number).wait()?;
        let reached = enabled.reach_target(Some(args.timeout)).wait();
        status = reached.as_ref().ok().copied().or_else(|| enabled.status());
        reached.map(|_| ())
    });
    let running = status.and_then(|status| status.view.seen?.aktsatz);
    if result.is_ok() {
        output.say(&format!("task {} at its target (ZSW1 bit 10)", args.number));
    }
    let more = fields! {
        "task": args.number, "aktsatz": running, "reached": result.is_ok(),
        "position": status.and_then(|status| status.position),
    };
    axis::finish(axis, result, END, "task", more, output)
        .map_err(|error| axis::explained(error, END, session, drive))
}
