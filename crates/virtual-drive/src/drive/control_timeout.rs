//! A drive that stands without its controller and watches the age of the control word itself (VLT 8-03, 8-04; Vacon
//! ID 733).

use std::time::Duration;

use profile::catalogue::Part;
use profile::state::FaultReaction;

use super::faults::Keeper;
use super::velocity::on_ramp;
use super::{Disconnect, Drive};
use crate::axis::Command;
use crate::model::{ControlTimeout, Lost, TimeoutAction};

/// How far it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ControllerLoss {
    /// The last control word still counts for so long.
    Waits(Duration),
    /// Its time is over.
    Acts(TimeoutAction),
}

impl ControllerLoss {
    /// Returns whether the last control word is as good as one of a controller.
    pub(super) const fn holds(self) -> bool {
        !matches!(
            self,
            Self::Acts(TimeoutAction::Stops | TimeoutAction::Trips | TimeoutAction::TripsCoasting)
        )
    }
}

impl Drive {
    /// Returns the time for which a control word is valid, where a parameter sets it.
    #[must_use]
    pub fn control_timeout(&self) -> Option<Duration> {
        self.control_word_rule().and_then(|_| self.loss_time())
    }

    const fn control_word_rule(&self) -> Option<&'static ControlTimeout> {
        match self.model.connection_lost {
            Lost::After(rule) => Some(rule),
            Lost::Always => None,
        }
    }

    fn loss_time(&self) -> Option<Duration> {
        let number = self.model.number(Part::LossTime)?;
        let parameter = self.model.numbered(number)?;
        let seconds = parameter.engineering(self.values.get(number), &self.settings.scaling);
        Duration::try_from_secs_f64(seconds).ok()
    }

    /// The controller is lost, `age` after its last word: a fault, or a warning where the parameters select it.
    pub(super) fn raise_lost(&mut self, cause: Disconnect, age: Duration) {
        let number = self.model.connection_lost_fault;
        match self.model.connection_lost {
            Lost::Always => self.raise(number),
            Lost::After(rule) => {
                let time = self.loss_time();
                let left = time.unwrap_or_default().saturating_sub(age);
                self.controller_loss = Some(ControllerLoss::Waits(left));
                let at_once = time.is_none();
                if at_once {
                    self.act_on_timeout(rule);
                }
                // a line has no connection whose loss could be reported
                let announced = at_once || cause != Disconnect::Silent;
                if announced && self.controller_loss.is_some_and(ControllerLoss::holds) {
                    self.keep(number, Keeper::Action, true);
                }
            }
        }
    }

    /// Handles the return of a controller.
    pub(super) fn controller_is_back(&mut self) {
        if self.controller_loss.take().is_some()
            && let Some(rule) = self.control_word_rule()
        {
            self.keep(rule.number, Keeper::Action, false);
        }
    }

    /// Counts `passed` more without a controller, and acts once that is too long.
    pub(super) fn count_time_without_controller(&mut self, passed: Duration) {
        let (Some(ControllerLoss::Waits(left)), Some(rule)) =
            (self.controller_loss, self.control_word_rule())
        else {
            return;
        };
        let left = left.saturating_sub(passed);
        if !left.is_zero() {
            self.controller_loss = Some(ControllerLoss::Waits(left));
            return;
        }
        self.act_on_timeout(rule);
    }

    /// Executes the configured action.
    fn act_on_timeout(&mut self, rule: &ControlTimeout) {
        let function = self.model.number(Part::LostController);
        let function = function.map(|number| self.values.get(number));
        let action = rule.actions.iter().find(|(value, _)| Some(*value) == function);
        let action = action.map_or(TimeoutAction::GoesOn, |(_, action)| *action);
        self.controller_loss = Some(ControllerLoss::Acts(action));
        match action {
            TimeoutAction::GoesOn => {}
            TimeoutAction::Trips => self.raise(rule.number),
            TimeoutAction::TripsCoasting => {
                self.raise(rule.number);
                self.reaction = Some(FaultReaction::Coast);
            }
            _ => self.keep(rule.number, Keeper::Action, true),
        }
    }

    /// Returns the reaction of the axis in place of following the last setpoint.
    pub(super) fn timeout_command(&mut self) -> Option<Command> {
        let Some(ControllerLoss::Acts(action)) = self.controller_loss else {
            return None;
        };
        let settings = &self.settings;
        let inverter = settings.inverter.as_ref()?;
        let (target, ramps) = match action {
            TimeoutAction::Freezes => (self.axis.speed_command(), settings.ramps),
            TimeoutAction::Jogs => (inverter.jog, settings.jog_ramps),
            TimeoutAction::RunsAtMaximum => (inverter.fastest(), settings.ramps),
            TimeoutAction::GoesOn
            | TimeoutAction::Stops
            | TimeoutAction::Trips
            | TimeoutAction::TripsCoasting => return None,
        };
        self.target = target;
        Some(on_ramp(target, ramps))
    }
}
