//! Receives cyclic frames: which one counts, what it carried, when the peer is lost.

use alloc::vec;
use alloc::vec::Vec;
use core::time::Duration;

use super::layout::Layout;
use super::timing::Timing;
use crate::wire::ethernet::{Frame, FrameId};
use crate::wire::rt::{Cyclic, DataStatus, Iops};
use crate::{Instant, MacAddress};

/// Largest forward step of the cycle counter that is taken as progress.
const MAX_STEP: u16 = 0xF000;

/// What a [`Consumer`] does at present.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ConsumerState {
    /// Waiting for the first frame, nothing is supervised.
    Waiting,
    /// Frames come; the data hold time runs.
    Running,
    /// The data hold time is over. Frames are no longer accepted.
    Expired,
}

/// A frame that was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Accepted {
    /// It was the first one.
    pub first: bool,
    /// Status before it; equal to the present status when nothing changed.
    pub previous_status: DataStatus,
    /// Status it carried.
    pub status: DataStatus,
}

/// Why a frame was ignored. Ignored frames change nothing and do not reload the watchdog.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Rejected {
    /// Another FrameID.
    FrameId,
    /// From another station.
    Source,
    /// Shorter than agreed.
    Length,
    /// TransferStatus is not 0.
    TransferStatus,
    /// The DataStatus marks the data as not valid.
    DataInvalid,
    /// The cycle counter did not advance: a duplicate, or overtaken.
    OutOfOrder,
    /// The connection had already expired.
    Expired,
}

/// Statistics of a [`Consumer`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CyclicStatistics {
    /// Frames accepted.
    pub received: u64,
    /// Frames missing between received ones, by the cycle counter.
    pub missed: u64,
    /// Frames ignored because their cycle counter did not advance.
    pub out_of_order: u64,
    /// Frames ignored for any other reason.
    pub rejected: u64,
    /// Longest time between two received frames, or from the last one until the peer was given up.
    pub longest_gap: Duration,
}

/// Receives one direction's cyclic data and supervises the peer.
///
/// Source: IEC 61158-6-10, consumer protocol machine (CPM). The first frame starts the supervision; from then on at
/// most DataHoldFactor x interval may pass between two frames. A frame that is handed in late but before
/// [`expire`](Self::expire) was called still counts, so that a process that was held up itself does not lose its
/// peers. No call allocates.
///
/// ```
/// use core::time::Duration;
/// use profidrive_profinet::cyclic::{Consumer, Provider, ProviderConfig, SubmoduleSize, Timing, pack};
/// use profidrive_profinet::wire::ethernet::{Frame, FrameId, Tag};
/// use profidrive_profinet::wire::rt::Iops;
/// use profidrive_profinet::{Instant, MacAddress};
///
/// let (_, output) = pack(&[SubmoduleSize::new(0, 1, 1, 4, 4)]).unwrap();
/// let (sender, id) = (MacAddress([2, 0, 0, 0, 0, 2]), FrameId(0xC000));
/// let timing = Timing::for_interval(Duration::from_millis(16)).unwrap();
/// let config = ProviderConfig {
///     destination: MacAddress([2, 0, 0, 0, 0, 1]),
///     source: sender,
///     tag: Some(Tag::PRIORITY_6),
///     frame_id: id,
///     timing,
///     origin: Instant::ZERO,
/// };
/// let mut provider = Provider::new(config, output.clone(), Instant::ZERO);
/// provider.set_data(1, 1, &[0x04, 0x7F, 0, 0], Iops::GOOD);
/// let mut buffer = [0; 1518];
/// let now = provider.next_send();
/// let length = provider.emit(now, &mut buffer).unwrap();
///
/// let mut consumer = Consumer::new(sender, id, timing, 3, output);
/// consumer.handle(now, &Frame::parse(&buffer[..length]).unwrap()).unwrap();
/// assert_eq!(consumer.data(1, 1), Some((&[0x04, 0x7F, 0, 0][..], Iops::GOOD)));
/// assert_eq!(consumer.deadline(), Some(now + Duration::from_millis(48)));
/// assert!(consumer.expire(now + Duration::from_millis(48))); // the peer is gone
/// ```
#[derive(Debug, Clone)]
pub struct Consumer {
    layout: Layout,
    image: Vec<u8>,
    source: MacAddress,
    frame_id: FrameId,
    step: u32,
    hold: Duration,
    state: ConsumerState,
    counter: u16,
    status: DataStatus,
    last: Instant,
    statistics: CyclicStatistics,
}

impl Consumer {
    /// Waits for frames `frame_id` from `source`.
    #[must_use]
    pub fn new(
        source: MacAddress,
        frame_id: FrameId,
        timing: Timing,
        data_hold_factor: u16,
        layout: Layout,
    ) -> Self {
        Self {
            image: vec![0; usize::from(layout.data_length())],
            layout,
            source,
            frame_id,
            step: timing.ticks(),
            hold: timing.hold_time(data_hold_factor),
            state: ConsumerState::Waiting,
            counter: 0,
            status: DataStatus(0),
            last: Instant::ZERO,
            statistics: CyclicStatistics::default(),
        }
    }

    /// Looks at a received frame; takes its data if it counts.
    ///
    /// # Errors
    /// Handles a frame; returns why it was ignored.
    pub fn handle(&mut self, now: Instant, frame: &Frame<'_>) -> Result<Accepted, Rejected> {
        let result = self.judge(now, frame);
        match result {
            Ok(_) => self.statistics.received += 1,
            Err(Rejected::OutOfOrder) => self.statistics.out_of_order += 1,
            Err(_) => self.statistics.rejected += 1,
        }
        result
    }

    fn judge(&mut self, now: Instant, frame: &Frame<'_>) -> Result<Accepted, Rejected> {
        if frame.frame_id != self.frame_id {
            return Err(Rejected::FrameId);
        }
        if frame.source != self.source {
            return Err(Rejected::Source);
        }
        let cyclic = Cyclic::parse(frame.payload, self.image.len()).ok_or(Rejected::Length)?;
        let trailer = cyclic.trailer;
        if trailer.transfer_status != 0 {
            return Err(Rejected::TransferStatus);
        }
        if !trailer.data_status.is_valid() {
            return Err(Rejected::DataInvalid);
        }
        let first = match self.state {
            ConsumerState::Waiting => true,
            ConsumerState::Running => false,
            ConsumerState::Expired => return Err(Rejected::Expired),
        };
        let previous_status = if first { trailer.data_status } else { self.status };
        if !first {
            let step = trailer.cycle_counter.wrapping_sub(self.counter);
            if step == 0 || step > MAX_STEP {
                return Err(Rejected::OutOfOrder);
            }
            let intervals = u64::from(u32::from(step) / self.step);
            self.statistics.missed += intervals.saturating_sub(1);
            let gap = now.saturating_since(self.last);
            self.statistics.longest_gap = self.statistics.longest_gap.max(gap);
        }
        self.image.copy_from_slice(cyclic.data);
        self.counter = trailer.cycle_counter;
        self.status = trailer.data_status;
        self.last = now;
        self.state = ConsumerState::Running;
        Ok(Accepted {
            first,
            previous_status,
            status: trailer.data_status,
        })
    }

    /// Returns the time when the connection is lost if nothing more comes; `None` while nothing is supervised.
    #[must_use]
    pub fn deadline(&self) -> Option<Instant> {
        (self.state == ConsumerState::Running).then(|| self.last + self.hold)
    }

    /// Ends the connection if its time is over. True exactly once, at or after [`deadline`](Self::deadline).
    pub fn expire(&mut self, now: Instant) -> bool {
        let over = self.deadline().is_some_and(|deadline| now >= deadline);
        if over {
            self.state = ConsumerState::Expired;
            // nothing ended this gap: it is at least as long as the hold time
            let gap = now.saturating_since(self.last);
            self.statistics.longest_gap = self.statistics.longest_gap.max(gap);
        }
        over
    }

    /// Ends the supervision: the connection is closed for another reason.
    pub const fn stop(&mut self) {
        self.state = ConsumerState::Expired;
    }

    /// Waits for a first frame again: gaps during an advanced start-up are not loss.
    pub const fn restart(&mut self) {
        self.state = ConsumerState::Waiting;
    }

    /// Present state.
    #[must_use]
    pub const fn state(&self) -> ConsumerState {
        self.state
    }

    /// Latest data of a submodule with its IOPS; `None` if it has no data in this direction. Before the first frame
    /// all is 0, which is an IOPS of bad.
    #[must_use]
    pub fn data(&self, slot: u16, subslot: u16) -> Option<(&[u8], Iops)> {
        let object = self.layout.data(slot, subslot)?;
        let start = usize::from(object.offset);
        let (iops, data) = self
            .image
            .get(start..=start + usize::from(object.length))?
            .split_last()?;
        Some((data, Iops(*iops)))
    }

    /// Latest IOCS of a submodule; `None` if it has none in this direction.
    #[must_use]
    pub fn iocs(&self, slot: u16, subslot: u16) -> Option<Iops> {
        let object = self.layout.status(slot, subslot)?;
        self.image
            .get(usize::from(object.offset))
            .map(|octet| Iops(*octet))
    }

    /// Status of the latest frame; 0 before the first.
    #[must_use]
    pub const fn status(&self) -> DataStatus {
        self.status
    }

    /// Cycle counter of the latest frame.
    #[must_use]
    pub const fn cycle_counter(&self) -> u16 {
        self.counter
    }

    /// FrameID of the received frames.
    #[must_use]
    pub const fn frame_id(&self) -> FrameId {
        self.frame_id
    }

    /// Address of the peer.
    #[must_use]
    pub const fn source(&self) -> MacAddress {
        self.source
    }

    /// Longest time between two frames.
    #[must_use]
    pub const fn hold_time(&self) -> Duration {
        self.hold
    }

    /// Table of the data received.
    #[must_use]
    pub const fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns the statistics so far.
    #[must_use]
    pub const fn statistics(&self) -> CyclicStatistics {
        self.statistics
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SubmoduleSize, pack};
    use super::*;
    use crate::wire::rt::Trailer;

    const PEER: MacAddress = MacAddress([2, 0, 0, 0, 0, 1]);
    const OTHER: MacAddress = MacAddress([2, 0, 0, 0, 0, 9]);

    fn consumer() -> Consumer {
        let (input, _) = pack(&[
            SubmoduleSize::new(0, 0, 1, 0, 0),
            SubmoduleSize::new(0, 1, 1, 4, 4),
        ])
        .unwrap();
        let timing = Timing {
            send_clock_factor: 32,
            reduction_ratio: 16,
            phase: 1,
        };
        Consumer::new(PEER, FrameId(0x8000), timing, 3, input)
    }

    fn payload(counter: u16, status: u8, transfer: u8) -> Vec<u8> {
        let mut payload = vec![0; 40];
        payload[..8].copy_from_slice(&[0x80, 1, 2, 3, 4, 0x80, 0x80, 0]);
        let trailer = Trailer {
            cycle_counter: counter,
            data_status: DataStatus(status),
            transfer_status: transfer,
        };
        payload.extend_from_slice(&trailer.to_bytes());
        payload
    }

    fn frame(payload: &[u8]) -> Frame<'_> {
        Frame {
            destination: OTHER,
            source: PEER,
            tag: None,
            frame_id: FrameId(0x8000),
            payload,
        }
    }

    fn feed(c: &mut Consumer, ms: u64, counter: u16, status: u8) -> Result<Accepted, Rejected> {
        c.handle(Instant::from_millis(ms), &frame(&payload(counter, status, 0)))
    }

    #[test]
    fn the_first_frame_starts_the_watchdog_whatever_its_counter() {
        let mut c = consumer();
        assert_eq!(c.deadline(), None);
        assert!(!c.expire(Instant::from_millis(1_000_000)));
        assert_eq!(c.data(1, 1), Some((&[0, 0, 0, 0][..], Iops(0))));
        let accepted = feed(&mut c, 100, 0xABCD, 0x35).unwrap();
        assert!(accepted.first);
        assert_eq!(c.data(1, 1), Some((&[1, 2, 3, 4][..], Iops::GOOD)));
        assert_eq!(c.iocs(1, 1), Some(Iops::GOOD));
        assert_eq!(c.iocs(0, 1), None);
        assert_eq!(c.deadline(), Some(Instant::from_millis(148)));
    }

    #[test]
    fn the_limit_of_the_watchdog_has_two_sides() {
        let mut c = consumer();
        feed(&mut c, 0, 0, 0x35).unwrap();
        assert!(!c.expire(Instant::from_nanos(47_999_999)));
        assert_eq!(c.state(), ConsumerState::Running);
        feed(&mut c, 47, 512, 0x35).unwrap();
        assert!(!c.expire(Instant::from_millis(94)));
        assert!(c.expire(Instant::from_millis(95)));
        assert!(!c.expire(Instant::from_millis(96)), "only once");
        assert_eq!(feed(&mut c, 97, 1024, 0x35), Err(Rejected::Expired));
        assert_eq!(c.deadline(), None);
    }

    #[test]
    fn cycle_counter_rules() {
        for (step, good) in [
            (0u16, false),
            (1, true),
            (512, true),
            (0xF000, true),
            (0xF001, false),
            (0xFFFF, false),
        ] {
            let mut c = consumer();
            feed(&mut c, 0, 0xFF00, 0x35).unwrap();
            let result = feed(&mut c, 16, 0xFF00u16.wrapping_add(step), 0x35);
            assert_eq!(result.is_ok(), good, "step {step:#x}");
            let deadline = if good { 64 } else { 48 };
            assert_eq!(c.deadline(), Some(Instant::from_millis(deadline)));
        }
    }

    #[test]
    fn ignored_frames_change_nothing() {
        let mut c = consumer();
        feed(&mut c, 0, 0, 0x35).unwrap();
        let good = payload(512, 0x35, 0);
        let now = Instant::from_millis(16);
        assert_eq!(
            c.handle(
                now,
                &Frame {
                    source: OTHER,
                    ..frame(&good)
                }
            ),
            Err(Rejected::Source)
        );
        assert_eq!(
            c.handle(
                now,
                &Frame {
                    frame_id: FrameId(0x8001),
                    ..frame(&good)
                }
            ),
            Err(Rejected::FrameId)
        );
        for cut in 0..44 {
            assert_eq!(c.handle(now, &frame(&good[..cut])), Err(Rejected::Length));
        }
        assert_eq!(
            c.handle(now, &frame(&payload(512, 0x35, 1))),
            Err(Rejected::TransferStatus)
        );
        assert_eq!(feed(&mut c, 16, 512, 0x31), Err(Rejected::DataInvalid));
        assert_eq!(c.deadline(), Some(Instant::from_millis(48)));
        assert_eq!(c.statistics().rejected, 48);
        assert_eq!(c.statistics().received, 1);
        let mut padded = good.clone();
        padded.extend_from_slice(&[0; 30]);
        assert!(c.handle(now, &frame(&padded)).is_ok());
    }

    /// The time without data that ended the connection is a gap too.
    #[test]
    fn the_silence_that_ends_it_is_its_longest_gap() {
        let mut c = consumer();
        feed(&mut c, 0, 0, 0x35).unwrap();
        feed(&mut c, 16, 512, 0x35).unwrap();
        let end = c.deadline().unwrap();
        assert!(c.expire(end));
        assert_eq!(c.statistics().longest_gap, end - Instant::from_millis(16));
        assert!(c.statistics().longest_gap > Duration::from_millis(16));
    }

    #[test]
    fn statistics_and_status_changes() {
        let mut c = consumer();
        feed(&mut c, 0, 0, 0x35).unwrap();
        feed(&mut c, 16, 512, 0x35).unwrap();
        let stop = feed(&mut c, 46, 2048, 0x25).unwrap();
        assert!(stop.previous_status.is_run() && !stop.status.is_run() && !stop.first);
        assert_eq!(feed(&mut c, 47, 1024, 0x35), Err(Rejected::OutOfOrder));
        assert_eq!(feed(&mut c, 47, 2048, 0x35), Err(Rejected::OutOfOrder));
        let s = c.statistics();
        assert_eq!((s.received, s.missed, s.out_of_order), (3, 2, 2));
        assert_eq!(s.longest_gap, Duration::from_millis(30));
        assert_eq!(c.status(), DataStatus::STOP);
    }
}
