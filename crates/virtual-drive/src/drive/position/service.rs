//! The parameters and commands of positioning that do something when they are written.

use profile::catalogue::Part;
use profile::parameter::ErrorNumber;
use profile::state::{PositionCommand, PositionState};
use profile::telegram::signal;

use super::task::{MOST_TASKS, Task};
use super::{Seen, homing};
use crate::drive::{Drive, Mode};
use crate::model::Place;

impl Drive {
    /// The telegram selects the source of setpoints (DRV.CMDSOURCE): motion tasks belong to the service channel, speeds
    /// to the field bus. Source: the vendor's note on the command source with PROFINET.
    pub(in crate::drive) fn take_command_source(&mut self) {
        let setpoints = self.process.setpoints();
        let source = if setpoints.has(signal::SATZANW) {
            0
        } else if setpoints.has(signal::NSOLL_A) {
            1
        } else {
            return;
        };
        if let Some(pnu) = self.model.number(Part::CommandSource) {
            self.values.set(pnu, source);
            self.apply();
        }
    }

    fn number_of(&self, part: Part) -> i64 {
        self.model
            .number(part)
            .map_or(0, |number| self.values.get(number))
    }

    fn set_number_of(&mut self, part: Part, raw: i64) {
        if let Some(number) = self.model.number(part) {
            self.values.set(number, raw);
        }
    }

    fn engineering(&self, part: Part) -> f64 {
        let parameter = self.model.catalogue.part(part);
        parameter.map_or(0.0, |parameter| {
            parameter.engineering(self.number_of(part), &self.settings.scaling.kept())
        })
    }

    fn set_engineering(&mut self, part: Part, value: f64) {
        if let Some(parameter) = self.model.catalogue.part(part) {
            let raw = parameter.raw(value, &self.settings.scaling.kept());
            self.set_number_of(part, raw);
        }
    }

    /// MT.SET: the edit values become task MT.NUM of the table. A speed or ramp of 0 makes it an empty one.
    pub(in crate::drive) fn set_task(&mut self) -> Result<(), ErrorNumber> {
        let raw = |part| self.number_of(part);
        let task = Task {
            position: self
                .settings
                .position
                .units
                .counts(self.engineering(Part::TaskPosition)),
            speed: self.engineering(Part::TaskVelocity),
            acceleration: self.engineering(Part::TaskAcceleration),
            deceleration: self.engineering(Part::TaskDeceleration),
            control: raw(Part::TaskControl) as u32,
            next: raw(Part::TaskNext) as u8,
            dwell: raw(Part::TaskDwell) as u16,
            profile: raw(Part::TaskProfile) as u8,
        };
        let number = usize::try_from(raw(Part::TaskNumber)).unwrap_or(MOST_TASKS);
        self.positioning.mdi_in_table &= number != 0;
        if self.positioning.tasks.set(number, task) {
            Ok(())
        } else {
            Err(ErrorNumber::LIMIT)
        }
    }

    /// MT.LOAD: task MT.NUM of the table becomes the edit values; an empty task has zeros.
    pub(in crate::drive) fn load_task(&mut self) -> Result<(), ErrorNumber> {
        let number = usize::try_from(self.number_of(Part::TaskNumber)).unwrap_or(MOST_TASKS);
        let task = *self.positioning.tasks.at(number).ok_or(ErrorNumber::LIMIT)?;
        let position = self.settings.position.units.value(task.position);
        self.set_engineering(Part::TaskPosition, position);
        self.set_engineering(Part::TaskVelocity, task.speed);
        self.set_engineering(Part::TaskAcceleration, task.acceleration);
        self.set_engineering(Part::TaskDeceleration, task.deceleration);
        for (part, raw) in [
            (Part::TaskControl, i64::from(task.control)),
            (Part::TaskNext, i64::from(task.next)),
            (Part::TaskDwell, i64::from(task.dwell)),
            (Part::TaskProfile, i64::from(task.profile)),
        ] {
            self.set_number_of(part, raw);
        }
        Ok(())
    }

    /// MT.CLEAR: empties one task, or with -1 all.
    pub(in crate::drive) fn clear_task(&mut self, raw: i64) -> Result<(), ErrorNumber> {
        let number = match raw {
            -1 => None,
            _ => Some(usize::try_from(raw).map_err(|_| ErrorNumber::LIMIT)?),
        };
        self.positioning.mdi_in_table &= number.is_some_and(|number| number != 0);
        if self.positioning.tasks.clear(number) {
            Ok(())
        } else {
            Err(ErrorNumber::LIMIT)
        }
    }

    /// MT.MOVE: starts a task of the table.
    pub(in crate::drive) fn move_task(&mut self, raw: i64) -> Result<(), ErrorNumber> {
        let number = u16::try_from(raw)
            .ok()
            .filter(|number| usize::from(*number) < MOST_TASKS)
            .ok_or(ErrorNumber::LIMIT)?;
        self.positioning.state().ok_or(ErrorNumber::NOT_NOW)?;
        let seen = Seen::new(&self.axis, self.settings.standstill);
        match self.permit(number, &seen) {
            Ok(_) => {
                self.positioning.wish = Some(PositionCommand::Task);
                self.positioning.wished_task = number;
                Ok(())
            }
            Err(refusal) => {
                self.positioning.flags.refuse(refusal);
                Err(ErrorNumber::NOT_NOW)
            }
        }
    }

    /// MT.CONTINUE: goes on with the task that DRV.STOP interrupted.
    pub(in crate::drive) fn continue_task(&mut self) -> Result<(), ErrorNumber> {
        self.ask(PositionCommand::Continue, &[PositionState::Pause])
    }

    /// HOME.MOVE: starts homing.
    pub(in crate::drive) fn start_homing(&mut self) -> Result<(), ErrorNumber> {
        if !homing::is_known(self.settings.position.home.mode) {
            return Err(ErrorNumber::NOT_NOW);
        }
        self.ask(PositionCommand::Homing, &[PositionState::Basic])
    }

    fn ask(&mut self, command: PositionCommand, states: &[PositionState]) -> Result<(), ErrorNumber> {
        match self.positioning.state() {
            Some(state) if states.contains(&state) => {
                self.positioning.wish = Some(command);
                Ok(())
            }
            _ => Err(ErrorNumber::NOT_NOW),
        }
    }

    /// DRV.STOP in position mode.
    pub(in crate::drive) fn stop_positioning(&mut self) {
        if self.positioning.active {
            self.positioning.wish = Some(PositionCommand::Stop);
        }
    }

    /// HOME.SET: the axis is homed where it stands, and that place is HOME.P; not while it moves.
    pub(in crate::drive) fn set_home(&mut self) -> Result<(), ErrorNumber> {
        let seen = Seen::new(&self.axis, self.settings.standstill);
        let idle = self
            .positioning
            .state()
            .is_none_or(|state| !state.has_task() && !state.is_jogging() && state != PositionState::Homing);
        if !idle || !seen.standing {
            return Err(ErrorNumber::NOT_NOW);
        }
        let by = self.settings.position.home.position.wrapping_sub(seen.command);
        self.axis.shift_position(by);
        let positioning = &mut self.positioning;
        positioning.homed = true;
        positioning.target = positioning.active.then_some(self.settings.position.home.position);
        positioning.flags.homed();
        Ok(())
    }

    /// The event that chains of motion tasks can wait for (MT.CNTL bits 5 to 9). A digital input in mode 2
    /// makes it ([`Injection::Input`](crate::drive::Injection::Input)).
    pub fn motion_event(&mut self) {
        self.positioning.event = self.settings.mode == Mode::Position;
    }

    /// Wraps the position of a modulo axis into its range.
    fn shown(&self, position: i64) -> i64 {
        self.settings
            .position
            .modulo
            .map_or(position, |modulo| modulo.wrap(position))
    }

    /// Returns the number of a position on the wire, before it is cut to its size.
    pub(in crate::drive) fn place_number(&self, place: Place) -> i64 {
        let axis = &self.axis;
        let bits = u32::from(self.settings.scaling.singleturn_bits.min(32));
        let divisor = f64::from(self.settings.scaling.position.max(1));
        let units = self.settings.position.units;
        let user = |counts: i64| (units.value(counts) * 1000.0 / divisor).round() as i64;
        match place {
            Place::Singleturn => self.shown(axis.position()) >> (32 - bits),
            Place::FollowingSingleturn => axis.following_error() >> (32 - bits),
            Place::Actual => user(self.shown(axis.position())),
            Place::Command => user(self.shown(axis.position_command())),
            Place::Following => user(axis.following_error()),
            Place::Feedback => user(axis.feedback()),
            Place::Angle => axis.feedback(),
        }
    }
}
