//! The socket of one page.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::Extension;
use axum::extract::State;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade, close_code};
use axum::response::Response;
use serde::{Deserialize, Serialize};
use tokio::sync::{OwnedSemaphorePermit, watch};
use tokio::time::{sleep_until, timeout};

use super::hub::Topic;
use super::streams::{Next, Place};
use crate::access::Caller;
use crate::assets;
use crate::problem::Problem;
use crate::shared::Shared;
use crate::upgrade::agree;

/// The protocol of this socket; another layout of the messages has another number.
const PROTOCOL: &str = "profidrive.live.1";
/// The longest message of a page, in octets.
const MESSAGE: usize = 4096;
/// Messages of a page in a second.
const RATE: u32 = 100;
/// Topics of a page.
const TOPICS: usize = 16;
/// Blocks of samples that are sent before everything else has its turn.
const BLOCKS: usize = 4;
/// The time between two values of a hidden page.
const HIDDEN: Duration = Duration::from_secs(1);
/// The time between two signs of life: a page that misses three of them knows within a second that it has lost its server.
const BEAT: Duration = Duration::from_millis(250);
/// The time between two looks at the session, and between two pings.
const LOOK: Duration = Duration::from_secs(1);
/// A page that takes nothing, or says nothing, for this time is gone.
const GONE: Duration = Duration::from_secs(40);

/// What a page sends.
#[derive(Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Request {
    /// Wants the values of a topic, at most `rate` in a second.
    Subscribe {
        topic: String,
        rate: f64,
        /// What `acyclic` reads.
        #[serde(default)]
        parameters: Vec<String>,
    },
    Unsubscribe {
        topic: String,
    },
    /// Whether the page is visible.
    Visible {
        visible: bool,
    },
    /// Continues after event `last_event` of the server with this `boot`.
    Resume {
        boot: String,
        last_event: u64,
    },
    /// A message of a newer page.
    #[serde(other)]
    Other,
}

/// The first message to a page.
#[derive(Debug, Serialize)]
struct Hello<'s> {
    r#type: &'static str,
    build: &'static str,
    boot: &'s str,
    simulation: bool,
    /// Time of this server in microseconds.
    t: u64,
    /// The number of the next event.
    next_event: u64,
}

/// A sign of life.
#[derive(Debug, Serialize)]
struct Clock {
    r#type: &'static str,
    t: u64,
}

/// Opens the socket with what changes: a page subscribes to topics and gets their newest values, and each event.
#[utoipa::path(get, path = "/api/v1/live", responses(
    (status = 101, description = "A WebSocket with the protocol `profidrive.live.1`"),
    (status = 403, description = "Another origin"),
    (status = 426, description = "No WebSocket, or another protocol"),
    (status = 429, description = "Too many sockets"),
))]
pub(crate) async fn live(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Problem> {
    let (upgrade, place) = agree(upgrade, PROTOCOL, MESSAGE, &shared.sockets, caller.role)?;
    Ok(upgrade.on_upgrade(move |socket| Client::new(shared, caller, place).serve(socket)))
}

/// What a page subscribes to.
#[derive(Debug)]
struct Subscription {
    topic: Topic,
    period: Duration,
    /// The revision that was sent last.
    sent: u64,
    /// How far it is in a stream of samples.
    place: Place,
    /// When a value may be sent again.
    due: Instant,
}

/// One page.
struct Client {
    shared: Arc<Shared>,
    caller: Caller,
    news: watch::Receiver<u64>,
    topics: Vec<Subscription>,
    visible: bool,
    /// The next event for it.
    next_event: u64,
    /// The second in which messages are counted.
    second: Instant,
    messages: u32,
    heard: Instant,
    _place: OwnedSemaphorePermit,
}

/// Why a socket is closed by this side.
type Closing = (u16, &'static str);

impl Client {
    fn new(shared: Arc<Shared>, caller: Caller, place: OwnedSemaphorePermit) -> Self {
        let now = Instant::now();
        Self {
            news: shared.hub.news(),
            next_event: shared.hub.next_event(),
            shared,
            caller,
            topics: Vec::new(),
            visible: true,
            second: now,
            messages: 0,
            heard: now,
            _place: place,
        }
    }

    async fn serve(mut self, mut socket: WebSocket) {
        if let Some((code, reason)) = self.talk(&mut socket).await {
            let frame = CloseFrame {
                code,
                reason: reason.into(),
            };
            // what it sent meanwhile is read: a connection that is closed with unread octets loses the reason on its way
            let end = async {
                let sent = socket.send(Message::Close(Some(frame))).await;
                while sent.is_ok() && matches!(socket.recv().await, Some(Ok(_))) {}
            };
            let _ = timeout(LOOK, end).await;
        }
    }

    /// Serves the page until it ends, or this side has a reason to end it.
    async fn talk(&mut self, socket: &mut WebSocket) -> Option<Closing> {
        let hello = Hello {
            r#type: "hello",
            build: assets::build(),
            boot: &self.shared.boot,
            simulation: self.shared.source.is_simulation(),
            t: self.shared.hub.time(),
            next_event: self.next_event,
        };
        send(socket, serde_json::to_string(&hello).unwrap_or_default().into()).await?;
        let mut beat = tokio::time::interval(BEAT);
        let mut look = tokio::time::interval(LOOK);
        loop {
            if let Err(closing) = self.flush(socket).await {
                return closing;
            }
            let due = self.next_due();
            tokio::select! {
                message = socket.recv() => match self.take(message?) {
                    Ok(()) => {}
                    Err(closing) => return closing,
                },
                // the sender is a part of what is shared
                _ = self.news.changed() => {}
                () = sleep_until(due.unwrap_or_else(Instant::now).into()), if due.is_some() => {}
                _ = beat.tick() => self.beat(socket).await?,
                _ = look.tick() => {
                    if let Err(closing) = self.look(socket).await {
                        return closing;
                    }
                }
            }
        }
    }

    /// Sends a sign of life; `None` when the page is gone.
    async fn beat(&self, socket: &mut WebSocket) -> Option<()> {
        let clock = Clock {
            r#type: "clock",
            t: self.shared.hub.time(),
        };
        send(socket, serde_json::to_string(&clock).unwrap_or_default().into()).await
    }

    /// Ends a socket whose session or page is gone.
    async fn look(&self, socket: &mut WebSocket) -> Result<(), Option<Closing>> {
        if self.heard.elapsed() > GONE {
            return Err(None);
        }
        if let Some(session) = &self.caller.session
            && !self
                .shared
                .sessions()
                .lasts(session, self.visible, Instant::now())
        {
            return Err(Some((close_code::POLICY, "the session has ended")));
        }
        if self.visible && !self.topics.is_empty() {
            self.shared.board.look(|_| ());
        }
        send_message(socket, Message::Ping(Vec::new().into()))
            .await
            .ok_or(None)
    }

    /// Takes a message of the page.
    fn take(&mut self, message: Result<Message, axum::Error>) -> Result<(), Option<Closing>> {
        let now = Instant::now();
        self.heard = now;
        if now.saturating_duration_since(self.second) >= Duration::from_secs(1) {
            (self.second, self.messages) = (now, 0);
        }
        self.messages += 1;
        if self.messages > RATE {
            return Err(Some((close_code::POLICY, "too many messages")));
        }
        let text = match message {
            Ok(Message::Text(text)) => text,
            Ok(Message::Binary(_)) => return Err(Some((close_code::POLICY, "not a text"))),
            Ok(Message::Close(_)) => return Err(None),
            Ok(_) => return Ok(()),
            // a lost connection gets no answer either way
            Err(_) => return Err(Some((close_code::SIZE, "the message is too long, or no message"))),
        };
        let request = serde_json::from_str(&text)
            .map_err(|_| Some((close_code::POLICY, "not a message of the protocol")))?;
        self.carry_out(request)
    }

    fn carry_out(&mut self, request: Request) -> Result<(), Option<Closing>> {
        match request {
            Request::Subscribe {
                topic,
                rate,
                parameters,
            } => {
                let Some(topic) = Topic::named(&topic, parameters) else {
                    return Ok(());
                };
                self.unsubscribe(&topic.name());
                if self.topics.len() >= TOPICS {
                    return Err(Some((close_code::POLICY, "too many topics")));
                }
                if self.visible {
                    self.want(&topic);
                }
                let rate = if rate.is_finite() {
                    rate.clamp(0.1, 50.0)
                } else {
                    1.0
                };
                self.topics.push(Subscription {
                    topic,
                    period: Duration::from_secs_f64(1.0 / rate),
                    sent: 0,
                    place: Place::default(),
                    due: Instant::now(),
                });
            }
            Request::Unsubscribe { topic } => {
                self.unsubscribe(&topic);
            }
            Request::Visible { visible } => self.set_visible(visible),
            Request::Resume { boot, last_event } => {
                let next = last_event.saturating_add(1);
                // of another start, or too long ago: what is subscribed to is sent anyway
                if boot == self.shared.boot && self.shared.hub.event(next).is_ok() {
                    self.next_event = next.min(self.next_event);
                }
            }
            Request::Other => {}
        }
        Ok(())
    }

    fn want(&self, topic: &Topic) {
        self.shared.hub.want(topic);
        self.shared.board.look_again();
    }

    /// Ends what is subscribed to by this name: a page has one stream of a name, whatever it reads.
    fn unsubscribe(&mut self, name: &str) {
        let (hub, visible) = (&self.shared.hub, self.visible);
        self.topics.retain(|known| {
            let stays = known.topic.name() != name;
            if !stays && visible {
                hub.leave(&known.topic);
            }
            stays
        });
    }

    /// A hidden page wants nothing for itself; it gets what is sent to others, once a second.
    fn set_visible(&mut self, visible: bool) {
        if visible == self.visible {
            return;
        }
        self.visible = visible;
        for subscription in &self.topics {
            match visible {
                true => self.want(&subscription.topic),
                false => self.shared.hub.leave(&subscription.topic),
            }
        }
    }

    /// Returns when a value may be sent that may not yet.
    fn next_due(&self) -> Option<Instant> {
        let waits = |subscription: &&Subscription| {
            let newest = self.shared.hub.newest(&subscription.topic);
            newest.is_some_and(|newest| newest.revision != subscription.sent)
        };
        self.topics.iter().filter(waits).map(|one| one.due).min()
    }

    /// Sends the events that have happened, and the newest values that are due.
    async fn flush(&mut self, socket: &mut WebSocket) -> Result<(), Option<Closing>> {
        self.news.mark_unchanged();
        loop {
            match self.shared.hub.event(self.next_event) {
                Ok(Some(text)) => send(socket, text).await.ok_or(None)?,
                Ok(None) => break,
                Err(_) => return Err(Some((close_code::AGAIN, "events were missed"))),
            }
            self.next_event += 1;
        }
        let now = Instant::now();
        let slowest = if self.visible { Duration::ZERO } else { HIDDEN };
        for subscription in &mut self.topics {
            if subscription.topic.has_samples() {
                // a few at a time: events must not wait for a page that is too slow, whose oldest blocks are gone
                for _ in 0..BLOCKS {
                    let streams = &self.shared.hub.streams;
                    let next = streams.next(&subscription.topic, &mut subscription.place);
                    let message = match next {
                        Some(Next::Header(text)) => Message::Text(text),
                        Some(Next::Block(octets)) if self.visible => Message::Binary(octets),
                        Some(Next::Block(_)) => continue,
                        None => break,
                    };
                    send_message(socket, message).await.ok_or(None)?;
                    self.news.mark_changed();
                }
                continue;
            }
            if subscription.due > now {
                continue;
            }
            let newest = self.shared.hub.newest(&subscription.topic);
            if let Some(newest) = newest.filter(|newest| newest.revision != subscription.sent) {
                send(socket, newest.text).await.ok_or(None)?;
                subscription.sent = newest.revision;
                subscription.due = now + subscription.period.max(slowest);
            }
        }
        Ok(())
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        self.set_visible(false);
    }
}

/// Sends a text; `None` when the page is gone, or takes nothing.
async fn send(socket: &mut WebSocket, text: axum::extract::ws::Utf8Bytes) -> Option<()> {
    send_message(socket, Message::Text(text)).await
}

async fn send_message(socket: &mut WebSocket, message: Message) -> Option<()> {
    timeout(GONE, socket.send(message)).await.ok()?.ok()
}
