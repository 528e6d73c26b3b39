//! Which drives to simulate: names, addresses, update times.

use std::net::Ipv4Addr;
use std::time::Duration;

use plant::{DrivePlan, derived_mac};
use profinet::wire::dcp::check_name;
use profinet::{IpSuite, MacAddress};
use virtual_drive::model::Model as DriveModel;

use crate::args::{Network, Simulate};
use crate::failure::Failure;

/// One step of an update time.
const TICK_NANOS: u128 = 31_250;

/// A drive to be simulated.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Which of several without a name.
    number: u16,
    pub drive: DrivePlan,
}

impl Plan {
    /// What it is called on the command line; names its files.
    pub fn key(&self) -> String {
        if self.drive.name.is_empty() {
            format!("drive-{}", self.number)
        } else {
            self.drive.name.clone()
        }
    }
}

impl From<DrivePlan> for Plan {
    fn from(drive: DrivePlan) -> Self {
        Self { number: 0, drive }
    }
}

/// Names, addresses and MAC addresses of all drives.
pub fn plans(
    args: &Simulate,
    model: &'static DriveModel,
    host: Option<MacAddress>,
) -> Result<Vec<Plan>, Failure> {
    let interval = args.min_cycle.map(interval).transpose()?;
    if let Some(first) = args.ip {
        has_room(first, args.count)?;
    }
    if args.rotary.is_some() && model.roles.address_mode.is_none() {
        let name = model.catalogue.model;
        return Err(Failure::usage(format!(
            "--rotary: a {name} has no rotary switches"
        )));
    }
    if args.rotary.is_some_and(|number| number > 0) && args.count > 1 {
        return Err(Failure::usage("--rotary: several drives would have one address"));
    }
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
            return Err(crate::commands::address::no_name(&name, rule));
        }
        let mut plan = Plan {
            number,
            drive: DrivePlan::new(&name, model),
        };
        let key = plan.key();
        plan.drive.mac = mac(args, &key, host)?;
        plan.drive.min_device_interval = interval;
        if let Some(first) = args.ip {
            plan.drive.ip = address(first, number - 1);
        }
        if let Some(other) = plans.iter().find(|other| other.drive.mac == plan.drive.mac) {
            let mac = plan.drive.mac;
            return Err(Failure::usage(format!(
                "{} and {key} get the same MAC address {mac}",
                other.key()
            ))
            .hint("choose another --name"));
        }
        plans.push(plan);
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

/// Addresses from `first` to the last one that a station of its subnet may have.
fn room(first: Network) -> u32 {
    let (address, mask) = (u32::from(first.address), u32::from(first.mask()));
    let (net, broadcast) = (address & mask, address | !mask);
    // two addresses or one have no room for those of net and broadcast (RFC 3021)
    let (lowest, highest) = match first.prefix {
        31.. => (net, broadcast),
        _ => (net + 1, broadcast - 1),
    };
    if (lowest..=highest).contains(&address) {
        (highest - address).saturating_add(1)
    } else {
        0
    }
}

fn has_room(first: Network, count: u16) -> Result<(), Failure> {
    let told = format!("{}/{}", first.address, first.prefix);
    match room(first) {
        0 => {
            let message =
                format!("--ip {told}: the first and the last address of a subnet belong to no station");
            Err(Failure::usage(message))
        }
        room if room < count.into() => {
            let message = format!(
                "from {told} on there is room for {}, not for {count}",
                super::count(room as usize)
            );
            Err(Failure::usage(message)
                .hint("begin at a lower address, or take a larger subnet (a smaller NN)"))
        }
        _ => Ok(()),
    }
}

/// The address so many behind the first; that there is room is known.
fn address(first: Network, offset: u16) -> IpSuite {
    IpSuite {
        address: u32::from(first.address).saturating_add(offset.into()).into(),
        mask: first.mask(),
        gateway: Ipv4Addr::UNSPECIFIED,
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failure::Exit;
    use clap::Parser;
    use virtual_drive::model::AKD;

    fn planned(line: &str) -> Result<Vec<Plan>, Failure> {
        let cli = crate::args::Cli::try_parse_from(line.split(' ')).unwrap();
        let crate::args::Command::Simulate(args) = cli.command else {
            panic!()
        };
        plans(&args.args, &AKD, Some(MacAddress([0, 1, 2, 3, 4, 5])))
    }

    #[test]
    fn names_addresses_and_macs_are_counted_up() {
        let drives = planned("profidrive simulate --name akd-1 --count 3 --ip 10.0.0.254/16").unwrap();
        let names: Vec<_> = drives.iter().map(|plan| plan.drive.name.as_str()).collect();
        assert_eq!(names, ["akd-1", "akd-2", "akd-3"]);
        let ips: Vec<_> = drives
            .iter()
            .map(|plan| plan.drive.ip.address.to_string())
            .collect();
        assert_eq!(ips, ["10.0.0.254", "10.0.0.255", "10.0.1.0"]);
        assert!(drives.iter().all(|plan| plan.drive.mac.0[0] == 2));
        assert_eq!(
            drives[0].drive.mac,
            planned("profidrive simulate --name akd-1").unwrap()[0].drive.mac,
            "stable"
        );
        assert_eq!(
            planned("profidrive simulate --name press --count 2").unwrap()[1]
                .drive
                .name,
            "press-2"
        );
        assert_eq!(planned("profidrive simulate").unwrap()[0].drive.name, "");
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
                "profidrive simulate --name akd-1 --count 256 --ip 10.0.0.2/24",
                "from 10.0.0.2/24 on there is room for 253 drives, not for 256",
            ),
            (
                "profidrive simulate --name akd-1 --count 2 --ip 10.0.0.254/24",
                "room for 1 drive, not for 2",
            ),
            (
                "profidrive simulate --name akd-1 --ip 10.0.0.255/24",
                "belong to no station",
            ),
            (
                "profidrive simulate --name akd-1 --count 3 --ip 10.0.0.0/31",
                "room for 2 drives, not for 3",
            ),
        ] {
            assert!(planned(line).unwrap_err().message.contains(words), "{line}");
        }
        assert_eq!(
            planned("profidrive simulate --mac host").unwrap()[0].drive.mac,
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
