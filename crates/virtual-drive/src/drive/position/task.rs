//! Motion tasks: contents of a task and the table of tasks.

use crate::axis::Ramps;

/// Tasks 1 to 128; 0 is the one that MDI fills.
pub(in crate::drive) const MOST_TASKS: usize = 129;

/// One motion task.
/// Source: AKD MT.P, MT.V, MT.ACC, MT.DEC, MT.CNTL, MT.MTNEXT, MT.TNEXT, MT.TNUM.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(in crate::drive) struct Task {
    /// Target or distance, 2^-32 revolutions.
    pub position: i64,
    /// rpm
    pub speed: f64,
    /// rpm/s; deceleration beside it.
    pub acceleration: f64,
    pub deceleration: f64,
    /// MT.CNTL.
    pub control: u32,
    /// Number of the task that follows.
    pub next: u8,
    /// Time before it, ms.
    pub dwell: u16,
    /// Number of the profile table.
    pub profile: u8,
}

/// What MT.P counts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drive) enum Kind {
    /// Zero.
    Absolute,
    /// The commanded position (PL.CMD).
    FromCommand,
    /// The target of the task before.
    FromTarget,
    /// The actual position (PL.FB).
    FromFeedback,
}

/// When the following task starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drive) enum Follow {
    /// At once after stopping.
    AtOnce,
    /// After stopping and the dwell.
    Dwell,
    /// After stopping and an event.
    Event,
    /// After stopping, the dwell and an event.
    DwellAndEvent,
    /// After stopping and the dwell or an event, whatever comes first.
    DwellOrEvent,
    /// On the fly: the target is passed at the speed of this task.
    PresentSpeed,
    /// On the fly: the target is passed at the speed of the next task.
    NextSpeed,
}

/// MT.CNTL bits 0 to 3; the other codes are reserved or need a latched position that this drive has not.
/// Source: AKD MT.CNTL.
const KINDS: [(u32, Kind); 4] = [
    (0b0000, Kind::Absolute),
    (0b0001, Kind::FromCommand),
    (0b0011, Kind::FromTarget),
    (0b0111, Kind::FromFeedback),
];

/// MT.CNTL bits 5 to 9; other codes do not exist.
/// Source: AKD MT.CNTL.
const FOLLOWS: [(u32, Follow); 7] = [
    (0b00000, Follow::AtOnce),
    (0b00001, Follow::Dwell),
    (0b00010, Follow::Event),
    (0b00011, Follow::DwellAndEvent),
    (0b00111, Follow::DwellOrEvent),
    (0b10000, Follow::PresentSpeed),
    (0b11000, Follow::NextSpeed),
];

/// MT.CNTL bit 4: a following task is executed.
pub(in crate::drive) const FOLLOWED: u32 = 1 << 4;
/// MT.CNTL bit 13: new tasks are refused while this one runs.
pub(in crate::drive) const EXCLUSIVE: u32 = 1 << 13;
/// MT.CNTL bit 14: starts only while another task moves.
pub(in crate::drive) const FLYING_ONLY: u32 = 1 << 14;
/// MT.CNTL bits 15 to 31: reserved, and a speed from an analog input, which this drive has not.
const UNUSABLE: u32 = !0 << 15;
/// The only profile table there is: the s-curve.
const SMOOTH: u8 = 0;

/// Why a task cannot run.
/// Source: AKD warnings of `data/akd/faults.csv`; which of them a cause gets where several fit is ours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(in crate::drive) enum Refusal {
    /// The axis is not homed, or has no other motion permitted.
    NotHomed,
    /// Homing, jogging or a stop has the axis.
    Busy,
    /// The running task accepts no other.
    Exclusive,
    /// There is no such task number.
    Number,
    /// The task is empty.
    Empty,
    /// Speed or ramp of 0.
    Values,
    /// MT.CNTL requests something that does not exist.
    Control,
    /// The profile table is not there.
    Profile,
    /// The target lies behind a software limit, or outside the modulo range.
    Range,
    /// A limit switch is touched in this direction.
    Switch,
    /// It may only start while another task moves.
    Standing,
    /// From the present speed its ramp would lead over a software limit.
    TooFast,
}

impl Refusal {
    /// Returns the warning for this rejection.
    pub const fn warning(self) -> u16 {
        match self {
            Self::NotHomed | Self::Busy | Self::Exclusive | Self::Switch => 160,
            Self::Number => 163,
            Self::Empty => 164,
            Self::Values => 159,
            Self::Control => 168,
            Self::Profile => 170,
            Self::Range => 165,
            Self::Standing | Self::TooFast => 169,
        }
    }
}

impl Task {
    /// Returns whether speed and ramps of a task are set.
    pub fn is_empty(&self) -> bool {
        !(self.speed > 0.0 && self.acceleration > 0.0 && self.deceleration > 0.0)
    }

    pub const fn ramps(&self) -> Ramps {
        Ramps {
            acceleration: self.acceleration,
            deceleration: self.deceleration,
        }
    }

    pub const fn has(&self, bit: u32) -> bool {
        self.control & bit != 0
    }

    /// Returns the reference of the position.
    pub fn kind(&self) -> Result<Kind, Refusal> {
        if self.control & UNUSABLE != 0 {
            return Err(Refusal::Control);
        }
        code(&KINDS, self.control & 0xF).ok_or(Refusal::Control)
    }

    /// Returns the number of the following task and when it starts.
    pub fn follow(&self) -> Result<Option<(u8, Follow)>, Refusal> {
        if !self.has(FOLLOWED) {
            return Ok(None);
        }
        let follow = code(&FOLLOWS, self.control >> 5 & 0x1F).ok_or(Refusal::Control)?;
        Ok(Some((self.next, follow)))
    }

    /// Returns true for an s-curve. Source: AKD MT.CNTL bits 10 and 11: 0 trapezoidal, 1 and 3 a profile table.
    pub fn is_smooth(&self) -> Result<bool, Refusal> {
        match self.control >> 10 & 3 {
            0 => Ok(false),
            1 | 3 if self.profile == SMOOTH => Ok(true),
            1 | 3 => Err(Refusal::Profile),
            _ => Err(Refusal::Control),
        }
    }
}

fn code<T: Copy>(table: &[(u32, T)], code: u32) -> Option<T> {
    table
        .iter()
        .find(|(known, _)| *known == code)
        .map(|(_, value)| *value)
}

/// The motion task table, as far as it was ever filled: most drives have none.
#[derive(Clone, PartialEq)]
pub(in crate::drive) struct Tasks(Vec<Task>);

/// What a place of the table is that was never filled.
static EMPTY: Task = Task {
    position: 0,
    speed: 0.0,
    acceleration: 0.0,
    deceleration: 0.0,
    control: 0,
    next: 0,
    dwell: 0,
    profile: 0,
};

impl core::fmt::Debug for Tasks {
    /// Returns the tasks that are not empty, by number.
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let tasks = self.0.iter().enumerate();
        f.debug_map()
            .entries(tasks.filter(|(_, task)| !task.is_empty()))
            .finish()
    }
}

impl Tasks {
    /// Returns all tasks empty.
    pub const fn new() -> Self {
        Self(Vec::new())
    }

    /// Returns the task with this number, empty or not; none for a number that does not exist.
    pub fn at(&self, number: usize) -> Option<&Task> {
        (number < MOST_TASKS).then(|| self.0.get(number).unwrap_or(&EMPTY))
    }

    /// Returns the task with this number.
    pub fn task(&self, number: usize) -> Result<Task, Refusal> {
        match self.at(number) {
            None => Err(Refusal::Number),
            Some(task) if task.is_empty() => Err(Refusal::Empty),
            Some(task) => Ok(*task),
        }
    }

    /// Puts a task into the table; false for a number that does not exist.
    pub fn set(&mut self, number: usize, task: Task) -> bool {
        if number >= MOST_TASKS {
            return false;
        }
        if number >= self.0.len() {
            self.0.resize(number + 1, EMPTY);
        }
        if let Some(place) = self.0.get_mut(number) {
            *place = task;
        }
        true
    }

    /// Empties one task, or all.
    pub fn clear(&mut self, number: Option<usize>) -> bool {
        match number {
            Some(number) => self.set(number, Task::default()),
            None => {
                self.0.clear();
                true
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::AKD;

    fn with(control: u32) -> Task {
        Task {
            position: 1,
            speed: 1.0,
            acceleration: 1.0,
            deceleration: 1.0,
            control,
            next: 7,
            ..Task::default()
        }
    }

    #[test]
    fn every_control_word_is_accepted_or_refused() {
        for control in 0..1 << 17 {
            let task = with(control);
            let kind = match control & 0xF {
                _ if control >> 15 != 0 => None,
                0 => Some(Kind::Absolute),
                1 => Some(Kind::FromCommand),
                3 => Some(Kind::FromTarget),
                7 => Some(Kind::FromFeedback),
                _ => None,
            };
            assert_eq!(task.kind().ok(), kind, "{control:#x}");
            let follow = (control >> 5) & 0x1F;
            let known = [0, 1, 2, 3, 7, 16, 24].contains(&follow);
            match task.follow() {
                Ok(None) => assert_eq!(control & 0x10, 0),
                Ok(Some((next, _))) => assert!(next == 7 && known && control & 0x10 != 0),
                Err(refusal) => assert!(!known && refusal == Refusal::Control),
            }
            assert_eq!(task.is_smooth().is_err(), control & 0xC00 == 0x800);
            assert_eq!(task.is_smooth() == Ok(true), control & 0x400 != 0);
        }
        let other_table = Task {
            profile: 3,
            ..with(0x400)
        };
        assert_eq!(other_table.is_smooth(), Err(Refusal::Profile));
    }

    #[test]
    fn the_table() {
        let mut tasks = Tasks::new();
        assert_eq!(tasks.task(1), Err(Refusal::Empty));
        assert_eq!(tasks.task(129), Err(Refusal::Number));
        assert!(tasks.set(128, with(0)) && tasks.set(1, with(3)) && !tasks.set(129, with(0)));
        assert_eq!(tasks.task(1), Ok(with(3)));
        assert!(tasks.clear(Some(1)) && !tasks.clear(Some(200)));
        assert_eq!(tasks.task(1), Err(Refusal::Empty));
        assert!(tasks.task(128).is_ok() && tasks.clear(None));
        assert!(tasks.task(128).is_err());
    }

    #[test]
    fn every_refusal_has_a_warning_of_the_table() {
        for refusal in [
            Refusal::NotHomed,
            Refusal::Busy,
            Refusal::Exclusive,
            Refusal::Number,
            Refusal::Empty,
            Refusal::Values,
            Refusal::Control,
            Refusal::Profile,
            Refusal::Range,
            Refusal::Switch,
            Refusal::Standing,
            Refusal::TooFast,
        ] {
            assert!(
                AKD.catalogue.fault(refusal.warning(), true).is_some(),
                "{refusal:?}"
            );
        }
    }
}
