//! Waking a thread that waits, from another one or from a signal.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::{AsRawFd, FromRawFd, RawFd};
use std::sync::atomic::{AtomicI32, AtomicU32, AtomicU64, Ordering};

use crate::system::stop::SAME_SIGNAL;

/// The event descriptor signals write to, -1 while there is none.
static SIGNALLED: AtomicI32 = AtomicI32::new(-1);

/// When the last signal that counted came, in milliseconds of the monotonic clock; 0 while none has.
static LAST: AtomicU64 = AtomicU64::new(0);
/// Signals that counted.
static COUNT: AtomicU32 = AtomicU32::new(0);
/// The signal that ends the program.
static ENOUGH: AtomicU32 = AtomicU32::new(2);

extern "C" fn on_signal(signal: libc::c_int) {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: clock_gettime is async-signal-safe; `time` is a valid place on this stack.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut time) };
    let now = 1 + time.tv_sec as u64 * 1000 + time.tv_nsec as u64 / 1_000_000;
    let last = LAST.load(Ordering::SeqCst);
    if last != 0 && now.saturating_sub(last) <= SAME_SIGNAL {
        return;
    }
    LAST.store(now, Ordering::SeqCst);
    if COUNT.fetch_add(1, Ordering::SeqCst) + 1 >= ENOUGH.load(Ordering::SeqCst) {
        // SAFETY: both are async-signal-safe. The signal is blocked in here; it ends the program on the way out.
        unsafe {
            libc::signal(signal, libc::SIG_DFL);
            libc::raise(signal);
        }
        return;
    }
    let one = 1u64.to_ne_bytes();
    // SAFETY: write is async-signal-safe; the buffer lives on this stack. A failure (no descriptor) does not matter.
    unsafe { libc::write(SIGNALLED.load(Ordering::SeqCst), one.as_ptr().cast(), one.len()) };
}

fn is_ignored(signal: libc::c_int) -> io::Result<bool> {
    // SAFETY: an all-zero sigaction is a valid one.
    let mut present: libc::sigaction = unsafe { std::mem::zeroed() };
    // SAFETY: without a new action nothing changes; `present` is written during the call only.
    if unsafe { libc::sigaction(signal, std::ptr::null(), &raw mut present) } != 0 {
        return Err(io::Error::last_os_error());
    }
    Ok(present.sa_sigaction == libc::SIG_IGN)
}

/// A descriptor that is readable from when it is raised until it is cleared.
#[derive(Debug)]
pub struct Event(File);

impl Event {
    pub fn new() -> io::Result<Self> {
        // SAFETY: eventfd takes two numbers and touches no memory of ours.
        let fd = unsafe { libc::eventfd(0, libc::EFD_CLOEXEC | libc::EFD_NONBLOCK) };
        if fd < 0 {
            return Err(io::Error::last_os_error());
        }
        // SAFETY: `fd` was just created and has no other owner.
        Ok(Self(unsafe { File::from_raw_fd(fd) }))
    }

    pub fn raise(&self) {
        // A full counter wakes as well; there is no other failure.
        let _ = (&self.0).write(&1u64.to_ne_bytes());
    }

    pub fn clear(&self) {
        let mut count = [0; 8];
        let _ = (&self.0).read(&mut count);
    }

    pub fn fd(&self) -> RawFd {
        self.0.as_raw_fd()
    }

    /// Lets the signals that end a program raise this event, until they are `enough`: then they end it. The event must
    /// live as long as the program.
    pub fn on_signals(&self, enough: u32) -> io::Result<()> {
        ENOUGH.store(enough, Ordering::SeqCst);
        SIGNALLED.store(self.fd(), Ordering::SeqCst);
        for signal in [libc::SIGINT, libc::SIGQUIT, libc::SIGTERM, libc::SIGHUP] {
            if signal == libc::SIGHUP && is_ignored(signal)? {
                continue;
            }
            // SAFETY: an all-zero sigaction is a valid one (no flags, empty mask).
            let mut action: libc::sigaction = unsafe { std::mem::zeroed() };
            action.sa_sigaction = on_signal as *const () as libc::sighandler_t;
            // SAFETY: `sa_mask` is a valid place. No signal interrupts the handling of another: they are counted.
            unsafe { libc::sigfillset(&raw mut action.sa_mask) };
            // SAFETY: the handler only does what is async-signal-safe; `action` is read during the call only.
            if unsafe { libc::sigaction(signal, &raw const action, std::ptr::null_mut()) } != 0 {
                return Err(io::Error::last_os_error());
            }
        }
        Ok(())
    }

    /// Signals that counted, if this is the event that they raise.
    pub fn signals(&self) -> u32 {
        if SIGNALLED.load(Ordering::SeqCst) == self.fd() {
            COUNT.load(Ordering::SeqCst)
        } else {
            0
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::system::Stop;

    #[test]
    fn quit_at_the_terminal_is_a_wish_to_stop() {
        let stop = Stop::on_signals().unwrap();
        assert!(!stop.is_stopped());
        // SAFETY: raise has no preconditions; the handler was installed above.
        assert_eq!(unsafe { libc::raise(libc::SIGQUIT) }, 0);
        assert!(stop.is_stopped() && !stop.is_urgent());
    }
}
