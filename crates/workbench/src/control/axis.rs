//! One axis under control: the task that has it.

use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use profidrive::client::axis::{Move, Purpose};
use profidrive::client::{ErrorKind, Rest};
use profidrive::motion::{self, HeldAxis, Hold, MotionError, Observer};
use profidrive::profile::notation::{Position, figures};
use serde::Serialize;
use tokio::sync::{mpsc, watch};
use tokio::time::{MissedTickBehavior, interval, sleep};

use super::running::{Command, GIVEN_BACK, Order, Running, conflict, purpose_name};
use super::taking::Taking;
use super::{Control, LEASE};
use crate::access::Caller;
use crate::act::{self, Intent};
use crate::problem::Problem;
use crate::shared::Shared;

/// Time between two pictures of the axis.
pub(super) const PICTURE: Duration = Duration::from_millis(33);
/// Homing takes no longer.
const HOMING: Duration = Duration::from_secs(120);

#[derive(Serialize)]
struct Lease<'r> {
    r#type: &'static str,
    n: u64,
    drive: &'r str,
    lease: u64,
    purpose: &'static str,
}

/// Takes the axis, carries out its commands, and gives it back. Returns whether it is at rest, or was never taken.
pub(super) async fn hold(shared: &Arc<Shared>, taking: Taking) -> bool {
    let Taking {
        caller,
        running,
        hold: wanted,
        checks,
        queue,
        number,
        reply,
        ..
    } = taking;
    let intent = |action, value: Option<String>| Intent::of_drive(action, &running.drive, value);
    let taking = intent("take", Some(terms(&running, &wanted, checks)));
    let taken = async {
        act::begin(shared, &caller, &taking).await?;
        take(shared, &running, &wanted).await
    };
    let axis = match taken.await {
        Ok(axis) => axis,
        Err(problem) => {
            reply.refused(number, &problem);
            // the one who wanted it has the refusal; for other pages nothing has changed
            act::noted_quietly(shared, &caller, &taking, problem.message().to_owned()).await;
            return true;
        }
    };
    act::note(shared, &caller, &taking, "done".to_owned()).await;
    running.hold_by(&axis);
    let simulation = shared.source.is_simulation();
    shared.feeds.begin(&running.drive, axis.axis(), simulation);
    running.busy.store(false, Ordering::Relaxed);
    reply.send(&Lease {
        r#type: "lease",
        n: number,
        drive: &running.drive,
        lease: running.lease,
        purpose: purpose_name(running.purpose),
    });
    let axis = serve(shared, &caller, &running, axis, queue).await;
    running.phase("releasing");
    let released = axis.release().await;
    shared.feeds.end(&running.drive);
    let result = match released {
        Ok(_) => "done".to_owned(),
        // that STOP ended its last motion is no failure of the release
        Err(error) if error.kind() == ErrorKind::Interrupted => "done".to_owned(),
        Err(error) => Problem::of(&error).message().to_owned(),
    };
    act::note(shared, &caller, &intent("release", None), result).await;
    // whatever had ended its last motion
    running.stands.load(Ordering::Relaxed)
}

/// On which terms an axis is taken, for the log.
fn terms(running: &Running, wanted: &Hold, checks: bool) -> String {
    let (purpose, stop) = (purpose_name(running.purpose), running.stop_by.name());
    let mut terms = format!(
        "for {purpose}, STOP by {stop}, at most {} rpm",
        figures(wanted.limit)
    );
    if let Some(turns) = wanted.travel {
        terms += &format!(", travel {} rev", figures(turns));
    }
    if wanted.control.may_run_on {
        terms += ", may run on when its controller is lost";
    }
    if checks {
        terms += ", checks of the machine confirmed";
    }
    terms
}

async fn take(shared: &Shared, running: &Arc<Running>, wanted: &Hold) -> Result<HeldAxis, Problem> {
    let (mut network, mut drive) = crate::api::find(shared, &running.drive).await?;
    let shown = Arc::clone(running);
    let observer = Observer::new(move |event| match event {
        motion::Event::Sample(status) => shown.show(status),
        motion::Event::Ended(ended) => {
            shown
                .stands
                .store(ended.report.rest == Rest::Stands, Ordering::Relaxed);
        }
        _ => {}
    });
    let axis = motion::hold(&mut network, &mut drive, wanted, &observer).await;
    axis.map_err(|error| Problem::of(&error))
}

/// Carries out commands until its page is gone or gives it back.
async fn serve(
    shared: &Arc<Shared>,
    caller: &Caller,
    running: &Arc<Running>,
    mut axis: HeldAxis,
    mut queue: mpsc::Receiver<Command>,
) -> HeldAxis {
    let mut picture = interval(PICTURE);
    picture.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let mut ended = running.ended.subscribe();
    loop {
        tokio::select! {
            biased;
            () = raised(&mut ended) => break,
            Some(command) = queue.recv() => {
                running.busy.store(true, Ordering::Relaxed);
                let (number, reply) = (command.stamp.number, command.reply.clone());
                let done = carry_out(shared, caller, running, &mut axis, &command).await;
                running.busy.store(false, Ordering::Relaxed);
                match done {
                    Ok(()) => reply.accepted(number),
                    Err(problem) => reply.refused(number, &problem),
                }
            }
            _ = picture.tick() => {}
        }
        match axis.status() {
            Some(status) if !status.lost => running.show(&status),
            // there is nothing left to control
            _ => break,
        }
        if running.unbeaten() > LEASE {
            shared.control.let_go(running);
        }
    }
    queue.close();
    while let Ok(Command { stamp, reply, .. }) = queue.try_recv() {
        reply.refused(stamp.number, &conflict(GIVEN_BACK));
    }
    axis
}

async fn raised(flag: &mut watch::Receiver<bool>) {
    // fails only when the sender is gone, which is a part of the axis
    let _ = flag.wait_for(|flag| *flag).await;
}

/// Carries out one command, after its intent is in the log.
async fn carry_out(
    shared: &Arc<Shared>,
    caller: &Caller,
    running: &Running,
    axis: &mut HeldAxis,
    command: &Command,
) -> Result<(), Problem> {
    let order = command.order;
    let intent = Intent::of_drive(order.action(), &running.drive, order.value());
    act::begin(shared, caller, &intent).await?;
    let result = {
        let mut work = pin!(turn(&shared.control, running, axis, command));
        tokio::select! {
            result = &mut work => result,
            // a call that waits renews the lease: that of a page that is gone must end
            () = abandoned(running) => {
                shared.control.let_go(running);
                work.await
            }
        }
    };
    let text = match &result {
        Ok(()) => "done".to_owned(),
        Err(problem) => problem.message().to_owned(),
    };
    act::noted_quietly(shared, caller, &intent, text).await;
    result
}

/// Waits until no beat has come for as long as control lasts without one.
async fn abandoned(running: &Running) {
    while running.unbeaten() <= LEASE {
        sleep(PICTURE).await;
    }
}

/// Lets a command have its turn, unless something has ended it while it waited.
pub(super) async fn turn(
    control: &Control,
    running: &Running,
    axis: &mut HeldAxis,
    command: &Command,
) -> Result<(), Problem> {
    let Command { order, stamp, .. } = command;
    let is_current = || control.ledger().is_current(&running.drive, *stamp);
    let off = matches!(order, Order::Disable | Order::Acknowledge);
    let permitted = || match () {
        () if off => Ok(()),
        () if !is_current() => Err(conflict("STOP was pressed before this had its turn")),
        () if running.is_ending() => Err(conflict(GIVEN_BACK)),
        () => Ok(()),
    };
    permitted()?;
    if order.kept().is_some() && !running.is_kept(stamp.number) {
        return Err(conflict("it was ended before it had its turn: nothing was moved"));
    }
    let result = perform(axis, *order, running.purpose, &permitted).await;
    // a STOP that came while this was sent must not be overtaken by it, nor must the end of control
    if !off && !is_current() {
        running.stop();
    } else if !off && running.is_ending() {
        running.end();
    }
    result
}

/// Lets the library carry out a command, with all its rules. `permitted`: nothing has ended it while it waited.
async fn perform(
    axis: &mut HeldAxis,
    order: Order,
    purpose: Purpose,
    permitted: &(dyn Fn() -> Result<(), Problem> + Sync),
) -> Result<(), Problem> {
    let done: Result<(), MotionError> = match order {
        Order::Enable => {
            // what ended the last operation is known by now: nothing is enabled from a stop under way, whoever began it
            axis.stop().await.map_err(|error| Problem::of(&error))?;
            permitted()?;
            axis.enable().await
        }
        Order::Disable => axis.stop().await.map_err(MotionError::from),
        Order::Acknowledge => axis.acknowledge().await.map_err(MotionError::from),
        Order::Jog(speed) | Order::Velocity(speed) => match purpose {
            Purpose::Move => axis.jog_at(speed).await,
            _ => axis.run(speed).await,
        },
        Order::Move {
            turns,
            relative,
            speed,
        } => {
            let order = Move {
                relative,
                ..Move::to(Position::Turns(turns), speed)
            };
            axis.start(&order).await.map(|_| ())
        }
        Order::Home => axis.home(HOMING).await,
        Order::Task(number) => axis.start_task(number).await,
    };
    done.map_err(|error| Problem::of(&error))
}
