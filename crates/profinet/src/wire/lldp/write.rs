//! Writing an LLDPDU.

use super::{Lldpdu, OUI_ETHERNET, OUI_PROFINET, kind};
use crate::wire::Writer;

impl Lldpdu<'_> {
    /// Writes chassis id and port id: what names a port among all ports.
    pub fn encode_ids(&self, out: &mut impl Writer) {
        for (kind, id) in [(kind::CHASSIS, self.chassis), (kind::PORT, self.port)] {
            write_tlv(out, kind, |out| {
                out.u8(id.subtype);
                out.bytes(id.value);
            });
        }
    }

    /// Writes the LLDPDU.
    pub fn encode(&self, out: &mut impl Writer) {
        self.encode_ids(out);
        write_tlv(out, kind::TTL, |out| out.u16(self.ttl));
        for (kind, text) in [
            (kind::PORT_DESCRIPTION, self.port_description),
            (kind::SYSTEM_NAME, self.system_name),
            (kind::SYSTEM_DESCRIPTION, self.system_description),
        ] {
            if let Some(text) = text {
                write_tlv(out, kind, |out| out.bytes(text));
            }
        }
        if let Some((there, used)) = self.capabilities {
            write_tlv(out, kind::CAPABILITIES, |out| {
                out.u16(there);
                out.u16(used);
            });
        }
        if let Some(management) = &self.management {
            write_tlv(out, kind::MANAGEMENT, |out| {
                out.u8(octet(management.address.len() + 1));
                out.u8(management.family);
                out.bytes(management.address);
                out.u8(management.numbering);
                out.u32(management.interface);
                out.u8(octet(management.object.len()));
                out.bytes(management.object);
            });
        }
        if let Some(delays) = self.delays {
            special(out, OUI_PROFINET, 1, |out| {
                delays.iter().for_each(|delay| out.u32(*delay))
            });
        }
        if let Some((class2, class3)) = self.port_status {
            special(out, OUI_PROFINET, 2, |out| {
                out.u16(class2);
                out.u16(class3);
            });
        }
        if let Some(mac) = self.chassis_mac {
            special(out, OUI_PROFINET, 5, |out| out.bytes(&mac.0));
        }
        if let Some(mac_phy) = self.mac_phy {
            special(out, OUI_ETHERNET, 1, |out| {
                out.u8(mac_phy.autonegotiation);
                out.u16(mac_phy.advertised);
                out.u16(mac_phy.mau_type);
            });
        }
        if let Some(length) = self.max_frame {
            special(out, OUI_ETHERNET, 4, |out| out.u16(length));
        }
        out.u16(0);
    }
}

fn octet(length: usize) -> u8 {
    u8::try_from(length).unwrap_or(u8::MAX)
}

/// Writes a TLV around what `content` writes.
fn write_tlv<W: Writer>(out: &mut W, kind: u8, content: impl FnOnce(&mut W)) {
    let start = out.position();
    out.u16(0);
    content(out);
    let length = u16::try_from(out.position() - start - 2)
        .unwrap_or(u16::MAX)
        .min(0x01FF);
    out.patch(start, &(u16::from(kind) << 9 | length).to_be_bytes());
}

fn special<W: Writer>(out: &mut W, oui: [u8; 3], subtype: u8, content: impl FnOnce(&mut W)) {
    write_tlv(out, kind::ORGANISATION, |out| {
        out.bytes(&oui);
        out.u8(subtype);
        content(out);
    });
}
