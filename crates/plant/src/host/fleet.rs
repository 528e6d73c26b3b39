//! A number of equal drives: names, addresses, update times.

use std::collections::HashSet;
use std::net::Ipv4Addr;
use std::time::Duration;

use profile::catalogue::Part;
use profinet::wire::dcp::{NameRule, check_name};
use profinet::{IpSuite, MacAddress};
use virtual_drive::model::Model;

use crate::plan::DrivePlan;
use crate::text::{count, free_mac};

/// One step of an update time.
const TICK_NANOS: u128 = 31_250;

/// Equal drives, counted up from the first.
#[derive(Debug, Clone)]
pub struct Fleet {
    /// Their model.
    pub model: &'static Model,
    /// Name of station; of several drives the names end in -1, -2, ..; `None` for drives that wait to be named.
    pub name: Option<String>,
    /// How many.
    pub count: u32,
    /// Address and prefix length of the first; `None` for drives that wait for their address.
    pub ip: Option<(Ipv4Addr, u8)>,
    /// Ethernet addresses.
    pub mac: MacChoice,
    /// Shortest update time; `None` for that of the model.
    pub min_cycle: Option<Duration>,
    /// Rotary switches; `None` for drives that have none set.
    pub rotary: Option<u8>,
}

/// Where drives have their Ethernet addresses from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MacChoice {
    /// From their names.
    #[default]
    Derived,
    /// That of the interface, for one drive only.
    Host,
    /// This one, for one drive only.
    This(MacAddress),
}

/// Why there can be no such drives.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FleetError {
    /// The model has no rotary switches.
    #[error("a {0} has no rotary switches")]
    NoRotarySwitches(&'static str),
    /// Several drives have the same switches.
    #[error("several drives would have one address")]
    SharedSwitches,
    /// The name of station is not valid.
    #[error("`{name}` is not a valid station name: {rule}")]
    Name {
        /// The name.
        name: String,
        /// The rule it breaks.
        rule: NameRule,
    },
    /// One Ethernet address for several drives.
    #[error("one MAC address is for one drive; several get theirs from their names")]
    SharedMac,
    /// The interface has no Ethernet address to give.
    #[error("the interface has no MAC address")]
    NoHostMac,
    /// A group address, or none.
    #[error("this address belongs to no single station")]
    NoStationMac(MacAddress),
    /// The first or last address of a subnet.
    #[error("{0}/{1}: the first and the last address of a subnet belong to no station")]
    NoStationAddress(Ipv4Addr, u8),
    /// The subnet is too small.
    #[error("from {address}/{prefix} on there is room for {}, not for {wanted}", count(*room as usize))]
    NoRoom {
        /// Address of the first drive.
        address: Ipv4Addr,
        /// Its prefix length.
        prefix: u8,
        /// Drives there is room for.
        room: u32,
        /// Drives there are.
        wanted: u32,
    },
    /// No such update time.
    #[error("an update time of {} ms does not exist", time.as_secs_f64() * 1000.0)]
    Interval {
        /// The update time.
        time: Duration,
        /// The nearest ones there are, in milliseconds.
        nearest: Vec<u16>,
    },
}

/// A drive to be simulated.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Which of several without a name.
    number: u32,
    pub drive: DrivePlan,
}

impl Plan {
    /// Returns its name in this simulation; names its files.
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

impl Fleet {
    /// One drive of `model` that waits for name and address.
    #[must_use]
    pub const fn new(model: &'static Model) -> Self {
        Self {
            model,
            name: None,
            count: 1,
            ip: None,
            mac: MacChoice::Derived,
            min_cycle: None,
            rotary: None,
        }
    }

    /// Returns the drives; `host` is the Ethernet address of the interface.
    pub(super) fn plans(&self, host: Option<MacAddress>) -> Result<Vec<Plan>, FleetError> {
        let interval = self.min_cycle.map(interval).transpose()?;
        self.check()?;
        let mut plans: Vec<Plan> = Vec::new();
        let mut taken = HashSet::new();
        for number in 1..=self.count {
            let name = match &self.name {
                None => String::new(),
                Some(name) if self.count == 1 => name.clone(),
                Some(name) => numbered(name, number),
            };
            if !name.is_empty()
                && let Err(rule) = check_name(name.as_bytes())
            {
                return Err(FleetError::Name { name, rule });
            }
            let mut plan = Plan {
                number,
                drive: DrivePlan::new(&name, self.model),
            };
            let key = plan.key();
            plan.drive.mac = self.mac(&key, host, &taken)?;
            plan.drive.min_device_interval = interval;
            if let Some((first, prefix)) = self.ip {
                plan.drive.ip = address(first, prefix, number - 1);
            }
            taken.insert(plan.drive.mac);
            plans.push(plan);
        }
        Ok(plans)
    }

    fn check(&self) -> Result<(), FleetError> {
        if let Some((address, prefix)) = self.ip {
            let wanted = self.count;
            match room(address, prefix) {
                0 => return Err(FleetError::NoStationAddress(address, prefix)),
                room if room < wanted => {
                    return Err(FleetError::NoRoom {
                        address,
                        prefix,
                        room,
                        wanted,
                    });
                }
                _ => {}
            }
        }
        if self.rotary.is_some() && self.model.number(Part::AddressMode).is_none() {
            return Err(FleetError::NoRotarySwitches(self.model.catalogue.model));
        }
        if self.rotary.is_some_and(|number| number > 0) && self.count > 1 {
            return Err(FleetError::SharedSwitches);
        }
        Ok(())
    }

    fn mac(
        &self,
        key: &str,
        host: Option<MacAddress>,
        taken: &HashSet<MacAddress>,
    ) -> Result<MacAddress, FleetError> {
        match self.mac {
            MacChoice::Derived => Ok(free_mac(key, |mac| taken.contains(&mac))),
            _ if self.count > 1 => Err(FleetError::SharedMac),
            MacChoice::Host => host.ok_or(FleetError::NoHostMac),
            MacChoice::This(mac) if mac.is_multicast() || mac == MacAddress::default() => {
                Err(FleetError::NoStationMac(mac))
            }
            MacChoice::This(mac) => Ok(mac),
        }
    }
}

/// `akd` gives akd-1, akd-2; `akd-1` gives akd-1, akd-2 as well; `akd-5` begins at 5.
fn numbered(name: &str, number: u32) -> String {
    let (base, first) = match name.rsplit_once('-') {
        Some((base, digits)) if !base.is_empty() => match digits.parse::<u32>() {
            Ok(first) => (base, first),
            Err(_) => (name, 1),
        },
        _ => (name, 1),
    };
    format!("{base}-{}", u64::from(first) + u64::from(number) - 1)
}

/// Mask of a subnet with this prefix length.
const fn mask(prefix: u8) -> Ipv4Addr {
    Ipv4Addr::from_bits(match prefix {
        0 => 0,
        1..32 => u32::MAX << (32 - prefix as u32),
        _ => u32::MAX,
    })
}

/// Addresses from `first` to the last one that a station of its subnet may have.
fn room(first: Ipv4Addr, prefix: u8) -> u32 {
    let (address, mask) = (u32::from(first), u32::from(mask(prefix)));
    let (net, broadcast) = (address & mask, address | !mask);
    // two addresses or one have no room for those of net and broadcast (RFC 3021)
    let (lowest, highest) = match prefix {
        31.. => (net, broadcast),
        _ => (net + 1, broadcast - 1),
    };
    if (lowest..=highest).contains(&address) {
        (highest - address).saturating_add(1)
    } else {
        0
    }
}

/// Returns the address so many behind the first; that there is room is known.
fn address(first: Ipv4Addr, prefix: u8, offset: u32) -> IpSuite {
    IpSuite {
        address: u32::from(first).saturating_add(offset).into(),
        mask: mask(prefix),
        gateway: Ipv4Addr::UNSPECIFIED,
    }
}

/// Returns the fastest update time in steps of 31.25 us: a power of two of them, as every update time of PROFINET here.
///
/// # Errors
/// [`FleetError::Interval`]
pub fn interval(time: Duration) -> Result<u16, FleetError> {
    let wanted = time.as_nanos();
    let nanos = |ticks: &u16| u128::from(*ticks) * TICK_NANOS;
    let mut possible = (5..=14).map(|power| 1_u16 << power);
    if let Some(ticks) = possible.clone().find(|ticks| nanos(ticks) == wanted) {
        return Ok(ticks);
    }
    let below = possible.clone().rfind(|ticks| nanos(ticks) < wanted);
    let above = possible.find(|ticks| nanos(ticks) > wanted);
    let nearest = [below, above].into_iter().flatten().map(|ticks| ticks / 32);
    Err(FleetError::Interval {
        time,
        nearest: nearest.collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use virtual_drive::model::AKD;

    const HOST: MacAddress = MacAddress([0, 1, 2, 3, 4, 5]);

    fn fleet(name: &str, count: u32) -> Fleet {
        Fleet {
            name: Some(name.into()),
            count,
            ..Fleet::new(&AKD)
        }
    }

    fn at(name: &str, count: u32, ip: [u8; 4], prefix: u8) -> Fleet {
        Fleet {
            ip: Some((ip.into(), prefix)),
            ..fleet(name, count)
        }
    }

    fn with_mac(count: u32, mac: MacChoice) -> Fleet {
        Fleet {
            mac,
            ..fleet("akd-1", count)
        }
    }

    #[test]
    fn names_addresses_and_macs_are_counted_up() {
        let drives = at("akd-1", 3, [10, 0, 0, 254], 16).plans(None).unwrap();
        let names: Vec<_> = drives.iter().map(|plan| plan.drive.name.as_str()).collect();
        assert_eq!(names, ["akd-1", "akd-2", "akd-3"]);
        let ips: Vec<_> = drives
            .iter()
            .map(|plan| plan.drive.ip.address.to_string())
            .collect();
        assert_eq!(ips, ["10.0.0.254", "10.0.0.255", "10.0.1.0"]);
        assert!(drives.iter().all(|plan| plan.drive.mac.0[0] == 2));
        let one = fleet("akd-1", 1).plans(None).unwrap();
        assert_eq!(drives[0].drive.mac, one[0].drive.mac, "stable");
        let name = |fleet: Fleet, at: usize| fleet.plans(None).unwrap()[at].drive.name.clone();
        assert_eq!(name(fleet("press", 2), 1), "press-2");
        assert_eq!(name(Fleet::new(&AKD), 0), "");
        assert_eq!(
            with_mac(1, MacChoice::Host).plans(Some(HOST)).unwrap()[0]
                .drive
                .mac,
            HOST
        );
    }

    #[test]
    fn any_number_of_drives_has_as_many_addresses() {
        // each of these bases has names whose own addresses are equal
        for base in ["c", "dev", "fleet", "akd"] {
            let drives = at(base, 70_000, [10, 0, 0, 1], 8).plans(None).unwrap();
            let macs: HashSet<_> = drives.iter().map(|plan| plan.drive.mac).collect();
            assert_eq!(macs.len(), 70_000, "{base}");
        }
    }

    #[test]
    fn drives_that_cannot_be_are_refused() {
        for (fleet, words) in [
            (fleet("akd_1", 1), "not a valid station name"),
            (with_mac(2, MacChoice::Host), "for one drive"),
            (with_mac(1, MacChoice::Host), "the interface has no MAC address"),
            (
                with_mac(1, MacChoice::This(MacAddress([0xFF; 6]))),
                "no single station",
            ),
            (
                at("akd-1", 256, [10, 0, 0, 2], 24),
                "from 10.0.0.2/24 on there is room for 253 drives, not for 256",
            ),
            (at("akd-1", 2, [10, 0, 0, 254], 24), "room for 1 drive, not for 2"),
            (at("akd-1", 1, [10, 0, 0, 255], 24), "belong to no station"),
            (at("akd-1", 3, [10, 0, 0, 0], 31), "room for 2 drives, not for 3"),
        ] {
            let error = fleet.plans(None).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn update_times() {
        assert_eq!(interval(Duration::from_millis(16)), Ok(512));
        assert_eq!(interval(Duration::from_millis(1)), Ok(32));
        assert_eq!(interval(Duration::from_millis(512)), Ok(16384));
        for (micros, possible) in [(500, vec![1]), (3_000, vec![2, 4]), (1_000_000, vec![512])] {
            let time = Duration::from_micros(micros);
            let nearest = possible;
            assert_eq!(interval(time), Err(FleetError::Interval { time, nearest }));
        }
    }
}
