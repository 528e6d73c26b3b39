//! `profidrive simulate --model akd --serial /dev/ttyUSB0 --address 1`

use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use clap::{Args, ValueEnum};
use client::{LineAddress, Parity};
use network::linux::{Bell, Stop, now};
use network::serial::{Error as SerialError, Line, Port, Talker};
use plant::Happening;
use profinet::Instant;
use uss::SlaveConfig;
use virtual_drive::serial::{SerialConfig, SerialStation};
use virtual_drive::station::AnswerFault;

use super::mailbox::Mailbox;
use super::maker::Maker;
use super::plans::plans;
use super::scribe::{SaveReport, Scribe};
use super::{Keeping, RETRY, count};
use crate::args::Simulate;
use crate::desk::{Answer, Question, Request};
use crate::failure::{Exit, Failure};
use crate::output::Output;
use crate::state::{DriveState, StateFolder};
use profidrive::serial_settings;

/// Octets of one telegram may come so far apart: adapters hand them over in lumps.
const GAP: Duration = Duration::from_millis(30);
/// Time between two looks for questions of other processes, which a port does not wake for.
const GLANCE: Duration = Duration::from_millis(100);
/// Time between two steps while there is no port.
const WITHOUT: Duration = Duration::from_millis(10);

/// Drives at a serial line instead of a network.
#[derive(Debug, Args)]
pub struct SerialOptions {
    /// Serial port: the drives are slaves of a serial line instead of stations on a network
    #[arg(
        long,
        value_name = "PORT",
        conflicts_with_all = ["plant", "virtual_time", "gsdml", "ip", "mac", "min_cycle", "pcap"]
    )]
    pub serial: Option<String>,
    /// Protocol of the line
    #[arg(long, value_enum, default_value = "fc", requires = "serial")]
    pub protocol: Protocol,
    /// Address of the (first) drive: 1 to 126, USS 0 to 31
    #[arg(long, value_name = "N", default_value_t = 1, requires = "serial")]
    pub address: u8,
    /// Bits per second
    #[arg(long, default_value_t = 9600, requires = "serial")]
    pub baud: u32,
    /// Parity
    #[arg(long, value_name = "even|odd|none", default_value = "even", value_parser = parity, requires = "serial")]
    pub parity: Parity,
}

/// Protocols of a serial line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Protocol {
    /// Danfoss FC protocol
    Fc,
    /// USS
    Uss,
}

fn parity(text: &str) -> Result<Parity, &'static str> {
    let known = Parity::ALL.into_iter().find(|parity| parity.name() == text);
    known.ok_or("even, odd or none")
}

/// All drives of the line, each hearing what the others say.
struct LineUp {
    drives: Vec<(Arc<Keeping>, SerialStation)>,
    /// What ends again, when, and of which drive.
    ends: Vec<(Instant, usize, Happening)>,
}

impl LineUp {
    /// Does what `profidrive inject` asks for.
    fn inject(&mut self, request: &Request, line: &Place, now: Instant) -> Answer {
        let meant = |(keeping, station): &(Arc<Keeping>, SerialStation)| {
            keeping.key == request.drive || line.is(&request.drive, station.number())
        };
        let found: Vec<usize> = (0..self.drives.len())
            .filter(|at| self.drives.get(*at).is_some_and(meant))
            .collect();
        let one = match found.as_slice() {
            [at] => self.drives.get_mut(*at).map(|one| (*at, one)),
            [] => None,
            several => {
                return Answer::Refused(format!(
                    "{} drives of this simulation go by this name",
                    several.len()
                ));
            }
        };
        let Some((at, (keeping, station))) = one else {
            let all = self.drives.iter();
            return Answer::NotHere(all.map(|(_, station)| line.of(station.number())).collect());
        };
        let drive = line.of(station.number());
        if request.happenings.is_empty() {
            let drive = format!("{drive} ({}), process {}", keeping.key, std::process::id());
            return Answer::Done { drive, here: true };
        }
        let happenings = match super::happenings(request, keeping.model) {
            Err(why) => return Answer::Refused(why),
            Ok(happenings) => happenings,
        };
        if let Some(other) = happenings.iter().find(|happening| !is_on_line(happening)) {
            return Answer::Refused(format!(
                "`{other}` is of a network, the drive is at a serial line"
            ));
        }
        let lasts = request.lasts.map(Duration::from_nanos);
        for happening in happenings {
            apply(happening, station);
            if let (Some(lasts), Some(end)) = (lasts, happening.undo()) {
                self.ends.push((now + lasts, at, end));
            }
        }
        Answer::Done { drive, here: true }
    }

    /// What was to last so long ends.
    fn end(&mut self, now: Instant) -> Vec<(usize, Happening)> {
        let due: Vec<(usize, Happening)> = self
            .ends
            .iter()
            .filter(|(at, ..)| *at <= now)
            .map(|(_, drive, happening)| (*drive, *happening))
            .collect();
        self.ends.retain(|(at, ..)| *at > now);
        for (drive, happening) in &due {
            if let Some((_, station)) = self.drives.get_mut(*drive) {
                apply(*happening, station);
            }
        }
        due
    }
}

/// True for what can happen to a drive at a serial line. Its parameter channel can refuse; the other faults of answers are
/// those of records.
const fn is_on_line(happening: &Happening) -> bool {
    matches!(
        happening,
        Happening::Drive(_) | Happening::Answers(AnswerFault::None | AnswerFault::Error(_))
    )
}

/// Lets happen to a drive what [`is_on_line`] allows.
fn apply(happening: Happening, station: &mut SerialStation) {
    match happening {
        Happening::Drive(injection) => station.drive_mut().inject(injection),
        Happening::Answers(fault) => station.refuse_all(fault.in_channel()),
        Happening::Cable { .. } | Happening::Link(_) => {}
    }
}

/// The line as a user writes it.
struct Place {
    protocol: Protocol,
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

    /// Whether a user means the drive with this address: by protocol, port and address, or by port and address.
    fn is(&self, text: &str, number: u8) -> bool {
        let same = |port: &str| {
            let real = |port: &str| std::fs::canonicalize(port).ok();
            port == self.port || real(port).is_some_and(|port| Some(port) == real(&self.port))
        };
        match LineAddress::parse(text) {
            Some(Ok(at)) => {
                let protocol = match at.protocol {
                    uss::Protocol::Fc => Protocol::Fc,
                    uss::Protocol::Uss => Protocol::Uss,
                };
                protocol == self.protocol && at.number == number && same(&at.port)
            }
            Some(Err(_)) => false,
            None => text
                .rsplit_once('/')
                .is_some_and(|(port, at)| at.parse() == Ok(number) && same(&LineAddress::path(port))),
        }
    }
}

impl Talker for LineUp {
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
        let (speaker, length) =
            drives.find_map(|(number, (_, drive))| Some((number, drive.poll_transmit(now, buffer)?)))?;
        let octets = buffer.get(..length).unwrap_or_default();
        for (number, (_, drive)) in self.drives.iter_mut().enumerate() {
            if number != speaker {
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

/// Runs the drives of `args` at `port` until Ctrl-C or the end of their time.
pub fn run(args: &Simulate, port: &str, output: &Output) -> Result<(), Failure> {
    let folder = args.state.as_deref().map(StateFolder::open).transpose()?;
    let mut lineup = LineUp {
        drives: Vec::new(),
        ends: Vec::new(),
    };
    let bell = Bell::new()
        .map_err(|error| Failure::new(Exit::Failed, format!("cannot wait for requests: {error}")))?;
    let scribe = Scribe::new(output.clone(), bell.clone());
    let start = now();
    let maker = Maker::of(args, None, output)?;
    for (plan, number) in plans(args, maker.model, None)?
        .iter()
        .zip(u16::from(args.line.address)..)
    {
        let slave = slave(&args.line, number)?;
        let key = plan.key();
        let state = folder
            .as_ref()
            .map_or_else(DriveState::default, |folder| folder.drive(&key));
        let mut config = SerialConfig::new(plan.drive.model, slave).with_gap(GAP);
        config.parameters = super::saved(&state, plan.drive.model, output)?;
        let keeping = Arc::new(Keeping {
            key,
            model: plan.drive.model,
            state,
        });
        let mut station = SerialStation::new(config);
        if keeping.state.is_kept() {
            station.confirm_saves();
        }
        lineup.drives.push((keeping, station));
    }
    let name = LineAddress::path(port);
    let open = || Port::open(&name, serial_settings(args.line.baud, args.line.parity));
    let stop = Stop::on_signals()
        .map_err(|error| Failure::new(Exit::Failed, format!("cannot watch for Ctrl-C: {error}")))?;
    let at = |port| {
        let mut line = Line::new(port);
        line.set_stop(stop.clone());
        line
    };
    let mut line = Some(at(open()?));
    let mailbox = Mailbox::open(bell);
    if let Err(failure) = &mailbox {
        output.warn(&format!(
            "`profidrive inject` will not reach these drives: {}",
            failure.message
        ));
    }
    let place = Place {
        protocol: args.line.protocol,
        port: name.clone(),
    };
    for (keeping, station) in &lineup.drives {
        let number = station.number();
        scribe.say(keeping, now() - start, format!("ready: address {number}"));
    }
    output.say(&format!("{} at {name}; Ctrl-C ends", count(lineup.drives.len())));
    let end = args.time.map(|time| start + time);
    let mut next_try = start;
    while !stop.is_stopped() && end.is_none_or(|end| now() < end) {
        let until = end.unwrap_or(Instant::MAX).min(now() + GLANCE);
        match &mut line {
            Some(open) => match open.step(&mut lineup, until) {
                Err(error @ (SerialError::Gone { .. } | SerialError::Stuck { .. })) => {
                    output.warn(&format!(
                        "{error}: waiting until it is back; the drives go on without it"
                    ));
                    line = None;
                    next_try = now() + RETRY;
                }
                other => other?,
            },
            None => {
                sleep(WITHOUT);
                lineup.handle_timeout(now());
                if now() >= next_try {
                    next_try = now() + RETRY;
                    line = open().ok().map(at);
                    if line.is_some() {
                        output.say(&format!("{name} is back"));
                    }
                }
            }
        }
        while let Some((question, answer)) = mailbox.as_ref().ok().and_then(Mailbox::take) {
            // whoever asked may be gone
            let _ = answer.send(match question {
                Question::Inject(request) => {
                    let done = lineup.inject(&request, &place, now());
                    told(&lineup, &request, &done, &place, &scribe, now() - start);
                    done
                }
                Question::Drives(_) => Answer::Drives(Vec::new()),
            });
        }
        while let Some(SaveReport {
            drive, save, stored, ..
        }) = scribe.report()
        {
            let mut drives = lineup.drives.iter_mut();
            if let Some((_, station)) = drives.find(|(keeping, _)| Arc::ptr_eq(keeping, &drive)) {
                station.report_save(save, stored);
            }
        }
        for (drive, happening) in lineup.end(now()) {
            if let Some((keeping, _)) = lineup.drives.get(drive) {
                scribe.say(keeping, now() - start, happening.to_string());
            }
        }
        for (keeping, drive) in &mut lineup.drives {
            while let Some(event) = drive.poll_event() {
                scribe.happened(keeping, now() - start, event);
            }
        }
    }
    for (keeping, drive) in &mut lineup.drives {
        drive.switch_off();
        while let Some(event) = drive.poll_event() {
            scribe.happened(keeping, now() - start, event);
        }
    }
    scribe.finish();
    Ok(())
}

/// What was let happen to a drive stands in its protocol.
fn told(lineup: &LineUp, request: &Request, done: &Answer, place: &Place, scribe: &Scribe, at: Duration) {
    let Answer::Done { drive, .. } = done else { return };
    let mut drives = lineup.drives.iter();
    let meant = drives.find(|(_, station)| place.of(station.number()) == *drive);
    if let Some((keeping, _)) = meant.filter(|_| !request.happenings.is_empty()) {
        scribe.say(keeping, at, request.happenings.join(" "));
    }
}

/// The slave of a drive, if there is such an address.
fn slave(options: &SerialOptions, number: u16) -> Result<SlaveConfig, Failure> {
    let (range, config): (_, fn(u8, u32) -> SlaveConfig) = match options.protocol {
        Protocol::Fc => (1..=126, SlaveConfig::fc),
        Protocol::Uss => (0..=31, SlaveConfig::uss),
    };
    match u8::try_from(number) {
        Ok(number) if range.contains(&number) => Ok(config(number, options.baud)),
        _ => Err(Failure::usage(format!(
            "no drive can have the address {number}: {} to {} are possible",
            range.start(),
            range.end()
        ))),
    }
}
