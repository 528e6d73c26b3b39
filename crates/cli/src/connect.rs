//! From the command line to a session with a drive: which interface, which way, which rights.

use std::net::Ipv4Addr;
use std::time::{SystemTime, UNIX_EPOCH};

use client::{Drive, DriveAddress, Error, LineAddress, LineConfig, Session};
use network::linux::{
    Error as NetworkError, InterfaceInfo, PacketMedium, Patience, ServerPort, Stop, UdpMedium,
};
use profinet::controller::ControllerConfig;
use profinet::{IpSuite, MacAddress};

use crate::args::Interface;
use crate::carrier::{self, Carrier};
use crate::commands::maker;
use crate::failure::{Exit, Failure};
use crate::output::Output;
use crate::reach::{Reach, far, reach};
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

/// A session on a real network, or a serial line.
pub type Live = Session<Carrier>;

/// Opens the network for a command.
pub fn session(
    interface: &Interface,
    need: Need,
    drive: Option<&DriveAddress>,
    output: &Output,
) -> Result<Live, Failure> {
    // what moves an axis may take long to bring it to rest: the second signal is a quick stop
    let patience = match need {
        Need::Cyclic | Need::Stop => Patience::Third,
        Need::Discovery | Need::Records | Need::Identity => Patience::Second,
    };
    let stop = Stop::on_signals_with(patience)
        .map_err(|error| Failure::new(Exit::Failed, format!("cannot watch for Ctrl-C: {error}")))?;
    let by_ip = matches!(
        (need, drive),
        (
            Need::Records | Need::Identity | Need::Stop,
            Some(DriveAddress::Ip(_))
        )
    );
    let mut session = match (self::interface(interface)?, by_ip) {
        (Some(name), _) => match PacketMedium::open(&name, server(need)) {
            Err(NetworkError::NoPermission { .. }) if by_ip => {
                output.say("no right to open a raw socket: going by UDP alone");
                udp(need, &stop)?
            }
            Err(error @ NetworkError::NoPermission { .. }) => {
                let failure = Failure::from(error);
                let hint = failure.hint.clone().unwrap_or_default();
                return Err(failure.hint(format!(
                    "{hint}; reading and writing a drive given by its IP needs no right"
                )));
            }
            Err(error) => return Err(error.into()),
            Ok(medium) => packet(medium, need, &stop)?,
        },
        (None, true) => udp(need, &stop)?,
        (None, false) => return Err(no_interface()),
    };
    let (flag, urgent, told) = (stop.clone(), stop, output.clone());
    let details = output.clone();
    session.follow_routes(move |drive, notice| details.detail(&clean(&format!("{drive}: {notice}"))));
    let reader = output.clone();
    session.interrupt_with(move || flag.is_stopped() || reader.is_closed());
    session.hurry_with(move || {
        let now = urgent.is_urgent();
        if now {
            told.say("second signal: quick stop (OFF3) in place of the ramp; a third one ends this program at once");
        }
        now
    });
    Ok(session)
}

fn server(need: Need) -> ServerPort {
    match need {
        // devices call back on this port when a cyclic connection becomes ready
        Need::Cyclic => ServerPort::Required,
        Need::Records | Need::Identity => ServerPort::IfFree,
        // the drive calls back on it, even while a client on this computer has it that is suspended
        Need::Stop => ServerPort::Shared,
        // left to a controller that starts meanwhile
        Need::Discovery => ServerPort::None,
    }
}

fn packet(mut medium: PacketMedium, need: Need, stop: &Stop) -> Result<Live, Failure> {
    let info = medium.interface().clone();
    if need != Need::Discovery && !info.ip().is_set() {
        return Err(NetworkError::NoAddress { interface: info.name }.into());
    }
    medium.set_stop(stop.clone());
    let config = config(info.usable()?, info.ip());
    let hears_calls = medium.hears_calls();
    let session = Session::new(Carrier::Packet(Box::new(medium)), config);
    Ok(if hears_calls {
        session
    } else {
        session.without_calls()
    })
}

fn udp(need: Need, stop: &Stop) -> Result<Live, Failure> {
    let mut medium = UdpMedium::open(Ipv4Addr::UNSPECIFIED, server(need))?;
    medium.set_stop(stop.clone());
    let mac = InterfaceInfo::list()
        .ok()
        .and_then(|all| all.into_iter().find(|info| info.up && !info.loopback)?.mac)
        .unwrap_or(MacAddress([2, 0, 0, 0, 0, 1]));
    let config = config(mac, IpSuite::NONE);
    let hears_calls = medium.hears_calls();
    let session = Session::new(Carrier::Udp(Box::new(medium)), config).without_discovery();
    Ok(if hears_calls {
        session
    } else {
        session.without_calls()
    })
}

fn config(mac: MacAddress, ip: IpSuite) -> ControllerConfig {
    let seed = seed();
    let mut config = ControllerConfig::new(mac, ip, "profidrive", seed);
    // several commands may run side by side
    config.client_port = 0xC000 | u16::try_from(seed >> 17 & 0x3FFF).unwrap_or(0);
    config
}

/// Differs from one start of the program to the next.
fn seed() -> u64 {
    let time = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let nanos = u64::try_from(time.as_nanos() & u128::from(u64::MAX)).unwrap_or_default();
    (nanos ^ u64::from(std::process::id()).rotate_left(40)).wrapping_mul(0x9E37_79B9_7F4A_7C15)
}

/// The interface to use: as told, else the only one there is.
pub fn interface(told: &Interface) -> Result<Option<String>, Failure> {
    let variable = || std::env::var("PROFIDRIVE_INTERFACE").ok();
    // an empty variable is no variable
    if let Some(name) = told
        .interface
        .clone()
        .or_else(variable)
        .filter(|name| !name.is_empty())
    {
        return Ok(Some(name));
    }
    let usable: Vec<InterfaceInfo> = InterfaceInfo::list()?
        .into_iter()
        .filter(|info| !info.loopback && info.usable().is_ok())
        .collect();
    match <[InterfaceInfo; 1]>::try_from(usable) {
        Ok([only]) => Ok(Some(only.name)),
        Err(_) => Ok(None),
    }
}

/// No interface was named, and there is none to take without asking.
pub fn no_interface() -> Failure {
    let names: Vec<String> = InterfaceInfo::list()
        .unwrap_or_default()
        .into_iter()
        .filter(|info| !info.loopback)
        .map(|info| {
            if info.up {
                info.name
            } else {
                format!("{} (down)", info.name)
            }
        })
        .collect();
    let there = if names.is_empty() {
        "there is none".to_owned()
    } else {
        format!("there are: {}", names.join(", "))
    };
    Failure::usage("which network interface?").hint(format!("-i IFACE, or PROFIDRIVE_INTERFACE; {there}"))
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
    let found = session.find(&address);
    spinner.finish_and_clear();
    let drive = found.map_err(|error| not_found(error, session.medium(), &address))?;
    let mut drive = match interface.model {
        Some(model) => drive.taken_for(model),
        None => drive,
    };
    if let Some(file) = &interface.gsdml {
        maker::describe(file, &mut drive)?;
    }
    if let (Carrier::Packet(medium), true) = (session.medium(), need != Need::Discovery) {
        let info = medium.interface();
        match reach(&info.name, &info.addresses, &drive.label(), drive.station.ip)? {
            Reach::Near => {}
            Reach::Routed(words) => output.warn(&words),
        }
    }
    let known = match (need, interface.model) {
        (Need::Discovery, _) => Ok(()),
        (_, None) => learn(&mut session, &mut drive, output),
        // without tables only the drive knows its axis
        (_, Some(_)) => session.find_channel(&mut drive),
    };
    match known {
        // a device without parameters still has its identity
        Err(Error::NotADrive { .. } | Error::NoRoute { .. } | Error::ParametersOwned { .. })
            if need == Need::Identity => {}
        // a stop needs no parameters
        _ if need == Need::Stop && session.unread().is_some() => {}
        other => other?,
    }
    Ok((session, drive))
}

/// A drive of which there are no tables is asked for them.
fn learn(session: &mut Live, drive: &mut Drive, output: &Output) -> Result<(), Error> {
    if drive.model.catalogue.is_some() {
        return Ok(());
    }
    let bar = bar(output, 0, "asking the drive what its parameters are");
    session.recognise(drive, &mut |done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    })?;
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
    let mut line = carrier::open(at)?;
    line.set_stop(stop.clone());
    let config = LineConfig::new(at.protocol, at.baud);
    let mut session = Session::on_line(Carrier::Serial(Box::new(line)), config);
    if need == Need::Stop {
        session.tolerate_unread();
    }
    session.interrupt_with(move || stop.is_stopped());
    let spinner = spinner(output, format!("looking for {at}"));
    let found = session.find(&DriveAddress::Line(at.clone()));
    spinner.finish_and_clear();
    let drive = found?;
    let drive = match interface.model {
        Some(model) => drive.taken_for(model),
        None => drive,
    };
    Ok((session, drive))
}

/// Nobody answered; without discovery the address may be the reason.
fn not_found(error: Error, medium: &Carrier, address: &DriveAddress) -> Failure {
    let failure = Failure::from(error);
    let (Carrier::Udp(_), DriveAddress::Ip(ip)) = (medium, address) else {
        return failure;
    };
    let own = InterfaceInfo::list().unwrap_or_default();
    let own: Vec<IpSuite> = own.into_iter().flat_map(|info| info.addresses).collect();
    match far(&own, *ip) {
        Some(words) if failure.exit == Exit::Unreachable => failure.hint(words),
        _ => failure,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_cyclic_data_needs_the_port_of_the_controller() {
        assert_eq!(server(Need::Discovery), ServerPort::None);
        assert_eq!(server(Need::Records), ServerPort::IfFree);
        // a client on this computer that runs a drive must not keep it from being stopped
        assert_eq!(server(Need::Stop), ServerPort::Shared);
        assert_eq!(server(Need::Cyclic), ServerPort::Required);
    }
}
