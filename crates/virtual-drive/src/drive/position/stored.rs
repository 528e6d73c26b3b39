//! Motion tasks as text: what DRV.NVSAVE keeps of the table.
//!
//! ```text
//! MT[5] = P 10.5rev, V 300rpm, ACC 3000rpm/s, DEC 3000rpm/s, CNTL 0x00000010, MTNEXT 6, TNEXT 0ms, TNUM 0
//! ```
//!
//! One line for each task that is not empty. Positions stand there in revolutions, whatever unit the user chose: a task
//! keeps its place when the unit changes.

use super::task::{MOST_TASKS, Task};
use crate::drive::Drive;

/// The words of a line in their order, each with the unit behind its number.
const WORDS: [(&str, &str); 8] = [
    ("P ", "rev"),
    ("V ", "rpm"),
    ("ACC ", "rpm/s"),
    ("DEC ", "rpm/s"),
    ("CNTL 0x", ""),
    ("MTNEXT ", ""),
    ("TNEXT ", "ms"),
    ("TNUM ", ""),
];

/// Fractions of a revolution that a position counts.
const FRACTIONS: f64 = 4_294_967_296.0;

/// Returns the text of a task.
fn to_text(task: &Task) -> String {
    let values = [
        revolutions(task.position),
        task.speed.to_string(),
        task.acceleration.to_string(),
        task.deceleration.to_string(),
        format!("{:08X}", task.control),
        task.next.to_string(),
        task.dwell.to_string(),
        task.profile.to_string(),
    ];
    let words = WORDS.iter().zip(values);
    let words: Vec<String> = words
        .map(|((word, unit), value)| format!("{word}{value}{unit}"))
        .collect();
    words.join(", ")
}

/// Parses a task; `None` when the text is not a task or its values are impossible.
fn from_text(text: &str) -> Option<Task> {
    let mut values = [""; WORDS.len()];
    let mut words = text.split(", ");
    for (value, (word, unit)) in values.iter_mut().zip(WORDS) {
        *value = words.next()?.strip_prefix(word)?.strip_suffix(unit)?;
    }
    let [
        position,
        speed,
        acceleration,
        deceleration,
        control,
        next,
        dwell,
        profile,
    ] = values;
    let positive = |text: &str| {
        let value: f64 = text.parse().ok()?;
        (value.is_finite() && value >= 0.0).then_some(value)
    };
    let task = Task {
        position: places(position)?,
        speed: positive(speed)?,
        acceleration: positive(acceleration)?,
        deceleration: positive(deceleration)?,
        control: u32::from_str_radix(control, 16).ok()?,
        next: next.parse().ok()?,
        dwell: dwell.parse().ok()?,
        profile: profile.parse().ok()?,
    };
    words.next().is_none().then_some(task)
}

/// 2^-32 revolutions in revolutions, exactly: the part before the point and the part behind it on their own.
fn revolutions(position: i64) -> String {
    let size = position.unsigned_abs();
    let (whole, part) = (size >> 32, (size & 0xFFFF_FFFF) as f64 / FRACTIONS);
    let sign = if position < 0 { "-" } else { "" };
    let part = part.to_string();
    format!("{sign}{whole}{}", part.strip_prefix('0').unwrap_or_default())
}

fn places(text: &str) -> Option<i64> {
    let (sign, digits) = text.strip_prefix('-').map_or((1, text), |digits| (-1, digits));
    let (whole, part) = digits.split_once('.').unwrap_or((digits, "0"));
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if !is_digits(whole) || !is_digits(part) {
        return None;
    }
    let part: f64 = format!("0.{part}").parse().ok()?;
    let size = (i128::from(whole.parse::<u64>().ok()?) << 32) + (part * FRACTIONS).round() as i128;
    i64::try_from(sign * size).ok()
}

impl Drive {
    /// Returns name and text of each task that is not empty. The MDI task is never saved.
    pub(in crate::drive) fn task_lines(&self) -> impl Iterator<Item = (String, String)> + '_ {
        (1..MOST_TASKS)
            .filter_map(|number| Some((number, self.positioning.tasks.at(number)?)))
            .filter(|(_, task)| !task.is_empty())
            .map(|(number, task)| (format!("MT[{number}]"), to_text(task)))
    }

    /// Empties the table.
    pub(in crate::drive) fn forget_tasks(&mut self) {
        self.positioning.tasks.clear(None);
    }

    /// Puts a task back; false when the line is none.
    pub(in crate::drive) fn take_task_line(&mut self, name: &str, text: &str) -> bool {
        let number = name.strip_prefix("MT[").and_then(|name| name.strip_suffix(']'));
        let number = number.and_then(|number| number.parse().ok()).unwrap_or(0_usize);
        match from_text(text) {
            Some(task) if number > 0 => self.positioning.tasks.set(number, task),
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_task_is_readable() {
        let task = Task {
            position: -(21 << 31),
            speed: 300.0,
            acceleration: 3000.0,
            deceleration: 2999.9995,
            control: 0x10,
            next: 6,
            dwell: 250,
            profile: 0,
        };
        let text = "P -10.5rev, V 300rpm, ACC 3000rpm/s, DEC 2999.9995rpm/s, CNTL 0x00000010, MTNEXT 6, TNEXT 250ms, TNUM 0";
        assert_eq!(to_text(&task), text);
        assert_eq!(from_text(text), Some(task));
        for wrong in [
            "",
            "P 1rev",
            "P 1rev, V -1rpm, ACC 1rpm/s, DEC 1rpm/s, CNTL 0x0, MTNEXT 0, TNEXT 0ms, TNUM 0",
            "P 1rev, V inf rpm, ACC 1rpm/s, DEC 1rpm/s, CNTL 0x0, MTNEXT 0, TNEXT 0ms, TNUM 0",
            "P 1rev, V 1rpm, ACC 1rpm/s, DEC 1rpm/s, CNTL 0x0, MTNEXT 256, TNEXT 0ms, TNUM 0",
            "P 9999999999rev, V 1rpm, ACC 1rpm/s, DEC 1rpm/s, CNTL 0x0, MTNEXT 0, TNEXT 0ms, TNUM 0",
            "P 1rev, V 1rpm, ACC 1rpm/s, DEC 1rpm/s, CNTL 0x0, MTNEXT 0, TNEXT 0ms, TNUM 0, X 1",
        ] {
            assert_eq!(from_text(wrong), None, "{wrong}");
        }
    }

    proptest! {
        #[test]
        fn every_task_survives_its_text(
            position: i64, speed in 0.0..20_000.0_f64, ramps in (0.0..1e9_f64, 0.0..1e9_f64), control: u32, next: u8,
            dwell: u16, profile: u8
        ) {
            let (acceleration, deceleration) = ramps;
            let position = position.max(-i64::MAX);
            let task = Task { position, speed, acceleration, deceleration, control, next, dwell, profile };
            prop_assert_eq!(from_text(&to_text(&task)), Some(task));
        }

        #[test]
        fn no_text_does_harm(text in "(P |V |rev|, |[0-9.x-]){0,30}") {
            let _ = from_text(&text);
        }
    }
}
