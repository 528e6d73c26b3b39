//! Every cyclic input of an axis, as it comes.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use profinet::Instant;

use super::{Command, Seen};

/// One cyclic input of an axis, with what was sent when it came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// When it came.
    pub at: Instant,
    /// Its number since the connection began; frames that were lost between two are counted in
    /// [`missed`](Self::missed).
    pub number: u64,
    /// Frames that the counter of the connection says were lost until now; 0 at a serial line, which has no counter.
    pub missed: u64,
    /// Decoded inputs of the drive.
    pub seen: Seen,
    /// The command in force when it came.
    pub command: Command,
}

/// Samples on their way from the engine to whoever records them: so many and no more.
#[derive(Debug)]
pub(crate) struct SampleQueue {
    open: Mutex<Open>,
    capacity: usize,
}

#[derive(Debug)]
struct Open {
    samples: VecDeque<Sample>,
    /// Samples that were not fetched in time.
    dropped: u64,
    ended: bool,
}

impl SampleQueue {
    pub(crate) fn new(capacity: usize) -> Arc<Self> {
        let capacity = capacity.max(1);
        Arc::new(Self {
            open: Mutex::new(Open {
                // all the memory there will ever be: nothing is allocated in the cycle
                samples: VecDeque::with_capacity(capacity),
                dropped: 0,
                ended: false,
            }),
            capacity,
        })
    }

    fn open(&self) -> MutexGuard<'_, Open> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes a sample in; the oldest one goes where there is no room.
    pub(crate) fn push(&self, sample: Sample) {
        let mut open = self.open();
        if open.samples.len() == self.capacity {
            open.samples.pop_front();
            open.dropped += 1;
        }
        open.samples.push_back(sample);
    }

    pub(crate) fn take(&self) -> Option<Sample> {
        self.open().samples.pop_front()
    }

    pub(crate) fn dropped(&self) -> u64 {
        self.open().dropped
    }

    /// No more samples come.
    pub(crate) fn end(&self) {
        self.open().ended = true;
    }

    pub(crate) fn is_ended(&self) -> bool {
        self.open().ended
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_costs_no_memory_and_the_oldest_makes_room() {
        let queue = SampleQueue::new(100);
        let allocated = allocations::made_by(|| {
            for number in 0..1000 {
                queue.push(Sample {
                    at: Instant::from_millis(number),
                    number,
                    missed: 0,
                    seen: Seen::default(),
                    command: Command::default(),
                });
            }
        });
        assert_eq!(allocated, 0);
        assert_eq!(queue.dropped(), 900);
        assert_eq!(queue.take().map(|sample| sample.number), Some(900));
    }
}
