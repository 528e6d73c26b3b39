//! Times of the line.

use core::time::Duration;

/// Baud rates with a start delay printed for them (Siemens CU240S p. 8-24).
pub const BAUD_RATES: [u32; 5] = [9_600, 19_200, 38_400, 57_600, 115_200];

/// Bits of a character: start, eight data, even parity, stop.
const BITS: u64 = 11;
/// Characters of silence in front of a telegram at least.
const START_DELAY: u32 = 2;

/// Times of a line. Source: Siemens CU240S p. 178-179 and 8-24; Danfoss VLT 2800 design guide p. 108.
///
/// ```
/// use core::time::Duration;
/// use profidrive_uss::Timing;
/// let timing = Timing::uss(9600);
/// assert_eq!(timing.start_delay.as_micros(), 2291);
/// assert_eq!(Timing::fc(9600).response, Duration::from_millis(50));
/// assert_eq!(timing.telegram(16).as_millis(), 18);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    /// One character, 11 bits.
    pub character: Duration,
    /// Silence in front of a telegram at least: two characters.
    pub start_delay: Duration,
    /// Time from one octet of a telegram to the next at most. By the rule the silence between them is shorter than the
    /// start delay; a port that hands octets over in lumps needs more, see [`Timing::with_gap`].
    pub gap: Duration,
    /// From the end of a request until the reply begins at most.
    pub response: Duration,
}

impl Timing {
    /// USS: the slave answers within 20 ms (the usual figure, no available document defines it).
    #[must_use]
    pub const fn uss(baud: u32) -> Self {
        Self::new(baud, Duration::from_millis(20))
    }

    /// Danfoss FC: the slave answers within 50 ms.
    #[must_use]
    pub const fn fc(baud: u32) -> Self {
        Self::new(baud, Duration::from_millis(50))
    }

    /// For a response delay of its own; 0 baud counts as 1.
    #[must_use]
    pub const fn new(baud: u32, response: Duration) -> Self {
        let baud = if baud == 0 { 1 } else { baud as u64 };
        let character = Duration::from_nanos(BITS * 1_000_000_000 / baud);
        let start_delay = Duration::from_nanos(START_DELAY as u64 * BITS * 1_000_000_000 / baud);
        Self {
            character,
            start_delay,
            gap: start_delay.saturating_add(character),
            response,
        }
    }

    /// Tolerates gaps of up to `gap` between the octets of one telegram: some adapters and systems deliver them in
    /// bursts. Never below the rule of the line.
    #[must_use]
    pub fn with_gap(self, gap: Duration) -> Self {
        Self {
            gap: gap.max(self.gap),
            ..self
        }
    }

    /// Returns the time that a telegram of so many octets takes on the wire.
    #[must_use]
    pub fn telegram(&self, octets: usize) -> Duration {
        self.character
            .saturating_mul(u32::try_from(octets).unwrap_or(u32::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The printed table; the 0.117 ms that prints show for 115200 belong to 187500.
    #[test]
    fn start_delays_as_printed() {
        for (baud, micros) in BAUD_RATES.iter().zip([2291, 1146, 573, 382, 191]) {
            let delay = Timing::uss(*baud).start_delay.as_nanos();
            assert!(delay.abs_diff(micros * 1000) <= 1000, "{baud}: {delay} ns");
        }
        assert_eq!(Timing::uss(187_500).start_delay.as_micros(), 117);
    }

    #[test]
    fn a_gap_is_never_shorter_than_the_rule() {
        let timing = Timing::uss(9600);
        assert_eq!(timing.with_gap(Duration::ZERO), timing);
        assert_eq!(
            timing.with_gap(Duration::from_millis(20)).gap,
            Duration::from_millis(20)
        );
    }
}
