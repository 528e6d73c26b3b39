//! All that is read of the drives of a machine.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use client::backup::Backup;
use client::{Drive, Error, ErrorKind, Session};
use futures::{StreamExt, stream};

use crate::fleet::{AT_ONCE, Selected, of_many};
use crate::open::{Caller, Opening};
use crate::report::{BundledDrive, FaultsReport, InfoReport, ScanReport, StatusReport, Wording};
use crate::{DriveError, Part, Selector, Step, Sum, inspection, scan, settings};

/// Time for all stations to answer.
const SEARCH: Duration = Duration::from_secs(1);

/// All that was read of a machine.
#[derive(Debug)]
pub struct Portrait {
    /// When it was read.
    pub time: SystemTime,
    /// The stations of the network; `None` where it has no discovery.
    pub scan: Option<ScanReport>,
    /// The drives that are meant.
    pub drives: Vec<DrivePortrait>,
    /// Stations that fit a pattern and are no drives.
    pub left_out: Vec<String>,
}

/// All that was read of a drive. What is `None` has its reason among the problems.
#[derive(Debug)]
pub struct DrivePortrait {
    /// Its name, or the part of the selector that found nothing.
    pub name: String,
    /// The drive; `None` where it was not found.
    pub drive: Option<Drive>,
    /// Who it is.
    pub info: Option<InfoReport>,
    /// Why it runs or not.
    pub status: Option<StatusReport>,
    /// Its faults, with those before.
    pub faults: Option<FaultsReport>,
    /// Its settings.
    pub backup: Option<Backup>,
    /// What could not be read, with the reason.
    pub problems: Vec<String>,
}

impl DrivePortrait {
    /// Returns what is missing of it in a document.
    pub(super) fn entry(&self) -> BundledDrive {
        let read =
            self.info.is_some() || self.status.is_some() || self.faults.is_some() || self.backup.is_some();
        BundledDrive {
            drive: self.name.clone(),
            read,
            missing: self.problems.clone(),
        }
    }
}

/// Finds the drives that are meant and reads all of them, side by side.
///
/// # Errors
/// When the network fails or the caller requests a stop.
pub async fn portrait(
    opening: &Opening,
    network: &mut Caller,
    selector: &Selector,
    wording: &(dyn Wording + Sync),
    progress: &mut (dyn FnMut(Step) + Send),
) -> Result<Portrait, Error> {
    progress(Step::of(Part::Searching));
    let scan = match scan::discover(network, SEARCH).await {
        Ok(found) => Some(found.report),
        Err(error) if error.kind() == ErrorKind::Interrupted => return Err(error),
        Err(_) => None,
    };
    let found = match opening.select(network, selector).await {
        Ok(found) => found,
        Err(DriveError::Client(error)) => return Err(error),
        Err(other) => {
            let nothing = Selected {
                name: selector.to_string(),
                notes: Vec::new(),
                drive: Err(other),
            };
            crate::fleet::Fleet {
                members: vec![nothing],
                left_out: Vec::new(),
            }
        }
    };
    let all = found.members.len();
    let session: &Session = network;
    progress(Step::counted(Part::Drives, 0, all));
    let progress = Mutex::new(progress);
    let sum = Sum::new(Part::Drives, all, |step| {
        (progress.lock().unwrap_or_else(PoisonError::into_inner))(step);
    });
    let sum = &sum;
    let mut reading = stream::iter(found.members)
        .map(|member| {
            let mut session = of_many(session);
            async move {
                let name = member.name.clone();
                let counted = |done, all| sum.report(&name, done, all);
                of_drive(&mut session, member, wording, counted).await
            }
        })
        .buffered(AT_ONCE);
    let mut drives = Vec::new();
    while let Some(drive) = reading.next().await {
        drives.push(drive?);
    }
    drop(reading);
    Ok(Portrait {
        time: SystemTime::now(),
        scan,
        drives,
        left_out: found.left_out,
    })
}

async fn of_drive(
    session: &mut Session,
    member: Selected,
    wording: &(dyn Wording + Sync),
    progress: impl FnMut(usize, usize) + Send,
) -> Result<DrivePortrait, Error> {
    let Selected { name, notes, drive } = member;
    let mut portrait = DrivePortrait {
        name,
        drive: None,
        info: None,
        status: None,
        faults: None,
        backup: None,
        problems: notes,
    };
    let mut drive = match drive {
        Ok(drive) => drive,
        Err(DriveError::Client(error)) if error.kind() == ErrorKind::Interrupted => return Err(error),
        Err(error) => {
            portrait.problems.push(format!("not found: {error}"));
            return Ok(portrait);
        }
    };
    let problems = &mut portrait.problems;
    let info = inspection::info(session, &mut drive).await;
    portrait.info = kept("identity", info, problems)?;
    let status = inspection::status(session, &mut drive, wording).await;
    portrait.status = kept("status", status, problems)?.map(|status| status.report);
    let faults = inspection::faults(session, &mut drive, true).await;
    portrait.faults = kept("faults", faults, problems)?;
    let backup = settings::backup(session, &mut drive, progress).await;
    portrait.backup = kept("settings", backup, problems)?.map(|backup| backup.report);
    if let Some(backup) = &portrait.backup {
        let missing = settings::missing(backup);
        if !missing.is_nothing() {
            problems.push(missing.to_string());
        }
    }
    portrait.drive = Some(drive);
    Ok(portrait)
}

/// Keeps the reason where something could not be read; a stop ends everything.
fn kept<T>(what: &str, result: Result<T, Error>, problems: &mut Vec<String>) -> Result<Option<T>, Error> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(error) if error.kind() == ErrorKind::Interrupted => Err(error),
        Err(error) => {
            problems.push(format!("{what}: {error}"));
            Ok(None)
        }
    }
}
