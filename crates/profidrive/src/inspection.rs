//! What a drive is like: its status, its identity and its faults. Nothing is changed.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use profidrive::inspection::{faults, info, status};
//! use profidrive::report::PlainWording;
//! use profidrive::{Outcome, Wait};
//!
//! let plant = r#"
//!     [[drive]]
//!     name = "akd-1"
//!     ip = "192.168.0.11/24"
//!     event = [{ at = "5s", do = "fault=439" }]
//! "#;
//! let mut network = profidrive::open_plan(plant.parse()?)?;
//! let mut drive = network.find(&"akd-1".parse()?).wait()?;
//! assert!(info(&mut network, &mut drive).wait()?.is_drive);
//! assert_eq!(status(&mut network, &mut drive, &PlainWording).wait()?.outcome, Outcome::Complete);
//!
//! network.pass(std::time::Duration::from_secs(5)).wait()?;
//! let held = status(&mut network, &mut drive, &PlainWording).wait()?;
//! assert_eq!((held.outcome, held.report.cause), (Outcome::Difference, "fault"));
//! assert_eq!(faults(&mut network, &mut drive, false).wait()?.faults[0].number, 439);
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use client::status::{Verdict, diagnose};
use client::{Advice, Drive, Error, ErrorKind, Info, Session};
use profinet::wire::block::RecordAddress;

use crate::motion::leftovers;
use crate::report::{FaultsReport, InfoReport, StatusReport, Wording};
use crate::{Outcome, Reported};

/// Reads how a drive is and why it does not run, with what killed programs left changed at it. For a drive that is kept from
/// running the outcome is [`Outcome::Difference`].
///
/// # Errors
/// When the drive cannot be reached; [`without_status`] has more to do then.
pub async fn status(
    session: &mut Session,
    drive: &mut Drive,
    wording: &(dyn Wording + Sync),
) -> Result<Reported<StatusReport>, Error> {
    let status = session.status(drive).await?;
    // a controller may be the very program that will put its setting back
    let left = match status.controller {
        Some(None) => leftovers(session, drive).await?,
        _ => Vec::new(),
    };
    let mut diagnosis = diagnose(&status);
    diagnosis.notes.extend(left.iter().map(|left| match left {
        Ok(left) => left.note(),
        Err(unreadable) => unreadable.note(),
    }));
    let outcome = match diagnosis.verdict {
        Verdict::Runs | Verdict::Waits => Outcome::Complete,
        Verdict::Held => Outcome::Difference,
    };
    let report = StatusReport::new(&status, &diagnosis, drive.model.catalogue, wording);
    Ok(Reported { report, outcome })
}

/// Returns what to do, beside [`Error::advice`], when [`status`] failed: a drive whose parameters cannot be read may turn all
/// the same. Empty for other errors.
#[must_use]
pub fn without_status(error: &Error) -> Advice {
    if !error.is_of_parameters() {
        return Advice::default();
    }
    Advice::from(
        "if it turns: {stop} brings it to rest by its control word, without parameters, where no controller has it",
    )
}

/// Reads who a drive is: identification, modules, neighbours, and where its parameters can be read its state and the
/// faults that are present. A station that is not a drive is described as far as it answers.
///
/// # Errors
/// When the drive cannot be reached. What it refuses is in [`InfoReport::refused`].
pub async fn info(session: &mut Session, drive: &mut Drive) -> Result<InfoReport, Error> {
    look(session, drive).await.map(|(report, _)| report)
}

/// The same, with what was requested and not answered in time.
pub(crate) async fn look(
    session: &mut Session,
    drive: &mut Drive,
) -> Result<(InfoReport, Vec<String>), Error> {
    let mut info = session.info(drive).await?;
    let (mut snapshot, mut faults) = (None, Vec::new());
    if !info.readings.is_empty() {
        match session.snapshot(drive, &[]).await {
            Ok(read) => snapshot = Some(read),
            Err(error) => miss(&mut info, "state", &error),
        }
        match session.faults(drive).await {
            Ok(read) => faults = read,
            Err(error) => miss(&mut info, "faults", &error),
        }
    }
    let report = InfoReport::new(drive, &info, snapshot.as_ref(), &faults);
    Ok((report, info.unanswered))
}

fn miss(info: &mut Info, what: &str, error: &Error) {
    if matches!(error.kind(), ErrorKind::Unreachable | ErrorKind::Lost) {
        let missing = format!("{what}: {error}");
        info.refused.push(missing.clone());
        info.unanswered.push(missing);
    }
}

/// Reads the faults and warnings of a drive, acknowledged faults and its log only with `history`.
/// [`FaultsReport::advice`] has what ends the faults.
///
/// # Errors
/// When the drive cannot be reached, has no fault buffer, or the buffer keeps changing.
pub async fn faults(session: &mut Session, drive: &mut Drive, history: bool) -> Result<FaultsReport, Error> {
    let report = session.fault_report(drive).await?;
    Ok(FaultsReport::new(drive.label(), &report, history))
}

/// Where a record is: what a submodule has under a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Record {
    /// Application process: 0, or 0x3A00 for the drive profile.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Index.
    pub index: u16,
}

/// Reads a record of any submodule, with its content in words where its layout is known.
///
/// ```
/// # #[cfg(feature = "simulate")] {
/// use profidrive::Wait;
/// use profidrive::inspection::{Record, record};
///
/// let plant = "[[drive]]\nname = \"akd-1\"\nip = \"192.168.0.11/24\"";
/// let mut network = profidrive::open_plan(plant.parse()?)?;
/// let mut drive = network.find(&"akd-1".parse()?).wait()?;
/// let identity = Record { api: 0, slot: 0, subslot: 1, index: 0xAFF0 };
/// let (octets, text) = record(&mut network, &mut drive, identity).wait()?;
/// assert_eq!(octets[..2], [0x00, 0x20]);
/// assert!(text.is_some_and(|text| text.contains("order number AKD")));
/// # }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the drive cannot be reached or refuses.
pub async fn record(
    session: &mut Session,
    drive: &mut Drive,
    at: Record,
) -> Result<(Vec<u8>, Option<String>), Error> {
    let address = RecordAddress {
        api: at.api,
        slot: at.slot,
        subslot: at.subslot,
        index: at.index,
    };
    let octets = session.read_record(drive, address).await?;
    let text = dissect::octets::record(at.index, &octets);
    Ok((octets, text))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_drive_with_a_silent_channel_can_be_stopped() {
        let silent = Error::Timeout {
            drive: "vlt-1".into(),
            what: "record access",
            limit: Duration::from_secs(10),
        };
        let actions: Vec<client::Action> = without_status(&silent).actions().cloned().collect();
        assert_eq!(actions, [client::Action::Stop]);
        assert!(without_status(&Error::Interrupted).is_empty());
    }
}
