//! Speeds as people write them, and the requests that they make.

use client::axis::SpeedUnit;
use client::{Drive, Session};
use profile::notation::Quantity;

use super::error::MotionError;
use super::event::Observer;
use super::run::{Frequency, Run, speed_at};
use super::step::Step;

/// Share of a step within which the new speed counts as settled, where its caller chooses no other.
const USUAL_BAND: f64 = 0.02;

/// A speed of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Speed {
    /// In rpm.
    Rpm(f64),
    /// Output frequency of a frequency converter, Hz.
    Hertz(f64),
}

impl Speed {
    /// Returns a speed as a person writes it: `60rpm`, `1rps`, `25Hz`. A number without a unit is in rpm. `what` begins the error.
    ///
    /// # Errors
    /// [`MotionError::Unit`]
    pub fn of(quantity: &Quantity, what: &'static str) -> Result<Self, MotionError> {
        match quantity.in_hertz() {
            Some(hertz) => Ok(Self::Hertz(hertz)),
            None => in_unit(quantity, "rpm", what).map(Self::Rpm),
        }
    }

    /// Returns the speed in rpm; a frequency is converted by the motor data of the drive, which is reported.
    ///
    /// # Errors
    /// As [`speed_at`].
    pub async fn in_rpm(
        self,
        session: &mut Session,
        drive: &mut Drive,
        observer: &Observer,
    ) -> Result<f64, MotionError> {
        match self {
            Self::Rpm(rpm) => Ok(rpm),
            Self::Hertz(hertz) => speed_at(session, drive, hertz, observer).await,
        }
    }
}

impl Run {
    /// At a speed as a person writes it: `60rpm`, `20%` of the reference of the drive, or `25Hz` of a frequency converter. A limit
    /// is in the same unit, or in rpm for a frequency; without one it is the usual one.
    ///
    /// ```
    /// use profidrive::motion::Run;
    ///
    /// let run = Run::of(&"20%".parse()?, Some(&"50%".parse()?))?;
    /// assert_eq!((run.speed, run.limit), (20.0, 50.0));
    /// let error = Run::of(&"60rpm".parse()?, Some(&"5A".parse()?)).unwrap_err();
    /// assert!(error.to_string().starts_with("limit of the speed: "), "{error}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MotionError::Unit`]
    pub fn of(speed: &Quantity, limit: Option<&Quantity>) -> Result<Self, MotionError> {
        match speed.in_hertz() {
            Some(hertz) => Self::of_hertz(hertz, limit),
            None => Self::of_unit(speed, limit, unit_of(&[speed])),
        }
    }

    fn of_hertz(hertz: f64, limit: Option<&Quantity>) -> Result<Self, MotionError> {
        let usual = Self::at_frequency(hertz);
        let Some(limit) = limit else { return Ok(usual) };
        if let Some(limit) = limit.in_hertz() {
            let limit = Some(limit.abs());
            let frequency = Some(Frequency { hertz, limit });
            return Ok(Self { frequency, ..usual });
        }
        let limit = in_unit(limit, "rpm", LIMIT)?.abs();
        Ok(Self { limit, ..usual })
    }

    fn of_unit(speed: &Quantity, limit: Option<&Quantity>, unit: SpeedUnit) -> Result<Self, MotionError> {
        let speed = in_unit(speed, unit.symbol(), SPEED)?;
        let usual = match unit {
            SpeedUnit::Rpm => Self::at(speed),
            SpeedUnit::Percent => Self::at_percent(speed),
        };
        let limit = limit.map(|limit| in_unit(limit, unit.symbol(), LIMIT));
        let limit = limit.transpose()?.map_or(usual.limit, f64::abs);
        Ok(Self { limit, ..usual })
    }
}

impl Step {
    /// From one speed to another as a person writes them, with the units and the limit of [`Run::of`]. The time is to be set.
    ///
    /// # Errors
    /// [`MotionError::Unit`]
    pub fn of(from: &Quantity, to: &Quantity, limit: Option<&Quantity>) -> Result<Self, MotionError> {
        let (from, run) = match from.in_hertz().zip(to.in_hertz()) {
            Some((from, to)) => (from, Run::of_hertz(to, limit)?),
            None => {
                let unit = unit_of(&[from, to]);
                let from = in_unit(from, unit.symbol(), SPEED)?;
                (from, Run::of_unit(to, limit, unit)?)
            }
        };
        let band = USUAL_BAND;
        Ok(Self { from, run, band })
    }
}

const SPEED: &str = "speed";
const LIMIT: &str = "limit of the speed";

/// Percent where one of the speeds is in percent.
fn unit_of(speeds: &[&Quantity]) -> SpeedUnit {
    let in_percent = |speed: &&Quantity| speed.unit.as_deref() == Some("%");
    match speeds.iter().any(in_percent) {
        true => SpeedUnit::Percent,
        false => SpeedUnit::Rpm,
    }
}

fn in_unit(quantity: &Quantity, unit: &str, what: &'static str) -> Result<f64, MotionError> {
    quantity
        .in_unit(unit)
        .map_err(|problem| MotionError::Unit { what, problem })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn run(speed: &str, limit: Option<&str>) -> Result<Run, String> {
        let limit = limit.map(|limit| limit.parse().unwrap());
        Run::of(&speed.parse().unwrap(), limit.as_ref()).map_err(|error| error.to_string())
    }

    #[test]
    fn a_limit_is_in_the_unit_of_the_speed() {
        assert_eq!(run("60rpm", None), Ok(Run::at(60.0)));
        assert_eq!(run("1rps", Some("-2rps")).unwrap().limit, 120.0);
        assert_eq!(run("20%", None), Ok(Run::at_percent(20.0)));
        assert!(run("20%", Some("500rpm")).is_err());
        let hertz = run("25Hz", Some("50Hz")).unwrap().frequency.unwrap();
        assert_eq!((hertz.hertz, hertz.limit), (25.0, Some(50.0)));
        assert_eq!(run("25Hz", Some("900rpm")).unwrap().limit, 900.0);
        assert!(run("60rpm", Some("50Hz")).is_err());
    }

    #[test]
    fn both_speeds_of_a_step_have_one_unit() {
        let step = |from: &str, to: &str| Step::of(&from.parse().unwrap(), &to.parse().unwrap(), None);
        let percent = step("0", "20%").unwrap();
        assert_eq!((percent.from, percent.run.unit), (0.0, SpeedUnit::Percent));
        assert_eq!(step("10Hz", "25Hz").unwrap().from, 10.0);
        assert!(step("10Hz", "100rpm").is_err() && step("10rpm", "20%").is_err());
    }
}
