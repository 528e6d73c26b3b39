//! A controller of a plant: connects, sends what its steps say, and connects again.

use std::collections::BTreeMap;
use std::time::Duration;

use network::segment::StationId;
use profinet::Instant;
use profinet::controller::{
    ArId, ConnectConfig, Controller, Event as ControllerEvent, ModuleConfig, Resolve, SubmoduleConfig, Target,
};
use profinet::cyclic::Timing;
use profinet::device::ModuleDescription;
use profinet::wire::block::ModuleState;
use virtual_drive::description::Description;
use virtual_drive::model::Model;

use crate::plan::{Action, ControllerPlan, DrivePlan, Step};

/// How long a controller waits before it connects again.
const RECONNECT_DELAY: Duration = Duration::from_millis(500);

/// A controller in its place.
pub(super) struct ControllerSeat {
    pub(super) id: StationId,
    pub(super) drive: usize,
    pub(super) target: Target,
    pub(super) connect: ConnectConfig,
    pub(super) ar: Option<ArId>,
    /// When it connects next; `None` while it has a connection or is not to have one.
    pub(super) connect_at: Option<Instant>,
    /// What it does, by the time after the start and the place in the program.
    pub(super) steps: BTreeMap<(Duration, usize), Step>,
    pub(super) outputs: Vec<u8>,
    /// Subslot of the telegram.
    pub(super) subslot: u16,
}

/// Returns the modules that a controller expects in a drive of this model with this telegram.
fn expected_modules(model: &'static Model, telegram: u16) -> Vec<ModuleConfig> {
    let description = Description::of(model);
    let access_point = description.access_points.first().map(|module| (0, module));
    let mut telegrams = description.telegrams.iter();
    let chosen = telegrams
        .find(|module| module.telegram == telegram)
        .map(|module| (module.slot, &module.module));
    access_point.into_iter().chain(chosen).map(expected).collect()
}

fn expected((slot, module): (u16, &ModuleDescription)) -> ModuleConfig {
    let submodules = module.submodules.iter().map(|submodule| SubmoduleConfig {
        subslot: submodule.subslot,
        ident: submodule.ident,
        input_length: submodule.input_length,
        output_length: submodule.output_length,
    });
    ModuleConfig {
        api: module.submodules.first().map_or(0, |submodule| submodule.api),
        slot,
        ident: module.ident,
        submodules: submodules.collect(),
    }
}

impl ControllerSeat {
    pub(super) fn new(id: StationId, plan: &ControllerPlan, drive: &DrivePlan) -> Self {
        let device = &drive.model.catalogue.device;
        // the file was checked: only telegrams of the model come here
        let module = device.telegram(plan.telegram);
        let modules = expected_modules(drive.model, plan.telegram);
        let outputs = module.map_or(0, |module| module.outputs);
        // the file was checked: only update times that exist come here
        let timing = Timing::for_interval(plan.cycle).unwrap_or(Timing {
            send_clock_factor: 32,
            reduction_ratio: 16,
            phase: 1,
        });
        let mut connect = ConnectConfig::new(modules, timing);
        connect.resolve = Resolve::Check;
        connect.watchdog_factor = plan.watchdog;
        connect.data_hold_factor = plan.watchdog;
        let steps = plan.steps.iter().cloned().enumerate();
        Self {
            id,
            drive: plan.drive,
            target: Target {
                name: drive.name.clone(),
                mac: None,
                ip: drive.ip,
                vendor_id: device.vendor_id,
                device_id: device.device_id,
                instance: 1,
            },
            connect,
            ar: None,
            connect_at: Some(Instant::ZERO),
            steps: steps.map(|(number, step)| ((step.at, number), step)).collect(),
            outputs: vec![0; usize::from(outputs)],
            subslot: device.layout.telegram,
        }
    }

    pub(super) fn next_step(&self) -> Option<Instant> {
        let (at, _) = self.steps.first_key_value()?.0;
        Some(Instant::ZERO + *at)
    }

    pub(super) fn is_due(&self, now: Instant) -> bool {
        Instant::earliest([self.next_step(), self.connect_at]).is_some_and(|at| at <= now)
    }

    /// Executes one due action. Returns the resulting message.
    pub(super) fn act(&mut self, now: Instant, controller: &mut Controller) -> Option<String> {
        if self.connect_at.is_some_and(|at| at <= now) {
            self.connect_at = None;
            match controller.connect(now, self.target.clone(), self.connect.clone()) {
                Ok(ar) => self.ar = Some(ar),
                Err(misuse) => return Some(format!("cannot connect: {misuse}")),
            }
            return None;
        }
        let ((at, number), step) = self.steps.pop_first()?;
        if let Some(every) = step.every {
            self.steps.insert((at + every, number), step.clone());
        }
        match step.action {
            Action::Send(signals) => {
                for (field, value) in signals {
                    // the file was checked: the signal is in the telegram, the value fits
                    let _ = field.set(&mut self.outputs, value);
                }
            }
            Action::Words(words) => {
                let (places, _) = self.outputs.as_chunks_mut::<2>();
                for (place, word) in places.iter_mut().zip(words) {
                    *place = word.to_be_bytes();
                }
            }
            Action::Release => {
                self.connect_at = None;
                let released = self.ar.map(|ar| controller.release(now, ar));
                return matches!(released, Some(Err(_)) | None).then(|| "nothing to release".into());
            }
            Action::Connect => {
                if self.ar.is_none() {
                    self.connect_at = Some(now);
                }
                return None;
            }
            Action::Stop | Action::Run => {
                let run = step.action == Action::Run;
                if let Some(ar) = self.ar {
                    let _ = controller.set_run(ar, run);
                }
                return Some(if run { "RUN" } else { "STOP" }.into());
            }
        }
        self.send(controller);
        None
    }

    fn send(&self, controller: &mut Controller) {
        if let Some(ar) = self.ar {
            // before the connection is there it is set again when it is
            let _ = controller.set_output(ar, 1, self.subslot, &self.outputs);
        }
    }

    /// Handles an event of the controller. Returns the resulting message.
    pub(super) fn take(
        &mut self,
        now: Instant,
        event: ControllerEvent,
        controller: &mut Controller,
    ) -> Option<String> {
        let own = self.ar;
        match event {
            ControllerEvent::Connected { ar, diff } if own == Some(ar) => {
                self.send(controller);
                // a drive may name a module of which nothing differs
                let wrong = diff.is_some_and(|diff| {
                    diff.modules
                        .iter()
                        .any(|module| module.state != ModuleState::PROPER)
                });
                let differs = if wrong { ", the modules differ" } else { "" };
                Some(format!("connected{differs}"))
            }
            ControllerEvent::Running { ar } if own == Some(ar) => Some("exchanges data".into()),
            ControllerEvent::Lost { ar, cause } if own == Some(ar) => {
                self.ar = None;
                self.connect_at = Some(now + RECONNECT_DELAY);
                Some(format!("connection lost: {cause}"))
            }
            ControllerEvent::Released { ar } if own == Some(ar) => {
                self.ar = None;
                Some("released".into())
            }
            _ => None,
        }
    }
}
