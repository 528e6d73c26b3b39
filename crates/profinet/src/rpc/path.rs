//! How many requests to a server were answered lately: what distinguishes a lossy path from a server that is gone.

use core::fmt;
use core::net::Ipv4Addr;

use alloc::collections::VecDeque;

/// Requests to one server that are counted; the oldest is forgotten.
const WINDOW: u32 = u64::BITS;
/// Servers whose requests are counted; the one that came first is forgotten.
const SERVERS: usize = 256;

/// Requests from which on the part that was lost is a figure and not chance.
const ENOUGH: u8 = 5;

/// How many of the last requests to a server were answered. A repetition counts as a request, and so does a DCP request that it
/// answers at once.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PathCount {
    /// Requests sent before the call that was given up, 64 at most.
    pub sent: u8,
    /// Of these, those that were answered.
    pub answered: u8,
}

impl PathCount {
    /// Whether a part of the requests was answered and a part was not: frames are lost on the way.
    #[must_use]
    pub const fn is_lossy(self) -> bool {
        0 < self.answered && self.answered < self.sent
    }
}

impl fmt::Display for PathCount {
    /// `: packet loss of 25 % (12 of the 16 requests before it were answered)`, without the percentage where there were few, or
    /// nothing where no loss is seen.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_lossy() {
            return Ok(());
        }
        let (sent, answered) = (u32::from(self.sent), u32::from(self.answered));
        f.write_str(": packet loss")?;
        if self.sent >= ENOUGH {
            write!(f, " of {} %", 100 * (sent - answered) / sent)?;
        }
        write!(f, " ({answered} of the {sent} requests before it were answered)")
    }
}

#[derive(Debug)]
struct Path {
    server: Ipv4Addr,
    /// One bit for each request, the newest in bit 0: answered or not.
    history: u64,
    counted: u32,
}

/// The counts of all servers.
#[derive(Debug, Default)]
pub(super) struct Paths(VecDeque<Path>);

impl Paths {
    pub(super) const fn new() -> Self {
        Self(VecDeque::new())
    }

    /// Counts a request that ended: the `sends` of a call, the last of them answered or not.
    pub(super) fn ended(&mut self, server: Ipv4Addr, sends: u8, answered: bool) {
        if !self.0.iter().any(|path| path.server == server) {
            if self.0.len() >= SERVERS {
                self.0.pop_front();
            }
            self.0.push_back(Path {
                server,
                history: 0,
                counted: 0,
            });
        }
        let Some(path) = self.0.iter_mut().find(|path| path.server == server) else {
            return;
        };
        // a server that never answered may be switched off
        if path.history == 0 && !answered {
            return;
        }
        let sends = u32::from(sends).min(WINDOW - 1);
        path.history = (path.history << sends) | u64::from(answered);
        path.counted = (path.counted + sends).min(WINDOW);
    }

    /// Returns the count of a server; nothing sent where it is not known.
    pub(super) fn count(&self, server: Ipv4Addr) -> PathCount {
        let path = self.0.iter().find(|path| path.server == server);
        path.filter(|path| path.history != 0)
            .map_or_else(PathCount::default, |path| {
                // what was not answered since the last answer: the server may be gone
                let sent = path.counted.saturating_sub(path.history.trailing_zeros());
                PathCount {
                    sent: u8::try_from(sent).unwrap_or(u8::MAX),
                    answered: u8::try_from(path.history.count_ones()).unwrap_or(u8::MAX),
                }
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    const SERVER: Ipv4Addr = Ipv4Addr::new(10, 0, 0, 2);

    #[test]
    fn a_server_that_is_gone_is_no_loss_and_repetitions_are() {
        let mut paths = Paths::new();
        assert_eq!(paths.count(SERVER).to_string(), "");
        (0..3).for_each(|_| paths.ended(SERVER, 1, true));
        assert_eq!(paths.count(SERVER), PathCount { sent: 3, answered: 3 });
        paths.ended(SERVER, 3, false);
        assert!(!paths.count(SERVER).is_lossy(), "it may be gone");
        let mut paths = Paths::new();
        paths.ended(SERVER, 2, true);
        assert_eq!(
            paths.count(SERVER).to_string(),
            ": packet loss (1 of the 2 requests before it were answered)"
        );
        let mut paths = Paths::new();
        (0..3).for_each(|_| paths.ended(SERVER, 1, true));
        paths.ended(SERVER, 2, true);
        assert_eq!(
            paths.count(SERVER).to_string(),
            ": packet loss of 20 % (4 of the 5 requests before it were answered)"
        );
    }

    #[test]
    fn windows_and_servers_are_bounded() {
        let mut paths = Paths::new();
        paths.ended(SERVER, 3, false);
        (0..1000).for_each(|_| paths.ended(SERVER, 1, true));
        assert_eq!(
            paths.count(SERVER),
            PathCount {
                sent: 64,
                answered: 64
            }
        );
        paths.ended(SERVER, u8::MAX, true);
        assert!(paths.count(SERVER).sent <= 64);
        for last in 0..u32::try_from(SERVERS).unwrap() {
            paths.ended(Ipv4Addr::from_bits(last), 1, true);
        }
        assert_eq!(paths.0.len(), SERVERS);
        assert_eq!(paths.count(SERVER).sent, 0);
    }
}
