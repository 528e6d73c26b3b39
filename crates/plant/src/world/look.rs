//! What the owner of a world sees of its drives and changes in them, without a frame on the network.

use profile::notation::ParameterReference;
use profile::value::{Assignment, ParameterProblem, Parameters};
use virtual_drive::drive::{WriteChannel, Written};
use virtual_drive::station::Station;

use crate::event::Unit;
use crate::expect::{Live, Observed as _};
use crate::plan::{WorldError, set};
use crate::snapshot::Snapshot;
use crate::trace::DriveMessage;
use crate::written::ParameterReading;

use super::{Seat, World};

impl World {
    fn seat(&self, drive: &str) -> Result<(&Seat, &Station), WorldError> {
        let seat = self.drives.iter().find(|seat| seat.name == drive);
        let found = seat.and_then(|seat| {
            let unit = self.medium.segment().station::<Unit>(seat.id)?;
            Some((seat, unit.inner().endpoint()))
        });
        found.ok_or_else(|| WorldError::NoDrive {
            drive: drive.to_owned(),
        })
    }

    /// Returns what the drive of this name is like now.
    ///
    /// # Errors
    /// When there is no such drive.
    pub fn snapshot(&self, drive: &str) -> Result<Snapshot, WorldError> {
        let (seat, station) = self.seat(drive)?;
        let live = Live {
            drive: station.drive(),
            connected: seat.connected,
        };
        Ok(Snapshot::of(&live, None))
    }

    /// Returns the faults (or warnings) of the drive of this name that are present.
    ///
    /// # Errors
    /// When there is no such drive.
    pub fn messages(&self, drive: &str, warnings: bool) -> Result<Vec<DriveMessage>, WorldError> {
        let snapshot = self.snapshot(drive)?;
        let (seat, _) = self.seat(drive)?;
        let numbers = snapshot.messages(warnings).into_iter();
        let message = |number| DriveMessage::of(number, warnings, seat.model.catalogue);
        Ok(numbers.map(message).collect())
    }

    /// Returns a parameter as the drive of this name reports it now. `name` is what people write: `DRV.ACC`, `p922`, `3-41`.
    ///
    /// ```
    /// use profidrive_plant::{PlantPlan, ReadingValue, World};
    /// let plant: PlantPlan = "[[drive]]\nname = \"akd-1\"".parse()?;
    /// let mut world = World::new(&plant)?;
    /// world.set_parameter("akd-1", "DRV.ACC", "5000rpm/s")?;
    /// let reading = world.parameter("akd-1", "DRV.ACC")?;
    /// assert_eq!((reading.pnu, reading.unit), (2108, "rpm/s"));
    /// assert!(matches!(reading.value, ReadingValue::Number(value) if (value - 5000.0).abs() < 1.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When there is no such drive or parameter, when the parameter has several elements and none is named, and when it has no
    /// value that can be read.
    pub fn parameter(&self, drive: &str, name: &str) -> Result<ParameterReading, WorldError> {
        let (seat, station) = self.seat(drive)?;
        let table = Parameters {
            catalogue: Some(seat.model.catalogue),
            scaling: station.drive().scaling(),
        };
        let problem = |problem: ParameterProblem| WorldError::Parameter {
            drive: drive.to_owned(),
            problem,
        };
        let reference: ParameterReference = name
            .parse()
            .map_err(|error| problem(ParameterProblem::from(error)))?;
        let selection = table.select(&reference).map_err(problem)?;
        let unreadable = |why| WorldError::Unreadable {
            drive: drive.to_owned(),
            parameter: selection.label(),
            why,
        };
        let is_text = selection.parameter.is_some_and(|parameter| parameter.is_text());
        if selection.count > 1 && !is_text {
            return Err(unreadable(
                "has several elements: name one by its index, such as p922[0]",
            ));
        }
        let (pnu, first) = (selection.pnu, selection.first);
        let present = station.drive().present(pnu, first);
        let (subindex, value) = present.ok_or_else(|| unreadable("has no value that can be read"))?;
        let written = Written {
            pnu,
            subindex,
            value,
            channel: WriteChannel::Other,
        };
        Ok(ParameterReading::of(&written, seat.model.catalogue))
    }

    /// Writes a parameter of the drive of this name and returns it as the drive reports it since. The value is what people write:
    /// `5000rpm/s`, `2`, the text of a choice. It is lost at the next power cycle.
    ///
    /// # Errors
    /// When there is no such drive or parameter, and when the value does not fit or is refused.
    pub fn set_parameter(
        &mut self,
        drive: &str,
        name: &str,
        value: &str,
    ) -> Result<ParameterReading, WorldError> {
        let (seat, _) = self.seat(drive)?;
        let (id, model) = (seat.id, seat.model);
        let problem = |problem| WorldError::Parameter {
            drive: drive.to_owned(),
            problem,
        };
        let assignment: Assignment = format!("{name}={value}").parse().map_err(problem)?;
        if let Some(unit) = self.medium.segment_mut().station_mut::<Unit>(id) {
            set(unit.inner_mut().endpoint_mut(), model, drive, &assignment)?;
        }
        self.parameter(drive, name)
    }
}
