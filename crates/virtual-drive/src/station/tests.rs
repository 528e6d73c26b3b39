//! The station against our own controller, frames handed over in virtual time without a network.

use std::net::SocketAddrV4;
use std::time::Duration;

use profile::state::State;
use profinet::controller::{
    ConnectConfig, Controller, ControllerConfig, Event, ModuleConfig, RecordAddress, Resolve,
    SubmoduleConfig, Target,
};
use profinet::cyclic::Timing;
use profinet::{Endpoint, IpSuite, MAX_FRAME, MacAddress, Transmit};

use super::*;
use crate::model::AKD;

const DRIVE: MacAddress = MacAddress([2, 0, 0, 0, 0, 1]);
const PLC: MacAddress = MacAddress([2, 0, 0, 0, 0, 2]);

fn suite(last: u8) -> IpSuite {
    IpSuite {
        address: [192, 168, 0, last].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0, 0, 0, 0].into(),
    }
}

pub(super) struct Plant {
    pub(super) now: Instant,
    pub(super) station: Station,
    pub(super) controller: Controller,
    pub(super) events: Vec<Event>,
    station_events: Vec<StationEvent>,
    /// The cable is plugged.
    cable: bool,
}

impl Plant {
    pub(super) fn new() -> Self {
        Self::of(&AKD)
    }

    pub(super) fn of(model: &'static Model) -> Self {
        let mut config = StationConfig::new(model, DRIVE);
        config.network = Stored {
            name: "akd-1".into(),
            ip: suite(1),
            ..Stored::default()
        };
        Self::with(config)
    }

    fn with(config: StationConfig) -> Self {
        Self {
            now: Instant::from_millis(1000),
            station: Station::new(config),
            controller: Controller::new(ControllerConfig::new(PLC, suite(2), "plc", 7)),
            events: Vec::new(),
            station_events: Vec::new(),
            cable: true,
        }
    }

    fn carry(&mut self) {
        let mut buffer = [0; MAX_FRAME];
        loop {
            let mut quiet = true;
            while let Some(sent) = self.controller.poll_transmit(self.now, &mut buffer) {
                quiet = false;
                let source = self.controller.ip();
                if self.cable {
                    hand_over(self.now, sent, &buffer, source, &mut self.station);
                }
            }
            while let Some(sent) = self.station.poll_transmit(self.now, &mut buffer) {
                quiet = false;
                let source = self.station.ip();
                if self.cable {
                    hand_over(self.now, sent, &buffer, source, &mut self.controller);
                }
            }
            if quiet {
                break;
            }
        }
        self.events
            .extend(core::iter::from_fn(|| self.controller.poll_event()));
        self.station_events
            .extend(core::iter::from_fn(|| self.station.poll_event()));
    }

    /// Returns the saves that the station has asked its owner for.
    pub(super) fn saves(&self) -> Vec<SaveId> {
        let save = |event: &StationEvent| match event {
            StationEvent::PersistParameters { save, .. } => Some(*save),
            _ => None,
        };
        self.station_events.iter().filter_map(save).collect()
    }

    /// Numbers of the saves of name and address.
    pub(super) fn network_saves(&self) -> Vec<SaveId> {
        let save = |event: &StationEvent| match event {
            StationEvent::PersistNetwork { save, .. } => Some(*save),
            _ => None,
        };
        self.station_events.iter().filter_map(save).collect()
    }

    /// Lets time pass.
    pub(super) fn run(&mut self, time: Duration) {
        let end = self.now + time;
        self.carry();
        loop {
            let next = [self.controller.poll_timeout(), self.station.poll_timeout()]
                .into_iter()
                .flatten()
                .min();
            match next.filter(|next| *next <= end) {
                Some(next) => self.now = next.max(self.now),
                None => break,
            }
            self.controller.handle_timeout(self.now);
            self.station.handle_timeout(self.now);
            self.carry();
        }
        self.now = end;
    }

    pub(super) fn seconds(&mut self, seconds: f64) {
        self.run(Duration::from_secs_f64(seconds));
    }

    pub(super) fn connect(&mut self, telegram: u16) -> profinet::controller::ArId {
        let ar = self.begin(telegram);
        self.seconds(0.5);
        assert!(self.events.contains(&Event::Running { ar }), "{:?}", self.events);
        ar
    }

    /// Only requests the connection.
    fn begin(&mut self, telegram: u16) -> profinet::controller::ArId {
        let device = &self.station.drive().model().catalogue.device;
        let module = device.telegram(telegram).unwrap();
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
                    subslot: 1,
                    ident: module.submodule,
                    input_length: module.inputs,
                    output_length: module.outputs,
                }],
            },
        ];
        let target = Target {
            name: "akd-1".into(),
            mac: Some(DRIVE),
            ip: suite(1),
            vendor_id: device.vendor_id,
            device_id: device.device_id,
            instance: 1,
        };
        let timing = Timing::for_interval(Duration::from_millis(16)).unwrap();
        let mut config = ConnectConfig::new(modules, timing);
        config.resolve = Resolve::Trust;
        self.controller.connect(self.now, target, config).unwrap()
    }

    pub(super) fn send(
        &mut self,
        ar: profinet::controller::ArId,
        control: u16,
        speed: i16,
        seconds: f64,
    ) -> (u16, i16) {
        let [a, b] = control.to_be_bytes();
        let [c, d] = speed.to_be_bytes();
        self.controller.set_output(ar, 1, 1, &[a, b, c, d]).unwrap();
        self.seconds(seconds);
        match self.controller.input(ar, 1, 1) {
            Some((&[a, b, c, d, ..], _)) => (u16::from_be_bytes([a, b]), i16::from_be_bytes([c, d])),
            other => panic!("{other:?}"),
        }
    }

    fn job(&mut self, ar: profinet::controller::ArId, index: u16, request: &[u8]) -> Vec<u8> {
        let at = RecordAddress {
            api: 0x3A00,
            slot: 1,
            subslot: 1,
            index,
        };
        self.events.clear();
        self.controller.parameter_job(self.now, ar, at, request).unwrap();
        self.seconds(0.3);
        let done = self.events.iter().find_map(|event| match event {
            Event::RecordDone { result, .. } => Some(result.clone()),
            _ => None,
        });
        done.expect("answered").expect("positive")
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

#[test]
fn sixty_rpm_over_profinet() {
    let mut plant = Plant::new();
    let ar = plant.connect(1);
    assert!(
        plant
            .station_events
            .contains(&StationEvent::Exchanging { telegram: 1 })
    );
    assert_eq!(plant.send(ar, 0x047E, 0, 0.2).0 & 0x0077, 0x0031);
    let (status, speed) = plant.send(ar, 0x047F, 164, 2.0);
    assert_eq!(status & 0x077F, 0x0737, "{status:#06x}");
    assert!((160..=168).contains(&speed), "{speed}");
    assert_eq!(plant.send(ar, 0x047E, 0, 1.0).0 & 0x0077, 0x0031);
    plant.controller.release(plant.now, ar).unwrap();
    plant.seconds(0.5);
    assert!(
        plant.events.contains(&Event::Released { ar }),
        "{:?}",
        plant.events
    );
    assert!(!plant.station.drive().has_fault());
    plant.seconds(120.0); // answers are kept a while for repeated requests
    assert_eq!(plant.station.drive().next_tick(), None, "idle again");
    // what is left is the word to the neighbour every 5 s
    let next = plant.station.poll_timeout().unwrap();
    assert!(next > plant.now && next <= plant.now + Duration::from_secs(5));
}

#[test]
fn parameters_by_all_three_records() {
    let mut plant = Plant::new();
    let ar = plant.connect(1);
    for index in INDICES {
        let answer = plant.job(ar, index, &[1, 1, 0, 1, 0x10, 1, 0x03, 0x9A, 0, 0]);
        assert_eq!(answer, [1, 1, 0, 1, 0x42, 1, 0, 1]);
    }
    let answer = plant.job(ar, 0xB02F, &[2, 1, 0, 1, 0x10, 1, 0x0B, 0xCE, 0, 0]); // PN.TIMEOUTFTHRESH
    assert_eq!(answer, [2, 1, 0, 1, 0x43, 1, 0, 0, 0, 48]);
    plant.job(
        ar,
        0xB02E,
        &[3, 2, 0, 1, 0x10, 1, 0x09, 0xA5, 0, 0, 0x42, 1, 0, 1],
    ); // DRV.NVSAVE
    assert!(
        plant
            .station_events
            .iter()
            .any(|event| matches!(event, StationEvent::PersistParameters { .. }))
    );
}

#[test]
fn a_pulled_cable_ends_in_fault_702_and_both_recover() {
    let mut plant = Plant::new();
    let ar = plant.connect(1);
    plant.send(ar, 0x047E, 0, 0.2);
    plant.send(ar, 0x047F, 1638, 1.0);
    plant.cable = false;
    plant.seconds(1.0);
    assert!(
        plant
            .events
            .iter()
            .any(|event| matches!(event, Event::Lost { .. }))
    );
    assert!(
        plant
            .station_events
            .contains(&StationEvent::Fault { number: 702 })
    );
    assert_eq!(plant.station.drive().state(), State::S1);
    assert!(plant.station.drive().axis().is_at_rest());
    let next = plant.station.poll_timeout();
    assert!(
        next.is_none_or(|next| next > plant.now + Duration::from_secs(1)),
        "idle"
    );
    plant.cable = true;
    plant.seconds(1.0);
    plant.events.clear();
    let ar = plant.connect(1);
    assert_eq!(plant.send(ar, 0x047E, 0, 0.2).0 & 0x0008, 0x0008);
    assert_eq!(plant.send(ar, 0x04FE, 0, 0.2).0 & 0x0008, 0);
    plant.send(ar, 0x047E, 0, 0.2);
    assert_eq!(plant.send(ar, 0x047F, 164, 1.0).0 & 0x0077, 0x0037);
}

#[test]
fn a_controller_in_stop_ramps_the_axis_down() {
    let mut plant = Plant::new();
    let ar = plant.connect(1);
    plant.send(ar, 0x047E, 0, 0.2);
    plant.send(ar, 0x047F, 1638, 1.0);
    plant.controller.set_run(ar, false).unwrap();
    plant.seconds(0.6);
    assert!(!plant.station.drive().is_enabled() && !plant.station.drive().has_fault());
    plant.controller.set_run(ar, true).unwrap();
    assert_eq!(plant.send(ar, 0x047F, 1638, 0.5).0 & 0x0077, 0x0070);
}

#[test]
fn another_telegram_is_plugged_by_the_controller() {
    let mut plant = Plant::new();
    plant.connect(350);
    assert!(
        plant
            .station_events
            .contains(&StationEvent::Exchanging { telegram: 350 })
    );
}

#[test]
fn named_and_addressed_and_both_are_kept() {
    let mut plant = Plant::with(StationConfig::new(&AKD, DRIVE));
    plant
        .controller
        .dcp_set_name(plant.now, DRIVE, "akd-7", true)
        .unwrap();
    plant.seconds(2.0);
    plant
        .controller
        .dcp_set_ip(plant.now, DRIVE, suite(9), true)
        .unwrap();
    plant.seconds(2.0);
    let kept = plant.station_events.iter().rev().find_map(|event| match event {
        StationEvent::PersistNetwork { network, .. } => Some(network.clone()),
        _ => None,
    });
    let kept = kept.expect("a save event");
    assert_eq!((kept.name.as_str(), kept.ip.address), ("akd-7", suite(9).address));
    assert_eq!(plant.station.name(), "akd-7");
    plant.controller.dcp_signal(plant.now, DRIVE).unwrap();
    plant.seconds(2.0);
    assert!(plant.station_events.contains(&StationEvent::Blink));
}

#[test]
fn saved_parameters_are_restored_and_damage_is_reported() {
    let mut drive = Drive::new(&AKD);
    drive.reset_to_delivery();
    let Some(crate::drive::Event::Save { text, .. }) = drive.poll_event() else {
        panic!("saves")
    };
    let mut config = StationConfig::new(&AKD, DRIVE);
    config.parameters = Some(text.clone().into_bytes());
    assert_eq!(Station::new(config.clone()).poll_event(), None);
    config.parameters = Some(text.replace("3000.000", "9000.000").into_bytes());
    assert!(matches!(
        Station::new(config).poll_event(),
        Some(StationEvent::ParametersIgnored(_))
    ));
}

#[test]
fn a_drive_that_shall_not_use_the_address_of_dcp_starts_without_one() {
    let mut drive = Drive::new(&AKD);
    let save = |drive: &mut Drive| {
        // DRV.NVSAVE
        drive
            .serve(
                &[1, 2, 0, 1, 0x10, 1, 0x09, 0xA5, 0, 0, 0x42, 1, 0, 1],
                &mut [0; 240],
            )
            .unwrap();
        core::iter::from_fn(|| drive.poll_event()).find_map(|event| match event {
            crate::drive::Event::Save { text, .. } => Some(text),
            _ => None,
        })
    };
    // IP.MODE 0
    drive
        .serve(
            &[1, 2, 0, 1, 0x10, 1, 0x0A, 0x2E, 0, 0, 0x42, 1, 0, 0],
            &mut [0; 240],
        )
        .unwrap();
    let config = |text: String| StationConfig {
        network: Stored {
            name: "akd-1".into(),
            ip: suite(1),
            ..Stored::default()
        },
        parameters: Some(text.into_bytes()),
        ..StationConfig::new(&AKD, DRIVE)
    };
    let mut station = Station::new(config(save(&mut drive).unwrap()));
    assert_eq!((station.ip(), station.name()), (IpSuite::NONE, "akd-1"));
    // DCP sets an address for good: IP.MODE is 1, in the memory too.
    station.device_event(
        Instant::from_millis(1),
        DeviceEvent::IpChanged {
            suite: suite(7),
            permanent: true,
        },
    );
    station.settle(Instant::from_millis(1));
    let station_events: Vec<StationEvent> = core::iter::from_fn(|| station.poll_event()).collect();
    let text = station_events.iter().find_map(|event| match event {
        StationEvent::PersistParameters { text, .. } => Some(text.clone()),
        _ => None,
    });
    assert!(station_events.iter().any(
        |event| matches!(event, StationEvent::PersistNetwork { network, .. } if network.ip == suite(7))
    ));
    assert_eq!(Station::new(config(text.unwrap())).ip(), suite(1));
}

#[test]
fn only_a_connection_that_exchanged_data_can_be_lost() {
    let (mut broken, mut lost) = (0, 0);
    for cut in 0..60_u32 {
        let mut plant = Plant::new();
        plant.begin(1);
        plant.run(Duration::from_micros(500) * cut);
        let known = plant
            .station_events
            .iter()
            .any(|event| matches!(event, StationEvent::Connected { .. }));
        plant.cable = false;
        plant.seconds(2.0);
        let exchanged = plant
            .station_events
            .iter()
            .any(|event| matches!(event, StationEvent::Exchanging { .. }));
        assert_eq!(
            plant.station.drive().has_fault(),
            exchanged,
            "cut after {cut} half milliseconds"
        );
        broken += usize::from(known && !exchanged);
        lost += usize::from(exchanged);
    }
    assert!(broken > 0 && lost > 0, "{broken} broken off, {lost} lost");
}

#[test]
fn resets_clear_by_mode() {
    for (mode, keeps_name, keeps_parameters) in [
        (ResetMode::ApplicationData, true, false),
        (ResetMode::Communication, false, true),
        (ResetMode::AllStored, false, false),
        (ResetMode::Device, false, false),
    ] {
        let mut plant = Plant::new();
        let now = plant.now;
        let drive = plant.station.drive_mut();
        // DRV.ACC 5000 rpm/s, then DRV.NVSAVE
        let change = [
            1, 2, 0, 1, 0x10, 1, 0x08, 0x3C, 0, 0, 0x43, 1, 0, 0x4C, 0x4B, 0x40,
        ];
        drive.serve(&change, &mut [0; 240]).unwrap();
        let save = [1, 2, 0, 1, 0x10, 1, 0x09, 0xA5, 0, 0, 0x42, 1, 0, 1];
        drive.serve(&save, &mut [0; 240]).unwrap();
        plant.station.settle(now);
        plant
            .station
            .device_event(now, DeviceEvent::FactoryReset { mode });
        plant.station.settle(now);
        let station_events: Vec<StationEvent> = core::iter::from_fn(|| plant.station.poll_event()).collect();
        let network = station_events.iter().rev().find_map(|event| match event {
            StationEvent::PersistNetwork { network, .. } => Some(network.clone()),
            _ => None,
        });
        let parameters = station_events.iter().rev().find_map(|event| match event {
            StationEvent::PersistParameters { text, .. } => Some(text.clone()),
            _ => None,
        });
        let network = network.unwrap();
        assert_eq!(network.name == "akd-1", keeps_name, "{mode:?}");
        assert_eq!(network.ip == suite(1), keeps_name, "{mode:?}");
        let text = parameters.unwrap();
        assert_eq!(text.contains("DRV.ACC = 5000.000"), keeps_parameters, "{mode:?}");
    }
}

/// 9-72 (PNU 972): 1 resets the drive after the answer, and it reads as 0; the other choices of the table do nothing.
#[test]
fn a_vlt_restarts_by_9_72_with_its_saved_values() {
    let mut plant = Plant::of(&crate::model::VLT);
    let ar = plant.connect(1);
    // 3-41 for good, 3-42 in RAM
    let saved = [1, 0x42, 0, 1, 0x10, 1, 0x01, 0x55, 0, 0, 7, 1, 0, 0, 1, 0xF4];
    let lost = [2, 2, 0, 1, 0x10, 1, 0x01, 0x56, 0, 0, 7, 1, 0, 0, 2, 0x58];
    let reset = |value| [3, 2, 0, 1, 0x10, 1, 0x03, 0xCC, 0, 0, 5, 1, value, 0];
    assert_eq!(plant.job(ar, 0xB02F, &saved), [1, 2, 0, 1]);
    assert_eq!(plant.job(ar, 0xB02F, &lost), [2, 2, 0, 1]);
    assert_eq!(plant.job(ar, 0xB02F, &reset(3)), [3, 2, 0, 1]);
    plant.seconds(1.0);
    assert!(plant.station.device().is_exchanging(), "3 resets the option only");
    assert_eq!(plant.job(ar, 0xB02F, &reset(1)), [3, 2, 0, 1], "answered first");
    plant.seconds(2.0);
    assert!(!plant.station.device().is_exchanging(), "the connection is lost");
    let ar = plant.connect(1);
    let read = [
        4, 1, 0, 3, 0x10, 1, 0x01, 0x55, 0, 0, 0x10, 1, 0x01, 0x56, 0, 0, 0x10, 1, 0x03, 0xCC, 0, 0,
    ];
    let values = [4, 1, 0, 3, 7, 1, 0, 0, 1, 0xF4, 7, 1, 0, 0, 1, 0x2C, 5, 1, 0, 0];
    assert_eq!(plant.job(ar, 0xB02F, &read), values);
    // 15-03: it counts as a power-up, and what was counted before is not lost
    let counted = plant.job(ar, 0xB02F, &[5, 1, 0, 1, 0x10, 1, 0x05, 0xDF, 0, 0]);
    assert_eq!(counted[counted.len() - 4..], [0, 0, 0, 2]);
}

/// 9-75 (PNU 975): vendor, unit type, version, year, day and month, type class 1 (axis), sub-class 1, axis 0.
#[test]
fn a_vlt_identifies_its_drive_object() {
    let mut plant = Plant::of(&crate::model::VLT);
    let ar = plant.connect(1);
    let words = |bytes: &[u8]| -> Vec<u16> {
        let words = bytes.chunks_exact(2);
        words.map(|word| u16::from_be_bytes([word[0], word[1]])).collect()
    };
    let unit = plant.job(ar, 0xB02F, &[1, 1, 0, 1, 0x10, 5, 0x03, 0xC4, 0, 0]);
    let object = plant.job(ar, 0xB02F, &[2, 1, 0, 1, 0x10, 8, 0x03, 0xCF, 0, 0]);
    assert_eq!(
        (unit[4..6].to_vec(), object[4..6].to_vec()),
        (vec![6, 5], vec![6, 8])
    );
    let (unit, object) = (words(&unit[6..]), words(&object[6..]));
    assert_eq!(
        (unit[0], unit[1]),
        (crate::model::VLT.catalogue.device.vendor_id, 302)
    );
    assert_eq!(object[..5], unit[..]);
    assert_eq!(object[5..], [1, 1, 0]);
    // beyond its elements
    let beyond = plant.job(ar, 0xB02F, &[3, 1, 0, 1, 0x10, 1, 0x03, 0xCF, 0, 8]);
    assert_eq!(beyond, [3, 0x81, 0, 1, 0x44, 2, 0, 3, 0, 8]);
    // and it is not written
    let written = plant.job(ar, 0xB02F, &[4, 2, 0, 1, 0x10, 1, 0x03, 0xCF, 0, 0, 6, 1, 0, 1]);
    assert_eq!(written, [4, 0x82, 0, 1, 0x44, 1, 0, 1]);
}

#[test]
fn events_that_nobody_takes_are_bounded_and_the_oldest_go() {
    let mut station = Station::new(StationConfig::new(&AKD, DRIVE));
    let exchanging = |telegram| StationEvent::Exchanging { telegram };
    for telegram in 0..300 {
        station.emit(exchanging(telegram));
    }
    let events: Vec<StationEvent> = core::iter::from_fn(|| station.poll_event()).collect();
    assert_eq!(events, (44..300).map(exchanging).collect::<Vec<_>>());
}
