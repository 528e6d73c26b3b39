//! `profidrive jog`

use client::Wait;
use client::axis::Jog as Setpoint;
use profidrive::motion::{self, JogPlan, RealTimeJog, Start};

use super::axis;
use super::run::telegram_text;
use crate::args::{Jog, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::{number, value};

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
        let plan = axis::moving(target, Need::Records, output, |session, drive, bound| {
            wanted.control.bound = bound;
            let observer = axis::observer(&drive.label(), Box::new(|_, _| None), output);
            motion::plan_jog(session, drive, &wanted, &observer).wait()
        })?;
        show(&plan, output);
        return Ok(());
    }
    let seconds = args.time.as_secs_f64();
    axis::moving(target, Need::Cyclic, output, |session, drive, bound| {
        wanted.control.bound = bound;
        let start = Box::new(move |start: &_, _| match start {
            Start::Jog { speed } => Some(format!("jogs at {} for {seconds} s", value::full(speed))),
            _ => None,
        });
        let observer = axis::observer(&drive.label(), start, output);
        motion::jog(session, drive, &wanted, &observer).wait()
    })
    .map(|_| ())
}

fn real_time(args: &Jog, mut wanted: RealTimeJog, target: &Target, output: &Output) -> Result<(), Failure> {
    wanted.check()?;
    if args.dry_run {
        let plan = axis::moving(target, Need::Records, output, |session, drive, bound| {
            wanted.control.bound = bound;
            let observer = axis::observer(&drive.label(), Box::new(|_, _| None), output);
            motion::plan_jog_in_real_time(session, drive, &wanted, &observer).wait()
        })?;
        show(&plan, output);
        return Ok(());
    }
    axis::moving(target, Need::Cyclic, output, |session, drive, bound| {
        wanted.control.bound = bound;
        let start = Box::new(move |_: &_, telegram| {
            Some(format!(
                "jogs at {} rpm for {} s (real-time jogging, telegram {telegram})",
                number(wanted.speed),
                wanted.time.as_secs_f64()
            ))
        });
        let observer = axis::observer(&drive.label(), start, output);
        motion::jog_in_real_time(session, drive, &wanted, &observer).wait()
    })
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
    output.say(&format!(
        "dry run: {} would jog at {} rpm for {} s{}; nothing was sent",
        plan.drive,
        number(plan.speed.value),
        plan.time,
        telegram_text(&plan.telegrams)
    ));
    output.json_report(plan);
}
