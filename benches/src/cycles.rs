//! CPU time of a device for its cyclic data, and the time from its start to the first valid cyclic frame: a virtual drive
//! beside pnio, our controller at the other end.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use system_tests::{Lab, Running, Side, built};

use crate::drives::simulate;
use crate::table::Row;

/// Longest time from the start of the process to the first valid cyclic frame.
const LIMIT: Duration = Duration::from_millis(40);
/// Highest CPU time of a cycle, as a multiple of that of a plain UDP answer measured beside it.
const LIMIT_TIMES_PLAIN: f64 = 1.2;

fn pnio(lab: &Lab) -> Running {
    lab.spawn(
        Side::Device,
        built("pnio-device"),
        ["dev0", "pnio-dev", "192.168.77.50"],
    )
}

/// CPU seconds per 1,000 cycles at 1, 4 and 16 ms.
pub fn cpu() -> Vec<Row> {
    let lab = Lab::new("bench-cpu");
    lab.address(Side::Device, "192.168.77.50/24");
    let own = std::env::current_exe().unwrap();
    let mut rows = Vec::new();
    for cycle_ms in [1_u64, 4, 16] {
        let measure = |kind: &str, name: &str, device: &Running| -> f64 {
            let seconds = seconds(cycle_ms);
            let options = [
                format!("cycle_us={}", cycle_ms * 1000),
                format!("seconds={seconds}"),
                "hold=20".into(),
            ];
            let arguments = ["ctl0", kind, name].into_iter().map(String::from).chain(options);
            let mut controller = lab.spawn(Side::Controller, built("test-controller"), arguments);
            controller.wait_for("running", Duration::from_secs(20));
            std::thread::sleep(Duration::from_millis(500));
            let used = used(device, Duration::from_secs(seconds - 2), cycle_ms);
            controller.finish(Duration::from_secs(60)).ok();
            used
        };
        let drive = simulate(&lab, &["--ip", "192.168.77.60/24", "--min-cycle", "1ms"]);
        let ours = measure("akd", "akd-1", &drive);
        drop(drive);
        let mut peer = pnio(&lab);
        peer.wait_for("ready", Duration::from_secs(5));
        let theirs = measure("pnio", "pnio-dev", &peer);
        drop(peer);
        let mut echo = lab.spawn(Side::Device, &own, ["echo", "192.168.77.50:5000"]);
        echo.wait_for("ready", Duration::from_secs(5));
        let millis = cycle_ms.to_string();
        let pace = lab.spawn(
            Side::Controller,
            &own,
            [
                "pace",
                "192.168.77.50:5000",
                &millis,
                &seconds(cycle_ms).to_string(),
            ],
        );
        std::thread::sleep(Duration::from_millis(500));
        let plain = used(&echo, Duration::from_secs(seconds(cycle_ms) - 2), cycle_ms);
        pace.finish(Duration::from_secs(60)).ok();
        drop(echo);
        rows.push(
            Row::new(
                &format!("CPU per 1,000 cycles at {cycle_ms} ms"),
                format!("{ours:.4} s"),
            )
            .beside(format!("pnio {theirs:.4} s, plain UDP answer {plain:.4} s"))
            .limit(
                format!("{LIMIT_TIMES_PLAIN} x plain UDP"),
                ours <= LIMIT_TIMES_PLAIN * plain,
            ),
        );
    }
    rows
}

/// Returns the duration of one measurement in seconds: at least 1,000 cycles.
const fn seconds(cycle_ms: u64) -> u64 {
    2 + if cycle_ms == 16 { 18 } else { 5 }
}

/// CPU seconds per 1,000 cycles of a process over a time: the least of three equal parts of it. What else goes on at a
/// shared machine only adds, by cold caches and slow wake-ups, to us and to the peers alike.
fn used(process: &Running, window: Duration, cycle_ms: u64) -> f64 {
    let part = || {
        let before = process.cpu();
        let start = Instant::now();
        std::thread::sleep(window / 3);
        let cycles = start.elapsed().as_secs_f64() * 1000.0 / cycle_ms as f64;
        (process.cpu() - before).as_secs_f64() * 1000.0 / cycles
    };
    (0..3).map(|_| part()).fold(f64::INFINITY, f64::min)
}

/// From the start of the device's process to its first valid cyclic frame; the controller looks for it every 2 ms.
pub fn start() -> Vec<Row> {
    let lab = Lab::new("bench-start");
    lab.address(Side::Device, "192.168.77.50/24");
    let once = |kind: &str, name: &str, start: &dyn Fn() -> Running| -> Duration {
        let arguments = [
            "ctl0",
            kind,
            name,
            "cycle_us=1000",
            "seconds=1",
            "hold=20",
            "hammer=1",
            "records=0",
        ];
        let mut controller = lab.spawn(Side::Controller, built("test-controller"), arguments);
        std::thread::sleep(Duration::from_millis(300));
        let begin = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
        let device = start();
        controller.wait_for("at_us", Duration::from_secs(20));
        let steps = controller.finish(Duration::from_secs(30)).ok().json_lines();
        drop(device);
        let at = steps.iter().find(|s| s["step"] == "running").unwrap()["first_frame_us"]
            .as_u64()
            .unwrap();
        Duration::from_micros(at) - begin
    };
    let median = |times: Vec<Duration>| {
        let mut times = times;
        times.sort();
        times[times.len() / 2]
    };
    let spawn_drive = || {
        let arguments = [
            "simulate",
            "--name",
            "akd-1",
            "--ip",
            "192.168.77.60/24",
            "--min-cycle",
            "1ms",
            "-i",
            "dev0",
        ];
        lab.spawn(Side::Device, built("profidrive"), arguments)
    };
    let ours = median((0..5).map(|_| once("akd", "akd-1", &spawn_drive)).collect());
    let theirs = median((0..5).map(|_| once("pnio", "pnio-dev", &|| pnio(&lab))).collect());
    let millis = |time: Duration| format!("{:.1} ms", time.as_secs_f64() * 1000.0);
    vec![
        Row::new("process start to first valid cyclic frame", millis(ours))
            .beside(format!("pnio {}", millis(theirs)))
            .limit("40 ms".into(), ours < LIMIT),
    ]
}
