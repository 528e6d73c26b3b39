//! All drives of a serial line: each receives what the others send.

use std::sync::Arc;
use std::time::Duration;

use network::serial::Talker;
use profinet::Instant;
use uss::Protocol;
use virtual_drive::serial::SerialStation;
use virtual_drive::station::AnswerFault;

use super::HostedDrive;
use super::event::DriveEvent;
use super::injection::{TOO_MANY, events};
use crate::control_socket::{InjectRequest, Response};
use crate::event::PlantEvent;
use crate::timeline::MOST_PENDING;

/// The drives of a line and what is still to happen to them.
pub struct SerialLine {
    place: Place,
    pub drives: Vec<(Arc<HostedDrive>, SerialStation)>,
    /// What ends again, when, and of which drive.
    ends: Vec<(Instant, usize, PlantEvent)>,
}

impl SerialLine {
    /// Returns the line at `port` with these drives.
    pub const fn new(
        protocol: Protocol,
        port: String,
        drives: Vec<(Arc<HostedDrive>, SerialStation)>,
    ) -> Self {
        Self {
            place: Place { protocol, port },
            drives,
            ends: Vec::new(),
        }
    }

    /// Makes a request happen; returns the response, and what happened to which drive.
    pub fn inject(
        &mut self,
        request: &InjectRequest,
        now: Instant,
    ) -> (Response, Option<(Arc<str>, DriveEvent)>) {
        match self.inject_one(request, now) {
            Err(response) => (response, None),
            Ok(at) => {
                let key = self.drives.get(at).map(|(hosted, _)| Arc::clone(&hosted.key));
                let what = DriveEvent::Injected(request.events.join(" "));
                let drive = self.name(at);
                (Response::Done { drive, here: true }, key.map(|key| (key, what)))
            }
        }
    }

    /// Makes a request happen to the drive at the returned index, or returns the response why nothing happened.
    fn inject_one(&mut self, request: &InjectRequest, now: Instant) -> Result<usize, Response> {
        let at = self.find(&request.drive)?;
        let name = self.name(at);
        let Some((hosted, station)) = self.drives.get_mut(at) else {
            return Err(Response::NotHere(Vec::new()));
        };
        if request.events.is_empty() {
            return Err(Response::Done {
                drive: format!("{name} ({}), process {}", hosted.key, std::process::id()),
                here: true,
            });
        }
        let events = events(request, hosted.model).map_err(|error| Response::Refused(error.to_string()))?;
        if let Some(other) = events.iter().find(|event| !is_on_line(event)) {
            return Err(Response::Refused(format!(
                "`{other}` is of a network, the drive is at a serial line"
            )));
        }
        let lasts = request.lasts.map(Duration::from_nanos);
        if lasts.is_some() && events.len() > MOST_PENDING.saturating_sub(self.ends.len()) {
            return Err(Response::Refused(TOO_MANY.to_owned()));
        }
        for event in events {
            apply(event, station);
            if let (Some(lasts), Some(end)) = (lasts, event.undo()) {
                self.ends.push((now + lasts, at, end));
            }
        }
        Ok(at)
    }

    /// Returns the one drive of this name or place.
    fn find(&self, drive: &str) -> Result<usize, Response> {
        let mut found = Vec::new();
        for (at, (hosted, station)) in self.drives.iter().enumerate() {
            if *hosted.key == *drive || self.place.is(drive, station.number()) {
                found.push(at);
            }
        }
        match found.as_slice() {
            [at] => Ok(*at),
            [] => Err(Response::NotHere(
                (0..self.drives.len()).map(|at| self.name(at)).collect(),
            )),
            several => Err(Response::Refused(format!(
                "{} drives of this simulation go by this name",
                several.len()
            ))),
        }
    }

    /// `fc:/dev/ttyUSB0/1`
    fn name(&self, at: usize) -> String {
        let number = self.drives.get(at).map(|(_, station)| station.number());
        number.map_or_else(String::new, |number| self.place.of(number))
    }

    /// Ends what was to last until `now`; returns it, each with its drive.
    pub fn end(&mut self, now: Instant) -> Vec<(Arc<str>, PlantEvent)> {
        let due: Vec<(usize, PlantEvent)> = self
            .ends
            .iter()
            .filter(|(at, ..)| *at <= now)
            .map(|(_, drive, event)| (*drive, *event))
            .collect();
        self.ends.retain(|(at, ..)| *at > now);
        let mut ended = Vec::new();
        for (drive, event) in due {
            if let Some((hosted, station)) = self.drives.get_mut(drive) {
                apply(event, station);
                ended.push((Arc::clone(&hosted.key), event));
            }
        }
        ended
    }
}

/// Returns true for what can happen to a drive at a serial line. Its parameter channel can refuse; the other faults of
/// answers are those of records.
const fn is_on_line(event: &PlantEvent) -> bool {
    matches!(
        event,
        PlantEvent::Drive(_) | PlantEvent::Answers(AnswerFault::None | AnswerFault::Error(_))
    )
}

/// Makes happen to a drive what [`is_on_line`] allows.
fn apply(event: PlantEvent, station: &mut SerialStation) {
    match event {
        PlantEvent::Drive(injection) => station.drive_mut().inject(injection),
        PlantEvent::Answers(fault) => station.refuse_all(fault.in_channel()),
        PlantEvent::Cable { .. } | PlantEvent::Link(_) => {}
    }
}

/// The line as a user writes it.
struct Place {
    protocol: Protocol,
    /// Path of the port.
    port: String,
}

impl Place {
    /// `fc:/dev/ttyUSB0/1`
    fn of(&self, number: u8) -> String {
        let protocol = match self.protocol {
            Protocol::Fc => "fc",
            Protocol::Uss => "uss",
        };
        format!("{protocol}:{}/{number}", self.port)
    }

    /// Returns whether `text` is the drive with this address: protocol, port and address, or port and address. Settings
    /// of the line may follow (`fc:ttyUSB0/1,baud=19200`).
    fn is(&self, text: &str, number: u8) -> bool {
        let (protocol, rest) = match text.split_once(':') {
            Some((scheme, rest)) if scheme.eq_ignore_ascii_case("fc") => (Some(Protocol::Fc), rest),
            Some((scheme, rest)) if scheme.eq_ignore_ascii_case("uss") => (Some(Protocol::Uss), rest),
            _ => (None, text),
        };
        let place = rest.split([',', '?']).next().unwrap_or_default();
        protocol.is_none_or(|protocol| protocol == self.protocol)
            && place
                .rsplit_once('/')
                .is_some_and(|(port, at)| at.parse() == Ok(number) && self.is_port(port))
    }

    fn is_port(&self, port: &str) -> bool {
        let path = if port.contains('/') {
            port.to_owned()
        } else {
            format!("/dev/{port}")
        };
        let real = |port: &str| std::fs::canonicalize(port).ok();
        path == self.port || real(&path).is_some_and(|path| Some(path) == real(&self.port))
    }
}

impl Talker for SerialLine {
    fn handle_octets(&mut self, now: Instant, octets: &[u8]) {
        for (_, drive) in &mut self.drives {
            drive.handle_octets(now, octets);
        }
    }

    fn handle_timeout(&mut self, now: Instant) {
        for (_, drive) in &mut self.drives {
            drive.handle_timeout(now);
        }
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        let mut drives = self.drives.iter_mut().enumerate();
        let (sender, length) =
            drives.find_map(|(number, (_, drive))| Some((number, drive.poll_transmit(now, buffer)?)))?;
        let octets = buffer.get(..length).unwrap_or_default();
        for (number, (_, drive)) in self.drives.iter_mut().enumerate() {
            if number != sender {
                drive.handle_octets(now, octets);
            }
        }
        Some(length)
    }

    fn poll_timeout(&self) -> Option<Instant> {
        self.drives
            .iter()
            .filter_map(|(_, drive)| drive.poll_timeout())
            .min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::state_folder::DriveState;
    use uss::SlaveConfig;
    use virtual_drive::model::AKD;
    use virtual_drive::serial::SerialConfig;

    #[test]
    fn events_that_wait_for_their_end_fill_the_room() {
        let hosted = HostedDrive {
            key: "akd-1".into(),
            model: &AKD,
            state: DriveState::default(),
        };
        let station = SerialStation::new(SerialConfig::new(&AKD, SlaveConfig::fc(1, 9600)));
        let drives = vec![(Arc::new(hosted), station)];
        let mut line = SerialLine::new(Protocol::Fc, "/dev/ttyUSB0".into(), drives);
        let request = |events| InjectRequest {
            drive: "akd-1".into(),
            from: 0,
            events: vec!["load=1Nm".into(); events],
            lasts: Some(1_000_000_000),
        };
        let now = Instant::ZERO;
        let done = |line: &mut SerialLine, events| match line.inject(&request(events), now).0 {
            Response::Done { .. } => true,
            response => {
                assert_eq!(response, Response::Refused(TOO_MANY.into()));
                false
            }
        };
        assert!(!done(&mut line, MOST_PENDING + 1));
        assert!(done(&mut line, MOST_PENDING - 1));
        assert!(!done(&mut line, 2));
        assert!(done(&mut line, 1));
        assert!(!done(&mut line, 1));
        assert_eq!(line.end(now + Duration::from_secs(1)).len(), MOST_PENDING);
        assert!(done(&mut line, MOST_PENDING));
    }

    #[test]
    fn a_drive_is_named_by_protocol_port_and_address() {
        let place = Place {
            protocol: Protocol::Fc,
            port: "/dev/ttyUSB0".into(),
        };
        assert_eq!(place.of(3), "fc:/dev/ttyUSB0/3");
        for text in [
            "fc:/dev/ttyUSB0/3",
            "FC:ttyUSB0/3?baud=19200",
            "fc:ttyUSB0/3,parity=none",
            "/dev/ttyUSB0/3",
            "ttyUSB0/3",
        ] {
            assert!(place.is(text, 3), "{text}");
        }
        for text in [
            "uss:ttyUSB0/3",
            "fc:ttyUSB0/4",
            "fc:ttyUSB1/3",
            "akd-1",
            "fc:",
            "3",
        ] {
            assert!(!place.is(text, 3), "{text}");
        }
    }
}
