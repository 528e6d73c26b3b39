//! A move in engineering units: its telegram values, and the objections to it.

mod facts;
mod modulo;
mod objection;

use core::fmt;

use profile::catalogue::{Catalogue, Scaling};
use profile::notation::{Position, figures};
use profile::telegram::signal;

use super::command::Traverse;
use profile::value::is_other_value;

pub use facts::MotionFacts;
pub use modulo::ModuloRange;
pub use objection::Objection;

/// A move to a position or by a distance.
///
/// ```
/// use profidrive_client::axis::Move;
/// use profile::notation::Position;
/// let order = Move::to(Position::Turns(10.0), 300.0).with_ramps(Some(3000.0), None);
/// assert!(!order.relative);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Where to, or how far.
    pub target: Position,
    /// True when the target is a distance.
    pub relative: bool,
    /// Speed in rpm, positive.
    pub speed: f64,
    /// Acceleration in rpm/s; that of the drive (DRV.ACC) when `None`.
    pub acceleration: Option<f64>,
    /// Deceleration in rpm/s; that of the drive (DRV.DEC) when `None`.
    pub deceleration: Option<f64>,
}

impl Move {
    /// To a position, at this speed in rpm.
    #[must_use]
    pub const fn to(target: Position, speed: f64) -> Self {
        Self {
            target,
            relative: false,
            speed,
            acceleration: None,
            deceleration: None,
        }
    }

    /// By a distance, at this speed in rpm.
    #[must_use]
    pub const fn by(distance: Position, speed: f64) -> Self {
        Self {
            relative: true,
            ..Self::to(distance, speed)
        }
    }

    /// Returns the same with ramps of its own in rpm/s.
    #[must_use]
    pub const fn with_ramps(self, acceleration: Option<f64>, deceleration: Option<f64>) -> Self {
        Self {
            acceleration,
            deceleration,
            ..self
        }
    }
}

/// A move as it will travel, in both views.
#[derive(Debug, Clone, PartialEq)]
pub struct MovePlan {
    /// True when the target of the order is a distance.
    pub relative: bool,
    /// As it travels.
    pub traverse: Traverse,
    /// Where the axis is, in turns.
    pub from: Option<f64>,
    /// Where it will end, in turns; `None` for a distance from an unknown position.
    pub target: Option<f64>,
    /// Speed as the drive will take it, rpm.
    pub speed: f64,
    /// Acceleration as the drive will take it, rpm/s.
    pub acceleration: f64,
    /// Deceleration as the drive will take it, rpm/s.
    pub deceleration: f64,
    /// How long it should take in seconds, where both ends are known.
    pub duration: Option<f64>,
    /// All objections to it.
    pub objections: Vec<Objection>,
}

/// What the axis does, behind its name:
/// `goes from 1.2 rev to 10 rev (655360 counts) at 300 rpm, ramps 3052 and 3052 rpm/s, in about 2.1 s`.
impl fmt::Display for MovePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded = |value: f64| figures((value * 1000.0).round() / 1000.0 + 0.0);
        let rev = |turns: Option<f64>| turns.map_or_else(|| "?".into(), rounded);
        let (from, to, counts) = (rev(self.from), rev(self.target), self.traverse.target);
        if self.relative {
            write!(f, "goes from {from} rev by {counts} counts to {to} rev")?;
        } else {
            write!(f, "goes from {from} rev to {to} rev ({counts} counts)")?;
        }
        let (speed, up, down) = (
            rounded(self.speed),
            figures(self.acceleration),
            figures(self.deceleration),
        );
        write!(f, " at {speed} rpm, ramps {up} and {down} rpm/s")?;
        self.duration
            .map_or(Ok(()), |seconds| write!(f, ", in about {seconds:.1} s"))
    }
}

/// Plans a move: converts engineering units into telegram values, checked against the facts of the drive and the limits
/// of the caller.
///
/// A ramp becomes the nearest step that the drive can take, at least one, which is reported; a target is exact to half
/// an increment. A speed that would become another one ([`MOST_ROUNDING`](profile::value::MOST_ROUNDING)) and a
/// distance that would become none are objections.
#[must_use]
pub fn plan_move(
    order: &Move,
    facts: &MotionFacts,
    tables: &Catalogue,
    scaling: &Scaling,
    speed_limit: f64,
) -> MovePlan {
    let mut objections = Vec::new();
    let per_turn = 2_f64.powi(i32::from(scaling.singleturn_bits.min(32)));
    let exact = order.target.counts(per_turn);
    let counts = exact.round();
    let wire = i32_of(counts);
    if wire.is_none() {
        objections.push(Objection::Range { counts });
    }
    if order.relative && counts == 0.0 && exact != 0.0 {
        objections.push(Objection::NoDistance { counts: exact });
    }
    let wanted = f64::from(wire.unwrap_or(0)) / per_turn;
    let (target, distance) = way(order.relative, wire.map(|_| wanted), facts, &mut objections);
    speed_objections(order.speed, distance, facts, speed_limit, &mut objections);
    let field = |number, value| {
        let parameter = tables.by_pnu(number);
        let raw = parameter.map_or(0, |parameter| parameter.raw(value, scaling));
        let taken = parameter.map_or(0.0, |parameter| parameter.engineering(raw, scaling));
        (raw, taken)
    };
    let (velocity, speed) = field(signal::MDI_VELOCITY, order.speed);
    // without the signal no speed is carried
    let carried = tables.by_pnu(signal::MDI_VELOCITY);
    let value = |raw| carried.map_or(0.0, |parameter| parameter.engineering(raw, scaling));
    objections.extend(speed_on_the_wire(
        order.speed,
        speed_limit,
        (velocity, speed),
        value,
    ));
    let mut ramp = |number, own: Option<f64>, drives: Option<f64>| {
        let [lowest, highest] = [1, i64::from(u16::MAX)].map(|raw| {
            let parameter = tables.by_pnu(number);
            parameter.map_or(0.0, |parameter| parameter.engineering(raw, scaling))
        });
        let wanted = own.or(drives).unwrap_or(lowest);
        if own.is_some_and(|own| !(own > 0.0 && own <= highest)) {
            objections.push(Objection::Ramp {
                ramp: wanted,
                lowest,
                highest,
            });
        }
        let (raw, taken) = field(number, wanted.max(lowest));
        (u16::try_from(raw).unwrap_or(u16::MAX), taken)
    };
    let (acc, acceleration) = ramp(signal::MDI_ACC, order.acceleration, facts.acceleration);
    let (dec, deceleration) = ramp(signal::MDI_DEC, order.deceleration, facts.deceleration);
    position_objections(target, distance, facts, &mut objections);
    let traverse = if order.relative {
        Traverse::relative(wire.unwrap_or(0))
    } else {
        Traverse::absolute(wire.unwrap_or(0))
    };
    MovePlan {
        relative: order.relative,
        traverse: traverse.with_speed(u32::try_from(velocity).unwrap_or(0), acc, dec),
        from: facts.position,
        target,
        speed,
        acceleration,
        deceleration,
        duration: distance.map(|distance| duration(distance, speed, acceleration, deceleration)),
        objections,
    }
}

/// Where a move ends and how far that is, as far as both are known; `wanted` is its target or distance, in turns.
fn way(
    relative: bool,
    wanted: Option<f64>,
    facts: &MotionFacts,
    objections: &mut Vec<Objection>,
) -> (Option<f64>, Option<f64>) {
    // a target that does not fit says nothing about the way there
    let known = wanted.and(facts.position);
    let range = facts.modulo_range.filter(|_| facts.modulo);
    let turns = wanted.unwrap_or(0.0);
    if relative {
        let end = known.map(|position| position + turns);
        let target = range.map_or(end, |range| end.map(|end| range.wrap(end)));
        return (target, known.map(|_| turns));
    }
    if let Some(range) = range.filter(|range| !(range.low..range.high).contains(&turns)) {
        objections.push(Objection::ModuloRange {
            target: turns,
            low: range.low,
            high: range.high,
        });
    }
    let distance = |from| range.map_or(turns - from, |range| range.distance(from, turns));
    (wanted, known.map(distance))
}

/// The objection to a speed that MDI_VELOCITY does not carry, or not as it is. `taken` is its nearest step with its speed,
/// `value` the speed of a step.
fn speed_on_the_wire(
    speed: f64,
    limit: f64,
    (step, taken): (i64, f64),
    value: impl Fn(i64) -> f64,
) -> Option<Objection> {
    let highest = value(1 << 32);
    if speed.is_finite() && speed > highest {
        return Some(Objection::SpeedRange { speed, highest });
    }
    if !(speed > 0.0 && speed <= limit && is_other_value(speed, taken)) {
        return None;
    }
    let other = value(if taken > speed { step - 1 } else { step + 1 });
    Some(Objection::SpeedStep {
        speed,
        nearest: [taken.min(other), taken.max(other)],
    })
}

fn speed_objections(
    speed: f64,
    distance: Option<f64>,
    facts: &MotionFacts,
    limit: f64,
    objections: &mut Vec<Objection>,
) {
    if !(speed > 0.0 && speed.is_finite()) {
        objections.push(Objection::NoSpeed { speed });
        return;
    }
    if speed > limit {
        objections.push(Objection::SpeedLimit { speed, limit });
    }
    let of_drive = match distance {
        Some(distance) if distance < 0.0 => facts.backward_limit,
        Some(_) => facts.forward_limit,
        None => None,
    };
    if let Some(limit) = of_drive.filter(|&limit| speed > limit) {
        objections.push(Objection::DriveLimit { speed, limit });
    }
}

fn position_objections(
    target: Option<f64>,
    distance: Option<f64>,
    facts: &MotionFacts,
    objections: &mut Vec<Objection>,
) {
    if facts.fault == Some(true) {
        objections.push(Objection::Fault);
    }
    if facts.homed == Some(false) {
        objections.push(Objection::NotHomed);
    }
    if facts.feedrate == Some(0.0) {
        objections.push(Objection::Feedrate);
    }
    if let Some(target) = target.filter(|_| !facts.modulo) {
        // limits count once the axis is homed
        if let Some(limit) = facts.highest.filter(|&limit| target > limit) {
            objections.push(Objection::SoftwareLimit {
                target,
                limit,
                upper: true,
            });
        }
        if let Some(limit) = facts.lowest.filter(|&limit| target < limit) {
            objections.push(Objection::SoftwareLimit {
                target,
                limit,
                upper: false,
            });
        }
    }
    for (hit, positive) in [(facts.negative_switch, false), (facts.positive_switch, true)] {
        let further = distance.is_some_and(|distance| distance != 0.0 && (distance > 0.0) == positive);
        if hit == Some(true) && further {
            objections.push(Objection::LimitSwitch { positive });
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "checked against the range first")]
fn i32_of(counts: f64) -> Option<i32> {
    (f64::from(i32::MIN)..=f64::from(i32::MAX))
        .contains(&counts)
        .then_some(counts as i32)
}

/// Seconds of a trapezoid over `distance` turns.
fn duration(distance: f64, speed: f64, acceleration: f64, deceleration: f64) -> f64 {
    let distance = distance.abs();
    let [speed, acceleration, deceleration] = [speed, acceleration, deceleration].map(|value| value / 60.0);
    if speed <= 0.0 || acceleration <= 0.0 || deceleration <= 0.0 {
        return 0.0;
    }
    let ramps = speed * speed / 2.0 * (1.0 / acceleration + 1.0 / deceleration);
    if ramps <= distance {
        (distance - ramps) / speed + speed / acceleration + speed / deceleration
    } else {
        let peak = (2.0 * distance * acceleration * deceleration / (acceleration + deceleration)).sqrt();
        peak / acceleration + peak / deceleration
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::AKD;

    fn facts() -> MotionFacts {
        MotionFacts {
            position: Some(2.0),
            homed: Some(true),
            fault: Some(false),
            forward_limit: Some(3000.0),
            backward_limit: Some(2000.0),
            negative_switch: Some(false),
            positive_switch: Some(false),
            acceleration: Some(3000.0),
            deceleration: Some(1000.0),
            ..MotionFacts::default()
        }
    }

    fn plan(order: &Move, facts: &MotionFacts) -> MovePlan {
        plan_move(order, facts, &AKD, &Scaling::default(), 2500.0)
    }

    fn turns(turns: f64) -> Move {
        Move::to(Position::Turns(turns), 300.0)
    }

    #[test]
    fn engineering_units_become_what_travels() {
        let plan = plan(&turns(10.0).with_ramps(Some(1526.0), None), &facts());
        assert_eq!(plan.objections, []);
        let expected = Traverse::absolute(655_360).with_speed(107_374_182, 2, 1);
        assert_eq!(plan.traverse, expected);
        assert_eq!((plan.target, plan.acceleration), (Some(10.0), 1526.0));
        assert_eq!(plan.deceleration, 763.0, "the nearest step below 1000 rpm/s");
        assert!((plan.speed - 300.0).abs() < 1e-4);
    }

    #[test]
    fn increments_and_distances() {
        let order = Move::by(Position::Counts(-65_536.0), 300.0);
        let plan = plan(&order, &facts());
        assert_eq!((plan.traverse.target, plan.traverse.modus), (-65_536, 0));
        assert_eq!(plan.target, Some(1.0));
        // from an unknown position the limits cannot be watched, the move itself is still known
        let blind = plan_move(&order, &MotionFacts::default(), &AKD, &Scaling::default(), 2500.0);
        assert_eq!(
            (blind.target, blind.duration, blind.objections),
            (None, None, vec![])
        );
    }

    #[test]
    fn a_modulo_axis_has_a_range_and_a_way_to_its_targets() {
        // 0 to 3 rev, either end first; it stands at 2 rev
        let table = |way| MotionFacts {
            modulo: true,
            modulo_range: ModuloRange::new(3.0, 0.0, way),
            ..facts()
        };
        let out_of_range = |target| Objection::ModuloRange {
            target,
            low: 0.0,
            high: 3.0,
        };
        for target in [4.0, 3.0, -0.5] {
            assert_eq!(plan(&turns(target), &table(0)).objections, [out_of_range(target)]);
        }
        assert!(
            out_of_range(4.0)
                .to_string()
                .contains("modulo range of 0.000 to 3.000 rev")
        );
        let by = plan(&Move::by(Position::Turns(2.0), 300.0), &table(0));
        assert_eq!((by.target, by.objections), (Some(1.0), vec![]));
        assert_eq!(by.traverse.target, 131_072);
        // the time shows the direction: 0.25 rev is 1.75 back, 1.25 on
        let seconds = |way| plan(&turns(0.25), &table(way)).duration.unwrap();
        let ramps = (3052.0, 763.0);
        let of = |distance| duration(distance, 300.0, ramps.0, ramps.1);
        for (way, distance) in [(0, 1.75), (1, 1.25), (2, 1.75), (3, 1.25)] {
            assert!(
                (seconds(way) - of(distance)).abs() < 1e-3,
                "{way}: {}",
                seconds(way)
            );
        }
        // a switch in the way counts, one behind does not
        let switch = |way| MotionFacts {
            positive_switch: Some(true),
            ..table(way)
        };
        assert_eq!(plan(&turns(0.25), &switch(0)).objections, []);
        assert_eq!(
            plan(&turns(0.25), &switch(3)).objections,
            [Objection::LimitSwitch { positive: true }]
        );
        assert_eq!(ModuloRange::new(1.0, 1.0, 0), None);
        assert_eq!(ModuloRange::new(f64::NAN, 1.0, 0), None);
        // without a known range nothing is made up
        let unknown = MotionFacts {
            modulo_range: None,
            ..table(0)
        };
        assert_eq!(plan(&turns(4.0), &unknown).objections, []);
    }

    #[test]
    fn the_time_of_a_trapezoid_and_of_a_triangle() {
        assert!((duration(10.0, 300.0, 3000.0, 3000.0) - 2.1).abs() < 1e-9);
        // 0.1 rev at 3000 rpm/s = 50 rev/s^2 both ways: 2 * sqrt(0.1 / 50)
        assert!((duration(-0.1, 3000.0, 3000.0, 3000.0) - 2.0 * (0.1_f64 / 50.0).sqrt()).abs() < 1e-9);
        assert_eq!(duration(1.0, 0.0, 1.0, 1.0), 0.0);
    }

    #[test]
    fn all_objections_to_a_move() {
        use Objection::{
            DriveLimit, Fault, LimitSwitch, NoDistance, NoSpeed, NotHomed, Ramp, Range, SoftwareLimit,
            SpeedLimit, SpeedRange,
        };
        let at = |speed| Move { speed, ..turns(10.0) };
        let with = |change: &dyn Fn(&mut MotionFacts)| {
            let mut facts = facts();
            change(&mut facts);
            facts
        };
        let limits = with(&|facts| (facts.lowest, facts.highest) = (Some(-1.0), Some(9.5)));
        let fast = with(&|facts| facts.forward_limit = None);
        let none: Vec<Objection> = Vec::new();
        for (order, facts, expected) in [
            (
                turns(10.0),
                with(&|facts| facts.homed = Some(false)),
                vec![NotHomed],
            ),
            (
                turns(10.0),
                MotionFacts {
                    homed: Some(false),
                    ..limits
                },
                vec![
                    NotHomed,
                    SoftwareLimit {
                        target: 10.0,
                        limit: 9.5,
                        upper: true,
                    },
                ],
            ),
            (turns(10.0), with(&|facts| facts.homed = None), none.clone()),
            (turns(10.0), with(&|facts| facts.fault = Some(true)), vec![Fault]),
            (
                turns(10.0),
                limits,
                vec![SoftwareLimit {
                    target: 10.0,
                    limit: 9.5,
                    upper: true,
                }],
            ),
            (turns(9.5), limits, none.clone()),
            (
                Move::by(Position::Turns(-3.5), 300.0),
                limits,
                vec![SoftwareLimit {
                    target: -1.5,
                    limit: -1.0,
                    upper: false,
                }],
            ),
            (
                turns(10.0),
                MotionFacts {
                    modulo: true,
                    ..limits
                },
                none.clone(),
            ),
            (
                turns(10.0),
                with(&|facts| facts.positive_switch = Some(true)),
                vec![LimitSwitch { positive: true }],
            ),
            (
                turns(1.0),
                with(&|facts| facts.positive_switch = Some(true)),
                none.clone(),
            ),
            (
                turns(1.0),
                with(&|facts| facts.negative_switch = Some(true)),
                vec![LimitSwitch { positive: false }],
            ),
            (
                turns(40_000.0),
                facts(),
                vec![Range {
                    counts: 2_621_440_000.0,
                }],
            ),
            (
                Move::by(Position::Counts(-0.4), 300.0),
                facts(),
                vec![NoDistance { counts: -0.4 }],
            ),
            (Move::by(Position::Counts(0.0), 300.0), facts(), none.clone()),
            (at(0.0), facts(), vec![NoSpeed { speed: 0.0 }]),
            (at(-5.0), facts(), vec![NoSpeed { speed: -5.0 }]),
            (
                at(2501.0),
                facts(),
                vec![SpeedLimit {
                    speed: 2501.0,
                    limit: 2500.0,
                }],
            ),
            (
                Move {
                    speed: 2001.0,
                    ..turns(0.0)
                },
                facts(),
                vec![DriveLimit {
                    speed: 2001.0,
                    limit: 2000.0,
                }],
            ),
            (at(2001.0), facts(), none),
            (
                at(12_001.0),
                fast,
                vec![
                    SpeedLimit {
                        speed: 12_001.0,
                        limit: 2500.0,
                    },
                    SpeedRange {
                        speed: 12_001.0,
                        highest: 12_000.0,
                    },
                ],
            ),
            (
                turns(10.0).with_ramps(Some(0.0), None),
                facts(),
                vec![Ramp {
                    ramp: 0.0,
                    lowest: 763.0,
                    highest: 50_003_205.0,
                }],
            ),
        ] {
            let found = plan(&order, &facts).objections;
            assert_eq!(found, expected, "{order:?}");
            assert!(
                found
                    .iter()
                    .all(|one| !one.advice().is_empty() && !one.to_string().is_empty())
            );
        }
        // steps of 2.8e-6 rpm
        for speed in [1e-6, 1e-5] {
            let found = plan(&at(speed), &facts()).objections;
            let [
                Objection::SpeedStep {
                    nearest: [below, above],
                    ..
                },
            ] = found[..]
            else {
                panic!("{found:?}")
            };
            assert!(below < speed && speed < above, "{below} {speed} {above}");
        }
        assert!(matches!(
            plan(&at(f64::NAN), &facts()).objections[..],
            [NoSpeed { .. }]
        ));
    }
}
