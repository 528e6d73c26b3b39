//! UDP datagrams out of Ethernet frames, as far as a capture needs it.

use std::net::{Ipv4Addr, SocketAddrV4};

use profinet::MacAddress;

/// One unfragmented UDP datagram.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Datagram<'a> {
    pub source: SocketAddrV4,
    pub destination: SocketAddrV4,
    /// Ethernet addresses of sender and receiver: those of a router, where one is between.
    pub macs: (MacAddress, MacAddress),
    pub payload: &'a [u8],
}

/// Returns the datagram in a frame, tag looked through; `None` for everything else, IP fragments included.
pub fn datagram(frame: &[u8]) -> Option<Datagram<'_>> {
    let mac = |at: usize| -> Option<MacAddress> { Some(MacAddress(frame.get(at..at + 6)?.try_into().ok()?)) };
    let macs = (mac(6)?, mac(0)?);
    let mut rest = frame.get(12..)?;
    let mut ether_type = word(rest, 0)?;
    rest = rest.get(2..)?;
    if ether_type == 0x8100 {
        ether_type = word(rest, 2)?;
        rest = rest.get(4..)?;
    }
    let version_length = *rest.first()?;
    if ether_type != 0x0800 || version_length >> 4 != 4 {
        return None;
    }
    let header = usize::from(version_length & 0xF) * 4;
    let total = usize::from(word(rest, 2)?);
    let fragment = word(rest, 6)? & 0x3FFF; // more fragments, or an offset
    if header < 20 || fragment != 0 || *rest.get(9)? != 17 {
        return None;
    }
    let ip = |at: usize| -> Option<Ipv4Addr> {
        let octets: [u8; 4] = rest.get(at..at + 4)?.try_into().ok()?;
        Some(Ipv4Addr::from(octets))
    };
    let udp = rest.get(header..total.min(rest.len()))?;
    let length = usize::from(word(udp, 4)?);
    Some(Datagram {
        source: SocketAddrV4::new(ip(12)?, word(udp, 0)?),
        destination: SocketAddrV4::new(ip(16)?, word(udp, 2)?),
        macs,
        payload: udp.get(8..length.min(udp.len()))?,
    })
}

fn word(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use profinet::wire::Uuid;
    use profinet::wire::rpc::Header;

    /// Returns a frame that carries one RPC request of the device interface.
    pub fn rpc_frame(operation: u8, body: &[u8]) -> Vec<u8> {
        let header = Header::request(
            Uuid::object(1, 1, 0x0105),
            Uuid::DEVICE_INTERFACE,
            Uuid([7; 16]),
            0,
            operation.into(),
        );
        let mut pdu = Vec::new();
        header.encode(&mut pdu, body.len());
        pdu.extend_from_slice(body);
        udp_frame(&pdu)
    }

    /// Returns a frame from station 10.0.0.1 (02:00:00:00:00:01) to 10.0.0.2 (02:00:00:00:00:02).
    pub fn udp_frame(payload: &[u8]) -> Vec<u8> {
        frame_between(1, 2, payload)
    }

    /// Returns a frame from the station with this last octet of its addresses to another.
    pub fn frame_between(from: u8, to: u8, payload: &[u8]) -> Vec<u8> {
        let length = u16::try_from(payload.len()).unwrap();
        let mut frame = vec![2, 0, 0, 0, 0, to, 2, 0, 0, 0, 0, from, 8, 0, 0x45, 0];
        frame.extend((length + 28).to_be_bytes());
        frame.extend([0, 0, 0, 0, 64, 17, 0, 0, 10, 0, 0, from, 10, 0, 0, to]);
        frame.extend([0x88, 0x94, 0x88, 0x94]);
        frame.extend((length + 8).to_be_bytes());
        frame.extend([0, 0]);
        frame.extend(payload);
        frame
    }

    #[test]
    fn payload_without_padding() {
        let mut frame = udp_frame(b"hello");
        frame.extend([0; 13]);
        let datagram = datagram(&frame).unwrap();
        assert_eq!(datagram.payload, b"hello");
        assert_eq!(datagram.destination, "10.0.0.2:34964".parse().unwrap());
    }

    #[test]
    fn cut_frames_are_no_datagrams() {
        let frame = udp_frame(b"");
        for length in 0..frame.len() {
            assert_eq!(datagram(&frame[..length]), None, "{length}");
        }
    }
}
