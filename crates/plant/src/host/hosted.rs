//! A drive as its events and its state need it.

use std::sync::Arc;

use profinet::device::Stored;
use virtual_drive::model::Model;

use super::fleet::Plan;
use super::{DriveState, Event, EventSender, HostError, StateFolder};

/// A drive as its events and its state need it.
#[derive(Debug)]
pub(super) struct HostedDrive {
    /// Its name in this simulation.
    pub key: Arc<str>,
    pub model: &'static Model,
    pub state: DriveState,
}

impl HostedDrive {
    pub fn new(plan: &Plan, folder: Option<&StateFolder>) -> Self {
        let key = plan.key();
        Self {
            state: folder.map_or_else(DriveState::default, |folder| folder.drive(&key)),
            model: plan.drive.model,
            key: key.into(),
        }
    }

    /// Returns the parameters that were saved earlier.
    pub fn saved_parameters(&self, events: &EventSender) -> Result<Option<Vec<u8>>, HostError> {
        let found = self.state.read_parameters(self.model)?;
        found
            .warning
            .into_iter()
            .for_each(|why| events.send(Event::SetAside(why)));
        Ok(found.content)
    }

    /// Returns the name and address that the drive begins with: those saved earlier, else the planned ones, which are
    /// saved now.
    pub fn network(&self, planned: Stored, events: &EventSender) -> Result<Stored, HostError> {
        let found = self.state.read_network()?;
        found
            .warning
            .into_iter()
            .for_each(|why| events.send(Event::SetAside(why)));
        let Some(mut network) = found.content else {
            if !planned.name.is_empty() || planned.ip.is_set() {
                self.state.write_network(&planned)?;
            }
            return Ok(planned);
        };
        if planned.ip.is_set() && !network.ip.is_set() {
            network.ip = planned.ip;
            self.state.write_network(&network)?;
        } else if planned.ip.is_set() && planned.ip != network.ip {
            events.send(Event::SavedAddress {
                drive: Arc::clone(&self.key),
                saved: network.ip.address,
                planned: planned.ip.address,
            });
        }
        Ok(network)
    }
}
