//! Who is who in a capture: names and addresses from discovery and connects, and two stations that claim the same.

use std::collections::{HashMap, HashSet};
use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::MacAddress;
use profinet::wire::dcp::MAX_NAME;

use super::drives::Drives;
use super::event::{Detail, Party, Sink, Trouble};
use crate::Weight;

/// Maximum number of stored stations; a capture of a whole plant has some hundreds.
const MAX_STATIONS: usize = 8192;
/// A station that was seen with a name this long ago may have been replaced since.
const RECENT: Duration = Duration::from_secs(10);

/// Names by address, and what each drive is.
#[derive(Debug, Default)]
pub struct Names {
    pub drives: Drives,
    by_mac: HashMap<MacAddress, String>,
    by_ip: HashMap<Ipv4Addr, String>,
    /// Last user of a name.
    holders: HashMap<String, (MacAddress, Duration)>,
    /// Last user of an address.
    owners: HashMap<Ipv4Addr, (MacAddress, Duration)>,
    /// Names and addresses of which a conflict was reported, with the two.
    reported: HashSet<(String, MacAddress, MacAddress)>,
    /// Names that several stations have.
    shared: HashSet<String>,
}

impl Names {
    /// Returns the name of a station, or its address. Where several have the name, with its address.
    pub fn label(&self, party: Party) -> String {
        let by_ip = |ip: Ipv4Addr| self.by_ip.get(&ip).cloned().unwrap_or_else(|| ip.to_string());
        match (party.mac, party.ip) {
            (mac, Some(ip)) => self.distinct(by_ip(ip), mac),
            (Some(mac), None) => match self.by_mac.get(&mac) {
                Some(name) => self.distinct(name.clone(), Some(mac)),
                None => mac.to_string(),
            },
            (None, None) => String::new(),
        }
    }

    fn distinct(&self, name: String, mac: Option<MacAddress>) -> String {
        match mac.filter(|_| self.shared.contains(&name)) {
            Some(mac) => format!("{name} ({mac})"),
            None => name,
        }
    }

    /// Returns true when a party has this name or this address.
    pub fn is(&self, party: Party, wanted: &str) -> bool {
        let by_mac = party.mac.is_some_and(|mac| {
            mac.to_string().eq_ignore_ascii_case(wanted)
                || self.by_mac.get(&mac).is_some_and(|name| name == wanted)
        });
        let by_ip = party.ip.is_some_and(|ip| {
            ip.to_string() == wanted
                || self.by_ip.get(&ip).is_some_and(|name| name == wanted)
                || self.owners.get(&ip).is_some_and(|(mac, _)| {
                    mac.to_string().eq_ignore_ascii_case(wanted)
                        || self.by_mac.get(mac).is_some_and(|name| name == wanted)
                })
        });
        let owns = || {
            let mut owners = self.owners.iter();
            owners.any(|(ip, (mac, _))| Some(*mac) == party.mac && ip.to_string() == wanted)
        };
        by_mac || by_ip || (party.mac.is_some() && wanted.parse::<Ipv4Addr>().is_ok() && owns())
    }

    /// Returns the last address of a station.
    pub fn ip_of(&self, mac: MacAddress) -> Option<Ipv4Addr> {
        let mut owners = self.owners.iter();
        owners.find(|(_, (owner, _))| *owner == mac).map(|(ip, _)| *ip)
    }

    /// Records the name and the address that a station reports of itself. Reports another station that has one of
    /// them too.
    pub fn seen(&mut self, mac: MacAddress, ip: Option<Ipv4Addr>, name: Option<&[u8]>, sink: &mut Sink<'_>) {
        if let Some(ip) = ip.filter(|ip| !ip.is_unspecified()) {
            self.seen_at(mac, ip, sink);
        }
        let Some(name) = name.map(text) else {
            return;
        };
        if let Some(ip) = ip.filter(|ip| !ip.is_unspecified()) {
            put(&mut self.by_ip, ip, &name);
        }
        put(&mut self.by_mac, mac, &name);
        if name.is_empty() {
            return;
        }
        let before = claim(&mut self.holders, name.clone(), mac, sink.at);
        let Some((other, ago)) = before else { return };
        if self.by_mac.get(&other) == Some(&name) && self.is_new(&name, mac, other) {
            self.shared.insert(name.clone());
            let before = seconds(ago);
            let duplicate =
                format!("duplicate name {name}: {mac} has it, and {other} had it {before} before");
            let moved = format!(
                "name {name} moved to {mac}; {other} had it {before} before (replaced, or a duplicate name)"
            );
            let trouble = Trouble::DuplicateName {
                name,
                mac,
                other,
                ago,
            };
            report_shared(ago, [duplicate, moved], trouble, sink);
        }
    }

    /// Records the IP address that a station uses. Reports another station that uses it.
    pub fn seen_at(&mut self, mac: MacAddress, ip: Ipv4Addr, sink: &mut Sink<'_>) {
        let before = claim(&mut self.owners, ip, mac, sink.at);
        let Some((other, ago)) = before else { return };
        if self.is_new(&ip.to_string(), mac, other) {
            let duplicate = format!("duplicate IP address {ip}: {mac} and {other} both use it");
            let moved = format!(
                "IP address {ip} moved to {mac}; {other} used it {} before",
                seconds(ago)
            );
            let trouble = Trouble::DuplicateAddress {
                ip,
                mac,
                other: Some(other),
            };
            report_shared(ago, [duplicate, moved], trouble, sink);
        }
    }

    /// A station was given a name, and confirmed it.
    pub fn renamed(&mut self, mac: MacAddress, name: &[u8], at: Duration) {
        let name = text(name);
        if let Some(ip) = self.ip_of(mac) {
            put(&mut self.by_ip, ip, &name);
        }
        put(&mut self.by_mac, mac, &name);
        if !name.is_empty() && self.holders.len() < MAX_STATIONS {
            self.holders.insert(name, (mac, at));
        }
    }

    /// A station was given an address, and confirmed it.
    pub fn readdressed(&mut self, mac: MacAddress, ip: Ipv4Addr, at: Duration) {
        self.owners.retain(|_, (owner, _)| *owner != mac);
        if !ip.is_unspecified() && self.owners.len() < MAX_STATIONS {
            self.owners.insert(ip, (mac, at));
            if let Some(name) = self.by_mac.get(&mac).cloned() {
                put(&mut self.by_ip, ip, &name);
            }
        }
    }

    /// Returns true the first time that these two are found with the same name or address.
    fn is_new(&mut self, what: &str, mac: MacAddress, other: MacAddress) -> bool {
        let key = (what.to_owned(), mac.min(other), mac.max(other));
        self.reported.len() < MAX_STATIONS && self.reported.insert(key)
    }
}

/// Returns a name as text. A block of a capture may hold far more octets than a name of station has; the rest is left out.
fn text(name: &[u8]) -> String {
    String::from_utf8_lossy(name.get(..MAX_NAME).unwrap_or(name)).into_owned()
}

/// Records the user of a name or address. Returns another station that used it, and how long ago.
fn claim<K: std::hash::Hash + Eq>(
    holders: &mut HashMap<K, (MacAddress, Duration)>,
    what: K,
    mac: MacAddress,
    at: Duration,
) -> Option<(MacAddress, Duration)> {
    let before = holders.get(&what).copied();
    if holders.len() < MAX_STATIONS || before.is_some() {
        holders.insert(what, (mac, at));
    }
    let (other, then) = before.filter(|(other, _)| *other != mac)?;
    Some((other, at.saturating_sub(then)))
}

/// Reports what two stations use: at nearly the same time it is a duplicate, later it may have moved.
fn report_shared(ago: Duration, [duplicate, moved]: [String; 2], trouble: Trouble, sink: &mut Sink<'_>) {
    let (weight, text) = if ago < RECENT {
        (Weight::Error, duplicate)
    } else {
        (Weight::Warning, moved)
    };
    sink.report(weight, "conflict", text, Detail::Trouble(trouble));
}

fn put<K: std::hash::Hash + Eq>(map: &mut HashMap<K, String>, key: K, name: &str) {
    if name.is_empty() {
        map.remove(&key);
    } else if map.len() < MAX_STATIONS || map.contains_key(&key) {
        map.insert(key, name.to_owned());
    }
}

/// `2.003 s`, `16 ms`, `120 us`: at most four digits.
pub fn seconds(time: Duration) -> String {
    let micros = time.as_micros();
    #[expect(clippy::cast_precision_loss, reason = "for people")]
    let scaled = |unit: f64| crate::number((micros as f64 / unit * 1000.0).round() / 1000.0);
    match micros {
        0..1000 => format!("{micros} us"),
        1000..1_000_000 => format!("{} ms", scaled(1e3)),
        _ => format!("{} s", scaled(1e6)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_kept_no_longer_than_a_name_can_be() {
        let mut names = Names::default();
        let mac = MacAddress([2, 0, 0, 0, 0, 1]);
        names.renamed(mac, &[b'a'; 65_000], Duration::ZERO);
        assert_eq!(names.by_mac.get(&mac).map(String::len), Some(MAX_NAME));
    }

    #[test]
    fn names_and_addresses_are_bounded() {
        let mut names = Names::default();
        for number in 0..10_000_u32 {
            let [a, b, c, d] = number.to_be_bytes();
            let mac = MacAddress([2, 0, a, b, c, d]);
            names.renamed(mac, format!("n{number}").as_bytes(), Duration::ZERO);
            names.readdressed(mac, Ipv4Addr::from(number + 1), Duration::ZERO);
        }
        assert_eq!(
            (names.by_mac.len(), names.holders.len()),
            (MAX_STATIONS, MAX_STATIONS)
        );
        assert_eq!(
            (names.by_ip.len(), names.owners.len()),
            (MAX_STATIONS, MAX_STATIONS)
        );
    }
}
