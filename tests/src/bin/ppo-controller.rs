//! Our controller and our client of the parameter channel, for a device with PPO modules in its slots: asks one thing after
//! the other in each slot and prints one JSON object per line with the results.
//!
//! `ppo-controller INTERFACE NAME`; slot 1 has PPO type 1, slot 2 the parameter channel alone, slot 3 PPO type 2.
#![forbid(unsafe_code)]

use std::process::ExitCode;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use network::ethernet::PacketMedium;
use network::system::{InterfaceInfo, ServerPort};
use profile::pkw::{Client, ClientTiming, Job, Memory, Outcome, PKW_LEN, PkwDialect, PkwValue};
use profinet::controller::{
    ArId, ConnectConfig, Controller, ControllerConfig, Event, ModuleConfig, SubmoduleConfig, Target,
};
use profinet::cyclic::Timing;
use profinet::{Instant, IpSuite, Medium};
use serde_json::json;

/// Slot and octets of its process data.
const SLOTS: [(u16, usize); 3] = [(1, 4), (2, 0), (3, 12)];
const RUN: [u8; 4] = [0x04, 0x7C, 0x20, 0x00];
const STOP: [u8; 4] = [0x04, 0x3C, 0x00, 0x00];

type Done<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [interface, name] = arguments.as_slice() else {
        eprintln!("usage: ppo-controller INTERFACE NAME");
        return ExitCode::from(2);
    };
    match Program::connect(interface, name).and_then(|mut program| program.run()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("ppo-controller: {error}");
            ExitCode::FAILURE
        }
    }
}

struct Program {
    medium: PacketMedium,
    controller: Controller,
    ar: ArId,
}

/// Returns the requests of each slot, with a name for the test.
fn jobs() -> Vec<(&'static str, Job<'static>)> {
    let read = |pnu, element| Job::Read { pnu, element };
    let change = |pnu, value| Job::Change {
        pnu,
        element: None,
        value,
        memory: Memory::Ram,
    };
    vec![
        ("double", read(207, None)),
        ("changed", change(207, PkwValue::DoubleWord(0x0001_0203))),
        ("again", read(207, None)),
        ("mode", change(930, PkwValue::DoubleWord(2))),
        ("element", read(1530, Some(1))),
        ("limit", change(414, PkwValue::Word(4000))),
        ("below", change(414, PkwValue::Word(1000))),
        ("missing", read(2000, None)),
        ("actual", read(1613, None)),
        ("later", read(1613, None)),
    ]
}

impl Program {
    fn connect(interface: &str, name: &str) -> Done<Self> {
        let info = InterfaceInfo::find(interface)?;
        let mut medium = PacketMedium::open(interface, ServerPort::Required)?;
        let seed = SystemTime::now().duration_since(UNIX_EPOCH)?.as_nanos() as u64;
        let config = ControllerConfig::new(info.usable()?, info.ip(), "ppo-controller", seed);
        let mut controller = Controller::new(config);
        let target = Target {
            name: name.into(),
            mac: None,
            ip: IpSuite::NONE,
            vendor_id: 0xFFFF,
            device_id: 0x0001,
            instance: 1,
        };
        let timing = Timing::for_interval(Duration::from_millis(8)).ok_or("no such cycle time")?;
        let mut config = ConnectConfig::new(modules(), timing);
        config.watchdog_factor = 12;
        config.data_hold_factor = 12;
        let ar = controller.connect(medium.now(), target, config)?;
        let until = medium.now() + Duration::from_secs(20);
        let (mut ready, mut running) = (false, false);
        while !(ready && running) {
            if medium.now() > until {
                return Err("no connection".into());
            }
            medium.step(&mut controller, until)?;
            while let Some(event) = controller.poll_event() {
                match event {
                    Event::Connected { diff, .. } => {
                        say(json!({"step": "connected", "diff": diff.is_some()}));
                        for (slot, process) in SLOTS {
                            controller.set_output(ar, slot, 1, &vec![0; PKW_LEN + process])?;
                        }
                    }
                    Event::Ready { .. } => ready = true,
                    Event::Running { .. } => running = true,
                    Event::Lost { cause, .. } => return Err(cause.to_string().into()),
                    _ => {}
                }
            }
        }
        Ok(Self {
            medium,
            controller,
            ar,
        })
    }

    fn run(&mut self) -> Done<()> {
        for (slot, process) in SLOTS {
            // the parameter channel alone mirrors the number in every reply of this device but one
            let mut client = Client::new(PkwDialect::DANFOSS_PPO, ClientTiming::CYCLIC);
            for (name, job) in jobs() {
                self.ask(&mut client, slot, &process_words(process, STOP), name, job)?;
                if name == "actual" {
                    self.pass(Duration::from_millis(300))?;
                }
            }
            if process > 0 {
                let running = process_words(process, RUN);
                let wrong_state = ("mode while it runs", jobs()[3].1);
                for (name, job) in [("double while it runs", jobs()[0].1), wrong_state] {
                    self.ask(&mut client, slot, &running, name, job)?;
                }
            }
            // many in a row: nothing is mixed up
            for round in 0..4 {
                for (name, job) in [
                    ("double", jobs()[0].1),
                    ("element", jobs()[4].1),
                    ("missing", jobs()[7].1),
                ] {
                    let name = format!("{name} in round {round}");
                    self.ask(&mut client, slot, &process_words(process, STOP), &name, job)?;
                }
            }
        }
        let now = self.medium.now();
        self.controller.release(now, self.ar)?;
        self.pass(Duration::from_millis(500))?;
        say(json!({"step": "done"}));
        Ok(())
    }

    /// One job; what came, the words of it and the process data at that moment.
    fn ask(&mut self, client: &mut Client, slot: u16, process: &[u8], name: &str, job: Job<'_>) -> Done<()> {
        client.start(self.time(), job)?;
        let until = self.medium.now() + Duration::from_secs(10);
        loop {
            if self.medium.now() > until {
                return Err(format!("{name} hangs").into());
            }
            let now = self.time();
            let output = [client.request(now), process].concat();
            self.controller.set_output(self.ar, slot, 1, &output)?;
            self.pass(Duration::from_millis(8))?;
            let (input, iops) = self.controller.input(self.ar, slot, 1).ok_or("no input")?;
            if !iops.is_good() {
                return Err("bad inputs".into());
            }
            let input = input.to_vec();
            let now = self.time();
            let outcome = client.handle(now, &input[..PKW_LEN]);
            if let Some(outcome) = outcome.or_else(|| client.handle_timeout(now)) {
                // so that the process data is of these outputs too
                self.pass(Duration::from_millis(40))?;
                let settled = self
                    .controller
                    .input(self.ar, slot, 1)
                    .ok_or("no input")?
                    .0
                    .to_vec();
                say(json!({
                    "step": "job", "slot": slot, "name": name, "outcome": outcome_text(outcome),
                    "words": hex(&input[..PKW_LEN]), "process": hex(&settled[PKW_LEN..]),
                }));
                return Ok(());
            }
        }
    }

    fn pass(&mut self, time: Duration) -> Done<()> {
        let until = self.medium.now() + time;
        while self.medium.now() < until {
            self.medium.step(&mut self.controller, until)?;
            while let Some(event) = self.controller.poll_event() {
                if let Event::Lost { cause, .. } = event {
                    return Err(cause.to_string().into());
                }
            }
        }
        Ok(())
    }

    fn time(&self) -> Duration {
        self.medium.now().saturating_since(Instant::ZERO)
    }
}

fn modules() -> Vec<ModuleConfig> {
    let sub = |subslot, ident, length| SubmoduleConfig {
        subslot,
        ident,
        input_length: length,
        output_length: length,
    };
    let access_point = ModuleConfig {
        api: 0,
        slot: 0,
        ident: 1,
        submodules: vec![sub(1, 1, 0), sub(0x8000, 0x8000, 0), sub(0x8001, 0x8001, 0)],
    };
    let converter = SLOTS.map(|(slot, process)| ModuleConfig {
        api: 0,
        slot,
        ident: 0x100 + u32::from(slot),
        submodules: vec![sub(1, 1, (PKW_LEN + process) as u16)],
    });
    [access_point].into_iter().chain(converter).collect()
}

/// Control word and reference, and numbers in the words behind them.
fn process_words(length: usize, first: [u8; 4]) -> Vec<u8> {
    first.into_iter().chain(0x11..).take(length).collect()
}

fn outcome_text(outcome: Outcome) -> String {
    match outcome {
        Ok(answer) => format!("{answer:?}"),
        Err(error) => error.to_string(),
    }
}

fn hex(data: &[u8]) -> String {
    data.iter().map(|octet| format!("{octet:02x}")).collect()
}

fn say(value: serde_json::Value) {
    println!("{value}");
}
