//! Samples of motions, recorded and compared, in virtual time.
// helpers of tests fail by panicking, like the tests themselves
#![allow(clippy::unwrap_used, clippy::panic)]
#![cfg(all(feature = "simulate", feature = "recording"))]

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use profidrive::client::{Drive, ErrorKind};
use profidrive::motion::{self, Control, Event, Frequency, MotionError, Observer, Run, Step};
use profidrive::recording::{EarlierStep, Form, MotionRecorder, OverlayError};
use profidrive::{Explained, Network, Transport, Wait};

/// A folder of its own, which goes with the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("profidrive-motion-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn open(more: &str) -> (Network, Drive) {
    let plant = format!("[[drive]]\nname = \"drive-1\"\nip = \"10.0.0.1/24\"\n{more}\n");
    let mut network = profidrive::open_plan(plant.parse().expect("a plant")).expect("opens");
    let drive = network.find(&"drive-1".parse().expect("a name")).wait();
    (network, drive.expect("there"))
}

fn recorder(network: &Network, file: &Path) -> MotionRecorder {
    MotionRecorder::new(file, Form::of(file).expect("a form"), network.wall_clock())
}

fn short(speed: f64) -> Run {
    Run {
        time: Some(Duration::from_secs(1)),
        ..Run::at(speed)
    }
}

fn step(from: f64, to: f64) -> Step {
    Step {
        from,
        run: short(to),
        band: 0.02,
    }
}

#[test]
fn a_run_is_recorded_with_its_stop() {
    let folder = Folder::new("run");
    let (mut network, mut drive) = open("");
    let file = folder.file("run.csv");
    let recorder = recorder(&network, &file);
    let observer = Observer::default().tapped_by(recorder.clone());
    motion::run(&mut network, &mut drive, &short(300.0), &observer)
        .wait()
        .unwrap();
    let recorded = recorder.finish().unwrap().expect("an axis was taken");
    let text = std::fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "t,wall,drive,gap,STW1,NSOLL_A [rpm],ZSW1,NIST_A [rpm]");
    assert_eq!((recorded.rows, recorded.missed), (lines.len() as u64 - 1, 0));
    let speed = |line: &str| line.rsplit(',').next().unwrap().parse::<f64>().unwrap();
    let highest = lines[1..].iter().map(|line| speed(line)).fold(0.0, f64::max);
    assert!((highest - 300.0).abs() < 5.0, "{highest}");
    // the ramp down to rest is part of it
    assert!(
        speed(lines[lines.len() - 1]).abs() < 5.0,
        "{}",
        lines[lines.len() - 1]
    );
}

#[test]
fn the_samples_of_a_motion_that_failed_are_kept() {
    let folder = Folder::new("failed");
    let (mut network, mut drive) = open("event = [{ at = \"3s\", do = \"fault=439\" }]");
    let file = folder.file("failed.parquet");
    let recorder = recorder(&network, &file);
    let observer = Observer::default().tapped_by(recorder.clone());
    let wanted = Step {
        run: Run {
            time: Some(Duration::from_secs(30)),
            ..Run::at(120.0)
        },
        ..step(0.0, 120.0)
    };
    let failed = motion::step(&mut network, &mut drive, &wanted, &observer).wait();
    assert_eq!(failed.unwrap_err().kind(), ErrorKind::Fault);
    let recorded = recorder.finish().unwrap().expect("an axis was taken");
    assert!(recorded.rows > 20 && file.exists(), "{recorded:?}");
}

#[test]
fn a_file_that_exists_keeps_the_axis_from_moving() {
    let folder = Folder::new("exists");
    let (mut network, mut drive) = open("");
    let file = folder.file("run.csv");
    std::fs::write(&file, "mine").unwrap();
    let recorder = recorder(&network, &file);
    let observer = Observer::default().tapped_by(recorder.clone());
    let error = motion::run(&mut network, &mut drive, &short(60.0), &observer)
        .wait()
        .unwrap_err();
    assert!(matches!(error, MotionError::NotRecorded { .. }), "{error}");
    assert!(error.to_string().ends_with("run.csv` exists already"), "{error}");
    assert_eq!(recorder.finish().unwrap(), None);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
    let Transport::Plant(plant) = network.transport() else {
        panic!("in memory")
    };
    let enabled = plant.with_world(|world| world.drive(0).is_some_and(|one| one.drive().is_enabled()));
    assert!(!enabled);
}

#[test]
fn only_the_same_step_is_compared_with() {
    let folder = Folder::new("before");
    let (mut network, mut drive) = open("");
    let file = folder.file("before.csv");
    let recorder = recorder(&network, &file);
    let observer = Observer::default().tapped_by(recorder.clone());
    let stepped = motion::step(&mut network, &mut drive, &step(0.0, 300.0), &observer)
        .wait()
        .unwrap();
    recorder.finish().unwrap();
    let before = EarlierStep::read(&file).unwrap();
    before.check_same(&step(0.0, 300.0)).unwrap();
    let (now, then) = (stepped.response.unwrap(), before.response(0.02).unwrap());
    assert!(
        (now.rise_time.unwrap() - then.rise_time.unwrap()).abs() < 1e-3,
        "{now:?} {then:?}"
    );
    for other in [step(0.0, 600.0), step(60.0, 300.0), step(0.0, -300.0)] {
        let error = before.check_same(&other).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        assert!(error.to_string().contains("has a step from 0 to 300"), "{error}");
    }
    let percent = Step {
        from: 0.0,
        run: Run::at_percent(300.0),
        band: 0.02,
    };
    assert!(before.check_same(&percent).is_err(), "another unit");
    let error = EarlierStep::read(&folder.file("before.parquet")).unwrap_err();
    assert!(matches!(error, OverlayError::NotCsv { .. }), "{error}");
}

#[test]
fn a_file_with_too_many_lines_is_not_compared_with() {
    let line = "0.1,,a,false,300,300\n";
    let text = format!(
        "t,wall,drive,gap,NSOLL_A [rpm],NIST_A [rpm]\n{}",
        line.repeat(1_000_001)
    );
    let error = EarlierStep::parse("long.csv", text.as_bytes()).unwrap_err();
    assert!(matches!(error, OverlayError::TooLong { .. }), "{error}");
}

/// A VLT as delivered keeps turning when its controller is lost.
#[test]
fn a_step_warns_of_that_once_and_takes_frequencies_of_a_converter() {
    let (mut network, mut drive) = open("model = \"vlt\"");
    let seen = Arc::new(Mutex::new(Vec::new()));
    let events = Arc::clone(&seen);
    let observer = Observer::new(move |event| {
        if let Event::RunsOn(_) | Event::Converted { .. } = event {
            events.lock().unwrap().push(format!("{event:?}"));
        }
    });
    let wanted = Step {
        from: 0.0,
        run: Run {
            time: Some(Duration::from_secs(5)),
            control: Control {
                may_run_on: true,
                ..Control::default()
            },
            ..Run::at_frequency(10.0)
        },
        band: 0.02,
    };
    let stepped = motion::step(&mut network, &mut drive, &wanted, &observer)
        .wait()
        .unwrap();
    let reached = stepped.report.result.speed.unwrap().value;
    assert!(
        (reached - 300.0).abs() < 15.0,
        "10 Hz of a motor with two pole pairs: {reached}"
    );
    let seen = seen.lock().unwrap();
    let count = |what: &str| seen.iter().filter(|event| event.starts_with(what)).count();
    assert_eq!((count("RunsOn"), count("Converted")), (1, 1), "{seen:?}");
}

#[test]
fn a_frequency_for_a_drive_that_is_no_converter_is_a_mistake_of_the_caller() {
    let (mut network, mut drive) = open("");
    for (from, to) in [(0.0, 25.0), (5.0, 25.0)] {
        let wanted = Step {
            from,
            run: Run {
                frequency: Some(Frequency {
                    hertz: to,
                    limit: None,
                }),
                ..short(0.0)
            },
            band: 0.02,
        };
        let error = motion::step(&mut network, &mut drive, &wanted, &Observer::default())
            .wait()
            .unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        assert!(
            error.to_string().contains("it is not a frequency converter"),
            "{error}"
        );
    }
}

/// The times of a step are no more exact than the cycles that arrived.
#[test]
fn cycles_that_were_missed_widen_the_times_of_a_step() {
    for (more, is_lossy) in [
        ("", false),
        ("event = [{ at = \"0s\", do = \"loss=10%\" }]", true),
    ] {
        let (mut network, mut drive) = open(more);
        let stepped = motion::step(&mut network, &mut drive, &step(0.0, 120.0), &Observer::default())
            .wait()
            .unwrap();
        let cycles = stepped.resolution.as_secs_f64() / stepped.cycle.as_secs_f64();
        assert_eq!(stepped.missed > 0, is_lossy, "{}", stepped.missed);
        assert_eq!(cycles > 1.9, is_lossy, "{cycles}");
        assert!(cycles >= 1.0, "{cycles}");
    }
}
