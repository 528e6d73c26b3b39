//! From the command line to a session with a drive: which interface, which way, which rights.

use client::{Drive, DriveAddress, Error, LineAddress, Wait};
use network::system::{Error as NetworkError, ForcedExit, InterfaceInfo, Stop};
use profidrive::{Access, Network, OpenError, Opening, Reach, Way, far, open_line, reach};
use profinet::IpSuite;

use crate::args::Interface;
use crate::commands::vendor;
use crate::failure::{Exit, Failure};
use crate::output::Output;
use crate::render::table::clean;

pub use crate::output::{bar, spinner};

/// What a command needs of the network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Discovery and addressing.
    Discovery,
    /// Records; UDP is enough for a drive given by IP address.
    Records,
    /// Records of a device that need not be a drive.
    Identity,
    /// Cyclic data.
    Cyclic,
    /// Records, and cyclic data where the drive has no other means to be stopped; beside a controller on this computer too.
    Stop,
}

impl Need {
    const fn access(self) -> Access {
        match self {
            Self::Discovery => Access::Discovery,
            Self::Records | Self::Identity => Access::Records,
            Self::Cyclic => Access::Cyclic,
            Self::Stop => Access::Stop,
        }
    }
}

/// A session on a real network, or a serial line.
pub type Live = Network;

/// Opens the network for a command.
pub fn session(
    interface: &Interface,
    need: Need,
    drive: Option<&DriveAddress>,
    output: &Output,
) -> Result<Live, Failure> {
    // what moves an axis may take long to bring it to rest: the second signal is a quick stop
    let signals = match need {
        Need::Cyclic | Need::Stop => ForcedExit::Third,
        Need::Discovery | Need::Records | Need::Identity => ForcedExit::Second,
    };
    let stop = Stop::on_signals_with(signals)
        .map_err(|error| Failure::new(Exit::Failed, format!("cannot watch for Ctrl-C: {error}")))?;
    let by_ip = matches!(
        (need, drive),
        (
            Need::Records | Need::Identity | Need::Stop,
            Some(DriveAddress::Ip(_))
        )
    );
    let opening = Opening::new(need.access()).by_ip(by_ip).stopped_by(stop.clone());
    let named = named(interface);
    let opening = match &named {
        Some(name) => opening.on(name),
        None => opening,
    };
    let mut session = opening.open().map_err(without_right)?;
    if named.is_some() && matches!(session.way(), Way::Udp) {
        output.say("no raw socket can be opened: going by UDP alone");
    }
    let (flag, urgent, printer) = (stop.clone(), stop, output.clone());
    let details = output.clone();
    session.follow_routes(move |drive, notice| details.detail(&clean(&format!("{drive}: {notice}"))));
    let reader = output.clone();
    session.interrupt_with(move || flag.is_stopped() || reader.is_closed());
    session.hurry_with(move || {
        let now = urgent.is_urgent();
        if now {
            printer.say("second signal: quick stop (OFF3) in place of the ramp; a third one ends this program at once");
        }
        now
    });
    Ok(session)
}

/// Returns the paths that work without permission for raw sockets.
fn without_right(error: OpenError) -> Failure {
    let missing = matches!(error, OpenError::Network(NetworkError::NoPermission { .. }));
    let failure = Failure::from(error);
    if !missing {
        return failure;
    }
    let hint = failure.hint.clone().unwrap_or_default();
    failure.hint(format!(
        "{hint}; reading and writing a drive given by its IP needs no right"
    ))
}

/// Returns the interface that was named, as an option or in the environment.
fn named(option: &Interface) -> Option<String> {
    let variable = || std::env::var("PROFIDRIVE_INTERFACE").ok();
    // an empty variable is not a variable
    option
        .interface
        .clone()
        .or_else(variable)
        .filter(|name| !name.is_empty())
}

/// Returns the interface to use: as configured, else the only one there is.
pub fn interface(option: &Interface) -> Result<Option<String>, Failure> {
    match named(option) {
        Some(name) => Ok(Some(name)),
        None => Ok(profidrive::interface()?),
    }
}

/// Failure when no interface was named and no unique one exists.
pub fn no_interface() -> Failure {
    OpenError::no_interface().into()
}

/// Opens the network and finds the drive.
pub fn drive(
    interface: &Interface,
    need: Need,
    text: &str,
    output: &Output,
) -> Result<(Live, Drive), Failure> {
    let address: DriveAddress = text.parse().map_err(|error: client::DriveAddressError| {
        Failure::usage(error.to_string())
            .hint("DRIVE is a station name (akd-1), an IP address, a MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS at a serial line")
    })?;
    if let DriveAddress::Line(at) = &address {
        return at_line(at, interface, need, output);
    }
    let mut session = session(interface, need, Some(&address), output)?;
    if need == Need::Stop {
        session.tolerate_unread();
    }
    let spinner = spinner(output, format!("looking for {address}"));
    let found = session.find(&address).wait();
    spinner.finish_and_clear();
    let drive = found.map_err(|error| not_found(error, session.way(), &address))?;
    let mut drive = match interface.model {
        Some(model) => drive.as_model(model),
        None => drive,
    };
    if let Some(file) = &interface.gsdml {
        vendor::describe(file, &mut drive)?;
    }
    if let (Way::Packet(info), true) = (session.way(), need != Need::Discovery) {
        match reach(&info.name, &info.addresses, &drive.label(), drive.station.ip)? {
            Reach::Near => {}
            Reach::Routed(words) => output.warn(&words),
        }
    }
    let known = match (need, interface.model) {
        (Need::Discovery, _) => Ok(()),
        (_, None) => learn(&mut session, &mut drive, output),
        // without tables only the drive knows its axis
        (_, Some(_)) => session.find_channel(&mut drive).wait(),
    };
    match known {
        // a device without parameters still has its identity
        Err(Error::NotADrive { .. } | Error::NoRoute { .. } | Error::ParametersOwned { .. })
            if need == Need::Identity => {}
        // a stop goes on without parameters
        _ if need == Need::Stop && session.unread().is_some() => {}
        other => other?,
    }
    Ok((session, drive))
}

/// Reads the parameter descriptions of a drive without a built-in catalogue.
fn learn(session: &mut Live, drive: &mut Drive, output: &Output) -> Result<(), Error> {
    if drive.model.catalogue.is_some() {
        return Ok(());
    }
    let bar = bar(output, 0, "asking the drive what its parameters are");
    session
        .recognise(drive, &mut |done, all| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        })
        .wait()?;
    bar.finish_and_clear();
    Ok(())
}

/// Opens the serial port and finds the drive.
fn at_line(
    at: &LineAddress,
    interface: &Interface,
    need: Need,
    output: &Output,
) -> Result<(Live, Drive), Failure> {
    if need == Need::Discovery {
        return Err(Failure::usage(format!(
            "{at} is at a serial line: it has no station name, IP address or signal"
        )));
    }
    let stop = Stop::on_signals()
        .map_err(|error| Failure::new(Exit::Failed, format!("cannot watch for Ctrl-C: {error}")))?;
    let mut session = open_line(at, Some(stop.clone()))?;
    if need == Need::Stop {
        session.tolerate_unread();
    }
    session.interrupt_with(move || stop.is_stopped());
    let spinner = spinner(output, format!("looking for {at}"));
    let found = session.find(&DriveAddress::Line(at.clone())).wait();
    spinner.finish_and_clear();
    let drive = found?;
    let drive = match interface.model {
        Some(model) => drive.as_model(model),
        None => drive,
    };
    Ok((session, drive))
}

/// Words the failure when no station answered; without discovery the address may be the cause.
fn not_found(error: Error, way: &Way, address: &DriveAddress) -> Failure {
    let failure = Failure::from(error);
    let (Way::Udp, DriveAddress::Ip(ip)) = (way, address) else {
        return failure;
    };
    let own = InterfaceInfo::list().unwrap_or_default();
    let own: Vec<IpSuite> = own.into_iter().flat_map(|info| info.addresses).collect();
    match far(&own, *ip) {
        Some(words) if failure.exit == Exit::Unreachable => failure.hint(words),
        _ => failure,
    }
}
