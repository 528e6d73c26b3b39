//! The clock, and waiting for descriptors with nanoseconds.

use std::io;
use std::os::fd::{AsRawFd, RawFd};
use std::time::Duration;

use profinet::Instant;

use crate::system::udp::Ports;
use crate::system::{Bell, Calls, Error, Rank, Stop};

/// Returns the time of all media: the monotonic clock, whose origin is the start of the computer.
#[must_use]
pub fn now() -> Instant {
    Instant::ZERO + clock(libc::CLOCK_MONOTONIC)
}

/// Returns how long the calling thread ran since it began, at the cost of a clock.
#[expect(clippy::unnecessary_wraps, reason = "other systems do not report it")]
pub fn thread_ran() -> Option<Duration> {
    Some(clock(libc::CLOCK_THREAD_CPUTIME_ID))
}

/// Both clocks exist on every Linux.
fn clock(id: libc::clockid_t) -> Duration {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: `time` is a valid place for the result.
    unsafe { libc::clock_gettime(id, &raw mut time) };
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// Lets timers of the calling thread expire when due, not up to 50 us later as the default allows.
pub fn sharpen_timers() {
    // SAFETY: PR_SET_TIMERSLACK takes one number and touches no memory of ours. If it fails timers stay as they were.
    unsafe { libc::prctl(libc::PR_SET_TIMERSLACK, 1 as libc::c_ulong, 0, 0, 0) };
}

/// Lets the calling thread run before all threads of a lower rank, or share the time of the computer with those that have none.
/// Returns whether the system permits it. Threads that it starts share.
pub fn run_first(rank: Option<Rank>) -> bool {
    let (policy, sched_priority) = match rank {
        None => (libc::SCHED_OTHER, 0),
        Some(Rank::Answers) => (libc::SCHED_RR, 1),
        Some(Rank::Frames) => (libc::SCHED_RR, 2),
        Some(Rank::Clock) => (libc::SCHED_RR, 3),
    };
    let priority = libc::sched_param { sched_priority };
    // SAFETY: 0 is the calling thread, and `priority` is valid for the call. If it fails the thread stays as it was.
    let result =
        unsafe { libc::sched_setscheduler(0, policy | libc::SCHED_RESET_ON_FORK, &raw const priority) };
    result == 0
}

/// Returns a descriptor to wait for input on.
pub fn readable(fd: RawFd) -> libc::pollfd {
    libc::pollfd {
        fd,
        events: libc::POLLIN,
        revents: 0,
    }
}

pub fn timespec(time: Duration) -> libc::timespec {
    libc::timespec {
        tv_sec: time.as_secs().min(i32::MAX as u64) as _,
        tv_nsec: time.subsec_nanos().into(),
    }
}

/// Sleeps until `port` has octets, a call arrives, or `until`. A closed other end is an error.
pub fn wait_for_octets(port: &impl AsRawFd, until: Instant, calls: &Calls) -> io::Result<()> {
    let [stop, bell] = called_by(calls);
    let mut fds = [readable(port.as_raw_fd()), stop, bell];
    wait(&mut fds, until.saturating_since(now()))?;
    gone(fds[0].revents)
}

/// Sleeps until `port` takes octets, or `until`. An end that is gone is an error.
pub fn wait_for_room(port: &impl AsRawFd, until: Instant) -> io::Result<()> {
    let mut fds = [libc::pollfd {
        events: libc::POLLOUT,
        ..readable(port.as_raw_fd())
    }];
    wait(&mut fds, until.saturating_since(now()))?;
    gone(fds[0].revents)
}

/// Hung up with nothing left to read.
fn gone(events: libc::c_short) -> io::Result<()> {
    let ended = events & (libc::POLLHUP | libc::POLLERR | libc::POLLNVAL) != 0;
    if ended && events & libc::POLLIN == 0 {
        return Err(io::Error::from_raw_os_error(libc::EIO));
    }
    Ok(())
}

/// Sleeps until one of `fds` has something, or for `timeout`. A signal ends it early, without error.
pub fn wait(fds: &mut [libc::pollfd], timeout: Duration) -> io::Result<()> {
    let timeout = timespec(timeout);
    // SAFETY: `fds` and `timeout` are valid for the call; the length is that of the slice; no signal mask is given.
    let ready = unsafe {
        libc::ppoll(
            fds.as_mut_ptr(),
            fds.len() as libc::nfds_t,
            &raw const timeout,
            std::ptr::null(),
        )
    };
    if ready >= 0 {
        return Ok(());
    }
    let error = io::Error::last_os_error();
    for fd in fds {
        fd.revents = 0;
    }
    if error.kind() == io::ErrorKind::Interrupted {
        Ok(())
    } else {
        Err(error)
    }
}

/// Returns the descriptors to poll for the stop flag and the bell. A negative descriptor is not watched.
fn called_by(calls: &Calls) -> [libc::pollfd; 2] {
    let stop = calls.stop().map(Stop::event);
    let bell = calls.bell.as_ref().map(Bell::event);
    [stop, bell].map(|event| readable(event.map_or(-1, |event| event.fd())))
}

/// Places of the packet socket, the stop flag and the bell among the descriptors; the UDP sockets follow.
const PACKET: usize = 0;
const STOP: usize = 1;
const BELL: usize = 2;
const UDP: usize = 3;

/// What a medium waits for, again and again.
#[derive(Debug, Default)]
pub struct Waiting {
    fds: Vec<libc::pollfd>,
    sharpened: bool,
}

impl Waiting {
    /// Waits until a port has data, a call arrives, or `until`.
    pub fn wait(&mut self, udp: Option<&Ports>, calls: &Calls, until: Instant) -> Result<(), Error> {
        self.wait_beside(-1, udp, calls, until)
    }

    /// The same, and for a packet socket too.
    pub fn wait_beside(
        &mut self,
        packet: RawFd,
        udp: Option<&Ports>,
        calls: &Calls,
        until: Instant,
    ) -> Result<(), Error> {
        if !self.sharpened {
            sharpen_timers();
            self.sharpened = true;
        }
        self.fds.clear();
        self.fds.push(readable(packet));
        self.fds.extend(called_by(calls));
        let sockets = udp.into_iter().flat_map(Ports::sockets);
        self.fds
            .extend(sockets.map(|socket| readable(socket.as_raw_fd())));
        wait(&mut self.fds, until - now()).map_err(Error::system("cannot wait for frames"))
    }

    fn revents(&self, index: usize) -> libc::c_short {
        self.fds.get(index).map_or(0, |fd| fd.revents)
    }

    /// Returns the events of the packet socket.
    pub fn packet(&self) -> libc::c_short {
        self.revents(PACKET)
    }

    /// Returns true if a call arrived.
    pub fn called(&self, calls: &Calls) -> bool {
        let is_raised = self.revents(BELL) != 0;
        if let (true, Some(bell)) = (is_raised, &calls.bell) {
            bell.quiet();
        }
        calls.was_rung() || is_raised || self.revents(STOP) != 0
    }

    /// Returns whether the port at `index` may have something.
    pub fn has(&self, index: usize) -> bool {
        self.revents(UDP + index) != 0
    }
}
