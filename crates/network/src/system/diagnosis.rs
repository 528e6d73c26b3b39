//! What of this computer decides how well it works as a controller: permissions, the state of an interface, who holds a port,
//! how late its timers are. Where a system does not report something, it is `None`.

use std::fmt;
use std::net::Ipv4Addr;
use std::time::Duration;

use super::{Rank, Stop, os};

/// What this program may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Permissions {
    /// Raw Ethernet (CAP_NET_RAW).
    pub raw: bool,
    /// Settings of interfaces (CAP_NET_ADMIN). Nothing here needs it.
    pub admin: bool,
    /// Threads that run before those of other programs, by CAP_SYS_NICE or a limit for real-time priorities: [`First`](super::First).
    pub first: bool,
}

impl Permissions {
    /// Returns the permissions of this program; `None` where the system does not report them.
    #[must_use]
    pub fn own() -> Option<Self> {
        os::permissions()
    }
}

/// How an interface is connected, and what it does with frames before a program gets them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Link {
    /// A cable with something alive at its other end.
    pub carrier: Option<bool>,
    /// Speed in Mbit/s.
    pub speed: Option<u32>,
    /// Both directions at the same time.
    pub full_duplex: Option<bool>,
    /// Largest packet in octets.
    pub mtu: Option<u32>,
    /// Received segments of TCP and UDP are merged by the kernel (GRO).
    pub merges: Option<bool>,
    /// Received segments of TCP are merged by the interface (LRO).
    pub merges_in_hardware: Option<bool>,
    /// How long the interface holds a received frame back before it interrupts (rx-usecs).
    pub holds_back: Option<Duration>,
    /// The interface chooses that time itself (adaptive-rx).
    pub adaptive: Option<bool>,
}

impl Link {
    /// Reads the state of an interface.
    #[must_use]
    pub fn of(interface: &str) -> Self {
        os::link(interface)
    }
}

/// A UDP port that is in use.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PortHolder {
    /// The local address; 0.0.0.0 is each.
    pub address: Ipv4Addr,
    /// The process; `None` where this program may not see it.
    pub process: Option<u32>,
    /// The name of its program.
    pub program: Option<String>,
}

impl PortHolder {
    /// Returns who has a UDP port; `None` where the system does not report it. This program itself is left out.
    #[must_use]
    pub fn of(port: u16) -> Option<Vec<Self>> {
        os::holders(port)
    }

    /// Returns who has a UDP port of an address, in words; `None` where that is not known.
    #[must_use]
    pub fn named(port: u16, address: Ipv4Addr) -> Option<String> {
        let all = Self::of(port).unwrap_or_default();
        let here = all.iter().filter(|holder| {
            address.is_unspecified() || holder.address.is_unspecified() || holder.address == address
        });
        let named: Vec<String> = here.map(Self::to_string).collect();
        (!named.is_empty()).then(|| named.join(", "))
    }
}

/// `codesys (process 812)`
impl fmt::Display for PortHolder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.program, self.process) {
            (Some(program), Some(process)) => write!(f, "{program} (process {process})"),
            _ => f.write_str("a process of another user"),
        }
    }
}

/// Sets a timer each `period` for `time` and returns how late each one was, in their order: for a thread of its own, which this
/// call uses up, and which runs before others where that is permitted, as one does that carries frames ([`First`](super::First)). Ends early once `stop` is raised.
#[must_use]
pub fn lateness(period: Duration, time: Duration, stop: Option<&Stop>) -> Vec<Duration> {
    os::sharpen_timers();
    os::run_first(Some(Rank::Frames));
    let begin = std::time::Instant::now();
    let mut late = Vec::new();
    let mut due = period;
    while due <= time && !stop.is_some_and(Stop::is_stopped) {
        std::thread::sleep(due.saturating_sub(begin.elapsed()));
        let now = begin.elapsed();
        late.push(now.saturating_sub(due));
        // what was due meanwhile was late once, not many times
        due = now.max(due) + period;
    }
    late
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timers_are_measured_until_the_time_is_over_or_a_stop_comes() {
        let period = Duration::from_millis(1);
        let time = Duration::from_millis(20);
        let measured = std::thread::spawn(move || lateness(period, time, None))
            .join()
            .unwrap();
        assert!((1..=20).contains(&measured.len()), "{measured:?}");
        let stop = Stop::new().unwrap();
        stop.stop();
        assert_eq!(lateness(period, Duration::from_secs(60), Some(&stop)), []);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_holder_of_a_port_is_found_and_this_program_is_not() {
        let own = std::net::UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let port = own.local_addr().unwrap().port();
        assert_eq!(PortHolder::of(port), Some(Vec::new()));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_loopback_interface_has_a_carrier_and_an_unknown_one_has_nothing() {
        let link = Link::of("lo");
        assert!(link.mtu.is_some_and(|mtu| mtu >= 1500), "{link:?}");
        assert_eq!(Link::of("no-such-0"), Link::default());
        assert_eq!(Link::of("a-name-longer-than-any-interface"), Link::default());
        assert!(Permissions::own().is_some());
    }
}
