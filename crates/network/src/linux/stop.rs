//! Ending a blocking program: Ctrl-C, or another thread.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::{AsRawFd, FromRawFd, RawFd};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicU32, AtomicU64, Ordering};

/// A flag that wakes whoever waits in a runner or medium it was given to. Clones are the same flag.
///
/// ```
/// # fn main() -> std::io::Result<()> {
/// use profidrive_network::linux::Stop;
/// let stop = Stop::new()?;
/// let other = stop.clone();
/// std::thread::spawn(move || other.stop()).join().expect("the thread ends");
/// assert!(stop.is_stopped());
/// # Ok(()) }
/// ```
#[derive(Debug, Clone)]
pub struct Stop {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    set: AtomicBool,
    event: File,
}

/// The event descriptor signals write to, -1 while there is none.
static SIGNALLED: AtomicI32 = AtomicI32::new(-1);

/// When the last signal that counted came, in milliseconds of the monotonic clock; 0 while none has.
static LAST: AtomicU64 = AtomicU64::new(0);
/// Signals that counted.
static COUNT: AtomicU32 = AtomicU32::new(0);
/// The signal that ends the program.
static ENOUGH: AtomicU32 = AtomicU32::new(2);

/// A signal again within this time, ms, means the same as the one before: a hasty Ctrl-C, a program that ends its whole
/// group.
const SAME: u64 = 1000;

/// Which signal ends the program at once, as without a handler. Signals within a second count as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Patience {
    /// The second one.
    Second,
    /// The third one: the second makes the flag [urgent](Stop::is_urgent), for a program whose end may take long.
    Third,
}

extern "C" fn on_signal(signal: libc::c_int) {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: clock_gettime is async-signal-safe; `time` is a valid place on this stack.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut time) };
    let now = 1 + time.tv_sec as u64 * 1000 + time.tv_nsec as u64 / 1_000_000;
    let last = LAST.load(Ordering::SeqCst);
    if last != 0 && now.saturating_sub(last) <= SAME {
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

/// A descriptor that is readable once it was written to.
fn event() -> io::Result<File> {
    // SAFETY: eventfd takes two numbers and touches no memory of ours.
    let fd = unsafe { libc::eventfd(0, libc::EFD_CLOEXEC | libc::EFD_NONBLOCK) };
    if fd < 0 {
        return Err(io::Error::last_os_error());
    }
    // SAFETY: `fd` was just made and belongs to nobody else.
    Ok(unsafe { File::from_raw_fd(fd) })
}

/// Wakes a runner again and again, from another thread that has work for it. Clones are the same bell.
#[derive(Debug, Clone)]
pub struct Bell {
    inner: Arc<Inner>,
}

impl Bell {
    /// A bell that is silent.
    ///
    /// # Errors
    /// When the operating system has no descriptor left.
    pub fn new() -> io::Result<Self> {
        let inner = Inner {
            set: AtomicBool::new(false),
            event: event()?,
        };
        Ok(Self {
            inner: Arc::new(inner),
        })
    }

    /// Ends the present or the next wait.
    pub fn ring(&self) {
        self.inner.set.store(true, Ordering::SeqCst);
        // A full counter wakes as well; there is no other failure.
        let _ = (&self.inner.event).write(&1u64.to_ne_bytes());
    }

    /// True if it has rung since the last look.
    pub(super) fn heard(&self) -> bool {
        let rung = self.inner.set.swap(false, Ordering::SeqCst);
        if rung {
            let mut count = [0; 8];
            let _ = (&self.inner.event).read(&mut count);
        }
        rung
    }

    /// Readable once it has rung.
    pub(super) fn fd(&self) -> RawFd {
        self.inner.event.as_raw_fd()
    }
}

impl Stop {
    /// A flag that only the program sets.
    ///
    /// # Errors
    /// When the operating system has no descriptor left.
    pub fn new() -> io::Result<Self> {
        let event = event()?;
        Ok(Self {
            inner: Arc::new(Inner {
                set: AtomicBool::new(false),
                event,
            }),
        })
    }

    /// A flag that Ctrl-C (SIGINT), Ctrl-\ (SIGQUIT), SIGTERM and a terminal that goes away (SIGHUP, unless ignored as by `nohup`) set.
    /// Signals within a second count as one; a later one ends the program at once, as without this.
    ///
    /// # Errors
    /// When the operating system has no descriptor left or refuses the handler.
    pub fn on_signals() -> io::Result<Self> {
        Self::on_signals_with(Patience::Second)
    }

    /// The same, and `patience` says which signal ends the program at once.
    ///
    /// # Errors
    /// When the operating system has no descriptor left or refuses the handler.
    pub fn on_signals_with(patience: Patience) -> io::Result<Self> {
        let stop = Self::new()?;
        let enough = match patience {
            Patience::Second => 2,
            Patience::Third => 3,
        };
        ENOUGH.store(enough, Ordering::SeqCst);
        SIGNALLED.store(stop.inner.event.as_raw_fd(), Ordering::SeqCst);
        // The descriptor must stay open as long as a signal may come: for ever.
        std::mem::forget(stop.clone());
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
        Ok(stop)
    }

    /// Sets the flag and wakes whoever waits.
    pub fn stop(&self) {
        self.inner.set.store(true, Ordering::SeqCst);
        // A full counter wakes as well; there is no other failure.
        let _ = (&self.inner.event).write(&1u64.to_ne_bytes());
    }

    /// True once the flag is set.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.signals() > 0 || self.inner.set.load(Ordering::SeqCst)
    }

    /// True once a second signal came, more than a second after the first: what takes its time is to be cut short.
    #[must_use]
    pub fn is_urgent(&self) -> bool {
        self.signals() > 1
    }

    /// Signals that counted, if this is the flag that they set.
    fn signals(&self) -> u32 {
        if SIGNALLED.load(Ordering::SeqCst) == self.fd() {
            COUNT.load(Ordering::SeqCst)
        } else {
            0
        }
    }

    /// Readable once the flag is set.
    pub(super) fn fd(&self) -> RawFd {
        self.inner.event.as_raw_fd()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quit_at_the_terminal_is_a_wish_to_stop() {
        let stop = Stop::on_signals().unwrap();
        assert!(!stop.is_stopped());
        // SAFETY: raise has no preconditions; the handler was installed above.
        assert_eq!(unsafe { libc::raise(libc::SIGQUIT) }, 0);
        assert!(stop.is_stopped() && !stop.is_urgent());
    }

    #[test]
    fn a_bell_is_heard_once_for_any_number_of_rings() {
        let bell = Bell::new().unwrap();
        assert!(!bell.heard());
        bell.clone().ring();
        bell.ring();
        assert!(bell.heard());
        assert!(!bell.heard());
        bell.ring();
        assert!(bell.heard());
    }
}
