//! Pieces of constant jerk, strung together: what the trajectory follows.
//!
//! Lengths are in 2^-32 revolutions and times in seconds; nothing here depends on the direction in the plant: the signs
//! of speed and acceleration are those of the position.

/// Most pieces of one plan: the end of an acceleration (1), a stop (6), a way up (3), the cruise (1), a way down (3) and
/// what follows (1).
const MOST: usize = 15;

/// Most jerk there is, 2^-32 rev/s^3: far above all that is requested, far below what floating point takes.
const HARDEST: f64 = 1.0e30;

/// Halvings when the highest speed of a smooth movement is looked for.
const HALVINGS: usize = 52;

/// Position, speed and acceleration at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct State {
    pub position: f64,
    pub speed: f64,
    pub acceleration: f64,
}

/// What a plan keeps to; all positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    /// Away from standstill.
    pub acceleration: f64,
    /// Towards standstill.
    pub deceleration: f64,
    /// Change of acceleration; none: accelerations change at once.
    pub jerk: Option<f64>,
}

/// A time of constant jerk.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Piece {
    duration: f64,
    start: State,
    jerk: f64,
}

impl Piece {
    fn at(&self, time: f64) -> State {
        let State {
            position,
            speed,
            acceleration,
        } = self.start;
        let half = 0.5 * self.jerk * time;
        State {
            position: position + time * (speed + time * (0.5 * acceleration + half * (1.0 / 3.0))),
            speed: speed + time * (acceleration + half),
            acceleration: acceleration + self.jerk * time,
        }
    }
}

/// A plan: pieces one after the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Profile {
    pieces: [Piece; MOST],
    count: usize,
    end: State,
}

impl Default for Profile {
    fn default() -> Self {
        Self::new(State::default())
    }
}

impl Profile {
    /// Creates an empty plan at a state.
    pub fn new(start: State) -> Self {
        Self {
            pieces: [Piece::default(); MOST],
            count: 0,
            end: start,
        }
    }

    /// Removes all pieces and starts at a state.
    pub const fn restart(&mut self, start: State) {
        self.count = 0;
        self.end = start;
    }

    /// State after the last piece.
    pub const fn end(&self) -> State {
        self.end
    }

    /// State `time` seconds after the start of piece `number`, which `time` is carried over from; moves both on.
    pub fn follow(&self, number: &mut usize, time: &mut f64) -> State {
        while let Some(piece) = self.pieces.get(*number).filter(|_| *number < self.count) {
            if *time < piece.duration {
                return piece.at(*time);
            }
            *time -= piece.duration;
            *number += 1;
        }
        self.end
    }

    /// Returns true when nothing comes after piece `number`.
    pub const fn is_over(&self, number: usize) -> bool {
        number >= self.count
    }

    /// Returns true when nothing but one speed comes from piece `number` on.
    pub fn is_steady(&self, number: usize) -> bool {
        self.is_over(number)
            || self
                .pieces
                .get(number)
                .is_some_and(|piece| piece.duration == f64::INFINITY)
    }

    /// Goes on with this acceleration and jerk.
    fn push(&mut self, duration: f64, acceleration: f64, jerk: f64) {
        if duration.is_nan() || duration <= 0.0 {
            self.end.acceleration = acceleration;
            return;
        }
        let Some(piece) = self.pieces.get_mut(self.count) else {
            return;
        };
        *piece = Piece {
            duration,
            start: State {
                acceleration,
                ..self.end
            },
            jerk,
        };
        self.end = piece.at(duration);
        self.count += 1;
    }

    /// Ends the acceleration with this jerk.
    pub fn relax(&mut self, jerk: f64) {
        let acceleration = self.end.acceleration;
        self.push(
            acceleration.abs() / jerk,
            acceleration,
            -jerk.copysign(acceleration),
        );
        self.end.acceleration = 0.0;
    }

    /// Keeps the present speed.
    pub fn cruise(&mut self, duration: f64) {
        self.push(duration, 0.0, 0.0);
        self.end.acceleration = 0.0;
    }

    /// Keeps the present speed for ever.
    pub fn go_on(&mut self) {
        if let Some(piece) = self.pieces.get_mut(self.count) {
            self.end.acceleration = 0.0;
            *piece = Piece {
                duration: f64::INFINITY,
                start: self.end,
                jerk: 0.0,
            };
            self.count += 1;
        }
    }

    /// Goes to a speed and no acceleration; through standstill when it lies on the other side.
    pub fn change(&mut self, speed: f64, bounds: &Bounds) {
        if self.end.speed * speed < 0.0 {
            self.change(0.0, bounds);
        }
        match bounds.jerk {
            None => self.change_at_once(speed, bounds),
            Some(jerk) => self.change_smoothly(speed, bounds, jerk),
        }
        self.end.speed = speed;
        self.end.acceleration = 0.0;
    }

    /// Goes `way` ahead, not faster than `top`, and is at `end` speed there (not above `top`) where the way allows it.
    /// All three have one sign; so has the present speed, or it is 0. The way is long enough to stop in, unless there is
    /// an end speed.
    pub fn travel(&mut self, way: f64, top: f64, end: f64, bounds: &Bounds) {
        let start = self.end;
        let sign = way.signum();
        let (way, highest) = (way.abs(), top.abs());
        let end = |peak: f64| end.abs().min(peak);
        let mut trial = *self;
        let mut needed = |peak: f64| {
            trial.restart(start);
            trial.change(sign * peak, bounds);
            sign * (trial.end.position - start.position) + way_between(peak, end(peak), bounds)
        };
        let mut peak = highest;
        let mut spare = way - needed(peak);
        if spare < 0.0 {
            // Too near for the highest speed: the one that just fits.
            peak = if bounds.jerk.is_some() {
                let mut low = end(start.speed.abs());
                let mut high = highest;
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    if needed(middle) <= way {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                low
            } else {
                let Bounds {
                    acceleration: up,
                    deceleration: down,
                    ..
                } = *bounds;
                let begin = start.speed * start.speed;
                let last = end(highest) * end(highest);
                let peak = (2.0 * up * down * way + down * begin + up * last) / (up + down);
                let single = begin + 2.0 * up * way;
                if peak < last { single.min(last) } else { peak }
                    .sqrt()
                    .min(highest)
            };
            spare = way - needed(peak);
        }
        self.change(sign * peak, bounds);
        if spare > 0.0 && peak > 0.0 {
            self.cruise(spare / peak);
        }
        self.change(sign * end(peak), bounds);
    }

    fn change_at_once(&mut self, speed: f64, bounds: &Bounds) {
        let missing = speed - self.end.speed;
        let slope = if speed.abs() > self.end.speed.abs() {
            bounds.acceleration
        } else {
            bounds.deceleration
        };
        self.push(missing.abs() / slope, slope.copysign(missing), 0.0);
    }

    fn change_smoothly(&mut self, speed: f64, bounds: &Bounds, jerk: f64) {
        let (before, now) = (self.end.speed, self.end.acceleration);
        // The sign of the speed while it changes; at standstill the sign of the acceleration.
        let side = [before, speed, now]
            .into_iter()
            .find(|value| *value != 0.0)
            .unwrap_or(1.0);
        // Braking never turns into going back, also when the jerk was higher before.
        let jerk = if now * before < 0.0 {
            jerk.max((0.5 * now * now / before.abs()).min(HARDEST))
        } else {
            jerk
        };
        // Speed that is left when the acceleration just ends.
        let left = before + 0.5 * now * now.abs() / jerk;
        let sign = if speed >= left { 1.0 } else { -1.0 };
        let most = if sign * side > 0.0 {
            bounds.acceleration
        } else {
            bounds.deceleration
        };
        let way = sign * (speed - before);
        let begin = sign * now;
        let peak = (jerk * way + 0.5 * begin * begin).max(0.0).sqrt().min(most);
        // An acceleration above the limit comes down to it first; then up or down to the peak, along it, and to zero.
        self.push(
            (begin - peak).abs() / jerk,
            now,
            jerk.copysign(sign * (peak - begin)),
        );
        let rest = way - sign * (self.end.speed - before) - 0.5 * peak * peak / jerk;
        if rest > 0.0 && peak > 0.0 {
            self.push(rest / peak, sign * peak, 0.0);
        }
        self.push(peak / jerk, sign * peak, -sign * jerk);
    }
}

/// Way from one speed to another, both without acceleration and on the same side of standstill.
pub(super) fn way_between(from: f64, to: f64, bounds: &Bounds) -> f64 {
    let slope = if to.abs() > from.abs() {
        bounds.acceleration
    } else {
        bounds.deceleration
    };
    let change = (to - from).abs();
    let time = match bounds.jerk {
        None => change / slope,
        Some(jerk) if change * jerk >= slope * slope => change / slope + slope / jerk,
        Some(jerk) => 2.0 * (change / jerk).sqrt(),
    };
    0.5 * (from + to) * time
}
