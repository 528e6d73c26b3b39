//! Every cyclic input of an axis, as it comes.

use std::collections::VecDeque;
use std::fmt;
use std::ops::Deref;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use profile::telegram::Field;
use profinet::Instant;

use super::wiring::{MOST_OCTETS, wrapped};
use super::{Command, Seen, SpeedScale};

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
    /// Decoded inputs of the drive; the last valid ones where these are not.
    pub seen: Seen,
    /// Whether the drive marked its data as valid (IOPS GOOD). Data that it marked as not valid are left out of
    /// [`inputs`](Self::inputs).
    pub valid: bool,
    /// The command in force when it came.
    pub command: Command,
    /// The data of the drive as they came.
    pub inputs: Octets,
    /// The data that the drive was sent.
    pub outputs: Octets,
}

impl Sample {
    /// Returns the cycles without a sample between an earlier one and this: lost on the network, or dropped because the queue was
    /// full.
    #[must_use]
    pub const fn missing_since(&self, before: &Self) -> u64 {
        let lost = self.missed.saturating_sub(before.missed);
        let dropped = self.number.saturating_sub(before.number).saturating_sub(1);
        lost.saturating_add(dropped)
    }
}

/// Cyclic data of one direction, in place: a sample is copied without allocation.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Octets {
    octets: [u8; MOST_OCTETS],
    length: u8,
}

impl Octets {
    /// No data.
    pub const NONE: Self = Self {
        octets: [0; MOST_OCTETS],
        length: 0,
    };

    /// Copies the data; what is longer than a telegram can be is cut off.
    #[must_use]
    pub fn new(data: &[u8]) -> Self {
        let mut copy = Self::NONE;
        for (place, octet) in copy.octets.iter_mut().zip(data) {
            *place = *octet;
            copy.length += 1;
        }
        copy
    }
}

impl Deref for Octets {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        self.octets.get(..usize::from(self.length)).unwrap_or_default()
    }
}

impl fmt::Debug for Octets {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

/// A signal in the cyclic data of an axis, and what its numbers mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisSignal {
    /// Where it is.
    pub field: Field,
    /// It is sent to the drive.
    pub is_setpoint: bool,
    /// What its numbers mean.
    pub scale: SignalScale,
}

/// What the numbers of a signal mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SignalScale {
    /// The number as it is.
    Raw,
    /// A speed.
    Speed(SpeedScale),
    /// A position or distance: increments of a turn.
    Turns(f64),
}

impl AxisSignal {
    /// Returns the unit of its values, empty where the number stands as it is.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        match &self.scale {
            SignalScale::Raw => "",
            SignalScale::Speed(scale) => scale.unit().symbol(),
            SignalScale::Turns(_) => "rev",
        }
    }

    /// Returns the number of this signal in a sample; `None` where the data end before it.
    #[must_use]
    pub fn raw(&self, sample: &Sample) -> Option<i64> {
        let data = if self.is_setpoint {
            &sample.outputs
        } else {
            &sample.inputs
        };
        self.field.get(data)
    }

    /// Returns the value of a number in the unit of the signal; `None` for a signal without a unit.
    #[must_use]
    pub fn engineering(&self, raw: i64) -> Option<f64> {
        match self.scale {
            SignalScale::Raw => None,
            SignalScale::Speed(scale) => Some(scale.speed(i16::try_from(raw).ok()?)),
            SignalScale::Turns(counts) => Some(f64::from(wrapped(raw)) / counts),
        }
    }
}

/// Samples on their way from the engine to whoever records them: so many and no more.
#[derive(Debug)]
pub(crate) struct SampleQueue {
    open: Mutex<Open>,
    capacity: usize,
    /// Inputs that the drive marked as not valid are wanted too.
    wants_all: bool,
}

#[derive(Debug)]
struct Open {
    samples: VecDeque<Sample>,
    /// Samples that were not fetched in time.
    dropped: u64,
    ended: bool,
}

impl SampleQueue {
    pub(crate) fn new(capacity: usize, wants_all: bool) -> Arc<Self> {
        let capacity = capacity.max(1);
        Arc::new(Self {
            open: Mutex::new(Open {
                // all the memory there will ever be: nothing is allocated in the cycle
                samples: VecDeque::with_capacity(capacity),
                dropped: 0,
                ended: false,
            }),
            capacity,
            wants_all,
        })
    }

    fn open(&self) -> MutexGuard<'_, Open> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes a sample in, if it is one that is wanted; the oldest one goes where there is no room.
    pub(crate) fn push(&self, sample: Sample) {
        if !sample.valid && !self.wants_all {
            return;
        }
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
    fn data_longer_than_a_telegram_are_cut() {
        assert_eq!(&*Octets::new(&[1, 2]), [1, 2]);
        assert_eq!(Octets::new(&[7; 80]).len(), MOST_OCTETS);
    }

    #[test]
    fn a_sample_costs_no_memory_and_the_oldest_makes_room() {
        let queue = SampleQueue::new(100, false);
        let allocated = allocations::made_by(|| {
            for number in 0..1000 {
                queue.push(Sample {
                    at: Instant::from_millis(number),
                    number,
                    missed: 0,
                    seen: Seen::default(),
                    valid: true,
                    command: Command::default(),
                    inputs: Octets::new(&[0; 80]),
                    outputs: Octets::NONE,
                });
            }
        });
        assert_eq!(allocated, 0);
        assert_eq!(queue.dropped(), 900);
        assert_eq!(queue.take().map(|sample| sample.number), Some(900));
    }
}
