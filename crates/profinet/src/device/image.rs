//! The application's side of a device: process data, timing, alarms, diagnosis.

use alloc::borrow::Cow;
use alloc::vec::Vec;
use core::time::Duration;

use super::Device;
use super::ar::Phase;
use super::event::ArKey;
use super::history::Pending;
use super::slots::differs;
use crate::Instant;
use crate::alarm::AlarmError;
use crate::cyclic::{ConsumerState, CyclicStatistics};
use crate::wire::alarm::{AlarmSpecifier, AlarmType, ChannelDiagnosis, Notification, Priority};
use crate::wire::rt::{DataStatus, Iops};

/// An alarm was not raised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RaiseError {
    /// No controller exchanges data.
    #[error("no controller exchanges data")]
    NotConnected,
    /// Nothing is plugged there.
    #[error("nothing is plugged in slot {slot} subslot {subslot:#06x}")]
    NoSubmodule {
        /// The slot.
        slot: u16,
        /// The subslot.
        subslot: u16,
    },
    /// The channel does not accept it.
    #[error(transparent)]
    Alarm(#[from] AlarmError),
}

impl Device {
    /// AR with cyclic data, if one is open.
    #[must_use]
    pub fn controller(&self) -> Option<ArKey> {
        self.controller.as_ref().map(|io| io.key)
    }

    /// ARs that are open, with cyclic data or for record access.
    #[must_use]
    pub fn ars(&self) -> usize {
        usize::from(self.controller.is_some()) + self.tools.len()
    }

    /// Returns true while data is exchanged: start-up is over.
    #[must_use]
    pub fn is_exchanging(&self) -> bool {
        self.controller.as_ref().is_some_and(|io| io.phase == Phase::Data)
    }

    /// Latest output data of a submodule and its IOPS; `None` while no outputs are received or the submodule is not
    /// the expected one. Use the data only if the IOPS is good and
    /// [`provider_running`](Self::provider_running), else substitute values.
    #[must_use]
    pub fn output(&self, slot: u16, subslot: u16) -> Option<(&[u8], Iops)> {
        let io = self.controller.as_ref()?;
        if io.consumer.state() != ConsumerState::Running || differs(&io.diff, slot, subslot) {
            return None;
        }
        io.consumer.data(slot, subslot)
    }

    /// Returns true while outputs come and the controller's provider is in run.
    #[must_use]
    pub fn provider_running(&self) -> bool {
        self.controller
            .as_ref()
            .is_some_and(|io| io.run == Some(true) && io.consumer.state() == ConsumerState::Running)
    }

    /// Sets whether the application moves something, so that DCP must not end the connection now; see
    /// [`DeviceConfig::refuses_in_operation`](super::DeviceConfig::refuses_in_operation).
    pub const fn set_operating(&mut self, operating: bool) {
        self.operating = operating;
    }

    /// Sets input data and IOPS of a submodule for the next frames. False if no controller reads it, it is not the
    /// expected one, or `data` has another length; nothing changes then.
    pub fn set_input(&mut self, slot: u16, subslot: u16, data: &[u8], iops: Iops) -> bool {
        match &mut self.controller {
            Some(io) if !differs(&io.diff, slot, subslot) => io.provider.set_data(slot, subslot, data, iops),
            _ => false,
        }
    }

    /// Sets whether the outputs of a submodule can be used (IOCS); good from the connect on.
    pub fn set_usable(&mut self, slot: u16, subslot: u16, usable: bool) -> bool {
        let iocs = if usable { Iops::GOOD } else { Iops::BAD_SUBSLOT };
        match &mut self.controller {
            Some(io) if !differs(&io.diff, slot, subslot) => io.provider.set_iocs(slot, subslot, iocs),
            _ => false,
        }
    }

    /// Returns the time when the next input frame is due. Step the application and set its inputs at this time, then
    /// call [`handle_timeout`](crate::Endpoint::handle_timeout).
    #[must_use]
    pub fn next_cycle(&self) -> Option<Instant> {
        self.controller.as_ref().map(|io| io.provider.next_send())
    }

    /// Returns the time between two input frames.
    #[must_use]
    pub fn send_interval(&self) -> Option<Duration> {
        self.controller.as_ref().map(|io| io.provider.interval())
    }

    /// Longest time between two output frames before the AR ends.
    #[must_use]
    pub fn watchdog(&self) -> Option<Duration> {
        self.controller.as_ref().map(|io| io.consumer.hold_time())
    }

    /// Returns the counters of received frames.
    #[must_use]
    pub fn statistics(&self) -> Option<CyclicStatistics> {
        self.controller.as_ref().map(|io| io.consumer.statistics())
    }

    /// Raises an alarm of a submodule, for example [`AlarmType::PROCESS`]; gives its sequence number, which comes
    /// back in [`Event::AlarmAcknowledged`](super::Event::AlarmAcknowledged).
    ///
    /// # Errors
    /// Without data exchange, for a submodule that is not plugged, or when the alarm channel rejects it.
    pub fn raise_alarm(
        &mut self,
        now: Instant,
        slot: u16,
        subslot: u16,
        alarm_type: AlarmType,
        usi: Option<u16>,
        data: &[u8],
    ) -> Result<u16, RaiseError> {
        let missing = RaiseError::NoSubmodule { slot, subslot };
        let catalogue = &self.config.modules;
        let module_ident = self.slots.module(catalogue, slot).ok_or(missing)?.ident;
        let submodule = self.slots.submodule(catalogue, slot, subslot).ok_or(missing)?;
        let mut specifier = 0;
        if self.diagnoses.has(slot, subslot) {
            specifier |= AlarmSpecifier::CHANNEL | AlarmSpecifier::SUBMODULE;
        }
        if !self.diagnoses.is_empty() {
            specifier |= AlarmSpecifier::CONNECTION;
        }
        let alarm = Notification {
            priority: Priority::Low,
            alarm_type,
            api: submodule.api,
            slot,
            subslot,
            module_ident,
            submodule_ident: submodule.ident,
            specifier: AlarmSpecifier(specifier),
            usi,
            data: Cow::Owned(data.to_vec()),
        };
        match &mut self.controller {
            Some(io) if io.phase == Phase::Data => {
                self.quiet_until = None;
                Ok(io.alarms.raise(now, alarm)?)
            }
            _ => Err(RaiseError::NotConnected),
        }
    }

    /// Sets or clears a pending diagnosis and notifies a connected controller by alarm. A pending diagnosis is also
    /// readable as a record and visible in the DataStatus. Sets the "appears" bits in the properties of `item`. Keeps
    /// at most 64. Returns true if anything changed.
    pub fn set_diagnosis(
        &mut self,
        now: Instant,
        slot: u16,
        subslot: u16,
        item: ChannelDiagnosis,
        pending: bool,
    ) -> bool {
        let Some(submodule) = self.slots.submodule(&self.config.modules, slot, subslot) else {
            return false;
        };
        let api = submodule.api;
        let cleared = item.properties & !(3 << 11);
        let item = if pending {
            ChannelDiagnosis {
                properties: cleared | ChannelDiagnosis::APPEARS,
                ..item
            }
        } else {
            ChannelDiagnosis {
                properties: cleared | ChannelDiagnosis::DISAPPEARS,
                ..item
            }
        };
        let changed = if pending {
            self.diagnoses.add(Pending {
                api,
                slot,
                subslot,
                item,
            })
        } else {
            self.diagnoses.remove(slot, subslot, &item)
        };
        if changed {
            self.update_station_problem();
            let mut data = Vec::new();
            item.encode(&mut data);
            let alarm_type = if pending {
                AlarmType::DIAGNOSIS
            } else {
                AlarmType::DIAGNOSIS_DISAPPEARS
            };
            // without a controller the diagnosis waits to be read
            let _ = self.raise_alarm(now, slot, subslot, alarm_type, Some(item.usi()), &data);
        }
        changed
    }

    /// Updates the bit of the DataStatus for pending diagnoses.
    pub(super) fn update_station_problem(&mut self) {
        let status = DataStatus::GOOD.with_problem(!self.diagnoses.is_empty());
        if let Some(io) = &mut self.controller {
            io.provider.set_status(status);
        }
    }
}
