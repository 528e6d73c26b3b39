//! `profidrive move`

use std::time::Duration;

use clap::Args;
use client::axis::{Move as Order, MovePlan, Purpose, SpeedUnit};
use client::{Drive, Error, Wait};
use profile::notation::Quantity;
use profile::state::Mode;
use serde_json::{Map, Value};

use super::axis::{self, End, SetMode};
use crate::args::{Consent, Cyclic, Interface, duration};
use crate::connect::{self, Live, Need};
use crate::failure::Failure;
use crate::fields;
use crate::output::Output;
use crate::render::number;

/// How much longer than reckoned a move may take: this many times, and this much more.
const ALLOWANCE: (u32, Duration) = (3, Duration::from_secs(10));
/// For a move whose length is not known.
const LONGEST: Duration = Duration::from_secs(120);

#[derive(Debug, Args)]
pub struct Move {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Where to: 10rev, -90deg, 655360 (counts); with --relative how far
    #[arg(long, value_name = "POSITION", allow_hyphen_values = true)]
    pub to: Quantity,
    /// The position is a distance from where the axis is
    #[arg(long)]
    pub relative: bool,
    /// Speed: 300rpm, 5rps; a bare number is in rpm
    #[arg(long, value_name = "SPEED")]
    pub velocity: Quantity,
    /// Acceleration: 3000rpm/s; DRV.ACC of the drive when left out
    #[arg(long, value_name = "RAMP")]
    pub acceleration: Option<Quantity>,
    /// Deceleration; DRV.DEC of the drive when left out
    #[arg(long, value_name = "RAMP")]
    pub deceleration: Option<Quantity>,
    /// Refuse any speed above this
    #[arg(long, value_name = "SPEED", default_value = "3000rpm")]
    pub limit: Quantity,
    /// Stop if the target is not reached in this time; a multiple of the reckoned time when left out
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub timeout: Option<Duration>,
    /// Check and show, but move nothing
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    pub mode: SetMode,
    #[command(flatten)]
    pub consent: Consent,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

pub fn run(args: &Move, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let order = order(args)?;
    let limit = axis::rpm(&args.limit, "--limit")?.abs();
    axis::within(order.speed, limit, SpeedUnit::Rpm)?;
    axis::checked(&args.cyclic)?;
    let need = if args.dry_run { Need::Records } else { Need::Cyclic };
    let (mut session, mut drive) = connect::drive(interface, need, &args.drive, output)?;
    drive.check_able(Some(Mode::Position))?;
    if !args.mode.set_mode {
        session.check_mode(&mut drive, Mode::Position).wait()?;
    }
    if args.dry_run {
        let plan = session.plan_move(&mut drive, &order, limit).wait()?;
        axis::report_controller_loss(&mut session, &mut drive, &args.consent, "move", output)?;
        session.close().wait()?;
        output.say(&format!(
            "dry run: {} {}; nothing moves",
            drive.label(),
            plan_text(&plan, &order)
        ));
        if output.json() {
            output.document("move", plan_json(&plan, &drive));
        }
        return permitted(&plan, &drive);
    }
    let go = |session: &mut Live, drive: &mut Drive| go(args, &order, limit, session, drive, output);
    axis::in_mode(&mut session, &mut drive, Mode::Position, &args.mode, output, go)?;
    Ok(session.close().wait()?)
}

fn go(
    args: &Move,
    order: &Order,
    limit: f64,
    session: &mut Live,
    drive: &mut Drive,
    output: &Output,
) -> Result<(), Failure> {
    const END: End = End::Target("the target was not reached");
    let plan = session.plan_move(drive, order, limit).wait()?;
    permitted(&plan, drive)?;
    axis::report_controller_loss(session, drive, &args.consent, "move", output)?;
    let settings = axis::settings(&args.cyclic, &args.consent, Purpose::Move, limit);
    let mut axis = session.take_axis(drive, settings).wait()?;
    output.say(&format!(
        "this moves the axis: {} {}, telegram {}; Ctrl-C stops it",
        drive.label(),
        plan_text(&plan, order),
        axis.telegram()
    ));
    axis::watch(&mut axis, "move", args.mode.set_mode, output);
    let mut place = None;
    let result = axis.enable().wait().and_then(|mut enabled| {
        // with what the telegram says now
        let plan = enabled.plan(order).wait()?;
        enabled.start(&plan).wait()?;
        let limit = args.timeout.unwrap_or_else(|| time_limit(&plan));
        let reached = enabled.reach_target(Some(limit)).wait();
        // where it was when ZSW1 bit 10 came, before anything else happens
        let status = reached.as_ref().ok().copied().or_else(|| enabled.status());
        place = status.and_then(|status| status.position);
        reached.map(|_| ())
    });
    // the release returns the result
    let _ = axis.stopped().wait();
    let now = axis.status().and_then(|status| status.position);
    let left = axis::left(place, now).filter(|_| result.is_ok());
    if let (Ok(()), Some(position)) = (&result, place) {
        output.say(&format!(
            "target reached (ZSW1 bit 10): {} rev ({:.0} counts)",
            number(axis::rounded(position)),
            (position * drive.counts_per_turn()).round() + 0.0
        ));
    }
    if let Some(now) = left {
        output.warn(&format!(
            "it has left the target since: it is at {} rev now",
            number(axis::rounded(now))
        ));
    }
    let more = fields! {
        "reached": result.is_ok(), "position": place, "left_to": left, "plan": plan_json(&plan, drive),
    };
    axis::finish(axis, result, END, "move", more, output)
        .map_err(|error| axis::explained(error, END, session, drive))
}

fn order(args: &Move) -> Result<Order, Failure> {
    let target = args
        .to
        .position()
        .map_err(|error| Failure::usage(format!("--to: {error}")))?;
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

fn permitted(plan: &MovePlan, drive: &Drive) -> Result<(), Failure> {
    if plan.objections.is_empty() {
        return Ok(());
    }
    Err(Error::Objections {
        drive: drive.label(),
        objections: plan.objections.clone(),
    }
    .into())
}

fn time_limit(plan: &MovePlan) -> Duration {
    plan.duration
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .map_or(LONGEST, |time| time * ALLOWANCE.0 + ALLOWANCE.1)
}

/// `goes from 1.2 rev to 10 rev (655360 counts) at 300 rpm, ramps 3052 and 3052 rpm/s, in about 2.1 s`
fn plan_text(plan: &MovePlan, order: &Order) -> String {
    let rev = |turns: Option<f64>| turns.map_or_else(|| "?".into(), |turns| number(axis::rounded(turns)));
    let way = if order.relative {
        format!(
            "goes from {} rev by {} counts to {} rev",
            rev(plan.from),
            plan.traverse.target,
            rev(plan.target)
        )
    } else {
        format!(
            "goes from {} rev to {} rev ({} counts)",
            rev(plan.from),
            rev(plan.target),
            plan.traverse.target
        )
    };
    let time = plan
        .duration
        .map_or_else(String::new, |seconds| format!(", in about {seconds:.1} s"));
    format!(
        "{way} at {} rpm, ramps {} and {} rpm/s{time}",
        number(axis::rounded(plan.speed)),
        number(plan.acceleration),
        number(plan.deceleration)
    )
}

fn plan_json(plan: &MovePlan, drive: &Drive) -> Map<String, Value> {
    let objections: Vec<Value> = plan
        .objections
        .iter()
        .map(|objection| objection.to_string().into())
        .collect();
    fields! {
        "drive": drive.label(), "from": plan.from, "target": plan.target, "speed": plan.speed,
        "acceleration": plan.acceleration, "deceleration": plan.deceleration, "duration": plan.duration,
        "satzanw": plan.traverse.satzanw, "mdi_tarpos": plan.traverse.target,
        "mdi_velocity": plan.traverse.velocity, "mdi_acc": plan.traverse.acceleration,
        "mdi_dec": plan.traverse.deceleration, "mdi_mod": plan.traverse.modus, "objections": objections,
    }
}
