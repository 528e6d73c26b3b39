//! The clock, and waiting for sockets with nanoseconds.

use std::io;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd, RawFd};
use std::time::Duration;

use profinet::Instant;

use super::stop::Stop;

/// The time of all Linux media: the monotonic clock, whose origin is the start of the computer.
#[must_use]
pub fn now() -> Instant {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: `time` is a valid place for the result. CLOCK_MONOTONIC exists on every Linux.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut time) };
    Instant::from_nanos(time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64)
}

/// Gives the calling thread real-time priority (SCHED_FIFO, 1 to 99).
///
/// # Errors
/// When that is not allowed: it needs root, `CAP_SYS_NICE` or an rtprio limit.
pub fn raise_priority(priority: i32) -> io::Result<()> {
    let parameter = libc::sched_param {
        sched_priority: priority,
    };
    // SAFETY: process 0 is the calling thread; `parameter` is read during the call only.
    match unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameter) } {
        0 => Ok(()),
        _ => Err(io::Error::last_os_error()),
    }
}

/// Lets timers of the calling thread expire when due, not up to 50 us later as the default allows.
pub(super) fn sharpen_timers() {
    // SAFETY: PR_SET_TIMERSLACK takes one number and touches no memory of ours. If it fails timers stay as they were.
    unsafe { libc::prctl(libc::PR_SET_TIMERSLACK, 1 as libc::c_ulong, 0, 0, 0) };
}

/// A descriptor to wait for input on.
pub(super) fn readable(fd: RawFd) -> libc::pollfd {
    libc::pollfd {
        fd,
        events: libc::POLLIN,
        revents: 0,
    }
}

/// Waits for the same descriptors again and again: they are told to the kernel once, so that a wait costs less than
/// [`wait`]'s, which counts for a drive that does little else.
#[derive(Debug)]
pub(super) struct Watch {
    epoll: OwnedFd,
    /// False on kernels before 5.11, which cannot wait for less than a millisecond this way.
    exact: bool,
}

impl Watch {
    /// Watches nothing.
    pub(super) fn new() -> io::Result<Self> {
        // SAFETY: epoll_create1 takes a number and touches no memory of ours.
        let fd = unsafe { libc::epoll_create1(libc::EPOLL_CLOEXEC) };
        if fd < 0 {
            return Err(io::Error::last_os_error());
        }
        // SAFETY: `fd` was just made and belongs to nobody else.
        let epoll = unsafe { OwnedFd::from_raw_fd(fd) };
        Ok(Self { epoll, exact: true })
    }

    /// Watches `fd` for input too, until it is closed.
    pub(super) fn add(&self, fd: RawFd) -> io::Result<()> {
        let mut event = libc::epoll_event {
            events: libc::EPOLLIN as u32,
            u64: fd as u64,
        };
        // SAFETY: `event` is read during the call only; a bad `fd` is an error of the call.
        match unsafe { libc::epoll_ctl(self.epoll.as_raw_fd(), libc::EPOLL_CTL_ADD, fd, &raw mut event) } {
            0 => Ok(()),
            _ => Err(io::Error::last_os_error()),
        }
    }

    /// Stops watching `fd`; one that is not watched is no failure.
    pub(super) fn remove(&self, fd: RawFd) {
        // SAFETY: no memory is touched: the event is null, which this operation ignores.
        unsafe {
            libc::epoll_ctl(
                self.epoll.as_raw_fd(),
                libc::EPOLL_CTL_DEL,
                fd,
                std::ptr::null_mut(),
            )
        };
    }

    /// Sleeps until a descriptor has something, or for `timeout`; gives the events of `fd`, as `poll` numbers them. A
    /// signal ends it early, without error.
    pub(super) fn wait(&mut self, fd: RawFd, timeout: Duration) -> io::Result<libc::c_short> {
        if !self.exact {
            let mut fds = [readable(self.epoll.as_raw_fd()), readable(fd)];
            wait(&mut fds, timeout)?;
            return Ok(fds[1].revents);
        }
        let timeout = timespec(timeout);
        let mut events = [libc::epoll_event { events: 0, u64: 0 }; 2];
        // SAFETY: `events` has room for two events, `timeout` is valid for the call, no signal mask is given. The call
        // has no wrapper in older C libraries, hence by its number.
        let ready = unsafe {
            libc::syscall(
                libc::SYS_epoll_pwait2,
                self.epoll.as_raw_fd(),
                events.as_mut_ptr(),
                events.len() as libc::c_int,
                &raw const timeout,
                std::ptr::null::<libc::sigset_t>(),
                0_usize,
            )
        };
        if ready >= 0 {
            let own = events
                .iter()
                .take(ready as usize)
                .find(|event| event.u64 == fd as u64);
            return Ok(own.map_or(0, |event| event.events as libc::c_short));
        }
        let error = io::Error::last_os_error();
        match error.raw_os_error() {
            Some(libc::EINTR) => Ok(0),
            Some(libc::ENOSYS | libc::EPERM) => {
                self.exact = false;
                Ok(0)
            }
            _ => Err(error),
        }
    }
}

fn timespec(time: Duration) -> libc::timespec {
    libc::timespec {
        tv_sec: time.as_secs().min(i32::MAX as u64) as libc::time_t,
        tv_nsec: time.subsec_nanos().into(),
    }
}

/// Sleeps until `fd` has octets, the flag is set, or `until`. An end that is gone is an error.
pub(crate) fn wait_for_octets(fd: RawFd, until: Instant, stop: Option<&Stop>) -> io::Result<()> {
    let other = stop.map_or(-1, Stop::fd);
    // a negative descriptor is not watched
    let mut fds = [readable(fd), readable(other)];
    wait(&mut fds, until.saturating_since(now()))?;
    gone(fds[0].revents)
}

/// Sleeps until `fd` takes octets, or `until`. An end that is gone is an error.
pub(crate) fn wait_for_room(fd: RawFd, until: Instant) -> io::Result<()> {
    let mut fds = [libc::pollfd {
        events: libc::POLLOUT,
        ..readable(fd)
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
pub(super) fn wait(fds: &mut [libc::pollfd], timeout: Duration) -> io::Result<()> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use std::os::unix::net::UnixStream;

    const SOON: Duration = Duration::from_millis(20);
    const LATE: Duration = Duration::from_secs(60);

    #[test]
    fn a_watch_tells_what_the_asked_descriptor_has() {
        for exact in [true, false] {
            let (mut far, near) = UnixStream::pair().unwrap();
            let (mut bell, stop) = UnixStream::pair().unwrap();
            let mut watch = Watch::new().unwrap();
            watch.exact = exact;
            watch.add(near.as_raw_fd()).unwrap();
            watch.add(stop.as_raw_fd()).unwrap();
            let fd = near.as_raw_fd();
            let start = now();
            assert_eq!(watch.wait(fd, SOON).unwrap(), 0, "nothing is there");
            assert!(now() - start >= SOON);
            far.write_all(b"x").unwrap();
            assert_eq!(watch.wait(fd, LATE).unwrap(), libc::POLLIN);
            watch.remove(fd);
            bell.write_all(b"x").unwrap();
            // the other descriptor ends the wait and is not taken for this one
            assert_eq!(watch.wait(stop.as_raw_fd(), LATE).unwrap(), libc::POLLIN);
            if exact {
                assert_eq!(watch.wait(fd, LATE).unwrap(), 0);
            }
        }
    }
}
