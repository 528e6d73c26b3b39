//! Processor time, as the kernel reports it.

use std::fs::read_to_string;
use std::time::Duration;

use crate::system::ThreadTime;

/// Returns the processor time of the calling thread since it began; `None` where the kernel does not report that.
#[must_use]
pub fn thread_time() -> Option<ThreadTime> {
    schedule(&read_to_string("/proc/thread-self/schedstat").ok()?)
}

/// Reads the nanoseconds on a processor and those of waiting for one: `52000 1800 7`.
fn schedule(text: &str) -> Option<ThreadTime> {
    let mut numbers = text.split_ascii_whitespace().map(str::parse);
    let mut next = || numbers.next()?.ok().map(Duration::from_nanos);
    Some(ThreadTime {
        ran: next()?,
        waited: next()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_the_kernel_is_read() {
        let time = ThreadTime {
            ran: Duration::from_nanos(52_000),
            waited: Duration::from_nanos(1_800),
        };
        assert_eq!(schedule("52000 1800 7\n"), Some(time));
        assert_eq!(schedule("52000"), None);
        assert_eq!(schedule("a b c"), None);
    }
}
