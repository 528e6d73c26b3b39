//! Bringing the drives of a machine to what its [machine file](crate::machine) says, and comparing them with it.
//!
//! [`plan`] reads only and returns all objections of all drives. [`carry_out`] gives names and addresses, writes the settings,
//! saves them and reads everything back. A run that was killed is finished by the next one: a note beside the machine file stays
//! until a drive is verified, and the values before are in files that [`settings::plan`] restores from. [`from_drives`] is the other
//! way: it writes the file of the drives that are there.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use profidrive::commissioning::{Purpose, plan};
//! use profidrive::machine::Machine;
//! use profidrive::{Access, Opening, Wait};
//!
//! let plant = "[[drive]]\nname = \"akd-1\"\nip = \"192.168.0.11/24\"";
//! let machine: Machine = "[[drive]]\nname = \"akd-1\"\nmodel = \"akd\"\nparameters = { 'DRV.ACC' = '5000rpm/s' }".parse()?;
//! let opening = Opening::new(Access::Records).in_plant(plant.parse()?);
//! let mut network = opening.clone().open()?;
//! let planned = plan(&opening, &mut network, &machine, Purpose::Commission).wait()?;
//! assert!(planned[0].is_change() && planned[0].objections.is_empty());
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod from_drives;
mod station;
mod wanted;

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use client::change::Step;
use client::{Drive, DriveAddress, Session};
use futures::{StreamExt, stream};

pub use error::CommissionError;
pub use from_drives::{FromDrives, MachineFile, from_drives};
pub use wanted::PlannedSettings;

use crate::drive::DriveError;
use crate::fleet::{AT_ONCE, of_many};
use crate::machine::{Machine, MachineDrive};
use crate::open::{Caller, Opening, Transport};
use crate::report::{IpReport, NameReport};
use crate::settings;
use crate::{Part, Sum};

/// Time for all stations to answer.
const SEARCH: Duration = Duration::from_secs(1);

/// What a plan is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// To be carried out: a drive at work is an objection.
    Commission,
    /// To see what differs: nothing will be written.
    Compare,
}

/// A drive of the machine file, with what is to be done or was done.
#[derive(Debug)]
pub struct Planned {
    /// The drive in the file.
    pub wanted: MachineDrive,
    /// The drive, where it was found.
    pub drive: Option<Drive>,
    /// Its new name; `None` where it has the name.
    pub name: Option<NameReport>,
    /// Its new address; `None` where it has the address, or the file has none.
    pub ip: Option<IpReport>,
    /// Its settings; `None` where the file has none, or they can be read with the new address only.
    pub settings: Option<PlannedSettings>,
    /// The settings can be read with the new address only.
    pub settings_later: bool,
    /// A run before this one did not end.
    pub unfinished: bool,
    /// What speaks against it; after [`carry_out`] what went wrong.
    pub objections: Vec<CommissionError>,
    /// The values before, where some were changed.
    pub way_back: Option<PathBuf>,
    /// Everything was read back and is as the file says.
    pub verified: bool,
}

impl Planned {
    fn of(wanted: &MachineDrive) -> Self {
        Self {
            wanted: wanted.clone(),
            drive: None,
            name: None,
            ip: None,
            settings: None,
            settings_later: false,
            unfinished: false,
            objections: Vec::new(),
            way_back: None,
            verified: false,
        }
    }

    /// Whether [`carry_out`] changes anything.
    #[must_use]
    pub fn is_change(&self) -> bool {
        let settings = self
            .settings
            .as_ref()
            .is_some_and(|settings| settings.plan.set.total() > 0);
        self.name.is_some() || self.ip.is_some() || self.settings_later || self.unfinished || settings
    }
}

/// Compares the drives of a machine with its file. Reads only. What speaks against a drive is in its entry; so one that does not
/// answer hides nothing of the others.
///
/// # Errors
/// When the network fails or the caller requests a stop.
pub async fn plan(
    opening: &Opening,
    network: &mut Caller,
    machine: &Machine,
    purpose: Purpose,
) -> Result<Vec<Planned>, DriveError> {
    plan_with(opening, network, machine, purpose, |_| ()).await
}

/// The same; `progress` receives how many drives are read.
///
/// # Errors
/// As [`plan`].
pub async fn plan_with(
    opening: &Opening,
    network: &mut Caller,
    machine: &Machine,
    purpose: Purpose,
    progress: impl Fn(crate::Step) + Sync,
) -> Result<Vec<Planned>, DriveError> {
    progress(crate::Step::of(Part::Searching));
    let answered = network.scan(SEARCH).await?.stations;
    let mut planned: Vec<Planned> = machine.drives.iter().map(Planned::of).collect();
    for one in &mut planned {
        one.unfinished =
            purpose == Purpose::Commission && note(machine, &one.wanted.name).is_ok_and(|note| note.exists());
        match station::find(&one.wanted, &answered) {
            Ok(station) => one.drive = Some(Drive::new(station.clone())),
            Err(error) => one.objections.push(error),
        }
        addresses(network, one, purpose).await;
    }
    let transport = network.transport().clone();
    let session: &Session = network;
    let (count, read) = (planned.len(), AtomicUsize::new(0));
    let (read, progress) = (&read, &progress);
    progress(crate::Step::counted(Part::Drives, 0, count));
    let all = stream::iter(planned).map(|mut one| {
        let mut session = of_many(session);
        let transport = &transport;
        async move {
            if let Err(error) =
                settings_of(opening, &mut session, transport, machine, &mut one, purpose).await
            {
                one.objections.push(error);
            }
            let done = read.fetch_add(1, Ordering::Relaxed) + 1;
            progress(crate::Step::counted(Part::Drives, done, count));
            one
        }
    });
    Ok(all.buffered(AT_ONCE).collect().await)
}

/// Plans the name and the address of a drive.
async fn addresses(session: &mut Session, one: &mut Planned, purpose: Purpose) {
    let Some(drive) = &mut one.drive else { return };
    if purpose == Purpose::Compare {
        let name = crate::addressing::NewName::new(&one.wanted.name);
        one.name = (drive.station.name != one.wanted.name).then(|| NameReport::new(&drive.station, &name));
        let ip = one.wanted.ip.filter(|ip| !station::has(&drive.station, *ip));
        one.ip = ip.map(|ip| IpReport::new(&drive.station, ip, true, true));
        return;
    }
    match station::name(session, drive, &one.wanted, true).await {
        Ok(report) => one.name = report,
        Err(error) => one.objections.push(error),
    }
    match station::address(session, drive, &one.wanted, true).await {
        Ok(report) => one.ip = report,
        Err(error) => one.objections.push(error),
    }
}

/// Plans the settings of a drive that was found.
async fn settings_of(
    opening: &Opening,
    session: &mut Session,
    transport: &Transport,
    machine: &Machine,
    one: &mut Planned,
    purpose: Purpose,
) -> Result<(), CommissionError> {
    let wanted = &one.wanted;
    let nothing = wanted.telegram.is_none() && wanted.parameters.is_empty() && wanted.backup.is_none();
    let Some(found) = one.drive.clone().filter(|_| !nothing) else {
        return Ok(());
    };
    let ready = if found.station.ip.is_set() {
        opening
            .ready(session, transport, found.clone(), &mut |_| {})
            .await
    } else {
        Err(DriveError::NoAddress { drive: found.label() })
    };
    let mut drive = match ready {
        Ok(drive) => drive,
        // with its own address it may be reached
        Err(_) if one.ip.is_some() => {
            one.settings_later = true;
            return Ok(());
        }
        Err(error) => return Err(error.into()),
    };
    let how = (purpose, one.unfinished);
    let (settings, objections) = wanted::plan(session, &mut drive, machine, wanted, how).await?;
    one.settings = settings;
    one.objections.extend(objections);
    one.drive = Some(drive);
    Ok(())
}

/// Returns the path of the note that a run has begun on a drive.
fn note(machine: &Machine, drive: &str) -> Result<PathBuf, CommissionError> {
    Ok(beside(machine, drive)?.with_added_extension("unfinished"))
}

/// `machine.toml.akd-1`
fn beside(machine: &Machine, drive: &str) -> Result<PathBuf, CommissionError> {
    let path = machine.path.as_ref().ok_or(CommissionError::NoFolder)?;
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{drive}"));
    Ok(path.with_file_name(name))
}

/// Carries out a plan: first all names and addresses, one after the other, then the settings of all drives side by side, each
/// saved and read back. Where there is an objection to any drive, nothing is changed; where one fails later, the others go on.
/// `progress` receives how many of all settings are written.
///
/// # Errors
/// [`CommissionError::NoFolder`]. What went wrong with a drive is in its entry.
pub async fn carry_out(
    opening: &Opening,
    network: &mut Caller,
    machine: &Machine,
    mut planned: Vec<Planned>,
    progress: impl Fn(crate::Step) + Sync,
) -> Result<Vec<Planned>, CommissionError> {
    if machine.path.is_none() {
        return Err(CommissionError::NoFolder);
    }
    if planned.iter().any(|one| !one.objections.is_empty()) {
        return Ok(planned);
    }
    for one in planned.iter_mut().filter(|one| one.is_change()) {
        if let Err(error) = begin(network, machine, one).await {
            one.objections.push(error);
        }
    }
    let transport = network.transport().clone();
    let session: &Session = network;
    let changing = planned.iter().filter(|one| one.is_change()).count();
    let sum = &Sum::new(Part::Settings, changing, progress);
    let all = stream::iter(planned).map(|mut one| {
        let mut session = session.clone();
        let transport = &transport;
        async move {
            if one.objections.is_empty() {
                let name = one.wanted.name.clone();
                let counted = |done, all| sum.report(&name, done, all);
                let finished = finish(opening, &mut session, transport, machine, &mut one, &counted).await;
                one.objections.extend(finished.err());
                let all = one
                    .settings
                    .as_ref()
                    .map_or(0, |settings| settings.plan.set.total())
                    + 1;
                if one.is_change() {
                    counted(all, all);
                }
            }
            one
        }
    });
    Ok(all.buffered(AT_ONCE).collect().await)
}

/// Notes that the run begins, and gives a drive its name and address.
async fn begin(session: &mut Session, machine: &Machine, one: &mut Planned) -> Result<(), CommissionError> {
    let path = note(machine, &one.wanted.name)?;
    fs::write(&path, "").map_err(|source| CommissionError::Note { path, source })?;
    let Some(drive) = &mut one.drive else {
        return Ok(());
    };
    if let Some(report) = station::name(session, drive, &one.wanted, false).await? {
        one.name = Some(report);
    }
    if let Some(report) = station::address(session, drive, &one.wanted, false).await? {
        one.ip = Some(report);
    }
    Ok(())
}

/// Writes the settings of a drive, saves them, reads everything back and removes the note.
async fn finish(
    opening: &Opening,
    session: &mut Session,
    transport: &Transport,
    machine: &Machine,
    one: &mut Planned,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<(), CommissionError> {
    if !one.is_change() {
        one.verified = true;
        return Ok(());
    }
    if one.name.is_some() || one.ip.is_some() {
        // as it is now
        let address = DriveAddress::Name(one.wanted.name.clone());
        let found = session.find(&address).await?;
        let as_wanted = one.wanted.ip.is_none_or(|ip| station::has(&found.station, ip));
        if !as_wanted {
            return Err(CommissionError::Differs {
                drive: one.wanted.name.clone(),
                count: 1,
            });
        }
        one.drive = Some(found);
        one.settings = None;
        settings_of(opening, session, transport, machine, one, Purpose::Commission).await?;
        one.settings_later = false;
        if !one.objections.is_empty() {
            return Ok(());
        }
    }
    write(session, machine, one, progress).await?;
    one.verified = true;
    let path = note(machine, &one.wanted.name)?;
    fs::remove_file(&path).map_err(|source| CommissionError::Note { path, source })
}

async fn write(
    session: &mut Session,
    machine: &Machine,
    one: &mut Planned,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<(), CommissionError> {
    let (Some(drive), Some(settings)) = (&mut one.drive, &mut one.settings) else {
        return Ok(());
    };
    let PlannedSettings {
        wanted,
        request,
        plan,
    } = settings;
    let name = &one.wanted.name;
    let way_back = settings::way_back(&beside(machine, name)?);
    let way_back = way_back.ok_or(CommissionError::NoFolder)?;
    // the last part is the comparison
    let all = plan.set.total() + 1;
    let counted = |done| progress(done, all);
    let result = settings::carry_out(session, drive, wanted, request, plan, &way_back, counted).await;
    one.way_back = way_back.exists().then_some(way_back);
    result?;
    if let Err(first) = plan.set.accepted() {
        return Err(CommissionError::Refused {
            others: plan.set.count(Step::is_refused).saturating_sub(1),
            first: Box::new(first),
        });
    }
    // a later value can change an earlier one, and the drive may round by itself
    let compare = settings::Restore {
        dry_run: true,
        ..request.clone()
    };
    let after = settings::plan(session, drive, wanted, &compare).await?;
    if after.set.total() > 0 || settings::shortfall(plan, drive, request).is_some() {
        return Err(CommissionError::Differs {
            drive: name.clone(),
            count: after.set.total(),
        });
    }
    Ok(())
}
