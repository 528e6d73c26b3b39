//! Examines this computer, its network interface, the network and the way to each drive. Reads only.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use profidrive::report::{Check, PlainWording, Severity};
//! use profidrive::{Access, Opening, Outcome, Wait, doctor};
//!
//! let plant = r#"
//!     [[drive]]
//!     name = "akd-1"
//!     ip = "192.168.0.11/24"
//! "#;
//! let opening = Opening::new(Access::Identity).in_plant(plant.parse()?);
//! let found = doctor::examine(&opening, None, &PlainWording, &mut |_| {}).wait()?;
//! assert_eq!(found.outcome, Outcome::Complete);
//! let loss = found.report.findings.iter().find(|one| one.check == Check::Loss);
//! assert_eq!(loss.map(|one| one.severity), Some(Severity::Ok));
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! It opens the network itself: whether that is possible is a part of what is examined. In a plant in memory only the network
//! is examined.

mod computer;
mod links;
mod stations;
mod timers;

use client::{Action, DriveAddress, Error, ErrorKind};

use crate::open::{Opening, Place, Transport, interface};
use crate::report::{Check, DoctorReport, Finding, Severity, Wording};
use crate::{Explained, Outcome, Part, Reported, Selector, Step};

/// Examines this computer and the way to the drives that are meant; `None` is all stations. What could not be checked is a
/// finding. With an error among the findings the outcome is [`Outcome::Unfit`].
///
/// It takes some 4 s on a network, more where requests are lost or many stations answer, and sends a bounded number of requests.
///
/// # Errors
/// When the caller requests a stop.
pub async fn examine(
    opening: &Opening,
    selector: Option<&Selector>,
    wording: &(dyn Wording + Sync),
    progress: &mut (dyn FnMut(Step) + Send),
) -> Result<Reported<DoctorReport>, Error> {
    let mut report = DoctorReport {
        interface: None,
        findings: Vec::new(),
        timers: None,
        links: Vec::new(),
    };
    if let Some(DriveAddress::Line(_)) = selector.and_then(Selector::single) {
        let found = "only networks are examined, and this drive is at a serial line";
        let finding = Finding::new(Check::Stations, Severity::Unchecked, found);
        report
            .findings
            .push(finding.remedied(&Action::Status.sentence(), wording));
        let outcome = Outcome::Complete;
        return Ok(Reported { report, outcome });
    }
    let in_memory = !matches!(opening.place, Place::Interface(_));
    let measured = if in_memory {
        None
    } else {
        let named = match &opening.place {
            Place::Interface(Some(name)) => Ok(Some(name.clone())),
            _ => interface(),
        };
        report.interface = computer::examine(named, &mut report.findings, wording);
        Some(timers::start(opening.stop.clone()))
    };
    let only_ip = selector.is_some_and(Selector::is_by_ip);
    match opening.clone().by_ip(only_ip).open() {
        Ok(mut network) => {
            let udp = matches!(network.transport(), Transport::Udp);
            if udp {
                links::by_udp(&mut network, selector, &mut report, wording, progress).await?;
            } else {
                stations::examine(&mut network, selector, &mut report, wording, progress).await?;
            }
            network.close().await?;
        }
        Err(error) => {
            let found = format!("the network cannot be used: {}", error.message());
            // its reason is a finding of its own
            let finding = Finding::new(Check::Stations, Severity::Unchecked, found);
            report.findings.push(finding.remedied(&error.advice(), wording));
        }
    }
    if let Some(measured) = measured {
        progress(Step::of(Part::Timers));
        timers::finish(measured.await.unwrap_or_default(), &mut report, wording);
    }
    if opening
        .stop
        .as_ref()
        .is_some_and(network::system::Stop::is_stopped)
    {
        return Err(Error::Interrupted);
    }
    let failed = |one: &Finding| one.severity == Severity::Error;
    let outcome = match report.findings.iter().any(failed) {
        true => Outcome::Unfit,
        false => Outcome::Complete,
    };
    Ok(Reported { report, outcome })
}

/// Returns an error only where the caller requested a stop: anything else is a finding.
fn unless_stopped<T>(result: Result<T, Error>) -> Result<Result<T, Error>, Error> {
    match result {
        Err(error) if error.kind() == ErrorKind::Interrupted => Err(error),
        result => Ok(result),
    }
}
