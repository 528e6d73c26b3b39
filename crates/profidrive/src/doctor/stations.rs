//! The stations of the network: who answers, who cannot be reached, what is there twice.

use std::time::Duration;

use client::{Action, Advice, Discovered, Drive, Error};
use network::system::NeighbourTable;
use profinet::controller::Station as Answer;
use profinet::wire::dcp::role;

use super::{links, unless_stopped};
use crate::open::{Caller, Transport};
use crate::report::{Check, DoctorReport, Finding, Remark, Scanned, Severity, Shared, Wording};
use crate::{Part, Selector, Step, scan};

/// Time for all stations to answer.
const SEARCH: Duration = Duration::from_secs(1);

pub(super) async fn examine(
    network: &mut Caller,
    selector: Option<&Selector>,
    report: &mut DoctorReport,
    wording: &(dyn Wording + Sync),
    progress: &mut (dyn FnMut(Step) + Send),
) -> Result<(), Error> {
    progress(Step::of(Part::Searching));
    let Discovered {
        stations: mut answers,
        more,
    } = match unless_stopped(network.scan(SEARCH).await)? {
        Ok(found) => found,
        Err(error) => {
            let found = format!("the search failed: {error}");
            let finding = Finding::new(Check::Stations, Severity::Error, found);
            let advice = error.advice().unwrap_or_default();
            report.findings.push(finding.remedied(&advice, wording));
            return Ok(());
        }
    };
    let measured = links::measure(network, &mut answers, progress).await?;
    let stations = scan::of_answers(network, &answers);
    report.findings.push(answered(&answers, wording));
    if more {
        let found = format!("more than {} stations answered", answers.len());
        let finding = Finding::new(Check::Stations, Severity::Warning, found);
        let why =
            "one search takes no more: the others are not examined, and `all` and patterns do not reach them";
        let advice = Advice::from("select the others by their names or IP addresses");
        report
            .findings
            .push(finding.because(why).remedied(&advice, wording));
    }
    let table = match network.transport() {
        Transport::Packet(_) => NeighbourTable::of_kernel(),
        _ => None,
    };
    let with_address = answers.iter().filter(|answer| answer.ip.is_set()).count();
    report
        .findings
        .extend(table.map(|table| room(table, with_address, wording)));
    let missing = selector.map_or_else(Vec::new, |selector| selector.without(&answers));
    for term in missing {
        let finding = Finding::new(Check::Stations, Severity::Error, "no station answers");
        let advice = Advice::from("check its name, its power and its cable; {scan} lists who answers");
        report
            .findings
            .push(finding.about(term).remedied(&advice, wording));
    }
    for duplicate in stations.duplicates() {
        let first = duplicate.stations.first().cloned();
        let advice = match duplicate.what {
            Shared::Name(_) => Action::SetName { device: first }.sentence(),
            Shared::Address(_) => Action::SetAddress { device: first }.sentence(),
        };
        let finding = Finding::new(Check::Duplicates, Severity::Error, duplicate.to_string())
            .because("each of them may get the commands that are meant for another one");
        report.findings.push(finding.remedied(&advice, wording));
    }
    if stations.duplicates().is_empty() && !answers.is_empty() {
        let found = "each name and each address is there once";
        report
            .findings
            .push(Finding::new(Check::Duplicates, Severity::Ok, found));
    }
    let meant = |answer: &&Answer| match selector {
        Some(selector) => selector.means_station(answer),
        None => answer.role & role::DEVICE != 0 || answer.role == 0,
    };
    let meant: Vec<Answer> = answers.iter().filter(meant).cloned().collect();
    let (lossy, readable): (Vec<Answer>, Vec<Answer>) = meant
        .iter()
        .cloned()
        .partition(|answer| measured.is_heavy(answer));
    measured.report(&meant, report, wording);
    for station in lossy {
        let found = "not read: too many of its packets are lost";
        let finding = Finding::new(Check::Records, Severity::Unchecked, found);
        report.findings.push(finding.about(Drive::new(station).label()));
    }
    let mut reading = |done, all| progress(Step::counted(Part::Identities, done, all));
    let read = unless_stopped(scan::described(network, &answers, &readable, &mut reading).await)?;
    for scanned in read.map(|read| read.report.stations).unwrap_or_default() {
        report.findings.extend(of_station(&scanned, wording));
    }
    Ok(())
}

fn answered(answers: &[Answer], wording: &dyn Wording) -> Finding {
    match answers.len() {
        0 => Finding::new(Check::Stations, Severity::Error, "no station answered")
            .because("a station answers whatever its name and its address are")
            .remedied(
                &Advice::from(
                    "check cable, interface and power: {choose interface} selects another interface",
                ),
                wording,
            ),
        1 => Finding::new(Check::Stations, Severity::Ok, "1 station answered"),
        count => Finding::new(
            Check::Stations,
            Severity::Ok,
            format!("{count} stations answered"),
        ),
    }
}

/// Whether the kernel can remember the Ethernet addresses of so many stations at the same time.
fn room(table: NeighbourTable, stations: usize, wording: &dyn Wording) -> Finding {
    let most = table.most;
    if stations <= most && !table.is_full() {
        let found = format!("the kernel has room for {most} addresses");
        return Finding::new(Check::ArpTable, Severity::Ok, found);
    }
    let found = if stations > most {
        format!("the kernel has room for {most} addresses, and {stations} stations have one")
    } else {
        format!(
            "the kernel has room for {most} addresses, and {} are in use",
            table.held
        )
    };
    Finding::new(Check::ArpTable, Severity::Warning, found)
        .because("a station whose address finds no room there does not answer to any record")
        .remedied(&table.enlarged_for(stations).into(), wording)
}

/// What keeps a station from being read, and who its neighbours are.
fn of_station(scanned: &Scanned, wording: &dyn Wording) -> Vec<Finding> {
    let station = &scanned.station;
    let mac = || Some(station.mac.clone());
    let label = || {
        let name = station.name.as_ref().or(station.ip.as_ref());
        name.unwrap_or(&station.mac).clone()
    };
    let remarked = |remark: &Remark| {
        let (severity, why, advice) = match remark {
            Remark::NoName => (
                Severity::Note,
                "no controller finds it",
                Action::SetName { device: mac() }.sentence(),
            ),
            Remark::NoAddress => (
                Severity::Warning,
                "it cannot be read",
                Action::SetAddress { device: mac() }.sentence(),
            ),
            Remark::OtherSubnet => (
                Severity::Error,
                "no answer can come to this computer",
                Advice::from(Action::SetAddress { device: mac() })
                    .and(" gives it an address in the subnet of this computer"),
            ),
            Remark::Routed => (
                Severity::Note,
                "a router must connect both subnets",
                Advice::default(),
            ),
            Remark::Conflict => (
                Severity::Error,
                "two stations with one address answer in place of each other",
                Action::SetAddress { device: mac() }.sentence(),
            ),
            // they are findings of their own
            Remark::NameTwice | Remark::AddressTwice => return None,
        };
        let ip = match (remark, &station.ip, station.prefix) {
            (Remark::OtherSubnet | Remark::Routed, Some(ip), Some(prefix)) => format!(": {ip}/{prefix}"),
            _ => String::new(),
        };
        let finding = Finding::new(Check::Reach, severity, format!("{remark}{ip}"));
        Some(finding.about(label()).because(why).remedied(&advice, wording))
    };
    let mut findings: Vec<Finding> = scanned.remarks.iter().filter_map(remarked).collect();
    if let Some(unread) = &scanned.unread {
        let finding = Finding::new(
            Check::Records,
            Severity::Warning,
            format!("could not be read: {unread}"),
        );
        findings.push(finding.about(label()).remedied(&Action::Info.sentence(), wording));
    }
    let info = scanned.info.as_ref();
    let neighbours: Vec<String> = info
        .map_or(&[][..], |info| &info.neighbours)
        .iter()
        .map(|one| {
            let other = one.station.as_ref().unwrap_or(&one.mac);
            format!("{} to {} of {other}", one.own_port, one.port)
        })
        .collect();
    if !neighbours.is_empty() {
        let finding = Finding::new(Check::Neighbours, Severity::Ok, neighbours.join(", "));
        findings.push(finding.about(label()));
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::PlainWording;

    #[test]
    fn a_table_of_the_kernel_that_is_too_small_is_a_warning_with_the_setting() {
        let of = |held, stations| room(NeighbourTable { held, most: 1024 }, stations, &PlainWording);
        assert_eq!(of(10, 1024).severity, Severity::Ok);
        let small = of(10, 1100);
        assert_eq!(small.severity, Severity::Warning);
        assert_eq!(
            small.found,
            "the kernel has room for 1024 addresses, and 1100 stations have one"
        );
        let remedy = small.remedy.unwrap();
        assert!(
            remedy.contains("net.ipv4.neigh.default.gc_thresh3=4096"),
            "{remedy}"
        );
        assert!(of(1020, 40).found.ends_with("and 1020 are in use"));
    }
}
