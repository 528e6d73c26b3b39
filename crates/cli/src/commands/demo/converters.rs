//! The part of the demo with frequency converters: a VLT with a PPO type and its parameter channel, a Vacon with a
//! telegram of its own. Jobs go through the client as everywhere; the cyclic data are put together here, frame by frame.

use std::time::Duration;

use client::change::Change;
use client::{Drive, DriveAddress, Error, Session, Wait, WriteMode, describe, modules_of};
use profidrive::Joined;
use profile::catalogue::Device;
use profile::pkw::{Answer, Client, ClientTiming, Job, Memory, Outcome, PkwDialect, PkwValue};
use profile::state::{Profile, Stw1, Zsw1};
use profile::telegram::{Telegram, signal};
use profinet::controller::{ArId, ConnectConfig, Controller, ControllerConfig, Event, Target};
use profinet::cyclic::Timing;
use profinet::{IpSuite, MacAddress, Medium};

use super::{Show, page};
use crate::render::{hex16, value};
use dissect::job::JobDrive;
use dissect::job::telegram::Half;

/// The controller of this part; the client keeps its own address.
const MAC: MacAddress = MacAddress([0x02, 0x50, 0x4E, 0, 0, 0xC1]);
const CYCLE: Duration = Duration::from_millis(16);
/// STW1: off, run, off with acknowledge.
const OFF: Stw1 = Stw1(0x047E);
const ACKNOWLEDGE: Stw1 = Stw1(0x04FE);
/// How long a drive has for its ramp.
const STOP: Duration = Duration::from_secs(5);
/// Tolerance of a speed in percent: slip, and the steps of the words.
const TOLERANCE: f64 = 3.0;

/// The demo of one model.
struct Act {
    name: &'static str,
    telegram: u16,
    words: Profile,
    page: &'static [&'static str],
    /// Written through the client before it runs; the first one lets it stop when its controller is lost.
    settings: &'static [&'static str],
    /// Reference in percent.
    reference: f64,
    fault: u16,
}

const VLT: Act = Act {
    name: "vlt-1",
    telegram: 101,
    words: Profile::DanfossFc,
    page: &["1-20", "1-23", "3-03", "3-41", "16-30", "15-40"],
    settings: &["8-04=5", "3-42=1s"],
    reference: 50.0,
    fault: 9,
};
const VACON: Act = Act {
    name: "vacon-1",
    telegram: 149,
    words: Profile::VaconPpo,
    page: &["ID 103", "ID 104", "ID 107", "ID 110"],
    settings: &["ID733=2", "ID103=1s", "ID104=1s"],
    reference: 25.0,
    fault: 1,
};

/// Ramp up of the VLT, 3-41: written through the parameter channel.
const RAMP_UP: u16 = 341;
/// A number that no parameter of the VLT has.
const UNKNOWN: u16 = 2000;

pub fn play(session: &mut Session, plant: &Joined, show: &mut Show) -> Result<(), Error> {
    let mut drive = introduce(session, &VLT, show)?;
    settings(session, &mut drive, &VLT, show)?;
    let mut line = Line::connect((session, plant), &drive, &VLT, show)?;
    let result = line.by_pkw(show).and_then(|()| {
        line.run(&VLT, show)?;
        line.alarm(&VLT, show)
    });
    line.end(result)?;
    let mut drive = introduce(session, &VACON, show)?;
    settings(session, &mut drive, &VACON, show)?;
    let mut line = Line::connect((session, plant), &drive, &VACON, show)?;
    let result = line.run(&VACON, show).and_then(|()| line.alarm(&VACON, show));
    line.end(result)
}

/// Found by name, known by its identity, read in its own numbers.
fn introduce(session: &mut Session, act: &Act, show: &mut Show) -> Result<Drive, Error> {
    show.next();
    let drive = session.find(&DriveAddress::Name(act.name.into())).wait()?;
    show.done(format!(
        "{}, by its identity a {}",
        describe(&drive.station),
        drive.model.name
    ));
    Ok(drive)
}

fn settings(session: &mut Session, drive: &mut Drive, act: &Act, show: &mut Show) -> Result<(), Error> {
    page(session, drive, act.page, show)?;
    for setting in act.settings {
        let set = session
            .write(drive, &[setting.parse()?], WriteMode::Write)
            .wait()?;
        if let Some(reading) = set.changes().first().and_then(Change::now) {
            show.detail(&format!(
                "{} {} = {}",
                reading.shown(),
                reading.name.unwrap_or_default(),
                value::full(reading)
            ));
        }
    }
    Ok(())
}

/// A cyclic connection, one frame after the other.
struct Line<'s> {
    session: &'s mut Session,
    plant: Joined,
    controller: Controller,
    ar: ArId,
    device: &'static Device,
    telegram: &'static Telegram,
    words: Profile,
    name: &'static str,
    drive: JobDrive,
    pkw: Client,
    sent: u16,
    lost: Option<String>,
    /// It is ending: nothing interrupts that.
    ending: bool,
}

impl<'s> Line<'s> {
    fn connect(
        (session, plant): (&'s mut Session, &Joined),
        drive: &Drive,
        act: &Act,
        show: &Show,
    ) -> Result<Self, Error> {
        let failed = |reason: String| malformed(act.name, reason);
        let device = drive.model.catalogue.map(|tables| &tables.device);
        let device = device.ok_or_else(|| failed("no tables of this drive".into()))?;
        let telegram = Telegram::find(act.telegram, device.vendor_id)
            .ok_or_else(|| failed("no such telegram".into()))?;
        let module = device
            .telegram(act.telegram)
            .ok_or_else(|| failed("no such module".into()))?;
        let modules = modules_of(device, module);
        let timing = Timing::for_interval(CYCLE).ok_or_else(|| failed("no such cycle".into()))?;
        let ip = IpSuite {
            address: std::net::Ipv4Addr::new(10, 0, 0, 200),
            ..drive.station.ip
        };
        // each is a program of its own: no identifier of one connection is that of another
        let seed = u64::from(act.telegram);
        let mut controller = Controller::new(ControllerConfig::new(MAC, ip, "demo-plc", seed));
        let now = session.now();
        let target = Target::of(&drive.station);
        let ar = controller
            .connect(now, target, ConnectConfig::new(modules, timing))
            .map_err(|error| failed(error.to_string()))?;
        let mut line = Self {
            session,
            plant: plant.clone(),
            controller,
            ar,
            device,
            telegram,
            words: act.words,
            name: act.name,
            drive: JobDrive::of(device.vendor_id, device.device_id),
            pkw: Client::new(PkwDialect::DANFOSS_PPO, ClientTiming::CYCLIC),
            sent: 0,
            lost: None,
            ending: false,
        };
        let mut ready = 0;
        let connected = line.until("connected", Duration::from_secs(5), |line, event| {
            match event {
                Some(Event::Connected { .. }) => line.output(OFF, 0),
                Some(Event::Ready { .. } | Event::Running { .. }) => ready += 1,
                _ => {}
            }
            ready == 2
        });
        if let Err(error) = connected.and_then(|()| line.pass(5 * CYCLE)) {
            return Err(line.end(Err(error)).err().unwrap_or(Error::Interrupted));
        }
        show.detail(&format!(
            "connected with telegram {}, {} octets each way, words of {}",
            act.telegram,
            telegram.setpoint.octets,
            act.words.name()
        ));
        Ok(line)
    }

    /// What goes out from the next frame on.
    fn output(&mut self, stw1: Stw1, speed: i64) {
        self.sent = self.words.control(stw1);
        let mut data = vec![0; usize::from(self.telegram.setpoint.octets)];
        let image = &self.telegram.setpoint;
        let fits = image
            .set(&mut data, signal::STW1, self.sent.into())
            .and(image.set(&mut data, signal::NSOLL_A, speed))
            .is_ok();
        let subslot = self.device.layout.telegram;
        let kept = self.controller.set_output(self.ar, 1, subslot, &data).is_ok();
        if !(fits && kept) {
            self.lost = Some("the outputs do not fit".into());
        }
    }

    fn input(&self) -> Option<&[u8]> {
        let (data, iops) = self.controller.input(self.ar, 1, self.device.layout.telegram)?;
        iops.is_good().then_some(data)
    }

    fn half(&self) -> Half<'_> {
        Half {
            drive: &self.drive,
            telegram: Some(self.telegram),
            output: false,
        }
    }

    fn zsw1(&self) -> Zsw1 {
        let status = self.input().and_then(|data| self.half().word(data));
        self.words.zsw1(status.unwrap_or(0), self.sent)
    }

    fn until(
        &mut self,
        what: &str,
        limit: Duration,
        mut done: impl FnMut(&mut Self, Option<Event>) -> bool,
    ) -> Result<(), Error> {
        let end = self.session.now() + limit;
        loop {
            if !self.ending {
                self.session.glance()?;
            }
            let now = self.session.now();
            let next = end.min(now + CYCLE);
            let controller = &mut self.controller;
            let stepped = self.plant.with_world(|world| world.step(controller, next));
            stepped.map_err(|error| malformed(self.name, error.to_string()))?;
            while let Some(event) = self.controller.poll_event() {
                if let Event::Lost { cause, .. } = &event {
                    self.lost = Some(cause.to_string());
                }
                if done(self, Some(event)) {
                    return Ok(());
                }
            }
            if let Some(cause) = self.lost.take() {
                return Err(malformed(self.name, cause));
            }
            if done(self, None) {
                return Ok(());
            }
            if self.session.now() >= end {
                return Err(malformed(self.name, format!("not within {limit:?}: {what}")));
            }
        }
    }

    fn pass(&mut self, time: Duration) -> Result<(), Error> {
        let end = self.session.now() + time;
        self.until("", time + CYCLE, |line, _| line.session.now() >= end)
    }

    /// One job through the eight octets in front of the control word.
    fn exchange(&mut self, job: Job<'_>) -> Result<Outcome, Error> {
        let origin = profinet::Instant::ZERO;
        let now = self.session.now() - origin;
        self.pkw
            .start(now, job)
            .map_err(|error| malformed(self.name, error.to_string()))?;
        let mut outcome = None;
        self.until(
            "reply in the parameter channel",
            Duration::from_secs(5),
            |line, _| {
                let now = line.session.now() - origin;
                let reply = line.input().and_then(|data| data.first_chunk::<8>().copied());
                outcome = reply.and_then(|reply| line.pkw.handle(now, &reply));
                outcome = outcome.or_else(|| line.pkw.handle_timeout(now));
                let request = line.pkw.request(now).to_vec();
                let subslot = line.device.layout.telegram;
                let data = line
                    .controller
                    .output(line.ar, 1, subslot)
                    .map(|(data, _)| data.to_vec());
                if let Some(mut data) = data
                    && let Some(channel) = data.get_mut(..request.len())
                {
                    channel.copy_from_slice(&request);
                    let _ = line.controller.set_output(line.ar, 1, subslot, &data);
                }
                outcome.is_some()
            },
        )?;
        outcome.ok_or_else(|| malformed(self.name, "no outcome".into()))
    }

    fn by_pkw(&mut self, show: &mut Show) -> Result<(), Error> {
        show.next();
        let text = self.ramp_by_pkw()?;
        show.done(text);
        Ok(())
    }

    /// Reads the ramp, writes it, and requests a parameter that is not there.
    fn ramp_by_pkw(&mut self) -> Result<String, Error> {
        let read = Job::Read {
            pnu: RAMP_UP,
            element: None,
        };
        let Ok(Answer::Value(before)) = self.exchange(read)? else {
            return Err(malformed(self.name, "3-41 was not read".into()));
        };
        let change = Job::Change {
            pnu: RAMP_UP,
            element: None,
            value: PkwValue::DoubleWord(100),
            memory: Memory::Ram,
        };
        let changed = self.exchange(change)?;
        if changed != Ok(Answer::Value(PkwValue::DoubleWord(100))) {
            return Err(malformed(self.name, format!("3-41 was not written: {changed:?}")));
        }
        let unknown = Job::Read {
            pnu: UNKNOWN,
            element: None,
        };
        let refused = match self.exchange(unknown)? {
            Err(error) => error.to_string(),
            Ok(answer) => return Err(malformed(self.name, format!("{UNKNOWN} is there: {answer:?}"))),
        };
        let seconds = f64::from(before.raw()) / 100.0;
        Ok(format!(
            "3-41 read {seconds} s, written 1 s; PNU {UNKNOWN}: {refused}"
        ))
    }

    fn raw(&self, percent: f64) -> i64 {
        let full = f64::from(self.telegram.full_speed.unwrap_or(0x4000));
        #[expect(clippy::cast_possible_truncation, reason = "a word")]
        let raw = (full * percent / 100.0).round() as i64;
        raw
    }

    /// Starts, reaches the reference, and keeps it for a while.
    fn run(&mut self, act: &Act, show: &mut Show) -> Result<(), Error> {
        show.next();
        let raw = self.raw(act.reference);
        self.output(OFF, 0);
        self.pass(5 * CYCLE)?;
        self.output(Stw1::RUN, raw);
        self.pass(Duration::from_millis(1750))?;
        let half = self.half();
        let speed = self.input().and_then(|data| half.speed(data)).unwrap_or_default();
        let full = self.telegram.full_speed;
        let percent = self.drive.percent(speed, full).unwrap_or_default();
        let text = format!(
            "{} {}: {}",
            half.word_name(),
            hex16(self.input().and_then(|data| half.word(data)).unwrap_or_default()),
            half.speed_text(speed)
        );
        let good = (percent - act.reference).abs() <= TOLERANCE && self.zsw1().has(Zsw1::READY_TO_OPERATE);
        let wrong = format!("{} turns at {percent:.1} %", self.name);
        show.check(good, text, &wrong)
    }

    /// Raises an alarm while it runs, reports it, and resets it; then it stands.
    fn alarm(&mut self, act: &Act, show: &mut Show) -> Result<(), Error> {
        show.next();
        super::inject(&self.plant, act.name, act.fault)?;
        let limit = Duration::from_secs(2);
        self.until("alarm", limit, |line, _| line.zsw1().has(Zsw1::FAULT))?;
        let word = self
            .input()
            .and_then(|data| self.half().word(data))
            .unwrap_or_default();
        let meaning = self
            .drive
            .tables()
            .and_then(|tables| tables.fault(act.fault, false))
            .map_or("", |fault| fault.meaning);
        let text = format!(
            "{} {}: alarm {} {meaning}",
            self.half().word_name(),
            hex16(word),
            act.fault
        );
        self.output(OFF, 0);
        self.pass(5 * CYCLE)?;
        self.output(ACKNOWLEDGE, 0);
        self.pass(5 * CYCLE)?;
        self.output(OFF, 0);
        self.until("reset", limit, |line, _| !line.zsw1().has(Zsw1::FAULT))?;
        let good = !self.zsw1().has(Zsw1::READY_TO_OPERATE);
        show.check(
            good,
            format!("{text}; reset"),
            "the motor still runs after the reset",
        )
    }

    /// Closes the connection; what ended early is brought to rest first.
    fn end(mut self, result: Result<(), Error>) -> Result<(), Error> {
        self.ending = true;
        if result.is_err() {
            self.output(OFF, 0);
            // a drive that is not reachable any more stops by its watchdog
            let _ = self.until("standstill", STOP, |line, _| {
                let speed = line.input().and_then(|data| line.half().speed(data));
                !line.zsw1().has(Zsw1::READY_TO_OPERATE) && speed.unwrap_or(0) == 0
            });
        }
        result.and(self.release())
    }

    fn release(mut self) -> Result<(), Error> {
        let now = self.session.now();
        let released = self.controller.release(now, self.ar);
        released.map_err(|error| malformed(self.name, error.to_string()))?;
        self.until("released", Duration::from_secs(5), |_, event| {
            matches!(event, Some(Event::Released { .. }))
        })
    }
}

fn malformed(drive: &str, reason: String) -> Error {
    Error::Malformed {
        drive: drive.into(),
        reason,
    }
}
