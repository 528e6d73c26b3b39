//! Many virtual drives in one process, our controller in another: what is lost, what a drive costs, how fast all are there.
//!
//! A machine that is held up by its host leaves cycles out. A thread beside both that only sleeps shows for how long.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use network::system::{First, Rank};
use serde_json::Value;
use system_tests::{Lab, Running, Side, built};

use crate::table::Row;

/// A wake-up that is later than this counts as a stall: half a cycle of 1 ms.
const LATE: Duration = Duration::from_micros(500);
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
    let (stalled, longest) = stalls.end();
    let micros = |before: f64, after: f64| (after - before) * 1e6 / cycles;
    let (user, kernel) = (
        micros(before.user, after.user),
        micros(before.kernel, after.kernel),
    );
    let resident = after.resident_kb as f64 / f64::from(count);

    let finished = controller.finish(Duration::from_secs(120));
    let steps = finished.json_lines();
    let exchanges: Vec<&Value> = steps.iter().filter(|step| step["step"] == "exchange").collect();
    let lost = count as usize - exchanges.iter().filter(|step| step["good"] == true).count();
    let number = |step: &Value, field: &str| step[field].as_u64().unwrap_or(0);
    let missed = exchanges
        .iter()
        .map(|step| number(step, "missed").max(number(step, "skipped")));
    let missed = missed.max().unwrap_or(0);
    drives.interrupt(Duration::from_secs(20)).ok();

    let millis = |time: Duration| format!("{:.1} ms", time.as_secs_f64() * 1000.0);
    let of = |what: &str| format!("{count} drives at {cycle_ms} ms: {what}");
    // a stall of either process costs each drive the cycles that fall into it, and the one that it began in
    let explained = (stalled.as_millis() as u64).div_ceil(cycle_ms);
    let mut rows = vec![
        Row::new(&of("connections lost in 60 s"), lost.to_string()).limit("0".into(), lost == 0),
        Row::new(&of("most cycles a drive missed in 60 s"), missed.to_string())
            .beside(format!(
                "idle thread stalled {}, longest {}",
                millis(stalled),
                millis(longest)
            ))
            .limit(format!("{explained} by stalls"), missed <= explained),
        Row::new(
            &of("processor time of a drive and cycle"),
            format!("{user:.2} us"),
        )
        .beside(format!("kernel {kernel:.2} us"))
        .limit(format!("{CPU} us"), user <= CPU),
        Row::new(&of("all discoverable after"), millis(started))
            .limit("1 s".into(), started < Duration::from_secs(1)),
        Row::new(&of("all connected after"), millis(connected))
            .limit("5 s".into(), connected < Duration::from_secs(5)),
    ];
    // of a small fleet the program itself is the most
    if count >= 1_000 {
        rows.push(
            Row::new(&of("resident memory of a drive"), format!("{resident:.1} kB"))
                .limit(format!("{MEMORY} kB"), resident < MEMORY),
        );
    }
    rows
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

/// A thread that only sleeps.
struct Stalls {
    stop: Arc<AtomicBool>,
    thread: std::thread::JoinHandle<(Duration, Duration)>,
}

impl Stalls {
    fn watch() -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let ended = stop.clone();
        let thread = std::thread::spawn(move || {
            // what it waits for is the host then, not the drives
            let _first = First::new(Rank::Clock);
            let nap = Duration::from_millis(1);
            let (mut sum, mut longest) = (Duration::ZERO, Duration::ZERO);
            while !ended.load(Ordering::Relaxed) {
                let begin = Instant::now();
                std::thread::sleep(nap);
                let late = begin.elapsed().saturating_sub(nap);
                if late > LATE {
                    sum += late;
                    longest = longest.max(late);
                }
            }
            (sum, longest)
        });
        Self { stop, thread }
    }

    /// Time by which it woke up too late: in all, and the longest.
    fn end(self) -> (Duration, Duration) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().unwrap()
    }
}
