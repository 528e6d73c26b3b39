//! Reading an LLDPDU.

use super::{Delays, Id, Lldpdu, MacPhy, Management, OUI_ETHERNET, OUI_PROFINET, kind};
use crate::MacAddress;
use crate::wire::{DecodeError, Problem, Reader};

impl<'a> Lldpdu<'a> {
    /// Reads an LLDPDU, the payload of an Ethernet frame. What stands behind its end is padding.
    ///
    /// # Errors
    /// When one of the first three TLVs is not what it must be or comes twice, or a TLV runs past the end: 802.1AB
    /// discards the whole LLDPDU then.
    pub fn decode(mut r: Reader<'a>) -> Result<Self, DecodeError> {
        let chassis = id(mandatory(&mut r, kind::CHASSIS, "chassis id")?, "chassis id")?;
        let port = id(mandatory(&mut r, kind::PORT, "port id")?, "port id")?;
        let ttl = mandatory(&mut r, kind::TTL, "time to live")?.u16("time to live")?;
        let mut lldpdu = Self {
            ttl,
            ..Self::new(chassis, port)
        };
        while !r.is_empty() {
            let start = r;
            let (found, content) = tlv(&mut r)?;
            match found {
                kind::END => break,
                kind::CHASSIS | kind::PORT | kind::TTL => {
                    let found = found.into();
                    return Err(start.error("second mandatory TLV", 0, Problem::Invalid { found }));
                }
                _ => lldpdu.take(found, content),
            }
        }
        Ok(lldpdu)
    }

    /// Takes an optional TLV; the first of a kind counts.
    fn take(&mut self, found: u8, mut r: Reader<'a>) {
        let taken = match found {
            kind::PORT_DESCRIPTION => keep(&mut self.port_description, text(r)),
            kind::SYSTEM_NAME => keep(&mut self.system_name, text(r)),
            kind::SYSTEM_DESCRIPTION => keep(&mut self.system_description, text(r)),
            kind::CAPABILITIES => keep(
                &mut self.capabilities,
                pair(r, ["capabilities", "enabled capabilities"]),
            ),
            kind::MANAGEMENT => match management(r) {
                // several addresses are allowed; the others are not needed here
                Some(_) if self.management.is_some() => true,
                other => keep(&mut self.management, other),
            },
            kind::ORGANISATION => match (r.array("OUI"), r.u8("subtype")) {
                (Ok(oui), Ok(subtype)) => return self.take_special(oui, subtype, r),
                _ => false,
            },
            _ => {
                self.unknown = self.unknown.saturating_add(1);
                return;
            }
        };
        if !taken {
            self.discarded = self.discarded.saturating_add(1);
        }
    }

    fn take_special(&mut self, oui: [u8; 3], subtype: u8, mut r: Reader<'a>) {
        let taken = match (oui, subtype) {
            (OUI_PROFINET, 1) => keep(&mut self.delays, delays(r)),
            (OUI_PROFINET, 2) => keep(
                &mut self.port_status,
                pair(r, ["RT class 2 port status", "RT class 3 port status"]),
            ),
            (OUI_PROFINET, 5) => {
                let mac = r.array("chassis MAC").ok().filter(|_| r.is_empty());
                keep(&mut self.chassis_mac, mac.map(MacAddress))
            }
            (OUI_ETHERNET, 1) => keep(&mut self.mac_phy, mac_phy(r)),
            (OUI_ETHERNET, 4) => {
                let length = r.u16("frame length").ok().filter(|_| r.is_empty());
                keep(&mut self.max_frame, length)
            }
            _ => {
                self.unknown = self.unknown.saturating_add(1);
                return;
            }
        };
        if !taken {
            self.discarded = self.discarded.saturating_add(1);
        }
    }
}

/// Reads type and content of the next TLV.
fn tlv<'a>(r: &mut Reader<'a>) -> Result<(u8, Reader<'a>), DecodeError> {
    let start = r.position();
    let head = r.u16("type and length")?;
    let content = r.sub(usize::from(head & 0x01FF), "TLV content")?;
    let found = (head >> 9) as u8;
    r.enclose(kind::name(found), start);
    Ok((found, content))
}

/// Reads one of the three TLVs that stand in front.
fn mandatory<'a>(r: &mut Reader<'a>, wanted: u8, what: &'static str) -> Result<Reader<'a>, DecodeError> {
    let start = *r;
    let (found, content) = tlv(r)?;
    if found == wanted {
        Ok(content)
    } else {
        let (expected, found) = (wanted.into(), found.into());
        Err(start.error(what, 0, Problem::Expected { expected, found }))
    }
}

fn id<'a>(mut r: Reader<'a>, what: &'static str) -> Result<Id<'a>, DecodeError> {
    let subtype = r.u8("subtype").map_err(|error| DecodeError { what, ..error })?;
    let value = r.rest("identifier");
    if (1..=255).contains(&value.len()) {
        Ok(Id { subtype, value })
    } else {
        Err(r.error(
            what,
            value.len(),
            Problem::Invalid {
                found: value.len() as u64,
            },
        ))
    }
}

/// Stores the first value of a kind; returns false if there is no value or it is a second one.
fn keep<T>(place: &mut Option<T>, value: Option<T>) -> bool {
    let first = place.is_none() && value.is_some();
    if first {
        *place = value;
    }
    first
}

fn text(mut r: Reader<'_>) -> Option<&[u8]> {
    Some(r.rest("text")).filter(|text| text.len() <= 255)
}

fn pair(mut r: Reader<'_>, [first, second]: [&'static str; 2]) -> Option<(u16, u16)> {
    let pair = (r.u16(first).ok()?, r.u16(second).ok()?);
    r.is_empty().then_some(pair)
}

fn delays(mut r: Reader<'_>) -> Option<Delays> {
    const NAMES: [&str; 5] = [
        "RxDelayLocal",
        "RxDelayRemote",
        "TxDelayLocal",
        "TxDelayRemote",
        "CableDelayLocal",
    ];
    let mut delays = [0; 5];
    for (delay, name) in delays.iter_mut().zip(NAMES) {
        *delay = r.u32(name).ok()?;
    }
    r.is_empty().then_some(delays)
}

fn mac_phy(mut r: Reader<'_>) -> Option<MacPhy> {
    let mac_phy = MacPhy {
        autonegotiation: r.u8("autonegotiation").ok()?,
        advertised: r.u16("abilities").ok()?,
        mau_type: r.u16("MAU type").ok()?,
    };
    r.is_empty().then_some(mac_phy)
}

fn management<'a>(mut r: Reader<'a>) -> Option<Management<'a>> {
    let length = usize::from(r.u8("address length").ok()?);
    let mut address = r.sub(length, "address").ok()?;
    let family = address.u8("address family").ok()?;
    let address = address.rest("address");
    let numbering = r.u8("interface numbering").ok()?;
    let interface = r.u32("interface number").ok()?;
    let length = usize::from(r.u8("object length").ok()?);
    let object = r.bytes(length, "object").ok()?;
    let fits = (1..=31).contains(&address.len()) && object.len() <= 128 && r.is_empty();
    fits.then_some(Management {
        family,
        address,
        numbering,
        interface,
        object,
    })
}
