//! A packet socket on one interface: ring in, batches out.

use std::collections::BTreeSet;
use std::io;
use std::os::fd::{AsRawFd, RawFd};

use profinet::{MAX_FRAME, MacAddress};
use smoltcp::wire::{IpProtocol, Ipv4Packet, TcpPacket, UdpPacket};
use socket2::{Domain, Protocol, Socket, Type};

use super::filter::{MAX_ADDRESSES, Wanted, program};
use super::ring::{OF_CAPTURE, Received, Ring, set_option};
use crate::ethernet::PacketStatistics;
use crate::host::ethertype;
use crate::system::{Error, InterfaceInfo};

const PACKET_IGNORE_OUTGOING: libc::c_int = 23;
/// Frames sent with one call.
const BATCH: usize = 64;
/// Multicast addresses a station receives: DCP Identify, DCP Hello and LLDP.
const MULTICAST: [[u8; 6]; 3] = [
    [0x01, 0x0E, 0xCF, 0, 0, 0],
    [0x01, 0x0E, 0xCF, 0, 0, 1],
    [0x01, 0x80, 0xC2, 0, 0, 0x0E],
];

/// A raw socket bound to an interface.
#[derive(Debug)]
pub(super) struct PacketSocket {
    // Dropped before the socket it belongs to.
    ring: Ring,
    socket: Socket,
    interface: InterfaceInfo,
    own_mac: MacAddress,
    wanted: Wanted,
    macs: BTreeSet<MacAddress>,
    promiscuous: bool,
    batch: Batch,
    statistics: PacketStatistics,
}

impl PacketSocket {
    /// Opens the interface `name` for the traffic of so many stations.
    pub(super) fn open(name: &str, wanted: Wanted, stations: usize) -> Result<Self, Error> {
        Self::listen(name, Some(wanted), stations)
    }

    /// Opens the interface `name` for all of its traffic: what it sends, and what is meant for others, too.
    pub(super) fn listen_to_all(name: &str) -> Result<Self, Error> {
        let socket = Self::listen(name, None, OF_CAPTURE)?;
        socket.join_all()?;
        Ok(socket)
    }

    /// Opens the interface `name`; without a filter for what it sends itself too.
    fn listen(name: &str, wanted: Option<Wanted>, stations: usize) -> Result<Self, Error> {
        let interface = InterfaceInfo::find(name)?;
        let own_mac = interface.usable()?;
        let refused = |source: io::Error| match source.kind() {
            io::ErrorKind::PermissionDenied => Error::NoPermission {
                interface: name.to_owned(),
            },
            _ => Error::System {
                action: "cannot open a raw socket",
                source,
            },
        };
        // Protocol 0: nothing is received until the filter is in place and the socket bound.
        let socket = Socket::new(Domain::PACKET, Type::RAW, Some(Protocol::from(0))).map_err(refused)?;
        socket.set_nonblocking(true).map_err(refused)?;
        let fd = socket.as_raw_fd();
        let ring = Ring::new(fd, stations).map_err(Error::system("cannot make a receive ring"))?;
        // Room for a burst of many stations; a smaller limit of the system is not a failure.
        let _ = socket.set_send_buffer_size(1 << 20);
        if let Some(wanted) = wanted {
            // Kernels before 4.20 do not support the option: own frames are then received and ignored by their source
            // address.
            let _ = set_option(fd, PACKET_IGNORE_OUTGOING, &(1 as libc::c_int));
            socket
                .attach_filter(&program(wanted, &[]))
                .map_err(Error::system("cannot set the frame filter"))?;
        }
        bind(fd, interface.index).map_err(Error::system("cannot bind the raw socket to the interface"))?;
        let index = interface.index;
        let packet_socket = Self {
            ring,
            socket,
            interface,
            own_mac,
            wanted: wanted.unwrap_or(Wanted::Stations),
            macs: BTreeSet::new(),
            promiscuous: false,
            batch: Batch::new(),
            statistics: PacketStatistics::default(),
        };
        for address in MULTICAST {
            join(fd, index, libc::PACKET_MR_MULTICAST, address)
                .map_err(Error::system("cannot join a multicast group"))?;
        }
        Ok(packet_socket)
    }

    /// Receives frames for `mac` too, in promiscuous mode if it is not the interface's own.
    pub(super) fn add_address(&mut self, mac: MacAddress) -> Result<(), Error> {
        if !self.macs.insert(mac) {
            return Ok(());
        }
        if mac != self.own_mac && !self.promiscuous {
            self.join_all()?;
            self.promiscuous = true;
        }
        // a program that looks at no address is not set again for each of many
        if self.macs.len() > MAX_ADDRESSES + 1 {
            return Ok(());
        }
        let macs: Vec<_> = self.macs.iter().copied().collect();
        self.socket
            .attach_filter(&program(self.wanted, &macs))
            .map_err(Error::system("cannot set the frame filter"))
    }

    /// Switches the interface to promiscuous mode until the socket is closed.
    fn join_all(&self) -> Result<(), Error> {
        join(self.fd(), self.interface.index, libc::PACKET_MR_PROMISC, [0; 6])
            .map_err(Error::system("cannot switch the interface to promiscuous mode"))
    }

    pub(super) fn interface(&self) -> &InterfaceInfo {
        &self.interface
    }

    pub(super) fn fd(&self) -> RawFd {
        self.socket.as_raw_fd()
    }

    /// Returns the counters; frames that were dropped are read from the kernel.
    pub(super) fn statistics(&mut self) -> PacketStatistics {
        let mut counted = libc::tpacket_stats {
            tp_packets: 0,
            tp_drops: 0,
        };
        let mut length = size_of::<libc::tpacket_stats>() as libc::socklen_t;
        // SAFETY: `counted` and `length` are valid places; the kernel writes at most `length` octets.
        let result = unsafe {
            libc::getsockopt(
                self.fd(),
                libc::SOL_PACKET,
                libc::PACKET_STATISTICS,
                (&raw mut counted).cast(),
                &raw mut length,
            )
        };
        if result == 0 {
            // The kernel starts again from zero after each question.
            self.statistics.missed += u64::from(counted.tp_drops);
        }
        self.statistics
    }

    /// Returns how many frames were lost since the kernel was asked last.
    pub(super) fn newly_missed(&mut self) -> u64 {
        let before = self.statistics.missed;
        self.statistics().missed - before
    }

    /// Returns the oldest received frame, without its tag if the kernel took it out, its UDP or TCP checksum in order.
    pub(super) fn peek(&mut self) -> Option<(Received, &[u8])> {
        let (received, frame) = self.ring.peek()?;
        self.statistics.received += 1;
        if received.checksum_missing {
            complete_checksum(frame);
        }
        Some((received, frame))
    }

    /// Ends the look at the frame peeked at.
    pub(super) fn release(&mut self) {
        self.ring.release();
    }

    /// Puts a frame into the batch; sends the batch when it is full.
    pub(super) fn queue(&mut self, frame: &[u8]) -> Result<(), Error> {
        self.batch.push(frame);
        if self.batch.used == BATCH {
            self.flush()
        } else {
            Ok(())
        }
    }

    /// Sends the batch.
    pub(super) fn flush(&mut self) -> Result<(), Error> {
        let mut first = 0;
        let mut result = Ok(());
        while first < self.batch.used {
            match self.batch.send(self.socket.as_raw_fd(), first) {
                Ok(count) => {
                    self.statistics.sent += count as u64;
                    first += count;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                // Whatever is wrong with this frame or the queue, the next one gets its own chance.
                Err(error) => {
                    self.statistics.unsent += 1;
                    first += 1;
                    if let Err(broken) = self.judge(error) {
                        result = Err(broken);
                        first = self.batch.used;
                    }
                }
            }
        }
        self.batch.used = 0;
        result
    }

    /// Looks whether waiting ended because the interface is down or gone.
    pub(super) fn check(&self, revents: libc::c_short) -> Result<(), Error> {
        if revents & (libc::POLLERR | libc::POLLHUP | libc::POLLNVAL) == 0 {
            return Ok(());
        }
        match self.socket.take_error() {
            Ok(Some(error)) | Err(error) => self.judge(error),
            Ok(None) => Ok(()),
        }
    }

    /// Distinguishes the loss of the interface from a temporary failure.
    fn judge(&self, error: io::Error) -> Result<(), Error> {
        let name = &self.interface.name;
        match error.raw_os_error() {
            Some(libc::ENETDOWN | libc::ENXIO | libc::ENODEV) => match InterfaceInfo::find(name) {
                Ok(found) if found.index == self.interface.index => Err(Error::InterfaceDown {
                    interface: name.clone(),
                }),
                _ => Err(Error::InterfaceGone {
                    interface: name.clone(),
                }),
            },
            Some(libc::EBADF | libc::ENOTSOCK) => Err(Error::System {
                action: "the raw socket failed",
                source: error,
            }),
            _ => Ok(()),
        }
    }
}

fn bind(fd: RawFd, index: u32) -> io::Result<()> {
    // SAFETY: all-zero is a valid sockaddr_ll.
    let mut address: libc::sockaddr_ll = unsafe { std::mem::zeroed() };
    address.sll_family = libc::AF_PACKET as u16;
    address.sll_protocol = (libc::ETH_P_ALL as u16).to_be();
    address.sll_ifindex = index as libc::c_int;
    let length = size_of::<libc::sockaddr_ll>() as libc::socklen_t;
    // SAFETY: `address` is a whole sockaddr_ll of `length` octets, read during the call only.
    match unsafe { libc::bind(fd, (&raw const address).cast(), length) } {
        0 => Ok(()),
        _ => Err(io::Error::last_os_error()),
    }
}

fn join(fd: RawFd, index: u32, kind: libc::c_int, address: [u8; 6]) -> io::Result<()> {
    let [a, b, c, d, e, f] = address;
    let request = libc::packet_mreq {
        mr_ifindex: index as libc::c_int,
        mr_type: kind as libc::c_ushort,
        mr_alen: 6,
        mr_address: [a, b, c, d, e, f, 0, 0],
    };
    set_option(fd, libc::PACKET_ADD_MEMBERSHIP, &request)
}

/// Frames to be sent with one call.
#[derive(Debug)]
struct Batch {
    bytes: Box<[u8]>,
    lengths: [usize; BATCH],
    used: usize,
}

impl Batch {
    fn new() -> Self {
        Self {
            bytes: vec![0; BATCH * MAX_FRAME].into_boxed_slice(),
            lengths: [0; BATCH],
            used: 0,
        }
    }

    fn push(&mut self, frame: &[u8]) {
        let place = self
            .bytes
            .get_mut(self.used * MAX_FRAME..)
            .and_then(|rest| rest.get_mut(..frame.len()));
        if let (Some(place), Some(length)) = (
            place.filter(|_| frame.len() <= MAX_FRAME),
            self.lengths.get_mut(self.used),
        ) {
            place.copy_from_slice(frame);
            *length = frame.len();
            self.used += 1;
        }
    }

    /// Sends from frame `first` on; returns how many the kernel took, at least one.
    fn send(&mut self, fd: RawFd, first: usize) -> io::Result<usize> {
        let frames = self
            .bytes
            .chunks_mut(MAX_FRAME)
            .zip(&self.lengths)
            .take(self.used)
            .skip(first);
        let result = if self.used - first == 1 {
            let Some((bytes, length)) = frames.into_iter().next() else {
                return Ok(1);
            };
            // SAFETY: `length` octets of `bytes` are readable; push made sure that length <= MAX_FRAME.
            unsafe { libc::send(fd, bytes.as_ptr().cast(), *length, libc::MSG_DONTWAIT) }.min(1)
        } else {
            // SAFETY: all-zero iovec and mmsghdr are valid: null pointers with length zero.
            let mut parts: [libc::iovec; BATCH] = unsafe { std::mem::zeroed() };
            // SAFETY: as above.
            let mut messages: [libc::mmsghdr; BATCH] = unsafe { std::mem::zeroed() };
            let mut count = 0;
            for (((bytes, length), part), message) in frames.zip(&mut parts).zip(&mut messages) {
                *part = libc::iovec {
                    iov_base: bytes.as_mut_ptr().cast(),
                    iov_len: *length,
                };
                message.msg_hdr.msg_iov = part;
                message.msg_hdr.msg_iovlen = 1;
                count += 1;
            }
            // SAFETY: the first `count` messages point to one part each, which points into `bytes`; all live until
            // the call returns and the kernel only reads the octets.
            unsafe { libc::sendmmsg(fd, messages.as_mut_ptr(), count, libc::MSG_DONTWAIT as _) as isize }
        };
        if result >= 0 {
            Ok((result as usize).max(1))
        } else {
            Err(io::Error::last_os_error())
        }
    }
}

/// Computes the UDP or TCP checksum of a frame whose sender left it to the network card (as on a veth pair).
fn complete_checksum(frame: &mut [u8]) {
    let Some((0x0800, offset)) = ethertype(frame) else {
        return;
    };
    let Some(bytes) = frame.get_mut(offset..) else {
        return;
    };
    let Ok(mut packet) = Ipv4Packet::new_checked(bytes) else {
        return;
    };
    if packet.frag_offset() != 0 || packet.more_frags() {
        return;
    }
    let (source, destination) = (packet.src_addr().into(), packet.dst_addr().into());
    match packet.next_header() {
        IpProtocol::Udp => {
            if let Ok(mut datagram) = UdpPacket::new_checked(packet.payload_mut()) {
                datagram.fill_checksum(&source, &destination);
            }
        }
        IpProtocol::Tcp => {
            if let Ok(mut segment) = TcpPacket::new_checked(packet.payload_mut()) {
                segment.fill_checksum(&source, &destination);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use smoltcp::wire::IpAddress;

    use super::*;

    #[test]
    fn completes_a_checksum_left_to_the_card() {
        let head = [2, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 9, 8, 0];
        let ip = [
            0x45, 0, 0, 0x21, 0, 0, 0x40, 0, 0x40, 0x11, 0x26, 0xC3, 10, 0, 0, 9, 10, 0, 0, 1,
        ];
        let udp = [
            0xC0, 0, 0x88, 0x94, 0, 0x0D, 0x12, 0x34, b'h', b'e', b'l', b'l', b'o', 0, 0,
        ];
        let mut frame = [&head[..], &ip, &udp].concat();
        complete_checksum(&mut frame);
        assert_eq!(frame[40..42], [0x5F, 0x63]);
        for cut in 0..frame.len() {
            complete_checksum(&mut frame[..cut].to_vec());
        }
    }

    #[test]
    fn completes_a_tcp_checksum_too() {
        let head = [2, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 9, 8, 0];
        let ip = [
            0x45, 0, 0, 0x28, 0, 0, 0x40, 0, 0x40, 6, 0x26, 0xC7, 10, 0, 0, 9, 10, 0, 0, 1,
        ];
        let tcp = [
            0x9C, 0x40, 1, 0xF6, 0, 0, 3, 0xE8, 0, 0, 0, 0, 0x50, 2, 3, 0xE8, 0x12, 0x34, 0, 0,
        ];
        let mut frame = [&head[..], &ip, &tcp].concat();
        complete_checksum(&mut frame);
        let (from, to) = ([10, 0, 0, 9].into(), [10, 0, 0, 1].into());
        let segment = TcpPacket::new_checked(&frame[34..]).expect("a segment");
        assert!(segment.verify_checksum(&IpAddress::Ipv4(from), &IpAddress::Ipv4(to)));
    }

    #[test]
    fn a_batch_takes_no_frame_that_is_too_long() {
        let mut batch = Batch::new();
        batch.push(&[0; MAX_FRAME]);
        batch.push(&[0; MAX_FRAME + 1]);
        assert_eq!(batch.used, 1);
    }
}
