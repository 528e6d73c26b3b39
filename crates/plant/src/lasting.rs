//! What has happened to a drive and has not ended.

use std::mem::discriminant;

use virtual_drive::drive::Injection;
use virtual_drive::station::AnswerFault;

use crate::event::{LinkFault, PlantEvent};

/// The events that make a drive, its cable or its answers other than they are by themselves.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lasting(Vec<PlantEvent>);

impl Lasting {
    /// Notes that something has happened. It takes the place of what set the same before, and what sets it as it is by itself
    /// leaves nothing.
    pub fn note(&mut self, event: PlantEvent) {
        if is_momentary(&event) {
            return;
        }
        self.0.retain(|before| !is_of_same(before, &event));
        if !is_normal(&event) {
            self.0.push(event);
        }
    }

    /// Returns what lasts, in the order in which it happened.
    pub fn events(&self) -> &[PlantEvent] {
        &self.0
    }
}

/// A fault that can be acknowledged at once, a button that is pressed: nothing lasts that another event would end.
const fn is_momentary(event: &PlantEvent) -> bool {
    matches!(
        event,
        PlantEvent::Drive(Injection::Fault { lasting: false, .. } | Injection::ButtonB1(_))
    )
}

/// Returns whether two events set the same thing, so that the later one counts.
fn is_of_same(a: &PlantEvent, b: &PlantEvent) -> bool {
    match (a, b) {
        (PlantEvent::Drive(a), PlantEvent::Drive(b)) => sets_same(*a, *b),
        (PlantEvent::Link(a), PlantEvent::Link(b)) => discriminant(a) == discriminant(b),
        (a, b) => discriminant(a) == discriminant(b),
    }
}

fn sets_same(a: Injection, b: Injection) -> bool {
    use Injection as I;
    match (a, b) {
        (I::ClearCause { number: a }, I::Fault { number: b, .. } | I::Warning { number: b })
        | (I::Fault { number: a, .. } | I::Warning { number: a }, I::ClearCause { number: b })
        | (I::Fault { number: a, .. }, I::Fault { number: b, .. })
        | (I::Warning { number: a }, I::Warning { number: b }) => a == b,
        (I::Input { number: a, .. }, I::Input { number: b, .. }) => a == b,
        (I::Limit { positive: a, .. }, I::Limit { positive: b, .. }) => a == b,
        (I::Local(_) | I::LocalSpeed(_), I::Local(_) | I::LocalSpeed(_)) => true,
        (a, b) => discriminant(&a) == discriminant(&b),
    }
}

/// Returns whether it sets what is so without any event.
fn is_normal(event: &PlantEvent) -> bool {
    use Injection as I;
    match *event {
        PlantEvent::Cable { pulled } => !pulled,
        PlantEvent::Link(
            LinkFault::Loss(share) | LinkFault::Duplicate(share) | LinkFault::Overtaken(share),
        ) => share == 0.0,
        PlantEvent::Link(LinkFault::Delay(time) | LinkFault::Jitter(time)) => time.is_zero(),
        PlantEvent::Answers(fault) => fault == AnswerFault::None,
        PlantEvent::Drive(injection) => match injection {
            I::Sto(on)
            | I::Block(on)
            | I::FeedbackLoss(on)
            | I::HardwareDisable(on)
            | I::ControlledStop(on)
            | I::Input { on, .. }
            | I::Local(on) => !on,
            I::Mains(on) | I::Regen(on) => on,
            I::Load(torque) => torque == 0.0,
            I::Limit { active, .. } => active.is_none(),
            I::HomeSwitch(active) | I::Brake(active) => active.is_none(),
            I::BusVoltage(value) | I::MotorTemperature(value) | I::PowerTemperature(value) => value.is_none(),
            I::ClearCause { .. } => true,
            _ => false,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::event::keys;

    fn after(events: &[&str]) -> Vec<String> {
        let mut lasting = Lasting::default();
        for event in events {
            lasting.note(event.parse().unwrap());
        }
        lasting.events().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_is_undone_does_not_last() {
        for key in keys() {
            let event: PlantEvent = key.example.parse().unwrap();
            let Some(undo) = event.undo() else { continue };
            let lasting = if is_normal(&event) { undo } else { event };
            let end = lasting.undo().unwrap();
            let mut noted = Lasting::default();
            noted.note(lasting);
            assert_eq!(noted.events(), [lasting], "{lasting}");
            noted.note(end);
            assert!(noted.events().is_empty(), "{lasting} is ended by {end}");
        }
    }

    #[test]
    fn the_last_of_the_same_counts_and_others_stay() {
        assert_eq!(
            after(&["load=1Nm", "sto=on", "load=2Nm", "fault=439!", "fault=439"]),
            ["sto=on", "load=2Nm", "fault=439!"]
        );
        assert_eq!(
            after(&[
                "input=1:on",
                "input=2:on",
                "input=1:off",
                "loss=5%",
                "delay=20ms",
                "loss=0%"
            ]),
            ["input=2:on", "delay=20ms"]
        );
        assert_eq!(
            after(&["fault=439!", "warning=107", "clear=439"]),
            ["warning=107"]
        );
        assert_eq!(after(&["local=on", "local-speed=300rpm"]), ["local-speed=300rpm"]);
        assert_eq!(after(&["fault=439", "cable=plugged", "mains=on"]), [""; 0]);
    }
}
