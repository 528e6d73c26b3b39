//! What is known of the stations: found and read in the background while a page looks, for all pages together.

use std::collections::{BTreeMap, HashSet};
use std::net::Ipv4Addr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use futures::{StreamExt, stream};
use profidrive::client::{Drive, DriveAddress};
use profidrive::fleet::AT_ONCE;
use profidrive::motion::StopOffer;
use profidrive::report::{Error, Remark, Scanned, Station, StatusReport};
use profidrive::{Caller, DriveError, Explained, Opening, inspection, scan};
use tokio::sync::{Notify, watch};
use tokio::task::JoinSet;
use tokio::time::{MissedTickBehavior, interval};

use crate::words::PageWords;

/// Time for all stations to answer a search.
const SEARCH: Duration = Duration::from_secs(1);
/// Time between two searches, and between two readings of identities.
const SURVEY: Duration = Duration::from_secs(5);
/// Time between two readings of a status.
const STATUS: Duration = Duration::from_secs(1);
/// The readings of that time are divided among its parts, so that neither the network nor this computer has all of them at once.
const PARTS: u32 = 20;
/// A drive is due so long after its last reading has ended.
const REST: Duration = Duration::from_millis(900);
/// The network is left alone when no page has looked for this time.
const LOOK: Duration = Duration::from_secs(10);
/// A station that no longer answers is shown for this time.
const REMEMBER: Duration = Duration::from_secs(600);
/// Stations that are shown.
pub(crate) const STATIONS: usize = 1024;

/// What is known of a station.
#[derive(Debug, Clone)]
pub(crate) struct Known {
    pub scanned: Scanned,
    /// When it was first missed; `None` while it answers.
    pub lost: Option<Instant>,
    /// The drive that is read; `None` before it was found.
    drive: Option<Drive>,
    pub status: Option<Result<StatusReport, Error>>,
    /// By what it can be stopped, by its status.
    pub stop: Option<StopOffer>,
    /// When the status was read.
    pub read: Option<Instant>,
}

/// All stations.
#[derive(Debug, Default)]
pub(crate) struct Stations {
    /// By MAC address, or `ip-A.B.C.D` where drives are given by their addresses.
    pub known: BTreeMap<String, Known>,
    /// When the last search ended.
    pub searched: Option<Instant>,
    /// Why the last search failed.
    pub failure: Option<Error>,
    /// When a page looked last.
    looked: Option<Instant>,
    /// How many plants were started in the place of the first one.
    pub restarts: u64,
}

impl Stations {
    /// Takes the result of a search. Returns how many stations had no place.
    fn survey(&mut self, found: Vec<(String, Scanned)>, now: Instant) -> usize {
        let mut left_out = 0;
        let mut answered = HashSet::new();
        for (id, scanned) in found {
            answered.insert(id.clone());
            if let Some(known) = self.known.get_mut(&id) {
                if known.scanned.station != scanned.station {
                    known.drive = None;
                }
                known.scanned = scanned;
                known.lost = None;
            } else if self.known.len() < STATIONS {
                let known = Known {
                    scanned,
                    lost: None,
                    drive: None,
                    status: None,
                    stop: None,
                    read: None,
                };
                self.known.insert(id, known);
            } else {
                left_out += 1;
            }
        }
        self.known.retain(|id, known| {
            if !answered.contains(id) {
                known.lost.get_or_insert(now);
            }
            known
                .lost
                .is_none_or(|lost| now.saturating_duration_since(lost) < REMEMBER)
        });
        self.searched = Some(now);
        self.failure = None;
        left_out
    }

    fn is_watched(&self, now: Instant) -> bool {
        self.looked
            .is_some_and(|looked| now.saturating_duration_since(looked) < LOOK)
    }
}

impl Known {
    /// Returns whether parameters can be read.
    pub fn is_readable(&self) -> bool {
        let unreadable = [Remark::NoAddress, Remark::OtherSubnet, Remark::AddressTwice];
        let is_drive = self.scanned.info.as_ref().is_none_or(|info| info.is_drive);
        let role = self.scanned.station.role;
        self.lost.is_none()
            && is_drive
            && role.is_none_or(|role| role == "device")
            && !self
                .scanned
                .remarks
                .iter()
                .any(|remark| unreadable.contains(remark))
    }
}

/// The stations, and those who read them.
#[derive(Debug)]
pub(crate) struct Board {
    stations: Mutex<Stations>,
    /// A page looks again.
    wake: Notify,
    /// A search has ended: what it found is read at once.
    found: Notify,
    /// A page wants a search now.
    wanted: Notify,
    /// Counts what has changed.
    changed: watch::Sender<u64>,
    /// How many searches have begun, and ended.
    searches: watch::Sender<(u64, u64)>,
    opening: Opening,
    /// Drives given by their addresses; empty where stations are searched for.
    addresses: Vec<Ipv4Addr>,
}

impl Board {
    /// Returns a board without stations. It is read for a while, whether anybody looks or not: a first page has something to show.
    pub fn new(opening: Opening, addresses: Vec<Ipv4Addr>, now: Instant) -> Self {
        let stations = Stations {
            looked: Some(now),
            ..Stations::default()
        };
        Self {
            stations: Mutex::new(stations),
            wake: Notify::new(),
            found: Notify::new(),
            wanted: Notify::new(),
            changed: watch::Sender::new(0),
            searches: watch::Sender::new((0, 0)),
            opening,
            addresses,
        }
    }

    fn stations(&self) -> MutexGuard<'_, Stations> {
        self.stations.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls `see` with the stations, and lets them be read for some time.
    pub fn look<T>(&self, see: impl FnOnce(&Stations) -> T) -> T {
        let mut stations = self.stations();
        let now = Instant::now();
        let rested = !stations.is_watched(now);
        stations.looked = Some(now);
        if rested {
            self.wake.notify_waiters();
        }
        see(&stations)
    }

    /// Calls `see` with the stations as they are known, whether anyone reads them or not.
    pub fn peek<T>(&self, see: impl FnOnce(&Stations) -> T) -> T {
        see(&self.stations())
    }

    /// Returns how many plants were started in the place of the first one.
    pub fn restarts(&self) -> u64 {
        self.stations().restarts
    }

    /// Starts another plant and forgets the stations of the one before, while they are locked. `start` has the number of restarts
    /// before this one.
    ///
    /// # Errors
    /// What `start` returns; then nothing is forgotten.
    pub fn restart<E>(&self, start: impl FnOnce(u64) -> Result<(), E>) -> Result<u64, E> {
        let restarts = {
            let mut stations = self.stations();
            start(stations.restarts)?;
            *stations = Stations {
                looked: stations.looked,
                restarts: stations.restarts + 1,
                ..Stations::default()
            };
            stations.restarts
        };
        self.changed();
        self.wanted.notify_one();
        Ok(restarts)
    }

    fn changed(&self) {
        self.changed.send_modify(|count| *count += 1);
    }

    /// Returns what wakes whoever waits for changes.
    pub fn changes(&self) -> watch::Receiver<u64> {
        self.changed.subscribe()
    }

    /// Lets the stations be read for some time, and shows them once more to a new page.
    pub fn look_again(&self) {
        self.look(|_| ());
        self.changed();
    }

    /// Returns whether stations are searched for.
    pub const fn searches(&self) -> bool {
        self.addresses.is_empty()
    }

    /// Waits until a page looks. Returns whether none did before.
    async fn watched(&self) -> bool {
        let mut has_waited = false;
        loop {
            let woken = self.wake.notified();
            if self.stations().is_watched(Instant::now()) {
                return has_waited;
            }
            woken.await;
            has_waited = true;
        }
    }

    /// Searches, and reads identities, for ever.
    pub async fn survey(self: Arc<Self>, mut network: Caller) {
        let mut turn = interval(SURVEY);
        turn.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                _ = turn.tick() => drop(self.watched().await),
                () = self.wanted.notified() => turn.reset(),
            }
            self.searches.send_modify(|(begun, _)| *begun += 1);
            let restarts = self.restarts();
            let found = match self.searches() {
                true => self.search(&mut network).await,
                false => Ok(self.visit(&network).await),
            };
            {
                let mut stations = self.stations();
                match found {
                    // of a plant that is no more
                    _ if stations.restarts != restarts => {}
                    Ok(found) => {
                        stations.survey(found, Instant::now());
                        self.found.notify_one();
                    }
                    Err(error) => stations.failure = Some(error),
                }
            }
            self.changed();
            self.searches.send_modify(|(begun, ended)| *ended = *begun);
        }
    }

    /// Searches now, and waits for the end of it. Searches are never side by side: callers at the same time wait for one.
    pub async fn search_now(&self) {
        self.look(|_| ());
        let mut searches = self.searches.subscribe();
        // one that is under way may have missed what has come since it began
        let (before, _) = *searches.borrow();
        self.wanted.notify_one();
        // fails only when this board is gone
        let _ = searches.wait_for(|(_, ended)| *ended > before).await;
    }

    async fn search(&self, network: &mut Caller) -> Result<Vec<(String, Scanned)>, Error> {
        let found = scan::survey(network, SEARCH, &mut |_, _| {}).await;
        let report = found.map_err(|error| explained(&error))?.report;
        let of_mac = |scanned: Scanned| (scanned.station.mac.to_lowercase(), scanned);
        Ok(report.stations.into_iter().map(of_mac).collect())
    }

    /// Reads the drives that are given by their addresses.
    async fn visit(&self, network: &Caller) -> Vec<(String, Scanned)> {
        let all = self
            .addresses
            .iter()
            .map(|address| visit(self.opening.clone(), network.clone(), *address));
        let visits: Vec<_> = all.collect();
        stream::iter(visits).buffer_unordered(AT_ONCE).collect().await
    }

    /// Reads the status of each drive once a second, for ever. A drive that answers late holds up no other one.
    pub async fn read(self: Arc<Self>, network: Caller) {
        let mut turn = interval(STATUS / PARTS);
        turn.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut busy: HashSet<String> = HashSet::new();
        let mut reading: JoinSet<(u64, Reading)> = JoinSet::new();
        loop {
            // who begins to look, or has a new station, does not wait for its part of a second
            let at_once = tokio::select! {
                _ = turn.tick() => self.watched().await,
                () = self.found.notified() => true,
                Some(done) = reading.join_next() => {
                    match done {
                        Ok((restarts, (id, drive, status))) => {
                            busy.remove(&id);
                            let stop = match (&drive, &status) {
                                (Some(drive), Ok(status)) => Some(StopOffer::of(&network, drive, status)),
                                _ => None,
                            };
                            self.note(restarts, &id, drive, status, stop);
                        }
                        // a panic in a reading was printed; its drive is read again
                        Err(_) => busy.clear(),
                    }
                    continue;
                }
            };
            let (restarts, due) = self.due(&busy, Instant::now(), at_once);
            for (id, drive) in due {
                busy.insert(id.clone());
                let status = status(Arc::clone(&self), network.clone(), id, drive);
                reading.spawn(async move { (restarts, status.await) });
            }
        }
    }

    /// Returns the drives to read now, those that wait longest first, with the number of restarts: all that are due, or the share of a
    /// part of the time between two readings.
    fn due(
        &self,
        busy: &HashSet<String>,
        now: Instant,
        at_once: bool,
    ) -> (u64, Vec<(String, Option<Drive>)>) {
        let stations = self.stations();
        let readable = stations.known.iter().filter(|(_, known)| known.is_readable());
        let is_due =
            |read: Option<Instant>| read.is_none_or(|read| now.saturating_duration_since(read) >= REST);
        let mut due: Vec<_> = readable
            .clone()
            .filter(|(id, known)| !busy.contains(*id) && is_due(known.read))
            .collect();
        due.sort_by_key(|(_, known)| known.read);
        let most = match at_once {
            true => AT_ONCE,
            false => readable.count().min(AT_ONCE).div_ceil(PARTS as usize),
        };
        due.truncate(most.min(AT_ONCE.saturating_sub(busy.len())));
        let due = due
            .into_iter()
            .map(|(id, known)| (id.clone(), known.drive.clone()));
        (stations.restarts, due.collect())
    }

    fn note(
        &self,
        restarts: u64,
        id: &str,
        drive: Option<Drive>,
        status: Result<StatusReport, Error>,
        stop: Option<StopOffer>,
    ) {
        let mut stations = self.stations();
        if stations.restarts == restarts
            && let Some(known) = stations.known.get_mut(id)
        {
            known.drive = drive;
            known.status = Some(status);
            known.stop = stop;
            known.read = Some(Instant::now());
        }
        drop(stations);
        self.changed();
    }

    /// Returns what a station is called.
    pub fn name(&self, id: &str) -> Option<String> {
        self.stations().known.get(id)?.scanned.station.name.clone()
    }

    /// Returns the serial number of a station, where it was read.
    pub fn serial(&self, id: &str) -> Option<String> {
        let stations = self.stations();
        let info = stations.known.get(id)?.scanned.info.as_ref()?;
        Some(info.identity.as_ref()?.serial_number.clone())
    }

    /// Finds the drive of a station.
    pub async fn find(&self, network: &mut Caller, id: &str) -> Result<Drive, DriveError> {
        let known = self
            .stations()
            .known
            .get(id)
            .and_then(|known| known.drive.clone());
        if let Some(drive) = known {
            return Ok(drive);
        }
        let address = id.strip_prefix("ip-").unwrap_or(id).parse()?;
        self.opening.find(network, &address, &mut |_| {}).await
    }
}

/// Reads who the drive at an address is.
async fn visit(opening: Opening, mut network: Caller, address: Ipv4Addr) -> (String, Scanned) {
    let found = opening
        .find(&mut network, &DriveAddress::Ip(address), &mut |_| {})
        .await;
    let (station, info) = match found {
        Ok(mut drive) => {
            let info = inspection::info(&mut network, &mut drive).await;
            (
                Station::from(&drive.station),
                info.map_err(|error| error.to_string()),
            )
        }
        Err(error) => {
            let mut station = Station::from(&Default::default());
            station.ip = Some(address.to_string());
            (station, Err(error.to_string()))
        }
    };
    let (info, unread) = match info {
        Ok(info) => (Some(info), None),
        Err(unread) => (None, Some(unread)),
    };
    let scanned = Scanned {
        station,
        remarks: Vec::new(),
        info,
        unread,
    };
    (format!("ip-{address}"), scanned)
}

/// A drive that was read: what it is called, the drive where it is to be read again, and its status.
type Reading = (String, Option<Drive>, Result<StatusReport, Error>);

/// Reads the status of one drive.
async fn status(board: Arc<Board>, mut network: Caller, id: String, drive: Option<Drive>) -> Reading {
    let found = match drive {
        Some(drive) => Ok(drive),
        None => board.find(&mut network, &id).await,
    };
    let mut drive = match found {
        Ok(drive) => drive,
        Err(error) => return (id, None, Err(explained(&error))),
    };
    match inspection::status(&mut network, &mut drive, &PageWords).await {
        Ok(status) => (id, Some(drive), Ok(status.report)),
        // it may be another one next time
        Err(error) => (id, None, Err(explained(&error))),
    }
}

/// Returns an error in the words of the page.
pub(crate) fn explained(error: &impl Explained) -> Error {
    Error::new(
        error.kind(),
        &error.message(),
        &error.details(),
        &error.advice(),
        &PageWords,
    )
}

#[cfg(test)]
mod tests {
    use profidrive::client::ErrorKind;
    use profidrive::report::ScanReport;

    use super::*;

    fn answers(names: &[&str]) -> Vec<(String, Scanned)> {
        let stations = names.iter().map(|name| {
            let mut station = Station::from(&Default::default());
            station.name = Some((*name).to_owned());
            (station, Vec::new())
        });
        let report = ScanReport::new(stations.collect::<Vec<_>>());
        names
            .iter()
            .map(|name| (*name).to_owned())
            .zip(report.stations)
            .collect()
    }

    #[test]
    fn a_station_that_no_longer_answers_is_shown_for_a_while() {
        let start = Instant::now();
        let mut stations = Stations::default();
        stations.survey(answers(&["a", "b"]), start);
        stations.survey(answers(&["a"]), start + SURVEY);
        assert_eq!(stations.known["b"].lost, Some(start + SURVEY));
        assert!(!stations.known["b"].is_readable());
        stations.survey(
            answers(&["a"]),
            start + SURVEY + REMEMBER - Duration::from_secs(1),
        );
        assert_eq!(
            stations.known["b"].lost,
            Some(start + SURVEY),
            "since the first miss"
        );
        stations.survey(answers(&["a", "b"]), start + SURVEY + REMEMBER);
        assert_eq!(stations.known["b"].lost, None);
        stations.survey(answers(&["a"]), start + 2 * REMEMBER);
        stations.survey(answers(&["a"]), start + 3 * REMEMBER);
        assert_eq!(stations.known.len(), 1);
    }

    #[test]
    fn each_of_many_drives_has_its_turn() {
        let names: Vec<String> = (0..AT_ONCE + 7).map(|number| number.to_string()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let board = Board::new(
            Opening::new(profidrive::Access::Records),
            Vec::new(),
            Instant::now(),
        );
        board.stations().survey(answers(&names), Instant::now());
        let mut busy = HashSet::new();
        let now = Instant::now();
        let due = |busy: &HashSet<String>, now, at_once| -> Vec<String> {
            let (_, due) = board.due(busy, now, at_once);
            due.into_iter().map(|(id, _)| id).collect()
        };
        let first = due(&busy, now, true);
        assert_eq!(first.len(), AT_ONCE);
        busy.extend(first.iter().cloned());
        assert!(due(&busy, now, true).is_empty(), "no more at once");
        for id in first {
            busy.remove(&id);
            board.stations().known.get_mut(&id).unwrap().read = Some(now);
        }
        assert_eq!(due(&busy, now, true).len(), 7, "those that were never read");
        // a second later all of them are due, and divided among the parts of a second
        for part in 0..PARTS {
            let now = now + STATUS + part * STATUS / PARTS;
            let some = due(&busy, now, false);
            assert!(some.len() <= 4, "{some:?}");
            for id in &some {
                board.stations().known.get_mut(id).unwrap().read = Some(now);
            }
        }
        let stations = board.stations();
        let mut reads = stations.known.values().map(|known| known.read);
        assert!(
            reads.all(|read| read >= Some(now + STATUS)),
            "each has had its turn"
        );
    }

    #[test]
    fn a_restart_forgets_the_stations_and_what_is_on_its_way_from_them() {
        let opening = Opening::new(profidrive::Access::Records);
        let board = Board::new(opening, Vec::new(), Instant::now());
        board.stations().survey(answers(&["a"]), Instant::now());
        let (before, _) = board.due(&HashSet::new(), Instant::now(), true);
        assert_eq!(board.restart(|_| Err(7)), Err(7));
        assert_eq!(board.name("a").as_deref(), Some("a"), "nothing was started");
        let mut before_it = None;
        let started = board.restart(|restarts| {
            before_it = Some(restarts);
            Ok::<_, u8>(())
        });
        assert_eq!((before_it, started), (Some(0), Ok(1)));
        assert_eq!(board.name("a"), None);
        board.stations().survey(answers(&["a"]), Instant::now());
        let failed = || Err(Error::new(ErrorKind::Lost, "", &[], &"".into(), &PageWords));
        board.note(before, "a", None, failed(), None);
        assert!(
            board.stations().known["a"].read.is_none(),
            "it is of another drive"
        );
        board.note(board.restarts(), "a", None, failed(), None);
        assert!(board.stations().known["a"].read.is_some());
    }

    #[test]
    fn stations_are_bounded() {
        let names: Vec<String> = (0..STATIONS + 7).map(|number| number.to_string()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut stations = Stations::default();
        assert_eq!(stations.survey(answers(&names), Instant::now()), 7);
        assert_eq!(stations.known.len(), STATIONS);
    }
}
