//! Waiting for the same descriptors again and again.

use std::io;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd, RawFd};
use std::time::Duration;

use crate::system::linux::{readable, timespec, wait};

/// What ended a wait.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(super) struct Woken {
    /// Events of the descriptor that was asked for, as `poll` numbers them.
    pub(super) events: libc::c_short,
    /// Another one may have something.
    pub(super) by_another: bool,
}

/// Waits for the same descriptors again and again: they are commanded to the kernel once, so that a wait costs less
/// than [`wait`]'s, which counts for a drive that does little else.
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
        // SAFETY: `fd` was just created and has no other owner.
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

    /// Stops watching `fd`; one that is not watched is not a failure.
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

    /// Sleeps until a descriptor has something, or for `timeout`; gives the events of `fd`. A signal ends it early, without
    /// error.
    pub(super) fn wait(&mut self, fd: RawFd, timeout: Duration) -> io::Result<Woken> {
        if !self.exact {
            let mut fds = [readable(self.epoll.as_raw_fd()), readable(fd)];
            wait(&mut fds, timeout)?;
            return Ok(Woken {
                events: fds[1].revents,
                by_another: fds[0].revents != 0,
            });
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
            let mut woken = Woken::default();
            for event in events.iter().take(ready as usize) {
                if event.u64 == fd as u64 {
                    woken.events = event.events as libc::c_short;
                } else {
                    woken.by_another = true;
                }
            }
            return Ok(woken);
        }
        let error = io::Error::last_os_error();
        match error.raw_os_error() {
            Some(libc::EINTR) => Ok(Woken::default()),
            Some(libc::ENOSYS | libc::EPERM) => {
                self.exact = false;
                Ok(Woken::default())
            }
            _ => Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::now;
    use std::io::Write;
    use std::os::unix::net::UnixStream;

    const SOON: Duration = Duration::from_millis(20);
    const LATE: Duration = Duration::from_secs(60);

    #[test]
    fn a_watch_reports_the_state_of_its_descriptor() {
        for exact in [true, false] {
            let (mut far, near) = UnixStream::pair().unwrap();
            let (mut bell, stop) = UnixStream::pair().unwrap();
            let mut watch = Watch::new().unwrap();
            watch.exact = exact;
            watch.add(near.as_raw_fd()).unwrap();
            watch.add(stop.as_raw_fd()).unwrap();
            let fd = near.as_raw_fd();
            let start = now();
            assert_eq!(
                watch.wait(fd, SOON).unwrap(),
                Woken::default(),
                "nothing is there"
            );
            assert!(now() - start >= SOON);
            far.write_all(b"x").unwrap();
            assert_eq!(watch.wait(fd, LATE).unwrap().events, libc::POLLIN);
            watch.remove(fd);
            bell.write_all(b"x").unwrap();
            // the other descriptor ends the wait and is not taken for this one
            assert_eq!(watch.wait(stop.as_raw_fd(), LATE).unwrap().events, libc::POLLIN);
            let another = Woken {
                events: 0,
                by_another: true,
            };
            assert_eq!(watch.wait(-1, LATE).unwrap(), another);
        }
    }
}
