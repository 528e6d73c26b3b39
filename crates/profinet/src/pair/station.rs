//! The device of these tests, and how a controller is commanded to use it.

use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;
use core::net::SocketAddrV4;
use core::time::Duration;

use crate::controller::{ConnectConfig, ModuleConfig, SubmoduleConfig, Target};
use crate::cyclic::Timing;
use crate::device::{
    self, ArKey, Device, DeviceConfig, Identity, ModuleDescription, Stored, SubmoduleDescription,
};
use crate::wire::PnioStatus;
use crate::wire::rt::Iops;
use crate::wire::status::record;
use crate::{Endpoint, Instant, IpSuite, MacAddress, Transmit};

pub(super) const PLC: MacAddress = MacAddress([2, 0x50, 0x4e, 0, 0, 2]);
pub(super) const DRIVE: MacAddress = MacAddress([2, 0x50, 0x4e, 0, 0, 1]);

pub(super) fn ip(last: u8) -> IpSuite {
    IpSuite {
        address: [192, 168, 77, last].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0; 4].into(),
    }
}

/// A device with an application that answers parameter jobs after some reads and mirrors its output.
pub(super) struct Station {
    pub(super) device: Device,
    jobs: BTreeMap<ArKey, (Vec<u8>, u32)>,
    pub(super) not_ready: u32,
    pub(super) events: Vec<device::Event>,
}

impl Station {
    pub(super) fn new(name: &str, suite: IpSuite) -> Self {
        Self::with_mac(DRIVE, name, suite)
    }

    pub(super) fn with_mac(mac: MacAddress, name: &str, suite: IpSuite) -> Self {
        let none = |subslot, ident| SubmoduleDescription {
            subslot,
            ident,
            api: 0,
            input_length: 0,
            output_length: 0,
        };
        let telegram = SubmoduleDescription {
            subslot: 1,
            ident: 0x11,
            api: 0x3A00,
            input_length: 4,
            output_length: 4,
        };
        let modules = vec![
            ModuleDescription {
                ident: 1,
                slots: vec![0],
                submodules: vec![none(1, 1), none(0x8000, 2), none(0x8001, 3)],
            },
            ModuleDescription {
                ident: 0x10,
                slots: vec![1],
                submodules: vec![telegram],
            },
        ];
        let identity = Identity {
            vendor_id: 0x0105,
            device_id: 1,
            instance: 1,
            station_type: "AKD".into(),
            order_id: "AKD-P00306".into(),
            serial_number: "1".into(),
            hardware_revision: 1,
            software_prefix: 'V',
            software_revision: [1, 2, 3],
            profile_id: 0x3A00,
            profile_specific_type: 0,
        };
        let stored = Stored {
            name: name.into(),
            ip: suite,
            ..Stored::default()
        };
        let device = Device::new(DeviceConfig::new(mac, identity, modules), stored);
        Self {
            device,
            jobs: BTreeMap::new(),
            not_ready: 0,
            events: vec![],
        }
    }

    fn work(&mut self, now: Instant) {
        while let Some(event) = self.device.poll_event() {
            match &event {
                device::Event::ParameterEnd { ar } => {
                    self.device.set_input(1, 1, &[0, 0, 0, 0], Iops::GOOD);
                    self.device.application_ready(now, *ar);
                }
                device::Event::RecordWrite { token, ar, data, .. } => {
                    self.jobs.insert(*ar, (data.clone(), self.not_ready));
                    self.device.answer_write(now, *token, Ok(()));
                }
                device::Event::RecordRead { token, ar, .. } => {
                    let job = ar.and_then(|ar| self.jobs.get_mut(&ar));
                    match job {
                        Some((data, 0)) => {
                            let data = data.clone();
                            self.device.answer_read(now, *token, Ok(&data));
                        }
                        Some((_, wait)) => {
                            *wait -= 1;
                            let busy = PnioStatus::read(record::STATE_CONFLICT);
                            self.device.answer_read(now, *token, Err(busy));
                        }
                        None => {
                            let none = PnioStatus::read(record::STATE_CONFLICT);
                            self.device.answer_read(now, *token, Err(none));
                        }
                    }
                }
                _ => {}
            }
            self.events.push(event);
        }
        if let Some((output, iops)) = self.device.output(1, 1) {
            let mirrored = [output[0], output[1], output[2], output[3]];
            if iops.is_good() {
                self.device.set_input(1, 1, &mirrored, Iops::GOOD);
            }
        }
    }
}

impl Endpoint for Station {
    fn mac(&self) -> MacAddress {
        self.device.mac()
    }
    fn ip(&self) -> IpSuite {
        self.device.ip()
    }
    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        self.device.handle_frame(now, frame);
        self.work(now);
    }
    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]) {
        self.device.handle_datagram(now, source, local_port, payload);
        self.work(now);
    }
    fn handle_timeout(&mut self, now: Instant) {
        self.device.handle_timeout(now);
        self.work(now);
    }
    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        self.device.poll_transmit(now, buffer)
    }
    fn poll_timeout(&self) -> Option<Instant> {
        self.device.poll_timeout()
    }
}

pub(super) fn target() -> Target {
    Target {
        name: "drive-1".into(),
        mac: None,
        ip: IpSuite::NONE,
        vendor_id: 0x0105,
        device_id: 1,
        instance: 1,
    }
}

pub(super) fn config(milliseconds: u64) -> ConnectConfig {
    let none = |subslot, ident| SubmoduleConfig {
        subslot,
        ident,
        input_length: 0,
        output_length: 0,
    };
    let telegram = SubmoduleConfig {
        subslot: 1,
        ident: 0x11,
        input_length: 4,
        output_length: 4,
    };
    let modules = vec![
        ModuleConfig {
            api: 0,
            slot: 0,
            ident: 1,
            submodules: vec![none(1, 1), none(0x8000, 2), none(0x8001, 3)],
        },
        ModuleConfig {
            api: 0x3A00,
            slot: 1,
            ident: 0x10,
            submodules: vec![telegram],
        },
    ];
    ConnectConfig::new(
        modules,
        Timing::for_interval(Duration::from_millis(milliseconds)).unwrap(),
    )
}
