//! Many drives at once: selected, found, and worked on side by side.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use profidrive::fleet;
//! use profidrive::{Access, DriveError, Opening, Wait, parameters};
//!
//! let plant = r#"
//!     [[drive]]
//!     name = "akd-1"
//!     ip = "192.168.0.11/24"
//!     [[drive]]
//!     name = "akd-2"
//!     ip = "192.168.0.12/24"
//! "#;
//! let opening = Opening::new(Access::Records).in_plant(plant.parse()?);
//! let mut network = opening.clone().open()?;
//! let selected = opening.select(&mut network, &"akd-*".parse()?).wait()?;
//! let ramp = ["DRV.ACC".parse()?];
//! let answers = fleet::each(&network, selected.members, async |session, drive| {
//!     parameters::read(session, drive, &ramp).await.map_err(DriveError::from)
//! });
//! for member in answers.wait() {
//!     let values = member.result?;
//!     println!("{} has {} values", member.name, values.readings.len());
//! }
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod kind;
mod write;

use std::cmp::Ordering;
use std::time::Duration;

use client::{Discovered, Drive, DriveAddress, Error, Session, StopWay};
use futures::channel::mpsc;
use futures::{StreamExt, stream};
use profinet::controller::Station;

use crate::drive::{DriveError, FindEvent};
use crate::motion::{self, MotionError, StopReport};
use crate::open::{Access, Caller, Network, OpenError, Opening, Transport};
use crate::selector::{Group, Selector, Term};

pub use kind::kind_of;
pub use write::{WritePlan, WrittenMembers, plan_write};

/// Drives that are worked on at the same time. Each has a connection of its own; the others wait for their turn.
pub const AT_ONCE: usize = 64;

/// Time for all stations to answer.
const SEARCH: Duration = Duration::from_secs(1);

/// Time for the first answer of one drive of many to a parameter request: one that is silent holds up the others no longer.
pub const FIRST_ANSWER: Duration = Duration::from_secs(2);

/// The drives of a selection.
#[derive(Debug)]
pub struct Fleet {
    /// In the order of the selector; those of a pattern by name.
    pub members: Vec<Selected>,
    /// Stations that fit a pattern, a model, a vendor or `all`, and are no drives.
    pub left_out: Vec<String>,
}

/// A drive of a selection.
#[derive(Debug)]
pub struct Selected {
    /// Its name, or the part of the selector that found nothing.
    pub name: String,
    /// What is to be known about it: the router between it and this computer.
    pub notes: Vec<String>,
    /// The drive, ready to be worked with, or why it is not.
    pub drive: Result<Drive, DriveError>,
}

/// What became of the work on one drive.
#[derive(Debug)]
pub struct Member<T> {
    /// The name of the drive, or the part of the selector that found nothing.
    pub name: String,
    /// The drive as it was when the work ended; `None` where there was none.
    pub drive: Option<Drive>,
    /// What came of it.
    pub result: T,
}

/// What is to be found.
enum Wanted {
    Address(DriveAddress),
    Station(Box<Station>),
    Nothing { name: String, error: DriveError },
}

impl Opening {
    /// Opens the network of the drives that a selector means: as [`open_to`](Self::open_to) for one. UDP alone is enough for
    /// the records of drives that are all given by their IP addresses.
    ///
    /// # Errors
    /// As [`open`](Self::open) and [`open_to`](Self::open_to).
    pub fn open_for(&self, selector: &Selector) -> Result<Network, OpenError> {
        if let Some(address) = selector.single() {
            return self.open_to(address);
        }
        let records = !matches!(self.access, Access::Discovery | Access::Cyclic);
        let by_ip = records && selector.is_by_ip();
        self.clone().by_ip(by_ip).open()
    }

    /// Finds the drives that a selector means, all at the same time: one that does not answer takes no time of the others.
    /// A drive that cannot be worked with is in the result with the reason.
    ///
    /// # Errors
    /// When the network fails or the caller requests a stop.
    pub async fn select(&self, network: &mut Caller, selector: &Selector) -> Result<Fleet, DriveError> {
        let transport = network.transport().clone();
        let searched = selector.terms().iter().any(|term| matches!(term, Term::Group(_)));
        let answered = if searched {
            network.scan(SEARCH).await?
        } else {
            Discovered::default()
        };
        let wanted = wanted(selector, &answered);
        let session: &Session = network;
        let found = stream::iter(wanted).map(|wanted| {
            let mut session = of_many(session);
            let transport = &transport;
            async move { self.found(&mut session, transport, wanted).await }
        });
        let found: Vec<(bool, Selected)> = found.buffered(AT_ONCE).collect().await;
        let mut fleet = Fleet {
            members: Vec::new(),
            left_out: Vec::new(),
        };
        for (named, selected) in found {
            match &selected.drive {
                Err(DriveError::Client(Error::NotADrive { .. })) if !named => {
                    fleet.left_out.push(selected.name);
                }
                Ok(drive) if fleet.has(drive) => {}
                _ => fleet.members.push(selected),
            }
        }
        Ok(fleet)
    }

    /// Finds one of them, and says whether it was given by its own name or address.
    async fn found(&self, session: &mut Session, transport: &Transport, wanted: Wanted) -> (bool, Selected) {
        let mut notes = Vec::new();
        let mut observer = |event: FindEvent<'_>| {
            if let FindEvent::Routed(words) = event {
                notes.push(words.to_owned());
            }
        };
        let (named, name, drive) = match wanted {
            Wanted::Address(address) => {
                let found = self.find_over(session, transport, &address, &mut observer).await;
                (true, address.to_string(), found)
            }
            Wanted::Station(station) => {
                let drive = Drive::new(*station);
                let name = drive.label();
                let ready = self.ready(session, transport, drive, &mut observer).await;
                (false, name, ready)
            }
            Wanted::Nothing { name, error } => (true, name, Err(error)),
        };
        let name = drive.as_ref().map_or(name, Drive::label);
        (named, Selected { name, notes, drive })
    }
}

/// Brings the drives that a selector means to rest, each as soon as it is found: see [`motion::stop`]. No drive waits for
/// another one, nor for the search to end.
///
/// # Errors
/// When the network fails or the caller requests a stop. What became of each drive is in its member.
pub async fn stop(
    opening: &Opening,
    network: &mut Caller,
    selector: &Selector,
    way: StopWay,
    limit: Duration,
) -> Result<Vec<Member<Result<StopReport, StopError>>>, DriveError> {
    let transport = network.transport().clone();
    let (found, stations) = mpsc::unbounded();
    let (groups, addresses): (Vec<&Term>, Vec<&Term>) = selector
        .terms()
        .iter()
        .partition(|term| matches!(term, Term::Group(_)));
    let send = |wanted| {
        // the receiver lives as long as the search
        let _ = found.unbounded_send(wanted);
    };
    for term in &addresses {
        if let Term::Address(address) = term {
            send(Wanted::Address(address.clone()));
        }
    }
    let mut fitting = vec![0_usize; groups.len()];
    let mut answered = Vec::new();
    let mut search = (**network).clone();
    let searching = async {
        let mut searched = Ok(false);
        if !groups.is_empty() {
            let each = |station: &Station| {
                answered.push(label(station));
                let mut meant = false;
                for (count, group) in fitting.iter_mut().zip(&groups) {
                    let means = matches!(group, Term::Group(group) if group.means(station));
                    *count += usize::from(means);
                    meant |= means;
                }
                if meant && !addresses.iter().any(|term| term.means(station)) {
                    send(of_station(station, &[]));
                }
            };
            searched = search.scan_quickly(each).await;
        }
        if matches!(searched, Ok(true)) {
            let groups = groups.iter().filter_map(|term| term.group());
            send(more_than(groups, answered.len()));
        }
        for (term, _) in groups.iter().zip(&fitting).filter(|(_, count)| **count == 0) {
            if let Term::Group(group) = term {
                send(none_of(group, answered.clone()));
            }
        }
        // whatever came of the search: those that wait for more would wait for ever
        found.close_channel();
        searched
    };
    let session: &Session = network;
    let stopping = stations.map(|wanted| {
        let (mut session, transport) = (session.clone(), &transport);
        async move {
            let (named, Selected { name, drive, .. }) = opening.found(&mut session, transport, wanted).await;
            let (drive, result) = match drive {
                Ok(mut drive) => {
                    let result = motion::stop(&mut session, &mut drive, way, limit).await;
                    (Some(drive), result.map_err(StopError::from))
                }
                Err(error) => (None, Err(error.into())),
            };
            (named, Member { name, drive, result })
        }
    });
    let stopping = stopping.buffer_unordered(AT_ONCE).collect::<Vec<_>>();
    let (searched, stopped) = futures::join!(searching, stopping);
    searched?;
    let is_none = |member: &Member<Result<StopReport, StopError>>| match &member.result {
        Err(StopError::Drive(DriveError::Client(error)))
        | Err(StopError::Motion(MotionError::Client(error))) => {
            matches!(error, Error::NotADrive { .. })
        }
        _ => false,
    };
    let mut members: Vec<_> = stopped
        .into_iter()
        .filter(|(named, member)| *named || !is_none(member))
        .map(|(_, member)| member)
        .collect();
    members.sort_by(|a, b| natural(&a.name, &b.name));
    Ok(members)
}

/// Why a drive of many was not stopped.
#[derive(Debug, thiserror::Error)]
pub enum StopError {
    /// It could not be worked with.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// It has no means to be stopped from here, or was lost.
    #[error(transparent)]
    Motion(#[from] MotionError),
}

impl Fleet {
    /// Returns whether a drive is among the members already.
    fn has(&self, drive: &Drive) -> bool {
        let id = |drive: &Drive| (drive.station.mac, drive.station.ip.address);
        let members = self
            .members
            .iter()
            .filter_map(|member| member.drive.as_ref().ok());
        members.map(id).any(|member| member == id(drive))
    }
}

/// Works on drives side by side, [`AT_ONCE`] at most, and returns what came of it in their order. Each drive has a caller of
/// its own, so that one that does not answer holds up none of the others.
pub async fn each<T, E: From<DriveError>>(
    session: &Session,
    members: Vec<Selected>,
    work: impl AsyncFn(&mut Session, &mut Drive) -> Result<T, E>,
) -> Vec<Member<Result<T, E>>> {
    let work = &work;
    let all = stream::iter(members).map(|Selected { name, drive, .. }| {
        let mut session = of_many(session);
        async move {
            match drive {
                Ok(mut drive) => {
                    // in a box: work on a drive has thousands of octets, and that of many would be moved from place to place
                    let result = Box::pin(work(&mut session, &mut drive)).await;
                    let drive = Some(drive);
                    Member { name, drive, result }
                }
                Err(error) => Member {
                    name,
                    drive: None,
                    result: Err(error.into()),
                },
            }
        }
    });
    all.buffered(AT_ONCE).collect().await
}

/// Returns a caller for one drive of many.
pub(crate) fn of_many(session: &Session) -> Session {
    let mut session = session.clone();
    session.expect_first_answer_within(FIRST_ANSWER);
    session
}

/// Returns what is to be found, each once, and with the groups of a search that was not complete that this is so.
fn wanted(selector: &Selector, found: &Discovered) -> Vec<Wanted> {
    let answered = &found.stations[..];
    let mut taken: Vec<&Station> = Vec::new();
    let mut wanted = Vec::new();
    for term in selector.terms() {
        let group = match term {
            Term::Address(address) => {
                wanted.push(Wanted::Address(address.clone()));
                continue;
            }
            Term::Group(group) => group,
        };
        let mut fitting: Vec<&Station> = answered.iter().filter(|station| group.means(station)).collect();
        if fitting.is_empty() {
            wanted.push(none_of(group, answered.iter().map(label).collect()));
        }
        fitting.retain(|station| !taken.contains(station));
        fitting.sort_by(|a, b| natural(&a.name, &b.name).then(a.mac.cmp(&b.mac)));
        wanted.extend(fitting.iter().map(|station| of_station(station, answered)));
        taken.extend(fitting);
    }
    if found.more {
        let groups = selector.terms().iter().filter_map(Term::group);
        wanted.push(more_than(groups, answered.len()));
    }
    wanted
}

/// Drives that no one has found must not be passed over in silence: neither a stop nor a write has reached them.
fn more_than<'g>(groups: impl Iterator<Item = &'g Group>, taken: usize) -> Wanted {
    let groups: Vec<String> = groups.map(ToString::to_string).collect();
    let term = groups.join(",");
    Wanted::Nothing {
        name: term.clone(),
        error: DriveError::MoreStations { term, taken },
    }
}

fn none_of(group: &Group, answered: Vec<String>) -> Wanted {
    Wanted::Nothing {
        name: group.to_string(),
        error: DriveError::NoneFits {
            term: group.to_string(),
            answered,
        },
    }
}

/// A station whose name or address another one has cannot be distinguished from that one.
fn of_station(station: &Station, answered: &[Station]) -> Wanted {
    let nothing = |error| Wanted::Nothing {
        name: label(station),
        error,
    };
    let same = |fits: &dyn Fn(&Station) -> bool| -> Vec<_> {
        let same = answered.iter().filter(|other| fits(other));
        same.map(|other| other.mac).collect()
    };
    let ambiguous = |address, macs| nothing(Error::Ambiguous { drive: address, macs }.into());
    let names = same(&|other| !other.name.is_empty() && other.name == station.name);
    if names.len() > 1 {
        return ambiguous(DriveAddress::Name(station.name.clone()), names);
    }
    if !station.ip.is_set() {
        return nothing(DriveError::NoAddress {
            drive: label(station),
        });
    }
    let addresses = same(&|other| other.ip.address == station.ip.address);
    if addresses.len() > 1 {
        return ambiguous(DriveAddress::Ip(station.ip.address), addresses);
    }
    Wanted::Station(Box::new(station.clone()))
}

fn label(station: &Station) -> String {
    Drive::new(station.clone()).label()
}

/// Compares names as people count: `akd-2` before `akd-10`.
fn natural(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a, b);
    loop {
        let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
        let (left, right) = (digits(a), digits(b));
        if left > 0 && right > 0 {
            let number = |text: &str| text.trim_start_matches('0').to_owned();
            let (x, y) = (number(&a[..left]), number(&b[..right]));
            let order = x
                .len()
                .cmp(&y.len())
                .then_with(|| x.cmp(&y))
                .then(left.cmp(&right));
            if order.is_ne() {
                return order;
            }
            (a, b) = (&a[left..], &b[right..]);
            continue;
        }
        let (Some(x), Some(y)) = (a.chars().next(), b.chars().next()) else {
            return a.len().cmp(&b.len());
        };
        if x != y {
            return x.cmp(&y);
        }
        (a, b) = (&a[x.len_utf8()..], &b[y.len_utf8()..]);
    }
}

#[cfg(test)]
mod tests {
    use client::ErrorKind;
    use profinet::IpSuite;

    use super::*;

    /// Without an error it would seem that all drives were reached.
    #[test]
    fn a_search_that_was_not_complete_is_an_error_of_its_groups() {
        let station = Station {
            name: "akd-1".into(),
            ip: IpSuite {
                address: [192, 168, 0, 11].into(),
                ..IpSuite::NONE
            },
            ..Station::default()
        };
        let mut found = Discovered {
            stations: vec![station],
            more: true,
        };
        let selector: Selector = "akd-*,192.168.0.11,all".parse().unwrap();
        let errors = |found: &Discovered| -> Vec<(String, DriveError)> {
            let wanted = wanted(&selector, found).into_iter();
            let nothing = wanted.filter_map(|wanted| match wanted {
                Wanted::Nothing { name, error } => Some((name, error)),
                _ => None,
            });
            nothing.collect()
        };
        let of_incomplete = errors(&found);
        let [(name, error @ DriveError::MoreStations { taken: 1, .. })] = of_incomplete.as_slice() else {
            panic!("{of_incomplete:?}");
        };
        assert_eq!((name.as_str(), error.kind()), ("akd-*,all", ErrorKind::Partial));
        found.more = false;
        assert!(errors(&found).is_empty());
    }

    #[test]
    fn names_are_sorted_as_people_count() {
        let mut names = ["akd-10", "akd-2", "b", "akd-1", "akd", "akd-02", "akd-2a", ""];
        names.sort_by(|a, b| natural(a, b));
        assert_eq!(
            names,
            ["", "akd", "akd-1", "akd-2", "akd-2a", "akd-02", "akd-10", "b"]
        );
    }
}
