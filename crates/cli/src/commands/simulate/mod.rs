//! `profidrive simulate --model akd --name akd-1 -i IFACE`

mod line;
mod mailbox;
mod maker;
mod plans;
mod saving;
mod scribe;
mod taken;
mod virtual_time;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use network::files;
use network::host::StationId;
use network::linux::{Bell, Error as NetworkError, Runner, Stop, Turn, now};
use network::pcap::Writer;
use plant::{Happening, Scenario, ScenarioError, Timeline, Unit, What};
use profinet::controller;
use profinet::device::Stored;
use profinet::{Endpoint, Instant};
use virtual_drive::model::Model as DriveModel;
use virtual_drive::station::Station;

use crate::args::{DcpInOperation, Interface, Simulate};
use crate::connect;
use crate::desk::{self, Answer, Question, Request};
use crate::failure::{Exit, Failure};
use crate::output::Output;
use crate::state::{DriveState, StateFolder};

pub use line::SerialOptions;
use mailbox::Mailbox;
use maker::Maker;
pub use maker::model_of;
use plans::{Plan, plans};
use scribe::Scribe;
use taken::Wanted;

/// How long to sleep while nothing happens.
const NAP: Duration = Duration::from_secs(3600);
/// How often an interface that went away is looked for.
const RETRY: Duration = Duration::from_secs(1);

/// A drive as it runs.
#[derive(Debug)]
struct Running {
    keeping: Arc<Keeping>,
    line: Timeline,
}

/// A drive as its events need it.
#[derive(Debug)]
struct Keeping {
    key: String,
    model: &'static DriveModel,
    state: DriveState,
}

pub fn run(args: &Simulate, on: &Interface, output: &Output) -> Result<(), Failure> {
    let scenario = args.plant.as_deref().map(read).transpose()?;
    if let Some(scenario) = scenario.as_ref().filter(|_| args.virtual_time) {
        return virtual_time::run(scenario, args.time, args.pcap.as_deref(), output);
    }
    if let Some(port) = &args.line.serial {
        return line::run(args, port, output);
    }
    let interface = connect::interface(on)?.ok_or_else(connect::no_interface)?;
    let maker = Maker::of(args, scenario.as_ref(), output)?;
    let mut runner = Runner::open(&interface)?;
    let host = runner.interface().mac;
    let seed = scenario.as_ref().map_or(1, |scenario| scenario.seed);
    let time = args.time.or_else(|| scenario.as_ref()?.duration);
    let plans: Vec<Plan> = match scenario {
        None => plans(args, maker.model, host)?,
        Some(scenario) => {
            if !scenario.controllers.is_empty() {
                output.warn("the controllers of the scenario are left out: they exist in virtual time only");
            }
            scenario.drives.into_iter().map(Plan::from).collect()
        }
    };
    let folder = args.state.as_deref().map(StateFolder::open).transpose()?;
    let stop = Stop::on_signals()
        .map_err(|error| Failure::new(Exit::Failed, format!("cannot watch for Ctrl-C: {error}")))?;
    runner.set_stop(stop)?;
    let mut configs = Vec::new();
    for plan in &plans {
        let state = folder
            .as_ref()
            .map_or_else(DriveState::default, |folder| folder.drive(&plan.key()));
        let mut config = plan.drive.config();
        config.description = maker.description(plan.drive.model);
        config.follow_controller = true;
        config.refuses_in_operation = args.dcp_in_operation == DcpInOperation::Refuse;
        config.rotary = args.rotary;
        config.network = kept(&state, plan, output)?;
        config.parameters = saved(&state, plan.drive.model, output)?;
        configs.push((state, config));
    }
    let wanted: Vec<Wanted> = plans
        .iter()
        .zip(&configs)
        .map(|(plan, (_, config))| Wanted::new(&plan.key(), plan.drive.mac, &config.network))
        .collect();
    let mut asked = Some(taken::Question::ask(&mut runner, wanted)?);
    if let Some(path) = &args.pcap {
        runner.add_tap(Box::new(capture(path, &interface)?));
    }
    let start = now();
    let end = time.map(|time| start + time);
    let mut drives: BTreeMap<StationId, Running> = BTreeMap::new();
    let bell = Bell::new()
        .map_err(|error| Failure::new(Exit::Failed, format!("cannot wait for requests: {error}")))?;
    runner.set_bell(bell.clone())?;
    let scribe = Scribe::new(output.clone(), bell.clone());
    let mut ready = Vec::new();
    for (number, (plan, (state, config))) in plans.iter().zip(configs).enumerate() {
        let key = plan.key();
        let unit = plan.drive.build(config, seed.wrapping_add(number as u64));
        let mut unit = unit.map_err(|error| Failure::new(Exit::Failed, error.to_string()))?;
        if state.is_kept() {
            unit.inner_mut().endpoint_mut().confirm_saves();
        }
        let told = told(unit.inner().endpoint());
        let id = runner.attach(Box::new(unit))?;
        let keeping = Arc::new(Keeping {
            key,
            model: plan.drive.model,
            state,
        });
        ready.push((Arc::clone(&keeping), format!("ready: {told}")));
        drives.insert(
            id,
            Running {
                keeping,
                line: Timeline::new(&plan.drive.cues, start),
            },
        );
    }
    // without it everything works but `inject`
    let mailbox = Mailbox::open(bell);
    if let Err(failure) = &mailbox {
        output.warn(&format!(
            "`profidrive inject` will not reach these drives: {}",
            failure.message
        ));
    }
    for (keeping, text) in ready {
        scribe.say(&keeping, now() - start, text);
    }
    output.say(&format!("{} on {interface}; Ctrl-C ends", count(plans.len())));
    let (mut away, mut next_try) = (false, now());
    loop {
        let next = drives.values().filter_map(|drive| drive.line.next()).min();
        let answered = asked.as_ref().map(taken::Question::due);
        let until = [Some(now() + if away { RETRY } else { NAP }), next, end, answered];
        let turn = match runner.step(until.into_iter().flatten().min().unwrap_or(Instant::MAX)) {
            Err(error @ (NetworkError::InterfaceDown { .. } | NetworkError::InterfaceGone { .. })) => {
                output.warn(&format!(
                    "{error}: waiting until it is back; the drives go on without it"
                ));
                (away, next_try) = (true, now() + RETRY);
                Turn::Worked
            }
            other => other?,
        };
        if away && now() >= next_try {
            next_try = now() + RETRY;
            away = !is_back(runner.reopen())?;
            if !away {
                output.say(&format!("{interface} is back"));
            }
        }
        if let Some(question) = asked.take_if(|question| question.due() <= now()) {
            question.tell(&mut runner, output)?;
        }
        if turn == Turn::Rung {
            while let Some(report) = scribe.report() {
                let id = drives
                    .iter()
                    .find(|(_, running)| Arc::ptr_eq(&running.keeping, &report.drive));
                if let Some(unit) = id.and_then(|(id, _)| runner.station_mut::<Unit>(*id)) {
                    report.deliver(unit.inner_mut().endpoint_mut(), now());
                }
            }
            while let Some((question, answer)) = mailbox.as_ref().ok().and_then(Mailbox::take) {
                // whoever asked may be gone
                let _ = answer.send(match question {
                    Question::Inject(request) => inject(&request, &runner, &mut drives),
                    Question::Drives(segment) => roll(&segment, &runner, &drives),
                });
            }
        }
        for turn in 0..runner.touched().len() {
            let Some(id) = runner.touched().get(turn).copied() else {
                continue;
            };
            // most turns have no event: looking first leaves the station undisturbed
            let waiting = runner
                .station::<Unit>(id)
                .is_some_and(|unit| unit.inner().endpoint().has_event());
            let Some(drive) = drives.get(&id).filter(|_| waiting) else {
                continue;
            };
            while let Some(event) = runner
                .station_mut::<Unit>(id)
                .and_then(|unit| unit.inner_mut().endpoint_mut().poll_event())
            {
                scribe.happened(&drive.keeping, now() - start, event);
            }
        }
        for (id, drive) in &mut drives {
            let at = now();
            let due = drive.line.next().is_some_and(|next| next <= at)
                || drive.line.watches_position()
                    && runner
                        .station::<Unit>(*id)
                        .is_some_and(|unit| drive.line.is_due(at, unit));
            if !due {
                continue;
            }
            if let Some(unit) = runner.station_mut::<Unit>(*id) {
                for played in drive.line.play(at, unit) {
                    scribe.say(&drive.keeping, at - start, What::Happened(played).to_string());
                }
            }
        }
        if turn == Turn::Stopped || end.is_some_and(|end| now() >= end) {
            break;
        }
    }
    for (id, drive) in &drives {
        let Some(unit) = runner.station_mut::<Unit>(*id) else {
            continue;
        };
        let station = unit.inner_mut().endpoint_mut();
        station.switch_off();
        while let Some(event) = station.poll_event() {
            scribe.happened(&drive.keeping, now() - start, event);
        }
    }
    scribe.finish();
    runner
        .finish_taps()
        .map_err(|error| Failure::new(Exit::Failed, format!("the capture is not complete: {error}")))
}

/// Octets that a plant file may have at most.
const MOST_OCTETS: u64 = 4 << 20;

/// Reads a plant file, not more than one may have.
fn read(path: &Path) -> Result<Scenario, Failure> {
    let failed = |why: String| Failure::new(Exit::Failed, format!("{}: {why}", path.display()));
    let mut octets = Vec::new();
    // one more than is taken, so that a longer file is told as such
    File::open(path)
        .and_then(|file| file.take(MOST_OCTETS + 1).read_to_end(&mut octets))
        .map_err(|error| failed(error.to_string()))?;
    if octets.len() as u64 > MOST_OCTETS {
        return Err(failed(format!(
            "longer than {MOST_OCTETS} octets, this is no plant file"
        )));
    }
    let text = String::from_utf8(octets).map_err(|_| failed("this is no text (UTF-8)".to_owned()))?;
    text.parse()
        .map_err(|error: ScenarioError| Failure::usage(format!("{}, {error}", path.display())))
}

/// Name and address that a drive begins with: those kept from an earlier run, else those of the plan, which are kept now.
fn kept(state: &DriveState, plan: &Plan, output: &Output) -> Result<Stored, Failure> {
    let planned = plan.drive.config().network;
    let found = state.read_network()?;
    found.warning.iter().for_each(|warning| output.warn(warning));
    let Some(mut network) = found.content else {
        if !planned.name.is_empty() || planned.ip.is_set() {
            state.write_network(&planned)?;
        }
        return Ok(planned);
    };
    if planned.ip.is_set() && !network.ip.is_set() {
        network.ip = planned.ip;
        state.write_network(&network)?;
    } else if planned.ip.is_set() && planned.ip != network.ip {
        output.warn(&format!(
            "{}: the address {} kept in --state counts, not {}; `profidrive ip` changes it",
            plan.key(),
            network.ip.address,
            planned.ip.address
        ));
    }
    Ok(network)
}

/// Parameters that a drive begins with: those kept from an earlier run.
fn saved(state: &DriveState, model: &DriveModel, output: &Output) -> Result<Option<Vec<u8>>, Failure> {
    let found = state.read_parameters(model)?;
    found.warning.iter().for_each(|warning| output.warn(warning));
    Ok(found.content)
}

/// The drives, where they are on this segment.
fn roll(segment: &str, runner: &Runner, drives: &BTreeMap<StationId, Running>) -> Answer {
    if segment != desk::segment(&runner.interface().name) {
        return Answer::Drives(Vec::new());
    }
    let units = drives.keys().filter_map(|id| runner.station::<Unit>(*id));
    let stations = units.map(|unit| {
        let station = unit.inner().endpoint();
        controller::Station {
            name: station.name().to_owned(),
            mac: station.mac(),
            ip: station.ip(),
            ..controller::Station::default()
        }
    });
    Answer::Drives(stations.collect())
}

/// Does what `profidrive inject` asks for.
fn inject(request: &Request, runner: &Runner, drives: &mut BTreeMap<StationId, Running>) -> Answer {
    let is_meant = |station: &Station| {
        station.name() == request.drive
            || station.mac().to_string().eq_ignore_ascii_case(&request.drive)
            || station.ip().is_set() && station.ip().address.to_string() == request.drive
    };
    let found: Vec<StationId> = drives
        .iter()
        .filter(|(id, drive)| {
            let unit = runner.station::<Unit>(**id);
            drive.keeping.key == request.drive || unit.is_some_and(|unit| is_meant(unit.inner().endpoint()))
        })
        .map(|(id, _)| *id)
        .collect();
    if found.len() > 1 {
        return Answer::Refused(format!(
            "{} drives of this simulation go by this name; say which one by its IP or MAC address",
            found.len()
        ));
    }
    let found = found.first().and_then(|id| Some((*id, drives.get_mut(id)?)));
    let Some((id, drive)) = found else {
        return Answer::NotHere(drives.values().map(|drive| drive.keeping.key.clone()).collect());
    };
    let who = runner.station::<Unit>(id).map_or_else(String::new, |unit| {
        let station = unit.inner().endpoint();
        let ip = station.ip();
        let ip = if ip.is_set() {
            ip.address.to_string()
        } else {
            "no IP address".into()
        };
        let (key, interface) = (&drive.keeping.key, &runner.interface().name);
        format!(
            "{key} ({}, {ip}) on {interface}, process {}",
            station.mac(),
            std::process::id()
        )
    });
    let here = request.from == desk::namespace();
    if request.happenings.is_empty() {
        return Answer::Done { drive: who, here };
    }
    match happenings(request, drive.keeping.model) {
        Err(why) => Answer::Refused(why),
        Ok(happenings) => {
            let lasts = request.lasts.map(Duration::from_nanos);
            for happening in happenings {
                drive.line.add(now(), happening, lasts);
            }
            let drive = drive.keeping.key.clone();
            Answer::Done { drive, here }
        }
    }
}

/// What a request asks for, if it can happen to a drive of this model.
fn happenings(request: &Request, model: &DriveModel) -> Result<Vec<Happening>, String> {
    let read = |text: &String| {
        let happening: Happening = text.parse()?;
        happening.fits(model).map(|()| happening)
    };
    let all: Result<Vec<Happening>, plant::HappeningError> = request.happenings.iter().map(read).collect();
    all.map_err(|error| error.to_string())
}

/// Whether the interface could be opened again; down and not there are no failures.
fn is_back(reopened: Result<(), NetworkError>) -> Result<bool, Failure> {
    match reopened {
        Ok(()) => Ok(true),
        Err(
            NetworkError::InterfaceDown { .. }
            | NetworkError::InterfaceGone { .. }
            | NetworkError::NoSuchInterface { .. },
        ) => Ok(false),
        Err(error) => Err(error.into()),
    }
}

fn count(drives: usize) -> String {
    if drives == 1 {
        "1 drive".into()
    } else {
        format!("{drives} drives")
    }
}

fn capture(path: &Path, interface: &str) -> Result<Writer<File>, Failure> {
    let failed = |error: std::io::Error| {
        Failure::new(Exit::Failed, format!("cannot write {}: {error}", path.display()))
    };
    let file = files::create(path).map_err(|error| Failure::new(Exit::Failed, error.to_string()))?;
    let wall = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let origin = wall.saturating_sub(now() - Instant::ZERO);
    Writer::new(file, interface, origin).map_err(failed)
}

fn told(station: &Station) -> String {
    let (mac, ip) = (station.mac(), station.ip());
    let name = match station.name() {
        "" => "no name",
        name => name,
    };
    if ip.is_set() {
        format!("{name}, {mac}, {}", ip.address)
    } else if station.acquires_address() {
        format!("{name}, {mac}, looks for an address (DHCP, AutoIP)")
    } else {
        format!("{name}, {mac}, waits for its address")
    }
}
