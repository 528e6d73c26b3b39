//! The part of the demo with frequency converters: a VLT with a PPO type, a Vacon with a telegram of its own.

use std::time::Duration;

use client::axis::{SpeedUnit, Trouble};
use client::change::Change;
use client::{Axis, AxisSettings, Drive, DriveAddress, Error, Session, Wait, WriteMode, describe};
use dissect::job::JobDrive;
use dissect::job::telegram::Half;
use profidrive::Joined;
use profile::notation::ParameterReference;
use profile::state::Zsw1;
use profile::telegram::Telegram;

use super::{Show, TOLERANCE, inject, page};
use crate::render::{hex16, value};

/// The demo of one model.
struct Act {
    name: &'static str,
    telegram: u16,
    page: &'static [&'static str],
    /// Written before it runs; the first one lets it stop when its controller is lost.
    settings: &'static [&'static str],
    /// Reference in percent.
    reference: f64,
    fault: u16,
}

const VLT: Act = Act {
    name: "vlt-1",
    telegram: 101,
    page: &["1-20", "1-23", "3-03", "3-41", "16-30", "15-40"],
    settings: &["8-04=5", "3-42=1s"],
    reference: 50.0,
    fault: 9,
};
const VACON: Act = Act {
    name: "vacon-1",
    telegram: 149,
    page: &["ID 103", "ID 104", "ID 107", "ID 110"],
    settings: &["ID733=2", "ID103=1s", "ID104=1s"],
    reference: 25.0,
    fault: 1,
};

/// How long a motor without current may turn.
const COASTS: Duration = Duration::from_secs(20);
/// A number that no parameter of the VLT has.
const UNKNOWN: u16 = 2000;

pub fn play(session: &mut Session, plant: &Joined, show: &mut Show) -> Result<(), Error> {
    let (mut drive, mut axis) = prepared(session, &VLT, show)?;
    ramp(session, &mut drive, show)?;
    VLT.run(&mut axis, show)?;
    VLT.alarm(&mut axis, plant, show)?;
    axis.release().wait()?;
    let (_, mut axis) = prepared(session, &VACON, show)?;
    VACON.run(&mut axis, show)?;
    VACON.alarm(&mut axis, plant, show)?;
    axis.release().wait()
}

/// Found by name, recognized by its identity, read in its own numbers, set up and under control.
fn prepared(session: &mut Session, act: &Act, show: &mut Show) -> Result<(Drive, Axis), Error> {
    show.next();
    let mut drive = session.find(&DriveAddress::Name(act.name.into())).wait()?;
    show.done(format!(
        "{}, by its identity a {}",
        describe(&drive.station),
        drive.model.name
    ));
    page(session, &mut drive, act.page, show)?;
    for setting in act.settings {
        let set = session
            .write(&mut drive, &[setting.parse()?], WriteMode::Write)
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
    let settings = AxisSettings {
        telegram: Some(act.telegram),
        unit: SpeedUnit::Percent,
        speed_limit: 100.0,
        ..AxisSettings::default()
    };
    let axis = session.take_axis(&mut drive, settings).wait()?;
    act.decoded(&drive, |half| {
        let octets = half.telegram.map_or(0, |telegram| telegram.setpoint.octets);
        show.detail(&format!(
            "connected with telegram {}, {octets} octets each way, words of {}",
            act.telegram,
            half.profile().name()
        ));
    });
    Ok((drive, axis))
}

/// Reads a ramp, writes it, and requests a parameter that is not there.
fn ramp(session: &mut Session, drive: &mut Drive, show: &mut Show) -> Result<(), Error> {
    show.next();
    let set = session
        .write(drive, &["3-41=1s".parse()?], WriteMode::Write)
        .wait()?;
    let change = set.changes().first();
    let old = change.and_then(|change| change.old.as_ref()?.as_ref().ok());
    let (old, new) = (
        old.map(value::full),
        change.and_then(Change::now).map(value::full),
    );
    let unknown = drive.parameters.select(&ParameterReference::number(UNKNOWN))?;
    let answer = session.read(drive, &[unknown]).wait()?.into_iter().next();
    let refused = answer.and_then(Result::err).map(|refusal| refusal.words());
    let text = format!(
        "3-41 read {}, written {}; PNU {UNKNOWN}: {}",
        old.unwrap_or_default(),
        new.clone().unwrap_or_default(),
        refused.clone().unwrap_or_default()
    );
    let good = set.is_done() && new.is_some() && refused.is_some();
    show.check(
        good,
        text,
        "3-41 was not written, or a parameter answers that is not there",
    )
}

impl Act {
    /// Shows what the words and speeds of the connection mean.
    fn decoded<T>(&self, drive: &Drive, show: impl FnOnce(&Half<'_>) -> T) -> T {
        let station = &drive.station;
        let job = JobDrive::of(station.vendor_id, station.device_id);
        show(&Half {
            drive: &job,
            telegram: Telegram::find(self.telegram, station.vendor_id),
            output: false,
        })
    }

    /// Starts, reaches the reference, and keeps it for a while.
    fn run(&self, axis: &mut Axis, show: &mut Show) -> Result<(), Error> {
        show.next();
        let mut enabled = axis.enable().wait()?;
        enabled.run(self.reference).wait()?;
        enabled.hold(Duration::from_millis(1750)).wait()?;
        enabled.leave();
        let status = axis.status();
        let percent = status.and_then(|status| status.speed_actual).unwrap_or_default();
        let seen = status.and_then(|status| status.view.seen).unwrap_or_default();
        let text = self.decoded(axis.drive(), |half| {
            let speed = half.speed_text(seen.nist_a.unwrap_or_default().into());
            format!("{} {}: {speed}", half.word_name(), hex16(seen.word))
        });
        let good = (percent - self.reference).abs() <= TOLERANCE && !seen.pulses_off();
        show.check(good, text, &format!("{} turns at {percent:.1} %", self.name))
    }

    /// Raises an alarm while it runs, reports it, and resets it; then it stands.
    fn alarm(&self, axis: &mut Axis, plant: &Joined, show: &mut Show) -> Result<(), Error> {
        show.next();
        inject(plant, self.name, self.fault)?;
        match axis.hold(Duration::from_secs(2)).wait() {
            Err(Error::Axis {
                trouble: Trouble::Fault,
                ..
            }) => {}
            Err(error) => return Err(error),
            Ok(()) => return show.check(false, String::new(), "the alarm did not arrive"),
        }
        let seen = axis
            .status()
            .and_then(|status| status.view.seen)
            .unwrap_or_default();
        let tables = axis.drive().model.catalogue;
        let fault = tables.and_then(|tables| tables.fault(self.fault, false));
        let meaning = fault.map_or("", |fault| fault.meaning);
        let text = self.decoded(axis.drive(), |half| {
            format!(
                "{} {}: alarm {} {meaning}",
                half.word_name(),
                hex16(seen.word),
                self.fault
            )
        });
        axis.acknowledge().wait()?;
        // the motor coasts after a fault
        let stands = axis.hold_until(COASTS, |status| !status.view.turns).wait()?;
        let seen = axis.status().and_then(|status| status.view.seen);
        let good = stands && seen.is_some_and(|seen| seen.pulses_off() && !seen.zsw1.has(Zsw1::FAULT));
        show.check(
            good,
            format!("{text}; reset"),
            "the motor still runs after the reset",
        )
    }
}
