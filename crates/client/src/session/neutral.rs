//! A connection as IO controller for the records of a device that accepts no other one. It can neither start nor stop the
//! drive, and leaves nothing behind when it is released.
//!
//! The start-up is held: parameter jobs travel in it, no data is exchanged, and the drive sees no control word. A device
//! that requires data first gets it with IOPS bad and the provider stopped. Valid outputs with a control word of 0 would be
//! less neutral: without bit 10 a PROFIdrive or a VLT ignores it, but the control word of a Vacon telegram has no such bit
//! and 0 means stop there. A change from run to stop, which some drives take for a lost controller (AKD FBUS.PARAM02),
//! never happens, as the provider never runs.

use std::time::Duration;

use profile::parameter::{ParameterAddress, encode_read, pnu};
use profinet::controller::{ArId, ConnectConfig, RecordAddress, Resolve};
use profinet::cyclic::TICK;
use profinet::wire::Reader;
use profinet::wire::record::{decode_apis, index};

use super::Session;
use super::access::{channel, target};
use super::info::controller_of;
use super::plugged::{Plugged, modules_in};
use super::route::wants_data;
use crate::axis::Cycle;
use crate::learn::device_of;
use crate::modules::PLACE;
use crate::{Connection, Drive, Error, Route, RouteNotice};
use profile::model::PROFIDRIVE_API;

/// How long a device may take to become ready.
const READY_LIMIT: Duration = Duration::from_secs(30);
/// How long a device may refuse a job in the start-up before the start-up is ended for it.
const START_UP_JOB: Duration = Duration::from_secs(2);
/// Largest request of one parameter.
const ONE_PARAMETER: usize = 32;

impl Session {
    /// Opens a connection as IO controller for the records of a drive.
    pub(super) async fn as_controller(&mut self, drive: &Drive) -> Result<ArId, Error> {
        if self.is_closed(drive, Route::Controller) {
            return Err(self.no_route(drive));
        }
        // an owner keeps others out however they come: that is reported before what else stands in the way
        let owner = self.glance_record(drive, 0, (0, 1), index::AR_DATA).await?;
        if let Some(Some(controller)) = owner.and_then(|data| controller_of(&data, &[])) {
            return Err(self.owned(drive, Some(controller)));
        }
        if !self.engine.receives_calls() {
            let reason = "UDP port 34964, on which the device calls, is in use by another program".into();
            self.close_route(drive, Route::Controller, reason);
            return Err(self.no_route(drive));
        }
        let apis = self.glance_record(drive, 0, (0, 1), index::API_DATA).await?;
        let apis = apis.and_then(|data| decode_apis(Reader::new(&data)).ok());
        if apis.is_some_and(|apis| !apis.contains(&drive.model.channel.api)) {
            return Err(Error::NotADrive { drive: drive.label() });
        }
        let tables = drive.model.catalogue;
        let device = tables.map_or_else(|| device_of(&drive.station), |tables| tables.device);
        let mut modules = Vec::new();
        for (api, place) in [(0, (0, 1)), (PROFIDRIVE_API, PLACE)] {
            let data = self
                .glance_record(drive, api, place, index::REAL_IDENTIFICATION_API)
                .await?;
            modules.push(data.map_or_else(Vec::new, |data| modules_in(&data, api)));
        }
        let profile = modules.pop().unwrap_or_default();
        let plugged = Plugged::new(modules.pop().unwrap_or_default(), profile);
        let known = tables.filter(|_| !drive.model.learned);
        let known = known.map(|tables| &tables.device);
        let Some(modules) = plugged.for_records(known, &drive.vendor_modules) else {
            let reason = "the plugged modules are not known: the device does not report them".into();
            self.close_route(drive, Route::Controller, reason);
            return Err(self.no_route(drive));
        };
        let least = TICK * u32::from(device.min_device_interval);
        let cycle = Cycle::choose(&drive.vendor_timings, least, None, None)?;
        let slots: Vec<String> = modules
            .iter()
            .map(|module| format!("slot {} 0x{:08X}", module.slot, module.ident))
            .collect();
        let details = format!("{}, update time {:?}", slots.join(", "), cycle.interval());
        let config = ConnectConfig {
            watchdog_factor: cycle.watchdog,
            data_hold_factor: cycle.watchdog,
            resolve: Resolve::Trust,
            ready_limit: READY_LIMIT,
            ..ConnectConfig::for_records(modules, cycle.timing)
        };
        let now = self.now();
        let ar = self.client().controller().connect(now, target(drive), config)?;
        let route = Route::Controller;
        let access = self.remember(drive, ar, route);
        let ar = match self.opened(drive, access).await {
            Ok(Some(ar)) => ar,
            Ok(None) => return Err(self.no_route(drive)),
            Err(Error::OwnedByController { controller, .. }) => return Err(self.owned(drive, controller)),
            Err(error) => return Err(error),
        };
        self.describe_route(drive, &RouteNotice::Taken { route, details });
        self.try_start_up(drive, ar).await?;
        Ok(ar)
    }

    fn owned(&self, drive: &Drive, controller: Option<String>) -> Error {
        Error::ParametersOwned {
            drive: drive.label(),
            controller,
            closed: self.closed_routes(drive),
        }
    }

    /// Reads a record without a connection; `None` where the device does not answer that.
    async fn glance_record(
        &mut self,
        drive: &Drive,
        api: u32,
        (slot, subslot): (u16, u16),
        index: u16,
    ) -> Result<Option<Vec<u8>>, Error> {
        if self.is_closed(drive, Route::Implicit) {
            return Ok(None);
        }
        let at = RecordAddress {
            api,
            slot,
            subslot,
            index,
        };
        Ok(self.read_implicitly(drive, at).await?.ok())
    }

    /// Reads one parameter: a device that takes no jobs in the start-up gets data exchange.
    async fn try_start_up(&mut self, drive: &Drive, ar: ArId) -> Result<(), Error> {
        let mut request = [0; ONE_PARAMETER];
        let reference = self.next_reference();
        let address = [ParameterAddress::value(pnu::IDENTIFICATION, 0)];
        let Ok(length) = encode_read(reference, drive.model.dialect, &address, &mut request) else {
            return Ok(());
        };
        let request = request.get(..length).unwrap_or_default();
        let now = self.now();
        let call = self.client().controller().parameter_job_within(
            now,
            ar,
            channel(drive),
            request,
            START_UP_JOB,
        )?;
        let limit = START_UP_JOB + READY_LIMIT;
        match self.wait(limit, |client| client.take_record(call)).await? {
            Some(Err(error)) if wants_data(&error) => self.exchange_data(drive, ar).await,
            // whatever else is wrong shows with the requested job
            _ => Ok(()),
        }
    }

    async fn exchange_data(&mut self, drive: &Drive, ar: ArId) -> Result<(), Error> {
        if !self.engine.discovers() {
            self.release(ar.into()).await?;
            let reason = "the device accepts a connection with cyclic data only, which needs raw frames, not UDP alone".into();
            self.close_route(drive, Route::Controller, reason);
            return Err(self.no_route(drive));
        }
        self.describe_route(drive, &RouteNotice::StartUpEnded);
        let now = self.now();
        self.client().controller().end_start_up(now, ar)?;
        let end = self
            .wait(READY_LIMIT * 2, |client| match client.connection(ar) {
                Connection::Opening | Connection::Open => None,
                other => Some(other),
            })
            .await?;
        match end {
            Some(Connection::Running) => Ok(()),
            Some(Connection::Lost(cause)) => {
                self.drop_access(ar);
                self.close_route(drive, Route::Controller, cause.to_string());
                Err(self.no_route(drive))
            }
            _ => {
                self.release(ar.into()).await?;
                self.close_route(drive, Route::Controller, "no cyclic data came".into());
                Err(self.no_route(drive))
            }
        }
    }
}
