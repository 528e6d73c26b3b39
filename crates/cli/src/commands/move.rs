//! `profidrive move`

use client::axis::Move as Order;
use client::{Error, Wait};
use profidrive::motion::{self, MoveReport};
use profile::notation::Quantity;

use super::axis;
use super::recorded::Recorder;
use crate::args::{Move, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Move, target: &Target, output: &Output) -> Result<(), Failure> {
    let mut args = args.clone();
    let ramps = args.acceleration.iter_mut().chain(&mut args.deceleration);
    let quantities = [&mut args.to, &mut args.velocity, &mut args.limit].into_iter();
    let unit = axis::in_motor_units(target, quantities.chain(ramps), output)?;
    let order = order(&args)?;
    let mut wanted = motion::Move {
        order,
        limit: axis::rpm(&args.limit, "--limit")?.abs(),
        timeout: args.timeout,
        control: axis::in_mode(&args.control)?,
    };
    wanted.check()?;
    let mut recorder = Recorder::of(args.recorded.record.as_deref())?;
    if args.dry_run {
        return try_out(wanted, target, output);
    }
    let (report, recorded) = recorder.moving(target, output, |(session, drive), bound, observer| {
        wanted.control.bound = bound;
        motion::move_to(session, drive, &wanted, observer).wait()
    })?;
    axis::show_travel(unit.as_ref(), &report, output);
    recorded
}

/// Everything that `move` reads and checks; nothing is sent that changes anything.
fn try_out(mut wanted: motion::Move, target: &Target, output: &Output) -> Result<(), Failure> {
    let (plan, report) = axis::moving(
        target,
        Need::Records,
        output,
        |(session, drive), bound, observer| {
            wanted.control.bound = bound;
            let plan = motion::plan_move(session, drive, &wanted, &observer).wait()?;
            let report = MoveReport::of(&plan, drive);
            Ok((plan, report))
        },
    )?;
    output.say(&format!("dry run: {} {}; nothing moves", report.drive, plan));
    output.json_report(&report);
    if plan.objections.is_empty() {
        return Ok(());
    }
    Err(Error::Objections {
        drive: report.drive,
        objections: plan.objections,
    }
    .into())
}

fn order(args: &Move) -> Result<Order, Failure> {
    let target = args
        .to
        .position()
        .map_err(|error| Failure::usage(format!("--to: {error}")))?;
    if args.velocity.in_hertz().is_some() {
        return Err(Failure::usage(
            "--velocity: speeds in Hz are output frequencies of frequency converters, which do not position",
        )
        .hint("give the speed in rpm"));
    }
    let speed = axis::rpm(&args.velocity, "--velocity")?;
    let ramp = |quantity: &Option<Quantity>, what| {
        quantity
            .as_ref()
            .map(|quantity| axis::in_unit(quantity, "rpm/s", what))
            .transpose()
    };
    let order = if args.relative {
        Order::by(target, speed)
    } else {
        Order::to(target, speed)
    };
    Ok(order.with_ramps(
        ramp(&args.acceleration, "--acceleration")?,
        ramp(&args.deceleration, "--deceleration")?,
    ))
}
