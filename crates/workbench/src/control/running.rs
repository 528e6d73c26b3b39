//! What an axis under control is to do, and what reaches it beside its queue. Knows nothing of the server.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use profidrive::client::axis::{Progress, Purpose};
use profidrive::client::{AxisStatus, BeatHandle, StopHandle};
use profidrive::motion::HeldAxis;
use profidrive::profile::notation::figures;
use profidrive::report::Action;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tokio::sync::{mpsc, watch};

use super::ledger::{Holder, Stamp, Wanted};
use super::stopping::Posted;
use super::{HOLD, LEASE};
use crate::problem::Problem;

/// Commands that wait for their turn.
pub(super) const QUEUE: usize = 8;

/// Why a command of a page is not carried out any more.
pub(super) const GIVEN_BACK: &str = "the drive is given back: nothing more is enabled or moved";

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
    pub(super) const fn action(self) -> &'static str {
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

    pub(super) fn value(self) -> Option<String> {
        Some(match self {
            Self::Jog(speed) | Self::Velocity(speed) => format!("{} rpm", figures(speed)),
            Self::Move {
                turns,
                relative,
                speed,
            } => format!(
                "{} {} rev at {} rpm",
                if relative { "by" } else { "to" },
                figures(turns),
                figures(speed)
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

/// How STOP stops an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StopBy {
    /// By its quick stop.
    #[default]
    Off3,
    /// Along its ramp, for loads that a quick stop would damage. The engine changes to the quick stop where the ramp takes too long.
    Off1,
    /// With its power stage off at once, for axes that a brake has to catch or that must not be driven any more: it coasts.
    Off2,
}

impl StopBy {
    /// Its name in the log.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Off3 => "OFF3",
            Self::Off1 => "OFF1",
            Self::Off2 => "OFF2",
        }
    }
}

/// A command, and where its answer goes.
#[derive(Debug)]
pub(super) struct Command {
    pub order: Order,
    pub stamp: Stamp,
    pub reply: Reply,
}

/// What is on its way out of one socket.
#[derive(Debug)]
pub(super) enum Out {
    Text(String),
    /// The last one: why this side closes the socket.
    Close(Closing),
}

/// Why a socket is closed by this side: its code and its reason.
pub(super) type Closing = (u16, &'static str);

/// Where answers of one socket go. A socket that takes no more is closed by its own task.
#[derive(Debug, Clone)]
pub(super) struct Reply(pub mpsc::Sender<Out>);

#[derive(Serialize)]
struct Accepted {
    r#type: &'static str,
    n: u64,
}

#[derive(Serialize)]
struct Refused<'r> {
    r#type: &'static str,
    n: u64,
    /// As in problems of requests: `refused`, `safety`, `fault`, ..
    kind: &'static str,
    sentence: &'r str,
    hint: Option<&'r str>,
    /// What to do next.
    actions: &'r [Action],
}

impl Reply {
    pub fn send(&self, message: &impl Serialize) {
        // a full queue: the socket ends by itself
        let text = serde_json::to_string(message).unwrap_or_default();
        let _ = self.0.try_send(Out::Text(text));
    }

    /// Closes the socket behind what is on its way.
    pub fn close(&self, closing: Closing) {
        let _ = self.0.try_send(Out::Close(closing));
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
            kind: error.kind,
            sentence: &error.message,
            hint: error.hint.as_deref(),
            actions: &error.actions,
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
    /// What that one is called by its own words, which nothing verifies.
    claimed_name: Option<String>,
    /// Who waits for it.
    wanted: Option<Wanted>,
    /// Whether it has moved since its page has it.
    moved: bool,
    /// Whether its direction was confirmed.
    confirmed: bool,
    purpose: &'static str,
    stop_by: StopBy,
    /// `taking`, `off`, `enabled`, `moving`, `stopping` or `releasing`.
    phase: &'static str,
    /// Whether a command is carried out.
    busy: bool,
    /// The control word as it is sent; nothing before the first valid input.
    stw1: Option<u16>,
    /// The status word as it came.
    zsw1: Option<u16>,
    speed: Option<f64>,
    speed_set: Option<f64>,
    unit: &'static str,
    /// In turns.
    position: Option<f64>,
    /// Whether the target of a move is reached.
    reached: bool,
    homed: Option<bool>,
    /// Whether it was halted at the end of its travel.
    travel_ended: bool,
    /// Why it stopped by itself.
    trouble: Option<Failing>,
    /// Whether the connection is lost: all of this is what the drive reported last.
    lost: bool,
}

/// Why an axis stopped by itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Failing {
    /// Its stable name: `stopped` for a STOP.
    kind: &'static str,
    /// In words.
    text: String,
}

/// The motion that is kept going.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Motion {
    /// The number of its command.
    number: u64,
    kept: Kept,
}

/// An axis that a page has, from the wish to take it until it is given back.
#[derive(Debug)]
pub(super) struct Running {
    pub drive: String,
    pub lease: u64,
    holder: Holder,
    pub(super) purpose: Purpose,
    pub(super) stop_by: StopBy,
    orders: mpsc::Sender<Command>,
    /// Once the axis is taken.
    handles: OnceLock<(StopHandle, BeatHandle)>,
    motion: Mutex<Option<Motion>>,
    /// When a fresh beat came last.
    beaten: Mutex<Instant>,
    /// Its page is gone, or gives it back.
    pub(super) ended: watch::Sender<bool>,
    pub(super) busy: AtomicBool,
    /// It stood when it was given back, as far as the drive reports.
    pub(super) stands: AtomicBool,
    picture: Mutex<Picture>,
}

impl Running {
    pub fn new(
        drive: &str,
        lease: u64,
        holder: Holder,
        purpose: Purpose,
        stop_by: StopBy,
    ) -> (Arc<Self>, mpsc::Receiver<Command>) {
        let (orders, queue) = mpsc::channel(QUEUE);
        let running = Self {
            drive: drive.to_owned(),
            lease,
            purpose,
            stop_by,
            orders,
            handles: OnceLock::new(),
            motion: Mutex::new(None),
            beaten: Mutex::new(Instant::now()),
            ended: watch::Sender::new(false),
            busy: AtomicBool::new(true),
            stands: AtomicBool::new(false),
            picture: Mutex::new(Picture {
                drive: drive.to_owned(),
                lease,
                holder: holder.who.clone(),
                claimed_name: holder.claimed_name.clone(),
                purpose: purpose_name(purpose),
                stop_by,
                phase: "taking",
                busy: true,
                ..Picture::default()
            }),
            holder,
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

    /// Returns whether it has moved since its page has it.
    pub fn has_moved(&self) -> bool {
        self.picture.lock().unwrap_or_else(PoisonError::into_inner).moved
    }

    /// Returns how it is, with who waits for it and whether its direction was confirmed.
    pub fn picture(&self, wanted: Option<Wanted>, confirmed: bool) -> Picture {
        let picture = self.picture.lock().unwrap_or_else(PoisonError::into_inner);
        Picture {
            wanted,
            confirmed,
            busy: self.busy.load(Ordering::Relaxed),
            ..picture.clone()
        }
    }

    /// Stops it by STOP.
    pub fn stop(&self) -> Posted {
        *self.motion() = None;
        let Some((stop, beat)) = self.handles.get() else {
            return Posted::Untaken;
        };
        beat.end();
        let stops = match self.stop_by {
            StopBy::Off3 => stop.quick_stop(),
            StopBy::Off1 => stop.stop(),
            StopBy::Off2 => stop.coast(),
        };
        Posted::To(stops.then_some(self.stop_by), stop.clone())
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
        if command.order == Order::Disable {
            // it does not wait for the motion that is under way, and nothing that waits moves after it
            self.ramp();
        }
        if let Some(kept) = kept {
            self.keep(number, kept);
        }
        if self.orders.try_send(command).is_err() {
            if kept.is_some() {
                self.halt();
            }
            let why = match self.is_ending() {
                true => GIVEN_BACK,
                false => "too many commands wait for this drive",
            };
            reply.refused(number, &conflict(why));
        }
    }

    /// Ramps it down, out of operation.
    fn ramp(&self) {
        *self.motion() = None;
        if let Some((stop, beat)) = self.handles.get() {
            beat.end();
            stop.stop();
        }
    }

    /// Ends it: the axis is ramped down and given back.
    pub fn end(&self) {
        self.ramp();
        self.ended.send_replace(true);
    }

    /// Returns whether it is given back.
    pub(super) fn is_ending(&self) -> bool {
        *self.ended.borrow()
    }

    pub(super) fn is_kept(&self, number: u64) -> bool {
        self.motion().is_some_and(|motion| motion.number == number)
    }

    pub(super) fn unbeaten(&self) -> Duration {
        self.beaten
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .elapsed()
    }

    pub(super) fn show(&self, status: &AxisStatus) {
        let view = &status.view;
        let phase = match () {
            () if view.goal.moves() => "moving",
            () if view.goal.operates() => "enabled",
            () if view.at_rest => "off",
            () => "stopping",
        };
        let trouble = match view.progress {
            Progress::Failed(trouble) => Some(Failing {
                kind: trouble.id(),
                text: trouble.to_string(),
            }),
            Progress::Pursuing | Progress::Reached => None,
        };
        let mut picture = self.picture.lock().unwrap_or_else(PoisonError::into_inner);
        *picture = Picture {
            drive: self.drive.clone(),
            lease: self.lease,
            holder: self.holder.who.clone(),
            claimed_name: self.holder.claimed_name.clone(),
            wanted: None,
            moved: picture.moved || phase == "moving",
            confirmed: false,
            purpose: purpose_name(self.purpose),
            stop_by: self.stop_by,
            phase,
            busy: false,
            stw1: view.seen.map(|_| view.sent),
            zsw1: view.seen.map(|seen| seen.word),
            speed: status.speed_actual,
            speed_set: status.speed_set,
            unit: status.unit.symbol(),
            position: status.position,
            reached: view.progress == Progress::Reached,
            homed: (self.purpose == Purpose::Move)
                .then(|| view.seen.map(|seen| seen.homed()))
                .flatten(),
            travel_ended: view.travel_ended,
            trouble,
            lost: status.lost,
        };
    }

    pub(super) fn phase(&self, phase: &'static str) {
        self.picture.lock().unwrap_or_else(PoisonError::into_inner).phase = phase;
    }
}

pub(super) const fn purpose_name(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Move => "position",
        _ => "speed",
    }
}

pub(super) fn conflict(detail: &str) -> Problem {
    Problem::new(axum::http::StatusCode::CONFLICT, "refused", detail)
}
