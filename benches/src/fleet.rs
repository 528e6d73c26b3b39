//! Many virtual drives in one process, our controller in another: what is lost, what a drive costs, how fast all are there.
//!
//! A machine that is held up by its host leaves cycles out. A program for each processor that only sleeps shows how long.

use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use network::system::{First, Rank};
use serde_json::Value;
use system_tests::{Lab, Running, Side, built};

use crate::table::Row;

/// How long the sleeping programs sleep: what they do not see of a stall.
const NAP: Duration = Duration::from_micros(250);
/// A wake-up that is later than this is a stall.
const LATE: Duration = Duration::from_micros(250);
/// Processor time of one drive in a cycle above the share of the kernel.
const CPU: f64 = 3.0;
const MEMORY: f64 = 48.0;

/// 2,000 at 16 ms and 120 at 1 ms, a minute each.
pub fn compare() -> Vec<Row> {
    let mut rows = fleet(2_000, 16, 120);
    rows.extend(fleet(120, 1, 255));
    rows
}

/// `hold` is the watchdog in cycles.
fn fleet(count: u32, cycle_ms: u64, hold: u32) -> Vec<Row> {
    let lab = Lab::alone("bench-fleet");
    let begin = Instant::now();
    let arguments = format!(
        "simulate --model akd -i dev0 --name akd --count {count} --ip 10.0.1.1/16 --min-cycle {cycle_ms}ms"
    );
    let mut drives = lab.spawn(Side::Device, built("profidrive"), arguments.split(' '));
    drives.wait_for("Ctrl-C ends", Duration::from_secs(60));
    let started = begin.elapsed();

    let names: Vec<String> = (1..=count).map(|n| format!("akd-{n}")).collect();
    let names = names.join(",");
    let cycle = format!("cycle_us={}", cycle_ms * 1000);
    let hold = format!("hold={hold}");
    let arguments = [
        "ctl0",
        "akd",
        &names,
        &cycle,
        &hold,
        "seconds=60",
        "records=0",
        "ip=10.0.0.2/16",
    ];
    let asked = SystemTime::now();
    let mut controller = lab.spawn(Side::Controller, built("test-controller"), arguments);
    controller.wait_for("\"running\"", Duration::from_secs(120));
    let running = controller.out().lines().find_map(|line| {
        let step: Value = serde_json::from_str(line).ok()?;
        step["at_us"].as_u64().filter(|_| step["step"] == "running")
    });
    let asked = asked.duration_since(UNIX_EPOCH).unwrap();
    let connected = Duration::from_micros(running.unwrap()) - asked;
    // what the start-up left to do is over
    std::thread::sleep(Duration::from_secs(2));

    let stalls = Stalls::watch();
    let window = Duration::from_secs(50);
    let (before, begin) = (Share::of(&drives), Instant::now());
    std::thread::sleep(window);
    let after = Share::of(&drives);
    let cycles = begin.elapsed().as_secs_f64() * 1000.0 / cycle_ms as f64 * f64::from(count);
    let stalls = stalls.end();
    let micros = |before: f64, after: f64| (after - before) * 1e6 / cycles;
    let (user, kernel) = (
        micros(before.user, after.user),
        micros(before.kernel, after.kernel),
    );
    let resident = after.resident_kb as f64 / f64::from(count);

    let finished = controller.finish(Duration::from_secs(120));
    let steps = finished.json_lines();
    let number = |step: &Value, field: &str| step[field].as_u64().unwrap_or(0);
    let exchanges: Vec<&Value> = steps.iter().filter(|step| step["step"] == "exchange").collect();
    let good = exchanges.iter().filter(|step| step["good"] == true).count();
    // the controller ends with the first loss, and leaves the drives that it has not lost
    let loss = steps.iter().find(|step| step["step"] == "lost");
    let lost = loss.map_or(count as usize - good, |loss| number(loss, "count") as usize);
    let loss = loss.map(|loss| {
        let (name, cause) = (loss["name"].as_str(), loss["cause"].as_str());
        format!(
            "{} after {} s: {}",
            name.unwrap_or_default(),
            number(loss, "after_ms") / 1000,
            cause.unwrap_or_default()
        )
    });
    let missed = exchanges
        .iter()
        .map(|step| number(step, "missed").max(number(step, "skipped")));
    let missed = missed.max().unwrap_or(0);
    drives.interrupt(Duration::from_secs(20)).ok();

    let millis = |time: Duration| format!("{:.1} ms", time.as_secs_f64() * 1000.0);
    let of = |what: &str| format!("{count} drives at {cycle_ms} ms: {what}");
    let explained = explained(&stalls, Duration::from_millis(cycle_ms));
    let mut rows = vec![
        Row::new(&of("all discoverable after"), millis(started))
            .limit("1 s".into(), started < Duration::from_secs(1)),
        Row::new(&of("all connected after"), millis(connected))
            .limit("5 s".into(), connected < Duration::from_secs(5)),
        Row::new(&of("connections lost in 60 s"), lost.to_string())
            .beside(loss.unwrap_or_default())
            .limit("0".into(), good == count as usize),
    ];
    // of the time after the controller ended nothing is to be said
    if good < count as usize {
        return rows;
    }
    rows.extend([
        Row::new(&of("most cycles a drive missed in 60 s"), missed.to_string())
            .beside(format!(
                "idle programs stalled {} times, {} in all, longest {}",
                stalls.len(),
                millis(stalls.iter().sum()),
                millis(stalls.iter().copied().max().unwrap_or_default())
            ))
            .limit(format!("{explained} by stalls"), missed <= explained),
        Row::new(
            &of("processor time of a drive and cycle"),
            format!("{user:.2} us"),
        )
        .beside(format!("kernel {kernel:.2} us"))
        .limit(format!("{CPU} us"), user <= CPU),
    ]);
    // of a small fleet the program itself is the most
    if count >= 1_000 {
        rows.push(
            Row::new(&of("resident memory of a drive"), format!("{resident:.1} kB"))
                .limit(format!("{MEMORY} kB"), resident < MEMORY),
        );
    }
    rows
}

/// Cycles of one drive that stalls of the host explain, of the processor of either process: one of more than half a cycle
/// costs those that it touches.
fn explained(stalls: &[Duration], cycle: Duration) -> u64 {
    let long = stalls.iter().filter(|stall| **stall > cycle / 2);
    long.map(|stall| stall.as_nanos().div_ceil(cycle.as_nanos()) as u64)
        .sum()
}

/// What a process has used of the machine.
struct Share {
    user: f64,
    kernel: f64,
    resident_kb: u64,
}

impl Share {
    fn of(process: &Running) -> Self {
        let read = |name: &str| std::fs::read_to_string(format!("/proc/{}/{name}", process.pid())).unwrap();
        let stat = read("stat");
        // behind the name of the program, which may contain blanks
        let fields: Vec<&str> = stat.rsplit_once(')').unwrap().1.split_whitespace().collect();
        let seconds = |index: usize| fields[index].parse::<f64>().unwrap() / 100.0;
        let status = read("status");
        let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let resident = resident.unwrap().trim().trim_end_matches(" kB");
        Self {
            user: seconds(11),
            kernel: seconds(12),
            resident_kb: resident.parse().unwrap(),
        }
    }
}

/// A program beside both for each processor that only sleeps there, before all others: what it waits for is the host.
struct Stalls(Vec<Child>);

impl Stalls {
    fn watch() -> Self {
        let own = std::env::current_exe().unwrap();
        let processors = std::thread::available_parallelism().unwrap().get();
        let start = |processor: usize| {
            let mut command = Command::new("taskset");
            command
                .args(["-c", &processor.to_string()])
                .arg(&own)
                .arg("stalls");
            command.stdin(Stdio::piped()).stdout(Stdio::piped());
            command.spawn().unwrap()
        };
        Self((0..processors).map(start).collect())
    }

    /// Returns each stall since the start.
    fn end(self) -> Vec<Duration> {
        let lines = self.0.into_iter().flat_map(|mut child| {
            drop(child.stdin.take());
            let output = child.wait_with_output().unwrap();
            assert!(output.status.success());
            let text = String::from_utf8(output.stdout).unwrap();
            text.lines().map(str::to_owned).collect::<Vec<_>>()
        });
        lines
            .map(|line| Duration::from_micros(line.parse().unwrap()))
            .collect()
    }
}

/// Sleeps until the input ends; prints each stall in microseconds then.
pub fn watch_stalls() {
    let stop = Arc::new(AtomicBool::new(false));
    let ended = stop.clone();
    std::thread::spawn(move || {
        let _ = std::io::copy(&mut std::io::stdin(), &mut std::io::sink());
        ended.store(true, Ordering::Relaxed);
    });
    let _first = First::new(Rank::Clock);
    let mut stalls = Vec::new();
    while !stop.load(Ordering::Relaxed) {
        let begin = Instant::now();
        std::thread::sleep(NAP);
        let late = begin.elapsed().saturating_sub(NAP);
        if late > LATE {
            stalls.push(late);
        }
    }
    for stall in stalls {
        println!("{}", stall.as_micros());
    }
}
