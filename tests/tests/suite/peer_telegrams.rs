//! An independent controller (profinet-py) with each telegram of the AKD: what it sets and sees in its frames is what
//! the parameters of the same numbers say.

use std::collections::HashMap;
use std::time::Duration;

use profile::catalogue::AKD;
use profile::telegram::{Direction, KOLLMORGEN, Mapping, Telegram, signal};
use system_tests::profinetpy::{controller, slots};
use system_tests::{Lab, Side, judge, simulate};

/// Mappings for the free telegrams: what no fixed one has.
const SETPOINTS: [u16; 12] = [1, 5, 101, 102, 103, 108, 109, 100, 100, 35, 35, 0];
const ACTUALS: [u16; 12] = [2, 6, 28, 28, 52, 104, 104, 105, 105, 106, 33, 4];

fn mappings(telegram: u16) -> (Mapping, Mapping) {
    let fixed = Telegram::find(telegram, KOLLMORGEN).unwrap();
    if fixed.free {
        let map = |words, direction| Mapping::new(words, KOLLMORGEN, direction).unwrap();
        (
            map(&SETPOINTS, Direction::Setpoint),
            map(&ACTUALS, Direction::Actual),
        )
    } else {
        (Mapping::of(&fixed.setpoint), Mapping::of(&fixed.actual))
    }
}

/// Returns a value for each setpoint; `number` makes them differ from frame to frame.
fn value(signal: u16, number: i64) -> i64 {
    match signal {
        signal::NSOLL_A | signal::kollmorgen::IL_CMD_FIELDBUS => 0,
        signal::SATZANW => 0x8000 + number,
        signal::MDI_TARPOS | signal::kollmorgen::HOME_DIST => -98_304 - number,
        signal::MDI_VELOCITY => 0xF000_0000 + number,
        signal::MDI_MOD => number & 1,
        signal::kollmorgen::HOME_MODE => 7 + (number & 1),
        // DRV_ACC, DRV_DEC, MDI_ACC, MDI_DEC, STW2, MT_FEEDRATE
        _ => 4 + number,
    }
}

/// What one connection is for.
struct Round {
    telegram: u16,
    setpoint: Mapping,
    actual: Mapping,
    /// Signals that have a parameter.
    signals: Vec<u16>,
    frames: Vec<Vec<u8>>,
    /// The speed that the axis has to have before a frame is looked at.
    speeds: Vec<Option<i64>>,
}

impl Round {
    /// Any values in all signals; an axis with a speed setpoint turns.
    fn new(telegram: u16) -> Self {
        let mut round = Self::without_frames(telegram);
        for (number, stw1) in [(0, 0x0400), (1, 0x0400), (2, 0x047E)] {
            round.frame(stw1, |signal| value(signal, number));
        }
        if round.setpoint.has(signal::NSOLL_A) {
            for (number, stw1, speed) in [
                (3, 0x047F, 164),
                (4, 0x047F, -300),
                (5, 0x047E, -300),
                (6, 0x047E, 0),
            ] {
                round.frame(stw1, |signal| {
                    if signal == signal::NSOLL_A {
                        speed
                    } else {
                        value(signal, number)
                    }
                });
                let runs = stw1 == 0x047F;
                *round.speeds.last_mut().unwrap() = Some(if runs { speed } else { 0 });
            }
        }
        round
    }

    /// Returns the position mode with MDI, manual 5.10.2 and 5.10.3: enable, home where it stands, two turns forward,
    /// one turn back on the fly, off.
    fn positioning(telegram: u16) -> Self {
        let mut round = Self::without_frames(telegram);
        for (stw1, turns) in [
            (0x043E, 0),
            (0x043F, 0),
            (0x0C3F, 0),
            (0x043F, 2),
            (0x047F, 2),
            (0x043F, 2),
            (0x047F, -1),
            (0x043F, -1),
            (0x043E, 0),
        ] {
            round.frame(stw1, |signal| match signal {
                signal::SATZANW => 0x8000,
                signal::MDI_TARPOS => turns * 65_536,
                signal::MDI_VELOCITY => 0x0CCC_CCCD,    // 600 rpm
                signal::MDI_ACC | signal::MDI_DEC => 8, // 6104 rpm/s
                _ => 0,
            });
        }
        round
    }

    fn without_frames(telegram: u16) -> Self {
        let (setpoint, actual) = mappings(telegram);
        let all = setpoint.fields().iter().chain(actual.fields());
        let signals = all
            .map(|field| field.signal.number)
            .filter(|number| AKD.by_pnu(*number).is_some());
        Self {
            telegram,
            signals: signals.collect(),
            setpoint,
            actual,
            frames: Vec::new(),
            speeds: Vec::new(),
        }
    }

    /// Returns its frames as the script takes them: each with the speed that it waits for, where the inputs have one.
    fn frames(&self) -> String {
        let field = self.actual.fields().iter();
        let speed = field.clone().find(|field| field.signal.number == signal::NIST_A);
        let texts = self.frames.iter().zip(&self.speeds).map(|(frame, wanted)| {
            let wanted = speed.zip(*wanted);
            let wanted =
                wanted.map_or_else(String::new, |(field, speed)| format!(":{}:{speed}", field.offset));
            hex(frame) + &wanted
        });
        texts.collect::<Vec<_>>().join(",")
    }

    fn frame(&mut self, stw1: i64, value: impl Fn(u16) -> i64) {
        let length = AKD.device.telegram(self.telegram).unwrap().outputs;
        let mut data = vec![0; length.into()];
        for field in self.setpoint.fields() {
            let value = match field.signal.number {
                signal::STW1 => stw1,
                other => value(other),
            };
            field.set(&mut data, value).unwrap();
        }
        self.frames.push(data);
        self.speeds.push(None);
    }

    /// Reads them all in one request.
    fn request(&self) -> Vec<u8> {
        let mut request = vec![0x11, 1, 0, u8::try_from(self.signals.len() + 1).unwrap()];
        for number in self.signals.iter().chain(&[922]) {
            request.extend([0x10, 1]);
            request.extend(number.to_be_bytes());
            request.extend([0, 0]);
        }
        request
    }

    /// Returns the values in the answer, by signal.
    fn values(&self, answer: &[u8]) -> HashMap<u16, i64> {
        assert_eq!(answer[..2], [0x11, 1], "{answer:02X?}");
        let mut rest = &answer[4..];
        let mut values = HashMap::new();
        for number in self.signals.iter().chain(&[922]) {
            let octets = if rest[0] == 0x43 { 4 } else { 2 };
            assert_eq!(rest[1], 1);
            let parameter = AKD.by_pnu(*number).unwrap();
            assert_eq!(
                (rest[0], octets),
                (parameter.size.format_code(), parameter.size.octets())
            );
            let raw = rest[2..2 + octets]
                .iter()
                .fold(0_u64, |raw, octet| raw << 8 | u64::from(*octet));
            let raw = match (octets, parameter.signed) {
                (2, true) => i64::from(raw as u16 as i16),
                (4, true) => i64::from(raw as u32 as i32),
                _ => raw.cast_signed(),
            };
            values.insert(*number, raw);
            rest = &rest[2 + octets..];
        }
        assert!(rest.is_empty());
        values
    }

    /// Compares one frame and the inputs around the answer with the parameters.
    fn compare(&self, output: &[u8], before: &[u8], answer: &[u8], after: &[u8]) {
        let values = self.values(answer);
        let context = |name: &str| {
            format!(
                "telegram {}, {name}, {output:02X?} {before:02X?} {after:02X?}",
                self.telegram
            )
        };
        assert_eq!(values[&922], i64::from(self.telegram));
        for field in self.setpoint.fields() {
            if let Some(value) = values.get(&field.signal.number) {
                assert_eq!(field.get(output), Some(*value), "{}", context(field.signal.name));
            }
        }
        let turning = self.actual.get(before, signal::ZSW1).unwrap() & 0x0004 != 0;
        for field in self.actual.fields() {
            let Some(value) = values.get(&field.signal.number) else {
                continue;
            };
            let (low, high) = (field.get(before).unwrap(), field.get(after).unwrap());
            let (low, high) = (low.min(high), low.max(high));
            // While it turns the values go on between the frames and the answer.
            let play = match field.signal.number {
                signal::NIST_A if turning => 3,
                signal::ITIST_GLATT if turning => 200,
                signal::XIST_A if turning => 2,
                _ => 0,
            };
            assert!(
                (low - play..=high + play).contains(value),
                "{value}: {}",
                context(field.signal.name)
            );
        }
    }
}

fn octets(text: &serde_json::Value) -> Vec<u8> {
    let text: Vec<char> = text
        .as_str()
        .unwrap()
        .chars()
        .filter(|c| !c.is_whitespace())
        .collect();
    text.chunks(2)
        .map(|pair| u8::from_str_radix(&pair.iter().collect::<String>(), 16).unwrap())
        .collect()
}

fn hex(octets: &[u8]) -> String {
    octets.iter().map(|octet| format!("{octet:02x}")).collect()
}

/// Chooses a free telegram and maps it, word by word.
fn mapping_jobs(telegram: u16) -> Vec<String> {
    let write = |pnu: u16, subindex: u16, value: u16| {
        let mut request = vec![1, 2, 0, 1, 0x10, 1];
        for word in [pnu, subindex, 0x4201, value] {
            request.extend(word.to_be_bytes());
        }
        hex(&request)
    };
    let mut jobs = vec![write(922, 0, telegram)];
    for (pnu, map) in [(915, SETPOINTS), (916, ACTUALS)] {
        jobs.extend((0..).zip(map).map(|(word, number)| write(pnu, word, number)));
    }
    jobs
}

/// What the script saw of one frame.
struct Seen {
    output: Vec<u8>,
    after: Vec<u8>,
}

/// Runs the rounds one after the other on one drive, with these jobs before; compares everything, and gives what was
/// seen, by round.
fn run(name: &str, jobs: &[String], rounds: &[Round]) -> Vec<Vec<Seen>> {
    let lab = Lab::new(name);
    let capture = lab.capture("traffic");
    let at = [
        "--mac",
        Side::Device.mac(),
        "--name",
        "drive-one",
        "--ip",
        "192.168.77.50/24",
    ];
    let drive = simulate(&lab, &at);
    let mut line: Vec<String> = Vec::new();
    let mut add = |words: &[&str]| line.extend(words.iter().map(|word| (*word).to_owned()));
    add(&["--name", "drive-one", "--ip", "192.168.77.50"]);
    // the longest watchdog there is, about: a busy machine holds a program up
    add(&["--ratio", "16", "--watchdog", "100", "--search-time", "1"]);
    for job in jobs {
        add(&["--job", job]);
    }
    for round in rounds {
        let (slots, frames) = (slots(&AKD.device, round.telegram), round.frames());
        add(&["--round", &format!("{slots}|{frames}|{}", hex(&round.request()))]);
    }
    add(&["--steps", "find,configure,telegrams"]);
    let finished = controller(&lab, &line, 300);
    let file = capture.stop();
    let steps = finished.ok().json_lines();

    let records: Vec<_> = steps.iter().filter(|step| step["step"] == "record").collect();
    assert_eq!(records.len(), jobs.len());
    for record in records {
        assert_eq!(record["answer"], "010200010000", "{record}");
    }
    let mut all = Vec::new();
    for (number, round) in rounds.iter().enumerate() {
        let of_round = |name: &'static str| {
            let fits = move |step: &&serde_json::Value| step["step"] == name && step["round"] == number;
            steps.iter().filter(fits).collect::<Vec<_>>()
        };
        let signals = of_round("signals");
        assert_eq!(
            signals.len(),
            round.frames.len(),
            "telegram {}: {signals:?}",
            round.telegram
        );
        let seen = signals.into_iter().map(|step| {
            let part = |name: &str| octets(&step[name]);
            let (output, after) = (part("output"), part("after"));
            round.compare(&output, &part("before"), &part("answer"), &after);
            Seen { output, after }
        });
        all.push(seen.collect());
        let end = of_round("round")[0];
        assert_eq!(
            (&end["state"], &end["errors"]),
            (&"RUNNING".into(), &serde_json::json!([])),
            "{end}"
        );
    }
    judge::judge(&file).clean().saw("pn_rt", 200).saw("pn_io", 20);
    drive.interrupt(Duration::from_secs(20)).ok();
    all
}

#[test]
fn every_telegram_with_profinet_py() {
    let rounds: Vec<Round> = [1, 7, 9, 350, 351, 352, 353, 354, 400, 0].map(Round::new).into();
    let jobs = [mapping_jobs(400), mapping_jobs(0)].concat();
    let seen = run("profinetpy-telegrams", &jobs, &rounds);
    for (round, seen) in rounds.iter().zip(seen) {
        for Seen { output, after } in seen {
            // It turns where it should, so that what is compared is not 0 everywhere.
            if let Some(speed) = round.actual.get(&after, signal::NIST_A) {
                let running = round.setpoint.get(&output, signal::STW1) == Some(0x047F);
                let wanted = round.setpoint.get(&output, signal::NSOLL_A).unwrap();
                let wanted = if running { wanted } else { 0 };
                assert!(
                    speed.abs_diff(wanted) < 8,
                    "telegram {}: {speed} for {wanted}",
                    round.telegram
                );
            }
        }
    }
}

#[test]
fn positioning_by_mdi_with_profinet_py() {
    let rounds: Vec<Round> = [9, 352, 353].map(Round::positioning).into();
    let position_mode = "01020001100103a2000042010002".to_owned();
    let seen = run("profinetpy-positioning", &[position_mode], &rounds);
    for (round, seen) in rounds.iter().zip(seen) {
        let status = |at: usize| round.actual.get(&seen[at].after, signal::ZSW1).unwrap();
        let position = |at: usize| round.actual.get(&seen[at].after, signal::XIST_A).unwrap();
        let all: Vec<String> = (0..seen.len())
            .map(|at| format!("{:#06x} {}", status(at), position(at)))
            .collect();
        assert_eq!(
            (status(0) & 0x0077, status(1) & 0x0077),
            (0x0031, 0x0037),
            "{all:?}"
        );
        assert_eq!(
            status(2) & 0x2C00,
            0x2C00,
            "homed, at its target, stopped: {all:?}"
        );
        assert_eq!(status(4) & 0x1000, 0x1000, "the task is acknowledged: {all:?}");
        assert_eq!(
            status(5) & 0x3400,
            0x2400,
            "there, the acknowledge is gone: {all:?}"
        );
        assert_eq!(status(7) & 0x3400, 0x2400, "{all:?}");
        let turns = |from: usize, to: usize| (position(to) - position(from)) as f64 / 65_536.0;
        assert!((turns(3, 5) - 2.0).abs() < 0.02, "{all:?}");
        assert!((turns(5, 7) + 1.0).abs() < 0.02, "{all:?}");
        assert_eq!(status(8) & 0x0077, 0x0031, "{all:?}");
    }
}
