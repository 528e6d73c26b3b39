//! Networks, real ones and those of plants, as Python sees them: the calls of a client.

use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use client::{Drive, ErrorKind};
use profidrive::addressing::{self, NewAddress, NewName};
use profidrive::fleet::{self, Member};
use profidrive::machine::Machine;
use profidrive::recording::{Every, Request};
use profidrive::{Access, Caller, IpSuite, Opening, Selector, StopRequests, Wait as _, scan};
use pyo3::exceptions::PyBaseException;
use pyo3::prelude::*;
use serde_json::json;

use crate::attention::within;
use crate::axis::{Axis, Wanted};
use crate::errors::{Failure, explained, of_client, of_drive, of_open};
use crate::joined::{Joined, address, locked};
use crate::log::{self, Logger};
use crate::recording::{Recording, record};
use crate::time::Span;
use crate::trace::document;
use crate::verb::Verb;
use crate::world::Held;

/// Name of a drive, with the document of a call or its error.
type Outcome = (String, Option<String>, Option<Py<PyBaseException>>);

/// Opens a network interface, the only one there is where none is named, or the serial line of a drive. With `ip` only UDP.
#[pyfunction]
pub fn open(
    py: Python<'_>,
    interface: Option<&str>,
    by_ip: bool,
    read_only: bool,
    timeout: Option<Span>,
    machine: Option<PathBuf>,
) -> PyResult<Network> {
    let timeout = timeout.map(|timeout| timeout.read()).transpose()?;
    let machine = machine.as_deref().map(machine_of).transpose()?;
    log::begin(py)?;
    let opened = py.detach(|| match interface {
        Some(line) if line.contains(':') => {
            let address = address(line)?;
            let opening = Opening::new(Access::Cyclic);
            let network = opening.open_to(&address).map_err(|error| of_open(&error))?;
            Ok::<_, Failure>(Joined::new(network, opening, machine, timeout))
        }
        interface => {
            let access = if by_ip { Access::Records } else { Access::Cyclic };
            // without permission for raw sockets drives are left that are given by their IP address
            let opening = Opening::new(access).by_ip(by_ip || interface.is_none());
            let opening = match interface {
                Some(name) => opening.on(name),
                None => opening,
            };
            let network = opening.clone().open().map_err(|error| of_open(&error))?;
            Ok(Joined::new(network, opening, machine, timeout))
        }
    });
    let shown = interface.unwrap_or(if by_ip { "UDP alone" } else { "the only interface" });
    log::call(Logger::Network, format_args!("open {shown}"), &opened, true);
    Ok(Network {
        source: Source::Real(opened?),
        read_only,
    })
}

/// Reads a machine file.
pub fn machine_of(path: &Path) -> Result<Machine, Failure> {
    Machine::read(path).map_err(|error| explained(&error))
}

/// A network in use.
#[derive(Clone)]
pub struct Place {
    pub joined: Arc<Joined>,
    /// The plant that it is in.
    held: Option<Arc<Held>>,
}

impl Place {
    /// Whether it is a plant in virtual time.
    pub const fn is_plant(&self) -> bool {
        self.held.is_some()
    }

    /// A plant is about to go on.
    pub fn goes_on(&self) {
        if let Some(held) = &self.held {
            held.goes_on();
        }
    }
}

enum Source {
    Real(Arc<Joined>),
    Plant(Arc<Held>),
}

/// A network.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Network {
    source: Source,
    /// Nothing but a stop changes anything.
    read_only: bool,
}

impl Network {
    pub const fn of_plant(held: Arc<Held>) -> Self {
        Self {
            source: Source::Plant(held),
            read_only: false,
        }
    }

    fn place(&self) -> Result<Place, Failure> {
        Ok(match &self.source {
            Source::Real(joined) => {
                joined.usable()?;
                Place {
                    joined: Arc::clone(joined),
                    held: None,
                }
            }
            Source::Plant(held) => Place {
                joined: held.joined()?,
                held: Some(Arc::clone(held)),
            },
        })
    }

    /// Fails where something is to change on a network that is only for reading.
    fn permit(&self, changes: bool) -> Result<(), Failure> {
        if !changes || !self.read_only {
            return Ok(());
        }
        let failure = Failure::new(ErrorKind::Safety, "the network was opened for reading only");
        Err(failure.with(json!({ "rule": "read_only" })))
    }

    /// Carries out a call for the network.
    fn search<T: Send>(
        &self,
        py: Python<'_>,
        work: impl AsyncFnOnce(&Joined, &mut Caller) -> Result<T, Failure> + Send,
    ) -> PyResult<T> {
        py.detach(|| {
            let place = self.place()?;
            place.goes_on();
            let requests = StopRequests::default();
            let mut caller = place.joined.caller(&requests);
            place.joined.wait(&[requests], work(&place.joined, &mut caller))
        })
    }

    /// Carries out a call for a station, which need not have an address. What was known of drives may be of another one then.
    fn station(
        &self,
        py: Python<'_>,
        name: &str,
        work: impl AsyncFnOnce(&mut Caller, &Drive) -> Result<String, Failure> + Send,
    ) -> PyResult<String> {
        self.search(py, async |joined, caller| {
            let address = address(name)?;
            let opening = Opening::new(Access::Discovery);
            let found = opening.find(caller, &address, &mut |_| {}).await;
            let station = found.map_err(|error| of_drive(&error).about(name))?;
            let done = work(caller, &station).await;
            locked(&joined.drives).clear();
            done.map_err(|failure| failure.about(&station.label()))
        })
    }

    /// Carries out a call for a drive.
    fn call<T: Send>(
        &self,
        py: Python<'_>,
        name: &str,
        timeout: Option<Duration>,
        work: impl AsyncFnOnce(&mut Caller, &mut Drive) -> Result<T, Failure> + Send,
    ) -> PyResult<T> {
        py.detach(|| {
            let place = self.place()?;
            place.goes_on();
            let requests = StopRequests::default();
            let mut caller = place.joined.caller(&requests);
            let clock = caller.clone();
            let call = async {
                let found = place.joined.drive(&mut caller, name).await;
                let mut drive = found.map_err(|failure| failure.about(name))?;
                let result = work(&mut caller, &mut drive).await;
                let result = result.map_err(|failure| failure.about(&drive.label()));
                // with what was read of it
                locked(&place.joined.drives).insert(name.to_owned(), drive);
                result
            };
            let call = async {
                let done = within(&clock, timeout, call).await;
                done.map_err(|failure| failure.about(name))
            };
            place.joined.wait(&[requests], call)
        })
    }
}

#[pymethods]
impl Network {
    /// Carries out a call for a drive; returns its document as JSON.
    #[pyo3(signature = (drive, verb, timeout=None))]
    fn one(&self, py: Python<'_>, drive: &str, verb: &Verb, timeout: Option<Span>) -> PyResult<String> {
        self.permit(verb.changes())?;
        let timeout = timeout.map(|timeout| timeout.read()).transpose()?;
        self.call(py, drive, timeout, async |caller, drive| {
            verb.carry_out(caller, drive).await
        })
    }

    /// Carries out a call for each of these drives, all at the same time; returns the name with the document or the error.
    #[pyo3(signature = (names, verb, timeout=None))]
    fn each(
        &self,
        py: Python<'_>,
        names: Vec<String>,
        verb: &Verb,
        timeout: Option<Span>,
    ) -> PyResult<Vec<Outcome>> {
        self.permit(verb.changes())?;
        let timeout = timeout.map(|timeout| timeout.read()).transpose()?;
        let done = self.search(py, async |joined, caller| {
            let members = joined.members(caller, &names).await?;
            let clock = caller.clone();
            let done = fleet::each(caller, members, async |session, drive| {
                within(&clock, timeout, verb.carry_out(session, drive)).await
            });
            Ok(done.await)
        })?;
        let outcome = |member: Member<Result<String, Failure>>| match member.result {
            Ok(document) => (member.name, Some(document), None),
            Err(failure) => {
                let error = PyErr::from(failure.about(&member.name));
                (member.name, None, Some(error.into_value(py)))
            }
        };
        Ok(done.into_iter().map(outcome).collect())
    }

    /// Returns the names of the drives that a selector means, with the errors of those that cannot be worked with.
    fn select(&self, py: Python<'_>, selector: &str) -> PyResult<Vec<(String, Option<Py<PyBaseException>>)>> {
        let machine = py.detach(|| Ok::<_, Failure>(self.place()?.joined.machine.clone()))?;
        let selector = Selector::of(selector, machine.as_ref()).map_err(|error| explained(&error))?;
        let members = self.search(py, async |joined, caller| joined.select(caller, &selector).await)?;
        let named = |(name, failure): (String, Option<Failure>)| {
            (name, failure.map(|failure| PyErr::from(failure).into_value(py)))
        };
        Ok(members.into_iter().map(named).collect())
    }

    /// Records signals of these drives: at an interval, or with each cycle where none is given; for a time, or beside other calls
    /// until it is stopped.
    fn record(
        &self,
        py: Python<'_>,
        names: Vec<String>,
        signals: Vec<String>,
        every: Option<Span>,
        time: Option<Span>,
        most: usize,
    ) -> PyResult<Recording> {
        let every = match every {
            Some(every) => Every::Interval(every.read()?),
            None => Every::CYCLE,
        };
        let request = Request {
            time: time.map(|time| time.read()).transpose()?,
            ..Request::new(signals, every)
        };
        let place = py.detach(|| self.place())?;
        let inside = place.clone();
        let recorded = self.search(py, async move |joined, caller| {
            let members = joined.members(caller, &names).await?;
            let waits = request.time.is_some();
            // nothing but its end interrupts what goes on beside the calls
            let own = joined.caller(&StopRequests::default());
            let session = if waits { &*caller } else { &own };
            let clock = caller.wall_clock();
            let (recording, task) = record(inside, session, clock, members, &request, most).await?;
            if waits {
                task.await;
                recording.check()?;
                return Ok((recording, None));
            }
            Ok((recording, Some(task)))
        });
        let (recording, task) = recorded?;
        match task {
            Some(task) if place.is_plant() => locked(&place.joined.beside).push(Box::pin(task)),
            Some(task) => drop(std::thread::spawn(move || task.wait())),
            None => {}
        }
        Ok(recording)
    }

    /// Finds all stations and reads who they are; a report as JSON.
    fn scan(&self, py: Python<'_>, time: Span) -> PyResult<String> {
        let time = time.read()?;
        self.search(py, async |_, caller| {
            let found = scan::survey(caller, time, &mut |_, _| {}).await;
            document(&found.map_err(|error| of_client(&error))?.report)
        })
    }

    /// Names a station; a report as JSON.
    fn set_name(
        &self,
        py: Python<'_>,
        station: &str,
        name: &str,
        permanent: bool,
        dry_run: bool,
    ) -> PyResult<String> {
        self.permit(!dry_run)?;
        let wanted = NewName {
            permanent,
            dry_run,
            ..NewName::new(name)
        };
        self.station(py, station, async |caller, station| {
            document(&addressing::set_name(caller, station, &wanted).await?)
        })
    }

    /// Gives a station an address; a report as JSON.
    #[expect(
        clippy::too_many_arguments,
        reason = "each is an argument of the call in Python"
    )]
    fn set_ip(
        &self,
        py: Python<'_>,
        station: &str,
        address: u32,
        mask: u32,
        gateway: u32,
        permanent: bool,
        dry_run: bool,
    ) -> PyResult<String> {
        self.permit(!dry_run)?;
        let ip = IpSuite {
            address: Ipv4Addr::from(address),
            mask: Ipv4Addr::from(mask),
            gateway: Ipv4Addr::from(gateway),
        };
        let wanted = NewAddress {
            permanent,
            dry_run,
            ..NewAddress::new(ip)
        };
        self.station(py, station, async |caller, station| {
            document(&addressing::set_ip(caller, station, &wanted).await?)
        })
    }

    /// Lets a station blink; a report as JSON.
    fn blink(&self, py: Python<'_>, station: &str, time: Span) -> PyResult<String> {
        let time = time.read()?;
        self.station(py, station, async |caller, station| {
            document(&addressing::blink(caller, station, time, || {}).await?)
        })
    }

    /// Stops all axes that this program has under control; does not wait.
    fn stop_all(&self, py: Python<'_>, quick: bool) -> PyResult<()> {
        py.detach(|| {
            self.place()?.joined.caller.stop_all(quick);
            Ok(())
        })
    }

    /// Takes control of an axis.
    #[expect(
        clippy::too_many_arguments,
        reason = "each is an argument of the call in Python"
    )]
    fn control(
        &self,
        py: Python<'_>,
        drive: &str,
        max_speed: &str,
        mode: Option<&str>,
        telegram: Option<u16>,
        cycle: Option<Span>,
        lease: Span,
        set_mode: bool,
        accept_no_timeout: bool,
    ) -> PyResult<Axis> {
        self.permit(true)?;
        let wanted = Wanted {
            limit: Wanted::limit(max_speed)?,
            mode: mode.map(Wanted::mode).transpose()?,
            telegram,
            cycle: cycle.map(|cycle| cycle.read()).transpose()?,
            lease: lease.read()?,
            set_mode,
            may_run_on: accept_no_timeout,
        };
        let place = py.detach(|| self.place())?;
        let requests = StopRequests::default();
        let obeyed = requests.clone();
        self.call(py, drive, None, async move |caller, drive| {
            // its calls have requests of their own
            let mut own = caller.clone();
            own.obey(&obeyed);
            Axis::take(place, requests, &mut own, drive, &wanted).await
        })
    }

    /// Closes the network; not waited for any longer than this time.
    fn close(&self, py: Python<'_>, timeout: Span) -> PyResult<()> {
        let timeout = timeout.read()?;
        py.detach(|| {
            let place = self.place()?;
            place.goes_on();
            place.joined.close(timeout)
        })
    }
}
