//! Cyclic real-time frames: process data, cycle counter, data status, transfer status; the IOxS octet.
//!
//! Source: IEC 61158-6-10, RTC-PDU and APDU-Status. A cyclic frame carries no length; the trailer is found from the
//! data length agreed at connect time, never from the end of the frame.

use core::fmt;

/// Octets behind the process data: cycle counter, data status, transfer status.
pub const TRAILER: usize = 4;

/// Shortest process data of class 1 and 2 in octets.
pub const MIN_DATA_LENGTH: u16 = 40;

/// Longest process data of class 1 and 2 in octets.
pub const MAX_DATA_LENGTH: u16 = 1440;

/// State of the whole frame and of its provider.
///
/// Source: IEC 61158-6-10, coding of the field DataStatus.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct DataStatus(pub u8);

impl DataStatus {
    /// Bit 0: 1 primary, 0 backup.
    pub const PRIMARY: u8 = 0x01;
    /// Bit 1: no primary exists (only meaningful when bit 0 is 0).
    pub const REDUNDANCY: u8 = 0x02;
    /// Bit 2: the data of this frame is valid; frames without it are ignored.
    pub const DATA_VALID: u8 = 0x04;
    /// Bit 4: 1 provider runs, 0 provider is stopped.
    pub const RUN: u8 = 0x10;
    /// Bit 5: 1 no problem, 0 diagnosis pending.
    pub const NO_PROBLEM: u8 = 0x20;
    /// Bit 7: the status shall not be evaluated.
    pub const IGNORE: u8 = 0x80;

    /// Primary, valid, running, no problem: 0x35.
    pub const GOOD: Self = Self(0x35);
    /// A controller in STOP: valid, not running, no problem: 0x25.
    pub const STOP: Self = Self(0x25);

    /// Returns whether the frame's data is valid.
    #[must_use]
    pub const fn is_valid(self) -> bool {
        self.0 & Self::DATA_VALID != 0
    }

    /// Returns whether the provider runs.
    #[must_use]
    pub const fn is_run(self) -> bool {
        self.0 & Self::RUN != 0
    }

    /// Returns whether the provider reports a problem.
    #[must_use]
    pub const fn has_problem(self) -> bool {
        self.0 & Self::NO_PROBLEM == 0
    }

    /// Returns whether the sender is the primary one.
    #[must_use]
    pub const fn is_primary(self) -> bool {
        self.0 & Self::PRIMARY != 0
    }

    /// With or without the run bit.
    #[must_use]
    pub const fn with_run(self, run: bool) -> Self {
        Self(if run {
            self.0 | Self::RUN
        } else {
            self.0 & !Self::RUN
        })
    }

    /// With or without a reported problem.
    #[must_use]
    pub const fn with_problem(self, problem: bool) -> Self {
        Self(if problem {
            self.0 & !Self::NO_PROBLEM
        } else {
            self.0 | Self::NO_PROBLEM
        })
    }

    /// With or without the data-valid bit.
    #[must_use]
    pub const fn with_valid(self, valid: bool) -> Self {
        Self(if valid {
            self.0 | Self::DATA_VALID
        } else {
            self.0 & !Self::DATA_VALID
        })
    }
}

impl fmt::Display for DataStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "0x{:02X} ({}, {}, {}, {})",
            self.0,
            if self.is_primary() { "primary" } else { "backup" },
            if self.is_valid() { "valid" } else { "invalid" },
            if self.is_run() { "run" } else { "stop" },
            if self.has_problem() { "problem" } else { "ok" }
        )
    }
}

impl fmt::Debug for DataStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "DataStatus(0x{:02X})", self.0)
    }
}

/// State of one submodule's data: the IOPS octet of a provider, the IOCS octet of a consumer.
///
/// Source: IEC 61158-6-10, coding of the field IOxS. Only bit 7 is evaluated.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Iops(pub u8);

impl Iops {
    /// Data is good.
    pub const GOOD: Self = Self(0x80);
    /// Bad, found by the submodule.
    pub const BAD_SUBSLOT: Self = Self(0x00);
    /// Bad, found by the module.
    pub const BAD_SLOT: Self = Self(0x20);
    /// Bad, found by the device.
    pub const BAD_DEVICE: Self = Self(0x40);
    /// Bad, found by the controller.
    pub const BAD_CONTROLLER: Self = Self(0x60);

    /// Returns true when bit 7 is good.
    #[must_use]
    pub const fn is_good(self) -> bool {
        self.0 & 0x80 != 0
    }
}

impl fmt::Display for Iops {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match (self.is_good(), self.0 & 0x60) {
            (true, _) => "good",
            (false, 0x00) => "bad (submodule)",
            (false, 0x20) => "bad (module)",
            (false, 0x40) => "bad (device)",
            (false, _) => "bad (controller)",
        };
        f.write_str(text)
    }
}

impl fmt::Debug for Iops {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Iops(0x{:02X})", self.0)
    }
}

/// The four octets behind the process data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Trailer {
    /// Start of the send interval in units of 31.25 us, modulo 65536.
    pub cycle_counter: u16,
    /// State of the provider.
    pub data_status: DataStatus,
    /// Always 0; other values mark a transfer error.
    pub transfer_status: u8,
}

impl Trailer {
    /// As it stands on the wire.
    #[must_use]
    pub const fn to_bytes(self) -> [u8; TRAILER] {
        let [high, low] = self.cycle_counter.to_be_bytes();
        [high, low, self.data_status.0, self.transfer_status]
    }

    /// From the wire.
    #[must_use]
    pub const fn from_bytes(bytes: [u8; TRAILER]) -> Self {
        let [high, low, status, transfer] = bytes;
        Self {
            cycle_counter: u16::from_be_bytes([high, low]),
            data_status: DataStatus(status),
            transfer_status: transfer,
        }
    }
}

/// One cyclic frame, looked at with the data length that was agreed at connect time.
///
/// ```
/// use profidrive_profinet::wire::rt::{Cyclic, DataStatus};
/// let mut payload = [0x80; 44];
/// payload[40..].copy_from_slice(&[0x1C, 0x00, 0x35, 0x00]);
/// let frame = Cyclic::parse(&payload, 40).unwrap();
/// assert_eq!(frame.trailer.cycle_counter, 0x1C00);
/// assert_eq!(frame.trailer.data_status, DataStatus::GOOD);
/// assert_eq!(frame.data.len(), 40);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cyclic<'a> {
    /// The C_SDU: process data, IOPS and IOCS.
    pub data: &'a [u8],
    /// What follows it.
    pub trailer: Trailer,
}

impl<'a> Cyclic<'a> {
    /// Splits the octets behind the FrameID; `None` when they are too short for `data_length` and the trailer.
    #[must_use]
    pub fn parse(payload: &'a [u8], data_length: usize) -> Option<Self> {
        let (data, rest) = payload.split_at_checked(data_length)?;
        let (trailer, _padding) = rest.split_first_chunk::<TRAILER>()?;
        Some(Self {
            data,
            trailer: Trailer::from_bytes(*trailer),
        })
    }

    /// Splits a frame whose data length is not known (a capture without its connect): all but the last four octets.
    /// Wrong for frames that were padded to the shortest Ethernet length.
    #[must_use]
    pub fn parse_to_end(payload: &'a [u8]) -> Option<Self> {
        Self::parse(payload, payload.len().checked_sub(TRAILER)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // device -> controller, data length 40, recorded at an S7-1500
    const CAPTURED: &[u8] = &[
        0x80, 0x80, 0x80, 0x2c, 0x80, 0x80, 0x2d, 0x80, 0x80, 0x00, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
        0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x1c, 0x00, 0x35, 0x00,
    ];

    #[test]
    fn golden() {
        let frame = Cyclic::parse(CAPTURED, 40).unwrap();
        assert_eq!(frame.trailer.cycle_counter, 7 * 1024);
        assert_eq!(frame.trailer.data_status, DataStatus::GOOD);
        assert_eq!(frame.trailer.transfer_status, 0);
        assert_eq!(frame.trailer.to_bytes(), CAPTURED[40..]);
        assert_eq!(Cyclic::parse_to_end(CAPTURED), Some(frame));
    }

    #[test]
    fn trailer_is_found_in_front_of_padding() {
        let mut padded = [0xEE; 64];
        padded[..44].copy_from_slice(CAPTURED);
        assert_eq!(Cyclic::parse(&padded, 40).unwrap().trailer.cycle_counter, 0x1C00);
    }

    #[test]
    fn every_cut_is_refused() {
        for cut in 0..CAPTURED.len() {
            assert_eq!(Cyclic::parse(&CAPTURED[..cut], 40), None);
        }
        assert_eq!(Cyclic::parse(CAPTURED, usize::MAX), None);
        assert_eq!(Cyclic::parse_to_end(&[1, 2, 3]), None);
    }

    #[test]
    fn status_bits_of_every_octet() {
        for n in 0..=255u8 {
            let s = DataStatus(n);
            assert_eq!(s.is_valid(), n & 4 != 0);
            assert_eq!(s.with_run(true).0, n | 0x10);
            assert_eq!(s.with_run(false).0, n & 0xEF);
            assert_eq!(s.with_problem(true).0, n & 0xDF);
            assert_eq!(s.with_valid(false).0, n & 0xFB);
            assert_eq!(Iops(n).is_good(), n >= 0x80);
            let trailer = Trailer {
                cycle_counter: u16::from(n) << 4,
                data_status: s,
                transfer_status: n,
            };
            assert_eq!(Trailer::from_bytes(trailer.to_bytes()), trailer);
        }
        assert_eq!(DataStatus::GOOD.with_run(false), DataStatus::STOP);
        assert_eq!(DataStatus(0x15).with_problem(false), DataStatus::GOOD);
    }

    #[test]
    fn words() {
        use alloc::string::ToString;
        assert_eq!(DataStatus::STOP.to_string(), "0x25 (primary, valid, stop, ok)");
        assert_eq!(Iops::BAD_CONTROLLER.to_string(), "bad (controller)");
        assert_eq!(Iops::GOOD.to_string(), "good");
    }
}
