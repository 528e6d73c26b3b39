//! Reading a fault buffer over the wire so that its parts are consistent.

/// What to do next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Next {
    /// Read PNU 944 and pass it to [`ConsistentRead::counter`].
    Counter,
    /// Read the buffer (947, and 945, 948, 949 as needed), then call [`ConsistentRead::buffer`]. What was read before
    /// is void.
    Buffer,
    /// The parts read last are consistent.
    Done,
    /// The buffer changed during every attempt.
    GiveUp,
}

/// Order of reads for a consistent fault buffer: counter, buffer, counter; equal counters mean that nothing changed.
/// Source: AKD manual 5.14; Siemens V90 p. 109 (the drive refreshes the buffer in the background).
///
/// It does no input or output: the caller reads what [`next`](Self::next) returns, in one request each or all in one.
///
/// ```
/// use profidrive_profile::fault::{ConsistentRead, Next};
/// let mut read = ConsistentRead::new(3);
/// let mut counters = [7, 8, 8].into_iter(); // a fault comes during the first attempt
/// let mut buffers = 0;
/// loop {
///     match read.next() {
///         Next::Counter => read.counter(counters.next().unwrap()),
///         Next::Buffer => { buffers += 1; read.buffer() }
///         end => break assert_eq!(end, Next::Done),
///     }
/// }
/// assert_eq!(buffers, 2);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConsistentRead {
    next: Next,
    before: Option<u16>,
    attempts: u8,
}

impl ConsistentRead {
    /// At most this many reads of the buffer, at least one.
    #[must_use]
    pub const fn new(attempts: u8) -> Self {
        Self {
            next: Next::Counter,
            before: None,
            attempts: if attempts == 0 { 1 } else { attempts },
        }
    }

    /// Returns the next step; the same one until its result is reported.
    #[must_use]
    pub const fn next(&self) -> Next {
        self.next
    }

    /// PNU 944 was read. Has no effect when something else was due.
    pub fn counter(&mut self, value: u16) {
        if self.next != Next::Counter {
            return;
        }
        self.next = if self.before == Some(value) {
            Next::Done
        } else if self.attempts == 0 {
            Next::GiveUp
        } else {
            Next::Buffer
        };
        self.before = Some(value);
    }

    /// Handles a buffer whose parts are not from one moment although the counter did not change: a counter of
    /// situations ([`Counting`](super::Counting)) does not count an acknowledge. Has no effect when another step is
    /// due.
    pub fn torn(&mut self) {
        if self.next == Next::Buffer {
            self.attempts -= 1;
            self.before = None;
            self.next = if self.attempts == 0 {
                Next::GiveUp
            } else {
                Next::Counter
            };
        }
    }

    /// The buffer was read. Has no effect when something else was due.
    pub fn buffer(&mut self) {
        if self.next == Next::Buffer {
            self.attempts -= 1;
            self.next = Next::Counter;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(attempts: u8, counters: &[u16]) -> (Next, usize, usize) {
        let mut read = ConsistentRead::new(attempts);
        let (mut used, mut buffers) = (0, 0);
        loop {
            match read.next() {
                Next::Counter => {
                    read.counter(counters[used]);
                    used += 1;
                }
                Next::Buffer => {
                    read.buffer();
                    buffers += 1;
                }
                end => return (end, used, buffers),
            }
        }
    }

    #[test]
    fn ends_as_soon_as_two_counters_agree() {
        assert_eq!(run(5, &[3, 3]), (Next::Done, 2, 1));
        assert_eq!(run(5, &[65535, 0, 0]), (Next::Done, 3, 2));
        assert_eq!(run(2, &[1, 2, 3]), (Next::GiveUp, 3, 2));
        assert_eq!(run(0, &[1, 2]), (Next::GiveUp, 2, 1));
    }

    #[test]
    fn a_torn_buffer_is_read_again() {
        let mut read = ConsistentRead::new(2);
        for torn in [true, false] {
            read.counter(4);
            assert_eq!(read.next(), Next::Buffer);
            if torn { read.torn() } else { read.buffer() }
        }
        read.counter(4);
        assert_eq!(read.next(), Next::Done);
        let mut read = ConsistentRead::new(1);
        read.counter(4);
        read.torn();
        assert_eq!(read.next(), Next::GiveUp);
    }

    #[test]
    fn reports_out_of_turn_change_nothing() {
        let mut read = ConsistentRead::new(1);
        read.buffer();
        assert_eq!(read.next(), Next::Counter);
        read.counter(1);
        read.counter(1);
        assert_eq!(read.next(), Next::Buffer);
        read.buffer();
        read.counter(1);
        read.counter(2);
        read.buffer();
        assert_eq!(read.next(), Next::Done);
    }
}
