//! Who is who in a capture: names learned from discovery and connects.

use std::collections::HashMap;
use std::net::Ipv4Addr;

use profinet::MacAddress;

use super::drives::Drives;
use crate::render::table::clean;

/// Most stations remembered; a capture of a whole plant has some hundreds.
const MAX_STATIONS: usize = 8192;

/// Names by address, and what each drive is.
#[derive(Debug, Default)]
pub struct Names {
    pub drives: Drives,
    by_mac: HashMap<MacAddress, String>,
    by_ip: HashMap<Ipv4Addr, String>,
}

impl Names {
    /// Name of a station, or its address.
    pub fn mac(&self, mac: MacAddress) -> String {
        self.by_mac.get(&mac).cloned().unwrap_or_else(|| mac.to_string())
    }

    /// Name of a station, or its address.
    pub fn ip(&self, ip: Ipv4Addr) -> String {
        self.by_ip.get(&ip).cloned().unwrap_or_else(|| ip.to_string())
    }

    /// Remembers what a station is called. An empty name forgets it.
    pub fn learn(&mut self, mac: Option<MacAddress>, ip: Option<Ipv4Addr>, name: &[u8]) {
        let name = clean(&String::from_utf8_lossy(name));
        if let Some(mac) = mac {
            put(&mut self.by_mac, mac, &name);
        }
        if let Some(ip) = ip.filter(|ip| !ip.is_unspecified()) {
            put(&mut self.by_ip, ip, &name);
        }
    }
}

fn put<K: std::hash::Hash + Eq>(map: &mut HashMap<K, String>, key: K, name: &str) {
    if name.is_empty() {
        map.remove(&key);
    } else if map.len() < MAX_STATIONS || map.contains_key(&key) {
        map.insert(key, name.to_owned());
    }
}
