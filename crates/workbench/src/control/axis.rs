//! One axis under control: the task that has it, and what reaches it beside its queue.

use std::pin::pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use profidrive::client::axis::{Move, Progress, Purpose};
use profidrive::client::{AxisStatus, BeatHandle, StopHandle};
use profidrive::motion::{self, HeldAxis, Hold, MotionError, Observer};
use profidrive::profile::notation::Position;
use serde::Serialize;
use tokio::sync::{mpsc, watch};
use tokio::time::{MissedTickBehavior, interval, sleep};

use super::ledger::Stamp;
use super::{Control, HOLD, LEASE};
use crate::access::Caller;
use crate::act::{self, Intent};
use crate::problem::Problem;
use crate::shared::Shared;

/// Commands that wait for their turn.
pub(super) const QUEUE: usize = 8;
/// Time between two pictures of the axis.
const PICTURE: Duration = Duration::from_millis(33);
/// Homing takes no longer.
const HOMING: Duration = Duration::from_secs(120);

/// What an axis is to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Order {
    Enable,
    Disable,
    Acknowledge,
    /// At this speed in rpm, while a button is held.
    Jog(f64),
    /// At this speed in rpm, until something else is requested.
    Velocity(f64),
    /// To a position or by a distance in turns, at a speed in rpm.
    Move {
        turns: f64,
        relative: bool,
        speed: f64,
    },
    /// The homing procedure of the drive.
    Home,
    /// A motion task of the drive.
    Task(u16),
}

impl Order {
    /// Its name in the log.
    const fn action(self) -> &'static str {
        match self {
            Self::Enable => "enable",
            Self::Disable => "disable",
            Self::Acknowledge => "acknowledge",
            Self::Jog(_) => "jog",
            Self::Velocity(_) => "velocity",
            Self::Move { .. } => "move",
            Self::Home => "home",
            Self::Task(_) => "task",
        }
    }

    fn value(self) -> Option<String> {
        Some(match self {
            Self::Jog(speed) | Self::Velocity(speed) => format!("{speed} rpm"),
            Self::Move {
                turns,
                relative,
                speed,
            } => format!(
                "{} {turns} rev at {speed} rpm",
                if relative { "by" } else { "to" }
            ),
            Self::Task(number) => number.to_string(),
            Self::Enable | Self::Disable | Self::Acknowledge | Self::Home => return None,
        })
    }

    /// How it is kept going; nothing where nothing moves by it.
    pub(super) const fn kept(self) -> Option<Kept> {
        match self {
            Self::Jog(_) => Some(Kept::ByButton),
            Self::Velocity(_) | Self::Move { .. } | Self::Home | Self::Task(_) => Some(Kept::ByPage),
            Self::Enable | Self::Disable | Self::Acknowledge => None,
        }
    }
}

/// What keeps a motion going.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    /// A button that is held.
    ByButton,
    /// The page, as long as it is there.
    ByPage,
}

/// A command, and where its answer goes.
#[derive(Debug)]
pub(super) struct Command {
    pub order: Order,
    pub stamp: Stamp,
    pub reply: Reply,
}

/// Where answers of one socket go. A socket that takes no more is closed by its own task.
#[derive(Debug, Clone)]
pub(super) struct Reply(pub mpsc::Sender<String>);

#[derive(Serialize)]
struct Accepted {
    r#type: &'static str,
    n: u64,
}

#[derive(Serialize)]
struct Refused<'r> {
    r#type: &'static str,
    n: u64,
    sentence: &'r str,
    hint: Option<&'r str>,
}

#[derive(Serialize)]
struct Lease<'r> {
    r#type: &'static str,
    n: u64,
    drive: &'r str,
    lease: u64,
    purpose: &'static str,
}

impl Reply {
    pub fn send(&self, message: &impl Serialize) {
        // a full queue: the socket ends by itself
        let _ = self
            .0
            .try_send(serde_json::to_string(message).unwrap_or_default());
    }

    pub fn accepted(&self, n: u64) {
        self.send(&Accepted {
            r#type: "accepted",
            n,
        });
    }

    pub fn refused(&self, n: u64, problem: &Problem) {
        let error = problem.error();
        self.send(&Refused {
            r#type: "refused",
            n,
            sentence: &error.message,
            hint: error.hint.as_deref(),
        });
    }
}

/// How an axis is.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(super) struct Picture {
    /// The drive, as it is called in paths.
    drive: String,
    lease: u64,
    /// Who has it, as in the log.
    holder: String,
    purpose: &'static str,
    /// `taking`, `off`, `enabled`, `moving`, `stopping` or `releasing`.
    phase: &'static str,
    /// Whether a command is carried out.
    busy: bool,
    speed: Option<f64>,
    speed_set: Option<f64>,
    unit: &'static str,
    /// In turns.
    position: Option<f64>,
    /// Whether the target of a move is reached.
    reached: bool,
    homed: Option<bool>,
    /// Why it stopped by itself.
    trouble: Option<String>,
    /// Whether the connection is lost: all of this is what the drive reported last.
    lost: bool,
}

/// The motion that is kept going.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Motion {
    /// The number of its command.
    number: u64,
    kept: Kept,
}

/// An axis that somebody has, from the wish to take it until it is given back.
#[derive(Debug)]
pub(super) struct Running {
    pub drive: String,
    pub lease: u64,
    holder: String,
    purpose: Purpose,
    orders: mpsc::Sender<Command>,
    /// Once the axis is taken.
    handles: OnceLock<(StopHandle, BeatHandle)>,
    motion: Mutex<Option<Motion>>,
    /// When a fresh beat came last.
    beaten: Mutex<Instant>,
    /// Its page is gone, or gives it back.
    ended: watch::Sender<bool>,
    busy: AtomicBool,
    picture: Mutex<Picture>,
}

impl Running {
    pub fn new(
        drive: &str,
        lease: u64,
        holder: &str,
        purpose: Purpose,
    ) -> (Arc<Self>, mpsc::Receiver<Command>) {
        let (orders, queue) = mpsc::channel(QUEUE);
        let running = Self {
            drive: drive.to_owned(),
            lease,
            holder: holder.to_owned(),
            purpose,
            orders,
            handles: OnceLock::new(),
            motion: Mutex::new(None),
            beaten: Mutex::new(Instant::now()),
            ended: watch::Sender::new(false),
            busy: AtomicBool::new(true),
            picture: Mutex::new(Picture {
                drive: drive.to_owned(),
                lease,
                holder: holder.to_owned(),
                purpose: purpose_name(purpose),
                phase: "taking",
                busy: true,
                ..Picture::default()
            }),
        };
        (Arc::new(running), queue)
    }

    /// Notes that the axis is taken. From now on nothing moves without beats.
    pub fn hold_by(&self, axis: &HeldAxis) {
        let (stop, beat) = (axis.stop_handle(), axis.beat_handle());
        beat.beat(Duration::ZERO);
        // it is taken once
        let _ = self.handles.set((stop, beat));
    }

    fn motion(&self) -> MutexGuard<'_, Option<Motion>> {
        self.motion.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns how it is.
    pub fn picture(&self) -> Picture {
        let picture = self.picture.lock().unwrap_or_else(PoisonError::into_inner);
        Picture {
            busy: self.busy.load(Ordering::Relaxed),
            ..picture.clone()
        }
    }

    /// Stops it by its quick stop.
    pub fn stop(&self) {
        *self.motion() = None;
        if let Some((stop, beat)) = self.handles.get() {
            beat.end();
            stop.quick_stop();
        }
    }

    /// Halts the motion along its ramp; the axis stays enabled.
    pub fn halt(&self) {
        *self.motion() = None;
        if let Some((_, beat)) = self.handles.get() {
            beat.end();
        }
    }

    /// Takes a fresh beat of its page. `held` is the number of the command whose button is held.
    pub fn beat(&self, held: Option<u64>) {
        *self.beaten.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
        let Some((_, beat)) = self.handles.get() else {
            return;
        };
        let mut motion = self.motion();
        match *motion {
            Some(Motion {
                number,
                kept: Kept::ByButton,
            }) if held != Some(number) => {
                // the button is up: the end is not waited for
                *motion = None;
                beat.beat(Duration::ZERO);
                beat.end();
            }
            Some(Motion {
                kept: Kept::ByButton, ..
            }) => beat.beat(HOLD),
            Some(Motion {
                kept: Kept::ByPage, ..
            }) => beat.beat(LEASE),
            // the lease goes on, and nothing may move: a command that comes late to its turn begins no motion
            None => beat.beat(Duration::ZERO),
        }
    }

    /// Begins to keep a motion going, before its command has its turn.
    fn keep(&self, number: u64, kept: Kept) {
        let mut motion = self.motion();
        *motion = Some(Motion { number, kept });
        if let Some((_, beat)) = self.handles.get() {
            beat.beat(match kept {
                Kept::ByButton => HOLD,
                Kept::ByPage => LEASE,
            });
        }
    }

    /// Hands a command to the task of the axis.
    pub fn order(&self, command: Command) {
        let (number, reply) = (command.stamp.number, command.reply.clone());
        let kept = command.order.kept();
        if let Some(kept) = kept {
            self.keep(number, kept);
        }
        if self.orders.try_send(command).is_err() {
            if kept.is_some() {
                self.halt();
            }
            reply.refused(number, &conflict("too many commands wait for this drive"));
        }
    }

    /// Ends it: the axis is ramped down and given back.
    pub fn end(&self) {
        *self.motion() = None;
        if let Some((stop, beat)) = self.handles.get() {
            beat.end();
            stop.stop();
        }
        self.ended.send_replace(true);
    }

    fn is_kept(&self, number: u64) -> bool {
        self.motion().is_some_and(|motion| motion.number == number)
    }

    fn unbeaten(&self) -> Duration {
        self.beaten
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .elapsed()
    }

    fn show(&self, status: &AxisStatus) {
        let view = &status.view;
        let phase = match () {
            () if view.goal.moves() => "moving",
            () if view.goal.operates() => "enabled",
            () if view.at_rest => "off",
            () => "stopping",
        };
        let trouble = match view.progress {
            Progress::Failed(trouble) => Some(trouble.to_string()),
            Progress::Pursuing | Progress::Reached => None,
        };
        let mut picture = self.picture.lock().unwrap_or_else(PoisonError::into_inner);
        *picture = Picture {
            drive: self.drive.clone(),
            lease: self.lease,
            holder: self.holder.clone(),
            purpose: purpose_name(self.purpose),
            phase,
            busy: false,
            speed: status.speed_actual,
            speed_set: status.speed_set,
            unit: status.unit.symbol(),
            position: status.position,
            reached: view.progress == Progress::Reached,
            homed: (self.purpose == Purpose::Move)
                .then(|| view.seen.map(|seen| seen.homed()))
                .flatten(),
            trouble,
            lost: status.lost,
        };
    }

    fn phase(&self, phase: &'static str) {
        self.picture.lock().unwrap_or_else(PoisonError::into_inner).phase = phase;
    }
}

const fn purpose_name(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Move => "position",
        _ => "speed",
    }
}

pub(super) fn conflict(detail: &str) -> Problem {
    Problem::new(axum::http::StatusCode::CONFLICT, "refused", detail)
}

/// Takes the axis, carries out its commands, and gives it back.
pub(super) async fn attend(
    shared: Arc<Shared>,
    caller: Caller,
    running: Arc<Running>,
    wanted: Hold,
    queue: mpsc::Receiver<Command>,
    (number, reply): (u64, Reply),
) {
    let (at, of) = (Arc::clone(&shared), Arc::clone(&running));
    // a panic was printed; the axis was dropped, and is ramped down and given back
    let attended = tokio::spawn(async move { hold(&at, &caller, &of, &wanted, queue, number, &reply).await });
    let _ = attended.await;
    shared.control.axes().remove(&running.drive);
    shared.control.ledger().give_back(&running.drive, running.lease);
}

async fn hold(
    shared: &Arc<Shared>,
    caller: &Caller,
    running: &Arc<Running>,
    wanted: &Hold,
    queue: mpsc::Receiver<Command>,
    number: u64,
    reply: &Reply,
) {
    let intent = |action, value: Option<String>| Intent {
        action,
        drive: Some(running.drive.clone()),
        value,
        changes: Vec::new(),
    };
    let taking = intent("take", Some(format!("for {}", purpose_name(running.purpose))));
    let taken = async {
        act::begin(shared, caller, &taking).await?;
        take(shared, running, wanted).await
    };
    let axis = match taken.await {
        Ok(axis) => axis,
        Err(problem) => {
            reply.refused(number, &problem);
            // who wanted it was told; for other pages nothing has changed
            act::noted_quietly(shared, caller, &taking, problem.message().to_owned()).await;
            return;
        }
    };
    act::note(shared, caller, &taking, "done".to_owned()).await;
    running.hold_by(&axis);
    running.busy.store(false, Ordering::Relaxed);
    reply.send(&Lease {
        r#type: "lease",
        n: number,
        drive: &running.drive,
        lease: running.lease,
        purpose: purpose_name(running.purpose),
    });
    let axis = serve(shared, caller, running, axis, queue).await;
    running.phase("releasing");
    let released = axis.release().await;
    let result = match released {
        Ok(_) => "done".to_owned(),
        Err(error) => Problem::of(&error).message().to_owned(),
    };
    act::note(shared, caller, &intent("release", None), result).await;
}

async fn take(shared: &Shared, running: &Arc<Running>, wanted: &Hold) -> Result<HeldAxis, Problem> {
    let (mut network, mut drive) = crate::api::find(shared, &running.drive).await?;
    let shown = Arc::clone(running);
    let observer = Observer::new(move |event| {
        if let motion::Event::Sample(status) = event {
            shown.show(status);
        }
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
            () = raised(&mut ended) => return axis,
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
            _ => return axis,
        }
        if running.unbeaten() > LEASE {
            running.end();
        }
    }
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
    let intent = Intent {
        action: order.action(),
        drive: Some(running.drive.clone()),
        value: order.value(),
        changes: Vec::new(),
    };
    act::begin(shared, caller, &intent).await?;
    let result = {
        let mut work = pin!(turn(&shared.control, running, axis, command));
        tokio::select! {
            result = &mut work => result,
            // a call that waits renews the lease: that of a page that is gone must end
            () = abandoned(running) => {
                running.end();
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
    if !off && !is_current() {
        return Err(conflict("STOP was pressed before this had its turn"));
    }
    if order.kept().is_some() && !running.is_kept(stamp.number) {
        return Err(conflict("it was ended before it had its turn: nothing was moved"));
    }
    let result = perform(axis, *order, running.purpose).await;
    // a STOP that came while this was sent must not be overtaken by it
    if !off && !is_current() {
        running.stop();
    }
    result
}

/// Lets the library carry out a command, with all its rules.
async fn perform(axis: &mut HeldAxis, order: Order, purpose: Purpose) -> Result<(), Problem> {
    let done: Result<(), MotionError> = match order {
        Order::Enable => {
            // what ended the last operation is known by now: nothing is enabled from a stop under way
            match axis.stop().await {
                Ok(()) => axis.enable().await.map_err(MotionError::from),
                Err(error) => Err(error.into()),
            }
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
