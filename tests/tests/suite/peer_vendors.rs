//! An independent controller (profinet-py) runs the VLT and the Vacon: telegram 1 and telegrams of the vendors, with
//! the parameter channel in them.

use std::time::Duration;

use profile::catalogue::{Catalogue, VACON, VLT};
use profile::telegram::{Telegram, signal};
use serde_json::Value;
use system_tests::profinetpy::{controller, slots};
use system_tests::{Lab, Side, judge, simulate};

/// Reads 9-22 of a VLT: which telegram is in use.
const TELEGRAM: &str = "11 01 00 01 10 01 03 9A 00 00";
/// Reads ID 103 of a Vacon, an element of PNU 10001.
const ID_103: &str = "11 01 01 01 10 01 27 11 00 67";

/// Frames of one connection, and a parameter request that is sent while each of them stands.
struct Round {
    telegram: u16,
    frames: &'static [&'static str],
    request: &'static str,
}

/// What the controller saw while one frame stood.
#[derive(Debug)]
struct Seen {
    inputs: Vec<u8>,
    answer: Vec<u8>,
}

fn octets(text: &str) -> Vec<u8> {
    let digits: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    (0..digits.len() / 2)
        .map(|at| u8::from_str_radix(&digits[2 * at..2 * at + 2], 16).unwrap())
        .collect()
}

/// Runs the rounds one after the other on one virtual drive; all its frames have to please the dissector.
fn run(tables: &'static Catalogue, rounds: &[Round]) -> Vec<Vec<Seen>> {
    let model = tables.model.to_ascii_lowercase();
    let lab = Lab::new(&format!("profinetpy-{model}"));
    let capture = lab.capture("traffic");
    let mac = Side::Device.mac();
    let ip = "192.168.77.50/24";
    let drive = simulate(
        &lab,
        &["--model", &model, "--mac", mac, "--name", "drive-one", "--ip", ip],
    );
    let subslot = tables.device.layout.telegram.to_string();
    let mut line: Vec<String> = ["--name", "drive-one", "--ip", "192.168.77.50", "--ratio", "16"]
        .into_iter()
        .chain(["--watchdog", "30", "--search-time", "1", "--hold", "2"])
        .chain(["--subslot", &subslot])
        .map(str::to_owned)
        .collect();
    for round in rounds {
        let slots = slots(&tables.device, round.telegram);
        let frames: Vec<String> = round.frames.iter().map(|frame| frame.replace(' ', "")).collect();
        line.push("--round".into());
        line.push(format!(
            "{slots}|{}|{}",
            frames.join(","),
            round.request.replace(' ', "")
        ));
    }
    line.extend(["--steps", "telegrams"].map(str::to_owned));
    let finished = controller(&lab, &line, 180);
    let file = capture.stop();
    let steps = finished.ok().json_lines();
    let seen = rounds.iter().enumerate().map(|(number, round)| {
        let of_round = |name: &'static str| {
            let fits = move |step: &&Value| step["step"] == name && step["round"] == number;
            steps.iter().filter(fits).collect::<Vec<_>>()
        };
        let end = of_round("round");
        let state = (&end[0]["state"], &end[0]["errors"]);
        assert_eq!(state, (&"RUNNING".into(), &serde_json::json!([])), "{end:?}");
        let signals = of_round("signals");
        assert_eq!(signals.len(), round.frames.len());
        let part = |step: &Value, name: &str| octets(step[name].as_str().unwrap());
        signals
            .iter()
            .map(|step| Seen {
                inputs: part(step, "after"),
                answer: part(step, "answer"),
            })
            .collect()
    });
    let seen = seen.collect();
    let verdict = judge::judge(&file);
    verdict.clean().saw("pn_rt", 1000).saw("pn_io", 20);
    assert!(verdict.warnings.is_empty(), "{:?}", verdict.warnings);
    drive.interrupt(Duration::from_secs(5)).ok();
    seen
}

impl Seen {
    fn signal(&self, tables: &Catalogue, telegram: u16, number: u16) -> i64 {
        let telegram = Telegram::find(telegram, tables.device.vendor_id).unwrap();
        telegram.actual.get(&self.inputs, number).unwrap()
    }

    fn pkw(&self) -> [u8; 8] {
        self.inputs[..8].try_into().unwrap()
    }
}

#[track_caller]
fn near(actual: i64, wanted: i64, tolerance: i64) {
    assert!((actual - wanted).abs() <= tolerance, "{actual} for {wanted}");
}

#[test]
fn the_vlt_with_profinet_py() {
    let rounds = [
        // PROFIdrive words: OFF, ON, 50 %, OFF
        Round {
            telegram: 1,
            frames: &["047E 0000", "047F 0000", "047F 2000", "047E 2000"],
            request: TELEGRAM,
        },
        // PPO type 1 with FC words: read 1-20; start at 50 % and read the number of elements of 15-30; write 3-41 := 2 s;
        // a number that is not there; the zero telegram and stop
        Round {
            telegram: 101,
            frames: &[
                "1078 0000 0000 0000 043C 0000",
                "95FA 0000 0000 0000 047C 2000",
                "3155 0000 0000 00C8 047C 2000",
                "1FFF 0000 0000 0000 047C 2000",
                "0000 0000 0000 0000 043C 0000",
            ],
            request: TELEGRAM,
        },
        // PPO type 4, no parameter channel
        Round {
            telegram: 104,
            frames: &[
                "043C 0000 0000 0000 0000 0000",
                "047C 1000 0000 0000 0000 0000",
                "043C 0000 0000 0000 0000 0000",
            ],
            request: TELEGRAM,
        },
    ];
    let seen = run(&VLT, &rounds);
    for (round, seen) in rounds.iter().zip(&seen) {
        for seen in seen {
            // Unsigned16, one value
            let number = u8::try_from(round.telegram).unwrap();
            assert_eq!(seen.answer, [0x11, 1, 0, 1, 6, 1, 0, number], "{seen:02X?}");
        }
    }
    let speed =
        |round: usize, at: usize| seen[round][at].signal(&VLT, rounds[round].telegram, signal::NIST_A);
    let status =
        |round: usize, at: usize| seen[round][at].signal(&VLT, rounds[round].telegram, signal::ZSW1) & 0x0FFF;
    // 4000 is 100 %; slip takes a little of it
    near(speed(0, 2), 0x2000, 0x0180);
    near(speed(0, 3), 0, 8);
    near(speed(1, 1), 0x2000, 0x0180);
    near(speed(1, 4), 0, 8);
    near(speed(2, 1), 0x1000, 0x0180);
    // running and no trip
    for (round, at) in [(0, 2), (1, 1), (1, 3), (2, 1)] {
        assert_eq!(status(round, at) & 0x080F, 0x0807, "{:02X?}", seen[round][at]);
    }
    for (round, at) in [(0, 0), (1, 0), (1, 4)] {
        assert_eq!(status(round, at) & 0x0808, 0, "{:02X?}", seen[round][at]);
    }
    // 1-20 Motor Power is 0.75 kW in steps of 10 W
    assert_eq!(seen[1][0].pkw(), [0x20, 0x78, 0, 0, 0, 0, 0, 75]);
    assert_eq!(seen[1][1].pkw(), [0x65, 0xFA, 0, 0, 0, 0, 0, 10]);
    assert_eq!(seen[1][2].pkw(), [0x21, 0x55, 0, 0, 0, 0, 0, 200]);
    // requested PNU 0x0FFF: bit 11 is spare in a PPO
    assert_eq!(seen[1][3].pkw(), [0x77, 0xFF, 0, 0, 0, 0, 0, 0]);
    assert_eq!(seen[1][4].pkw(), [0; 8]);
}

#[test]
fn the_vacon_with_profinet_py() {
    let rounds = [
        Round {
            telegram: 1,
            frames: &["047E 0000", "047F 0000", "047F 1000", "047E 1000"],
            request: ID_103,
        },
        // 100 % is 10000
        Round {
            telegram: 149,
            frames: &[
                "047E 0000 0000 0000 0000 0000",
                "047F 0000 0000 0000 0000 0000",
                "047F 09C4 0000 0000 0000 0000",
                "047E 0000 0000 0000 0000 0000",
            ],
            request: ID_103,
        },
    ];
    let seen = run(&VACON, &rounds);
    for seen in seen.iter().flatten() {
        // a Vacon answers words only
        assert_eq!(seen.answer[..6], [0x11, 1, 1, 1, 0x42, 1], "{seen:02X?}");
    }
    let speed =
        |round: usize, at: usize| seen[round][at].signal(&VACON, rounds[round].telegram, signal::NIST_A);
    let status =
        |round: usize, at: usize| seen[round][at].signal(&VACON, rounds[round].telegram, signal::ZSW1);
    near(speed(0, 2), 0x1000, 0x0180);
    near(speed(0, 3), 0, 0x10);
    near(speed(1, 2), 2500, 150);
    assert_eq!(status(0, 2) & 0x007F, 0x0037, "S4: {:02X?}", seen[0][2]);
    assert_eq!(status(1, 2) & 0x100F, 0x1007, "running: {:02X?}", seen[1][2]);
    assert_eq!(status(0, 0) & 0x0077, 0x0031, "S2: {:02X?}", seen[0][0]);
}
