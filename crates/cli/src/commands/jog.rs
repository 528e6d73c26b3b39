//! `profidrive jog`

use client::Wait;
use client::axis::Jog as Setpoint;
use profidrive::motion::{self, JogPlan, RealTimeJog};

use super::axis;
use crate::args::{Jog, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::value;

pub fn run(args: &Jog, target: &Target, output: &Output) -> Result<(), Failure> {
    let limit = axis::rpm(&args.limit, "--limit")?.abs();
    let speed = args.velocity.as_ref();
    let speed = speed
        .map(|quantity| axis::rpm(quantity, "--velocity"))
        .transpose()?;
    let control = axis::enabling(&args.control)?;
    if let Some(speed) = speed.filter(|_| args.real_time) {
        let wanted = RealTimeJog {
            speed,
            time: args.time,
            limit,
            control,
        };
        return real_time(args, wanted, target, output);
    }
    let mut wanted = motion::Jog {
        setpoint: match args.jog {
            2 => Setpoint::Two,
            _ => Setpoint::One,
        },
        speed,
        time: args.time,
        limit,
        control,
    };
    wanted.check()?;
    if args.dry_run {
        let plan = axis::moving(
            target,
            Need::Records,
            output,
            |(session, drive), bound, observer| {
                wanted.control.bound = bound;
                motion::plan_jog(session, drive, &wanted, observer).wait()
            },
        )?;
        show(&plan, output);
        return Ok(());
    }
    axis::moving(
        target,
        Need::Cyclic,
        output,
        |(session, drive), bound, observer| {
            wanted.control.bound = bound;
            motion::jog(session, drive, &wanted, observer).wait()
        },
    )
    .map(|_| ())
}

fn real_time(args: &Jog, mut wanted: RealTimeJog, target: &Target, output: &Output) -> Result<(), Failure> {
    wanted.check()?;
    if args.dry_run {
        let plan = axis::moving(
            target,
            Need::Records,
            output,
            |(session, drive), bound, observer| {
                wanted.control.bound = bound;
                motion::plan_jog_in_real_time(session, drive, &wanted, observer).wait()
            },
        )?;
        show(&plan, output);
        return Ok(());
    }
    axis::moving(
        target,
        Need::Cyclic,
        output,
        |(session, drive), bound, observer| {
            wanted.control.bound = bound;
            motion::jog_in_real_time(session, drive, &wanted, observer).wait()
        },
    )
    .map(|_| ())
}

fn show(plan: &JogPlan, output: &Output) {
    if let Some(change) = &plan.change {
        let (before, after) = (value::full(&change.before), value::full(&change.after));
        output.say(&format!(
            "{} would be {before} -> {after} for this and back afterwards",
            change.parameter
        ));
    }
    output.say(&format!("dry run: {} would {plan}; nothing was sent", plan.drive));
    output.json_report(plan);
}
