//! A client, its calls, and what must be true of their results.

use client::axis::Purpose;
use client::{Drive, DriveAddress, Error, Session, StopWay, Wait, Wire, WriteMode};
use futures::future::join_all;

use super::drives::drive_of;
use super::wire::Life;
use super::{HIGHEST, LOWEST, SECOND, SPEED};
use crate::running_on;
use crate::shared::On;

/// A client with the drives that it has found.
pub(super) struct Caller<'a> {
    pub(super) life: &'a Life,
    pub(super) network: On<Life>,
    pub(super) drives: Vec<Option<Drive>>,
}

impl Caller<'_> {
    pub(super) fn find(&mut self, place: usize) -> Option<Drive> {
        if self.drives[place].is_none() {
            let address: DriveAddress = format!("drive-{}", place + 1).parse().expect("an address");
            let begun = self.network.now();
            let found = self.network.find(&address).wait();
            self.drives[place] = self.life.ended("find", place, begun, true, found);
        }
        self.drives[place].clone()
    }

    /// Reads the pairs of all drives at the same time.
    pub(super) fn read(&mut self) {
        let places: Vec<usize> = (0..self.drives.len()).collect();
        let mut calls = Vec::new();
        for place in places {
            let Some(drive) = self.find(place) else { continue };
            let kind = self.life.0.borrow().places[place].kind;
            for (which, (name, _)) in kind.pair.into_iter().enumerate() {
                let (mut session, mut drive) = (Session::clone(&self.network), drive.clone());
                let life = self.life;
                calls.push(async move {
                    let begun = session.now();
                    let selection = drive.select(name).expect("known");
                    let answer = session.read_one(&mut drive, &selection).await;
                    let Some(reading) = life.ended("read", place, begun, true, answer) else {
                        return;
                    };
                    let raw = reading.raw().expect("a number");
                    let ended = session.now();
                    let had = life.0.borrow().places[place].values[which].had(begun, ended, raw);
                    if !had {
                        life.breaks(format!(
                            "{}: {name} was read as {raw}, which it never was then",
                            drive.label()
                        ));
                    }
                });
            }
        }
        join_all(calls).wait();
    }

    pub(super) fn write(&mut self, place: usize, mode: WriteMode) {
        let Some(mut drive) = self.find(place) else { return };
        let kind = self.life.0.borrow().places[place].kind;
        let value = LOWEST + self.life.below((HIGHEST - LOWEST) as usize) as i64;
        let text = |name: &str| {
            let scale = 10_i64.pow(kind.decimals as u32);
            let (whole, part) = (value / scale, value % scale);
            let text = match kind.decimals {
                0 => format!("{name}={whole}"),
                decimals => format!("{name}={whole}.{part:0decimals$}"),
            };
            text.parse().expect("an assignment")
        };
        let assignments = kind.pair.map(|(name, _)| text(name));
        let begun = self.network.now();
        let result = self.network.write(&mut drive, &assignments, mode).wait();
        let result = result.and_then(|set| set.accepted());
        // what the disk refuses, the drive refuses
        let refused = mode == WriteMode::Save && matches!(result, Err(Error::Refused { .. }));
        let is_full = self.life.0.borrow().places[place].disk.full;
        if refused && is_full || self.life.ended("write", place, begun, true, result).is_none() {
            return;
        }
        let ended = self.network.now();
        let state = self.life.0.borrow();
        let values = &state.places[place].values;
        let written = values.iter().all(|log| log.had(begun, ended, value));
        // the panel may have changed one of both
        let saved = state.places[place].disk.pair;
        let saved = saved.is_some_and(|pair| pair.contains(&value));
        drop(state);
        if !written {
            self.life.breaks(format!(
                "{}: {value} was reported as written and never there",
                drive.label()
            ));
        }
        if mode == WriteMode::Save && !saved {
            self.life.breaks(format!(
                "{}: {value} was reported as saved and is not on the disk",
                drive.label()
            ));
        }
    }

    pub(super) fn is_enabled(&mut self, place: usize) {
        let Some(mut drive) = self.find(place) else { return };
        let begun = self.network.now();
        let answer = self.network.is_enabled(&mut drive).wait();
        let Some(Some(enabled)) = self.life.ended("is enabled", place, begun, true, answer) else {
            return;
        };
        let ended = self.network.now();
        let had = self.life.0.borrow().places[place]
            .enabled
            .had(begun, ended, enabled);
        if !had {
            self.life.breaks(format!(
                "{}: enabled {enabled}, which it never was then",
                drive.label()
            ));
        }
    }

    /// The drive that is reported as at rest.
    pub(super) fn rests(&self, place: usize, after: &str) {
        let mut state = self.life.0.borrow_mut();
        let Some(station) = state.station(place) else {
            return;
        };
        let drive = drive_of(station);
        let (speed, enabled) = (drive.axis().speed(), drive.is_enabled());
        if speed.abs() > 1.0 || enabled {
            state.breaks(format!("{speed} rpm, enabled {enabled} after {after}"));
        }
    }

    pub(super) fn run(&mut self, place: usize) {
        let Some(mut drive) = self.find(place) else { return };
        let time = self.life.time(SECOND * 4);
        let leaves = self.life.below(3) == 0;
        self.life.0.borrow_mut().commanded = SPEED;
        let network = &mut self.network;
        let motion = async {
            let mut axis = network.take_axis(&mut drive, running_on(Purpose::Speed)).await?;
            axis.ready_or_fault().await?;
            let seen = axis.status().and_then(|status| status.view.seen);
            if seen.is_some_and(|seen| seen.fault()) {
                axis.acknowledge().await?;
            }
            let mut enabled = axis.enable().await?;
            enabled.reach_speed(SPEED, None).await?;
            enabled.keep_speed(SPEED, time).await?;
            if leaves {
                return Ok(false);
            }
            enabled.disable().await?;
            axis.release().await.map(|()| true)
        };
        let begun = Wire::now(self.life);
        let result: Result<bool, Error> = motion.wait();
        let Some(released) = self.life.ended("run", place, begun, false, result) else {
            return;
        };
        self.life.0.borrow_mut().tally.motions += 1;
        if released {
            self.rests(place, "the axis was released");
        }
    }

    pub(super) fn stop(&mut self, place: usize) {
        let Some(mut drive) = self.find(place) else { return };
        let begun = self.network.now();
        let outcome = self
            .network
            .stop_drive(&mut drive, StopWay::Disable, SECOND * 15)
            .wait();
        let outcome = self.life.ended("stop", place, begun, false, outcome);
        if outcome.is_some_and(|outcome| outcome.at_rest) {
            self.rests(place, "it was reported to be at rest");
        }
    }

    pub(super) fn act(&mut self) {
        let place = self.life.below(self.drives.len());
        match self.life.below(8) {
            0 | 1 => self.read(),
            2 => self.write(place, WriteMode::Write),
            3 => self.write(place, WriteMode::Save),
            4 => self.is_enabled(place),
            5 | 6 => self.run(place),
            _ => self.stop(place),
        }
        let pause = self.life.time(SECOND);
        // a killed client has no time left
        let _ = self.network.pass(pause).wait();
    }
}
