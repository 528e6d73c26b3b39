//! State and settings of an interface. The ioctl of ethtool (SIOCETHTOOL) needs no permission for reading; the crates for its
//! netlink family bring an asynchronous run-time. The files in /sys show the network of whoever mounted them, which in a network
//! namespace is another one.

use std::io;
use std::os::fd::AsRawFd;
use std::time::Duration;

use socket2::{Domain, Socket, Type};

use crate::system::diagnosis::Link;

// linux/ethtool.h
const GET_SETTINGS: u32 = 0x01;
const GET_LINK: u32 = 0x0A;
const GET_COALESCE: u32 = 0x0E;
const GET_FLAGS: u32 = 0x25;
const GET_GRO: u32 = 0x2B;
const FLAG_LRO: u32 = 1 << 15;
const DUPLEX_HALF: u8 = 0;
const DUPLEX_FULL: u8 = 1;

/// Reads the state of an interface.
pub fn link(interface: &str) -> Link {
    let Some(socket) = Interface::open(interface) else {
        return Link::default();
    };
    let value = |command| socket.ethtool([command, 0]).map(|[_, value]| value);
    let settings = socket.ethtool(first::<11>(GET_SETTINGS));
    let coalesce = socket.ethtool(first::<23>(GET_COALESCE));
    Link {
        carrier: value(GET_LINK).map(|up| up != 0),
        speed: settings.as_ref().and_then(speed),
        full_duplex: settings.as_ref().and_then(full_duplex),
        mtu: socket.mtu(),
        merges: value(GET_GRO).map(|on| on != 0),
        merges_in_hardware: value(GET_FLAGS).map(|flags| flags & FLAG_LRO != 0),
        holds_back: coalesce.map(|words| Duration::from_micros(words[1].into())),
        adaptive: coalesce.map(|words| words[10] != 0),
    }
}

/// A command with room for the answer (`struct ethtool_cmd` has 11 words, `struct ethtool_coalesce` 23).
const fn first<const N: usize>(command: u32) -> [u32; N] {
    let mut words = [0; N];
    words[0] = command;
    words
}

/// Mbit/s: the low half in octets 12 and 13, the high half in 28 and 29.
fn speed(words: &[u32; 11]) -> Option<u32> {
    let half = |word: u32| {
        let [a, b, ..] = word.to_ne_bytes();
        u32::from(u16::from_ne_bytes([a, b]))
    };
    let speed = half(words[7]) << 16 | half(words[3]);
    // all ones: not known; 0 is no link
    (speed != u32::MAX && speed != u32::from(u16::MAX) && speed != 0).then_some(speed)
}

/// Octet 14.
fn full_duplex(words: &[u32; 11]) -> Option<bool> {
    match words[3].to_ne_bytes()[2] {
        DUPLEX_HALF => Some(false),
        DUPLEX_FULL => Some(true),
        _ => None,
    }
}

/// An interface by its name, with a socket to ask through.
struct Interface {
    socket: Socket,
    request: libc::ifreq,
}

impl Interface {
    fn open(name: &str) -> Option<Self> {
        // SAFETY: an all-zero ifreq is a valid one.
        let mut request: libc::ifreq = unsafe { std::mem::zeroed() };
        // the name ends with a zero
        if name.len() >= request.ifr_name.len() {
            return None;
        }
        for (place, octet) in request.ifr_name.iter_mut().zip(name.bytes()) {
            *place = octet as libc::c_char;
        }
        let socket = Socket::new(Domain::IPV4, Type::DGRAM, None).ok()?;
        Some(Self { socket, request })
    }

    fn mtu(&self) -> Option<u32> {
        let mut request = self.request;
        self.call(libc::SIOCGIFMTU, &mut request).ok()?;
        // SAFETY: the call succeeded, and SIOCGIFMTU fills in this member.
        u32::try_from(unsafe { request.ifr_ifru.ifru_mtu }).ok()
    }

    /// Carries out a command of ethtool that reads: the first word is the command, the others are the answer.
    fn ethtool<const N: usize>(&self, mut words: [u32; N]) -> Option<[u32; N]> {
        let mut request = self.request;
        request.ifr_ifru.ifru_data = words.as_mut_ptr().cast();
        self.call(libc::SIOCETHTOOL, &mut request).ok()?;
        Some(words)
    }

    fn call(&self, number: libc::c_ulong, request: &mut libc::ifreq) -> io::Result<()> {
        // SAFETY: `request` is a valid ifreq for the call. For SIOCETHTOOL its data points to as many words as the structure of
        // the command has (`first`), which live during the call.
        let result = unsafe {
            libc::ioctl(
                self.socket.as_raw_fd(),
                number as libc::Ioctl,
                std::ptr::from_mut(request),
            )
        };
        if result < 0 {
            return Err(io::Error::last_os_error());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_and_duplex_are_read_where_the_kernel_has_them() {
        let of = |low: u16, high: u16, duplex: u8| {
            let ([a, b], [c, d]) = (low.to_ne_bytes(), high.to_ne_bytes());
            let mut words = [0; 11];
            words[3] = u32::from_ne_bytes([a, b, duplex, 0]);
            words[7] = u32::from_ne_bytes([c, d, 0, 0]);
            (speed(&words), full_duplex(&words))
        };
        assert_eq!(of(100, 0, 1), (Some(100), Some(true)));
        assert_eq!(of(0x86A0, 1, 0), (Some(100_000), Some(false)));
        assert_eq!(of(0xFFFF, 0xFFFF, 0xFF), (None, None));
        assert_eq!(of(0xFFFF, 0, 0xFF), (None, None));
    }
}
