//! What the system does where only the standard library is used: whoever waits looks once a millisecond. Nothing of this has
//! run on such a system yet.

use std::io;
use std::net::Ipv4Addr;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

use profinet::Instant;
use serialport::SerialPort;

use super::diagnosis::{Link, Permissions, PortHolder};
use super::stop::SAME_SIGNAL;
use super::udp::Ports;
use super::{Calls, Error, InterfaceInfo, NeighbourTable, Rank, Stop, ThreadTime};

/// How long to sleep between two looks.
const NAP: Duration = Duration::from_millis(1);

/// Whether a UDP port can be shared, only with programs that request sharing too.
pub const PORTS_ARE_SHARED: bool = false;

/// Returns the time of all media; its origin is the first call.
#[must_use]
pub fn now() -> Instant {
    static START: OnceLock<std::time::Instant> = OnceLock::new();
    let start = START.get_or_init(std::time::Instant::now);
    Instant::ZERO + start.elapsed()
}

/// Returns nothing: not available in the standard library.
#[must_use]
pub const fn free_memory() -> Option<u64> {
    None
}

/// Returns nothing: not available in the standard library.
#[must_use]
pub const fn neighbour_table() -> Option<NeighbourTable> {
    None
}

/// Returns nothing: not available in the standard library.
#[must_use]
pub const fn thread_time() -> Option<ThreadTime> {
    None
}

/// Returns nothing: not available in the standard library.
pub const fn thread_ran() -> Option<Duration> {
    None
}

/// Returns nothing: not available in the standard library.
pub const fn permissions() -> Option<Permissions> {
    None
}

/// Returns nothing: not available in the standard library.
pub fn link(_interface: &str) -> Link {
    Link::default()
}

/// Returns nothing: not available in the standard library.
pub const fn holders(_port: u16) -> Option<Vec<PortHolder>> {
    None
}

/// Does nothing: timers are as the system sets them.
pub const fn sharpen_timers() {}

/// Returns false: the thread shares the time of the computer with all others.
pub const fn run_first(_rank: Option<Rank>) -> bool {
    false
}

/// Interfaces are used for raw Ethernet only.
pub fn interfaces() -> Result<Vec<InterfaceInfo>, Error> {
    Ok(Vec::new())
}

/// Nothing: a port that is in use is refused by the system.
#[derive(Debug)]
pub struct Claim;

/// Claims a UDP port of an address.
pub fn claim(_address: Ipv4Addr, _port: u16) -> io::Result<Claim> {
    Ok(Claim)
}

/// Counts the signals that end a program.
#[derive(Debug)]
pub struct Event {
    signals: Arc<AtomicU32>,
}

/// The event that counts them now.
static COUNTING: Mutex<Option<Counting>> = Mutex::new(None);

struct Counting {
    signals: Arc<AtomicU32>,
    enough: u32,
    last: Option<Instant>,
}

impl Counting {
    /// Counts a signal; true when there were enough.
    fn signal(&mut self, at: Instant) -> bool {
        let same = Duration::from_millis(SAME_SIGNAL);
        if self.last.is_some_and(|last| at <= last + same) {
            return false;
        }
        self.last = Some(at);
        self.signals.fetch_add(1, Ordering::SeqCst) + 1 >= self.enough
    }
}

impl Event {
    pub fn new() -> io::Result<Self> {
        Ok(Self {
            signals: Arc::default(),
        })
    }

    /// Does nothing: there is no thread to wake.
    pub fn raise(&self) {}

    pub fn clear(&self) {}

    /// Counts signals from now on, in place of the event before, until they are `enough`: then they end the program.
    pub fn on_signals(&self, enough: u32) -> io::Result<()> {
        let counting = Counting {
            signals: Arc::clone(&self.signals),
            enough,
            last: None,
        };
        let lock = || COUNTING.lock().unwrap_or_else(PoisonError::into_inner);
        if lock().replace(counting).is_some() {
            return Ok(());
        }
        let handler = move || {
            if lock().as_mut().is_some_and(|counting| counting.signal(now())) {
                std::process::exit(130);
            }
        };
        ctrlc::set_handler(handler).map_err(io::Error::other)
    }

    /// Signals that counted.
    pub fn signals(&self) -> u32 {
        self.signals.load(Ordering::SeqCst)
    }
}

/// What a medium waits for, again and again.
#[derive(Debug, Default)]
pub struct Waiting {
    called: bool,
}

impl Waiting {
    /// Waits until a port may have data, a call arrives, or `until`.
    pub fn wait(&mut self, _udp: Option<&Ports>, calls: &Calls, until: Instant) -> Result<(), Error> {
        let stop = calls.stop();
        nap(until);
        self.called = calls.was_rung() || stop.is_some_and(Stop::is_stopped);
        Ok(())
    }

    /// Returns true if a call arrived.
    pub fn called(&self, _calls: &Calls) -> bool {
        self.called
    }

    /// Returns whether the port at `index` may have something.
    pub fn has(&self, _index: usize) -> bool {
        true
    }
}

fn nap(until: Instant) {
    std::thread::sleep(until.saturating_since(now()).min(NAP));
}

/// Sleeps until `port` has octets, a call arrives, or `until`.
pub fn wait_for_octets(port: &impl SerialPort, until: Instant, calls: &Calls) -> io::Result<()> {
    let stop = calls.stop();
    let called = || calls.was_rung() || stop.is_some_and(Stop::is_stopped);
    while port.bytes_to_read()? == 0 && now() < until && !called() {
        nap(until);
    }
    Ok(())
}

/// Sleeps a moment, or until `until`.
pub fn wait_for_room(_port: &impl SerialPort, until: Instant) -> io::Result<()> {
    nap(until);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_within_a_second_count_as_one_and_the_last_one_ends_the_program() {
        let event = Event::new().unwrap();
        let mut counting = Counting {
            signals: Arc::clone(&event.signals),
            enough: 2,
            last: None,
        };
        let first = Instant::from_millis(5_000);
        assert!(!counting.signal(first));
        assert!(!counting.signal(first + Duration::from_millis(SAME_SIGNAL)));
        assert_eq!(event.signals(), 1);
        assert!(counting.signal(first + Duration::from_millis(SAME_SIGNAL + 1)));
        assert_eq!(event.signals(), 2);
    }

    #[test]
    fn a_flag_ends_a_wait_once_and_time_ends_it_too() {
        let stop = Stop::new().unwrap();
        let calls = Calls {
            stop: Some(stop.clone()),
            ..Calls::default()
        };
        let mut waiting = Waiting::default();
        let past = now();
        waiting.wait(None, &calls, past).unwrap();
        assert!(!waiting.called(&calls));
        stop.stop();
        // set already: the owner may have things to bring to an end
        waiting.wait(None, &calls, past).unwrap();
        assert!(!waiting.called(&calls) && now() >= past);
    }
}
