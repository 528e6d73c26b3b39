//! One virtual drive and a controller with raw requests and frames, connected on a segment in virtual time.

use std::time::Duration;

use network::host::{Host, StationId};
use network::segment::{Pace, Segment, SegmentMedium};
use profinet::controller::{
    ArId, ConnectConfig, Controller, ControllerConfig, Event, RecordAddress, Resolve, ServiceError, Target,
};
use profinet::cyclic::Timing;
use profinet::device::Stored;
use profinet::{IpSuite, MacAddress, Medium};
use virtual_drive::drive::Drive;
use virtual_drive::model::Model;
use virtual_drive::station::{Station, StationConfig};

use crate::ip;

/// Ethernet address of the drive.
pub const DRIVE: MacAddress = MacAddress([2, 0x50, 0x4E, 0, 0, 1]);
const CONTROLLER: MacAddress = MacAddress([2, 0x50, 0x4E, 0, 0, 0xC0]);
const NAME: &str = "drive-1";

/// Update time of the connection of a [`Plc`].
pub const CYCLE: Duration = Duration::from_millis(16);

/// A drive and a controller that exchanges data with it.
pub struct Plc {
    /// The segment between them.
    pub medium: SegmentMedium,
    model: &'static Model,
    controller: Controller,
    ar: ArId,
    station: StationId,
}

impl Plc {
    /// Connects a drive of a model with a telegram. The controller sends `outputs` from its first frame on. `listen` sees
    /// the segment before the first frame.
    pub fn connected(
        model: &'static Model,
        telegram: u16,
        outputs: &[u8],
        listen: impl FnOnce(&mut Segment),
    ) -> Self {
        let mut segment = Segment::new(1);
        let mut config = StationConfig::new(model, DRIVE);
        config.network = Stored {
            name: NAME.into(),
            ip: ip(2),
            ..Stored::default()
        };
        let station = segment.attach(Box::new(Host::new(Station::new(config))));
        listen(&mut segment);
        let medium = SegmentMedium::new(segment, Pace::Virtual);
        let mut controller = Controller::new(ControllerConfig::new(CONTROLLER, ip(1), "controller", 1));
        let target = target(model, NAME, Some(DRIVE), ip(2));
        let config = connection(model, telegram, Resolve::Trust);
        let ar = controller
            .connect(medium.now(), target, config)
            .expect("a request");
        let mut plc = Self {
            medium,
            model,
            controller,
            ar,
            station,
        };
        let (mut ready, mut running) = (false, false);
        plc.until(Duration::from_secs(5), |plc, event| {
            match event {
                Some(Event::Connected { .. }) => plc.output(outputs),
                Some(Event::Ready { diff, .. }) => {
                    let modules = diff.iter().flat_map(|diff| &diff.modules);
                    let mut submodules = modules.flat_map(|module| &module.submodules);
                    assert!(submodules.all(|submodule| submodule.ident != 0));
                    ready = true;
                }
                Some(Event::Running { .. }) => running = true,
                Some(Event::Lost { cause, .. }) => panic!("{cause}"),
                _ => {}
            }
            ready && running
        });
        plc
    }

    /// Sets the outputs of the telegram, sent from the next cycle on.
    pub fn output(&mut self, outputs: &[u8]) {
        let subslot = self.model.catalogue.device.layout.telegram;
        self.controller
            .set_output(self.ar, 1, subslot, outputs)
            .expect("the length of the telegram");
    }

    /// Lets time pass until `done`, which sees each event of the controller and, without one, each step.
    #[track_caller]
    pub fn until(&mut self, limit: Duration, mut done: impl FnMut(&mut Self, Option<Event>) -> bool) {
        let end = self.medium.now() + limit;
        loop {
            assert!(self.medium.now() < end, "not within {limit:?}");
            let Ok(()) = self.medium.step(&mut self.controller, end);
            while let Some(event) = self.controller.poll_event() {
                if done(self, Some(event)) {
                    return;
                }
            }
            if done(self, None) {
                return;
            }
        }
    }

    /// Writes a request to a record of the parameter channel and reads the response, or why the write was refused.
    pub fn job(&mut self, index: u16, request: &[u8]) -> Result<Vec<u8>, ServiceError> {
        let device = &self.model.catalogue.device;
        let at = RecordAddress {
            api: device.api.into(),
            slot: 1,
            subslot: device.layout.parameters.subslot,
            index,
        };
        let now = self.medium.now();
        let call = self
            .controller
            .parameter_job(now, self.ar, at, request)
            .expect("a call");
        let mut answer = None;
        self.until(Duration::from_secs(10), |_, event| {
            if let Some(Event::RecordDone { call: done, result }) = event
                && done == call
            {
                answer = Some(result);
            }
            answer.is_some()
        });
        answer.expect("an answer")
    }

    /// Sends outputs for a while and returns the inputs at its end.
    #[track_caller]
    pub fn exchange(&mut self, outputs: &[u8], time: Duration) -> Vec<u8> {
        self.output(outputs);
        let end = self.medium.now() + time;
        while self.medium.now() < end {
            let Ok(()) = self.medium.step(&mut self.controller, end);
            while let Some(event) = self.controller.poll_event() {
                assert!(!matches!(event, Event::Lost { .. }), "{event:?}");
            }
        }
        let subslot = self.model.catalogue.device.layout.telegram;
        let (data, iops) = self.controller.input(self.ar, 1, subslot).expect("connected");
        assert!(iops.is_good());
        data.to_vec()
    }

    /// The drive itself.
    pub fn drive_mut(&mut self) -> &mut Drive {
        let segment = self.medium.segment_mut();
        let host = segment.station_mut::<Host<Station>>(self.station);
        host.expect("the drive").endpoint_mut().drive_mut()
    }
}

/// What a controller connects to.
pub fn target(model: &Model, name: &str, mac: Option<MacAddress>, ip: IpSuite) -> Target {
    let device = &model.catalogue.device;
    Target {
        name: name.into(),
        mac,
        ip,
        vendor_id: device.vendor_id,
        device_id: device.device_id,
        instance: 1,
    }
}

/// A connection with a telegram of a model, as its tables have the modules.
pub fn connection(model: &Model, telegram: u16, resolve: Resolve) -> ConnectConfig {
    let device = &model.catalogue.device;
    let telegram = device.telegram(telegram).expect("a telegram of the model");
    let timing = Timing::for_interval(CYCLE).expect("an interval of PROFINET");
    let mut config = ConnectConfig::new(client::modules_of(device, telegram), timing);
    config.resolve = resolve;
    config
}
