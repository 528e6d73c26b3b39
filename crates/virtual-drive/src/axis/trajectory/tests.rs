//! The reference stays within its bounds for any goal, and arrives.

use proptest::prelude::*;

use super::*;

const REV: i64 = 1 << 32;
const FREE: [f64; 2] = [10_000.0, 10_000.0];
const DT: f64 = 0.001;

fn manner(acceleration: f64, deceleration: f64, smoothing: Option<f64>) -> Manner {
    Manner {
        ramps: Ramps {
            acceleration,
            deceleration,
        },
        smoothing,
        limits: FREE,
    }
}

fn to(target: i64, speed: f64) -> Goal {
    Goal::To {
        target,
        speed,
        end_speed: 0.0,
    }
}

/// Checks at every step that the reference stays within its bounds; all in rpm.
struct Watch {
    trajectory: Trajectory,
    position: i64,
    speed: f64,
    acceleration: f64,
}

impl Watch {
    fn new() -> Self {
        Self {
            trajectory: Trajectory::new(0),
            position: 0,
            speed: 0.0,
            acceleration: 0.0,
        }
    }

    /// One step; speeds and slopes may be as high as these, apart from rounding.
    fn step(&mut self, dt: f64, top: f64, manner: &Manner) {
        let mean = self.trajectory.step(dt) / COUNTS;
        let now = &self.trajectory;
        let moved = now.position().wrapping_sub(self.position) as f64 / COUNTS / dt;
        assert!(
            (moved - mean).abs() < 1e-4,
            "the mean speed is that of the way: {moved} {mean}"
        );
        let slack = 1e-6 * (1.0 + top);
        assert!(
            mean.abs() <= top + slack && now.speed().abs() <= top + slack,
            "{mean} {}",
            now.speed()
        );
        // Slope of the step: towards standstill the one ramp, away from it the other.
        let slope = (now.speed() - self.speed) / dt;
        let Ramps {
            acceleration,
            deceleration,
        } = manner.ramps;
        let up = now.speed().abs() > self.speed.abs() && now.speed() * self.speed >= 0.0;
        let through = now.speed() * self.speed < 0.0;
        let most = if through {
            acceleration.max(deceleration)
        } else if up {
            acceleration
        } else {
            deceleration
        };
        let most = if manner.smoothing.is_some() {
            acceleration.max(deceleration)
        } else {
            most
        };
        assert!(
            slope.abs() <= most * (1.0 + 1e-6) + 1e-6,
            "{slope} above {most} at {} rpm",
            now.speed()
        );
        if let Some(time) = manner.smoothing {
            let jerk = (now.acceleration() - self.acceleration).abs() / dt;
            let most = acceleration.max(deceleration) / time;
            assert!(jerk <= most * (1.0 + 1e-6) + 1e-3, "jerk {jerk} above {most}");
        }
        self.position = now.position();
        self.speed = now.speed();
        self.acceleration = now.acceleration();
    }
}

/// Steps until it is there; the number of steps.
fn arrive(watch: &mut Watch, dt: f64, top: f64, manner: &Manner, most: usize) -> usize {
    for number in 0..most {
        if watch.trajectory.is_done() {
            return number;
        }
        watch.step(dt, top, manner);
    }
    panic!("not there after {most} steps: {:?}", watch.trajectory);
}

#[test]
fn a_trapezoid_takes_the_time_of_a_trapezoid() {
    // 10 rev at 600 rpm with 3000 rpm/s: 0.2 s up, 0.2 s down, 1 rev each; 8 rev at 10 rev/s.
    let manner = manner(3000.0, 3000.0, None);
    let mut watch = Watch::new();
    watch.trajectory.aim(to(10 * REV, 600.0), manner);
    let steps = arrive(&mut watch, DT, 600.0, &manner, 5000);
    assert!((1200..=1201).contains(&steps), "{steps}");
    assert_eq!(watch.trajectory.position(), 10 * REV);
    assert_eq!(
        (watch.trajectory.speed(), watch.trajectory.acceleration()),
        (0.0, 0.0)
    );
}

#[test]
fn an_s_curve_takes_the_jerk_time_longer() {
    let manner = manner(3000.0, 3000.0, Some(0.05));
    let mut watch = Watch::new();
    watch.trajectory.aim(to(-10 * REV, 600.0), manner);
    let steps = arrive(&mut watch, DT, 600.0, &manner, 5000);
    assert!((1250..=1251).contains(&steps), "{steps}");
    assert_eq!(watch.trajectory.position(), -10 * REV);
}

#[test]
fn a_short_way_does_not_reach_the_speed() {
    for smoothing in [None, Some(0.05)] {
        let manner = manner(3000.0, 6000.0, smoothing);
        let mut watch = Watch::new();
        watch.trajectory.aim(to(REV / 2, 3000.0), manner);
        let mut top = 0.0_f64;
        for _ in 0..2000 {
            watch.step(DT, 3000.0, &manner);
            top = top.max(watch.trajectory.speed());
        }
        assert!(watch.trajectory.is_done());
        // v^2 = 2 s a d / (a + d) = 2 * 0.5 rev * 2000 rpm/s
        let sharp = (2.0 * 0.5 * 60.0 * 2000.0_f64).sqrt();
        let expected = if smoothing.is_some() {
            0.7 * sharp..0.95 * sharp
        } else {
            0.99 * sharp..sharp + 0.01
        };
        assert!(expected.contains(&top), "{top} {sharp}");
    }
}

#[test]
fn a_target_too_near_to_stop_is_passed_and_come_back_to() {
    for smoothing in [None, Some(0.03)] {
        let manner = manner(3000.0, 3000.0, smoothing);
        let mut watch = Watch::new();
        watch.trajectory.aim(to(100 * REV, 600.0), manner);
        for _ in 0..500 {
            watch.step(DT, 600.0, &manner);
        }
        let near = watch.trajectory.position() + REV / 10;
        watch.trajectory.aim(to(near, 600.0), manner);
        let mut furthest = i64::MIN;
        for _ in 0..1000 {
            watch.step(DT, 600.0, &manner);
            furthest = furthest.max(watch.trajectory.position());
        }
        // 1 rev to stop (and a little more for the jerk), 0.1 rev were left.
        let over = (furthest - near) as f64 / REV as f64;
        assert!((0.89..1.3).contains(&over), "{over}");
        assert!(watch.trajectory.is_done());
        assert_eq!(watch.trajectory.position(), near);
    }
}

/// Accelerates with high jerk, then continues with low jerk: the speed does not overshoot the former target and changes
/// smoothly to the new one.
#[test]
fn a_gentler_manner_does_not_carry_it_beyond_its_speed() {
    let (hard, soft) = (
        manner(36_000.0, 36_000.0, Some(0.015)),
        manner(12_000.0, 12_000.0, Some(0.1)),
    );
    for goal in [
        to(100 * REV, 1800.0),
        Goal::At { speed: 1800.0 },
        to(-5 * REV, 1800.0),
    ] {
        let mut trajectory = Trajectory::new(0);
        trajectory.aim(to(100 * REV, 2200.0), hard);
        while trajectory.speed() < 1500.0 {
            trajectory.step(DT);
        }
        assert!(trajectory.acceleration() > 10_000.0);
        let planned = trajectory.stopping_position(&soft);
        trajectory.aim(goal, soft);
        let (mut top, mut farthest) = (0.0_f64, i64::MIN);
        for _ in 0..3000 {
            trajectory.step(DT);
            top = top.max(trajectory.speed());
            farthest = farthest.max(trajectory.position());
        }
        assert!(top <= 2200.0, "{top}");
        if let Goal::To { target, .. } = goal {
            assert!(trajectory.is_done() || target > REV, "{trajectory:?}");
            assert!(target > REV || (farthest - planned).abs() < REV / 1000);
        }
    }
}

#[test]
fn speed_zero_stops_and_speed_brings_it_on() {
    for smoothing in [None, Some(0.03)] {
        let manner = manner(3000.0, 3000.0, smoothing);
        let mut watch = Watch::new();
        watch.trajectory.aim(to(10 * REV, 600.0), manner);
        (0..400).for_each(|_| watch.step(DT, 600.0, &manner));
        watch.trajectory.aim(to(10 * REV, 0.0), manner);
        (0..300).for_each(|_| watch.step(DT, 600.0, &manner));
        assert_eq!(watch.trajectory.speed(), 0.0);
        assert!(!watch.trajectory.is_done());
        let stopped = watch.trajectory.position();
        (0..300).for_each(|_| watch.step(DT, 0.0, &manner));
        assert_eq!(watch.trajectory.position(), stopped);
        watch.trajectory.aim(to(10 * REV, 600.0), manner);
        arrive(&mut watch, DT, 600.0, &manner, 5000);
        assert_eq!(watch.trajectory.position(), 10 * REV);
    }
}

#[test]
fn a_target_with_an_end_speed_is_passed_at_that_speed() {
    for smoothing in [None, Some(0.03)] {
        for end in [100.0, 600.0, 2000.0] {
            let manner = manner(3000.0, 3000.0, smoothing);
            let goal = Goal::To {
                target: 5 * REV,
                speed: 600.0,
                end_speed: end,
            };
            let mut watch = Watch::new();
            watch.trajectory.aim(goal, manner);
            arrive(&mut watch, DT, 600.0, &manner, 5000);
            let passed = (watch.trajectory.position() - 5 * REV) as f64 / REV as f64;
            assert!((0.0..0.011).contains(&passed), "{passed}");
            assert!((watch.trajectory.speed() - f64::min(end, 600.0)).abs() < 4.0);
            // The motion continues until the next command.
            (0..1000).for_each(|_| watch.step(DT, 600.0, &manner));
            watch.trajectory.aim(
                goal,
                Manner {
                    limits: [1.0, 50.0],
                    ..manner
                },
            );
            (0..1000).for_each(|_| watch.step(DT, 600.0, &manner));
            assert!((watch.trajectory.speed() - 50.0).abs() < 1e-6);
            assert!(watch.trajectory.is_done());
            watch.trajectory.aim(to(5 * REV, 600.0), manner);
            assert!(!watch.trajectory.is_done());
            arrive(&mut watch, DT, 600.0, &manner, 20_000);
            assert_eq!(watch.trajectory.position(), 5 * REV);
        }
    }
}

#[test]
fn an_end_speed_that_the_way_does_not_allow_is_approached() {
    let manner = manner(1000.0, 1000.0, None);
    let mut watch = Watch::new();
    let goal = Goal::To {
        target: REV,
        speed: 600.0,
        end_speed: 600.0,
    };
    watch.trajectory.aim(goal, manner);
    arrive(&mut watch, DT, 600.0, &manner, 5000);
    let expected = (2.0 * 1000.0 * 60.0_f64).sqrt();
    assert!(
        (watch.trajectory.speed() - expected).abs() < 2.0,
        "{}",
        watch.trajectory.speed()
    );
    // Standing at the target there is nothing to pass.
    let mut watch = Watch::new();
    watch.trajectory.aim(
        Goal::To {
            target: 1,
            speed: 600.0,
            end_speed: 600.0,
        },
        manner,
    );
    (0..100).for_each(|_| watch.step(DT, 0.0, &manner));
    assert!(watch.trajectory.is_done());
    assert_eq!(watch.trajectory.position(), 1);
}

#[test]
fn travel_goes_on_and_numbers_stay_fresh() {
    let manner = manner(3000.0, 3000.0, None);
    let mut watch = Watch::new();
    watch.trajectory.aim(Goal::At { speed: -3000.0 }, manner);
    for _ in 0..3000 {
        watch.trajectory.step(1.0);
    }
    assert!(watch.trajectory.is_done());
    // 3000 s at 50 rev/s, less the 25 rev of the ramp
    let expected = -(3000 * 50 - 25) * REV;
    assert!((watch.trajectory.position() - expected).abs() < 1000);
    watch.trajectory.aim(Goal::At { speed: 0.0 }, manner);
    watch.trajectory.step(2.0);
    assert!(watch.trajectory.is_done());
    assert!((watch.trajectory.position() - (expected - 25 * REV)).abs() < 1000);
}

#[test]
fn the_way_over_the_end_of_the_numbers_is_the_short_one() {
    let manner = manner(3000.0, 3000.0, None);
    let mut trajectory = Trajectory::new(i64::MAX - REV);
    trajectory.aim(to(i64::MIN + REV, 600.0), manner);
    for _ in 0..1000 {
        trajectory.step(DT);
    }
    assert!(trajectory.is_done());
    assert_eq!(trajectory.position(), i64::MIN + REV);
    for (start, target) in [
        (0, i64::MIN),
        (0, i64::MAX),
        (i64::MIN, 0),
        (-1, i64::MAX),
        (i64::MIN, i64::MAX),
    ] {
        let mut trajectory = Trajectory::new(start);
        trajectory.aim(to(target, 1e9), manner);
        for _ in 0..1000 {
            trajectory.step(1.0e7);
        }
        assert_eq!(trajectory.position(), target);
    }
}

#[test]
fn nonsense_is_harmless() {
    let odd = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -1.0,
        0.0,
        1e-300,
        1e300,
    ];
    for speed in odd {
        for slope in odd {
            for smoothing in [None, Some(f64::NAN), Some(0.0), Some(1e300)] {
                let manner = Manner {
                    limits: [speed, slope],
                    ..manner(slope, speed, smoothing)
                };
                let mut trajectory = Trajectory::new(0);
                for target in [5, i64::MAX, i64::MIN, 0] {
                    for end_speed in odd {
                        trajectory.aim(
                            Goal::To {
                                target,
                                speed,
                                end_speed,
                            },
                            manner,
                        );
                        for _ in 0..3 {
                            trajectory.step(DT);
                        }
                        trajectory.aim(Goal::At { speed: end_speed }, manner);
                        trajectory.step(DT);
                        assert!(trajectory.speed().is_finite() && trajectory.acceleration().is_finite());
                        assert!(trajectory.speed().abs() <= FASTEST * (1.0 + 1e-9));
                    }
                }
            }
        }
    }
}

#[test]
fn a_shift_moves_no_target() {
    let manner = manner(3000.0, 3000.0, Some(0.02));
    let mut plain = Trajectory::new(0);
    let mut shifted = Trajectory::new(0);
    for number in 0..2000 {
        if number == 300 {
            shifted.shift(i64::MAX - 5);
        }
        let by = if number < 300 { 0 } else { i64::MAX - 5 };
        plain.aim(to(10 * REV, 600.0), manner);
        shifted.aim(to((10 * REV).wrapping_add(by), 600.0), manner);
        assert_eq!(plain.step(DT), shifted.step(DT));
    }
    assert_eq!(shifted.position(), (10 * REV).wrapping_add(i64::MAX - 5));
}

fn slopes() -> impl Strategy<Value = f64> {
    (0.5_f64..6.0).prop_map(|exponent| 10.0_f64.powf(exponent))
}

proptest! {
    /// From standstill: bounds kept, no overshoot, exact arrival, at rest.
    #[test]
    fn from_standstill(
        target in prop_oneof![-500 * REV..500 * REV, -REV..REV, -100_000_i64..100_000],
        speed in 1.0..6000.0_f64,
        acceleration in slopes(),
        deceleration in slopes(),
        smoothing in proptest::option::of(0.001..1.0_f64),
        dt in 0.0003..0.001_f64,
    ) {
        let manner = manner(acceleration, deceleration, smoothing);
        let mut watch = Watch::new();
        watch.trajectory.aim(to(target, speed), manner);
        let mut before = 0;
        // As quick as can be: the time of the trapezoid, and with a jerk limit not much more.
        let way = target.abs() as f64 / REV as f64 * 60.0;
        let slopes = 0.5 * (1.0 / acceleration + 1.0 / deceleration);
        let shortest = if way > speed * speed * slopes {
            way / speed + speed * slopes
        } else {
            2.0 * (way * slopes).sqrt()
        };
        let longest = shortest + 2.0 * smoothing.unwrap_or(0.0) + 1.01 * dt;
        for number in 0..4000 {
            let time = f64::from(number) * dt;
            if watch.trajectory.is_done() {
                prop_assert!(time > shortest - dt && time < longest, "{} {}", time, shortest);
                break;
            }
            prop_assert!(time < longest, "{} {}", time, shortest);
            watch.step(dt, speed, &manner);
            let now = watch.trajectory.position();
            prop_assert!((before..=target).contains(&now) || (target..=before).contains(&now));
            before = now;
        }
        // However long it takes: in large steps to the end.
        for _ in 0..60 {
            watch.trajectory.step(1000.0);
        }
        prop_assert!(watch.trajectory.is_done());
        prop_assert_eq!(watch.trajectory.position(), target);
        prop_assert_eq!(watch.trajectory.speed(), 0.0);
    }

    /// Any goal at any moment: the bounds hold, and the last command is carried out.
    #[test]
    fn on_the_fly(
        moments in proptest::collection::vec(
            (0_usize..400, -20 * REV..20 * REV, 0.0..3000.0_f64, prop_oneof![Just(0.0), 0.0..3000.0_f64], any::<bool>()),
            1..12,
        ),
        acceleration in slopes(),
        deceleration in slopes(),
        smoothing in proptest::option::of(0.001..0.3_f64),
        last in -20 * REV..20 * REV,
    ) {
        let manner = manner(acceleration, deceleration, smoothing);
        let mut watch = Watch::new();
        let mut top;
        for (steps, target, speed, end_speed, travel) in moments {
            let goal = if travel {
                Goal::At { speed: speed.copysign(target as f64) }
            } else {
                Goal::To { target, speed, end_speed }
            };
            watch.trajectory.aim(goal, manner);
            // A lower speed is not reached at once; with a jerk limit the speed even grows while the acceleration ends.
            let grows = smoothing.map_or(0.0, |time| {
                0.5 * watch.acceleration * watch.acceleration * time / acceleration.max(deceleration)
            });
            top = (watch.speed.abs() + grows).max(speed);
            for _ in 0..steps {
                watch.step(DT, top, &manner);
                top = top.max(watch.speed.abs());
            }
        }
        watch.trajectory.aim(to(last, 2500.0), manner);
        let grows = smoothing.map_or(0.0, |time| {
            0.5 * watch.acceleration * watch.acceleration * time / acceleration.max(deceleration)
        });
        top = (watch.speed.abs() + grows).max(2500.0);
        for _ in 0..3000 {
            watch.step(DT, top, &manner);
        }
        for _ in 0..60 {
            watch.trajectory.step(1000.0);
        }
        prop_assert!(watch.trajectory.is_done());
        prop_assert_eq!(watch.trajectory.position(), last);
    }

    /// Ramps, limits and smoothness change too: nothing wilder than the steepest ramp, and it arrives.
    #[test]
    fn everything_changes(
        moments in proptest::collection::vec(
            (0_usize..200, -20 * REV..20 * REV, 0.0..3000.0_f64, slopes(), slopes(), proptest::option::of(0.001..0.3_f64)),
            1..12,
        ),
        last in -20 * REV..20 * REV,
    ) {
        let mut trajectory = Trajectory::new(0);
        let mut before = 0.0;
        let mut steepest = 0.0_f64;
        for (steps, target, speed, acceleration, deceleration, smoothing) in moments {
            trajectory.aim(to(target, speed), manner(acceleration, deceleration, smoothing));
            steepest = steepest.max(acceleration).max(deceleration);
            for _ in 0..steps {
                trajectory.step(DT);
                let slope = (trajectory.speed() - before) / DT;
                prop_assert!(slope.abs() <= steepest * (1.0 + 1e-6), "{} {}", slope, steepest);
                // The acceleration ends within the smoothing time: not much more speed than requested comes of it.
                let most = 3000.0 + 0.5 * 0.3 * steepest;
                prop_assert!(trajectory.speed().abs() <= most, "{}", trajectory.speed());
                before = trajectory.speed();
            }
        }
        trajectory.aim(to(last, 3000.0), manner(1000.0, 1000.0, Some(0.1)));
        for _ in 0..60 {
            trajectory.step(1000.0);
        }
        prop_assert!(trajectory.is_done());
        prop_assert_eq!(trajectory.position(), last);
    }
}
