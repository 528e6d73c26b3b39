//! Loss and latency of the way to each station.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use client::{Advice, DriveAddress, Error};
use profinet::MacAddress;
use profinet::controller::Station as Answer;

use super::unless_stopped;
use crate::inspection;
use crate::open::Caller;
use crate::report::{Check, DoctorReport, Finding, LinkReport, Severity, Wording};
use crate::selector::Term;
use crate::{Part, Selector, Step};

/// Requests to each station.
const ROUNDS: usize = 40;
/// How long an answer may take; a station answers to this request at once.
const LIMIT: Duration = Duration::from_millis(100);
/// One of so many requests waits for stations that are not known yet, for the whole limit; the others end with the last
/// answer that is expected, before a slower station that the search has lost could join.
const ROUNDS_EACH_SEARCH: usize = 5;
/// Between two requests: loss comes in bursts.
const PAUSE: Duration = Duration::from_millis(20);
/// Added for each station: all of them answer at once, which a network that is at work has to carry too.
const PAUSE_FOR_EACH: Duration = Duration::from_millis(2);
/// The longest time between two requests.
const LONGEST_PAUSE: Duration = Duration::from_secs(1);
/// Stations that are measured at most.
const MAX_STATIONS: usize = 4096;
/// From this part of lost requests on connections do not last.
const HEAVY: f64 = 0.1;

/// Returns the time between two requests that so many stations answer.
fn pause(stations: usize) -> Duration {
    let stations = u32::try_from(stations).unwrap_or(u32::MAX);
    (PAUSE + PAUSE_FOR_EACH.saturating_mul(stations)).min(LONGEST_PAUSE)
}

/// What was measured of the way to the stations.
#[derive(Default)]
pub(super) struct Measured {
    rounds: usize,
    times: BTreeMap<MacAddress, Vec<Duration>>,
}

/// Sends requests that are not repeated to the stations that are known, and counts the answers of each. A station that the
/// search before has lost joins them.
pub(super) async fn measure(
    network: &mut Caller,
    known: &mut Vec<Answer>,
    progress: &mut (dyn FnMut(Step) + Send),
) -> Result<Measured, Error> {
    let mut measured = Measured::default();
    while measured.rounds < ROUNDS {
        progress(Step::counted(Part::Requests, measured.rounds, ROUNDS));
        let expected = match measured.rounds % ROUNDS_EACH_SEARCH {
            0 => usize::MAX,
            _ => known.len().max(1),
        };
        let Ok(answers) = unless_stopped(network.identify_once(expected, LIMIT).await)? else {
            break;
        };
        measured.take(answers, known);
        network.pass(pause(known.len())).await?;
    }
    Ok(measured)
}

impl Measured {
    /// Takes the answers to one request.
    fn take(&mut self, answers: Vec<(Answer, Duration)>, known: &mut Vec<Answer>) {
        self.rounds += 1;
        for (answer, time) in answers {
            if !known.iter().any(|one| one.mac == answer.mac) {
                if known.len() >= MAX_STATIONS {
                    continue;
                }
                known.push(answer.clone());
            }
            self.times.entry(answer.mac).or_default().push(time);
        }
    }

    /// Whether so many requests to a station are lost that reading it would take long.
    pub(super) fn is_heavy(&self, station: &Answer) -> bool {
        let answers = self.times.get(&station.mac).map_or(0, Vec::len);
        is_heavy(self.rounds.saturating_sub(answers), self.rounds)
    }

    /// Reports the way to each of these stations.
    pub(super) fn report(mut self, meant: &[Answer], report: &mut DoctorReport, wording: &dyn Wording) {
        for station in meant {
            let times = self.times.remove(&station.mac).unwrap_or_default();
            let label = client::Drive::new(station.clone()).label();
            let link = link(label, Some(station.mac.to_string()), self.rounds, times);
            report.findings.push(judged(&link, wording));
            report.links.push(link);
        }
    }
}

fn link(drive: String, mac: Option<String>, requests: usize, mut times: Vec<Duration>) -> LinkReport {
    times.sort_unstable();
    LinkReport {
        drive,
        mac,
        requests,
        answers: times.len(),
        median: times.get(times.len() / 2).map(Duration::as_secs_f64),
        max: times.last().map(Duration::as_secs_f64),
    }
}

fn is_heavy(lost: usize, requests: usize) -> bool {
    lost > 0 && lost as f64 >= requests as f64 * HEAVY
}

fn judged(link: &LinkReport, wording: &dyn Wording) -> Finding {
    let lost = link.requests.saturating_sub(link.answers);
    let times = match (link.median, link.max) {
        (Some(median), Some(max)) => format!(
            "answers after {:.1} ms in the median, {:.1} ms at most",
            median * 1e3,
            max * 1e3
        ),
        _ => "no answer".to_owned(),
    };
    if lost == 0 {
        let found = format!("{} requests, none lost, {times}", link.requests);
        return Finding::new(Check::Loss, Severity::Ok, found).about(&link.drive);
    }
    let found = format!(
        "packet loss: {lost} of {} requests without an answer ({:.0} %), {times}",
        link.requests,
        lost as f64 / link.requests as f64 * 1e2
    );
    let severity = if is_heavy(lost, link.requests) {
        Severity::Error
    } else {
        Severity::Warning
    };
    Finding::new(Check::Loss, severity, found)
        .about(&link.drive)
        .because("a cyclic connection ends after three lost frames in a row; records are repeated and become slow")
        .remedied(
            &Advice::from("check cable, plugs and shield, half duplex at a switch, other traffic on the network; {choose cycle} allows for longer gaps"),
            wording,
        )
}

/// Examines drives that are given by their IP addresses, without permission for raw Ethernet: whether they can be read.
pub(super) async fn by_udp(
    network: &mut Caller,
    selector: Option<&Selector>,
    report: &mut DoctorReport,
    wording: &(dyn Wording + Sync),
    progress: &mut (dyn FnMut(Step) + Send),
) -> Result<(), Error> {
    let terms = selector.map_or(&[][..], Selector::terms);
    let unchecked = "names, duplicates, loss and neighbours need raw Ethernet";
    report
        .findings
        .push(Finding::new(Check::Stations, Severity::Unchecked, unchecked));
    for (at, term) in terms.iter().enumerate() {
        progress(Step::counted(Part::Identities, at, terms.len()));
        let Term::Address(address @ DriveAddress::Ip(_)) = term else {
            continue;
        };
        let begin = Instant::now();
        let read = match network.find(address).await {
            Ok(mut drive) => inspection::info(network, &mut drive).await,
            Err(error) => Err(error),
        };
        let finding = match unless_stopped(read)? {
            Ok(_) => {
                let found = format!("read by UDP in {:.0} ms", begin.elapsed().as_secs_f64() * 1e3);
                Finding::new(Check::Records, Severity::Ok, found)
            }
            Err(error) => {
                let advice = error.advice().unwrap_or_default();
                Finding::new(Check::Records, Severity::Error, error.to_string()).remedied(&advice, wording)
            }
        };
        report.findings.push(finding.about(address.to_string()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::PlainWording;

    #[test]
    fn a_station_that_the_search_lost_joins_and_ever_new_stations_are_bounded() {
        let answer = |number: u32| {
            let [a, b, c, d] = number.to_be_bytes();
            let station = Answer {
                mac: MacAddress([2, 0, a, b, c, d]),
                ..Answer::default()
            };
            (station, Duration::from_millis(1))
        };
        let mut known = vec![answer(0).0];
        let mut measured = Measured::default();
        measured.take(vec![answer(0), answer(1)], &mut known);
        measured.take(vec![answer(0)], &mut known);
        assert_eq!((known.len(), measured.rounds), (2, 2));
        let mut report = report();
        let heavy: Vec<bool> = known.iter().map(|one| measured.is_heavy(one)).collect();
        assert_eq!(heavy, [false, true]);
        measured.report(&known, &mut report, &PlainWording);
        let counts: Vec<_> = report
            .links
            .iter()
            .map(|link| (link.answers, link.requests))
            .collect();
        assert_eq!(counts, [(2, 2), (1, 2)]);
        assert_eq!(report.findings.len(), 2);

        let mut measured = Measured::default();
        for round in 0..3 {
            let of_round = (0..2000).map(|number| answer(round * 2000 + number));
            measured.take(of_round.collect(), &mut known);
        }
        assert_eq!((known.len(), measured.times.len()), (MAX_STATIONS, MAX_STATIONS));
    }

    fn report() -> DoctorReport {
        DoctorReport {
            interface: None,
            findings: Vec::new(),
            timers: None,
            links: Vec::new(),
        }
    }

    #[test]
    fn many_stations_are_requested_less_often() {
        let ms = |stations| pause(stations).as_millis();
        assert_eq!((ms(1), ms(40), ms(1000), ms(usize::MAX)), (22, 100, 1000, 1000));
    }

    #[test]
    fn loss_is_named_and_judged_by_its_part() {
        let of = |answers: usize| {
            let link = link("akd-1".into(), None, 40, vec![Duration::from_millis(1); answers]);
            judged(&link, &PlainWording)
        };
        assert_eq!(of(40).severity, Severity::Ok);
        let some = of(39);
        assert_eq!(some.severity, Severity::Warning);
        assert!(
            some.found.starts_with("packet loss: 1 of 40 requests"),
            "{}",
            some.found
        );
        assert_eq!(of(36).severity, Severity::Error);
        assert!(of(0).found.ends_with("(100 %), no answer"), "{}", of(0).found);
    }
}
