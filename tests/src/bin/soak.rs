//! Many virtual drives in one process and one program of the library as their controller, for hours: it connects to all of
//! them, keeps their axes, reads parameters, and leaves them, each minute again. In every other minute the cable is pulled
//! instead. Memory, file handles and threads of both processes must not grow.
//!
//! - `soak MINUTES [DRIVES]`: makes a laboratory, runs both processes in it and prints one JSON object for each minute.
//!   Exit code 1 if anything grew.
//! - `soak control INTERFACE MINUTES NAME...`: the controller.
#![forbid(unsafe_code)]

use std::process::ExitCode;
use std::time::{Duration, Instant};

use client::axis::Purpose;
use client::{AxisSettings, Error};
use futures::future::join_all;
use profidrive::{Access, Caller, Opening, Wait};
use profile::notation::Notation;
use profile::value::Selection;
use serde_json::{Value, json};
use system_tests::{Lab, Running, Side, built, simulate};

type Done<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// From one connection to the next.
const ROUND: Duration = Duration::from_secs(60);
/// How long the axes are kept.
const HOLD: Duration = Duration::from_secs(40);
/// How long a cable that was pulled stays out: longer than any watchdog.
const OUT: Duration = Duration::from_secs(5);
/// Rounds until all buffers have their size: two with each way to end.
const WARM: usize = 4;
/// What the resident memory may grow by from then on: pages that the allocator has not given back.
const ROOM_KB: u64 = 1024;
/// Read from each drive while its axis is kept.
const READ: [u16; 4] = [2108, 2115, 2439, 947];

fn main() -> Done<ExitCode> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["control", interface, minutes, ref names @ ..] => {
            control(interface, minutes.parse()?, names)?;
            Ok(ExitCode::SUCCESS)
        }
        [minutes] => soak(minutes.parse()?, 200),
        [minutes, drives] => soak(minutes.parse()?, drives.parse()?),
        _ => Err("give MINUTES [DRIVES]".into()),
    }
}

/// The laboratory around both processes.
fn soak(minutes: usize, drives: usize) -> Done<ExitCode> {
    let lab = Lab::new("soak");
    let count = drives.to_string();
    let simulation = [
        "--model",
        "akd",
        "--name",
        "akd",
        "--count",
        &count,
        "--ip",
        "192.168.77.20/24",
    ];
    let drives_process = simulate(&lab, &simulation);
    let names = (1..=drives).map(|number| format!("akd-{number}"));
    let arguments = ["control".into(), "ctl0".into(), minutes.to_string()];
    let mut controller = lab.spawn(
        Side::Controller,
        built("soak"),
        arguments.into_iter().chain(names),
    );

    let mut used: Vec<[Usage; 2]> = Vec::new();
    for round in 0..minutes {
        let step = |step: &str| format!(r#""round":{round},"step":"{step}""#);
        controller.wait_for(&step("held"), 2 * ROUND);
        let sample = [Usage::of(&drives_process), Usage::of(&controller)];
        if pulled(round) {
            controller.wait_for(&step("pull"), 2 * ROUND);
            lab.link(Side::Device, false);
            std::thread::sleep(OUT);
            lab.link(Side::Device, true);
        }
        controller.wait_for(&step("left"), 2 * ROUND);
        println!(
            "{}",
            json!({"minute": round, "drives": sample[0].shown(), "controller": sample[1].shown()})
        );
        used.push(sample);
    }
    let finished = controller.finish(2 * ROUND).ok();
    let lines = finished.json_lines();
    let sum = |field: &str| lines.iter().filter_map(|line| line[field].as_u64()).sum::<u64>();
    println!(
        "{}",
        json!({"connected": sum("connected"), "read": sum("read"), "failed": sum("failed"), "rounds": minutes})
    );

    let mut problems = Vec::new();
    let expected = (minutes * drives) as u64;
    if sum("connected") != expected || sum("read") != expected || sum("failed") > 0 {
        problems.push("an axis was not taken, not read or not left as expected".to_owned());
    }
    for (at, process) in ["drives", "controller"].into_iter().enumerate() {
        let later = used.get(WARM..).unwrap_or_default();
        let Some(first) = later.first().map(|sample| &sample[at]) else {
            problems.push(format!("fewer than {} minutes show nothing", WARM + 1));
            break;
        };
        for sample in later.iter().map(|sample| &sample[at]) {
            problems.extend(sample.problem(first).map(|what| format!("{process}: {what}")));
        }
    }
    problems.dedup();
    for problem in &problems {
        eprintln!("{problem}");
    }
    Ok(ExitCode::from(u8::from(!problems.is_empty())))
}

/// Returns whether the cable is pulled at the end of a round.
const fn pulled(round: usize) -> bool {
    round % 2 == 1
}

/// What a process has at a moment.
struct Usage {
    resident_kb: u64,
    handles: usize,
    threads: usize,
}

impl Usage {
    fn of(process: &Running) -> Self {
        let folder = format!("/proc/{}", process.pid());
        let status = std::fs::read_to_string(format!("{folder}/status")).unwrap();
        let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let resident = resident.unwrap().trim().trim_end_matches(" kB");
        let entries = |name: &str| std::fs::read_dir(format!("{folder}/{name}")).unwrap().count();
        Self {
            resident_kb: resident.parse().unwrap(),
            handles: entries("fd"),
            threads: entries("task"),
        }
    }

    fn shown(&self) -> Value {
        json!({"resident_kb": self.resident_kb, "handles": self.handles, "threads": self.threads})
    }

    /// Returns what has grown since `first`.
    fn problem(&self, first: &Self) -> Option<String> {
        let most = first.resident_kb + first.resident_kb / 50 + ROOM_KB;
        if self.resident_kb > most {
            return Some(format!(
                "resident memory {} kB, at first {} kB",
                self.resident_kb, first.resident_kb
            ));
        }
        if self.handles > first.handles || self.threads > first.threads {
            return Some(format!(
                "{} file handles and {} threads, at first {} and {}",
                self.handles, self.threads, first.handles, first.threads
            ));
        }
        None
    }
}

/// One program that takes all axes and leaves them, round by round.
fn control(interface: &str, rounds: usize, names: &[&str]) -> Done<()> {
    let network = Opening::new(Access::Cyclic).on(interface).open()?;
    for round in 0..rounds {
        let begin = Instant::now();
        let step = |step: &str| println!("{}", json!({"round": round, "step": step}));
        let taken = join_all(names.iter().map(|name| take(network.clone(), name))).wait();
        let mut failed = 0;
        let mut axes = Vec::new();
        for axis in taken {
            match axis {
                Ok(axis) => axes.push(axis),
                Err(error) => {
                    failed += 1;
                    eprintln!("round {round}: {error}");
                }
            }
        }
        let connected = axes.len();
        let reads = axes
            .iter()
            .map(|axis| read(network.clone(), axis.drive().clone()));
        let read = join_all(reads).wait().into_iter().filter(|read| *read).count();
        step("held");
        let half = HOLD.saturating_sub(begin.elapsed()) / 2;
        let kept = join_all(axes.iter_mut().map(|axis| axis.hold(half))).wait();
        failed += unexpected(round, "kept", &kept, true);
        if pulled(round) {
            step("pull");
        }
        let kept = join_all(axes.iter_mut().map(|axis| axis.hold(half))).wait();
        failed += unexpected(round, "kept until its end", &kept, !pulled(round));
        let left = join_all(axes.into_iter().map(client::Axis::release)).wait();
        failed += unexpected(round, "left", &left, !pulled(round));
        println!(
            "{}",
            json!({"round": round, "connected": connected, "read": read, "failed": failed})
        );
        step("left");
        std::thread::sleep(ROUND.saturating_sub(begin.elapsed()));
    }
    Ok(())
}

/// Returns how many did not end as expected, and says of the first of them what happened and when.
fn unexpected<T>(round: usize, what: &str, ends: &[Result<T, Error>], good: bool) -> usize {
    let mut others = ends.iter().filter(|end| end.is_ok() != good);
    let Some(first) = others.next() else {
        return 0;
    };
    let count = 1 + others.count();
    let error = first.as_ref().err().map(ToString::to_string);
    let error = error.as_deref().unwrap_or("no error");
    eprintln!(
        "{:?} round {round}: {count} axes not {what} as expected, the first: {error}",
        network::system::now()
    );
    count
}

async fn take(mut session: Caller, name: &str) -> Result<client::Axis, Error> {
    let mut drive = session.find(&name.parse().unwrap()).await?;
    let settings = AxisSettings::for_purpose(Purpose::Speed);
    session.take_axis(&mut drive, settings).await
}

/// Returns whether each parameter had an answer, an answer that refuses it included.
async fn read(mut session: Caller, mut drive: client::Drive) -> bool {
    let wanted = READ.map(|pnu| Selection::number(pnu, Notation::Name));
    match session.read(&mut drive, &wanted).await {
        Ok(readings) => readings.len() == READ.len(),
        Err(error) => {
            eprintln!("{error}");
            false
        }
    }
}
