//! One virtual drive and one controller on a segment in memory: virtual time, the whole wire path, every frame kept.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use client::modules_of;
use network::host::{Host, StationId};
use network::segment::{Pace, Segment, SegmentMedium};
use profinet::controller::{
    ArId, ConnectConfig, Controller, ControllerConfig, Event, ModuleConfig, RecordAddress, Resolve, Target,
};
use profinet::cyclic::Timing;
use profinet::device::Stored;
use profinet::wire::block::ModuleDiff;
use profinet::{Instant, IpSuite, MacAddress, Medium};
use virtual_drive::model::{AKD, Model};
use virtual_drive::station::{Station, StationConfig};

use crate::{judge, memory};

/// Ethernet address of the drive.
pub const DRIVE: MacAddress = MacAddress([0x02, 0x50, 0x4E, 0, 0, 1]);
/// Ethernet address of the controller.
pub const CONTROLLER: MacAddress = MacAddress([0x02, 0x50, 0x4E, 0, 0, 2]);
/// Update time: the fastest of the AKD.
pub const CYCLE: Duration = Duration::from_millis(16);

const NAME: &str = "akd-1";

fn address(last: u8) -> IpSuite {
    IpSuite {
        address: [192, 168, 77, last].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0; 4].into(),
    }
}

/// Returns the modules that a controller expects of an AKD with this telegram.
#[must_use]
pub fn modules(telegram: u16) -> Vec<ModuleConfig> {
    let device = &AKD.catalogue.device;
    modules_of(device, device.telegram(telegram).expect("a telegram of the AKD"))
}

/// The two of them and the wire between.
pub struct Bus {
    medium: SegmentMedium,
    controller: Controller,
    model: &'static Model,
    /// Update time of the connection.
    cycle: Duration,
    drive: StationId,
    ar: Option<ArId>,
    events: Vec<Event>,
    frames: Arc<Mutex<Seen>>,
    /// How many of them were given to the test.
    given: usize,
}

/// Frames with their times.
type Seen = Vec<(Instant, Vec<u8>)>;

impl Default for Bus {
    fn default() -> Self {
        Self::new()
    }
}

impl Bus {
    /// Creates a drive as delivered with name and address, and a controller that has not connected yet.
    #[must_use]
    pub fn new() -> Self {
        Self::of(&AKD)
    }

    /// Returns the same with a drive of another model.
    #[must_use]
    pub fn of(model: &'static Model) -> Self {
        let mut config = StationConfig::new(model, DRIVE);
        config.network = Stored {
            name: NAME.into(),
            ip: address(1),
            ..Stored::default()
        };
        let frames = Arc::new(Mutex::new(Seen::new()));
        let mut segment = Segment::new(1);
        segment.add_tap(Box::new(Arc::clone(&frames)));
        let drive = segment.attach(Box::new(Host::new(Station::new(config))));
        let plc = ControllerConfig::new(CONTROLLER, address(2), "plc", 1);
        let mut bus = Self {
            medium: SegmentMedium::new(segment, Pace::Virtual),
            controller: Controller::new(plc),
            model,
            cycle: CYCLE,
            drive,
            ar: None,
            events: Vec::new(),
            frames,
            given: 0,
        };
        bus.run(Duration::from_millis(5));
        bus
    }

    /// Returns the drive with its device.
    ///
    /// # Panics
    /// Never: it is there from the beginning.
    pub fn station(&mut self) -> &mut Station {
        let segment = self.medium.segment_mut();
        let host: &mut Host<Station> = segment.station_mut(self.drive).expect("attached");
        host.endpoint_mut()
    }

    /// Time goes on.
    ///
    /// # Panics
    /// Never: the segment cannot fail.
    pub fn run(&mut self, time: Duration) {
        let end = self.medium.now() + time;
        while self.medium.now() < end {
            self.medium
                .step(&mut self.controller, end)
                .expect("a segment cannot fail");
            self.events
                .extend(std::iter::from_fn(|| self.controller.poll_event()));
        }
    }

    /// Connects with one of the AKD's telegrams; data is exchanged then.
    ///
    /// # Panics
    /// When the drive differs from what is expected or no data comes.
    pub fn connect(&mut self, telegram: u16) {
        let (diff, running) = self.connect_as(modules(telegram));
        assert_eq!(diff, None);
        assert!(running, "no data: {:?}", self.events);
    }

    /// The same with a slower update time than the fastest of the AKD.
    ///
    /// # Panics
    /// As [`connect`](Self::connect).
    pub fn connect_every(&mut self, cycle: Duration, telegram: u16) {
        self.cycle = cycle;
        self.connect(telegram);
    }

    /// Connects with any modules: how the drive differs, and if data is exchanged.
    ///
    /// # Panics
    /// When the drive refuses or does not become ready.
    pub fn connect_as(&mut self, modules: Vec<ModuleConfig>) -> (Option<ModuleDiff>, bool) {
        let device = &self.model.catalogue.device;
        let target = Target {
            name: NAME.into(),
            mac: Some(DRIVE),
            ip: address(1),
            vendor_id: device.vendor_id,
            device_id: device.device_id,
            instance: 1,
        };
        let fastest = Duration::from_nanos(31_250) * u32::from(device.min_device_interval);
        let timing = Timing::for_interval(fastest + (self.cycle - CYCLE)).expect("an interval of PROFINET");
        let mut config = ConnectConfig::new(modules, timing);
        config.resolve = Resolve::Trust;
        self.events.clear();
        let now = self.medium.now();
        let ar = self.controller.connect(now, target, config).expect("connects");
        self.ar = Some(ar);
        self.run(Duration::from_millis(500) + 4 * (self.cycle - CYCLE));
        let diff = self.events.iter().find_map(|event| match event {
            Event::Connected { diff, .. } => Some(diff.clone()),
            _ => None,
        });
        let diff = diff.unwrap_or_else(|| panic!("refused: {:?}", self.events));
        let ready = self
            .events
            .iter()
            .any(|event| matches!(event, Event::Ready { .. }));
        assert!(ready, "not ready: {:?}", self.events);
        let running = self
            .events
            .iter()
            .any(|event| matches!(event, Event::Running { .. }));
        (diff, running)
    }

    fn ar(&self) -> ArId {
        self.ar.expect("connected")
    }

    /// Gives the connection back.
    ///
    /// # Panics
    /// When there is none.
    pub fn release(&mut self) {
        let now = self.medium.now();
        self.controller.release(now, self.ar()).expect("connected");
        self.run(Duration::from_millis(500));
        self.ar = None;
    }

    /// Sends these outputs for some cycles; the inputs after that.
    ///
    /// # Panics
    /// When there is no connection or the length is not that of the telegram.
    pub fn send(&mut self, outputs: &[u8], cycles: u32) -> Vec<u8> {
        let subslot = self.model.catalogue.device.layout.telegram;
        self.controller
            .set_output(self.ar(), 1, subslot, outputs)
            .expect("the length of the telegram");
        self.run(self.cycle * cycles);
        let (inputs, iops) = self.controller.input(self.ar(), 1, subslot).expect("inputs");
        assert!(iops.is_good());
        inputs.to_vec()
    }

    /// One parameter job through record 0xB02F.
    ///
    /// # Panics
    /// When the drive refuses the record.
    pub fn job(&mut self, request: &[u8]) -> Vec<u8> {
        self.job_at(0xB02F, request)
    }

    /// One parameter job through any record.
    ///
    /// # Panics
    /// When the drive refuses the record.
    pub fn job_at(&mut self, index: u16, request: &[u8]) -> Vec<u8> {
        let at = RecordAddress {
            api: AKD.catalogue.device.api.into(),
            slot: 1,
            subslot: 1,
            index,
        };
        self.events.clear();
        let now = self.medium.now();
        self.controller
            .parameter_job(now, self.ar(), at, request)
            .expect("connected");
        self.run(Duration::from_millis(200));
        let done = self.events.iter().find_map(|event| match event {
            Event::RecordDone { result, .. } => Some(result.clone()),
            _ => None,
        });
        done.expect("answered").expect("positive")
    }

    /// Reads the number of one element, without sign.
    ///
    /// # Panics
    /// When the drive answers with an error.
    pub fn read(&mut self, pnu: u16, subindex: u16) -> u32 {
        let [a, b] = pnu.to_be_bytes();
        let [c, d] = subindex.to_be_bytes();
        let answer = self.job(&[1, 1, 0, 1, 0x10, 1, a, b, c, d]);
        assert_eq!(answer[..4], [1, 1, 0, 1], "PNU {pnu}: {answer:02X?}");
        match answer[4] {
            0x41 => answer[6].into(),
            0x42 => u16::from_be_bytes([answer[6], answer[7]]).into(),
            0x43 => u32::from_be_bytes([answer[6], answer[7], answer[8], answer[9]]),
            other => panic!("PNU {pnu}: format {other:02X}"),
        }
    }

    /// Writes one element as word; the error number when the drive refuses.
    pub fn write_word(&mut self, pnu: u16, subindex: u16, value: u16) -> Option<u16> {
        let [a, b] = pnu.to_be_bytes();
        let [c, d] = subindex.to_be_bytes();
        let [e, f] = value.to_be_bytes();
        let answer = self.job(&[1, 2, 0, 1, 0x10, 1, a, b, c, d, 0x42, 1, e, f]);
        (answer[1] == 0x82).then(|| u16::from_be_bytes([answer[6], answer[7]]))
    }

    /// Ends it, and lets the dissector judge every frame: `target/system/<name>`.
    #[track_caller]
    pub fn judged(self, name: &str) -> PathBuf {
        let file = memory::save(&format!("{name}.pcapng"), &self.frames.lock().unwrap());
        judge::judge(&file).clean().saw("pn_io", 10).saw("pn_rt", 10);
        file
    }

    /// Every frame since the last call, as it was on the wire.
    #[must_use]
    pub fn frames(&mut self) -> Vec<Vec<u8>> {
        let frames = self.frames.lock().unwrap();
        let since = std::mem::replace(&mut self.given, frames.len());
        frames
            .iter()
            .skip(since)
            .map(|(_, frame)| frame.clone())
            .collect()
    }
}
