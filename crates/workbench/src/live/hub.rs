//! The newest value of each topic, and the last events.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use axum::extract::ws::Utf8Bytes;
use serde::Serialize;
use tokio::sync::watch;

use super::streams::Streams;

/// Events that are kept for pages that were away for a moment.
pub(crate) const EVENTS: usize = 1024;

/// What a page can subscribe to.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Topic {
    /// `network`: all stations.
    Network,
    /// `plant`: the shafts of virtual drives.
    Plant,
    /// `drive/ID/faults`: the faults of a drive.
    Faults(String),
    /// `drive/ID/samples`: each cyclic input of an axis that this server controls.
    Samples(String),
    /// `drive/ID/acyclic`: words, speeds and these parameters, read again and again.
    Acyclic(String, Vec<String>),
    /// `drive/ID/machine`: where a drive is in the state machine.
    Machine(String),
    /// `drive/ID/telegram`: its cyclic frames.
    Telegram(String),
    /// `drive/ID/link`: how regular its cyclic frames are.
    Link(String),
    /// `log`: how many records there are.
    Log,
}

/// Parameters of one stream, and the longest name of one.
const PARAMETERS: usize = 16;
const PARAMETER: usize = 64;

impl Topic {
    /// Returns the topic of this name. Parameters count for `acyclic` only.
    pub fn named(name: &str, parameters: Vec<String>) -> Option<Self> {
        match name {
            "network" => Some(Self::Network),
            "plant" => Some(Self::Plant),
            "log" => Some(Self::Log),
            _ => {
                let (id, what) = name.strip_prefix("drive/")?.rsplit_once('/')?;
                if id.is_empty() || id.len() > 64 || id.contains('/') {
                    return None;
                }
                let id = id.to_owned();
                match what {
                    "faults" => Some(Self::Faults(id)),
                    "machine" => Some(Self::Machine(id)),
                    "telegram" => Some(Self::Telegram(id)),
                    "link" => Some(Self::Link(id)),
                    "samples" => Some(Self::Samples(id)),
                    "acyclic" => {
                        let fit = parameters.len() <= PARAMETERS
                            && parameters.iter().all(|name| name.len() <= PARAMETER);
                        fit.then_some(Self::Acyclic(id, parameters))
                    }
                    _ => None,
                }
            }
        }
    }

    /// Returns whether it has blocks of samples, and no newest value.
    pub const fn has_samples(&self) -> bool {
        matches!(self, Self::Samples(_) | Self::Acyclic(..))
    }

    /// Returns its name.
    pub fn name(&self) -> String {
        match self {
            Self::Network => "network".to_owned(),
            Self::Plant => "plant".to_owned(),
            Self::Log => "log".to_owned(),
            Self::Faults(id) => format!("drive/{id}/faults"),
            Self::Samples(id) => format!("drive/{id}/samples"),
            Self::Acyclic(id, _) => format!("drive/{id}/acyclic"),
            Self::Machine(id) => format!("drive/{id}/machine"),
            Self::Telegram(id) => format!("drive/{id}/telegram"),
            Self::Link(id) => format!("drive/{id}/link"),
        }
    }
}

/// Something that happened, which each page shows.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Event {
    /// What kind of event it is.
    pub kind: &'static str,
    /// The drive, as it is called in paths.
    pub drive: Option<String>,
    /// Who did it, as in the log; empty where no person did.
    pub who: String,
    /// What that one is called by its own words, which nothing verifies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub claimed_name: Option<String>,
    /// In words.
    pub text: String,
    /// Whether it was wanted and not done.
    pub failed: bool,
}

/// A value as it is sent.
#[derive(Debug, Clone)]
pub(crate) struct Newest {
    /// Grows with each value; 0 before the first.
    pub revision: u64,
    pub text: Utf8Bytes,
}

#[derive(Debug)]
struct Held {
    newest: Newest,
    /// Visible pages that subscribe to it.
    wanted: usize,
}

#[derive(Debug, Default)]
struct State {
    topics: BTreeMap<Topic, Held>,
    /// The last events, with the number of the first.
    events: VecDeque<Utf8Bytes>,
    first: u64,
}

/// What all pages share.
#[derive(Debug)]
pub(crate) struct Hub {
    state: Mutex<State>,
    /// Counts what has come, so that sockets wait for more.
    news: watch::Sender<u64>,
    /// Counts what pages begin to want.
    wants: watch::Sender<u64>,
    /// The samples of drives.
    pub streams: Streams,
    begin: Instant,
}

#[derive(Serialize)]
struct Snapshot<'s, T> {
    r#type: &'static str,
    topic: &'s str,
    rev: u64,
    /// Time of this server in microseconds.
    t: u64,
    data: &'s T,
}

#[derive(Serialize)]
struct Numbered<'s> {
    r#type: &'static str,
    n: u64,
    t: u64,
    unix_ms: u64,
    #[serde(flatten)]
    event: &'s Event,
}

impl Hub {
    pub fn new(begin: Instant) -> Self {
        Self {
            state: Mutex::default(),
            news: watch::Sender::new(0),
            wants: watch::Sender::new(0),
            streams: Streams::default(),
            begin,
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the time of this server in microseconds.
    pub fn time(&self) -> u64 {
        u64::try_from(self.begin.elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    /// Returns what wakes a socket when something has come.
    pub fn news(&self) -> watch::Receiver<u64> {
        self.news.subscribe()
    }

    /// Wakes each socket: something has come.
    pub fn announce(&self) {
        self.news.send_modify(|count| *count += 1);
    }

    /// Notes that a visible page subscribes to a topic.
    pub fn want(&self, topic: &Topic) {
        let mut state = self.state();
        let held = state.topics.entry(topic.clone()).or_insert_with(|| Held {
            newest: Newest {
                revision: 0,
                text: Utf8Bytes::default(),
            },
            wanted: 0,
        });
        held.wanted += 1;
        drop(state);
        self.wants.send_modify(|count| *count += 1);
    }

    /// Returns what wakes a producer when a page begins to want a topic.
    pub fn wants(&self) -> watch::Receiver<u64> {
        self.wants.subscribe()
    }

    /// Notes that one page less wants a topic.
    pub fn leave(&self, topic: &Topic) {
        let mut state = self.state();
        if let Some(held) = state.topics.get_mut(topic) {
            held.wanted = held.wanted.saturating_sub(1);
            // an old value must not greet the next page as the newest
            if held.wanted == 0 {
                state.topics.remove(topic);
            }
        }
    }

    /// Returns the topics that visible pages want.
    pub fn wanted(&self) -> Vec<Topic> {
        self.state().topics.keys().cloned().collect()
    }

    /// Returns whether a visible page wants a topic.
    pub fn is_wanted(&self, topic: &Topic) -> bool {
        self.state().topics.contains_key(topic)
    }

    /// Replaces the value of a topic, where a page wants it.
    pub fn publish(&self, topic: &Topic, data: &impl Serialize) {
        let name = topic.name();
        let t = self.time();
        {
            let mut state = self.state();
            let Some(held) = state.topics.get_mut(topic) else {
                return;
            };
            // revisions of a topic that was left and wanted again must differ from those before
            let rev = t.max(held.newest.revision + 1);
            let snapshot = Snapshot {
                r#type: "snapshot",
                topic: &name,
                rev,
                t,
                data,
            };
            held.newest = Newest {
                revision: rev,
                text: serde_json::to_string(&snapshot).unwrap_or_default().into(),
            };
        }
        self.announce();
    }

    /// Returns the newest value of a topic; `None` before the first.
    pub fn newest(&self, topic: &Topic) -> Option<Newest> {
        let state = self.state();
        let held = state.topics.get(topic)?;
        (held.newest.revision > 0).then(|| held.newest.clone())
    }

    /// Forgets the values of all topics: they are of drives that are no more.
    pub fn forget(&self) {
        for held in self.state().topics.values_mut() {
            held.newest = Newest {
                revision: 0,
                text: Utf8Bytes::default(),
            };
        }
    }

    /// Notes an event for all pages.
    pub fn report(&self, event: &Event) {
        let unix = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        {
            let mut state = self.state();
            let numbered = Numbered {
                r#type: "event",
                n: state.first + state.events.len() as u64,
                t: self.time(),
                unix_ms: u64::try_from(unix.as_millis()).unwrap_or(u64::MAX),
                event,
            };
            let text = serde_json::to_string(&numbered).unwrap_or_default();
            state.events.push_back(text.into());
            if state.events.len() > EVENTS {
                state.events.pop_front();
                state.first += 1;
            }
        }
        self.announce();
    }

    /// Returns the number of the next event.
    pub fn next_event(&self) -> u64 {
        let state = self.state();
        state.first + state.events.len() as u64
    }

    /// Returns the event of this number, `Ok(None)` before it has happened.
    ///
    /// # Errors
    /// When it is no longer kept.
    pub fn event(&self, number: u64) -> Result<Option<Utf8Bytes>, Gone> {
        let state = self.state();
        let place = number.checked_sub(state.first).ok_or(Gone)?;
        let place = usize::try_from(place).map_err(|_| Gone)?;
        Ok(state.events.get(place).cloned())
    }
}

/// An event that is no longer kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Gone;

#[cfg(test)]
mod tests {
    use super::*;

    fn stop(number: usize) -> Event {
        Event {
            kind: "stop",
            drive: None,
            who: "1".to_owned(),
            claimed_name: None,
            text: number.to_string(),
            failed: false,
        }
    }

    #[test]
    fn each_topic_is_described() {
        let page = include_str!("../../../../docs/src/workbench-sockets.md");
        let of = ["faults", "machine", "telegram", "link", "samples", "acyclic"]
            .map(|what| format!("drive/ID/{what}"));
        let names = ["network", "plant", "log"].map(str::to_owned);
        for name in names.iter().chain(&of) {
            let topic = Topic::named(name, Vec::new()).unwrap();
            assert_eq!(topic.name(), *name);
            assert!(page.contains(&format!("| `{name}` |")), "{name}");
        }
    }

    #[test]
    fn a_topic_has_its_newest_value_while_it_is_wanted() {
        let hub = Hub::new(Instant::now());
        let topic = Topic::named("drive/02:00:00:00:00:01/faults", Vec::new()).unwrap();
        hub.publish(&topic, &1);
        assert!(hub.newest(&topic).is_none(), "no page wants it");
        hub.want(&topic);
        hub.want(&topic);
        assert!(hub.newest(&topic).is_none());
        hub.publish(&topic, &1);
        let first = hub.newest(&topic).unwrap();
        hub.publish(&topic, &2);
        let second = hub.newest(&topic).unwrap();
        assert!(second.revision > first.revision);
        assert!(second.text.contains("\"data\":2"), "{}", second.text);
        assert!(
            second
                .text
                .contains("\"topic\":\"drive/02:00:00:00:00:01/faults\"")
        );
        hub.forget();
        assert!(hub.newest(&topic).is_none());
        hub.publish(&topic, &3);
        assert!(hub.newest(&topic).unwrap().revision > second.revision);
        hub.leave(&topic);
        assert!(hub.is_wanted(&topic));
        hub.leave(&topic);
        hub.want(&topic);
        assert!(
            hub.newest(&topic).is_none(),
            "a value of before is not the newest"
        );
    }

    #[test]
    fn events_are_kept_in_order_and_bounded() {
        let hub = Hub::new(Instant::now());
        assert_eq!(hub.event(0), Ok(None));
        for number in 0..EVENTS + 10 {
            hub.report(&stop(number));
        }
        assert_eq!(hub.event(9), Err(Gone));
        for number in 10..EVENTS + 10 {
            let text = hub.event(number as u64).unwrap().unwrap();
            assert!(text.contains(&format!("\"n\":{number},")), "{text}");
            assert!(text.contains(&format!("\"text\":\"{number}\"")), "{text}");
        }
        assert_eq!(hub.next_event(), EVENTS as u64 + 10);
        assert_eq!(hub.event(hub.next_event()), Ok(None));
    }

    #[test]
    fn only_topics_that_exist_have_a_name() {
        for name in ["", "networks", "drive//faults/", "drive/x", "drive/x/nothing"] {
            assert_eq!(Topic::named(name, Vec::new()), None, "{name}");
        }
        assert_eq!(
            Topic::named(&format!("drive/{}/faults", "x".repeat(65)), Vec::new()),
            None
        );
        for name in [
            "network",
            "plant",
            "drive/ip-10.0.0.1/faults",
            "drive/02:00:00:00:00:01/samples",
            "drive/x/acyclic",
            "log",
            "drive/02:00:00:00:00:01/machine",
            "drive/02:00:00:00:00:01/telegram",
            "drive/02:00:00:00:00:01/link",
        ] {
            assert_eq!(Topic::named(name, Vec::new()).unwrap().name(), name);
        }
        for wrong in [vec!["p1".to_owned(); 17], vec!["p".repeat(65)]] {
            assert_eq!(Topic::named("drive/x/acyclic", wrong), None);
        }
    }
}
