//! Sends cyclic frames: one template, changed in place, and an absolute grid of send times.

use alloc::vec;
use alloc::vec::Vec;
use core::time::Duration;

use super::layout::Layout;
use super::timing::Timing;
use crate::wire::ethernet::{self, FrameId, Tag};
use crate::wire::rt::{DataStatus, Iops, TRAILER, Trailer};
use crate::{Instant, MacAddress};

const TICK_NANOS: u64 = 31_250;

/// Parameters of a [`Provider`] in addition to its layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProviderConfig {
    /// Receiver of the frames.
    pub destination: MacAddress,
    /// Own address.
    pub source: MacAddress,
    /// 802.1Q tag; [`Tag::PRIORITY_6`] always in practice.
    pub tag: Option<Tag>,
    /// FrameID agreed at connect time.
    pub frame_id: FrameId,
    /// Interval and phase.
    pub timing: Timing,
    /// Start of the grid of send clocks. Interval k begins at `origin + k x interval`, the frame is due
    /// (phase - 1) send clocks later.
    pub origin: Instant,
}

/// Sends one direction's cyclic data.
///
/// Source: IEC 61158-6-10, provider protocol machine (PPM). Send times lie on a grid, so they do not drift; an
/// interval that was missed is left out and its cycle counter with it. No call allocates.
///
/// ```
/// use core::time::Duration;
/// use profidrive_profinet::cyclic::{Provider, ProviderConfig, SubmoduleSize, Timing, pack};
/// use profidrive_profinet::wire::ethernet::{FrameId, Tag};
/// use profidrive_profinet::wire::rt::Iops;
/// use profidrive_profinet::{Instant, MacAddress};
///
/// let (_, output) = pack(&[SubmoduleSize::new(0, 1, 1, 4, 4)]).unwrap();
/// let config = ProviderConfig {
///     destination: MacAddress([2, 0, 0, 0, 0, 1]),
///     source: MacAddress([2, 0, 0, 0, 0, 2]),
///     tag: Some(Tag::PRIORITY_6),
///     frame_id: FrameId(0xC000),
///     timing: Timing::for_interval(Duration::from_millis(16)).unwrap(),
///     origin: Instant::ZERO,
/// };
/// let mut provider = Provider::new(config, output, Instant::from_millis(5));
/// provider.set_data(1, 1, &[0x04, 0x7F, 0, 0], Iops::GOOD);
/// assert_eq!(provider.next_send(), Instant::from_millis(16));
/// let mut buffer = [0; 1518];
/// assert_eq!(provider.emit(Instant::from_millis(16), &mut buffer), Some(64));
/// assert_eq!(provider.next_send(), Instant::from_millis(32));
/// ```
#[derive(Debug, Clone)]
pub struct Provider {
    layout: Layout,
    frame: Vec<u8>,
    header: usize,
    timing: Timing,
    origin: Instant,
    next: Instant,
    /// How far the send times have moved against the grid, in nanoseconds, earlier is positive.
    moved: i64,
    /// The next frame follows one of the peer.
    following: bool,
    /// The next frame is put off already.
    waits: bool,
    status: DataStatus,
    sent: u64,
    skipped: u64,
}

impl Provider {
    /// Ready to send from the first point of the grid at or after `now`. Data is zero, all IOPS and IOCS bad
    /// (submodule), status 0x35.
    #[must_use]
    pub fn new(config: ProviderConfig, layout: Layout, now: Instant) -> Self {
        let header = if config.tag.is_some() {
            ethernet::TAGGED_HEADER
        } else {
            ethernet::UNTAGGED_HEADER
        };
        let mut frame = vec![0; header + usize::from(layout.data_length()) + TRAILER];
        // the template is as long as its header at least
        let _ = ethernet::emit_header(
            &mut frame,
            config.destination,
            config.source,
            config.tag,
            config.frame_id,
        );
        let mut provider = Self {
            layout,
            frame,
            header,
            timing: config.timing,
            origin: config.origin,
            next: now,
            moved: 0,
            following: false,
            waits: false,
            status: DataStatus::GOOD,
            sent: 0,
            skipped: 0,
        };
        provider.next = provider.at_or_after(now);
        provider
    }

    /// Returns the time between the start of an interval and its frame.
    fn phase_nanos(&self) -> u64 {
        u64::from(self.timing.phase.saturating_sub(1)) * u64::from(self.timing.send_clock_factor) * TICK_NANOS
    }

    fn period_nanos(&self) -> u64 {
        u64::from(self.timing.ticks()) * TICK_NANOS
    }

    /// First point of the grid that is not before `time`.
    fn at_or_after(&self, time: Instant) -> Instant {
        let first = self.origin + Duration::from_nanos(self.phase_nanos());
        let since = time.saturating_since(first).as_nanos();
        let since = u64::try_from(since).unwrap_or(u64::MAX);
        let intervals = since.div_ceil(self.period_nanos());
        first + Duration::from_nanos(intervals.saturating_mul(self.period_nanos()))
    }

    /// Returns the time when the next frame is due.
    #[must_use]
    pub const fn next_send(&self) -> Instant {
        self.next
    }

    /// Returns true when a frame is due.
    #[must_use]
    pub fn is_due(&self, now: Instant) -> bool {
        now >= self.next
    }

    /// Returns the time between two frames.
    #[must_use]
    pub const fn interval(&self) -> Duration {
        self.timing.interval()
    }

    /// Reports a received frame of the peer, so that the own frames come into step with it: the station then wakes up
    /// once per cycle instead of twice.
    ///
    /// An own frame that is due within a quarter of the interval follows at once. One that is due later is put off
    /// by a sixteenth of the interval (1 ms at most), once in an interval, until it comes behind the peer's. Later
    /// frames are shifted accordingly, and cycle counters continue. A late or silent peer has no effect: the own frame
    /// is sent at most that sixteenth after its time.
    ///
    /// Only for a peer that sends with the same interval.
    pub fn follow(&mut self, now: Instant) {
        let early = self.next.saturating_since(now);
        if early <= self.interval() / 4 {
            self.moved = self.moved.saturating_add(signed(early));
            self.next = self.next.min(now);
            self.following = true;
        } else if !self.waits {
            self.put_off();
        }
    }

    /// Gives the peer's frame time to come before the own one.
    fn put_off(&mut self) {
        let time = (self.interval() / 16).min(Duration::from_millis(1));
        self.next += time;
        self.moved = self.moved.saturating_sub(signed(time));
        self.waits = true;
    }

    /// Writes the frame that is due and returns its length; `None` if none is due or `buffer` is too small (that
    /// frame is then lost). Of several intervals that have passed only the latest one's frame is sent.
    pub fn emit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        if now < self.next {
            return None;
        }
        let period = self.period_nanos();
        let late = u64::try_from(now.saturating_since(self.next).as_nanos()).unwrap_or(u64::MAX);
        let missed = late / period;
        self.skipped += missed;
        let due = self.next + Duration::from_nanos(missed.saturating_mul(period));
        let cycle_counter = self.counter(due);
        self.next = due + Duration::from_nanos(period);
        self.waits = false;
        if core::mem::take(&mut self.following) {
            self.put_off();
        }
        let trailer = Trailer {
            cycle_counter,
            data_status: self.status,
            transfer_status: 0,
        };
        let end = self.frame.len() - TRAILER;
        self.frame.get_mut(end..)?.copy_from_slice(&trailer.to_bytes());
        buffer.get_mut(..self.frame.len())?.copy_from_slice(&self.frame);
        self.sent += 1;
        Some(ethernet::pad(buffer, self.frame.len()))
    }

    /// Cycle counter of the frame due at `due`: the start of its interval in ticks modulo 65536, a multiple of the
    /// interval.
    fn counter(&self, due: Instant) -> u16 {
        let start = due.saturating_since(self.origin + Duration::from_nanos(self.phase_nanos()));
        let start = u64::try_from(start.as_nanos())
            .unwrap_or(0)
            .saturating_add_signed(self.moved);
        let ticks = start / TICK_NANOS % 0x1_0000;
        let step = u64::from(self.timing.ticks());
        u16::try_from(ticks - ticks % step).unwrap_or(0)
    }

    /// Range of the process data within the template.
    fn at(&mut self, offset: u16, length: u16) -> Option<&mut [u8]> {
        let start = self.header + usize::from(offset);
        self.frame.get_mut(start..start + usize::from(length))
    }

    /// Sets a submodule's data and IOPS for the next frames. False if it has no data here or `data` has another
    /// length than agreed; nothing is changed then.
    pub fn set_data(&mut self, slot: u16, subslot: u16, data: &[u8], iops: Iops) -> bool {
        let Some(object) = self.layout.data(slot, subslot).copied() else {
            return false;
        };
        if data.len() != usize::from(object.length) {
            return false;
        }
        if let Some(place) = self.at(object.offset, object.length) {
            place.copy_from_slice(data);
        }
        self.set_octet(object.iops_offset(), iops)
    }

    /// Sets a submodule's IOPS only; false if it has no data here.
    pub fn set_iops(&mut self, slot: u16, subslot: u16, iops: Iops) -> bool {
        let offset = self
            .layout
            .data(slot, subslot)
            .map(super::DataObject::iops_offset);
        offset.is_some_and(|offset| self.set_octet(offset, iops))
    }

    /// Sets a submodule's IOCS; false if it has none here.
    pub fn set_iocs(&mut self, slot: u16, subslot: u16, iocs: Iops) -> bool {
        let offset = self.layout.status(slot, subslot).map(|s| s.offset);
        offset.is_some_and(|offset| self.set_octet(offset, iocs))
    }

    fn set_octet(&mut self, offset: u16, value: Iops) -> bool {
        match self.at(offset, 1) {
            Some([octet]) => {
                *octet = value.0;
                true
            }
            _ => false,
        }
    }

    /// Sets the IOPS of every submodule.
    pub fn set_all_iops(&mut self, iops: Iops) {
        for index in 0..self.layout.data_objects().len() {
            if let Some(offset) = self
                .layout
                .data_objects()
                .get(index)
                .map(super::DataObject::iops_offset)
            {
                self.set_octet(offset, iops);
            }
        }
    }

    /// Sets the IOCS of every submodule.
    pub fn set_all_iocs(&mut self, iocs: Iops) {
        for index in 0..self.layout.status_objects().len() {
            if let Some(offset) = self.layout.status_objects().get(index).map(|s| s.offset) {
                self.set_octet(offset, iocs);
            }
        }
    }

    /// Returns data and IOPS of a submodule in the next frame.
    #[must_use]
    pub fn data(&self, slot: u16, subslot: u16) -> Option<(&[u8], Iops)> {
        let object = self.layout.data(slot, subslot)?;
        let start = self.header + usize::from(object.offset);
        let (iops, data) = self
            .frame
            .get(start..=start + usize::from(object.length))?
            .split_last()?;
        Some((data, Iops(*iops)))
    }

    /// Status the next frame carries.
    #[must_use]
    pub const fn status(&self) -> DataStatus {
        self.status
    }

    /// Sets the status of the next frames.
    pub const fn set_status(&mut self, status: DataStatus) {
        self.status = status;
    }

    /// Table of the data sent.
    #[must_use]
    pub const fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Frames sent.
    #[must_use]
    pub const fn sent(&self) -> u64 {
        self.sent
    }

    /// Intervals for which [`emit`](Self::emit) came too late.
    #[must_use]
    pub const fn skipped(&self) -> u64 {
        self.skipped
    }
}

fn signed(time: Duration) -> i64 {
    i64::try_from(time.as_nanos()).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::super::{SubmoduleSize, pack};
    use super::*;
    use crate::wire::ethernet::Frame;
    use crate::wire::rt::Cyclic;

    fn provider(timing: Timing, origin: Instant, now: Instant) -> Provider {
        let (input, _) = pack(&[
            SubmoduleSize::new(0, 0, 1, 0, 0),
            SubmoduleSize::new(0, 1, 1, 4, 4),
        ])
        .unwrap();
        let config = ProviderConfig {
            destination: MacAddress([2, 0, 0, 0, 0, 1]),
            source: MacAddress([2, 0, 0, 0, 0, 2]),
            tag: Some(Tag::PRIORITY_6),
            frame_id: FrameId(0x8000),
            timing,
            origin,
        };
        Provider::new(config, input, now)
    }

    fn timing(factor: u16, ratio: u16, phase: u16) -> Timing {
        Timing {
            send_clock_factor: factor,
            reduction_ratio: ratio,
            phase,
        }
    }

    fn counter(provider: &mut Provider, now: Instant) -> u16 {
        let mut buffer = [0xA5; 1518];
        let n = provider.emit(now, &mut buffer).unwrap();
        assert_eq!(n, 64);
        let frame = Frame::parse(&buffer[..n]).unwrap();
        assert_eq!(frame.tag, Some(Tag::PRIORITY_6));
        Cyclic::parse(frame.payload, 40).unwrap().trailer.cycle_counter
    }

    #[test]
    fn a_following_provider_sends_behind_the_peer_and_counts_on() {
        let us = |micros: u64| Instant::from_nanos(micros * 1000);
        let mut p = provider(timing(32, 16, 1), Instant::ZERO, Instant::from_millis(1));
        // far too early: put off, but once only, however often the peer sends
        p.follow(us(5_000));
        p.follow(us(5_001));
        assert_eq!(p.next_send(), us(17_000));
        // the peer sends every 16 ms, at first 4 ms before us, with 200 us of jitter
        let mut expected = 512_u16;
        for cycle in 0..500_u64 {
            let comes = us(13_000 + 16_000 * cycle + 37 * cycle % 200);
            p.follow(comes);
            assert!(p.next_send() <= comes, "cycle {cycle}");
            assert_eq!(counter(&mut p, comes), expected, "cycle {cycle}");
            assert!(
                p.next_send() > comes + p.interval(),
                "the timer leaves the peer time to come"
            );
            expected = expected.wrapping_add(512);
        }
        assert_eq!((p.sent(), p.skipped()), (500, 0));
        // the peer falls silent: one frame a sixteenth late, then every interval
        let last = us(13_000 + 16_000 * 499 + 37 * 499 % 200);
        for silent in 1..=20_u32 {
            let due = last + p.interval() * silent + Duration::from_millis(1);
            assert_eq!(p.next_send(), due);
            assert_eq!(counter(&mut p, due), expected);
            expected = expected.wrapping_add(512);
        }
        // and comes back
        let back = Instant::ZERO + ((p.next_send() - Instant::ZERO) - Duration::from_millis(1));
        p.follow(back);
        assert_eq!(counter(&mut p, back), expected);
    }

    #[test]
    fn a_provider_comes_into_step_with_a_peer_at_any_distance() {
        for ratio in [1_u16, 4, 16] {
            for distance in 1..32_u32 {
                let mut p = provider(timing(32, ratio, 1), Instant::ZERO, Instant::from_nanos(1));
                let interval = p.interval();
                let mut comes = p.next_send() + interval * distance / 32;
                let mut counters = Vec::new();
                let mut in_step = 0;
                for _ in 0..64 {
                    let due = p.next_send();
                    if due < comes {
                        counters.push(counter(&mut p, due));
                    }
                    p.follow(comes);
                    if p.is_due(comes) {
                        in_step += 1;
                        counters.push(counter(&mut p, comes));
                    }
                    comes += interval;
                }
                let step = 32 * ratio;
                let counts = counters.is_sorted_by(|one, next| one.wrapping_add(step) == *next);
                assert!(counts, "{ratio}, {distance}: {counters:?}");
                assert!(in_step >= 64 - 16, "{ratio}, {distance}: {in_step} of 64 in step");
                assert_eq!(p.skipped(), 0);
            }
        }
    }

    #[test]
    fn the_grid_does_not_drift_and_skipped_intervals_count() {
        let mut p = provider(timing(32, 16, 1), Instant::ZERO, Instant::from_millis(1));
        assert_eq!(p.next_send(), Instant::from_millis(16));
        let mut buffer = [0; 1518];
        assert_eq!(p.emit(Instant::from_nanos(15_999_999), &mut buffer), None);
        assert_eq!(counter(&mut p, Instant::from_millis(16)), 512);
        assert_eq!(counter(&mut p, Instant::from_nanos(35_123_456)), 1024);
        assert_eq!(
            p.next_send(),
            Instant::from_millis(48),
            "late sending moves nothing"
        );
        assert_eq!(
            counter(&mut p, Instant::from_millis(100)),
            6 * 512,
            "48 and 64 and 80 are gone"
        );
        assert_eq!(p.skipped(), 3);
        assert_eq!(p.next_send(), Instant::from_millis(112));
        assert_eq!(p.sent(), 3);
        assert_eq!(p.emit(Instant::from_millis(111), &mut buffer), None);
    }

    #[test]
    fn phase_shifts_the_frame_but_not_its_counter() {
        let mut p = provider(timing(32, 8, 3), Instant::ZERO, Instant::ZERO);
        assert_eq!(p.next_send(), Instant::from_millis(2));
        assert_eq!(counter(&mut p, Instant::from_millis(2)), 0);
        assert_eq!(counter(&mut p, Instant::from_millis(10)), 256);
    }

    #[test]
    fn the_counter_wraps() {
        let mut p = provider(timing(32, 512, 1), Instant::ZERO, Instant::ZERO);
        let seen: Vec<_> = (0..6)
            .map(|k| counter(&mut p, Instant::from_millis(512 * k)))
            .collect();
        assert_eq!(seen, [0, 16384, 32768, 49152, 0, 16384]);
    }

    #[test]
    fn a_counter_of_an_odd_interval_stays_a_multiple_and_never_repeats() {
        let mut p = provider(timing(33, 1, 1), Instant::ZERO, Instant::ZERO);
        let mut last = None;
        for k in 0..5000u64 {
            let value = counter(&mut p, Instant::from_nanos(k * 33 * 31_250));
            assert_eq!(value % 33, 0);
            assert_ne!(Some(value), last);
            last = Some(value);
        }
    }

    #[test]
    fn data_is_placed_as_in_the_layout() {
        let mut p = provider(timing(32, 1, 1), Instant::ZERO, Instant::ZERO);
        assert!(p.set_data(1, 1, &[1, 2, 3, 4], Iops::GOOD));
        assert!(!p.set_data(1, 1, &[1, 2, 3], Iops::GOOD));
        assert!(!p.set_data(2, 1, &[], Iops::GOOD));
        assert!(p.set_data(0, 1, &[], Iops::GOOD));
        assert!(p.set_iocs(1, 1, Iops::GOOD));
        assert!(
            !p.set_iocs(0, 1, Iops::GOOD),
            "its IOCS is in the other direction"
        );
        assert_eq!(p.data(1, 1), Some((&[1, 2, 3, 4][..], Iops::GOOD)));
        p.set_status(DataStatus::STOP);
        let mut buffer = [0; 1518];
        let n = p.emit(Instant::ZERO, &mut buffer).unwrap();
        assert_eq!(&buffer[20..28], [0x80, 1, 2, 3, 4, 0x80, 0x80, 0]);
        assert_eq!(&buffer[n - 4..n], [0, 0, 0x25, 0]);
        p.set_all_iops(Iops::BAD_CONTROLLER);
        p.set_all_iocs(Iops::BAD_SUBSLOT);
        let n = p.emit(Instant::from_millis(1), &mut buffer).unwrap();
        assert_eq!(&buffer[20..28], [0x60, 1, 2, 3, 4, 0x60, 0, 0]);
        assert_eq!(&buffer[n - 4..n], [0, 32, 0x25, 0]);
        assert_eq!(
            p.emit(Instant::from_millis(2), &mut [0; 20]),
            None,
            "too small a buffer"
        );
    }
}
