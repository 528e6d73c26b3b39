//! Many runs of one plant: a seed and varied values for each, and what its expectations say.

use std::fmt;
use std::time::Duration;

use profile::notation::Quantity;
use profinet::Instant;
use serde::Serialize;

use crate::expect::{ExpectationResult, Measure};
use crate::kept::{Trace, TraceError};
use crate::plan::WorldError;
use crate::source::{ChangeError, PlantSource};
use crate::world::World;

/// How a value is chosen for each run.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Distribution {
    /// One of these values, each as often as the others.
    Choice(Vec<toml::Value>),
    /// The value at this place of a list, in every run: the campaigns with the other values stand beside it.
    Listed {
        /// All values.
        values: Vec<toml::Value>,
        /// Which one, from 0.
        place: usize,
    },
    /// Any value between two, each as often as the others.
    Uniform(Bounds),
    /// Any value between two above 0, each order of magnitude as often as the others.
    LogUniform(Bounds),
    /// Values around a mean.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
        /// Unit of both.
        unit: Option<String>,
    },
}

/// The ends of an interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    low: f64,
    high: f64,
    unit: Option<String>,
}

/// What the values of a distribution have in common: the type of a column of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ValueForm {
    /// True and false.
    Flag,
    /// Whole numbers without a unit.
    Integer,
    /// Numbers of this unit, empty for none.
    Number(String),
    /// Anything else.
    Text,
}

/// Returns the number of a value and its unit; `None` for a value that is no quantity.
#[must_use]
pub fn number_of(value: &toml::Value) -> Option<(f64, String)> {
    match value {
        toml::Value::Integer(number) => Some((*number as f64, String::new())),
        toml::Value::Float(number) => Some((*number, String::new())),
        toml::Value::String(text) => {
            let quantity: Quantity = text.parse().ok()?;
            Some((quantity.number.as_f64(), quantity.unit?))
        }
        _ => None,
    }
}

/// Numbers that make no distribution.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct DistributionError(String);

impl Bounds {
    /// Returns the interval between two quantities of one unit.
    ///
    /// # Errors
    /// When they have two units, or the first one is not below the second.
    pub fn new(low: &Quantity, high: &Quantity) -> Result<Self, DistributionError> {
        let (low, high, unit) = of_one_unit(low, high)?;
        if low < high {
            return Ok(Self { low, high, unit });
        }
        Err(DistributionError(format!("{low} is not below {high}")))
    }
}

fn of_one_unit(a: &Quantity, b: &Quantity) -> Result<(f64, f64, Option<String>), DistributionError> {
    let (first, second) = (a.number.as_f64(), b.number.as_f64());
    if a.unit != b.unit || !first.is_finite() || !second.is_finite() {
        return Err(DistributionError(format!(
            "{a} and {b} are not numbers of one unit"
        )));
    }
    Ok((first, second, a.unit.clone()))
}

impl Distribution {
    /// Returns a normal distribution.
    ///
    /// # Errors
    /// When the two have different units, or the deviation is below 0.
    pub fn normal(mean: &Quantity, deviation: &Quantity) -> Result<Self, DistributionError> {
        let (mean, deviation, unit) = of_one_unit(mean, deviation)?;
        if deviation < 0.0 {
            return Err(DistributionError(format!(
                "a deviation of {deviation} is below 0"
            )));
        }
        Ok(Self::Normal {
            mean,
            deviation,
            unit,
        })
    }

    /// Returns what all of its values have in common.
    #[must_use]
    pub fn form(&self) -> ValueForm {
        let unit = |unit: &Option<String>| ValueForm::Number(unit.clone().unwrap_or_default());
        let values = match self {
            Self::Uniform(Bounds { unit: of, .. }) | Self::LogUniform(Bounds { unit: of, .. }) => {
                return unit(of);
            }
            Self::Normal { unit: of, .. } => return unit(of),
            Self::Choice(values) | Self::Listed { values, .. } => values,
        };
        if values.iter().all(toml::Value::is_bool) {
            return ValueForm::Flag;
        }
        if values.iter().all(toml::Value::is_integer) {
            return ValueForm::Integer;
        }
        let units: Option<Vec<_>> = values.iter().map(|value| Some(number_of(value)?.1)).collect();
        match units.as_deref() {
            Some([first, rest @ ..]) if rest.iter().all(|unit| unit == first) => {
                ValueForm::Number(first.clone())
            }
            _ => ValueForm::Text,
        }
    }

    /// Returns the value for a run. It depends on the seed of the run and the path of the value alone, so that neither the order of
    /// runs nor other values change it.
    #[must_use]
    pub fn draw(&self, seed: u64, path: &str) -> Option<toml::Value> {
        let mut draws = Draws::new(seed, path);
        let (number, unit) = match self {
            Self::Choice(values) => {
                let place = draws.share() * values.len() as f64;
                return values.get(place as usize).cloned();
            }
            Self::Listed { values, place } => return values.get(*place).cloned(),
            Self::Uniform(Bounds { low, high, unit }) => (low + draws.share() * (high - low), unit),
            Self::LogUniform(Bounds { low, high, unit }) => {
                ((low.ln() + draws.share() * (high.ln() - low.ln())).exp(), unit)
            }
            Self::Normal {
                mean,
                deviation,
                unit,
            } => {
                // Box and Muller
                let radius = (-2.0 * (1.0 - draws.share()).ln()).sqrt();
                let angle = std::f64::consts::TAU * draws.share();
                (mean + deviation * radius * angle.cos(), unit)
            }
        };
        Some(match unit {
            Some(unit) => toml::Value::String(format!("{number}{unit}")),
            None => toml::Value::Float(number),
        })
    }
}

/// Numbers by chance, from a seed and a name (SplitMix64 over FNV-1a).
struct Draws(u64);

impl Draws {
    fn new(seed: u64, name: &str) -> Self {
        let of_name = name.bytes().fold(0xCBF2_9CE4_8422_2325, |hash: u64, octet| {
            (hash ^ u64::from(octet)).wrapping_mul(0x0100_0000_01B3)
        });
        Self(of_name ^ Self(seed).next())
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    }

    /// From 0 to below 1.
    fn share(&mut self) -> f64 {
        // as many bits as a number of 64 bits has behind the point
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A run of a campaign, with what came of it.
#[derive(Debug, Clone, Serialize)]
pub struct CampaignRun {
    /// Its seed.
    pub seed: u64,
    /// The values that varied, by path.
    pub variables: Vec<(String, toml::Value)>,
    /// What came of each expectation for each of its drives.
    pub results: Vec<ExpectationResult>,
    /// What was measured, by name; no number where there is none.
    pub measures: Vec<(String, Option<f64>)>,
    /// [`World::digest`] at its end, as text in hexadecimal: that of the trace of the same run.
    pub digest: String,
    /// Seconds of the plant that passed.
    pub end: f64,
}

/// Why a run of a campaign cannot be.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CampaignError {
    /// A value that varies does not fit the plant.
    #[error("seed {seed}: {error}")]
    Change {
        /// The seed of the run.
        seed: u64,
        /// What is wrong.
        error: ChangeError,
    },
    /// The plant does not start.
    #[error("seed {seed}: {error}")]
    World {
        /// The seed of the run.
        seed: u64,
        /// Why not.
        error: Box<WorldError>,
    },
    /// Something cannot be measured.
    #[error("seed {seed}: {error}")]
    Measure {
        /// The seed of the run.
        seed: u64,
        /// Why not.
        error: TraceError,
    },
    /// The plant has no `duration`, and no time was given.
    #[error("how long? The plant has no `duration`: give a time")]
    NoDuration,
}

/// One plant that is run with many seeds. A run depends on nothing but the campaign and its seed.
///
/// ```
/// use profidrive_plant::{Bounds, Campaign, Distribution, PlantSource};
///
/// let plant: PlantSource = r#"
///     duration = "2s"
///     expect = [{ name = "no fault", never = true, drive = "akd-1", fault = "any" }]
///     [[drive]]
///     name = "akd-1"
///     ip = "10.0.0.1/24"
/// "#.parse()?;
/// let friction = Distribution::Uniform(Bounds::new(&"0.1".parse()?, &"0.4".parse()?)?);
/// let campaign = Campaign::new(plant).vary("drive.akd-1.load.friction", friction);
/// let run = campaign.run(7)?;
/// assert!(run.results.iter().all(|result| result.is_met()));
/// assert_eq!(campaign.run(7)?.digest, run.digest);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Campaign {
    plant: PlantSource,
    vary: Vec<(String, Distribution)>,
    until: Option<Duration>,
    measures: Vec<(String, Measure)>,
}

impl Campaign {
    /// Returns the campaign of a plant, in which nothing varies but the seed.
    #[must_use]
    pub const fn new(plant: PlantSource) -> Self {
        Self {
            plant,
            vary: Vec::new(),
            until: None,
            measures: Vec::new(),
        }
    }

    /// Lets the value at a path vary; paths are those of [`PlantSource::with_changes`].
    #[must_use]
    pub fn vary(mut self, path: impl Into<String>, distribution: Distribution) -> Self {
        self.vary.push((path.into(), distribution));
        self
    }

    /// Ends each run at this time; otherwise at the `duration` of the plant.
    #[must_use]
    pub fn until(mut self, time: Duration) -> Self {
        self.until = Some(time);
        self
    }

    /// Makes a number of this name of each run.
    #[must_use]
    pub fn measure(mut self, name: impl Into<String>, measure: Measure) -> Self {
        self.measures.push((name.into(), measure));
        self
    }

    /// Returns what is measured, by name.
    pub fn measured(&self) -> impl Iterator<Item = (&str, &Measure)> {
        self.measures
            .iter()
            .map(|(name, measure)| (name.as_str(), measure))
    }

    /// Returns the plant before its values vary.
    #[must_use]
    pub const fn source(&self) -> &PlantSource {
        &self.plant
    }

    /// Returns the paths whose values vary, with how they do.
    pub fn varied(&self) -> impl Iterator<Item = (&str, &Distribution)> {
        self.vary.iter().map(|(path, how)| (path.as_str(), how))
    }

    /// Returns the plant of a run with this seed, and the values that vary.
    ///
    /// # Errors
    /// When a value does not fit.
    pub fn plant(&self, seed: u64) -> Result<(PlantSource, Vec<(String, toml::Value)>), CampaignError> {
        let draw = |(path, distribution): &(String, Distribution)| {
            let value = distribution.draw(seed, path)?;
            Some((path.clone(), value))
        };
        let variables: Vec<_> = self.vary.iter().filter_map(draw).collect();
        Ok((self.changed(seed, &variables)?, variables))
    }

    /// Returns the plant with a seed and these values.
    pub(crate) fn changed<'a>(
        &self,
        seed: u64,
        variables: impl IntoIterator<Item = &'a (String, toml::Value)>,
    ) -> Result<PlantSource, CampaignError> {
        let changes = variables
            .into_iter()
            .map(|(path, value)| (path.as_str(), value.clone()));
        // the text of a plant has numbers of 63 bits
        let own = [("seed", toml::Value::Integer((seed & (u64::MAX >> 1)) as i64))];
        let plant = self.plant.with_changes(changes.chain(own));
        plant.map_err(|error| CampaignError::Change { seed, error })
    }

    /// Returns when a run of this plant ends.
    pub(crate) fn end(&self, plant: &PlantSource) -> Result<Duration, CampaignError> {
        let end = self.until.or(plant.plan().duration);
        end.ok_or(CampaignError::NoDuration)
    }

    /// Runs the plant with this seed, in virtual time.
    ///
    /// # Errors
    /// When a value does not fit, the plant does not start, it is not known how long it is to run, or there is no room for what is
    /// measured.
    pub fn run(&self, seed: u64) -> Result<CampaignRun, CampaignError> {
        let limit = if self.measures.is_empty() {
            0
        } else {
            Trace::USUAL_LIMIT
        };
        Ok(self.run_kept(seed, limit)?.0)
    }

    /// The same; returns the trace of the run too, of about `limit` octets at most.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_kept(
        &self,
        seed: u64,
        limit: usize,
    ) -> Result<(CampaignRun, PlantSource, Option<Trace>), CampaignError> {
        let (plant, variables) = self.plant(seed)?;
        let end = self.end(&plant)?;
        let (results, digest, trace) = run(&plant, seed, end, limit)?;
        let measure = |(name, measure): &(String, Measure)| {
            let number = trace.as_ref().map_or(Ok(None), |trace| measure.of(trace));
            let number = number.map_err(|error| CampaignError::Measure { seed, error })?;
            Ok::<_, CampaignError>((name.clone(), number))
        };
        let run = CampaignRun {
            seed,
            variables,
            results,
            measures: self.measures.iter().map(measure).collect::<Result<_, _>>()?,
            digest: format!("{digest:016x}"),
            end: end.as_secs_f64(),
        };
        Ok((run, plant, trace))
    }
}

/// Runs a plant in virtual time and returns what came of its expectations, the digest of the run, and its trace where there is room
/// for one.
pub(crate) fn run(
    plant: &PlantSource,
    seed: u64,
    end: Duration,
    limit: usize,
) -> Result<(Vec<ExpectationResult>, u64, Option<Trace>), CampaignError> {
    let plan = plant.plan();
    let mut world = World::new(plan).map_err(|error| CampaignError::World {
        seed,
        error: Box::new(error),
    })?;
    if limit > 0 {
        world.keep_trace(limit);
    }
    world.expect(&plan.expectations, plan.seed);
    world.run_until(Instant::ZERO + end, &mut drop);
    let (results, digest) = (world.finish_expectations(), world.digest());
    Ok((results, digest, world.take_trace()))
}

impl fmt::Display for CampaignRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let failed = self.results.iter().filter(|result| !result.is_met()).count();
        write!(
            f,
            "seed {}: {failed} of {} not met",
            self.seed,
            self.results.len()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uniform(low: &str, high: &str) -> Distribution {
        Distribution::Uniform(Bounds::new(&low.parse().unwrap(), &high.parse().unwrap()).unwrap())
    }

    fn number(value: &toml::Value) -> f64 {
        value.as_float().unwrap()
    }

    #[test]
    fn values_of_one_kind_have_a_form() {
        let of = |values: Vec<toml::Value>| Distribution::Choice(values).form();
        let number = |unit: &str| ValueForm::Number(unit.to_owned());
        assert_eq!(of(vec![true.into(), false.into()]), ValueForm::Flag);
        assert_eq!(of(vec![1.into(), 2.into()]), ValueForm::Integer);
        assert_eq!(of(vec![1.into(), 2.5.into()]), number(""));
        assert_eq!(of(vec!["1Nm".into(), "0.2Nm".into()]), number("Nm"));
        assert_eq!(of(vec!["1Nm".into(), "0.2mNm".into()]), ValueForm::Text);
        assert_eq!(of(vec!["akd".into(), "vlt".into()]), ValueForm::Text);
        let listed = Distribution::Listed {
            values: vec![1.into(), 0.5.into()],
            place: 1,
        };
        assert_eq!(
            (listed.form(), listed.draw(7, "x")),
            (number(""), Some(0.5.into()))
        );
        let bounds = Bounds::new(&"1ms".parse().unwrap(), &"2ms".parse().unwrap()).unwrap();
        assert_eq!(Distribution::Uniform(bounds).form(), number("ms"));
    }

    #[test]
    fn draws_depend_on_seed_and_path_alone_and_are_spread() {
        let friction = uniform("1", "3");
        assert_eq!(friction.draw(7, "a"), friction.draw(7, "a"));
        assert_ne!(friction.draw(7, "a"), friction.draw(7, "b"));
        assert_ne!(friction.draw(7, "a"), friction.draw(8, "a"));
        let drawn: Vec<f64> = (0..4000)
            .filter_map(|seed| friction.draw(seed, "drive.akd-1.load.friction"))
            .map(|value| number(&value))
            .collect();
        assert!(drawn.iter().all(|value| (1.0..3.0).contains(value)));
        let mean = drawn.iter().sum::<f64>() / drawn.len() as f64;
        assert!((mean - 2.0).abs() < 0.03, "{mean}");
        let normal = Distribution::normal(&"5".parse().unwrap(), &"2".parse().unwrap()).unwrap();
        let drawn: Vec<f64> = (0..4000)
            .filter_map(|seed| normal.draw(seed, "x"))
            .map(|value| number(&value) - 5.0)
            .collect();
        let deviation = (drawn.iter().map(|value| value * value).sum::<f64>() / drawn.len() as f64).sqrt();
        assert!((deviation - 2.0).abs() < 0.1, "{deviation}");
    }

    #[test]
    fn values_keep_their_unit_and_a_choice_is_one_of_its_values() {
        let load = uniform("0.2Nm", "0.8Nm").draw(1, "x").unwrap();
        assert!(load.as_str().is_some_and(|text| text.ends_with("Nm")), "{load}");
        let values = ["1%", "2%"].map(|text| toml::Value::String(text.into()));
        let choice = Distribution::Choice(values.to_vec());
        let drawn: Vec<_> = (0..50).filter_map(|seed| choice.draw(seed, "x")).collect();
        assert!(values.iter().all(|value| drawn.contains(value)) && drawn.len() == 50);
        assert_eq!(Distribution::Choice(Vec::new()).draw(1, "x"), None);
        let wrong =
            |low: &str, high: &str| Bounds::new(&low.parse().unwrap(), &high.parse().unwrap()).is_err();
        assert!(wrong("1Nm", "2A") && wrong("2", "1"));
    }

    #[test]
    fn a_value_that_does_not_fit_names_the_seed() {
        let plant: PlantSource = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\""
            .parse()
            .unwrap();
        let campaign = Campaign::new(plant.clone()).vary("drive.akd-2.load.friction", uniform("0", "1"));
        let error = campaign.run(3).unwrap_err().to_string();
        assert!(
            error.starts_with("seed 3: ") && error.contains("akd-2"),
            "{error}"
        );
        assert!(matches!(
            Campaign::new(plant).run(3),
            Err(CampaignError::NoDuration)
        ));
    }
}
