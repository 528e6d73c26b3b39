//! DHCP client of a station: frames in, frames out, the next deadline. The client is that of smoltcp.

use std::collections::VecDeque;
use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::{Instant, IpSuite, MAX_FRAME, MacAddress};
use smoltcp::iface::{Config, Interface, SocketHandle, SocketSet};
use smoltcp::phy::{Device, DeviceCapabilities, Medium, RxToken, TxToken};
use smoltcp::socket::dhcpv4;
use smoltcp::time::Instant as Time;
use smoltcp::wire::{
    ArpOperation, ArpPacket, EthernetAddress, EthernetFrame, EthernetProtocol, HardwareAddress, IpCidr,
    IpProtocol, Ipv4Cidr, Ipv4Packet, UdpPacket,
};

/// UDP port of a DHCP client.
const CLIENT_PORT: u16 = 68;
/// Frames that wait to be sent; beyond, new ones are dropped.
const MOST: usize = 8;

/// A DHCP client for one station.
pub(super) struct Dhcp {
    cable: Cable,
    interface: Interface,
    sockets: SocketSet<'static>,
    client: SocketHandle,
    deadline: Option<Instant>,
}

impl std::fmt::Debug for Dhcp {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Dhcp")
            .field("deadline", &self.deadline)
            .finish_non_exhaustive()
    }
}

impl Dhcp {
    /// Creates a client that looks for a server from `now` on.
    pub fn new(now: Instant, mac: MacAddress) -> Self {
        let mut cable = Cable::default();
        let mut config = Config::new(HardwareAddress::Ethernet(EthernetAddress(mac.0)));
        // transaction ids of several stations differ, and those of one run repeat
        config.random_seed = mac.0.iter().fold(1, |seed, octet| seed << 8 | u64::from(*octet));
        let interface = Interface::new(config, &mut cable, time(now));
        let mut sockets = SocketSet::new(Vec::new());
        let client = sockets.add(dhcpv4::Socket::new());
        Self {
            cable,
            interface,
            sockets,
            client,
            deadline: Some(now),
        }
    }

    /// Takes a received frame if it is for the client.
    pub fn handle_frame(&mut self, frame: &[u8]) {
        if self.cable.received.len() < MOST && is_meant(frame) {
            self.cable.received.push_back(frame.to_vec());
        }
    }

    /// Does what is due and returns the news: an address, or `Some(None)` when the lease is lost.
    pub fn poll(&mut self, now: Instant) -> Option<Option<IpSuite>> {
        if self.cable.received.is_empty() && self.deadline.is_none_or(|deadline| deadline > now) {
            return None;
        }
        self.interface.poll(time(now), &mut self.cable, &mut self.sockets);
        let news = match self.sockets.get_mut::<dhcpv4::Socket<'_>>(self.client).poll() {
            None => None,
            Some(dhcpv4::Event::Deconfigured) => Some(None),
            Some(dhcpv4::Event::Configured(lease)) => Some(Some((lease.address, lease.router))),
        };
        if let Some(news) = &news {
            let address = news.map(|(address, _)| address);
            self.interface.update_ip_addrs(|all| {
                all.clear();
                // there is room for one
                let _ = address.map(|address| all.push(IpCidr::Ipv4(address)));
            });
        }
        let next = self.interface.poll_at(time(now), &self.sockets);
        self.deadline = next.map(|next| {
            let micros = u64::try_from(next.total_micros()).unwrap_or_default();
            (Instant::ZERO + Duration::from_micros(micros)).max(now + Duration::from_millis(1))
        });
        // before the first lease there is none to lose
        news.map(|news| news.map(|(address, router)| suite(address, router)))
    }

    /// Returns the next frame to send.
    pub fn poll_transmit(&mut self) -> Option<Vec<u8>> {
        self.cable.sent.pop_front()
    }

    /// Returns the time when [`poll`](Self::poll) has something to do.
    pub const fn poll_timeout(&self) -> Option<Instant> {
        self.deadline
    }
}

fn suite(address: Ipv4Cidr, router: Option<Ipv4Addr>) -> IpSuite {
    let suite = IpSuite {
        address: address.address(),
        mask: address.netmask(),
        gateway: Ipv4Addr::UNSPECIFIED,
    };
    // a router elsewhere leads nowhere
    let gateway = router.filter(|router| suite.is_local(*router));
    IpSuite {
        gateway: gateway.unwrap_or(Ipv4Addr::UNSPECIFIED),
        ..suite
    }
}

fn time(now: Instant) -> Time {
    let micros = (now - Instant::ZERO).as_micros();
    Time::from_micros(i64::try_from(micros).unwrap_or(i64::MAX))
}

/// Returns true for an answer of a server, and for an answer to the ARP request that finds the server again.
fn is_meant(frame: &[u8]) -> bool {
    let Ok(frame) = EthernetFrame::new_checked(frame) else {
        return false;
    };
    match frame.ethertype() {
        EthernetProtocol::Arp => ArpPacket::new_checked(frame.payload())
            .is_ok_and(|packet| packet.operation() == ArpOperation::Reply),
        EthernetProtocol::Ipv4 => Ipv4Packet::new_checked(frame.payload()).is_ok_and(|packet| {
            packet.next_header() == IpProtocol::Udp
                && !packet.more_frags()
                && UdpPacket::new_checked(packet.payload())
                    .is_ok_and(|packet| packet.dst_port() == CLIENT_PORT)
        }),
        _ => false,
    }
}

/// What the client takes for its network.
#[derive(Debug, Default)]
struct Cable {
    received: VecDeque<Vec<u8>>,
    sent: VecDeque<Vec<u8>>,
}

impl Device for Cable {
    type RxToken<'a> = Received;
    type TxToken<'a> = Sending<'a>;

    fn receive(&mut self, _: Time) -> Option<(Received, Sending<'_>)> {
        let frame = self.received.pop_front()?;
        Some((Received(frame), Sending(&mut self.sent)))
    }

    fn transmit(&mut self, _: Time) -> Option<Sending<'_>> {
        (self.sent.len() < MOST).then_some(Sending(&mut self.sent))
    }

    fn capabilities(&self) -> DeviceCapabilities {
        let mut capabilities = DeviceCapabilities::default();
        capabilities.medium = Medium::Ethernet;
        capabilities.max_transmission_unit = MAX_FRAME - 4;
        capabilities
    }
}

struct Received(Vec<u8>);

impl RxToken for Received {
    fn consume<R, F: FnOnce(&[u8]) -> R>(self, read: F) -> R {
        read(&self.0)
    }
}

struct Sending<'a>(&'a mut VecDeque<Vec<u8>>);

impl TxToken for Sending<'_> {
    fn consume<R, F: FnOnce(&mut [u8]) -> R>(self, length: usize, write: F) -> R {
        let mut frame = vec![0; length];
        let result = write(&mut frame);
        frame.resize(length.max(super::MINIMUM_FRAME), 0);
        self.0.push_back(frame);
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An empty datagram of a server.
    fn answer() -> Vec<u8> {
        let mut frame = [[2; 6], [4; 6]].concat();
        frame.extend([8, 0, 0x45, 0, 0, 28, 0, 0, 0, 0, 64, 17, 0, 0]);
        frame.extend([10, 0, 0, 9, 255, 255, 255, 255, 0, 67, 0, 68, 0, 8, 0, 0]);
        frame
    }

    #[test]
    fn frames_of_a_server_are_bounded() {
        let now = Instant::from_millis(1);
        let mut client = Dhcp::new(now, MacAddress([2; 6]));
        for _ in 0..3 {
            for _ in 0..100 {
                client.handle_frame(&answer());
            }
            assert_eq!(client.cable.received.len(), 8);
            client.poll(now);
            assert_eq!(client.cable.received.len(), 0);
        }
        // its own request alone
        assert_eq!(client.cable.sent.len(), 1);
    }
}
