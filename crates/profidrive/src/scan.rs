//! Which stations are on a network: found, read, and watched as they come and go. Nothing is changed.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use std::time::Duration;
//!
//! use profidrive::report::Remark;
//! use profidrive::{Wait, scan};
//!
//! let plant = r#"
//!     [[drive]]
//!     name = "akd-1"
//!     ip = "192.168.0.11/24"
//!     [[drive]]
//!     name = "akd-2"
//! "#;
//! let mut network = profidrive::open_plan(plant.parse()?)?;
//! let found = scan::survey(&mut network, Duration::from_secs(1), &mut |_, _| {}).wait()?;
//! let [akd, fresh] = found.report.stations.as_slice() else {
//!     panic!("{found:?}");
//! };
//! assert_eq!(fresh.remarks, [Remark::NoAddress]);
//! assert_eq!(akd.station.vendor, Some("Kollmorgen"));
//! let identity = akd.info.as_ref().and_then(|info| info.identity.as_ref()).ok_or("not read")?;
//! assert!(identity.software_revision.starts_with('V'));
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::collections::BTreeMap;
use std::time::Duration;

use client::{Drive, Error, ErrorKind, Session};
use futures::{StreamExt, stream};
use network::system::NeighbourTable;
use profinet::controller::Station as Answer;
use profinet::wire::dcp::role;
use profinet::{Instant, MacAddress};

use crate::fleet::AT_ONCE;
use crate::open::{Caller, Transport};
use crate::reach::{Reach, reach};
use crate::report::{Change, Remark, ScanReport, Station, StationChange};
use crate::{Outcome, Reported, inspection};

/// Rounds of discovery that a station may miss before it counts as gone: an answer can be lost.
const MISSED: u8 = 3;

/// Finds all stations that answer within `time`, by name and address. Where none does, the outcome is
/// [`Outcome::NoAnswer`]; [`ScanReport::duplicates`] has the names and addresses of more than one station.
///
/// # Errors
/// When the medium fails or the caller requests a stop.
pub async fn discover(network: &mut Caller, time: Duration) -> Result<Reported<ScanReport>, Error> {
    let found = network.scan(time).await?;
    let mut report = of_answers(network, &found.stations);
    report.more = found.more;
    Ok(reported(report))
}

/// Finds all stations as [`discover`], then reads who each of them is, all at the same time: its firmware, its serial number,
/// its state, its controller and its neighbours. What cannot be read is in [`Scanned::unread`](crate::report::Scanned::unread).
/// `progress` gets how many of how many have been read.
///
/// # Errors
/// When the medium fails or the caller requests a stop.
pub async fn survey(
    network: &mut Caller,
    time: Duration,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<Reported<ScanReport>, Error> {
    let found = network.scan(time).await?;
    let mut read = described(network, &found.stations, &found.stations, progress).await?;
    read.report.more = found.more;
    Ok(read)
}

/// Reads who each of the stations is that are meant among all that answered: see [`survey`].
pub(crate) async fn described(
    network: &mut Caller,
    all: &[Answer],
    meant: &[Answer],
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<Reported<ScanReport>, Error> {
    let mut report = of_answers(network, all);
    // what is there twice is known from all of them
    let wanted = |mac: &str| meant.iter().any(|answer| answer.mac.to_string() == mac);
    report.stations.retain(|one| wanted(&one.station.mac));
    let answers = meant;
    let without_address = match network.transport() {
        Transport::Packet(info) if !info.ip().is_set() => Some(&info.name),
        _ => None,
    };
    let readable = |&(at, answer): &(usize, &Answer)| {
        let unreadable = [Remark::NoAddress, Remark::OtherSubnet, Remark::AddressTwice];
        let remarks = report.stations.get(at).map(|one| one.remarks.as_slice());
        // a controller and a tool for commissioning have no records
        answer.role & role::DEVICE != 0
            && !remarks
                .unwrap_or_default()
                .iter()
                .any(|remark| unreadable.contains(remark))
    };
    let wanted = answers.iter().enumerate().filter(readable);
    let wanted: Vec<(usize, Drive)> = wanted
        .map(|(at, answer)| (at, Drive::new(answer.clone())))
        .collect();
    if let Some(name) = without_address {
        for (at, _) in &wanted {
            if let Some(one) = report.stations.get_mut(*at) {
                one.unread = Some(format!("this computer has no IP address on {name}"));
            }
        }
        return Ok(reported(report));
    }
    let session: &Session = network;
    let all = wanted.len();
    let mut reading = stream::iter(wanted)
        .map(|(at, mut drive)| {
            let mut session = session.clone();
            async move { (at, inspection::look(&mut session, &mut drive).await) }
        })
        .buffer_unordered(AT_ONCE);
    let mut done = 0;
    progress(done, all);
    while let Some((at, info)) = reading.next().await {
        done += 1;
        progress(done, all);
        let Some(one) = report.stations.get_mut(at) else {
            continue;
        };
        match info {
            Ok((info, unanswered)) => {
                one.info = Some(info);
                one.unread = (!unanswered.is_empty()).then(|| unanswered.join("; "));
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => return Err(error),
            Err(error) => one.unread = Some(error.to_string()),
        }
    }
    drop(reading);
    Ok(reported(report))
}

/// Returns what is to be known where the kernel has no room for the addresses of all stations that were found: some of them
/// cannot be read.
#[must_use]
pub fn crowded(network: &Caller, report: &ScanReport) -> Option<String> {
    let Transport::Packet(_) = network.transport() else {
        return None;
    };
    let stations = report.stations.iter().filter(|one| one.station.ip.is_some());
    too_many(NeighbourTable::of_kernel()?, stations.count())
}

fn too_many(table: NeighbourTable, stations: usize) -> Option<String> {
    let NeighbourTable { held, most } = table;
    let found = match stations > most {
        true => format!("{stations} stations have one"),
        false if table.is_full() => format!("{held} are in use"),
        false => return None,
    };
    let remedy = table.enlarged_for(stations);
    Some(format!(
        "this computer has room for the addresses of {most} stations, and {found}: some do not answer; {remedy} makes room"
    ))
}

fn reported(report: ScanReport) -> Reported<ScanReport> {
    let outcome = if report.stations.is_empty() {
        Outcome::NoAnswer
    } else {
        Outcome::Complete
    };
    Reported { report, outcome }
}

pub(crate) fn of_answers(network: &Caller, answers: &[Answer]) -> ScanReport {
    let place = network.transport().place();
    let remarked = answers.iter().map(|answer| {
        let other = place.and_then(|(name, own)| match reach(name, own, &answer.name, answer.ip) {
            Ok(Reach::Near) => None,
            Ok(Reach::Routed(_)) => Some(Remark::Routed),
            Err(_) => Some(Remark::OtherSubnet),
        });
        let remarks = [
            answer.name.is_empty().then_some(Remark::NoName),
            (!answer.ip.is_set()).then_some(Remark::NoAddress),
            answer.ip_conflict.then_some(Remark::Conflict),
            other,
        ];
        (Station::from(answer), remarks.into_iter().flatten().collect())
    });
    ScanReport::new(remarked)
}

/// Stations that come, go, and change their name or address, as rounds of discovery tell them.
///
/// ```
/// # #[cfg(feature = "simulate")] {
/// use std::time::Duration;
///
/// use profidrive::Wait;
/// use profidrive::report::Change;
/// use profidrive::scan::Watch;
///
/// let plant = r#"
///     [[drive]]
///     name = "akd-1"
///     ip = "192.168.0.11/24"
///     event = [{ at = "10s", do = "cable=pulled" }]
/// "#;
/// let mut network = profidrive::open_plan(plant.parse()?)?;
/// let mut watch = Watch::default();
/// let mut seen = Vec::new();
/// for _ in 0..20 {
///     seen.extend(watch.next(&mut network, Duration::from_secs(1)).wait()?);
/// }
/// assert_eq!(seen.iter().map(|one| one.change).collect::<Vec<_>>(), [Change::Came, Change::Went]);
/// # }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct Watch {
    known: BTreeMap<MacAddress, Known>,
    begin: Option<Instant>,
}

#[derive(Debug)]
struct Known {
    station: Answer,
    missed: u8,
}

impl Watch {
    /// Listens for `time` and returns what is different from before; in the first round all stations came. A station that
    /// does not answer in three rounds is gone.
    ///
    /// # Errors
    /// When the medium fails or the caller requests a stop.
    pub async fn next(&mut self, network: &mut Caller, time: Duration) -> Result<Vec<StationChange>, Error> {
        let begin = *self.begin.get_or_insert(network.now());
        let answers = network.scan(time).await?.stations;
        Ok(self.compare(answers, network.now() - begin))
    }

    fn compare(&mut self, answers: Vec<Answer>, time: Duration) -> Vec<StationChange> {
        let changed = |change, station: &Answer, before: Option<&Answer>| StationChange {
            time: time.as_secs_f64(),
            change,
            station: Station::from(station),
            before: before.map(Station::from),
        };
        let mut changes = Vec::new();
        for known in self.known.values_mut() {
            known.missed += 1;
        }
        for station in answers {
            let before = self.known.get(&station.mac).map(|known| &known.station);
            match before {
                None => changes.push(changed(Change::Came, &station, None)),
                Some(before) if (&before.name, before.ip) != (&station.name, station.ip) => {
                    changes.push(changed(Change::Changed, &station, Some(before)));
                }
                Some(_) => {}
            }
            self.known.insert(station.mac, Known { station, missed: 0 });
        }
        self.known.retain(|_, known| {
            let gone = known.missed >= MISSED;
            if gone {
                changes.push(changed(Change::Went, &known.station, None));
            }
            !gone
        });
        changes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_stations_than_the_kernel_has_room_for_are_reported_with_the_setting() {
        let of = |held, stations| too_many(NeighbourTable { held, most: 1024 }, stations);
        assert_eq!(of(0, 1024), None);
        assert_eq!(
            of(0, 2000).as_deref(),
            Some(
                "this computer has room for the addresses of 1024 stations, and 2000 stations have one: some do not answer; \
                 sysctl -w net.ipv4.neigh.default.gc_thresh3=4096 makes room"
            )
        );
        assert!(of(1024, 3).is_some_and(|text| text.contains("1024 are in use")));
    }

    #[test]
    fn an_answer_that_is_lost_is_not_a_station_that_went() {
        let station = |last, name: &str| Answer {
            mac: MacAddress([2, 0, 0, 0, 0, last]),
            name: name.into(),
            ..Default::default()
        };
        let mut watch = Watch::default();
        let mut round = |answers: Vec<Answer>| -> Vec<(Change, Option<String>)> {
            let changes = watch.compare(answers, Duration::ZERO);
            changes
                .into_iter()
                .map(|one| (one.change, one.station.name))
                .collect()
        };
        let named = |name: &str| Some(name.to_owned());
        assert_eq!(
            round(vec![station(1, "a"), station(2, "b")]),
            [(Change::Came, named("a")), (Change::Came, named("b"))]
        );
        assert_eq!(round(vec![station(1, "a")]), []);
        assert_eq!(round(vec![station(1, "a")]), []);
        assert_eq!(
            round(vec![station(1, "c"), station(2, "b")]),
            [(Change::Changed, named("c"))]
        );
        for _ in 1..MISSED {
            assert_eq!(round(vec![station(1, "c")]), []);
        }
        assert_eq!(round(vec![station(1, "c")]), [(Change::Went, named("b"))]);
        assert_eq!(
            round(vec![station(1, "c"), station(2, "b")]),
            [(Change::Came, named("b"))]
        );
    }
}
