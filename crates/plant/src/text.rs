//! Values as plant files write them.

use std::time::Duration;

use profile::notation::Quantity;
use profinet::{IpSuite, MacAddress};

/// Longest time allowed in a plant file: a year.
const LONGEST: f64 = 366.0 * 86_400.0;

/// One revolution in the positions of the axis.
const REVOLUTION: f64 = 4_294_967_296.0;

/// Returns a time as plant files write it: with its unit, `2s` or `500ms`, and at most a year.
///
/// # Errors
/// What is wrong with it, in words.
pub fn time(text: &str) -> Result<Duration, String> {
    let quantity: Quantity = text.parse().map_err(|error| format!("{error}"))?;
    if quantity.unit.is_none() && quantity.number.as_f64() != 0.0 {
        return Err(format!("`{text}`: a time needs its unit (2s, 500ms)"));
    }
    let seconds = quantity.in_unit("s").map_err(|error| error.to_string())?;
    if !(0.0..=LONGEST).contains(&seconds) {
        return Err(format!("`{text}`: a time is 0 s to one year"));
    }
    Ok(Duration::from_nanos((seconds * 1e9).round() as u64))
}

/// Returns a place on the way of the axis, `2.5rev`, in 2^-32 revolutions.
pub fn place(text: &str) -> Result<i64, String> {
    let quantity: Quantity = text.parse().map_err(|error| format!("{error}"))?;
    let revolutions = match quantity.unit.as_deref() {
        Some("rev") => quantity.number.as_f64(),
        _ => return Err(format!("`{text}`: a place is written in revolutions, as 2.5rev")),
    };
    if revolutions.abs() > 1e9 {
        return Err(format!("`{text}`: a place is at most 1,000,000,000rev away"));
    }
    Ok((revolutions * REVOLUTION).round() as i64)
}

/// `192.168.0.11/24`.
pub fn suite(text: &str) -> Result<IpSuite, String> {
    let wrong = || format!("`{text}`: an address is written as 192.168.0.11/24");
    let (address, prefix) = text.split_once('/').ok_or_else(wrong)?;
    let address: std::net::Ipv4Addr = address.parse().map_err(|_| wrong())?;
    let prefix: u32 = prefix
        .parse()
        .ok()
        .filter(|p| (1..=31).contains(p))
        .ok_or_else(wrong)?;
    if address.is_unspecified() || address.is_multicast() || address.is_broadcast() {
        return Err(wrong());
    }
    Ok(IpSuite {
        address,
        mask: (u32::MAX << (32 - prefix)).into(),
        gateway: std::net::Ipv4Addr::UNSPECIFIED,
    })
}

/// Returns a locally administered address that is the same for the same name every time: FNV-1a, 40 bits of it.
pub fn derived_mac(name: &str) -> MacAddress {
    let hash = name.bytes().fold(0xCBF2_9CE4_8422_2325_u64, |hash, octet| {
        (hash ^ u64::from(octet)).wrapping_mul(0x0100_0000_01B3)
    });
    let folded = hash ^ (hash >> 40);
    let [.., a, b, c, d, e] = folded.to_be_bytes();
    MacAddress([0x02, a, b, c, d, e])
}

/// Returns the derived address of a station beside others: where one of them has it, the next one that none has.
pub fn free_mac(name: &str, is_taken: impl Fn(MacAddress) -> bool) -> MacAddress {
    let mut mac = derived_mac(name);
    while is_taken(mac) {
        let MacAddress([_, own @ ..]) = &mut mac;
        for octet in own.iter_mut().rev() {
            *octet = octet.wrapping_add(1);
            if *octet != 0 {
                break;
            }
        }
    }
    mac
}

/// Returns a station in a few words: `akd-1 (02:50:4e:00:00:01, 10.0.0.2)`.
pub fn station_text(name: &str, mac: MacAddress, ip: IpSuite) -> String {
    if ip.is_set() {
        format!("{name} ({mac}, {})", ip.address)
    } else {
        format!("{name} ({mac}, no IP address)")
    }
}

/// `1 drive`, `2 drives`.
pub fn count(drives: usize) -> String {
    match drives {
        1 => "1 drive".into(),
        _ => format!("{drives} drives"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_that_is_taken_is_followed_by_the_next() {
        let own = derived_mac("c-1369");
        assert_eq!(own, derived_mac("c-1361"), "these two show it");
        assert_eq!(free_mac("c-1369", |_| false), own);
        let next = free_mac("c-1369", |mac| mac == own);
        assert_eq!(next.0[..5], own.0[..5]);
        assert_eq!(next.0[5], own.0[5] + 1);
        let all_of_the_last = |mac: MacAddress| mac.0[..5] == own.0[..5];
        let carried = free_mac("c-1369", all_of_the_last);
        assert_eq!((carried.0[4], carried.0[5]), (own.0[4] + 1, 0));
    }

    #[test]
    fn times_places_and_addresses() {
        assert_eq!(time("1.5s"), Ok(Duration::from_millis(1500)));
        assert_eq!(time("0"), Ok(Duration::ZERO));
        assert!(time("5").unwrap_err().contains("unit"));
        assert!(time("-1s").is_err());
        assert!(time("5rpm").is_err());
        assert!(time("1e300s").is_err());
        assert_eq!(place("-0.5rev"), Ok(-(1 << 31)));
        assert!(place("3").unwrap_err().contains("revolutions"));
        assert!(place("1e30rev").is_err());
        assert_eq!(
            suite("10.0.0.2/24").map(|suite| suite.mask),
            Ok([255, 255, 255, 0].into())
        );
        for wrong in [
            "10.0.0.2",
            "10.0.0.2/0",
            "10.0.0.2/32",
            "0.0.0.0/8",
            "224.0.0.1/8",
            "x/8",
        ] {
            assert!(suite(wrong).is_err(), "{wrong}");
        }
    }
}
