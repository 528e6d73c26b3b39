//! Status of positioning: ZSW1 bits 8 and 10 to 14, DRV.MOTIONSTAT, AKTSATZ, warnings.
//!
//! Source: AKD manual 5.5 and 5.10.3; bits of DRV.MOTIONSTAT from the AKD Parameter Guide 12/2009.

use profile::state::{PositionFacts, PositionState, Zsw1};

use super::task::Refusal;
use super::{MDI, Positioning, Seen, Setup};
use crate::drive::{Drive, Mode, Service};

/// DRV.MOTIONSTAT, see `data/akd/meanings.csv`.
mod bit {
    pub const TASK_ACTIVE: i64 = 1;
    pub const HOME_FOUND: i64 = 1 << 1;
    pub const HOMING_FINISHED: i64 = 1 << 2;
    pub const HOMING_ACTIVE: i64 = 1 << 3;
    pub const HOMING_ERROR: i64 = 1 << 4;
    pub const STOPPING: i64 = 1 << 7;
    pub const SERVICE: i64 = 1 << 9;
    pub const NOT_ACTIVATED: i64 = 1 << 10;
    pub const REACHED: i64 = 1 << 11;
    pub const SPEED_REACHED: i64 = 1 << 12;
    pub const EXCEPTION: i64 = 1 << 13;
    pub const CROSSED: i64 = 1 << 14;
    pub const IN_WINDOW: i64 = 1 << 15;
}

/// Warnings that positioning raises, each with the bit of its place here in [`Flags`].
const WARNINGS: [u16; 14] = [
    107, 108, 153, 154, 157, 158, 159, 160, 161, 163, 164, 165, 168, 169,
];
const NO_TABLE: u16 = 170;

/// Above and below the software limits.
const ABOVE: u16 = 107;
const BELOW: u16 = 108;
/// The speed of a task is above that of the drive.
const SLOWED: u16 = 153;
/// The following task cannot run.
const NOT_FOLLOWED: u16 = 154;
/// Homing failed.
const HOMING_FAILED: u16 = 161;
/// Warnings that belong to homing.
const OF_HOMING: [u16; 3] = [157, 158, HOMING_FAILED];

/// Set of warnings: bits by place in [`WARNINGS`], the highest one [`NO_TABLE`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Warnings(u32);

impl Warnings {
    fn of(number: u16) -> Self {
        let place = WARNINGS.iter().position(|known| *known == number);
        Self(1 << place.unwrap_or(WARNINGS.len()))
    }

    fn set(&mut self, number: u16, on: bool) {
        let bit = Self::of(number).0;
        self.0 = if on { self.0 | bit } else { self.0 & !bit };
    }

    /// Numbers that exactly one of two sets has, with the value in the first set.
    fn differing(self, other: Self) -> impl Iterator<Item = (u16, bool)> {
        let numbers = WARNINGS.into_iter().chain([NO_TABLE]).enumerate();
        numbers
            .filter(move |(place, _)| (self.0 ^ other.0) >> place & 1 != 0)
            .map(move |(place, number)| (number, self.0 >> place & 1 != 0))
    }
}

/// What has happened and is still to be reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::drive) struct Flags {
    /// Bits 1, 2 and 4 of DRV.MOTIONSTAT.
    pub found: bool,
    finished: bool,
    pub homing_failed: bool,
    /// Bits 10, 13 and 14.
    not_activated: bool,
    pub exception: bool,
    pub crossed: bool,
    warnings: Warnings,
    /// As the drive shows them.
    shown: Warnings,
}

impl Flags {
    /// A task began.
    pub fn started(&mut self, slowed: bool) {
        let homing = OF_HOMING
            .into_iter()
            .fold(0, |bits, number| bits | Warnings::of(number).0);
        self.warnings.0 &= homing;
        self.warnings.set(SLOWED, slowed);
        self.not_activated = false;
        self.exception = false;
        self.crossed = false;
    }

    /// A task cannot run.
    pub fn refuse(&mut self, refusal: Refusal) {
        self.not_activated = true;
        self.warnings.set(refusal.warning(), true);
    }

    /// The task after the running one cannot run.
    pub fn not_followed(&mut self) {
        self.not_activated = true;
        self.warnings.set(NOT_FOLLOWED, true);
    }

    pub fn homing_begins(&mut self) {
        self.warnings = Warnings::default();
        self.found = false;
        self.finished = false;
        self.homing_failed = false;
        self.not_activated = false;
    }

    /// Homing was aborted, or failed with a warning.
    pub fn homing_ends(&mut self, failure: Option<u16>) {
        self.found = false;
        if let Some(number) = failure {
            self.homing_failed = true;
            self.warnings.set(number, true);
        }
    }

    /// Homing was requested and cannot run.
    pub fn homing_refused(&mut self) {
        self.homing_failed = true;
        self.warnings.set(HOMING_FAILED, true);
    }

    pub fn homed(&mut self) {
        self.found = true;
        self.finished = true;
        self.homing_failed = false;
    }

    /// Nothing of a task that was running is left to be reported.
    pub fn leave(&mut self) {
        self.warnings.set(SLOWED, false);
    }
}

impl Positioning {
    /// Returns whether the position is in the target window, if there is a target: that of the running task, else the
    /// one reached last.
    fn is_in_window(&self, position: i64, setup: &Setup) -> bool {
        let target = self.run.map(|run| run.leg.target).or(self.target);
        target.is_some_and(|target| {
            position.wrapping_sub(target).unsigned_abs() <= setup.target_window.unsigned_abs()
        })
    }

    /// Returns the number of the task that runs or waits, as in AKTSATZ: 0 for none, bit 15 for MDI.
    pub fn running_task(&self) -> u16 {
        match (self.machine.state().has_task(), self.run) {
            // Task 0 is that of MDI, also when it is started in another way.
            (true, Some(run)) if run.leg.number & MDI != 0 || run.leg.number == 0 => MDI,
            (true, Some(run)) => run.leg.number,
            _ => 0,
        }
    }
}

impl Drive {
    fn position_facts(&self) -> PositionFacts {
        let setup = &self.settings.position;
        let positioning = &self.positioning;
        let seen = Seen::new(&self.axis, self.settings.standstill);
        let following = seen.following.unsigned_abs();
        let over = positioning.run.is_none() || positioning.finished;
        PositionFacts {
            in_range: setup
                .error_window
                .is_none_or(|window| following <= window.unsigned_abs()),
            reached: over && positioning.target.is_some() && positioning.is_in_window(seen.position, setup),
            homed: positioning.homed,
            standstill: seen.standing,
        }
    }

    /// Bits 8 and 10 to 14 of ZSW1.
    pub(in crate::drive) fn position_status(&self) -> Zsw1 {
        self.positioning.machine.status(&self.position_facts())
    }

    /// DRV.MOTIONSTAT.
    pub(in crate::drive) fn motion_status(&self) -> i64 {
        let setup = &self.settings.position;
        let positioning = &self.positioning;
        let flags = &positioning.flags;
        let state = positioning.state();
        let task = state.is_some_and(PositionState::has_task);
        let leg = positioning.run.filter(|_| task).map(|run| run.leg);
        let at_speed =
            leg.is_some_and(|leg| (self.axis.measured_speed().abs() - leg.speed).abs() <= setup.speed_window);
        let position = self.axis.position();
        let positions = self.settings.mode == Mode::Position;
        let reached = positions && self.position_status().has(Zsw1::REACHED);
        let bits = [
            (bit::TASK_ACTIVE, task),
            (bit::HOME_FOUND, flags.found),
            (bit::HOMING_FINISHED, flags.finished),
            (bit::HOMING_ACTIVE, state == Some(PositionState::Homing)),
            (bit::HOMING_ERROR, flags.homing_failed),
            (bit::STOPPING, self.is_quick_stopping()),
            (
                bit::SERVICE,
                self.service != Service::Off || state.is_some_and(PositionState::is_jogging),
            ),
            (bit::NOT_ACTIVATED, flags.not_activated),
            (bit::REACHED, reached),
            (bit::SPEED_REACHED, at_speed),
            (bit::EXCEPTION, flags.exception),
            (bit::CROSSED, flags.crossed),
            (bit::IN_WINDOW, positioning.is_in_window(position, setup)),
        ];
        bits.into_iter()
            .filter(|(_, on)| *on)
            .fold(0, |word, (bit, _)| word | bit)
    }

    /// SWLS.STATE.
    pub(in crate::drive) fn software_limits(&self) -> i64 {
        let limits = self.positioning.limits(&self.settings.position);
        // The commanded position stands still where the actual one trembles.
        limits.state(self.axis.position_command())
    }

    /// Shows the warnings of positioning that came, and takes back those that went.
    pub(in crate::drive) fn position_warnings(&mut self) {
        let state = self.software_limits();
        let flags = &mut self.positioning.flags;
        flags.warnings.set(BELOW, state & 1 != 0);
        flags.warnings.set(ABOVE, state & 2 != 0);
        let (wanted, shown) = (flags.warnings, flags.shown);
        if wanted == shown {
            return;
        }
        flags.shown = wanted;
        for (number, active) in wanted.differing(shown) {
            self.warn(number, active);
        }
    }
}
