//! Our controller as a program, for the tests: connects to one or many devices, exchanges data, reads records, and says
//! what happened in one JSON object a line.
//!
//! `test-controller INTERFACE pnio|akd NAME[,NAME...] [key=value ...]` with `cycle_us`, `seconds`, `hold` (intervals),
//! `records` (reads of I&M0 for each device), `reconnect` (1: after a loss wait for the device and connect again, once),
//! `hammer` (1: look for the device every 2 ms instead of once), `speed` (akd: runs at this NSOLL), `ip` (`ADDRESS/LENGTH`: an
//! Ethernet and an IP address of its own beside those of the interface. The kernel remembers 1,024 neighbours in all, which a
//! controller of a large plant exceeds).
#![forbid(unsafe_code)]

use std::collections::{BTreeSet, HashMap};
use std::net::Ipv4Addr;
use std::process::ExitCode;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use network::ethernet::{PacketMedium, Runner};
use network::host::{Host, StationId};
use network::system::{InterfaceInfo, ServerPort};
use profile::catalogue::AKD;
use profinet::controller::{
    ArId, ConnectConfig, Controller, ControllerConfig, Event, Filter, IdentifyOptions, ModuleConfig,
    RecordAddress, Resolve, SubmoduleConfig, Target,
};
use profinet::cyclic::{CyclicStatistics, Timing};
use profinet::{Instant, IpSuite, MacAddress, Medium};
use serde_json::json;

/// What is at the other end.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Pnio,
    Akd,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [interface, kind, names, options @ ..] = arguments.as_slice() else {
        eprintln!("usage: test-controller INTERFACE pnio|akd NAME[,NAME...] [key=value ...]");
        return ExitCode::from(2);
    };
    let options: HashMap<&str, &str> = options.iter().filter_map(|o| o.split_once('=')).collect();
    let kind = if kind == "pnio" { Kind::Pnio } else { Kind::Akd };
    let names: Vec<&str> = names.split(',').collect();
    match App::open(interface, kind, names.len(), options).and_then(|mut app| app.run(&names)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("test-controller: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Calls under way at once.
const CALLS: usize = 256;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// The controller and what carries its frames.
enum Carrier {
    /// With the addresses of the interface and the kernel's UDP.
    Kernel(Box<PacketMedium>, Box<Controller>),
    /// With addresses and a UDP of its own.
    Own(Box<Runner>, StationId),
}

impl Carrier {
    fn open(interface: &str, devices: usize, own: Option<&str>) -> Outcome<Self> {
        let seed = SystemTime::now().duration_since(UNIX_EPOCH)?.as_nanos() as u64;
        let config = |mac, ip| ControllerConfig::new(mac, ip, "test-controller", seed);
        let Some(own) = own else {
            let info = InterfaceInfo::find(interface)?;
            let medium = PacketMedium::open_for(interface, ServerPort::Required, devices)?;
            let controller = Controller::new(config(info.usable()?, info.ip()));
            return Ok(Self::Kernel(Box::new(medium), Box::new(controller)));
        };
        let (address, length) = own.split_once('/').ok_or("ip=ADDRESS/LENGTH")?;
        let address: Ipv4Addr = address.parse()?;
        let mask = u32::MAX.checked_shl(32 - length.parse::<u32>()?);
        let ip = IpSuite {
            address,
            mask: mask.unwrap_or(0).into(),
            gateway: Ipv4Addr::UNSPECIFIED,
        };
        let [_, _, c, d] = address.octets();
        let controller = Controller::new(config(MacAddress([2, 0x50, 0x4e, 0xFF, c, d]), ip));
        let mut runner = Runner::open_for(interface, devices)?;
        let station = runner.attach(Box::new(Host::new(controller).with_neighbours(devices + 16)))?;
        Ok(Self::Own(Box::new(runner), station))
    }

    fn now(&self) -> Instant {
        network::system::now()
    }

    fn controller(&mut self) -> &mut Controller {
        match self {
            Self::Kernel(_, controller) => controller,
            Self::Own(runner, station) => runner
                .station_mut::<Host<Controller>>(*station)
                .unwrap()
                .endpoint_mut(),
        }
    }

    fn step(&mut self, until: Instant) -> Outcome<()> {
        match self {
            Self::Kernel(medium, controller) => medium.step(controller.as_mut(), until)?,
            Self::Own(runner, _) => _ = runner.step(until)?,
        }
        Ok(())
    }
}

struct App<'a> {
    carrier: Carrier,
    kind: Kind,
    options: HashMap<&'a str, &'a str>,
    names: HashMap<ArId, String>,
    running: BTreeSet<ArId>,
    ready: BTreeSet<ArId>,
    lost: Vec<(ArId, String)>,
    released: usize,
    records: Vec<(usize, Result<Vec<u8>, String>)>,
    calls: Vec<profinet::controller::CallId>,
    received: Vec<profinet::controller::Station>,
    identify_done: bool,
    first_frame_us: u64,
}

impl<'a> App<'a> {
    fn open(
        interface: &str,
        kind: Kind,
        devices: usize,
        options: HashMap<&'a str, &'a str>,
    ) -> Outcome<Self> {
        Ok(Self {
            carrier: Carrier::open(interface, devices, options.get("ip").copied())?,
            kind,
            options,
            names: HashMap::new(),
            running: BTreeSet::new(),
            ready: BTreeSet::new(),
            lost: Vec::new(),
            released: 0,
            records: Vec::new(),
            calls: Vec::new(),
            received: Vec::new(),
            identify_done: false,
            first_frame_us: 0,
        })
    }

    fn option(&self, name: &str, default: u64) -> u64 {
        self.options
            .get(name)
            .map_or(default, |value| value.parse().unwrap())
    }

    fn run(&mut self, names: &[&str]) -> Outcome<()> {
        let reconnect = self.option("reconnect", 0) == 1;
        let ars = self.connect_all(names)?;
        let complete = self.exchange(&ars, reconnect)?;
        if !complete {
            // the device was lost: wait until it is back, then everything again
            let again = self.connect_again(names)?;
            if !self.exchange(&again, false)? {
                return Err(format!("lost again: {:?}", self.lost).into());
            }
            self.release_all(&again)?;
        } else {
            self.release_all(&ars)?;
        }
        say(json!({"step": "done"}));
        Ok(())
    }

    fn connect_all(&mut self, names: &[&str]) -> Outcome<Vec<ArId>> {
        let mut ars = Vec::new();
        for name in names {
            let target = if self.option("hammer", 0) == 1 {
                Target::of(&self.hammer(name)?)
            } else {
                let (vendor_id, device_id) = match self.kind {
                    Kind::Pnio => (0xFFFF, 0x0001),
                    Kind::Akd => (AKD.device.vendor_id, AKD.device.device_id),
                };
                Target {
                    name: (*name).into(),
                    mac: None,
                    ip: IpSuite::NONE,
                    vendor_id,
                    device_id,
                    instance: 1,
                }
            };
            let mut config = self.connect_config()?;
            if self.option("hammer", 0) == 1 {
                config.resolve = Resolve::Trust;
            }
            let now = self.carrier.now();
            let ar = self.carrier.controller().connect(now, target, config)?;
            self.names.insert(ar, (*name).into());
            ars.push(ar);
        }
        let limit = Duration::from_secs(20);
        let all = ars.len();
        self.until("all devices running", limit, |app| {
            (app.running.len(), app.ready.len()) == (all, all) || !app.lost.is_empty()
        })?;
        if !self.lost.is_empty() {
            return Err(format!("not connected: {:?}", self.lost).into());
        }
        say(
            json!({"step": "running", "devices": ars.len(), "at_us": wall_us(), "first_frame_us": self.first_frame_us}),
        );
        Ok(ars)
    }

    /// After a loss: the device comes back some time.
    fn connect_again(&mut self, names: &[&str]) -> Outcome<Vec<ArId>> {
        let until = self.carrier.now() + Duration::from_secs(20);
        loop {
            self.lost.clear();
            self.running.clear();
            self.ready.clear();
            match self.connect_all(names) {
                Ok(ars) => return Ok(ars),
                Err(error) if self.carrier.now() > until => return Err(error),
                Err(error) => say(json!({"step": "absent", "error": error.to_string()})),
            }
        }
    }

    /// Looks for a device again and again, as soon as it answers it is known.
    fn hammer(&mut self, name: &str) -> Outcome<profinet::controller::Station> {
        let until = self.carrier.now() + Duration::from_secs(20);
        while self.carrier.now() < until {
            self.identify_done = false;
            let options = IdentifyOptions {
                delay_factor: 1,
                margin: Duration::ZERO,
                sends: 1,
            };
            let now = self.carrier.now();
            let id = self
                .carrier
                .controller()
                .identify_with(now, Filter::name(name), options)?;
            let short = now + Duration::from_millis(2);
            while self.carrier.now() < short && self.received.is_empty() {
                self.carrier.step(short)?;
                self.drain();
            }
            self.carrier.controller().cancel_dcp(id);
            if let Some(station) = self.received.pop() {
                return Ok(station);
            }
        }
        Err(format!("{name} did not answer").into())
    }

    fn connect_config(&self) -> Outcome<ConnectConfig> {
        let timing = Timing::for_interval(Duration::from_micros(self.option("cycle_us", 16_000)))
            .ok_or("no such cycle time")?;
        let mut config = ConnectConfig::new(modules(self.kind), timing);
        config.watchdog_factor = self.option("hold", 3) as u16;
        config.data_hold_factor = config.watchdog_factor;
        Ok(config)
    }

    fn outputs(&mut self, ar: ArId) {
        let done = match self.kind {
            Kind::Pnio => self
                .carrier
                .controller()
                .set_output(ar, 3, 1, &PATTERN)
                .and(self.carrier.controller().set_output(ar, 4, 1, &[0; 4])),
            Kind::Akd => self
                .carrier
                .controller()
                .set_output(ar, 1, 1, &[0x04, 0x7E, 0, 0]),
        };
        done.unwrap();
    }

    /// Exchanges data for the time requested. False when a connection was lost and that is allowed.
    fn exchange(&mut self, ars: &[ArId], may_lose: bool) -> Outcome<bool> {
        // the frames of the start-up do not count
        let start = self.carrier.now() + Duration::from_millis(500);
        self.pass(start)?;
        let before: Vec<CyclicStatistics> = ars
            .iter()
            .map(|ar| self.carrier.controller().statistics(*ar))
            .map(Option::unwrap_or_default)
            .collect();
        let sent: Vec<(u64, u64)> = ars
            .iter()
            .map(|ar| self.carrier.controller().sent(*ar).unwrap_or_default())
            .collect();
        say(json!({"step": "exchanging"}));
        let seconds = self.option("seconds", 20);
        let until = start + Duration::from_secs(seconds);
        let speed = self.option("speed", 0) as i16;
        if speed != 0 {
            self.drive(ars, speed)?;
        }
        self.pass(until)?;
        if let Some((ar, cause)) = self.lost.first().cloned() {
            let after = self.carrier.now().saturating_since(start).as_millis() as u64;
            say(
                json!({"step": "lost", "name": self.names[&ar], "cause": cause, "count": self.lost.len(), "after_ms": after}),
            );
            return if may_lose {
                Ok(false)
            } else {
                Err(format!("lost: {:?}", self.lost).into())
            };
        }
        for ((ar, before), sent) in ars.iter().zip(before).zip(sent) {
            let after = self.carrier.controller().statistics(*ar).unwrap_or_default();
            let sent_after = self.carrier.controller().sent(*ar).unwrap_or_default();
            let input = self
                .carrier
                .controller()
                .input(*ar, 1, 1)
                .map(|(data, iops)| (data.to_vec(), iops.is_good()));
            let (input, good) = input.unwrap_or_default();
            say(json!({
                "step": "exchange", "name": self.names[ar], "received": after.received - before.received,
                "missed": after.missed - before.missed, "disordered": after.out_of_order - before.out_of_order,
                "rejected": after.rejected - before.rejected, "longest_gap_us": after.longest_gap.as_micros() as u64,
                "sent": sent_after.0 - sent.0, "skipped": sent_after.1 - sent.1, "input": hex(&input), "good": good,
                "mirrored": input == PATTERN,
            }));
        }
        for _ in 0..self.option("records", 1) {
            for some in ars.chunks(CALLS) {
                self.read_identification(some)?;
            }
        }
        Ok(true)
    }

    /// Steps to operation and sets the speed.
    fn drive(&mut self, ars: &[ArId], speed: i16) -> Outcome<()> {
        let [high, low] = speed.to_be_bytes();
        for (word, setpoint) in [
            ([0x04, 0x7E], [0, 0]),
            ([0x04, 0x7F], [0, 0]),
            ([0x04, 0x7F], [high, low]),
        ] {
            for ar in ars {
                self.carrier.controller().set_output(
                    *ar,
                    1,
                    1,
                    &[word[0], word[1], setpoint[0], setpoint[1]],
                )?;
            }
            let soon = self.carrier.now() + Duration::from_millis(200);
            self.pass(soon)?;
        }
        Ok(())
    }

    fn read_identification(&mut self, ars: &[ArId]) -> Outcome<()> {
        self.records.clear();
        self.calls.clear();
        for ar in ars {
            let at = RecordAddress {
                api: 0,
                slot: 0,
                subslot: 1,
                index: 0xAFF0,
            };
            let now = self.carrier.now();
            self.calls
                .push(self.carrier.controller().read(now, *ar, at, 4096)?);
        }
        let count = ars.len();
        self.until("records read", Duration::from_secs(10), |app| {
            app.records.len() == count
        })?;
        for (at, result) in std::mem::take(&mut self.records) {
            match result {
                Ok(data) => say(json!({"step": "im0", "name": self.names[&ars[at]], "data": hex(&data)})),
                Err(error) => return Err(format!("I&M0: {error}").into()),
            }
        }
        Ok(())
    }

    fn release_all(&mut self, ars: &[ArId]) -> Outcome<()> {
        self.released = 0;
        let mut count = 0;
        for some in ars.chunks(CALLS) {
            for ar in some {
                let now = self.carrier.now();
                self.carrier.controller().release(now, *ar)?;
            }
            count += some.len();
            self.until("all released", Duration::from_secs(10), |app| {
                app.released == count
            })?;
        }
        say(json!({"step": "released", "devices": count}));
        Ok(())
    }

    /// Lets time pass; ends early when a connection is lost.
    fn pass(&mut self, until: Instant) -> Outcome<()> {
        while self.carrier.now() < until && self.lost.is_empty() {
            self.carrier.step(until)?;
            self.drain();
        }
        Ok(())
    }

    fn until(&mut self, what: &str, limit: Duration, mut done: impl FnMut(&Self) -> bool) -> Outcome<()> {
        let until = self.carrier.now() + limit;
        while !done(self) {
            if self.carrier.now() >= until {
                return Err(format!("not within {limit:?}: {what}").into());
            }
            self.carrier.step(until)?;
            self.drain();
        }
        Ok(())
    }

    fn drain(&mut self) {
        while let Some(event) = self.carrier.controller().poll_event() {
            match event {
                Event::Identified { station, .. } => self.received.push(station),
                Event::IdentifyDone { .. } => self.identify_done = true,
                Event::Connected { ar, .. } => self.outputs(ar),
                Event::Running { ar } => {
                    self.first_frame_us = wall_us();
                    self.running.insert(ar);
                }
                Event::Ready { ar, diff } => {
                    if let Some(diff) = diff {
                        say(json!({"step": "diff", "diff": format!("{diff:?}")}));
                    }
                    self.ready.insert(ar);
                }
                Event::Lost { ar, cause } => self.lost.push((ar, cause.to_string())),
                Event::Released { .. } => self.released += 1,
                Event::RecordDone { call, result } => {
                    if let Some(at) = self.calls.iter().position(|known| *known == call) {
                        self.records.push((at, result.map_err(|e| e.to_string())));
                    }
                }
                Event::Alarm { alarm, .. } => say(json!({"step": "alarm", "alarm": format!("{alarm:?}")})),
                _ => {}
            }
        }
    }
}

/// What is sent to the device that mirrors: 16 REAL values that survive as such.
const PATTERN: [u8; 64] = {
    let mut pattern = [0x40; 64];
    let mut at = 0;
    while at < 64 {
        pattern[at + 1] = at as u8;
        at += 4;
    }
    pattern
};

fn modules(kind: Kind) -> Vec<ModuleConfig> {
    let sub = |subslot, ident, input_length, output_length| SubmoduleConfig {
        subslot,
        ident,
        input_length,
        output_length,
    };
    let module = |api, slot, ident, submodules| ModuleConfig {
        api,
        slot,
        ident,
        submodules,
    };
    match kind {
        Kind::Pnio => vec![
            module(
                0,
                0,
                1,
                vec![
                    sub(1, 1, 0, 0),
                    sub(0x8000, 0x8000, 0, 0),
                    sub(0x8001, 0x8001, 0, 0),
                ],
            ),
            module(0, 1, 0x101, vec![sub(1, 1, 64, 0)]),
            module(0, 2, 0x102, vec![sub(1, 1, 4, 0)]),
            module(0, 3, 0x103, vec![sub(1, 1, 0, 64)]),
            module(0, 4, 0x104, vec![sub(1, 1, 0, 4)]),
        ],
        Kind::Akd => {
            let device = &AKD.device;
            let telegram = device.telegram(1).unwrap();
            vec![
                module(
                    0,
                    0,
                    device.access_point_module,
                    vec![
                        sub(1, device.access_point_submodule, 0, 0),
                        sub(0x8000, device.interface_submodule, 0, 0),
                        sub(0x8001, device.port_submodule, 0, 0),
                    ],
                ),
                module(
                    device.api.into(),
                    1,
                    telegram.module,
                    vec![sub(1, telegram.submodule, telegram.inputs, telegram.outputs)],
                ),
            ]
        }
    }
}

fn wall_us() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |time| time.as_micros() as u64)
}

fn hex(data: &[u8]) -> String {
    data.iter().map(|octet| format!("{octet:02x}")).collect()
}

fn say(value: serde_json::Value) {
    println!("{value}");
}
