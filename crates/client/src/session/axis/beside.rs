//! Operations on an axis that another handle moves: stop it, record it.

use std::sync::Arc;
use std::time::Duration;

use profile::state::bits::Bit;
use profile::telegram::{Field, signal};
use profinet::Instant;

use super::{Axis, Ending};
use crate::axis::{AxisSignal, Sample, SampleQueue, SignalScale, StopKind};
use crate::engine::Interest;
use crate::{Connection, Engine, Error, Link};

/// Stops an axis from any thread, whoever moves it and whatever waits for its drive. Who moves it is reported by
/// [`Trouble::Stopped`](crate::axis::Trouble::Stopped).
///
/// Clones stop the same axis. Nothing happens once it was given back.
#[derive(Debug, Clone)]
pub struct StopHandle {
    engine: Engine,
    link: Link,
    ending: Arc<Ending>,
    deceleration: Option<f64>,
}

impl StopHandle {
    /// Stops it along its ramp (OFF1); does not wait for the end. Returns false where it was not in operation, so that there was
    /// nothing to stop.
    pub fn stop(&self) -> bool {
        self.post(StopKind::Ramp)
    }

    /// Stops it by its quick stop (OFF3); does not wait for the end. Returns as [`stop`](Self::stop).
    pub fn quick_stop(&self) -> bool {
        self.post(StopKind::Quick)
    }

    /// Switches its power stage off (OFF2): it coasts. Does not wait for the end, which is standstill for half a second as the
    /// drive reports it: a frequency converter without a speed sensor reports standstill while its shaft still turns. Returns as
    /// [`stop`](Self::stop).
    pub fn coast(&self) -> bool {
        self.post(StopKind::Coast)
    }

    fn post(&self, way: StopKind) -> bool {
        let limit = self.ending.stop_limit(None, self.deceleration);
        let now = self.engine.now();
        let stops = {
            let mut client = self.engine.client();
            client.allow_stop(self.link, limit);
            client.stop_now(now, Some(self.link), way)
        };
        self.engine.stir();
        stops
    }

    /// Returns the present time of the network, as [`sent`](Self::sent) has it.
    #[must_use]
    pub fn now(&self) -> Instant {
        self.engine.now()
    }

    /// Waits until a frame with the last stop was handed to the network, and returns when that was, on the clock of the network;
    /// `None` where the axis was given back or its connection was lost before. At a serial line it is when the drive answered.
    ///
    /// Frames leave once in each update time. Where nothing carries the network any more this waits for ever: a caller who reports
    /// that a stop is on its way sets a limit.
    ///
    /// # Errors
    /// When the network is closed or its wire fails.
    pub async fn sent(&self) -> Result<Option<Instant>, Error> {
        loop {
            {
                let client = self.engine.client();
                if let Some(at) = client.stop_sent(self.link) {
                    return Ok(Some(at));
                }
                let ended = matches!(
                    client.connection(self.link),
                    Connection::Lost(_) | Connection::Silent | Connection::Released
                );
                if ended || client.axis(self.link).is_none() {
                    return Ok(None);
                }
            }
            let due = self.engine.now() + super::GLANCE;
            self.engine.next_turn(due, Interest::Axis(self.link)).await?;
        }
    }
}

/// Keeps the motion of an axis going from any thread, whatever its owner waits for: see [`Axis::beat`].
///
/// Clones are of the same axis. Nothing happens once it was given back.
#[derive(Debug, Clone)]
pub struct BeatHandle {
    engine: Engine,
    link: Link,
    lease: Duration,
}

impl BeatHandle {
    /// Keeps a motion going for this time from now on, as [`Axis::beat`] does, and renews the lease of the axis.
    pub fn beat(&self, time: Duration) {
        let now = self.engine.now();
        let mut client = self.engine.quietly();
        client.set_beat(self.link, Some(now + time));
        client.set_deadline(self.link, Some(now + self.lease));
    }

    /// Ends the motion that the beats keep going: it is halted along its ramp, and the axis stays in operation. The lease goes on
    /// as it was.
    pub fn end(&self) {
        let now = self.engine.now();
        self.engine.client().set_beat(self.link, Some(now));
        self.engine.stir();
    }
}

/// Every cyclic input of an axis, in order, from when this was made.
///
/// What is not taken in time is dropped, the oldest first, and counted.
///
/// ```
/// use profidrive_client::{Axis, Error};
/// async fn record(axis: &Axis) -> Result<(), Error> {
///     let mut samples = axis.samples(1000);
///     while let Some(sample) = samples.next().await? {
///         println!("{} {:?}", sample.at.as_millis(), sample.seen.nist_a);
///     }
///     Ok(())
/// }
/// ```
#[derive(Debug)]
pub struct Samples {
    engine: Engine,
    link: Link,
    queue: Arc<SampleQueue>,
}

impl Samples {
    /// Returns the next one, if it came already.
    pub fn take(&mut self) -> Option<Sample> {
        self.queue.take()
    }

    /// Waits for the next one; `None` once the axis was given back and nothing is left.
    ///
    /// # Errors
    /// When the network is closed or its wire fails.
    pub async fn next(&mut self) -> Result<Option<Sample>, Error> {
        loop {
            let ended = self.queue.is_ended();
            if let Some(sample) = self.queue.take() {
                return Ok(Some(sample));
            }
            if ended {
                return Ok(None);
            }
            let due = self.engine.now() + super::GLANCE;
            self.engine.next_turn(due, Interest::Axis(self.link)).await?;
        }
    }

    /// Returns the present time on the clock of the samples.
    #[must_use]
    pub fn now(&self) -> Instant {
        self.engine.now()
    }

    /// Returns the number of samples that were dropped because they were not fetched in time.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.queue.dropped()
    }
}

impl Axis {
    /// Returns a handle that stops this axis from any thread.
    #[must_use]
    pub fn stop_handle(&self) -> StopHandle {
        StopHandle {
            engine: self.session.engine().clone(),
            link: self.link,
            ending: Arc::clone(&self.ending),
            deceleration: self.deceleration,
        }
    }

    /// Returns a handle that keeps a motion of this axis going from any thread.
    #[must_use]
    pub fn beat_handle(&self) -> BeatHandle {
        BeatHandle {
            engine: self.session.engine().clone(),
            link: self.link,
            lease: self.settings.lease,
        }
    }

    /// Returns the signals of its telegram: setpoints, then actual values. Empty once it was given back.
    #[must_use]
    pub fn signals(&self) -> Vec<AxisSignal> {
        let client = self.session.client();
        let Some(wiring) = client.wiring(self.link) else {
            return Vec::new();
        };
        let scale = |number| match number {
            signal::NSOLL_A | signal::NIST_A => SignalScale::Speed(self.scale),
            signal::XIST_A | signal::MDI_TARPOS | signal::kollmorgen::XIST_ERROR => {
                SignalScale::Turns(self.drive.counts_per_turn())
            }
            _ => SignalScale::Raw,
        };
        let of = |field: &Field, is_setpoint| AxisSignal {
            field: *field,
            is_setpoint,
            scale: scale(field.signal.number),
        };
        let setpoints = wiring.setpoints().iter().map(|field| of(field, true));
        let actuals = wiring.actuals().iter().map(|field| of(field, false));
        setpoints.chain(actuals).collect()
    }

    /// Returns the bits of a control or status word of its telegram, bit 0 first; `None` for another signal.
    #[must_use]
    pub fn bits(&self, word: &AxisSignal) -> Option<&'static [Bit; 16]> {
        let client = self.session.client();
        let words = client.wiring(self.link)?.words();
        let mode = client.axis(self.link)?.mode;
        match word.field.signal.number {
            signal::STW1 => Some(words.control_bits(mode)),
            signal::ZSW1 => Some(words.status_bits(mode)),
            _ => None,
        }
    }

    /// Every cyclic input from now on; at most `capacity` of them are kept until they are taken.
    #[must_use]
    pub fn samples(&self, capacity: usize) -> Samples {
        self.tap(capacity, false)
    }

    /// The same with the inputs that the drive marked as not valid (IOPS BAD); see [`Sample::valid`].
    #[must_use]
    pub fn all_samples(&self, capacity: usize) -> Samples {
        self.tap(capacity, true)
    }

    fn tap(&self, capacity: usize, wants_all: bool) -> Samples {
        let queue = SampleQueue::new(capacity, wants_all);
        let engine = self.session.engine().clone();
        engine.client().tap(self.link, Arc::clone(&queue));
        let link = self.link;
        Samples { engine, link, queue }
    }
}
