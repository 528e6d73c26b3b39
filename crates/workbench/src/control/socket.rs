//! The control socket of one page: what it requests, its beats, and STOP.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use axum::Extension;
use axum::extract::State;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade, close_code};
use axum::response::Response;
use futures::stream::{SplitSink, SplitStream};
use futures::{FutureExt, SinkExt, StreamExt};
use profidrive::motion::{Control as Common, Hold};
use tokio::sync::{OwnedSemaphorePermit, mpsc};
use tokio::task::unconstrained;
use tokio::time::{MissedTickBehavior, interval, timeout};

use super::denied::{Denied, permit_round_trip};
use super::fresh::Freshness;
use super::ledger::Stamp;
use super::messages::{Axes, Echo, For, HeldGoal, Hello, Request, Stamped};
use super::running::{Closing, Command, Order, Out, Reply, Running, conflict};
use super::stopping::StopsSent;
use super::taking::Terms;
use super::{HOLD, LEASE};
use crate::access::{Caller, Role};
use crate::act::{self, Author, Intent};
use crate::assets;
use crate::problem::Problem;
use crate::settings::Source;
use crate::shared::Shared;
use crate::upgrade::agree;

/// The protocol of this socket; another layout of the messages has another number.
const PROTOCOL: &str = "profidrive.control.1";
/// The longest message of a page, in octets.
const MESSAGE: usize = 4096;
/// Messages of a page in a second; STOP is not counted.
const RATE: u32 = 100;
/// Messages that are searched for a STOP before a socket is closed that broke the rules.
const BEHIND: usize = 1000;
/// Answers that a page has not taken, before its socket is closed.
const ANSWERS: usize = 64;
/// Time between two pictures of the axes that differ.
const PICTURES: Duration = Duration::from_millis(33);
/// A picture is sent after this time at the latest, as a sign of life: a page that misses three of them knows within a second that it
/// has lost its server.
const ALIVE: Duration = Duration::from_millis(250);
/// Time between two looks at the session.
const LOOK: Duration = Duration::from_secs(1);
/// A page that takes nothing for this time is gone.
const GONE: Duration = Duration::from_secs(5);
/// Highest speed of a lease where the page requests no other, rpm.
const LIMIT: f64 = 300.0;

/// Opens the control socket: a page takes an axis by it, keeps a motion going by beats, and stops. Each session may open it, and only
/// STOP is for all of them.
#[utoipa::path(get, path = "/api/v1/control", responses(
    (status = 101, description = "A WebSocket with the protocol `profidrive.control.1`"),
    (status = 403, description = "Another origin"),
    (status = 426, description = "No WebSocket, or another protocol"),
    (status = 429, description = "Too many sockets"),
))]
pub(crate) async fn control(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Problem> {
    let (upgrade, place) = agree(upgrade, PROTOCOL, MESSAGE, &shared.control_sockets, caller.role)?;
    Ok(upgrade.on_upgrade(move |socket| serve(shared, caller, socket, place)))
}

async fn serve(shared: Arc<Shared>, caller: Caller, socket: WebSocket, place: OwnedSemaphorePermit) {
    let (sink, mut stream) = socket.split();
    let (answers, queue) = mpsc::channel(ANSWERS);
    let mut page = Page::new(shared, caller, Reply(answers));
    // before it has the present state: what comes meanwhile is sent twice rather than never
    let sent_before = page.shared.control.stop_news.borrow().all_sent();
    page.hello();
    // sending waits for the page, reading must not: STOP and beats pass whatever is on its way out
    let writer = tokio::spawn(write(Arc::clone(&page.shared), sink, queue, sent_before));
    let mut look = interval(LOOK);
    let closing = loop {
        tokio::select! {
            message = stream.next() => match message.map(|message| page.read(message)) {
                Some(Ok(())) => {}
                Some(Err(closing)) => {
                    page.read_stop(&mut stream);
                    break closing;
                }
                None => break None,
            },
            _ = look.tick() => if let Err(closing) = page.look() { break Some(closing) },
        }
        if page.reply.0.is_closed() {
            break None;
        }
    };
    // first: nothing that follows may keep an axis
    page.end();
    drop(place);
    if let Some(closing) = closing {
        page.reply.close(closing);
    }
    drop(page);
    let _ = timeout(GONE, writer).await;
}

/// Sends answers, news and pictures of the axes until the page is gone.
async fn write(
    shared: Arc<Shared>,
    mut sink: SplitSink<WebSocket, Message>,
    mut queue: mpsc::Receiver<Out>,
    mut sent_before: StopsSent,
) {
    let mut pictures = interval(PICTURES);
    pictures.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let mut stops = shared.control.stop_news.subscribe();
    let mut shown = Vec::new();
    let mut showed = Instant::now();
    loop {
        let message = tokio::select! {
            biased;
            changed = stops.changed() => {
                // the sender is a part of what is shared
                if changed.is_err() {
                    return;
                }
                let next = stops.borrow_and_update().next(&mut sent_before);
                match next {
                    Some(text) => {
                        // a reset may come behind it
                        stops.mark_changed();
                        Message::Text(text)
                    }
                    None => continue,
                }
            }
            answer = queue.recv() => match answer {
                None => return,
                Some(Out::Text(text)) => Message::Text(text.into()),
                Some(Out::Close((code, reason))) => Message::Close(Some(CloseFrame {
                    code,
                    reason: reason.into(),
                })),
            },
            _ = pictures.tick() => {
                let axes = shared.control.pictures();
                if axes == shown && showed.elapsed() + PICTURES <= ALIVE {
                    continue;
                }
                showed = Instant::now();
                shown.clone_from(&axes);
                let picture = Axes { r#type: "axes", axes };
                Message::Text(serde_json::to_string(&picture).unwrap_or_default().into())
            }
        };
        let last = matches!(message, Message::Close(_));
        let sent = timeout(GONE, sink.send(message)).await;
        if last || !matches!(sent, Ok(Ok(()))) {
            return;
        }
    }
}

/// Why a text is no message of a page.
fn no_message(error: &serde_json::Error) -> &'static str {
    // JSON has neither infinite numbers nor NaN, and a larger one than that of a float is none here
    match error.to_string().contains("out of range") {
        true => "a number is too large to be one",
        false => "not a message of the protocol",
    }
}

/// One page.
pub(super) struct Page {
    pub(super) shared: Arc<Shared>,
    pub(super) caller: Caller,
    /// The number of its socket.
    pub(super) number: u64,
    pub(super) reply: Reply,
    freshness: Freshness,
    begin: Instant,
    /// The second in which messages are counted.
    second: Instant,
    messages: u32,
    /// Its axes.
    pub(super) own: Vec<Arc<Running>>,
    /// A STOP of a flood of them is on its way.
    confirming: Arc<AtomicBool>,
}

impl Page {
    fn new(shared: Arc<Shared>, caller: Caller, reply: Reply) -> Self {
        let now = Instant::now();
        Self {
            number: shared.control.next_socket(),
            shared,
            caller,
            reply,
            freshness: Freshness::default(),
            begin: now,
            second: now,
            messages: 0,
            own: Vec::new(),
            confirming: Arc::default(),
        }
    }

    /// Returns why this page controls nothing here, whatever it requests.
    pub(super) fn refusal(&self) -> Option<Denied> {
        match (&self.shared.source, self.caller.role) {
            _ if self.shared.read_only => Some(Denied::ReadOnly),
            (_, Role::View) => Some(Denied::View),
            _ if self.caller.remote && !self.shared.moves_remotely => Some(Denied::Remote),
            (Source::Addresses(_), _) => Some(Denied::Addresses),
            _ => None,
        }
    }

    fn hello(&self) {
        let ledger = self.shared.control.ledger();
        self.reply.send(&Hello {
            r#type: "hello",
            build: assets::build(),
            boot: &self.shared.boot,
            who: &self.caller.who,
            epoch: ledger.epoch(),
            stopped: ledger.is_stopped(),
            refusal: self.refusal().and_then(|denied| denied.of_page()),
            hold_ms: HOLD.as_millis(),
            lease_ms: LEASE.as_millis(),
        });
    }

    /// Ends a socket whose session has ended.
    fn look(&mut self) -> Result<(), Closing> {
        let control = &self.shared.control;
        self.own
            .retain(|running| control.ledger().is_known(&running.drive, running.lease));
        match &self.caller.session {
            // a page that has an axis is used
            Some(session)
                if !self
                    .shared
                    .sessions()
                    .lasts(session, !self.own.is_empty(), Instant::now()) =>
            {
                Err((close_code::POLICY, "the session has ended"))
            }
            _ => Ok(()),
        }
    }

    /// Gives back everything that this page has.
    fn end(&self) {
        for running in &self.own {
            self.shared.control.let_go(running);
        }
    }

    fn read(&mut self, message: Result<Message, axum::Error>) -> Result<(), Option<Closing>> {
        let text = match message {
            Ok(Message::Text(text)) => text,
            Ok(Message::Binary(_)) => return Err(Some((close_code::POLICY, "not a text"))),
            Ok(Message::Close(_)) => return Err(None),
            Ok(_) => return Ok(()),
            Err(_) => return Err(Some((close_code::SIZE, "the message is too long, or no message"))),
        };
        let request: Request =
            serde_json::from_str(&text).map_err(|error| Some((close_code::POLICY, no_message(&error))))?;
        let now = Instant::now();
        if now.saturating_duration_since(self.second) >= Duration::from_secs(1) {
            (self.second, self.messages) = (now, 0);
        }
        self.messages = self.messages.saturating_add(1);
        if matches!(request, Request::Stop) {
            self.stop();
            return Ok(());
        }
        if self.messages > RATE {
            return Err(Some((close_code::POLICY, "too many messages")));
        }
        self.carry_out(request);
        Ok(())
    }

    /// Looks for a STOP among the messages that came behind the one that ends the socket: it passes those.
    fn read_stop(&mut self, stream: &mut SplitStream<WebSocket>) {
        for _ in 0..BEHIND {
            // what has come is looked at without waiting, however much it is
            let next = unconstrained(stream.next()).now_or_never();
            let Some(Some(Ok(message))) = next else { return };
            if let Message::Text(text) = message
                && matches!(serde_json::from_str(&text), Ok(Request::Stop))
            {
                return self.stop();
            }
        }
    }

    /// Stops everything now; the log comes behind. A flood of stops is carried out, and not logged one by one.
    fn stop(&self) {
        let stopping = self
            .shared
            .control
            .stop(&self.caller.who, self.caller.claimed.name());
        let (shared, caller) = (Arc::clone(&self.shared), self.caller.clone());
        if self.messages <= RATE {
            tokio::spawn(async move { act::confirm_stop(&shared, &caller, stopping).await });
            return;
        }
        let confirming = Arc::clone(&self.confirming);
        if confirming.swap(true, Ordering::Relaxed) {
            // the one that is on its way reports the newest
            return;
        }
        tokio::spawn(async move {
            let stopped = stopping.confirmed().await;
            // first: what comes from now on is reported by another one
            confirming.store(false, Ordering::Relaxed);
            shared.control.report_newest(stopped);
        });
    }

    fn carry_out(&mut self, request: Request) {
        match request {
            Request::Stop | Request::Other => {}
            Request::Beat { n, t, held } => self.beat(n, t, held.as_ref()),
            Request::Take {
                n,
                drive,
                purpose,
                limit,
                travel,
                cycle_ms,
                set_mode,
                may_run_on,
                checks,
                stop_by,
                wait,
            } => {
                let common = Common {
                    cycle: cycle_ms.map(|ms| Duration::from_millis(ms.into())),
                    set_mode,
                    may_run_on,
                    ..Common::default()
                };
                let hold = Hold {
                    limit: limit.unwrap_or(LIMIT),
                    travel,
                    lease: LEASE,
                    control: common,
                    ..match purpose {
                        For::Speed => Hold::for_speed(),
                        For::Position => Hold::for_position(),
                    }
                };
                let terms = Terms {
                    hold,
                    stop_by,
                    checks,
                    wait,
                };
                self.take(n, &drive.to_lowercase(), terms);
            }
            Request::Release { drive } => self.release(&drive),
            Request::HandOver { of, request } => self.hand_over(&of, request),
            Request::Keep { of, request } => self.keep(&of, request),
            Request::Halt { drive, lease } => {
                if let Some(running) = self.own(&drive).filter(|running| running.lease == lease) {
                    running.halt();
                }
            }
            Request::Confirm(of) => {
                let moved = self.own(&of.drive).is_some_and(|running| running.has_moved());
                let confirmed = self
                    .shared
                    .control
                    .ledger()
                    .confirm(&of.drive, self.stamp(&of), moved);
                self.answered(&of, "confirm", confirmed.map(|()| None));
            }
            Request::Reset { n, epoch } => self.reset(n, epoch),
            Request::Enable(of) => self.order(of, Order::Enable),
            Request::Disable(of) => self.order(of, Order::Disable),
            Request::Acknowledge(of) => self.order(of, Order::Acknowledge),
            Request::Jog { of, t, speed, rtt } => {
                let fresh = self.freshness.is_fresh(self.begin.elapsed(), t);
                let permitted = match fresh {
                    true => permit_round_trip(rtt),
                    false => Err(Denied::LateJog),
                };
                match permitted {
                    Ok(()) => self.order(of, Order::Jog(speed)),
                    Err(denied) => {
                        let value = Order::Jog(speed).value();
                        self.refuse(of.n, Some(&of.drive), "jog", value, &denied);
                    }
                }
            }
            Request::Velocity { of, speed } => self.order(of, Order::Velocity(speed)),
            Request::Move {
                of,
                turns,
                relative,
                speed,
            } => self.order(
                of,
                Order::Move {
                    turns,
                    relative,
                    speed,
                },
            ),
            Request::Home(of) => self.order(of, Order::Home),
            Request::Task { of, number } => self.order(of, Order::Task(number)),
        }
    }

    pub(super) fn own(&self, drive: &str) -> Option<&Arc<Running>> {
        let own = self.own.iter().rev();
        let mut of = own.filter(|running| running.drive == drive);
        of.next()
    }

    pub(super) const fn stamp(&self, of: &Stamped) -> Stamp {
        Stamp {
            socket: self.number,
            lease: of.lease,
            epoch: of.epoch,
            number: of.n,
        }
    }

    /// Refuses what a page wants, and notes that.
    pub(super) fn refuse(
        &self,
        n: u64,
        drive: Option<&str>,
        action: &'static str,
        value: Option<String>,
        denied: &Denied,
    ) {
        let reason = denied.to_string();
        self.reply.refused(n, &conflict(&reason));
        let intent = Intent {
            drive: drive.map(str::to_owned),
            ..Intent::new(action, value)
        };
        act::note_refusal(&self.shared, Author::caller(&self.caller), intent, &reason);
    }

    fn beat(&mut self, n: u64, t: f64, held: Option<&HeldGoal>) {
        let fresh = self.freshness.is_fresh(self.begin.elapsed(), t);
        if fresh {
            for running in &self.own {
                let number = held.filter(|held| held.drive == running.drive).map(|held| held.n);
                running.beat(number);
            }
        }
        self.reply.send(&Echo {
            r#type: "beat",
            n,
            t,
            fresh,
        });
    }

    fn order(&self, of: Stamped, order: Order) {
        let stamp = self.stamp(&of);
        let permitted = {
            let mut ledger = self.shared.control.ledger();
            match order {
                Order::Disable | Order::Acknowledge => ledger.permit(&of.drive, stamp),
                Order::Enable => ledger.permit_enable(&of.drive, stamp),
                Order::Jog(speed) | Order::Velocity(speed) | Order::Move { speed, .. } => {
                    ledger.permit_motion(&of.drive, stamp, Some(speed))
                }
                Order::Home | Order::Task(_) => ledger.permit_motion(&of.drive, stamp, None),
            }
        };
        if let Err(denied) = permitted {
            let value = order.value();
            self.refuse(of.n, Some(&of.drive), order.action(), value, &denied);
            return;
        }
        let command = Command {
            order,
            stamp,
            reply: self.reply.clone(),
        };
        match self.own(&of.drive) {
            Some(running) => running.order(command),
            None => self.refuse(of.n, Some(&of.drive), order.action(), None, &Denied::NotHeld),
        }
    }

    fn reset(&self, n: u64, epoch: u64) {
        if let Some(denied) = self.refusal() {
            self.refuse(n, None, "reset", None, &denied);
            return;
        }
        let reset = self.shared.control.ledger().reset(epoch);
        if let Err(denied) = reset {
            self.refuse(n, None, "reset", None, &denied);
        } else {
            self.reply.accepted(n);
            self.shared.control.report_reset(epoch);
            let (shared, caller) = (Arc::clone(&self.shared), self.caller.clone());
            tokio::spawn(async move {
                let intent = Intent::new("reset", Some(format!("STOP {epoch}")));
                act::note(&shared, &caller, &intent, "done".to_owned()).await;
            });
        }
    }
}
