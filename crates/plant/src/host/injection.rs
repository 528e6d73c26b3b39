//! Requests of the control socket to drives on a network.

use std::time::Duration;

use network::host::StationId;
use network::system::now;
use profinet::{Endpoint, controller};
use virtual_drive::model::Model;
use virtual_drive::station::Station;

use super::Host;
use crate::control_socket::{InjectRequest, Response, namespace, segment};
use crate::event::{PlantEvent, PlantEventError, Unit};
use crate::text::station_text;

/// Why an event is refused when many wait.
pub(super) const TOO_MANY: &str =
    "too many events wait for their end; repeat it when some of them have ended";

impl Host {
    /// Returns the drives, where they are on this segment.
    pub(super) fn drives_on(&self, place: &str) -> Response {
        if place != segment(&self.runner.interface().name) {
            return Response::Drives(Vec::new());
        }
        let stations = self.drives.keys().filter_map(|id| self.station(*id));
        let stations = stations.map(|station| controller::Station {
            name: station.name().to_owned(),
            mac: station.mac(),
            ip: station.ip(),
            ..controller::Station::default()
        });
        Response::Drives(stations.collect())
    }

    fn station(&self, id: StationId) -> Option<&Station> {
        let unit = self.runner.station::<Unit>(id)?;
        Some(unit.inner().endpoint())
    }

    /// Makes a request happen.
    pub(super) fn inject(&mut self, request: &InjectRequest) -> Response {
        let found: Vec<StationId> = self
            .drives
            .iter()
            .filter(|(id, running)| {
                *running.drive.key == *request.drive
                    || self
                        .station(**id)
                        .is_some_and(|station| is_meant(station, &request.drive))
            })
            .map(|(id, _)| *id)
            .collect();
        let id = match found.as_slice() {
            [id] => *id,
            [] => {
                let all = self.drives.values().map(|running| running.drive.key.to_string());
                return Response::NotHere(all.collect());
            }
            several => {
                return Response::Refused(format!(
                    "{} drives of this simulation go by this name; say which one by its IP or MAC address",
                    several.len()
                ));
            }
        };
        let here = request.from == namespace();
        if request.events.is_empty() {
            let drive = self.in_words(id);
            return Response::Done { drive, here };
        }
        let Some(running) = self.drives.get_mut(&id) else {
            return Response::NotHere(Vec::new());
        };
        match events(request, running.drive.model) {
            Err(error) => Response::Refused(error.to_string()),
            Ok(events) if !running.timeline.has_room(events.len()) => Response::Refused(TOO_MANY.to_owned()),
            Ok(events) => {
                let lasts = request.lasts.map(Duration::from_nanos);
                for event in events {
                    running.timeline.add(now(), event, lasts);
                }
                self.timed.insert(id);
                let drive = running.drive.key.to_string();
                Response::Done { drive, here }
            }
        }
    }

    fn in_words(&self, id: StationId) -> String {
        let running = self.drives.get(&id);
        running
            .zip(self.station(id))
            .map_or_else(String::new, |(running, station)| {
                format!(
                    "{} on {}, process {}",
                    station_text(&running.drive.key, station.mac(), station.ip()),
                    self.runner.interface().name,
                    std::process::id()
                )
            })
    }
}

fn is_meant(station: &Station, drive: &str) -> bool {
    station.name() == drive
        || station.mac().to_string().eq_ignore_ascii_case(drive)
        || station.ip().is_set() && station.ip().address.to_string() == drive
}

/// Returns the event that a request describes, if it is possible on a drive of this model.
pub(super) fn events(request: &InjectRequest, model: &Model) -> Result<Vec<PlantEvent>, PlantEventError> {
    let read = |text: &String| {
        let event: PlantEvent = text.parse()?;
        event.fits(model).map(|()| event)
    };
    request.events.iter().map(read).collect()
}
