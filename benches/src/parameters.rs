//! Reading every parameter of an AKD with the client: in memory, and over a veth pair from a drive in another process;
//! saving all its settings with the program.

use std::time::{Duration, Instant};

use client::{Session, Wait};
use profidrive::{Access, Opening};
use system_tests::{Lab, Side, built, memory};

use crate::drives::simulate;
use crate::table::Row;

const ROUNDS: usize = 5;
const IN_MEMORY: Duration = Duration::from_millis(10);
const OVER_VETH: Duration = Duration::from_millis(50);
const BACKUP: Duration = Duration::from_secs(1);

/// Both ways.
pub fn compare() -> Vec<Row> {
    let (count, in_memory) = measure(&mut memory::network().0);
    let lab = Lab::new("bench-parameters");
    let own = std::env::current_exe().unwrap();
    let _drive = simulate(&lab, &["--ip", "192.168.77.60/24"]);
    let finished = lab
        .run(
            Side::Controller,
            own,
            ["read-all", "ctl0"],
            Duration::from_secs(60),
        )
        .ok();
    let over_veth = Duration::from_nanos(finished.out.trim().parse().unwrap());
    let row = |way: &str, time: Duration, limit: Duration| {
        Row::new(
            &format!("reading all {count} AKD parameters {way} (median)"),
            format!("{:.1} ms", time.as_secs_f64() * 1000.0),
        )
        .limit(format!("{} ms", limit.as_millis()), time <= limit)
    };
    vec![
        row("in memory", in_memory, IN_MEMORY),
        row("over veth", over_veth, OVER_VETH),
        backup(&lab),
    ]
}

/// `profidrive backup akd-1 -o FILE` from start to end: finding the drive, reading, writing the file.
fn backup(lab: &Lab) -> Row {
    let file = lab.folder().join("akd-1.backup");
    let file = file.to_str().unwrap();
    let mut times: Vec<Duration> = (0..ROUNDS)
        .map(|_| {
            let _ = std::fs::remove_file(file);
            let start = Instant::now();
            let arguments = ["-i", "ctl0", "backup", "akd-1", "-o", file];
            lab.run(
                Side::Controller,
                built("profidrive"),
                arguments,
                Duration::from_secs(60),
            )
            .ok();
            start.elapsed()
        })
        .collect();
    times.sort();
    let settings = std::fs::read_to_string(file).unwrap();
    let settings = settings.lines().filter(|line| line.starts_with('p')).count() - 1;
    let time = times[ROUNDS / 2];
    Row::new(
        &format!("`profidrive backup` of a whole AKD over veth, {settings} settings (median)"),
        format!("{:.0} ms", time.as_secs_f64() * 1000.0),
    )
    .limit(format!("{} ms", BACKUP.as_millis()), time <= BACKUP)
}

/// The client over an interface: prints the median time in nanoseconds.
pub fn read_all(interface: &str) {
    let opening = Opening::new(Access::Records).on(interface);
    let (_, time) = measure(&mut opening.open().unwrap());
    println!("{}", time.as_nanos());
}

/// Returns the number of parameters and median wall time to read them all, on a connection that is there already.
fn measure(session: &mut Session) -> (usize, Duration) {
    let mut drive = memory::find(session);
    let all = memory::everything(&drive);
    session.read(&mut drive, &all[..1]).wait().unwrap();
    let mut times: Vec<Duration> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            let readings = session.read(&mut drive, &all).wait().unwrap();
            let time = start.elapsed();
            let refused = readings.iter().filter(|reading| reading.is_err()).count();
            assert_eq!(refused, 0, "parameters refused");
            time
        })
        .collect();
    times.sort();
    session.close().wait().unwrap();
    (all.len(), times[ROUNDS / 2])
}
