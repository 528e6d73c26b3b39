//! `profidrive simulate --model akd --name akd-1 -i IFACE`

mod scribe;

use std::collections::BTreeMap;
use std::fs::File;
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use network::host::{Host, StationId};
use network::linux::{Error as NetworkError, Runner, Stop, Turn, now};
use network::pcap::Writer;
use profinet::device::Stored;
use profinet::wire::dcp::check_name;
use profinet::{Instant, IpSuite, MacAddress};
use virtual_drive::description::Description;
use virtual_drive::model::{self, Model as DriveModel};
use virtual_drive::station::{Station, StationConfig};

use crate::args::{Interface, Model, Network, Simulate};
use crate::connect;
use crate::failure::{Exit, Failure};
use crate::output::Output;
use crate::render::table::clean;
use crate::state::{self, DriveState};

use scribe::Scribe;

/// One step of an update time.
const TICK_NANOS: u128 = 31_250;
/// How long to sleep while nothing happens.
const NAP: Duration = Duration::from_secs(3600);
/// How often an interface that went away is looked for.
const RETRY: Duration = Duration::from_secs(1);

/// A drive to be simulated.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Plan {
    /// What it is called on the command line; names its files and its MAC address.
    key: String,
    name: String,
    mac: MacAddress,
    ip: IpSuite,
}

/// A drive as its events need it.
#[derive(Debug)]
struct Keeping {
    key: String,
    state: DriveState,
}

pub fn run(args: &Simulate, on: &Interface, output: &Output) -> Result<(), Failure> {
    let interface = connect::interface(on)?.ok_or_else(connect::no_interface)?;
    let interval = args.min_cycle.map(interval).transpose()?;
    let description = description(args, output)?;
    let mut runner = Runner::open(&interface)?;
    let host = runner.interface().mac;
    let plans = plans(args, host)?;
    if let Some(folder) = &args.state {
        state::usable(folder)?;
    }
    let stop = Stop::on_signals()
        .map_err(|error| Failure::new(Exit::Failed, format!("cannot watch for Ctrl-C: {error}")))?;
    runner.set_stop(stop)?;
    if let Some(path) = &args.pcap {
        runner.add_tap(Box::new(capture(path, &interface)?));
    }
    let start = now();
    let mut drives: BTreeMap<StationId, Arc<Keeping>> = BTreeMap::new();
    let scribe = Scribe::new(output.clone());
    for plan in &plans {
        let state = DriveState::new(args.state.as_deref(), &plan.key);
        let mut config = StationConfig::new(model_of(args.model), plan.mac);
        config.min_device_interval = interval;
        config.description = description.clone();
        config.follow_controller = true;
        config.network = state.read_network()?.unwrap_or_else(|| Stored {
            name: plan.name.clone(),
            ip: plan.ip,
            ..Stored::default()
        });
        config.parameters = state.read_parameters()?;
        let told = told(&config.network, plan.mac);
        let id = runner.attach(Box::new(Host::new(Station::new(config))))?;
        let keeping = Arc::new(Keeping {
            key: plan.key.clone(),
            state,
        });
        scribe.say(&keeping, now() - start, format!("ready: {told}"));
        drives.insert(id, keeping);
    }
    output.say(&format!("{} on {interface}; Ctrl-C ends", count(plans.len())));
    let (mut away, mut next_try) = (false, now());
    loop {
        let nap = if away { RETRY } else { NAP };
        let turn = match runner.step(now() + nap) {
            Err(error @ (NetworkError::InterfaceDown { .. } | NetworkError::InterfaceGone { .. })) => {
                output.warn(&format!(
                    "{error}: waiting until it is back; the drives go on without it"
                ));
                (away, next_try) = (true, now() + RETRY);
                Turn::Worked
            }
            other => other?,
        };
        if away && now() >= next_try {
            next_try = now() + RETRY;
            away = !is_back(runner.reopen())?;
            if !away {
                output.say(&format!("{interface} is back"));
            }
        }
        for turn in 0..runner.touched().len() {
            // most turns have no event: looking first leaves the station undisturbed
            let touched = runner.touched().get(turn).copied();
            let Some((id, keeping)) = touched
                .filter(|id| {
                    let host = runner.station::<Host<Station>>(*id);
                    host.is_some_and(|host| host.endpoint().has_event())
                })
                .and_then(|id| Some((id, drives.get(&id)?)))
            else {
                continue;
            };
            while let Some(event) = runner
                .station_mut::<Host<Station>>(id)
                .and_then(|host| host.endpoint_mut().poll_event())
            {
                scribe.happened(keeping, now() - start, event);
            }
        }
        if turn == Turn::Stopped {
            break;
        }
    }
    scribe.finish();
    runner
        .finish_taps()
        .map_err(|error| Failure::new(Exit::Failed, format!("the capture is not complete: {error}")))
}

/// Whether the interface could be opened again; down and not there are no failures.
fn is_back(reopened: Result<(), NetworkError>) -> Result<bool, Failure> {
    match reopened {
        Ok(()) => Ok(true),
        Err(
            NetworkError::InterfaceDown { .. }
            | NetworkError::InterfaceGone { .. }
            | NetworkError::NoSuchInterface { .. },
        ) => Ok(false),
        Err(error) => Err(error.into()),
    }
}

pub const fn model_of(model: Model) -> &'static DriveModel {
    match model {
        Model::Akd => &model::AKD,
    }
}

/// Identity and modules: those of the model, or of the maker's device description.
fn description(args: &Simulate, output: &Output) -> Result<Description, Failure> {
    let model = model_of(args.model);
    let Some(path) = &args.gsdml else {
        return Ok(Description::of(model));
    };
    let file = super::gsdml::read(path)?;
    let import = Description::from_gsdml(&file, model, args.access_point.as_deref());
    let import = import.map_err(|error| {
        let message = format!("{}: {}", path.display(), clean(&error.to_string()));
        Failure::new(Exit::Failed, message).hint(format!(
            "`profidrive gsdml show {}` shows access points and modules",
            path.display()
        ))
    })?;
    for reason in &import.left_out {
        output.warn(&format!("not simulated: {}", clean(reason)));
    }
    let identity = &import.description.identity;
    let mut telegrams: Vec<u16> = import.description.telegrams.iter().map(|t| t.telegram).collect();
    telegrams.sort_unstable();
    telegrams.dedup();
    let telegrams: Vec<String> = telegrams.iter().map(u16::to_string).collect();
    output.say(&format!(
        "{}: {} {}, device 0x{:04X}, telegrams {}",
        path.display(),
        clean(&file.identity.vendor),
        identity.station_type,
        identity.device_id,
        telegrams.join(", ")
    ));
    Ok(import.description)
}

fn count(drives: usize) -> String {
    if drives == 1 {
        "1 drive".into()
    } else {
        format!("{drives} drives")
    }
}

fn capture(path: &std::path::Path, interface: &str) -> Result<Writer<File>, Failure> {
    let failed = |error: std::io::Error| {
        Failure::new(Exit::Failed, format!("cannot write {}: {error}", path.display()))
    };
    let wall = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let origin = wall.saturating_sub(now() - Instant::ZERO);
    Writer::new(File::create(path).map_err(failed)?, interface, origin).map_err(failed)
}

/// The fastest update time in steps of 31.25 us: a power of two of them, as every update time of PROFINET here.
fn interval(time: Duration) -> Result<u16, Failure> {
    let wanted = time.as_nanos();
    let possible = (5..=14).map(|power| 1_u16 << power);
    if let Some(ticks) = possible
        .clone()
        .find(|ticks| u128::from(*ticks) * TICK_NANOS == wanted)
    {
        return Ok(ticks);
    }
    let below = possible
        .clone()
        .rfind(|ticks| u128::from(*ticks) * TICK_NANOS < wanted);
    let above = possible
        .clone()
        .find(|ticks| u128::from(*ticks) * TICK_NANOS > wanted);
    let nearest: Vec<String> = [below, above]
        .into_iter()
        .flatten()
        .map(|ticks| format!("{} ms", ticks / 32))
        .collect();
    Err(Failure::usage(format!(
        "--min-cycle: an update time of {} ms does not exist",
        time.as_secs_f64() * 1000.0
    ))
    .hint(format!(
        "nearest: {}; possible are 1, 2, 4, 8 .. 512 ms",
        nearest.join(" and ")
    )))
}

/// Names, addresses and MAC addresses of all drives.
fn plans(args: &Simulate, host: Option<MacAddress>) -> Result<Vec<Plan>, Failure> {
    let mut plans: Vec<Plan> = Vec::new();
    for number in 1..=args.count {
        let name = match &args.name {
            None => String::new(),
            Some(name) if args.count == 1 => name.clone(),
            Some(name) => numbered(name, number),
        };
        if !name.is_empty()
            && let Err(rule) = check_name(name.as_bytes())
        {
            return Err(super::address::no_name(&name, rule));
        }
        let key = if name.is_empty() {
            format!("drive-{number}")
        } else {
            name.clone()
        };
        let mac = mac(args, &key, host)?;
        if let Some(other) = plans.iter().find(|other| other.mac == mac) {
            return Err(
                Failure::usage(format!("{} and {key} get the same MAC address {mac}", other.key))
                    .hint("choose another --name"),
            );
        }
        let ip = args
            .ip
            .map_or(Ok(IpSuite::NONE), |first| address(first, number - 1))?;
        plans.push(Plan { key, name, mac, ip });
    }
    Ok(plans)
}

/// `akd` gives akd-1, akd-2; `akd-1` gives akd-1, akd-2 as well; `akd-5` begins at 5.
fn numbered(name: &str, number: u16) -> String {
    let (base, first) = match name.rsplit_once('-') {
        Some((base, digits)) if !base.is_empty() => match digits.parse::<u16>() {
            Ok(first) => (base, first),
            Err(_) => (name, 1),
        },
        _ => (name, 1),
    };
    format!("{base}-{}", u32::from(first) + u32::from(number) - 1)
}

fn mac(args: &Simulate, key: &str, host: Option<MacAddress>) -> Result<MacAddress, Failure> {
    match args.mac.as_deref() {
        None => Ok(derived_mac(key)),
        Some(_) if args.count > 1 => Err(Failure::usage(
            "--mac is for one drive; several get theirs from their names",
        )),
        Some("host") => host.ok_or_else(|| Failure::usage("the interface has no MAC address")),
        Some(text) => {
            let mac: MacAddress = text
                .parse()
                .map_err(|error| Failure::usage(format!("--mac {text}: {error}")))?;
            if mac.is_multicast() || mac == MacAddress::default() {
                return Err(Failure::usage(format!(
                    "--mac {text}: this address belongs to no single station"
                )));
            }
            Ok(mac)
        }
    }
}

/// A locally administered address that is the same for the same name every time: FNV-1a, 40 bits of it.
fn derived_mac(key: &str) -> MacAddress {
    let hash = key.bytes().fold(0xCBF2_9CE4_8422_2325_u64, |hash, octet| {
        (hash ^ u64::from(octet)).wrapping_mul(0x0100_0000_01B3)
    });
    let folded = hash ^ (hash >> 40);
    let [.., a, b, c, d, e] = folded.to_be_bytes();
    MacAddress([0x02, a, b, c, d, e])
}

fn address(first: Network, offset: u16) -> Result<IpSuite, Failure> {
    let address = u32::from(first.address)
        .checked_add(offset.into())
        .map(Ipv4Addr::from);
    let suite = |address| IpSuite {
        address,
        mask: first.mask(),
        gateway: Ipv4Addr::UNSPECIFIED,
    };
    let fits = |address: &Ipv4Addr| {
        let host = u32::from(*address) & !u32::from(first.mask());
        suite(first.address).is_local(*address)
            && (first.prefix >= 31 || (host != 0 && host != !u32::from(first.mask())))
    };
    address.filter(fits).map(suite).ok_or_else(|| {
        Failure::usage(format!(
            "{}/{} has no room for {} drives",
            first.address,
            first.prefix,
            offset + 1
        ))
    })
}

fn told(network: &Stored, mac: MacAddress) -> String {
    let name = if network.name.is_empty() {
        "no name"
    } else {
        &network.name
    };
    if network.ip.is_set() {
        format!("{name}, {mac}, {}", network.ip.address)
    } else {
        format!("{name}, {mac}, waits for its address")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    fn planned(line: &str) -> Result<Vec<Plan>, Failure> {
        let cli = crate::args::Cli::try_parse_from(line.split(' ')).unwrap();
        let crate::args::Command::Simulate(args) = cli.command else {
            panic!()
        };
        plans(&args.args, Some(MacAddress([0, 1, 2, 3, 4, 5])))
    }

    #[test]
    fn names_addresses_and_macs_are_counted_up() {
        let drives = planned("profidrive simulate --name akd-1 --count 3 --ip 10.0.0.254/16").unwrap();
        let names: Vec<_> = drives.iter().map(|plan| plan.name.as_str()).collect();
        assert_eq!(names, ["akd-1", "akd-2", "akd-3"]);
        let ips: Vec<_> = drives.iter().map(|plan| plan.ip.address.to_string()).collect();
        assert_eq!(ips, ["10.0.0.254", "10.0.0.255", "10.0.1.0"]);
        assert!(drives.iter().all(|plan| plan.mac.0[0] == 2));
        assert_eq!(
            drives[0].mac,
            planned("profidrive simulate --name akd-1").unwrap()[0].mac,
            "stable"
        );
        assert_eq!(
            planned("profidrive simulate --name press --count 2").unwrap()[1].name,
            "press-2"
        );
        assert_eq!(planned("profidrive simulate").unwrap()[0].name, "");
    }

    #[test]
    fn many_names_many_macs() {
        let drives = planned("profidrive simulate --name akd-1 --count 256 --ip 10.0.0.1/16").unwrap();
        assert_eq!(drives.len(), 256);
    }

    #[test]
    fn mistakes_are_told() {
        for (line, words) in [
            ("profidrive simulate --name akd_1", "no station name"),
            (
                "profidrive simulate --name akd-1 --count 2 --mac host",
                "for one drive",
            ),
            (
                "profidrive simulate --name akd-1 --mac ff:ff:ff:ff:ff:ff",
                "no single station",
            ),
            (
                "profidrive simulate --name akd-1 --count 2 --ip 10.0.0.254/24",
                "no room for 2 drives",
            ),
        ] {
            assert!(planned(line).unwrap_err().message.contains(words), "{line}");
        }
        assert_eq!(
            planned("profidrive simulate --mac host").unwrap()[0].mac,
            MacAddress([0, 1, 2, 3, 4, 5])
        );
    }

    #[test]
    fn update_times() {
        assert_eq!(interval(Duration::from_millis(16)), Ok(512));
        assert_eq!(interval(Duration::from_millis(1)), Ok(32));
        assert_eq!(interval(Duration::from_millis(512)), Ok(16384));
        for (micros, hint) in [
            (500, "nearest: 1 ms;"),
            (3_000, "nearest: 2 ms and 4 ms;"),
            (1_000_000, "nearest: 512 ms;"),
        ] {
            let failure = interval(Duration::from_micros(micros)).unwrap_err();
            assert_eq!(failure.exit, Exit::Usage);
            assert!(failure.hint.unwrap().starts_with(hint), "{micros}");
        }
    }
}
