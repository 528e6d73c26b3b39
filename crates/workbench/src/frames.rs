//! What the frames of the network show of each drive: the states of the last minute, its telegrams, what went wrong.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use profidrive::report::{DriveState, DriveWords, MachineReport};
use profidrive::traffic::{News, Node, StreamSummary, Traffic, Watch, hex_bytes, is_own_look};
use profidrive::{Caller as Network, MacAddress};
use schemars::JsonSchema;
use serde::Serialize;
use tokio::time::{MissedTickBehavior, interval};

use crate::live::Topic;
use crate::shared::Shared;

/// Time between two looks at the frames that have come.
const LOOK: Duration = Duration::from_millis(50);
/// States are shown for this time.
const SHOWN: Duration = Duration::from_secs(60);
/// Changes of state that are kept of a drive.
const CHANGES: usize = 512;
/// Things that went wrong that are kept.
const TROUBLES: usize = 500;
/// Looks after which a state is sent again that has not changed, so that pages see that it is not old.
const AGAIN: u32 = 10;

/// A drive came into a state.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(crate) struct StateChange {
    /// Time of day in ms since 1970.
    unix_ms: u64,
    /// The state; null where its words have none.
    state: Option<DriveState>,
    /// The control word that its controller sent, in hexadecimal.
    stw1: Option<String>,
    /// Its status word.
    zsw1: Option<String>,
}

/// Where a drive is in the state machine, and where it was in the last minute.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct MachineTopic {
    /// Where the words are from: `frames`, its cyclic connection, or `parameters`, which are read once a second.
    source: &'static str,
    /// Time of day in ms since 1970 when this was made.
    unix_ms: u64,
    machine: MachineReport,
    /// The changes of the last minute, the oldest first, with the one before them.
    changes: Vec<StateChange>,
}

/// The last cyclic frame of one direction.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct TelegramHalf {
    /// `output`, from the controller, or `input`, from the drive.
    direction: &'static str,
    /// Time of day in ms since 1970 when it was on the wire.
    unix_ms: u64,
    /// Its octets in hexadecimal.
    octets: String,
    /// What they mean.
    tree: Node,
    /// How regular the frames are.
    timing: Option<StreamSummary>,
    /// How many frames were how far from their cycle.
    deviations: Vec<Deviations>,
}

/// Frames that were off their cycle by less than a time, and not less than that of the step before.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Deviations {
    /// In seconds.
    below: f64,
    frames: u64,
}

/// The cyclic frames of a drive.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct TelegramTopic {
    /// Number of the telegram; null where it is not known.
    telegram: Option<u16>,
    /// The last frame of each direction; empty where there is no cyclic connection.
    halves: Vec<TelegramHalf>,
}

/// How regular the cyclic frames of a drive are, as this computer receives them.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct LinkTopic {
    /// The frames from the drive; null where it has no cyclic connection whose frames reach this computer.
    timing: Option<StreamSummary>,
}

/// Something that went wrong on the network.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct NetworkTrouble {
    /// Time of day in ms since 1970.
    unix_ms: u64,
    /// Who sent the frame.
    from: String,
    /// For whom it is; empty where for all.
    to: String,
    /// The protocol or service.
    topic: &'static str,
    /// What happened.
    text: String,
    /// How often since the start, or since it was forgotten: `unix_ms` is the time of the last.
    count: u64,
}

#[derive(Debug, Default)]
struct States {
    changes: VecDeque<StateChange>,
    /// Counts the changes.
    count: u64,
}

impl States {
    fn note(&mut self, words: &DriveWords, time: Duration) {
        if self.changes.back().is_some_and(|last| last.state == words.state) {
            return;
        }
        let hex = |word: &Option<profidrive::report::Word>| word.as_ref().map(|word| word.hex.clone());
        self.changes.push_back(StateChange {
            unix_ms: millis(time),
            state: words.state,
            stw1: hex(&words.stw1),
            zsw1: hex(&words.zsw1),
        });
        self.count += 1;
        self.trim(time);
    }

    /// Forgets what no minute before this time has.
    fn trim(&mut self, time: Duration) {
        let oldest = millis(time.saturating_sub(SHOWN));
        while self.changes.len() > CHANGES
            || self.changes.get(1).is_some_and(|second| second.unix_ms < oldest)
        {
            self.changes.pop_front();
        }
    }
}

/// What is known from frames, and from the parameters of drives that have none.
#[derive(Debug)]
pub(crate) struct Frames {
    traffic: Traffic,
    watch: Mutex<Watch>,
    states: Mutex<BTreeMap<String, States>>,
    troubles: Mutex<VecDeque<NetworkTrouble>>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

fn now() -> Duration {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default()
}

/// Adds a trouble as the newest. One that repeats is counted: it must not push the others out.
fn note_trouble(troubles: &mut VecDeque<NetworkTrouble>, mut newest: NetworkTrouble) {
    let is_same = |one: &NetworkTrouble| {
        (&one.from, &one.to, one.topic, &one.text) == (&newest.from, &newest.to, newest.topic, &newest.text)
    };
    if let Some(known) = troubles
        .iter()
        .position(is_same)
        .and_then(|place| troubles.remove(place))
    {
        newest.count += known.count;
    } else if troubles.len() >= TROUBLES {
        troubles.pop_front();
    }
    troubles.push_back(newest);
}

impl Frames {
    pub fn new(traffic: Traffic) -> Self {
        Self {
            watch: Mutex::new(Watch::new(&traffic)),
            traffic,
            states: Mutex::default(),
            troubles: Mutex::default(),
        }
    }

    /// Returns the frames of the last minute.
    pub const fn traffic(&self) -> &Traffic {
        &self.traffic
    }

    /// Returns what went wrong on the network, the oldest first.
    pub fn troubles(&self) -> Vec<NetworkTrouble> {
        locked(&self.troubles).iter().cloned().collect()
    }

    /// Reads the frames that have come since the last call. That a drive does not have what this server looks for on it is no
    /// trouble.
    pub fn catch_up(&self, network: &Network) {
        let mut watch = locked(&self.watch);
        let mut states = locked(&self.states);
        watch.catch_up(&mut |news| match news {
            News::Words { drive, time, words } => {
                states.entry(drive.to_string()).or_default().note(&words, time);
            }
            News::Restarted => {
                states.clear();
                locked(&self.troubles).clear();
            }
            News::Trouble { event, .. } if is_own_look(&event, network) => {}
            News::Trouble { time, event } => {
                note_trouble(
                    &mut locked(&self.troubles),
                    NetworkTrouble {
                        unix_ms: millis(time),
                        from: event.from,
                        to: event.to,
                        topic: event.topic,
                        text: event.text,
                        count: 1,
                    },
                );
            }
        });
    }

    /// Returns the words of a drive in its frames.
    fn words(&self, id: &str) -> Option<DriveWords> {
        locked(&self.watch).words(id.parse().ok()?)
    }

    /// Notes the states of drives that are read and have no frames here.
    fn note_read(&self, shared: &Shared) {
        let read = shared.board.peek(|stations| {
            let known = stations.known.iter().filter(|(_, known)| known.lost.is_none());
            let with_words = known.filter_map(|(id, known)| match &known.status {
                Some(Ok(status)) => Some((id.clone(), status.words.clone())),
                _ => None,
            });
            with_words.collect::<Vec<_>>()
        });
        for (id, words) in read {
            if self.words(&id).is_none() {
                locked(&self.states).entry(id).or_default().note(&words, now());
            }
        }
    }

    /// Returns where a drive is in the state machine; `None` before its words are known.
    pub fn machine(&self, shared: &Shared, id: &str) -> Option<MachineTopic> {
        let (source, words) = match self.words(id) {
            Some(words) => ("frames", words),
            None => shared
                .board
                .peek(|stations| match &stations.known.get(id)?.status {
                    Some(Ok(status)) => Some(("parameters", status.words.clone())),
                    _ => None,
                })?,
        };
        let mut states = locked(&self.states);
        let changes = states.get_mut(id).map(|states| {
            states.trim(now());
            states.changes.iter().cloned().collect()
        });
        Some(MachineTopic {
            source,
            unix_ms: millis(now()),
            machine: MachineReport::new(&words),
            changes: changes.unwrap_or_default(),
        })
    }

    /// Returns the cyclic frames of a drive.
    pub fn telegram(&self, id: &str) -> TelegramTopic {
        let watch = locked(&self.watch);
        let Ok(drive) = id.parse::<MacAddress>() else {
            return TelegramTopic {
                telegram: None,
                halves: Vec::new(),
            };
        };
        let streams = watch
            .summary(drive)
            .map(|summary| summary.streams)
            .unwrap_or_default();
        let halves = [("output", true), ("input", false)]
            .into_iter()
            .filter_map(|(direction, output)| {
                let (frame, tree) = watch.last(drive, output)?;
                let deviations = watch.deviations(drive, output).into_iter();
                Some(TelegramHalf {
                    direction,
                    unix_ms: millis(frame.time),
                    octets: hex_bytes(&frame.octets),
                    tree,
                    timing: streams
                        .iter()
                        .find(|stream| stream.direction == direction)
                        .cloned(),
                    deviations: deviations
                        .map(|(below, frames)| Deviations {
                            below: below.as_secs_f64(),
                            frames,
                        })
                        .collect(),
                })
            });
        TelegramTopic {
            telegram: watch.telegram(drive),
            halves: halves.collect(),
        }
    }

    /// Returns how regular the frames of the present connection of a drive are.
    pub fn link(&self, id: &str) -> LinkTopic {
        let watch = locked(&self.watch);
        let drive = id.parse::<MacAddress>().ok();
        // without words the connection has ended
        let drive = drive.filter(|drive| watch.words(*drive).is_some());
        let summary = drive.and_then(|drive| watch.summary(drive));
        let mut streams = summary.into_iter().flat_map(|summary| summary.streams);
        LinkTopic {
            timing: streams.find(|stream| stream.direction == "input"),
        }
    }

    fn count(&self, id: &str) -> u64 {
        locked(&self.states).get(id).map_or(0, |states| states.count)
    }
}

/// Reads the frames as they come, and brings the topics up to date that are made of them, for ever.
pub(crate) async fn follow(shared: Arc<Shared>) {
    let frames = &shared.frames;
    let mut changes = shared.board.changes();
    let mut turn = interval(LOOK);
    turn.set_missed_tick_behavior(MissedTickBehavior::Delay);
    // what was sent of each drive: the number of its changes, and before how many looks
    let mut sent: BTreeMap<String, (u64, u32)> = BTreeMap::new();
    let mut looks: u32 = 0;
    loop {
        turn.tick().await;
        looks = looks.wrapping_add(1);
        frames.catch_up(&shared.network);
        if changes.has_changed().unwrap_or(false) {
            changes.mark_unchanged();
            frames.note_read(&shared);
        }
        let wanted = shared.hub.wanted();
        sent.retain(|id, _| wanted.contains(&Topic::Machine(id.clone())));
        for topic in wanted {
            match &topic {
                Topic::Machine(id) => {
                    let count = frames.count(id);
                    let (before, looks) = sent.get(id).copied().unwrap_or((u64::MAX, 0));
                    let is_due = before != count || looks >= AGAIN;
                    if is_due && let Some(machine) = frames.machine(&shared, id) {
                        shared.hub.publish(&topic, &machine);
                        sent.insert(id.clone(), (count, 0));
                    } else {
                        sent.insert(id.clone(), (before, looks.saturating_add(1)));
                    }
                }
                // its figures change slowly
                Topic::Link(id) if looks.is_multiple_of(AGAIN) => {
                    shared.hub.publish(&topic, &frames.link(id));
                }
                Topic::Telegram(id) => shared.hub.publish(&topic, &frames.telegram(id)),
                _ => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use profidrive::profile::state::{Mode, Profile};

    use super::*;

    fn words(status: u16) -> DriveWords {
        DriveWords::of(Profile::Profidrive, Mode::Velocity, Some(0x047F), Some(status))
    }

    #[test]
    fn states_of_a_minute_are_kept_with_the_one_before() {
        let mut states = States::default();
        for (second, status) in [(0, 0x0240), (1, 0x0231), (2, 0x0231), (30, 0x0237), (85, 0x0231)] {
            states.note(&words(status), Duration::from_secs(second));
        }
        let shown: Vec<_> = states
            .changes
            .iter()
            .map(|change| (change.unix_ms / 1000, change.state))
            .collect();
        let (s2, s4) = (Some(DriveState::S2), Some(DriveState::S4));
        assert_eq!(shown, [(1, s2), (30, s4), (85, s2)]);
        assert_eq!(states.count, 4);
    }

    #[test]
    fn troubles_are_bounded_and_one_that_repeats_is_counted() {
        let trouble = |number: u64| NetworkTrouble {
            unix_ms: number,
            from: "axis-1".to_owned(),
            to: String::new(),
            topic: "cyclic",
            text: format!("trouble {}", number % 1000),
            count: 1,
        };
        let mut troubles = VecDeque::new();
        for number in (0..1000).chain([1999, 2999]) {
            note_trouble(&mut troubles, trouble(number));
        }
        let (oldest, newest) = (troubles.front().unwrap(), troubles.back().unwrap());
        assert_eq!((troubles.len(), oldest.unix_ms), (TROUBLES, 500));
        assert_eq!((newest.unix_ms, newest.count), (2999, 3));
    }

    #[test]
    fn their_number_is_bounded() {
        let mut states = States::default();
        for number in 0..2000 {
            let status = if number % 2 == 0 { 0x0231 } else { 0x0237 };
            states.note(&words(status), Duration::from_millis(number));
        }
        assert_eq!(states.changes.len(), CHANGES);
    }
}
