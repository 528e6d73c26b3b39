//! The end of an axis: it is brought to rest and given back, whatever became of the one who had it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use profile::value::Reading;

use super::{Axis, AxisStatus, Released, Rest};
use crate::axis::{Goal, Progress, Seen, SpeedScale, StopKind, Trouble};
use crate::client::AxisView;
use crate::engine::{At, at};
use crate::session::{Session, takeover};
use crate::{Connection, Drive, Error, Link, LossReaction};

/// Time for which a silent drive on a line still receives the stop.
const CALL_AGAIN: Duration = Duration::from_secs(2);
/// How long the first valid data of a drive is waited for.
const FIRST_DATA: Duration = Duration::from_secs(1);
/// How long a connection that is to be released stays open for an answer under way.
const LAST_ANSWER: Duration = Duration::from_secs(5);
/// The longest ramp that is waited for.
const LONGEST_RAMP: Duration = Duration::from_secs(600);

/// State shared by an axis and the task that ends it.
#[derive(Debug)]
pub(in crate::session) struct Ending {
    reported: AtomicBool,
    done: AtomicBool,
    open: Mutex<Open>,
}

#[derive(Debug)]
struct Open {
    /// Highest speed requested since the axis was taken.
    fastest: f64,
    /// How much longer than the ramp of the drive stopping may take.
    stop: Duration,
    /// The trouble that was returned to the owner since its last command.
    returned: Option<Trouble>,
    result: Option<Released>,
}

impl Ending {
    pub(super) fn new(stop: Duration) -> Arc<Self> {
        Arc::new(Self {
            reported: AtomicBool::new(false),
            done: AtomicBool::new(false),
            open: Mutex::new(Open {
                fastest: 0.0,
                stop,
                returned: None,
                result: None,
            }),
        })
    }

    fn open(&self) -> MutexGuard<'_, Open> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(in crate::session) fn note_speed(&self, speed: f64) {
        let mut open = self.open();
        open.fastest = open.fastest.max(speed);
    }

    pub(in crate::session) fn allow(&self, stop: Duration) {
        self.open().stop = stop;
    }

    pub(super) fn note_returned(&self, trouble: Option<Trouble>) {
        self.open().returned = trouble;
    }

    pub(super) fn take_result(&self) -> Option<Released> {
        self.open().result.take()
    }

    pub(super) fn report(&self) {
        self.reported.store(true, Ordering::Release);
    }

    pub(super) fn is_reported(&self) -> bool {
        self.reported.load(Ordering::Acquire)
    }

    /// How long a ramp stop from this speed may take, where the speed is not known from the fastest one requested.
    pub(in crate::session) fn stop_limit(&self, speed: Option<f64>, deceleration: Option<f64>) -> Duration {
        let open = self.open();
        let speed = speed.map_or(open.fastest, f64::abs);
        let ramp = deceleration
            .and_then(|ramp| Duration::try_from_secs_f64(speed / ramp).ok())
            .map_or(Duration::ZERO, |time| time.min(LONGEST_RAMP));
        open.stop + ramp
    }
}

/// An axis that was taken, for callers that use its drive after it.
#[derive(Debug)]
pub(in crate::session) struct Place {
    at: At,
    link: Link,
    ending: Weak<Ending>,
}

impl Place {
    pub(super) fn new(drive: &Drive, link: Link, ending: &Arc<Ending>) -> Self {
        Self {
            at: at(drive),
            link,
            ending: Arc::downgrade(ending),
        }
    }

    pub(in crate::session) fn is_of(&self, drive: &Drive) -> bool {
        self.at == at(drive)
    }

    /// Its connection, as long as its owner has it.
    pub(in crate::session) fn held(&self) -> Option<Link> {
        let ending = self.ending.upgrade()?;
        (!ending.is_reported()).then_some(self.link)
    }

    /// It is on the way to its rest.
    pub(in crate::session) fn is_ending(&self) -> bool {
        let ending = self.ending.upgrade();
        ending.is_some_and(|ending| ending.is_reported() && !ending.done.load(Ordering::Acquire))
    }

    /// It is at rest and its connection is closed, or cannot be reached any more.
    pub(in crate::session) fn is_done(&self) -> bool {
        let ending = self.ending.upgrade();
        ending.is_none_or(|ending| ending.done.load(Ordering::Acquire))
    }

    pub(in crate::session) fn is_over(&self) -> bool {
        self.ending.strong_count() == 0
    }
}

/// Ends an axis on request of its owner or when the network is left.
pub(super) struct Closer {
    pub session: Session,
    pub drive: Drive,
    pub link: Link,
    pub cycle: Duration,
    pub scale: SpeedScale,
    pub deceleration: Option<f64>,
    pub kept: Vec<Reading>,
    pub loss: Box<LossReaction>,
    pub ending: Arc<Ending>,
    /// A quick stop that was not requested ended what should have been a ramp stop.
    pub quick: bool,
    /// A caller has made the ramp a quick stop.
    pub hurried: bool,
}

impl Closer {
    /// Waits for the end and sees to it.
    pub(super) async fn attend(mut self) {
        let _meanwhile = self.session.unstoppable();
        let engine = self.session.engine().clone();
        // what the wire does meanwhile is reported to the owner
        let ends = || self.ending.is_reported() || engine.is_closing();
        if !engine.until(ends).await {
            return;
        }
        let result = self.shut_down().await;
        self.ending.open().result = Some(result);
        self.ending.done.store(true, Ordering::Release);
    }

    async fn shut_down(&mut self) -> Released {
        // where the network is left, the owner may still be at work in another thread
        self.ending.report();
        self.session.client().only_stop(self.link);
        if self.session.connection(self.link) == Connection::Silent {
            self.call_again().await;
        }
        let connection = self.session.connection(self.link);
        let running = connection == Connection::Running;
        let (rest, stopped) = match self.lost(connection) {
            // standstill was not seen, so this is not the end of a stop
            Some(error) => (Rest::Unknown, Err(error)),
            None if running => {
                let stopped = self.bring_to_rest().await;
                (self.rest(), stopped)
            }
            None => (Rest::Unknown, Ok(())),
        };
        let released = {
            // a request of another caller on this connection gets its answer first
            let engine = self.session.engine().clone();
            let due = engine.now() + LAST_ANSWER;
            let _turn = engine.turn_at(&self.drive, true, Some(due)).await;
            self.session.release(self.link).await
        };
        let closed = released.is_ok();
        let mut result = stopped.and(released);
        if running && result.is_ok() {
            result = self.session.put_values_back(&mut self.drive, &self.kept).await;
        }
        Released {
            rest,
            closed,
            hurried: self.hurried,
            result,
        }
    }

    /// How the axis is by the last data of its drive. The power stage is off by now, so a pulling load is visible. An axis
    /// that this client never enabled was already coasting.
    fn rest(&self) -> Rest {
        match self.view() {
            None => Rest::Unknown,
            Some(view) if !view.turns => Rest::Stands,
            Some(view) if view.seen.is_some_and(Seen::pulses_off) => Rest::Coasts,
            Some(_) => Rest::Runs,
        }
    }

    /// A silent drive on a line may still receive, and may run on without a time-out. It is sent the stop for a while,
    /// and stopped properly once it answers.
    async fn call_again(&mut self) {
        self.pursue(Goal::Stop);
        let end = self.session.now() + CALL_AGAIN;
        while self.session.now() < end && self.session.connection(self.link) == Connection::Silent {
            if self.session.step(end).await.is_err() {
                return;
            }
        }
    }

    async fn bring_to_rest(&mut self) -> Result<(), Error> {
        let control_taken = self.view().is_some_and(|view| view.goal != Goal::Released);
        let stopped = if control_taken {
            self.ramp_down().await
        } else {
            Ok(())
        };
        self.pursue(Goal::Released);
        // a fault that came during the ramp, or after the last look of the owner, is no regular end
        let faulted = self
            .view()
            .is_some_and(|view| view.operated && view.seen.is_some_and(Seen::fault))
            && self.ending.open().returned.is_none();
        // the drive must see the word without control before the connection ends
        let end = self.session.now() + self.cycle * 4;
        while self.session.now() < end && self.session.connection(self.link) == Connection::Running {
            self.session.step(end).await?;
        }
        stopped?;
        if faulted {
            return Err(self.trouble(Trouble::Fault));
        }
        if self.quick {
            return Err(self.trouble(Trouble::QuickStopUsed));
        }
        if self.view().is_some_and(|view| view.operated && view.turns) {
            return Err(self.trouble(Trouble::StillTurns));
        }
        Ok(())
    }

    /// OFF1, and whatever it takes until the pulses are off or the control gives up.
    async fn ramp_down(&mut self) -> Result<(), Error> {
        let seen = self.view().and_then(|view| view.seen);
        let speed = seen.and_then(|seen| Some(self.scale.speed(seen.nist_a?)));
        let limit = self.ending.stop_limit(speed, self.deceleration);
        self.session.client().allow_stop(self.link, limit);
        self.pursue(Goal::Stop);
        loop {
            let view = self.view();
            // a quick stop that took over is waited for as well, and reported with the release
            self.quick |= view.is_some_and(|view| view.quick_stop && !view.hurried);
            self.hurried |= view.is_some_and(|view| view.hurried);
            if let Some(error) = self.lost(self.session.connection(self.link)) {
                return Err(error);
            }
            let Some(view) = view else { return Ok(()) };
            self.session.hurry_on(self.link, &view);
            match view.progress {
                Progress::Failed(Trouble::QuickStopUsed) if !view.at_rest => {}
                Progress::Failed(trouble) => return Err(self.trouble(trouble)),
                _ if view.at_rest => return Ok(()),
                _ => {}
            }
            self.session.look_again().await?;
        }
    }

    fn pursue(&self, goal: Goal) {
        let now = self.session.now();
        self.session.client().pursue(now, self.link, goal);
    }

    fn view(&self) -> Option<AxisView> {
        self.session.client().axis(self.link)
    }

    fn trouble(&self, trouble: Trouble) -> Error {
        Error::Axis {
            drive: self.drive.label(),
            trouble,
        }
    }

    fn lost(&self, connection: Connection) -> Option<Error> {
        lost(&self.drive, connection, &self.loss)
    }
}

/// The error of a connection that is gone.
pub(super) fn lost(drive: &Drive, connection: Connection, loss: &LossReaction) -> Option<Error> {
    let reaction = || Some(Box::new(loss.clone()));
    match connection {
        Connection::Lost(cause) => Some(Error::ConnectionLost {
            drive: drive.label(),
            cause,
            reaction: reaction(),
        }),
        Connection::Silent => Some(Error::LineSilent {
            drive: drive.label(),
            reaction: reaction(),
        }),
        _ => None,
    }
}

impl Axis {
    /// Stops the axis, gives control back and closes the connection. An axis that [`coasts`](Self::coasts) is not waited
    /// for.
    ///
    /// # Errors
    /// When the axis does not come to a standstill or the connection is lost; it is closed anyway.
    pub async fn release(self) -> Result<(), Error> {
        self.release_and_look().await.result
    }

    /// The same; returns how the axis was when control was given back, also where something went wrong on the way.
    pub async fn release_and_look(mut self) -> Released {
        let _meanwhile = self.session.unstoppable();
        self.ending.report();
        self.session.engine().stir();
        loop {
            if let Some(result) = self.ending.take_result() {
                return result;
            }
            // what the word without control brings about is no motion any more
            if self
                .status()
                .is_some_and(|status| status.view.goal != Goal::Released)
            {
                self.show();
            }
            // further failures are part of the result
            if let Err(error) = self.session.look_again().await
                && error.is_final()
            {
                return Released {
                    rest: Rest::Unknown,
                    closed: false,
                    hurried: false,
                    result: Err(error),
                };
            }
        }
    }

    /// Begins a ramp stop; what is called next waits for its end.
    pub(in crate::session) fn begin_stop(&mut self) {
        self.begin_stop_by(StopKind::Ramp);
    }

    /// The same, or another stop.
    pub(in crate::session) fn begin_stop_by(&mut self, way: StopKind) {
        let speed = self.status().and_then(|status| status.speed_actual);
        let limit = self.ending.stop_limit(speed, self.deceleration);
        let now = self.session.now();
        {
            let mut client = self.session.client();
            client.allow_stop(self.link, limit);
            client.pursue(now, self.link, Goal::Stop);
            client.hurry(now, self.link, way);
        }
        self.reported = false;
        self.session.engine().stir();
    }

    /// Stops an ownerless axis by the control word, and releases it. Returns how it was then, and how it was stopped in the end.
    pub(in crate::session) async fn stop_and_release(mut self) -> Result<(Rest, StopKind), Error> {
        let _meanwhile = self.session.unstoppable();
        let seen = |status: &AxisStatus| status.view.seen.map(|seen| seen.zsw1);
        // the first data shows whether it is in operation
        let operated = self.status().is_some_and(|status| status.view.operated);
        let first = if operated {
            Ok(true)
        } else {
            let first = self.hold_until(FIRST_DATA, |status| seen(status).is_some()).await;
            if takeover::is_kept(self.status().as_ref().and_then(seen)) {
                self.session.client().note_operated(self.link);
            }
            first
        };
        self.begin_stop();
        let released = self.release_and_look().await;
        let way = match released.hurried {
            true => StopKind::Quick,
            false => StopKind::Ramp,
        };
        first.and(released.result).map(|()| (released.rest, way))
    }
}

impl Drop for Axis {
    fn drop(&mut self) {
        self.ending.report();
        self.session.engine().stir();
    }
}
