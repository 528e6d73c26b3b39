//! One virtual AKD and a session with it, looked at after each thing that happens between them; and whether what a
//! restoration claims to have written is true at every one of these moments.

// helpers of tests fail by panicking, like the tests themselves
#![allow(clippy::unwrap_used, clippy::panic)]

use std::ops::{Deref, DerefMut};

use client::backup::Backup;
use client::change::{ChangeSet, Choice};
use client::{Drive, DriveAddress, Error, Network, Wait};
use network::host::{Host, StationId};
use network::segment::{Pace, Segment, SegmentMedium};
use profile::catalogue::AKD;
use profile::parameter::{Keep, ParameterAccess};
use profinet::controller::ControllerConfig;
use profinet::{Endpoint, Instant, MacAddress, Medium};
use virtual_drive::station::Station;

use crate::shared::{On, Shared};
use crate::{ip, station};

/// What happens to the drive while a session works: called after each step of the medium with its number.
pub type Hook = Box<dyn FnMut(usize, &mut Wire<'_>) + Send>;

/// The drive and its cable, looked at past the session.
pub struct Wire<'a> {
    /// The segment.
    pub segment: Box<dyn DerefMut<Target = Segment> + 'a>,
    /// The drive on it.
    pub id: StationId,
}

impl Wire<'_> {
    /// The station of the drive.
    pub fn station(&mut self) -> &mut Station {
        let host = self.segment.station_mut::<Host<Station>>(self.id);
        host.unwrap().endpoint_mut()
    }

    /// The number that the drive has, looked up in the drive itself.
    pub fn truth(&mut self, pnu: u16) -> u64 {
        let bits = 8 * AKD.by_pnu(pnu).unwrap().size.octets();
        self.station().drive_mut().read(pnu, 0).unwrap() & (u64::MAX >> (64 - bits))
    }
}

/// A segment that is looked at after each thing that happens on it.
pub struct Watched {
    inner: SegmentMedium,
    /// The drive.
    pub id: StationId,
    /// Number of steps so far.
    pub steps: Shared<usize>,
    hook: Shared<Hook>,
}

impl Medium for Watched {
    type Error = <SegmentMedium as Medium>::Error;

    fn now(&self) -> Instant {
        self.inner.now()
    }

    fn step(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> Result<(), Self::Error> {
        let result = self.inner.step(endpoint, until);
        let step = self.steps.get() + 1;
        self.steps.set(step);
        let mut wire = Wire {
            segment: Box::new(self.inner.segment_mut()),
            id: self.id,
        };
        (self.hook.borrow_mut())(step, &mut wire);
        result
    }
}

/// The segment of a medium.
struct Of<M>(M);

impl<M: Deref<Target = Watched>> Deref for Of<M> {
    type Target = Segment;

    fn deref(&self) -> &Segment {
        self.0.inner.segment()
    }
}

impl<M: DerefMut<Target = Watched>> DerefMut for Of<M> {
    fn deref_mut(&mut self) -> &mut Segment {
        self.0.inner.segment_mut()
    }
}

/// One virtual AKD and a session with it.
pub struct Bench {
    /// The session.
    pub session: On<Watched>,
    /// The drive as the session found it.
    pub drive: Drive,
    /// Number of steps so far.
    pub steps: Shared<usize>,
    hook: Shared<Hook>,
}

/// One AKD and a session with it.
pub fn bench() -> Bench {
    let mut segment = Segment::new(7);
    let id = segment.attach(station("akd-1", 1));
    let steps = Shared::new(0);
    let hook: Shared<Hook> = Shared::new(Box::new(|_, _| {}));
    let medium = Watched {
        inner: SegmentMedium::new(segment, Pace::Virtual),
        id,
        steps: steps.clone(),
        hook: hook.clone(),
    };
    let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", 1);
    let mut session = On::new(Network::on(medium, config));
    let drive = session
        .find(&"akd-1".parse::<DriveAddress>().unwrap())
        .wait()
        .unwrap();
    Bench {
        session,
        drive,
        steps,
        hook,
    }
}

impl Bench {
    /// Looks at the drive and its cable.
    pub fn wire(&mut self) -> Wire<'_> {
        let medium = self.session.medium();
        let id = medium.id;
        Wire {
            segment: Box::new(Of(medium)),
            id,
        }
    }

    /// A backup of the drive.
    pub fn backup(&mut self) -> Backup {
        self.session
            .backup(&mut self.drive, &mut |_, _| {})
            .wait()
            .unwrap()
    }

    /// Sets a number in the drive itself.
    pub fn set(&mut self, pnu: u16, raw: u64) {
        let result = self
            .wire()
            .station()
            .drive_mut()
            .write(pnu, 0, raw, Keep::Volatile);
        result.unwrap_or_else(|error| panic!("{pnu} = {raw}: {error}"));
    }

    /// The journal of a restoration that has not begun.
    pub fn journal(&mut self, wanted: &Backup, choice: &Choice) -> ChangeSet {
        let plan = self.session.plan(&mut self.drive, wanted, choice).wait();
        plan.unwrap().set
    }

    /// Restores; gives the last text that was kept.
    pub fn restore(&mut self, journal: &mut ChangeSet, save: bool) -> (Result<(), Error>, String) {
        let mut kept = String::new();
        if save {
            journal.save(&self.drive).unwrap();
        }
        let result = self
            .session
            .apply_kept(&mut self.drive, journal, &mut |journal| {
                kept = journal.to_string();
                Ok(())
            })
            .wait();
        (result, kept)
    }

    /// Calls `hook` after each step from now on, counted from 1.
    pub fn on_each_step(&self, hook: impl FnMut(usize, &mut Wire<'_>) + Send + 'static) {
        self.steps.set(0);
        *self.hook.borrow_mut() = Box::new(hook);
    }
}

/// True numbers, before and wanted, of each parameter.
pub type Numbers = Vec<(u16, u64, u64)>;

/// Looks at the drive after each step and compares it with what the text that was kept last claims.
#[derive(Clone, Default)]
pub struct Claims {
    /// The text that was stored last.
    pub kept: Shared<String>,
    /// True numbers of each parameter.
    pub numbers: Shared<Numbers>,
}

impl Claims {
    /// Begins to watch a restoration.
    pub fn watch(bench: &mut Bench, journal: &ChangeSet) -> Self {
        let claims = Self::default();
        for change in journal.changes() {
            let number = |octets: &[u8]| octets.iter().fold(0, |sum, &octet| sum << 8 | u64::from(octet));
            let pair = (
                change.new.pnu,
                number(&change.old.as_ref().unwrap().as_ref().unwrap().octets),
                number(&change.new.octets),
            );
            assert_eq!(bench.wire().truth(pair.0), pair.1);
            claims.numbers.borrow_mut().push(pair);
        }
        claims
    }

    /// Compares the drive with what the stored text claims.
    pub fn check(&self, wire: &mut Wire<'_>) {
        let text = self.kept.borrow();
        if text.is_empty() {
            // nothing was kept, so nothing may be written
            for &(pnu, old, _) in self.numbers.borrow().iter() {
                assert_eq!(
                    wire.truth(pnu),
                    old,
                    "{pnu} was written before there was a way back"
                );
            }
            return;
        }
        for &(pnu, old, new) in self.numbers.borrow().iter() {
            let line = text
                .lines()
                .find(|line| line.starts_with(&format!("p{pnu:04} ")))
                .unwrap_or_else(|| panic!("{pnu} is not in\n{text}"));
            let claim = line.rsplit_once(": ").unwrap().1;
            let claim = if line.contains(": in doubt: ") {
                "in doubt"
            } else {
                claim
            };
            let claim = if line.contains(": refused: ") {
                "refused"
            } else {
                claim
            };
            let has = wire.truth(pnu);
            let right = match claim {
                "not written" | "refused" => has == old,
                "in doubt" => has == old || has == new,
                "written" | "written, read back" => has == new,
                other => panic!("{other}"),
            };
            assert!(right, "the drive has {has}, before {old}, wanted {new}: {line}");
        }
    }
}
