//! From the command line to a session with a drive: options and signals in, messages and progress out.

use std::path::PathBuf;

use client::{Drive, ErrorKind, Wait};
use network::system::{Error as NetworkError, ForcedExit, Stop};
use profidrive::fleet::Fleet;
use profidrive::machine::Machine;
use profidrive::{DescriptionError, DriveError, FindEvent, Network, OpenError, Opening, Selector};

use crate::args::{DriveOptions, Interface, Kind, Target};
use crate::commands::gsdml;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::clean;

pub use crate::output::{bar, spinner, steps};
/// What a command needs of the network.
pub use profidrive::Access as Need;

/// A session on a real network, or a serial line.
pub type Live = Network;

/// Opens the network for a command.
pub fn session(interface: &Interface, need: Need, output: &Output) -> Result<Live, Failure> {
    let (opening, stop) = opening(interface, need)?;
    let session = opening.open().map_err(|error| unopened_on(interface, error))?;
    Ok(attended(session, &stop, QUICK_STOP, output))
}

/// Returns which drives are meant.
pub fn selector(target: &Target, output: &Output) -> Result<Selector, Failure> {
    let is_all = |part: &str| part.trim().eq_ignore_ascii_case("all");
    // where no drive of it is meant no machine file is read: a file that is not valid must not keep a drive from being stopped
    let machine = if target.drive.contains('@') {
        machine(&target.options, output)?
    } else if target.drive.split(',').any(is_all) {
        machine(&target.options, output).unwrap_or_else(|failure| {
            static SAID: std::sync::Once = std::sync::Once::new();
            SAID.call_once(|| {
                output.warn(&format!(
                    "{}; drives of it that do not answer are not shown",
                    failure.message
                ));
            });
            None
        })
    } else {
        None
    };
    Selector::of(&target.drive, machine.as_ref()).map_err(|error| Failure::explained(&error))
}

/// Returns where the machine file is: as configured, else `machine.toml` in the current folder where there is one.
pub fn machine_path(options: &DriveOptions) -> Option<PathBuf> {
    let variable = || std::env::var_os("PROFIDRIVE_MACHINE").filter(|path| !path.is_empty());
    let named = options.machine.clone().or_else(|| variable().map(PathBuf::from));
    // what exists and cannot be read is an error later on, not silence
    let usual = || Some(PathBuf::from("machine.toml")).filter(|path| std::fs::symlink_metadata(path).is_ok());
    named.or_else(usual)
}

/// Reads the machine file, where there is one.
pub fn machine(options: &DriveOptions, output: &Output) -> Result<Option<Machine>, Failure> {
    let Some(path) = machine_path(options) else {
        return Ok(None);
    };
    output.detail(&format!("machine file: {}", path.display()));
    Ok(Some(Machine::read(&path)?))
}

/// Opens the network or the serial line of a drive and finds the drive.
pub fn drive(target: &Target, need: Need, output: &Output) -> Result<(Live, Drive), Failure> {
    let selector = selector(target, output)?;
    let address = selector.single().ok_or_else(|| {
        Failure::usage(format!(
            "`{selector}` may be several drives, and this command is for one"
        ))
        .hint("name the drive; {scan} lists who answers")
    })?;
    let (opening, stop) = opening_for(target, need)?;
    let unopened = |error| unopened_on(&target.options.interface, error);
    let session = opening.open_to(address).map_err(unopened)?;
    let mut session = attended(session, &stop, QUICK_STOP, output);
    let mut shown = None;
    let mut observer = |event: FindEvent<'_>| match event {
        FindEvent::UdpAlone => output.say("no raw socket can be opened: going by UDP alone"),
        FindEvent::LookingFor(address) => shown = Some(spinner(output, format!("looking for {address}"))),
        FindEvent::Learning { done, all } => {
            let bar = shown.get_or_insert_with(|| bar(output, 0, "reading the parameter list of the drive"));
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        }
        FindEvent::Routed(words) => output.warn(words),
        // found: what comes next is shown by another bar
        _ => {
            if let Some(bar) = shown.take() {
                bar.finish_and_clear();
            }
        }
    };
    let found = opening.find(&mut session, address, &mut observer).wait();
    if let Some(bar) = shown {
        bar.finish_and_clear();
    }
    Ok((
        session,
        found.map_err(|error| failed(error, &target.options.kind))?,
    ))
}

/// Opens the network and finds the drives that are meant.
pub fn drives(target: &Target, need: Need, output: &Output) -> Result<(Live, Fleet), Failure> {
    drives_with(target, need, QUICK_STOP, output)
}

/// The same; `hurried` is printed with the second signal.
pub fn drives_with(
    target: &Target,
    need: Need,
    hurried: &'static str,
    output: &Output,
) -> Result<(Live, Fleet), Failure> {
    let selector = selector(target, output)?;
    let (opening, stop) = opening_for(target, need)?;
    let unopened = |error| unopened_on(&target.options.interface, error);
    let session = opening.open_for(&selector).map_err(unopened)?;
    let mut session = attended(session, &stop, hurried, output);
    let spinner = spinner(output, format!("looking for {selector}"));
    let found = opening.select(&mut session, &selector).wait();
    spinner.finish_and_clear();
    let found = found.map_err(|error| failed(error, &target.options.kind))?;
    for note in found.members.iter().flat_map(|member| &member.notes) {
        output.warn(note);
    }
    Ok((session, found))
}

/// Opens the network of the drives that are meant.
pub fn network(
    target: &Target,
    selector: &Selector,
    need: Need,
    output: &Output,
) -> Result<(Opening, Live), Failure> {
    let (opening, stop) = opening_for(target, need)?;
    let unopened = |error| unopened_on(&target.options.interface, error);
    let session = opening.open_for(selector).map_err(unopened)?;
    Ok((opening, attended(session, &stop, QUICK_STOP, output)))
}

/// Returns how to open the network for a verb that opens it itself.
pub fn unopened(target: &Target, need: Need) -> Result<Opening, Failure> {
    opening_for(target, need).map(|(opening, _)| opening)
}

fn opening_for(target: &Target, need: Need) -> Result<(Opening, Stop), Failure> {
    let (mut opening, stop) = opening(&target.options.interface, need)?;
    if let Some(model) = target.options.kind.model {
        opening = opening.as_model(model);
    }
    if let Some(file) = &target.options.kind.gsdml {
        opening = opening.described_by(gsdml::read(file)?);
    }
    Ok((opening, stop))
}

/// A drive that was not found, or cannot be worked with, as one of many.
impl From<DriveError> for Failure {
    fn from(error: DriveError) -> Self {
        failed(error, &Kind::default())
    }
}

fn opening(interface: &Interface, need: Need) -> Result<(Opening, Stop), Failure> {
    // what moves an axis may take long to bring it to rest: the second signal is a quick stop
    let signals = match need {
        Need::Cyclic | Need::Stop => ForcedExit::Third,
        Need::Discovery | Need::Records | Need::Identity => ForcedExit::Second,
    };
    let stop = Stop::on_signals_with(signals)
        .map_err(|error| Failure::new(ErrorKind::Internal, format!("cannot watch for Ctrl-C: {error}")))?;
    let opening = Opening::new(need).stopped_by(stop.clone());
    let opening = match named(interface) {
        Some(name) => opening.on(name),
        None => opening,
    };
    Ok((opening, stop))
}

/// What the second signal does to a motion.
const QUICK_STOP: &str =
    "second signal: quick stop (OFF3) in place of the ramp; a third one ends this program at once";

/// The same with the wishes of the person at the keyboard. A closed output is a wish to stop as the first signal is.
fn attended(mut session: Live, stop: &Stop, hurried: &'static str, output: &Output) -> Live {
    let (flag, urgent, printer) = (stop.clone(), stop.clone(), output.clone());
    let details = output.clone();
    session.follow_routes(move |drive, notice| details.detail(&clean(&format!("{drive}: {notice}"))));
    let reader = output.clone();
    session.interrupt_with(move || flag.is_stopped() || reader.is_closed());
    let mut said = false;
    session.hurry_with(move || {
        let now = urgent.is_urgent();
        if now && !std::mem::replace(&mut said, true) {
            printer.say(hurried);
        }
        now
    });
    session
}

/// Returns the failure of an interface that cannot be used, with where its name is from where that is not the command line.
fn unopened_on(interface: &Interface, error: OpenError) -> Failure {
    let failure = without_permission(error);
    match &interface.configured {
        Some(name) if explicit(interface).is_none() => failure.and_hint(format!(
            "the interface `{name}` is from the configuration file; -i IFACE names another"
        )),
        _ => failure,
    }
}

/// Returns the paths that work without permission for raw sockets.
pub fn without_permission(error: OpenError) -> Failure {
    let missing = matches!(error, OpenError::Network(NetworkError::NoPermission { .. }));
    let failure = Failure::from(error);
    if !missing {
        return failure;
    }
    failure.and_hint("reading and writing a drive given by its IP needs no permission")
}

/// Words the failure of a drive that was not found, or cannot be worked with.
fn failed(error: DriveError, taken_for: &Kind) -> Failure {
    match error {
        DriveError::Open(error) => without_permission(error),
        DriveError::Description(ref inner) => {
            let file = taken_for
                .gsdml
                .as_deref()
                .unwrap_or_else(|| "-".as_ref())
                .display();
            let failure = Failure {
                message: format!("{file}: {}", clean(&inner.to_string())),
                ..Failure::explained(&error)
            };
            match inner {
                DescriptionError::Modules(_) => failure.hint(format!(
                    "`profidrive gsdml show {file}` shows access points and modules"
                )),
                _ => failure,
            }
        }
        other => Failure::explained(&other),
    }
}

/// Returns the interface that was named, as an option, in the environment or in the configuration.
pub fn named(option: &Interface) -> Option<String> {
    explicit(option).or_else(|| option.configured.clone())
}

/// Returns the interface that was named as an option or in the environment.
fn explicit(option: &Interface) -> Option<String> {
    let variable = || std::env::var("PROFIDRIVE_INTERFACE").ok();
    // an empty variable is not a variable
    let named = option.interface.clone().or_else(variable);
    named.filter(|name| !name.is_empty())
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
