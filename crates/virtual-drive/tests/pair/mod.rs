//! A station and a controller that exchange data, for tests and benches: frames are handed over in virtual time.

use std::net::SocketAddrV4;
use std::time::Duration;

use profidrive_virtual_drive::model::AKD;
use profidrive_virtual_drive::station::{Station, StationConfig};
use profinet::controller::{
    ArId, ConnectConfig, Controller, ControllerConfig, ModuleConfig, Resolve, SubmoduleConfig, Target,
};
use profinet::cyclic::Timing;
use profinet::device::Stored;
use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Transmit};

/// The station.
pub const DRIVE: MacAddress = MacAddress([2, 0, 0, 0, 0, 1]);

/// Both ends and the time.
pub struct Pair {
    /// The drive.
    pub station: Station,
    controller: Controller,
    #[allow(dead_code)]
    ar: ArId,
    now: Instant,
    interval: Duration,
    buffer: [u8; MAX_FRAME],
}

impl Pair {
    // not every test that has this module uses all of it
    #[allow(dead_code)]
    /// Connected with telegram 1 at this interval; data is exchanged.
    pub fn new(interval: Duration) -> Self {
        let mut config = StationConfig::new(&AKD, DRIVE);
        config.min_device_interval = Some(32);
        let device = &AKD.catalogue.device;
        let module = device.telegram(1).expect("telegram 1");
        let sub = |subslot, ident| SubmoduleConfig {
            subslot,
            ident,
            input_length: 0,
            output_length: 0,
        };
        let modules = vec![
            ModuleConfig {
                api: 0,
                slot: 0,
                ident: device.access_point_module,
                submodules: vec![
                    sub(1, device.access_point_submodule),
                    sub(0x8000, device.interface_submodule),
                    sub(0x8001, device.port_submodule),
                ],
            },
            ModuleConfig {
                api: u32::from(device.api),
                slot: 1,
                ident: module.module,
                submodules: vec![SubmoduleConfig {
                    input_length: module.inputs,
                    output_length: module.outputs,
                    ..sub(1, module.submodule)
                }],
            },
        ];
        Self::connected(config, modules, interval)
    }

    /// Returns the same with another station and other modules; any telegram in slot 1.
    pub fn connected(mut config: StationConfig, modules: Vec<ModuleConfig>, interval: Duration) -> Self {
        let mask = [255, 255, 255, 0].into();
        let suite = |last| IpSuite {
            address: [10, 0, 0, last].into(),
            mask,
            gateway: [0; 4].into(),
        };
        config.network = Stored {
            name: "akd-1".into(),
            ip: suite(1),
            ..Stored::default()
        };
        let target = Target {
            name: "akd-1".into(),
            mac: Some(DRIVE),
            ip: suite(1),
            vendor_id: config.description.identity.vendor_id,
            device_id: config.description.identity.device_id,
            instance: config.description.identity.instance,
        };
        let station = Station::new(config);
        let plc = ControllerConfig::new(MacAddress([2, 0, 0, 0, 0, 2]), suite(2), "plc", 1);
        let mut controller = Controller::new(plc);
        let timing = Timing::for_interval(interval).expect("an interval of PROFINET");
        let mut config = ConnectConfig::new(modules, timing);
        config.resolve = Resolve::Trust;
        let now = Instant::from_millis(1);
        let ar = controller.connect(now, target, config).expect("connects");
        let mut pair = Self {
            station,
            controller,
            ar,
            now,
            interval,
            buffer: [0; MAX_FRAME],
        };
        while !pair.station.device().is_exchanging() {
            pair.cycle(|_, work| work());
            assert!(pair.now < Instant::from_millis(10_000), "no data exchange");
        }
        pair
    }

    #[allow(dead_code)]
    /// Sets STW1 and NSOLL_A.
    pub fn send(&mut self, outputs: [u8; 4]) {
        self.controller
            .set_output(self.ar, 1, 1, &outputs)
            .expect("connected");
    }

    /// One interval; everything the station does goes through `watch`, with the name of the call.
    pub fn cycle(&mut self, mut watch: impl FnMut(&str, &mut dyn FnMut())) {
        let end = self.now + self.interval;
        loop {
            let mut quiet = true;
            while let Some(sent) = self.controller.poll_transmit(self.now, &mut self.buffer) {
                quiet = false;
                let (now, buffer, station) = (self.now, &self.buffer, &mut self.station);
                let source = self.controller.ip();
                watch("receive", &mut || hand_over(now, sent, buffer, source, station));
            }
            loop {
                let mut sent = None;
                let (now, buffer, station) = (self.now, &mut self.buffer, &mut self.station);
                watch("transmit", &mut || sent = station.poll_transmit(now, buffer));
                let Some(sent) = sent else { break };
                quiet = false;
                hand_over(
                    self.now,
                    sent,
                    &self.buffer,
                    self.station.ip(),
                    &mut self.controller,
                );
            }
            while self.controller.poll_event().is_some() {}
            while self.station.poll_event().is_some() {}
            if !quiet {
                continue;
            }
            let (mut due, station) = (None, &self.station);
            watch("deadline", &mut || due = station.poll_timeout());
            let next = [self.controller.poll_timeout(), due].into_iter().flatten().min();
            let Some(next) = next.filter(|next| *next <= end) else {
                break;
            };
            self.now = next.max(self.now);
            self.controller.handle_timeout(self.now);
            let (now, station) = (self.now, &mut self.station);
            if due.is_some_and(|due| due <= now) {
                watch("step", &mut || station.handle_timeout(now));
            }
        }
        self.now = end;
    }
}

fn hand_over(now: Instant, sent: Transmit, buffer: &[u8], source: IpSuite, to: &mut dyn Endpoint) {
    match sent {
        Transmit::Frame { length } => to.handle_frame(now, &buffer[..length]),
        Transmit::Datagram {
            destination,
            source_port,
            length,
        } => {
            let source = SocketAddrV4::new(source.address, source_port);
            to.handle_datagram(now, source, destination.port(), &buffer[..length]);
        }
    }
}
