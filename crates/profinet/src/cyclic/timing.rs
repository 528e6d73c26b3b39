//! Send interval, phase, data hold time, and what a connect request may request.

use core::time::Duration;

/// The time unit of PROFINET cycles, 31.25 us.
pub const TICK: Duration = Duration::from_nanos(31_250);

/// Largest watchdog and data hold factor.
pub const MAX_FACTOR: u16 = 0x1E00;

/// Longest data hold time of class 1 and 2.
const MAX_HOLD_NANOS: u64 = 1_920_000_000;

/// What is wrong with an IOCR block.
///
/// Source: IEC 61158-6-10, PNIOStatus with ErrorCode 0xDB, ErrorDecode 0x81, ErrorCode1 0x02; [`code2`](Self::code2)
/// is the ErrorCode2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
pub enum IocrError {
    /// DataLength outside 40 to 1440.
    #[error("data length {0} is outside 40 to 1440 octets")]
    DataLength(u16),
    /// SendClockFactor is not a power of two from 1 to 128.
    #[error("send clock factor {0} is not a power of two from 1 to 128")]
    SendClockFactor(u16),
    /// ReductionRatio is not allowed, or the interval is shorter than the device can do.
    #[error("reduction ratio {0} is not possible with this send clock or device")]
    ReductionRatio(u16),
    /// Phase outside 1 to ReductionRatio.
    #[error("phase {0} is outside 1 to the reduction ratio")]
    Phase(u16),
    /// WatchdogFactor outside 1 to 0x1E00.
    #[error("watchdog factor {0} is outside 1 to 7680")]
    WatchdogFactor(u16),
    /// DataHoldFactor outside 1 to the second number: more would be beyond 0x1E00 or hold longer than 1.92 s.
    #[error(
        "watchdog and data hold of {0} update times: 1 to {1} are possible with this update time (at most 1.92 s)"
    )]
    DataHoldFactor(u16, u16),
    /// No API, or an API without any object.
    #[error("no API, or an API without an object")]
    NumberOfApis,
    /// An API that no expected submodule has.
    #[error("API 0x{0:X} has no expected submodule")]
    Api(u32),
    /// A data object in a slot without expected submodules.
    #[error("data object in slot {0}, where nothing is expected")]
    DataSlot(u16),
    /// A data object of a subslot that is not expected, has no data of this direction or came twice.
    #[error("data object of slot {0} subslot 0x{1:X} is not expected here or came twice")]
    DataSubslot(u16, u16),
    /// A data object with its IOPS overlaps something or leaves the frame.
    #[error("data object of slot {0} subslot 0x{1:X} overlaps or leaves the frame at offset {2}")]
    DataOffset(u16, u16, u16),
    /// An IOCS in a slot without expected submodules.
    #[error("IOCS in slot {0}, where nothing is expected")]
    StatusSlot(u16),
    /// An IOCS of a subslot that is not expected, has no data of the other direction or came twice.
    #[error("IOCS of slot {0} subslot 0x{1:X} is not expected here or came twice")]
    StatusSubslot(u16, u16),
    /// An IOCS overlaps something or leaves the frame.
    #[error("IOCS of slot {0} subslot 0x{1:X} overlaps or leaves the frame at offset {2}")]
    StatusOffset(u16, u16, u16),
}

impl IocrError {
    /// ErrorCode2 of the PNIOStatus DB 81 02 xx that refuses such a connect.
    #[must_use]
    pub const fn code2(self) -> u8 {
        match self {
            Self::DataLength(_) => 8,
            Self::SendClockFactor(_) => 10,
            Self::ReductionRatio(_) => 11,
            Self::Phase(_) => 12,
            Self::WatchdogFactor(_) => 15,
            Self::DataHoldFactor(..) => 16,
            Self::NumberOfApis => 19,
            Self::Api(_) => 20,
            Self::DataSlot(_) => 22,
            Self::DataSubslot(..) => 23,
            Self::DataOffset(..) => 24,
            Self::StatusSlot(_) => 26,
            Self::StatusSubslot(..) => 27,
            Self::StatusOffset(..) => 28,
        }
    }
}

/// When frames of one direction are sent.
///
/// Source: IEC 61158-6-10, SendClockFactor, ReductionRatio, Phase. Interval = factor x ratio x 31.25 us.
///
/// ```
/// use core::time::Duration;
/// use profidrive_profinet::cyclic::Timing;
/// let timing = Timing { send_clock_factor: 32, reduction_ratio: 16, phase: 1 };
/// assert_eq!(timing.interval(), Duration::from_millis(16));
/// assert_eq!(timing.hold_time(3), Duration::from_millis(48));
/// assert_eq!(Timing::for_interval(Duration::from_millis(16)), Some(timing));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Timing {
    /// Length of a send clock in ticks of 31.25 us; 32 is 1 ms.
    pub send_clock_factor: u16,
    /// A frame goes out once in this many send clocks.
    pub reduction_ratio: u16,
    /// In which of them, from 1.
    pub phase: u16,
}

impl Timing {
    /// Ticks of 31.25 us from frame to frame; at least 1.
    #[must_use]
    pub const fn ticks(&self) -> u32 {
        let ticks = self.send_clock_factor as u32 * self.reduction_ratio as u32;
        if ticks == 0 { 1 } else { ticks }
    }

    /// Returns the time from frame to frame.
    #[must_use]
    pub const fn interval(&self) -> Duration {
        Duration::from_nanos(self.ticks() as u64 * 31_250)
    }

    /// Returns the data hold time: without a frame for this long the connection is lost.
    #[must_use]
    pub const fn hold_time(&self, data_hold_factor: u16) -> Duration {
        Duration::from_nanos(self.ticks() as u64 * 31_250 * data_hold_factor as u64)
    }

    /// Returns the highest DataHoldFactor with this interval: 0x1E00, and no longer than 1.92 s.
    ///
    /// ```
    /// use profidrive_profinet::cyclic::Timing;
    /// use core::time::Duration;
    /// let timing = Timing::for_interval(Duration::from_millis(16)).unwrap();
    /// assert_eq!(timing.highest_hold_factor(), 120);
    /// ```
    #[must_use]
    pub fn highest_hold_factor(&self) -> u16 {
        let factor = MAX_HOLD_NANOS / (u64::from(self.ticks()) * 31_250);
        u16::try_from(factor).map_or(MAX_FACTOR, |factor| factor.min(MAX_FACTOR))
    }

    /// Returns the usual timing of an interval: send clock 1 ms and a reduction ratio, or for shorter ones a shorter
    /// send clock. `None` unless the interval is 31.25 us times a power of two up to 512 ms.
    #[must_use]
    pub fn for_interval(interval: Duration) -> Option<Self> {
        let nanos = u64::try_from(interval.as_nanos()).ok()?;
        if nanos == 0 || nanos % 31_250 != 0 {
            return None;
        }
        let ticks = nanos / 31_250;
        if !ticks.is_power_of_two() || ticks > 32 * 512 {
            return None;
        }
        let factor = ticks.min(32);
        let ratio = ticks / factor;
        Some(Self {
            send_clock_factor: u16::try_from(factor).ok()?,
            reduction_ratio: u16::try_from(ratio).ok()?,
            phase: 1,
        })
    }

    /// Checks the three numbers and both supervision factors as a device must; `min_device_interval` in ticks.
    ///
    /// # Errors
    /// The [`IocrError`] of the first field that is not allowed, in the order of the block.
    pub fn check(
        &self,
        watchdog_factor: u16,
        data_hold_factor: u16,
        min_device_interval: u16,
    ) -> Result<(), IocrError> {
        let factor = self.send_clock_factor;
        if !factor.is_power_of_two() || factor > 128 {
            return Err(IocrError::SendClockFactor(factor));
        }
        let ratio = self.reduction_ratio;
        let too_long = (ratio >= 256 && factor > 64) || (ratio == 512 && factor > 32);
        if !ratio.is_power_of_two()
            || ratio > 512
            || too_long
            || self.ticks() < u32::from(min_device_interval)
        {
            return Err(IocrError::ReductionRatio(ratio));
        }
        if self.phase == 0 || self.phase > ratio {
            return Err(IocrError::Phase(self.phase));
        }
        if watchdog_factor == 0 || watchdog_factor > MAX_FACTOR {
            return Err(IocrError::WatchdogFactor(watchdog_factor));
        }
        let highest = self.highest_hold_factor();
        if data_hold_factor == 0 || data_hold_factor > highest {
            return Err(IocrError::DataHoldFactor(data_hold_factor, highest));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timing(send_clock_factor: u16, reduction_ratio: u16, phase: u16) -> Timing {
        Timing {
            send_clock_factor,
            reduction_ratio,
            phase,
        }
    }

    #[test]
    fn both_sides_of_each_limit() {
        assert_eq!(timing(32, 1, 1).check(3, 3, 32), Ok(()));
        assert_eq!(
            timing(32, 1, 1).check(3, 3, 33),
            Err(IocrError::ReductionRatio(1))
        );
        assert_eq!(timing(128, 128, 128).check(3, 3, 0), Ok(()));
        assert_eq!(
            timing(128, 256, 1).check(1, 1, 0),
            Err(IocrError::ReductionRatio(256))
        );
        assert_eq!(timing(64, 256, 1).check(1, 3, 0), Ok(()));
        assert_eq!(
            timing(64, 512, 1).check(1, 1, 0),
            Err(IocrError::ReductionRatio(512))
        );
        assert_eq!(timing(32, 512, 1).check(3, 3, 0), Ok(()));
        assert_eq!(
            timing(32, 1024, 1).check(3, 3, 0),
            Err(IocrError::ReductionRatio(1024))
        );
        assert_eq!(
            timing(256, 1, 1).check(3, 3, 0),
            Err(IocrError::SendClockFactor(256))
        );
        assert_eq!(timing(0, 1, 1).check(3, 3, 0), Err(IocrError::SendClockFactor(0)));
        assert_eq!(
            timing(33, 1, 1).check(3, 3, 0),
            Err(IocrError::SendClockFactor(33))
        );
        assert_eq!(timing(32, 4, 0).check(3, 3, 0), Err(IocrError::Phase(0)));
        assert_eq!(timing(32, 4, 5).check(3, 3, 0), Err(IocrError::Phase(5)));
        assert_eq!(timing(32, 4, 4).check(0, 3, 0), Err(IocrError::WatchdogFactor(0)));
        assert_eq!(
            timing(32, 4, 4).check(0x1E01, 3, 0),
            Err(IocrError::WatchdogFactor(0x1E01))
        );
        assert_eq!(timing(32, 1, 1).check(0x1E00, 1920, 0), Ok(()));
        assert_eq!(
            timing(32, 1, 1).check(3, 1921, 0),
            Err(IocrError::DataHoldFactor(1921, 1920))
        );
        assert_eq!(timing(1, 1, 1).check(3, 0x1E00, 0), Ok(()));
        assert_eq!(
            timing(1, 1, 1).check(3, 0x1E01, 0),
            Err(IocrError::DataHoldFactor(0x1E01, 0x1E00))
        );
        assert_eq!(
            timing(1, 1, 1).check(3, 0, 0),
            Err(IocrError::DataHoldFactor(0, 0x1E00))
        );
    }

    #[test]
    fn intervals() {
        for power in 0..=9 {
            let interval = Duration::from_millis(1 << power);
            let t = Timing::for_interval(interval).unwrap();
            assert_eq!(t.interval(), interval);
            assert_eq!(t.check(3, 3, 0), Ok(()));
        }
        assert_eq!(
            Timing::for_interval(Duration::from_micros(500)),
            Some(timing(16, 1, 1))
        );
        assert_eq!(Timing::for_interval(Duration::from_millis(3)), None);
        assert_eq!(Timing::for_interval(Duration::from_millis(1024)), None);
        assert_eq!(Timing::for_interval(Duration::ZERO), None);
    }
}
