//! Ports and the interface.

use alloc::vec::Vec;

use crate::IpSuite;
use crate::MacAddress;
use crate::wire::block::{Block, BlockType, write_block};
use crate::wire::{DecodeError, Reader, Writer};
use core::net::Ipv4Addr;

/// A neighbour of a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PortPeer<'a> {
    /// Name of its port.
    pub port: &'a [u8],
    /// Name of its station.
    pub station: &'a [u8],
    /// Delay of the line, 0 where not measured.
    pub line_delay: u32,
    /// Its Ethernet address.
    pub mac: MacAddress,
}

/// PDPortDataReal: a port and who is at the other end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PortReal<'a> {
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Own port name, `port-001`.
    pub name: &'a [u8],
    /// Its neighbours, at most 255.
    pub peers: Vec<PortPeer<'a>>,
    /// MAUType: 16 is 100BASE-TX full duplex, 30 is 1000BASE-T full duplex.
    pub mau_type: u16,
    /// LinkState.Link is up.
    pub link_up: bool,
}

/// Writes a name of at most 255 octets behind its length.
fn name(out: &mut impl Writer, name: &[u8]) {
    let name = name.get(..usize::from(u8::MAX)).unwrap_or(name);
    out.u8(u8::try_from(name.len()).unwrap_or(u8::MAX));
    out.bytes(name);
}

fn read_name<'a>(r: &mut Reader<'a>, what: &'static str) -> Result<&'a [u8], DecodeError> {
    let length = usize::from(r.u8(what)?);
    r.bytes(length, what)
}

/// Skips up to the next multiple of four octets from `start`.
fn read_align(r: &mut Reader<'_>, start: usize) -> Result<(), DecodeError> {
    r.skip((4 - (r.offset() - start) % 4) % 4, "padding")
}

impl<'a> PortReal<'a> {
    /// Reads the record.
    ///
    /// # Errors
    /// When it is another block or too short.
    pub fn decode(mut reader: Reader<'a>) -> Result<Self, DecodeError> {
        let start = reader.offset();
        let mut r = Block::expect(&mut reader, BlockType::PD_PORT_REAL)?;
        r.skip(2, "padding")?;
        let (slot, subslot) = (r.u16("SlotNumber")?, r.u16("SubslotNumber")?);
        let name = read_name(&mut r, "OwnPortName")?;
        let count = r.u8("NumberOfPeers")?;
        read_align(&mut r, start)?;
        let mut peers = Vec::new();
        for _ in 0..count {
            let port = read_name(&mut r, "PeerPortName")?;
            let station = read_name(&mut r, "PeerStationName")?;
            read_align(&mut r, start)?;
            let line_delay = r.u32("LineDelay")?;
            let mac = MacAddress(r.array("PeerMACAddress")?);
            read_align(&mut r, start)?;
            peers.push(PortPeer {
                port,
                station,
                line_delay,
                mac,
            });
        }
        let mau_type = r.u16("MAUType")?;
        r.skip(2 + 4 + 4 + 1, "boundaries")?;
        let link_up = r.u8("LinkState.Link")? == 1;
        Ok(Self {
            slot,
            subslot,
            name,
            peers,
            mau_type,
            link_up,
        })
    }

    /// Writes the record, version 1.0.
    pub fn encode(&self, out: &mut impl Writer) {
        let start = out.position();
        write_block(out, BlockType::PD_PORT_REAL, 0, |out| {
            out.u16(0);
            out.u16(self.slot);
            out.u16(self.subslot);
            name(out, self.name);
            let peers = self.peers.get(..usize::from(u8::MAX)).unwrap_or(&self.peers);
            out.u8(u8::try_from(peers.len()).unwrap_or(u8::MAX));
            out.align(start, 4);
            for peer in peers {
                name(out, peer.port);
                name(out, peer.station);
                out.align(start, 4);
                out.u32(peer.line_delay);
                out.bytes(&peer.mac.0);
                out.align(start, 4);
            }
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
