//! Ports and the interface.

use crate::IpSuite;
use crate::MacAddress;
use crate::wire::block::{Block, BlockType, write_block};
use crate::wire::{DecodeError, Reader, Writer};
use core::net::Ipv4Addr;

/// PDPortDataReal of a port without a known neighbour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PortReal<'a> {
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Own port name, `port-001`.
    pub name: &'a [u8],
    /// MAUType: 16 is 100BASE-TX full duplex, 30 is 1000BASE-T full duplex.
    pub mau_type: u16,
    /// LinkState.Link is up.
    pub link_up: bool,
}

impl PortReal<'_> {
    /// Writes the record, version 1.0.
    pub fn encode(&self, out: &mut impl Writer) {
        let start = out.position();
        write_block(out, BlockType::PD_PORT_REAL, 0, |out| {
            out.u16(0);
            out.u16(self.slot);
            out.u16(self.subslot);
            out.u8(u8::try_from(self.name.len()).unwrap_or(u8::MAX));
            out.bytes(self.name);
            out.u8(0); // no neighbour
            out.align(start, 4);
            out.u16(self.mau_type);
            out.u16(0);
            out.u32(0); // DomainBoundary
            out.u32(0); // MulticastBoundary
            out.u8(0); // LinkState.Port: unknown
            out.u8(if self.link_up { 1 } else { 2 });
            out.u16(0);
            out.u32(1); // copper
        });
    }
}

/// PDInterfaceDataReal: name and addresses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InterfaceReal<'a> {
    /// Own name of station.
    pub name: &'a [u8],
    /// Own Ethernet address.
    pub mac: MacAddress,
    /// Own address.
    pub ip: IpSuite,
}

impl<'a> InterfaceReal<'a> {
    /// Writes the record.
    pub fn encode(&self, out: &mut impl Writer) {
        let start = out.position();
        write_block(out, BlockType::PD_INTERFACE_REAL, 0, |out| {
            out.u8(u8::try_from(self.name.len()).unwrap_or(u8::MAX));
            out.bytes(self.name);
            out.align(start, 4);
            out.bytes(&self.mac.0);
            out.u16(0);
            for address in [self.ip.address, self.ip.mask, self.ip.gateway] {
                out.bytes(&address.octets());
            }
        });
    }

    /// Reads the record.
    ///
    /// # Errors
    /// When it is another block or too short.
    pub fn decode(mut reader: Reader<'a>) -> Result<Self, DecodeError> {
        let mut r = Block::expect(&mut reader, BlockType::PD_INTERFACE_REAL)?;
        let length = usize::from(r.u8("LengthOwnStationName")?);
        let name = r.bytes(length, "OwnStationName")?;
        r.skip((4 - (7 + length) % 4) % 4, "padding")?;
        let mac = MacAddress(r.array("MAC address")?);
        r.skip(2, "padding")?;
        let mut address = || Ok(Ipv4Addr::from(r.u32("IP address")?));
        let ip = IpSuite {
            address: address()?,
            mask: address()?,
            gateway: address()?,
        };
        Ok(Self { name, mac, ip })
    }
}

/// PDPortStatistic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PortStatistic {
    /// Octets in and out.
    pub octets: (u32, u32),
    /// Discarded in and out.
    pub discards: (u32, u32),
    /// Errors in and out.
    pub errors: (u32, u32),
}

impl PortStatistic {
    /// Writes the record.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::PD_PORT_STATISTIC, 0, |out| {
            out.u16(0);
            for (input, output) in [self.octets, self.discards, self.errors] {
                out.u32(input);
                out.u32(output);
            }
        });
    }
}

/// Writes a MultipleBlockHeader around the blocks of one subslot that `content` writes.
pub fn encode_multiple<W: Writer>(
    out: &mut W,
    api: u32,
    slot: u16,
    subslot: u16,
    content: impl FnOnce(&mut W),
) {
    write_block(out, BlockType::MULTIPLE_BLOCK, 0, |out| {
        out.u16(0);
        out.u32(api);
        out.u16(slot);
        out.u16(subslot);
        content(out);
    });
}
