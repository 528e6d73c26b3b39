//! What the numbers of a speed setpoint mean.

use profile::unit::Linear;

/// What speeds of an axis are reported in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SpeedUnit {
    /// Revolutions per minute.
    #[default]
    Rpm,
    /// Percent of the reference of the drive.
    Percent,
}

impl SpeedUnit {
    /// As it is written behind a number.
    ///
    /// ```
    /// use profidrive_client::axis::SpeedUnit;
    /// assert_eq!(SpeedUnit::Percent.symbol(), "%");
    /// ```
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Rpm => "rpm",
            Self::Percent => "%",
        }
    }

    /// Speed below which an axis counts as standing.
    #[must_use]
    pub const fn standstill(self) -> f64 {
        match self {
            Self::Rpm => 5.0,
            Self::Percent => 0.3,
        }
    }

    /// Returns the tolerance within which a speed counts as reached, also at low speeds.
    #[must_use]
    pub const fn near(self) -> f64 {
        match self {
            Self::Rpm => 2.0,
            Self::Percent => 0.2,
        }
    }
}

/// NSOLL_A and NIST_A of an axis: number and speed.
///
/// ```
/// use profidrive_client::axis::{SpeedScale, SpeedUnit};
/// // PPO types of a VLT with a reference of 1500 rpm
/// let scale = SpeedScale::range(0x4000, [0.0, 1500.0], SpeedUnit::Rpm);
/// assert_eq!((scale.raw(750.0), scale.speed(-0x4000)), (Some(0x2000), -1500.0));
/// // telegrams of a Vacon with references from 300 to 1500 rpm
/// let scale = SpeedScale::range(10_000, [300.0, 1500.0], SpeedUnit::Rpm);
/// assert_eq!((scale.raw(-900.0), scale.speed(5000), scale.raw(0.0)), (Some(-5000), 900.0, Some(0)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedScale {
    numbers: Numbers,
    unit: SpeedUnit,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Numbers {
    /// As the scaling of the drive has it.
    Linear(Linear),
    /// `full` is the higher of two speeds, 0 the lower one.
    Range { full: u16, ends: [f64; 2] },
}

impl SpeedScale {
    /// As the scaling of the drive has it, in rpm.
    #[must_use]
    pub const fn linear(linear: Linear) -> Self {
        Self {
            numbers: Numbers::Linear(linear),
            unit: SpeedUnit::Rpm,
        }
    }

    /// `full` is the second of two speeds; from the first one on the number counts.
    #[must_use]
    pub const fn range(full: u16, ends: [f64; 2], unit: SpeedUnit) -> Self {
        Self {
            numbers: Numbers::Range { full, ends },
            unit,
        }
    }

    /// Percent: `full` is 100 %.
    #[must_use]
    pub const fn percent(full: u16) -> Self {
        Self::range(full, [0.0, 100.0], SpeedUnit::Percent)
    }

    /// Returns the unit of its speeds.
    #[must_use]
    pub const fn unit(&self) -> SpeedUnit {
        self.unit
    }

    /// Returns the number of a speed; `None` where it has none.
    #[must_use]
    pub fn raw(&self, speed: f64) -> Option<i16> {
        let raw = match self.numbers {
            Numbers::Linear(linear) => linear.raw(speed).checked().ok()?,
            Numbers::Range {
                full,
                ends: [low, high],
            } => {
                let part = speed.signum() * ((speed.abs() - low) / (high - low)).max(0.0);
                let raw = (part * f64::from(full)).round();
                if !raw.is_finite() || raw.abs() > f64::from(i16::MAX) {
                    return None;
                }
                #[expect(clippy::cast_possible_truncation, reason = "a whole number of 16 bits")]
                let raw = raw as i64;
                raw
            }
        };
        i16::try_from(raw).ok()
    }

    /// Returns the speed of a number.
    #[must_use]
    pub fn speed(&self, raw: i16) -> f64 {
        match self.numbers {
            Numbers::Linear(linear) => linear.engineering(raw.into()),
            Numbers::Range { .. } if raw == 0 => 0.0,
            Numbers::Range {
                full,
                ends: [low, high],
            } => {
                let part = f64::from(raw) / f64::from(full.max(1));
                part.signum() * low + part * (high - low)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_comes_back() {
        for scale in [
            SpeedScale::percent(0x4000),
            SpeedScale::range(10_000, [150.0, 1500.0], SpeedUnit::Rpm),
            SpeedScale::range(0x4000, [0.0, 3000.0], SpeedUnit::Rpm),
        ] {
            for raw in (-0x7FFF..=0x7FFF).step_by(97) {
                assert_eq!(scale.raw(scale.speed(raw)), Some(raw), "{scale:?}");
            }
        }
        assert_eq!(SpeedScale::percent(0x4000).raw(250.0), None);
        assert_eq!(SpeedScale::percent(0x4000).raw(f64::NAN), None);
        assert_eq!(SpeedScale::range(1, [7.0, 7.0], SpeedUnit::Rpm).raw(8.0), None);
    }
}
