//! Configuration of a controller: identity, devices and connections.

use alloc::string::String;
use alloc::vec::Vec;
use core::time::Duration;

use crate::cyclic::{SubmoduleSize, Timing};
use crate::{IpSuite, MacAddress};

/// Who a [`Controller`](super::Controller) is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControllerConfig {
    /// Own Ethernet address.
    pub mac: MacAddress,
    /// Own IP configuration.
    pub ip: IpSuite,
    /// Own name of station, sent to devices in a connect.
    pub station_name: String,
    /// Own vendor id.
    pub vendor_id: u16,
    /// Own device id.
    pub device_id: u16,
    /// Own instance.
    pub instance: u16,
    /// Start of all UUIDs and transaction numbers: must differ from one start of the program to the next.
    pub seed: u64,
    /// UDP port calls leave from; 0xC000 or above.
    pub client_port: u16,
    /// Application ARs at most.
    pub max_connections: u16,
    /// Time a call is repeated after, and DCP requests with it.
    pub timeouts: Timeouts,
}

/// Most connections of one controller: each has a frame id of its own.
pub(super) const MAX_CONNECTIONS: u16 = 0x0FFF;

impl ControllerConfig {
    /// Creates a controller with the usual settings: 4,095 connections, 2 s x 3 calls, 1 s x 3 DCP requests.
    #[must_use]
    pub fn new(mac: MacAddress, ip: IpSuite, station_name: &str, seed: u64) -> Self {
        Self {
            mac,
            ip,
            station_name: station_name.into(),
            vendor_id: 0xFFFF,
            device_id: 1,
            instance: 1,
            seed,
            client_port: 0xC000,
            max_connections: MAX_CONNECTIONS,
            timeouts: Timeouts::default(),
        }
    }
}

/// How long a controller waits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timeouts {
    /// A call without answer is sent again after this time.
    pub call: Duration,
    /// How often it is sent.
    pub call_sends: u8,
    /// Maximum time for which a device may answer "working" to a call.
    pub call_limit: Duration,
    /// A DCP Get or Set without answer is sent again after this time.
    pub dcp: Duration,
    /// How often it is sent.
    pub dcp_sends: u8,
    /// How long a parameter job may take altogether.
    pub parameter_job: Duration,
    /// How long, when a name is looked up before connecting, a second station of the same name may take to answer.
    pub name_check: Duration,
}

impl Default for Timeouts {
    fn default() -> Self {
        Self {
            call: Duration::from_secs(2),
            call_sends: 3,
            call_limit: Duration::from_secs(60),
            dcp: Duration::from_secs(1),
            dcp_sends: 3,
            parameter_job: Duration::from_secs(10),
            name_check: Duration::from_millis(10),
        }
    }
}

/// The device to connect to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Target {
    /// Its name of station; needed for every [`Resolve`] but `Trust`.
    pub name: String,
    /// Its Ethernet address; found by name, or taken from its answer, if not given.
    pub mac: Option<MacAddress>,
    /// Its IP configuration; found by name if not set.
    pub ip: IpSuite,
    /// Its vendor id.
    pub vendor_id: u16,
    /// Its device id.
    pub device_id: u16,
    /// Its instance, 1 for nearly all devices.
    pub instance: u16,
}

impl Target {
    /// Returns the device a station found by Identify is.
    #[must_use]
    pub fn of(station: &super::Station) -> Self {
        Self {
            name: station.name.clone(),
            mac: Some(station.mac),
            ip: station.ip,
            vendor_id: station.vendor_id,
            device_id: station.device_id,
            instance: if station.instance == 0 {
                1
            } else {
                station.instance
            },
        }
    }
}

/// What is checked by DCP before connecting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Resolve {
    /// Nothing: address and IP of the target are as given.
    Trust,
    /// The name is looked up: exactly one station must answer, its vendor, device and IP must be as given (an IP of
    /// none in the target takes the station's own).
    #[default]
    Check,
    /// The same, but a station with another IP gets the target's, temporarily.
    SetIp,
}

/// Order of the start-up and meaning of time-outs in it.
///
/// Source: IEC 61158-6-10, ARProperties.StartupMode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StartUp {
    /// StartupMode 0.
    Legacy,
    /// StartupMode 1.
    #[default]
    Advanced,
}

/// Class of the cyclic frames.
///
/// Source: IEC 61158-6-10, IOCRProperties.RTClass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RtClass {
    /// FrameIDs from 0xC000; only with legacy start-up.
    Class1,
    /// FrameIDs from 0x8000.
    #[default]
    Class2,
}

/// One module the device shall have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModuleConfig {
    /// Application process identifier of its submodules.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// ModuleIdentNumber.
    pub ident: u32,
    /// What is in it.
    pub submodules: Vec<SubmoduleConfig>,
}

/// One submodule of a [`ModuleConfig`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SubmoduleConfig {
    /// Subslot.
    pub subslot: u16,
    /// SubmoduleIdentNumber.
    pub ident: u32,
    /// Octets it sends.
    pub input_length: u16,
    /// Octets it receives.
    pub output_length: u16,
}

/// A record written between connect and the end of parameterization.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StartupRecord {
    /// Application process identifier.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Index.
    pub index: u16,
    /// Content.
    pub data: Vec<u8>,
}

/// How to connect cyclically.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConnectConfig {
    /// What the device shall be made of, in slot order.
    pub modules: Vec<ModuleConfig>,
    /// Interval of the frames in both directions.
    pub timing: Timing,
    /// WatchdogFactor, sent to the device; usually 3.
    pub watchdog_factor: u16,
    /// DataHoldFactor: intervals without a frame until the connection is lost, on both sides; 3 usually.
    pub data_hold_factor: u16,
    /// Start-up mode.
    pub start_up: StartUp,
    /// Class of the frames.
    pub rt_class: RtClass,
    /// Records to write before the device becomes ready.
    pub records: Vec<StartupRecord>,
    /// What to check first.
    pub resolve: Resolve,
    /// CMInitiatorActivityTimeoutFactor x 100 ms: the device gives the start-up up after so much silence; 1 to 1000.
    pub activity_timeout_factor: u16,
    /// How long the device may take to become ready.
    pub ready_limit: Duration,
    /// RTATimeoutFactor x 100 ms, 1 to 100.
    pub rta_timeout_factor: u16,
    /// RTARetries, 3 to 15.
    pub rta_retries: u16,
    /// Longest alarm in octets, 200 to 1432.
    pub max_alarm_length: u16,
    /// Outputs are valid (run, IOPS good) as soon as the device is ready; else after
    /// [`set_run`](super::Controller::set_run).
    pub run: bool,
    /// Stays in the start-up, where records are read and written, until
    /// [`end_start_up`](super::Controller::end_start_up). The device exchanges no data until then.
    pub hold_start_up: bool,
}

impl ConnectConfig {
    /// Returns the usual settings of a PLC: advanced start-up, class 2, three intervals, 20 s activity, 300 s to get
    /// ready.
    #[must_use]
    pub const fn new(modules: Vec<ModuleConfig>, timing: Timing) -> Self {
        Self {
            modules,
            timing,
            watchdog_factor: 3,
            data_hold_factor: 3,
            start_up: StartUp::Advanced,
            rt_class: RtClass::Class2,
            records: Vec::new(),
            resolve: Resolve::Check,
            activity_timeout_factor: 200,
            ready_limit: Duration::from_secs(300),
            rta_timeout_factor: 1,
            rta_retries: 3,
            max_alarm_length: 200,
            run: true,
            hold_start_up: false,
        }
    }

    /// Creates a connection for the records of a device that accepts none for records alone: the start-up is held, and
    /// the outputs never become valid (IOPS bad, provider stopped). The device never receives a valid control word, not
    /// even a stop, and detects no change from run to stop at the release.
    #[must_use]
    pub const fn for_records(modules: Vec<ModuleConfig>, timing: Timing) -> Self {
        let mut config = Self::new(modules, timing);
        config.run = false;
        config.hold_start_up = true;
        config
    }

    /// As [`new`](Self::new) with legacy start-up and class 1.
    #[must_use]
    pub const fn legacy(modules: Vec<ModuleConfig>, timing: Timing) -> Self {
        let mut config = Self::new(modules, timing);
        config.start_up = StartUp::Legacy;
        config.rt_class = RtClass::Class1;
        config
    }

    /// Returns all submodules with their lengths, in slot order.
    pub fn sizes(&self) -> impl Iterator<Item = SubmoduleSize> + '_ {
        self.modules.iter().flat_map(|module| {
            module.submodules.iter().map(|sub| {
                SubmoduleSize::new(
                    module.api,
                    module.slot,
                    sub.subslot,
                    sub.input_length,
                    sub.output_length,
                )
            })
        })
    }
}
