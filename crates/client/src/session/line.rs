//! What a serial line does differently from a network: who is there, and how a parameter job travels.

use std::time::Duration;

use profile::notation::Notation;
use profile::parameter::pnu;
use profile::pkw::{JobError, PkwDialect};
use profinet::controller::Station;
use uss::{Protocol, SlaveId};

use super::Session;
use crate::line::{Answered, Bridge};
use crate::{Client, Drive, DriveAddress, Error, LineAddress};
use profile::model::Model;
use profile::value::Selection;

/// Longer than a drive is polled before it counts as absent.
const ASK_LIMIT: Duration = Duration::from_secs(5);
/// Longer than the exchanges for one parameter may take, with every repetition.
const PARAMETER_LIMIT: Duration = Duration::from_secs(10);
/// Octets of one parameter address in a request.
const ADDRESS: usize = 6;
/// Whose protocol FC is.
const FC_MODEL: &str = "vlt";

impl Session {
    pub(super) fn is_on_line(&self) -> bool {
        self.client().line_config().is_some()
    }

    /// Returns the drive at a place of the line, if it answers.
    pub(super) async fn find_on_line(&mut self, at: &LineAddress) -> Result<Drive, Error> {
        let address = || DriveAddress::Line(at.clone());
        let same = self
            .client()
            .line_config()
            .is_some_and(|line| line.protocol == at.protocol && line.baud == at.baud);
        let slave = self.client().line().and_then(|line| line.slave(at.number));
        let Some(slave) = slave.filter(|_| same) else {
            return Err(Error::OtherWire { drive: address() });
        };
        if let Some(line) = self.client().line() {
            line.ask(slave);
        }
        let answers = self
            .wait(ASK_LIMIT, |client| client.line()?.answers(slave))
            .await?;
        if answers != Some(true) {
            let counters = self.client().line_counters().copied().unwrap_or_default();
            return Err(Error::NoAnswer {
                drive: address(),
                telegrams: counters.telegrams,
                noise: counters.noise + counters.broken + counters.lengths + counters.checksums,
            });
        }
        let mut station = Station {
            name: at.to_string(),
            ..Station::default()
        };
        let mut probe = Drive::new(station.clone());
        probe.slave = Some(slave);
        let identification = Selection {
            pnu: pnu::IDENTIFICATION,
            first: 0,
            count: 2,
            indexed: true,
            parameter: None,
            notation: Notation::Name,
        };
        let (mut vendor, mut unit) = (0, 0);
        let dialects = self.dialects();
        for dialect in &dialects {
            self.set_dialect(slave, *dialect);
            let answer = match self.read_strictly(&probe, &[identification]).await {
                // nothing came at all: another dialect would not be answered either
                Err(error @ Error::Timeout { .. }) if self.gives_up(&error) => break,
                // it does not understand
                Err(Error::Channel { .. }) => continue,
                answer => answer?,
            };
            let words: Vec<u16> = answer
                .into_iter()
                .flatten()
                .filter_map(|reading| u16::try_from(reading.raw()?).ok())
                .collect();
            if let [vendor_of, kind, ..] = words.as_slice() {
                (vendor, unit) = (*vendor_of, *kind);
                break;
            }
        }
        if let (0, Some(first)) = (vendor, dialects.first()) {
            self.set_dialect(slave, *first);
        }
        let vendor_of = |model: &Model| model.catalogue.map(|tables| tables.device.vendor_id);
        // another VLT speaks like the one with tables; older ones do not name their vendor
        let speaks_fc =
            |model: &Model| at.protocol == Protocol::Fc && (vendor == 0 || vendor_of(model) == Some(vendor));
        let by_protocol = || Model::by_name(FC_MODEL).filter(speaks_fc);
        let model = Model::of_unit(vendor, unit).or_else(by_protocol);
        match model.and_then(|model| model.catalogue) {
            Some(tables) => {
                station.vendor_id = tables.device.vendor_id;
                station.device_id = tables.device.device_id;
            }
            None => (station.vendor_id, station.device_id) = (vendor, unit),
        }
        let mut drive = Drive::new(station);
        drive.slave = Some(slave);
        Ok(drive)
    }

    /// Returns the candidate dialects of an unknown drive, that of the protocol first.
    fn dialects(&self) -> Vec<PkwDialect> {
        let line = self.client().line_config();
        let Some(line) = line else {
            return Vec::new();
        };
        let mut dialects = vec![line.dialect(None)];
        for vendor in Model::vendors() {
            let dialect = line.dialect(Some(vendor));
            if !dialects.contains(&dialect) {
                dialects.push(dialect);
            }
        }
        dialects
    }

    /// Status word and actual value of a drive at the line, from a reply that comes now. `None` where it does not answer
    /// with them.
    pub(super) async fn line_words(
        &mut self,
        drive: &Drive,
        slave: SlaveId,
    ) -> Result<Option<[u16; 2]>, Error> {
        let cyclic = self.client().line().is_some_and(|line| line.is_cyclic(slave));
        if !cyclic {
            if let Some(line) = self.client().line() {
                line.ask(slave);
            }
            let answers = self.wait(ASK_LIMIT, |client| client.line()?.answers(slave)).await;
            if Self::reached(drive, answers)? != Some(true) {
                return Err(Error::LineSilent {
                    drive: drive.label(),
                    reaction: None,
                });
            }
        }
        Ok(self.client().line().and_then(|line| line.latest(slave)))
    }

    fn set_dialect(&mut self, slave: SlaveId, dialect: PkwDialect) {
        if let Some(line) = self.client().line() {
            line.set_dialect(slave, dialect);
        }
    }

    /// One parameter job through the parameter channel of a drive at the line.
    pub(super) async fn line_job(
        &mut self,
        drive: &Drive,
        slave: SlaveId,
        request: &[u8],
    ) -> Result<Answered, Error> {
        // of a drive without tables what it was found to speak stays
        let vendor = drive
            .model
            .catalogue
            .filter(|_| !drive.model.learned)
            .map(|tables| tables.device.vendor_id);
        let config = self.client().line_config();
        if let (Some(vendor), Some(line)) = (vendor, config) {
            self.set_dialect(slave, line.dialect(Some(vendor)));
        }
        let names = self
            .client()
            .line()
            .and_then(|line| line.dialect_of(slave).map(|dialect| dialect.error_names));
        let bridge = Bridge::new(request, drive.model.dialect, names.unwrap_or_default(), |pnu| {
            drive.shape(pnu)
        });
        let limit = PARAMETER_LIMIT * u32::try_from(request.len() / ADDRESS + 1).unwrap_or(1);
        let now = self.now();
        self.client()
            .line_job(now, slave, bridge)
            .map_err(|error| Error::Malformed {
                drive: drive.label(),
                reason: error.to_string(),
            })?;
        let end = self.line_job_done(slave, limit).await;
        if !matches!(end, Ok(Some(_)))
            && let Some(line) = self.client().line()
        {
            line.drop_job(slave);
        }
        match end? {
            Some(Ok(answered)) => Ok(answered),
            Some(Err(JobError::Lost)) => Err(Error::LineSilent {
                drive: drive.label(),
                reaction: None,
            }),
            Some(Err(error)) => Err(Error::Channel {
                drive: drive.label(),
                error,
            }),
            None => Err(Error::Timeout {
                drive: drive.label(),
                what: "parameter access",
                limit: self.silence(limit),
            }),
        }
    }

    /// Waits until a job has ended, as long as the drive answers one exchange after the other.
    async fn line_job_done(
        &mut self,
        slave: SlaveId,
        limit: Duration,
    ) -> Result<Option<Result<Answered, JobError>>, Error> {
        let end = self.now() + limit;
        loop {
            let left = self.silence(end - self.now());
            let progress = |client: &mut Client| client.line()?.progress(slave);
            let before = progress(&mut self.client());
            let advanced = self
                .wait(left, |client| match client.take_line_job(slave) {
                    Some(done) => Some(Some(done)),
                    None => (progress(client) != before).then_some(None),
                })
                .await?;
            match advanced {
                // it gets on
                Some(None) => {}
                done => return Ok(done.flatten()),
            }
        }
    }
}
