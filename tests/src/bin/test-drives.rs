//! Virtual AKDs as a program, for the tests and benchmarks that need what `profidrive simulate` does not offer: a chosen
//! Ethernet address for each.
//!
//! `test-drives INTERFACE [key=value ...]` with `count`, `mac` (of the first), `name` (prefix, `-1`, `-2` ... follow; one
//! drive has it as it is), `ip` (of the first), `min_us` (shortest cycle). Prints `ready` when all are on the wire.
#![forbid(unsafe_code)]

use std::collections::HashMap;
use std::net::Ipv4Addr;
use std::process::ExitCode;
use std::time::Duration;

use network::host::Host;
use network::linux::{Runner, Stop, Turn, now};
use profinet::device::Stored;
use profinet::{IpSuite, MacAddress};
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((interface, options)) = arguments.split_first() else {
        eprintln!("usage: test-drives INTERFACE [key=value ...]");
        return ExitCode::from(2);
    };
    match run(interface, options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("test-drives: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(interface: &str, options: &[String]) -> Result<(), Box<dyn std::error::Error>> {
    let options: HashMap<&str, &str> = options.iter().filter_map(|o| o.split_once('=')).collect();
    let option = |name: &str, default| options.get(name).copied().unwrap_or(default);
    let count: u8 = option("count", "1").parse()?;
    let first: MacAddress = option("mac", "02:50:4e:00:01:01").parse()?;
    let min_us: u64 = option("min_us", "16000").parse()?;
    let mut runner = Runner::open(interface)?;
    runner.set_stop(Stop::on_signals()?);
    let mut ids = Vec::new();
    for number in 0..count {
        let mut mac = first;
        mac.0[5] = mac.0[5].wrapping_add(number);
        let mut config = StationConfig::new(&model::AKD, mac);
        config.min_device_interval = Some(u16::try_from(min_us * 1000 / 31_250)?);
        config.network = Stored::default();
        if let Some(name) = options.get("name") {
            config.network.name = if count == 1 {
                (*name).into()
            } else {
                format!("{name}-{}", number + 1)
            };
        }
        if let Some(ip) = options.get("ip") {
            let address = Ipv4Addr::from_bits(ip.parse::<Ipv4Addr>()?.to_bits() + u32::from(number));
            let mask = Ipv4Addr::new(255, 255, 255, 0);
            config.network.ip = IpSuite {
                address,
                mask,
                gateway: Ipv4Addr::UNSPECIFIED,
            };
        }
        ids.push(runner.attach(Box::new(Host::new(Station::new(config))))?);
    }
    println!("ready");
    loop {
        let turn = runner.step(now() + Duration::from_secs(1))?;
        for id in runner.touched().to_vec() {
            let number = ids.iter().position(|known| *known == id).unwrap_or_default();
            if let Some(host) = runner.station_mut::<Host<Station>>(id) {
                while let Some(event) = host.endpoint_mut().poll_event() {
                    println!("{number} {event:?}");
                }
            }
        }
        if turn == Turn::Stopped {
            return Ok(());
        }
    }
}
