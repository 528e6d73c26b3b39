//! One virtual drive on a network or at a serial line, in virtual time, and clients that come and go: killed, frozen, or
//! with the cable pulled at a given time.

use std::fmt;
use std::time::Duration;

use client::{Client, Drive, DriveAddress, Engine, Error, LineConfig, Network, Wait, Wire};
use network::host::{Host, StationId};
use network::segment::{Pace, Segment, SegmentMedium};
use profile::model::Model;
use profinet::controller::ControllerConfig;
use profinet::device::Stored;
use profinet::{Instant, IpSuite, MacAddress, Medium};
use uss::{Protocol, SlaveConfig};
use virtual_drive::drive::Drive as VirtualDrive;
use virtual_drive::model::Model as Virtual;
use virtual_drive::serial::{SerialConfig, SerialStation};
use virtual_drive::station::{AnswerFault, Station, StationConfig};

use crate::ip;
use crate::line::{AtLine, Line, bench_of};
use crate::shared::{On, Shared};

/// How a drive is reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transport {
    /// PROFINET IO.
    Profinet,
    /// A serial line with the FC protocol.
    Fc,
    /// A serial line with USS.
    Uss,
}

/// What happens to a client.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Accident {
    /// It is gone.
    Killed,
    /// It does nothing for a while, then goes on.
    Frozen(Duration),
    /// Nothing passes for a while.
    CableOut(Duration),
}

enum Ends {
    Network {
        medium: Box<SegmentMedium>,
        drive: StationId,
    },
    Line {
        bus: AtLine,
    },
}

struct State {
    ends: Ends,
    accident: Option<(Instant, Accident)>,
    killed: bool,
    /// When the cable is put in again.
    cable_in: Option<Instant>,
    /// Highest speed since it was last requested, rpm.
    fastest: f64,
}

/// The drive and the wire to it; each client has a clone.
#[derive(Clone)]
pub struct World(Shared<State>);

/// A client that was killed does nothing any more.
#[derive(Debug)]
pub struct Gone;

impl fmt::Display for Gone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the client was killed")
    }
}

impl std::error::Error for Gone {}

/// Returns an endpoint that receives frames and ignores them.
fn idle_engine() -> Engine {
    Engine::new(Client::new(ControllerConfig::new(
        CLIENT,
        IpSuite::NONE,
        "idle",
        99,
    )))
}

const CLIENT: MacAddress = MacAddress([2, 0, 0, 0, 1, 0]);

impl World {
    /// A drive of a model, reached in this way.
    pub fn new(model: &'static Virtual, transport: Transport, seed: u64) -> Self {
        let ends = match transport {
            Transport::Profinet => {
                let mut config = StationConfig::new(model, MacAddress([2, 0, 0, 0, 0, 1]));
                config.network = Stored {
                    name: "drive-1".into(),
                    ip: ip(1),
                    ..Stored::default()
                };
                let mut segment = Segment::new(seed);
                let drive = segment.attach(Box::new(Host::new(Station::new(config))));
                let medium = Box::new(SegmentMedium::new(segment, Pace::Virtual));
                Ends::Network { medium, drive }
            }
            Transport::Fc | Transport::Uss => {
                let (protocol, slave) = match transport {
                    Transport::Uss => (Protocol::Uss, SlaveConfig::uss(1, 9600)),
                    _ => (Protocol::Fc, SlaveConfig::fc(1, 9600)),
                };
                let (_, bus) = bench_of(model, protocol, &[], Line::default());
                let station = SerialStation::new(SerialConfig::new(model, slave));
                bus.0.borrow_mut().drives.push(station);
                Ends::Line { bus }
            }
        };
        Self(Shared::new(State {
            ends,
            accident: None,
            killed: false,
            cable_in: None,
            fastest: 0.0,
        }))
    }

    /// Returns a new client, and the drive as it finds it.
    pub fn client(&self, model: &str, transport: Transport, seed: u64) -> Result<(On<Self>, Drive), Error> {
        let (mut session, address) = self.session(transport, seed);
        let drive = session.find(&address).wait()?;
        Ok((session, drive.as_model(Model::by_name(model).expect("a model"))))
    }

    /// Returns a new client, and the address of the drive.
    pub fn session(&self, transport: Transport, seed: u64) -> (On<Self>, DriveAddress) {
        {
            let mut state = self.0.borrow_mut();
            // what was planned for the client before does not happen to this one
            (state.killed, state.accident) = (false, None);
        }
        let session = match transport {
            Transport::Profinet => {
                let mut config = ControllerConfig::new(CLIENT, ip(200), "client", seed);
                config.client_port = 0xC000 + u16::try_from(seed % 0x2000).unwrap_or(0) * 2;
                Network::on(self.clone(), config)
            }
            Transport::Fc => Network::on_line(self.clone(), LineConfig::new(Protocol::Fc, 9600)),
            Transport::Uss => Network::on_line(self.clone(), LineConfig::new(Protocol::Uss, 9600)),
        };
        let name = match transport {
            Transport::Profinet => "drive-1",
            Transport::Fc => "fc:/dev/ttyX/1",
            Transport::Uss => "uss:/dev/ttyX/1",
        };
        (On::new(session), name.parse().expect("an address"))
    }

    /// Lets this happen to the client in so much time.
    pub fn plan(&self, after: Duration, accident: Accident) {
        let now = Wire::now(self);
        self.0.borrow_mut().accident = Some((now + after, accident));
    }

    /// Lets time pass without a client.
    pub fn pass(&self, time: Duration) {
        let until = Wire::now(self) + time;
        let mut idle_engine = idle_engine();
        while Wire::now(self) < until {
            self.0.borrow_mut().go(&mut idle_engine, until);
        }
    }

    /// Another master of the FC line sends these words for a time, and is gone.
    pub fn command(&self, words: &[u8; 4], time: Duration) {
        let mut telegram = vec![0x02, 0x06, 0x81];
        telegram.extend(words);
        telegram.push(telegram.iter().fold(0, |sum, octet| sum ^ octet));
        let end = Wire::now(self) + time;
        while Wire::now(self) < end {
            if let Ends::Line { bus } = &mut self.0.borrow_mut().ends {
                let now = Wire::now(bus);
                let mut bus = bus.0.borrow_mut();
                bus.drives[0].handle_octets(now, &telegram);
                bus.now = now + Duration::from_millis(50);
            }
            self.pass(Duration::from_millis(50));
        }
    }

    /// Looks at the drive itself.
    pub fn look<T>(&self, look: impl FnOnce(&mut VirtualDrive) -> T) -> T {
        match &mut self.0.borrow_mut().ends {
            Ends::Network { medium, drive } => {
                let host = medium.segment_mut().station_mut::<Host<Station>>(*drive);
                look(host.expect("the drive").endpoint_mut().drive_mut())
            }
            Ends::Line { bus } => look(bus.0.borrow_mut().drives[0].drive_mut()),
        }
    }

    /// Makes the parameter channel answer like this. A line knows only all or nothing.
    pub fn answer(&self, fault: AnswerFault) {
        match &mut self.0.borrow_mut().ends {
            Ends::Network { medium, drive } => {
                let host = medium.segment_mut().station_mut::<Host<Station>>(*drive);
                host.expect("the drive").endpoint_mut().set_answer_fault(fault);
            }
            Ends::Line { bus } => bus.0.borrow_mut().line.mute = fault != AnswerFault::None,
        }
    }

    /// Speed of the axis, rpm.
    pub fn speed(&self) -> f64 {
        self.look(|drive| drive.axis().speed())
    }

    /// Returns the highest speed since this was last asked, rpm.
    pub fn fastest(&self) -> f64 {
        let speed = self.speed().abs();
        std::mem::replace(&mut self.0.borrow_mut().fastest, speed)
    }
}

impl State {
    fn now(&self) -> Instant {
        match &self.ends {
            Ends::Network { medium, .. } => Medium::now(&**medium),
            Ends::Line { bus } => Wire::now(bus),
        }
    }

    fn cable(&mut self, out: bool) {
        match &mut self.ends {
            Ends::Network { medium, drive } if out => medium.segment_mut().cut(*drive),
            Ends::Network { medium, drive } => medium.segment_mut().uncut(*drive),
            Ends::Line { bus } => bus.0.borrow_mut().line.cut = out,
        }
    }

    /// Lets one thing happen.
    fn go(&mut self, client: &mut Engine, until: Instant) {
        let until = self.cable_in.map_or(until, |at| until.min(at));
        match &mut self.ends {
            Ends::Network { medium, .. } => {
                let Ok(()) = Medium::step(&mut **medium, client, until);
            }
            Ends::Line { bus } => {
                let Ok(()) = Wire::step(bus, client, until);
            }
        }
        if self.cable_in.is_some_and(|at| at <= self.now()) {
            self.cable_in = None;
            self.cable(false);
        }
        let speed = match &mut self.ends {
            Ends::Network { medium, drive } => {
                let host = medium.segment().station::<Host<Station>>(*drive);
                host.expect("the drive").endpoint().drive().axis().speed()
            }
            Ends::Line { bus } => bus.0.borrow().drives[0].drive().axis().speed(),
        };
        self.fastest = self.fastest.max(speed.abs());
    }
}

impl Wire for World {
    type Error = Gone;

    fn now(&self) -> Instant {
        self.0.borrow().now()
    }

    fn step(&mut self, client: &mut Engine, until: Instant) -> Result<(), Gone> {
        let due = {
            let state = self.0.borrow();
            state.accident.filter(|(at, _)| *at <= state.now())
        };
        if let Some((_, accident)) = due {
            self.0.borrow_mut().accident = None;
            match accident {
                Accident::Killed => self.0.borrow_mut().killed = true,
                Accident::Frozen(time) => self.pass(time),
                Accident::CableOut(time) => {
                    let mut state = self.0.borrow_mut();
                    state.cable(true);
                    state.cable_in = Some(state.now() + time);
                }
            }
        }
        let mut state = self.0.borrow_mut();
        if state.killed {
            return Err(Gone);
        }
        let until = state
            .accident
            .map_or(until, |(at, _)| until.min(at.max(state.now())));
        state.go(client, until);
        Ok(())
    }
}
