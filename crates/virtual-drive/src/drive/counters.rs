//! Lifetime counters (VLT 15-0*) and the latest faults (15-3*): retained over power-off without a save request.
//!
//! The text that keeps them is due a second after power on, then every ten minutes, when a fault came, and when the drive
//! is switched off in order. So a kill costs ten minutes of operating hours. Source of what is counted: FC 300 programming
//! guide 15-0*, from memory; how often it is kept is ours.

use std::time::Duration;

use profile::catalogue::Part;

use super::Drive;
use crate::axis::Axis;
use crate::store::Image;

/// When the text is due first, and how often after that.
const FIRST: Duration = Duration::from_secs(1);
const EVERY: Duration = Duration::from_secs(600);

/// What is counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Meter {
    /// Power on, in all.
    pub on: Duration,
    /// The motor runs, in all; can be reset.
    pub running: Duration,
    /// Energy that went to the motor, Ws; can be reset.
    pub energy: f64,
    /// How often power came.
    pub power_ups: u32,
    /// Faults of temperature and of too high a voltage.
    pub hot: u32,
    pub over_voltage: u32,
    /// Since power on; when the text is due; something happened that is to be kept at once.
    awake: Duration,
    due: Duration,
    at_once: bool,
    /// The time is known.
    counting: bool,
}

impl Default for Meter {
    fn default() -> Self {
        Self {
            on: Duration::ZERO,
            running: Duration::ZERO,
            energy: 0.0,
            power_ups: 1,
            hot: 0,
            over_voltage: 0,
            awake: Duration::ZERO,
            due: FIRST,
            at_once: false,
            counting: false,
        }
    }
}

impl Meter {
    /// Counts a step.
    ///
    /// The first step only sets the reference time: a drive that starts has not been on since the origin of the clock.
    pub fn count(&mut self, passed: Duration, running: bool, axis: &Axis) {
        if !std::mem::replace(&mut self.counting, true) {
            return;
        }
        self.on += passed;
        self.awake += passed;
        if running {
            self.running += passed;
            self.energy += axis.motor_output().power.max(0.0) * passed.as_secs_f64();
        }
    }

    fn lines(&self) -> [(&'static str, String); 6] {
        [
            (NAMES[0], format!("{}s", self.on.as_secs())),
            (NAMES[1], format!("{}s", self.running.as_secs())),
            (NAMES[2], format!("{:.0}Ws", self.energy)),
            (NAMES[3], self.power_ups.to_string()),
            (NAMES[4], self.hot.to_string()),
            (NAMES[5], self.over_voltage.to_string()),
        ]
    }

    /// Takes a line over; false when it is none.
    fn take(&mut self, name: &str, text: &str) -> bool {
        let seconds = || {
            let number = text.strip_suffix('s')?.parse::<u32>().ok()?;
            Some(Duration::from_secs(number.into()))
        };
        let energy = || {
            let energy: f64 = text.strip_suffix("Ws")?.parse().ok()?;
            (0.0..1e18).contains(&energy).then_some(energy)
        };
        let number = || text.parse::<u32>().ok();
        let [on, running, work, power_ups, hot, over_voltage] = NAMES;
        match name {
            _ if name == on => put(&mut self.on, seconds()),
            _ if name == running => put(&mut self.running, seconds()),
            _ if name == work => put(&mut self.energy, energy()),
            // and this time
            _ if name == power_ups => put(
                &mut self.power_ups,
                number().map(|number| number.saturating_add(1)),
            ),
            _ if name == hot => put(&mut self.hot, number()),
            _ if name == over_voltage => put(&mut self.over_voltage, number()),
            _ => false,
        }
    }
}

/// Names of the lines, in the order of [`Meter::lines`].
const NAMES: [&str; 6] = [
    "counter power on",
    "counter running",
    "counter energy",
    "counter power-ups",
    "counter over-temperatures",
    "counter over-voltages",
];

/// Line of a fault in the log, with its place behind it: the newest is 0.
const LOG: &str = "fault log ";

fn put<T>(place: &mut T, value: Option<T>) -> bool {
    match value {
        Some(value) => {
            *place = value;
            true
        }
        None => false,
    }
}

impl Drive {
    /// Returns true for a drive that keeps its counters.
    fn keeps_counters(&self) -> bool {
        self.model.number(Part::PowerTime).is_some()
    }

    /// A fault came.
    pub(super) fn count_fault(&mut self, number: u16) {
        let Some(converter) = self.model.converter.filter(|_| self.keeps_counters()) else {
            return;
        };
        let counted = [
            (converter.hot, &mut self.meter.hot),
            (converter.over_voltage, &mut self.meter.over_voltage),
        ];
        for (numbers, counter) in counted {
            if numbers.contains(&number) {
                *counter = counter.saturating_add(1);
            }
        }
        self.meter.at_once = true;
    }

    /// Switches off in an orderly way: counters are saved, other unsaved values are lost.
    pub fn switch_off(&mut self) {
        self.end_counting();
        self.saving.end();
    }

    /// Makes the counters due: power goes in order.
    pub(super) fn end_counting(&mut self) {
        self.meter.at_once = self.keeps_counters();
    }

    /// Saves the counters when it is due.
    pub(super) fn count_due(&mut self) {
        let due = self.meter.at_once || self.meter.awake >= self.meter.due;
        if !due || !self.keeps_counters() {
            return;
        }
        self.meter.at_once = false;
        self.meter.due = self.meter.awake + EVERY;
        let mut image = self.saved_image();
        self.push_counters(&mut image);
        self.saving.save(image.encode(), false);
    }

    /// Puts the counters into a text, in the place of those that stand there.
    pub(super) fn push_counters(&self, image: &mut Image) {
        if !self.keeps_counters() {
            return;
        }
        for (name, text) in self.meter.lines() {
            image.set_text(name, &text);
        }
        for place in 0.. {
            let Some((number, at)) = self.faults.logged(place) else {
                break;
            };
            image.set_text(
                &format!("{LOG}{place}"),
                &format!("{number} at {}s", at.as_secs()),
            );
        }
    }

    /// Takes the counters of a text over: the drive starts with them. Returns how many lines that were.
    pub(super) fn take_counters(&mut self, image: &Image) {
        if !self.keeps_counters() {
            return;
        }
        for (name, text) in image.entries() {
            if self.meter.take(name, text) {
                continue;
            }
            if let Some((place, number, seconds)) = fault_line(name, text) {
                self.faults
                    .log_again(place, number, Duration::from_secs(seconds.into()));
            }
        }
    }

    /// Returns true for a line of counters.
    pub(super) fn is_counter_line(&self, name: &str, text: &str) -> bool {
        self.keeps_counters() && (Meter::default().take(name, text) || fault_line(name, text).is_some())
    }
}

/// Place, number and time of a fault in the log.
fn fault_line(name: &str, text: &str) -> Option<(usize, u16, u32)> {
    let place = name.strip_prefix(LOG)?.parse().ok()?;
    let (number, at) = text.split_once(" at ")?;
    Some((place, number.parse().ok()?, at.strip_suffix('s')?.parse().ok()?))
}
