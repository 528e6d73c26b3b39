//! The motions of the library against virtual drives in memory and in virtual time.

// helpers of tests fail by panicking, like the tests themselves
#![allow(clippy::unwrap_used)]

use std::net::Ipv4Addr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use client::{Action, Drive, ErrorKind, Network, World, WriteMode};
use network::host::{Host, StationId};
use network::segment::{Pace, Segment, SegmentMedium};
use profidrive::Wait;
use profidrive::motion::{
    self, Control, Event, Home, Jog, MotionError, Move, Observer, Report, Run, Setting,
};
use profile::state::Mode;
use profinet::controller::ControllerConfig;
use profinet::device::Stored;
use profinet::{IpSuite, MacAddress};
use virtual_drive::drive::Injection;
use virtual_drive::model::{self, Model};
use virtual_drive::station::{AnswerFault, Station, StationConfig};

const SECOND: Duration = Duration::from_secs(1);

const fn ip(last: u8) -> IpSuite {
    IpSuite {
        address: Ipv4Addr::new(10, 0, 0, last),
        mask: Ipv4Addr::new(255, 255, 255, 0),
        gateway: Ipv4Addr::UNSPECIFIED,
    }
}

/// One drive and a client.
struct Plant {
    network: Network,
    world: Arc<World<SegmentMedium>>,
    station: StationId,
    drive: Drive,
}

impl Plant {
    fn new(model: &'static Model) -> Self {
        let mut config = StationConfig::new(model, MacAddress([2, 0, 0, 0, 0, 1]));
        config.network = Stored {
            name: "drive-1".into(),
            ip: ip(1),
            ..Stored::default()
        };
        let mut segment = Segment::new(7);
        let station = segment.attach(Box::new(Host::new(Station::new(config))));
        let own = ControllerConfig::new(MacAddress([2, 0, 0, 0, 0, 99]), ip(99), "test", 1);
        let (mut network, world) = Network::on(SegmentMedium::new(segment, Pace::Virtual), own);
        let drive = network.find(&"drive-1".parse().unwrap()).wait().unwrap();
        Self {
            network,
            world,
            station,
            drive,
        }
    }

    fn with_station<T>(&self, look: impl FnOnce(&mut Station) -> T) -> T {
        let mut wire = self.world.wire();
        let host: &mut Host<Station> = wire.segment_mut().station_mut(self.station).unwrap();
        look(host.endpoint_mut())
    }

    fn with_drive<T>(&self, look: impl FnOnce(&mut virtual_drive::drive::Drive) -> T) -> T {
        self.with_station(|station| look(station.drive_mut()))
    }

    fn is_at_rest(&self) -> bool {
        self.with_drive(|drive| !drive.is_enabled() && drive.axis().speed().abs() < 0.1)
    }

    /// Mode, telegram and jog speeds, read at the drive itself: without a client.
    fn settings(&self) -> [Vec<u8>; 4] {
        [930_u16, 922, 1004, 1005].map(|pnu| {
            let [high, low] = pnu.to_be_bytes();
            let request = [1, 1, 0, 1, 0x10, 1, high, low, 0, 0];
            let mut answer = [0; 64];
            let length = self
                .with_drive(|drive| drive.serve(&request, &mut answer))
                .unwrap();
            assert_eq!(answer[1], 1, "PNU {pnu} cannot be read");
            answer[4..length].to_vec()
        })
    }

    fn value(&mut self, name: &str) -> f64 {
        let selection = self.drive.select(name).unwrap();
        let reading = self.network.read_one(&mut self.drive, &selection).wait().unwrap();
        reading.number().unwrap()
    }

    fn write(&mut self, text: &str) {
        let assignments = [text.parse().unwrap()];
        let written = self
            .network
            .write(&mut self.drive, &assignments, WriteMode::Write);
        assert!(written.wait().unwrap().is_done());
    }

    fn run(&mut self, wanted: &Run, observer: &Observer) -> Result<Report, MotionError> {
        motion::run(&mut self.network, &mut self.drive, wanted, observer).wait()
    }
}

/// Keeps every event but the samples.
fn kept() -> (Observer, Arc<Mutex<Vec<Event>>>) {
    let events = Arc::new(Mutex::new(Vec::new()));
    let kept = Arc::clone(&events);
    let observer = Observer::new(move |event| {
        if !matches!(event, Event::Sample(_)) {
            kept.lock().unwrap().push(event.clone());
        }
    });
    (observer, events)
}

fn for_a_second(rpm: f64) -> Run {
    Run {
        time: Some(SECOND),
        ..Run::at(rpm)
    }
}

#[test]
fn report_of_a_run_has_speed_time_and_distance() {
    let mut plant = Plant::new(&model::AKD);
    let (observer, events) = kept();
    let report = plant.run(&for_a_second(300.0), &observer).unwrap();
    let result = &report.result;
    assert!(result.reached && !report.interrupted && report.released);
    assert!(
        (result.speed.as_ref().unwrap().value - 300.0).abs() < 1.0,
        "{result:?}"
    );
    assert!((result.time_at_speed.unwrap() - 1.0).abs() < 0.05, "{result:?}");
    // five turns in the second, and the ramps
    let distance = result.distance.as_ref().unwrap().value;
    assert!((5.0..6.5).contains(&distance), "{distance}");
    assert!(report.frames.received.is_some_and(|frames| frames > 50));
    assert!(plant.is_at_rest());
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(json["speed"]["unit"], "rpm");
    assert_eq!(json["frames"]["missed"], 0);
    let events = events.lock().unwrap();
    // the setpoint of the AKD has steps of some tenths of a rpm
    assert!(
        matches!(events[..], [Event::Rounded { .. }, Event::Starting { .. }, ..]),
        "{events:?}"
    );
    assert!(matches!(events.last(), Some(Event::Ended(ended)) if ended.report == report));
}

#[test]
fn a_dry_run_sends_nothing() {
    let mut plant = Plant::new(&model::AKD);
    let wanted = for_a_second(300.0);
    let observer = Observer::default();
    let plan = motion::plan_run(&mut plant.network, &mut plant.drive, &wanted, &observer);
    let plan = plan.wait().unwrap();
    assert_eq!(plan.telegrams.telegram, plan.telegrams.telegram_before);
    assert!((plan.speed_rounded.unwrap().value - 300.0).abs() < 0.2);
    assert_eq!(plant.with_drive(|drive| drive.control_word().0), 0);
}

#[test]
fn a_speed_above_a_limit_is_refused_before_anything_is_sent() {
    let mut plant = Plant::new(&model::AKD);
    let error = plant
        .run(&for_a_second(3001.0), &Observer::default())
        .unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Safety);
    let wanted = Run {
        limit: 1e6,
        ..for_a_second(20_000.0)
    };
    let error = plant.run(&wanted, &Observer::default()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Safety, "{error}");
    assert_eq!(plant.with_drive(|drive| drive.control_word().0), 0);
}

#[test]
fn mode_and_telegram_are_put_back() {
    let mut plant = Plant::new(&model::AKD);
    let telegram = plant.value("922");
    let wanted = Home {
        timeout: 60 * SECOND,
        control: Control {
            set_mode: true,
            ..Control::default()
        },
    };
    let (observer, events) = kept();
    let home = motion::home(&mut plant.network, &mut plant.drive, &wanted, &observer).wait();
    assert!(home.unwrap().result.reached);
    assert_eq!((plant.value("930"), plant.value("922")), (1.0, telegram));
    let events = events.lock().unwrap();
    let changed = |event: &Event| {
        matches!(
            event,
            Event::ModeChanged {
                now: Mode::Position,
                ..
            }
        )
    };
    assert!(changed(&events[0]), "{events:?}");
    let back = |event: &&Event| matches!(event, Event::PutBack(Setting::Number { .. }));
    assert_eq!(events.iter().filter(back).count(), 2, "{events:?}");
}

#[test]
fn a_motion_in_another_mode_is_refused() {
    let mut plant = Plant::new(&model::AKD);
    let order = client::axis::Move::to(profile::notation::Position::Turns(1.0), 60.0);
    let wanted = Move::by(order);
    let observer = Observer::default();
    let moved = motion::move_to(&mut plant.network, &mut plant.drive, &wanted, &observer).wait();
    let error = moved.unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Safety);
    assert_eq!(plant.value("930"), 1.0);
    assert_eq!(plant.with_drive(|drive| drive.control_word().0), 0);
}

#[test]
fn a_drive_that_runs_on_needs_consent_in_every_motion() {
    let mut plant = Plant::new(&model::VLT);
    let wanted = for_a_second(300.0);
    let error = plant.run(&wanted, &Observer::default()).unwrap_err();
    assert_eq!(
        (error.kind(), error.consent()),
        (ErrorKind::Safety, Some(client::Choice::RunOn))
    );
    let observer = Observer::default();
    let jog = Jog::lasting(SECOND);
    let jogged = motion::jog(&mut plant.network, &mut plant.drive, &jog, &observer).wait();
    assert_eq!(jogged.unwrap_err().kind(), ErrorKind::Safety);
    assert!(plant.is_at_rest());
    let (observer, events) = kept();
    let consented = Run {
        control: Control {
            may_run_on: true,
            ..Control::default()
        },
        ..wanted
    };
    plant.run(&consented, &observer).unwrap();
    assert!(matches!(events.lock().unwrap()[0], Event::RunsOn(_)));
    plant.write("8-04=5");
    plant.run(&wanted, &Observer::default()).unwrap();
}

#[test]
fn a_jog_speed_is_put_back_after_a_failure_too() {
    let mut plant = Plant::new(&model::AKD);
    let before = plant.value("1004");
    let wanted = Jog {
        speed: Some(90.0),
        ..Jog::lasting(SECOND)
    };
    let (observer, events) = kept();
    let report = motion::jog(&mut plant.network, &mut plant.drive, &wanted, &observer).wait();
    assert!(report.unwrap().result.reached);
    assert_eq!(plant.value("1004"), before);
    let back = |event: &Event| matches!(event, Event::PutBack(Setting::Reading { .. }));
    assert!(events.lock().unwrap().iter().any(back));
    let failing = Observer::new({
        let station = plant.station;
        let world = Arc::clone(&plant.world);
        move |event| {
            if matches!(event, Event::Starting { .. }) {
                let mut wire = world.wire();
                let host: &mut Host<Station> = wire.segment_mut().station_mut(station).unwrap();
                host.endpoint_mut().drive_mut().inject(Injection::Fault {
                    number: 439,
                    lasting: false,
                });
            }
        }
    });
    let error = motion::jog(&mut plant.network, &mut plant.drive, &wanted, &failing).wait();
    let error = error.unwrap_err();
    assert!(error.to_string().contains("439"), "{error}");
    assert_eq!(plant.value("1004"), before);
    assert!(plant.is_at_rest());
    let control = Control::default();
    let done = motion::acknowledge(&mut plant.network, &mut plant.drive, &control, &observer).wait();
    assert!(done.unwrap().released);
    let again = motion::acknowledge(&mut plant.network, &mut plant.drive, &control, &observer).wait();
    let again = again.unwrap();
    assert!(!again.released && again.result.reached);
}

/// Makes the drive refuse all parameters from the start of a motion on.
fn refusing(plant: &Plant) -> Observer {
    let (station, world) = (plant.station, Arc::clone(&plant.world));
    Observer::new(move |event| {
        if matches!(event, Event::Starting { .. }) {
            let mut wire = world.wire();
            let host: &mut Host<Station> = wire.segment_mut().station_mut(station).unwrap();
            host.endpoint_mut().set_answer_fault(AnswerFault::Error(17));
        }
    })
}

#[test]
fn a_motion_after_which_a_setting_is_not_put_back_did_not_go_well() {
    let mut plant = Plant::new(&model::AKD);
    let before = plant.value("1004");
    let wanted = Jog {
        speed: Some(90.0),
        ..Jog::lasting(SECOND)
    };
    let observer = refusing(&plant);
    let error = motion::jog(&mut plant.network, &mut plant.drive, &wanted, &observer).wait();
    let error = error.unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Partial, "{error}");
    assert!(error.to_string().contains("was not put back to"), "{error}");
    let report = error.report().unwrap();
    assert!(report.released && report.result.reached, "{report:?}");
    let [left] = report.put_back.as_slice() else {
        panic!("{report:?}");
    };
    assert!(
        left.failed.as_ref().is_some_and(|cause| cause.contains("0x11")),
        "{left:?}"
    );
    assert!(plant.is_at_rest());
    // the advice does what the program could not
    let Some(advice) = error.advice() else {
        panic!("no advice: {error}");
    };
    let Some(Action::Write { parameter, value }) = advice.actions().next() else {
        panic!("{advice}");
    };
    plant.with_station(|station| station.set_answer_fault(AnswerFault::None));
    assert!((plant.value("1004") - before).abs() > 1.0);
    plant.write(&format!("{parameter}={value}"));
    assert!((plant.value("1004") - before).abs() < 0.1);
}

#[test]
fn mode_and_telegram_that_are_not_put_back_are_in_the_report() {
    let mut plant = Plant::new(&model::AKD);
    plant.write("930=2");
    let wanted = Run {
        control: SET_MODE,
        ..for_a_second(300.0)
    };
    let observer = refusing(&plant);
    let error = plant.run(&wanted, &observer).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Partial, "{error}");
    let report = error.report().unwrap();
    assert!(
        report.released && report.put_back.iter().any(|one| one.failed.is_some()),
        "{report:?}"
    );
    assert!(plant.is_at_rest());
}

#[test]
fn a_caller_that_stops_a_motion_finds_it_at_rest_and_put_back() {
    let mut plant = Plant::new(&model::AKD);
    plant.write("930=2");
    let before = plant.settings();
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    plant.network.interrupt_with(move || flag.load(Ordering::SeqCst));
    let observer = Observer::new(move |event| {
        if matches!(event, Event::Sample(status) if status.speed_actual.is_some_and(|speed| speed > 100.0)) {
            stop.store(true, Ordering::SeqCst);
        }
    });
    let wanted = Run {
        control: Control {
            set_mode: true,
            ..Control::default()
        },
        ..for_a_second(300.0)
    };
    let error = plant.run(&wanted, &observer).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Interrupted, "{error}");
    assert!(plant.is_at_rest());
    assert_eq!(plant.settings(), before);
}

/// Polls a motion for so long, and drops it then if it has not ended.
fn dropped_after(session: &client::Session, motion: impl Future<Output: Send>, time: Duration) {
    let mut motion = std::pin::pin!(motion);
    let until = session.now() + time;
    let both = std::future::poll_fn(|context| {
        if motion.as_mut().poll(context).is_ready() || session.now() >= until {
            return std::task::Poll::Ready(());
        }
        context.waker().wake_by_ref();
        std::task::Poll::Pending
    });
    both.wait();
}

const SET_MODE: Control = Control {
    cycle: None,
    watchdog: None,
    may_run_on: false,
    set_mode: true,
    bound: None,
};

/// A motion that changes settings of the drive, by its number.
async fn changing(session: &mut client::Session, drive: &mut Drive, motion: usize, observer: &Observer) {
    let _ = match motion {
        0 => {
            let wanted = Home {
                timeout: 60 * SECOND,
                control: SET_MODE,
            };
            motion::home(session, drive, &wanted, observer).await
        }
        1 => {
            let order = client::axis::Move::by(profile::notation::Position::Turns(5.0), 300.0);
            let wanted = Move {
                control: SET_MODE,
                ..Move::by(order)
            };
            motion::move_to(session, drive, &wanted, observer).await
        }
        2 => {
            let wanted = Jog {
                speed: Some(90.0),
                ..Jog::lasting(SECOND)
            };
            motion::jog(session, drive, &wanted, observer).await
        }
        _ => {
            let wanted = Run {
                control: SET_MODE,
                ..for_a_second(300.0)
            };
            motion::run(session, drive, &wanted, observer).await
        }
    };
}

/// A homed drive for motion `motion` of [`changing`], in the mode in which that has to change something.
fn prepared(motion: usize) -> Plant {
    let mut plant = Plant::new(&model::AKD);
    let (mut session, mut drive) = (plant.network.clone(), plant.drive.clone());
    changing(&mut session, &mut drive, 0, &Observer::default()).wait();
    if motion == 3 {
        plant.write("930=2");
    }
    plant
}

/// A future that is dropped leaves stop, release and what is to be put back to the network.
#[test]
fn a_motion_that_is_dropped_at_any_moment_leaves_nothing_behind() {
    let mut moments = 0x2545_F491_4F6C_DD1D_u64;
    let mut found_changed = [false; 4];
    for round in 0..48 {
        moments = moments.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let time = Duration::from_micros((moments >> 33) % 1_500_000);
        let motion = round % 4;
        let mut plant = prepared(motion);
        let before = plant.settings();
        let (mut session, mut drive) = (plant.network.clone(), plant.drive.clone());
        let observer = Observer::default();
        let changing = changing(&mut session, &mut drive, motion, &observer);
        dropped_after(&plant.network, changing, time);
        found_changed[motion] |= plant.settings() != before;
        let leaves = round % 8 < 4;
        if leaves {
            // the program ends
            let other = Plant::new(&model::AKD);
            drop(std::mem::replace(&mut plant.network, other.network));
        } else {
            plant.network.settled().wait().unwrap();
        }
        let what = format!("motion {motion} dropped after {time:?}, network left: {leaves}");
        assert!(plant.is_at_rest(), "{what}");
        assert_eq!(plant.settings(), before, "{what}");
    }
    assert_eq!(found_changed, [true; 4]);
}

#[test]
fn a_motion_whose_caller_panics_leaves_nothing_behind() {
    for motion in [1, 2] {
        let mut plant = prepared(motion);
        let before = plant.settings();
        let (mut session, mut drive) = (plant.network.clone(), plant.drive.clone());
        let observer = Observer::new(|event| {
            if let Event::Sample(status) = event {
                let speed = status.view.seen.map(|seen| seen.zsw1);
                assert!(speed.is_none() || status.time < SECOND / 2, "the caller fails");
            }
        });
        let caller = std::panic::AssertUnwindSafe(|| {
            changing(&mut session, &mut drive, motion, &observer).wait();
        });
        assert!(std::panic::catch_unwind(caller).is_err());
        plant.network.settled().wait().unwrap();
        assert!(plant.is_at_rest());
        assert_eq!(plant.settings(), before, "motion {motion}");
    }
}

/// The next motion begins with the settings of the drive, not with those of the one before it.
#[test]
fn a_motion_waits_until_the_one_before_it_is_put_back() {
    let mut plant = prepared(1);
    let (mut session, mut drive) = (plant.network.clone(), plant.drive.clone());
    let observer = Observer::default();
    let moving = changing(&mut session, &mut drive, 1, &observer);
    dropped_after(&plant.network, moving, SECOND);
    assert!(!plant.is_at_rest());
    plant.run(&for_a_second(60.0), &Observer::default()).unwrap();
    assert_eq!(plant.value("930"), 1.0);
}

#[test]
fn motions_may_change_threads() {
    fn movable<T: Send>(_: &T) {}
    let plant = Plant::new(&model::AKD);
    let (mut session, mut drive) = (plant.network.clone(), plant.drive.clone());
    let observer = Observer::default();
    movable(&motion::run(&mut session, &mut drive, &Run::at(1.0), &observer));
    movable(&motion::jog(
        &mut session,
        &mut drive,
        &Jog::lasting(SECOND),
        &observer,
    ));
    let home = Home {
        timeout: SECOND,
        control: Control::default(),
    };
    movable(&motion::home(&mut session, &mut drive, &home, &observer));
}

fn at_frequency(hertz: f64, limit: Option<f64>) -> Run {
    Run {
        frequency: Some(motion::Frequency { hertz, limit }),
        time: Some(SECOND),
        control: Control {
            may_run_on: true,
            ..Control::default()
        },
        ..Run::at_frequency(hertz)
    }
}

#[test]
fn a_converter_runs_at_a_frequency_by_the_pole_pairs_of_its_motor() {
    for model in [&model::VLT, &model::VACON] {
        let mut plant = Plant::new(model);
        let (observer, events) = kept();
        let report = plant.run(&at_frequency(10.0, None), &observer).unwrap();
        // 4 poles
        let speed = report.result.speed.unwrap();
        assert_eq!(speed.unit, "rpm");
        assert!((speed.value - 300.0).abs() < 15.0, "{speed:?}");
        let reported = events.lock().unwrap().iter().any(|event| {
            matches!(event, Event::Converted { hertz, rpm, pole_pairs } if [*hertz, *rpm, *pole_pairs] == [10.0, 300.0, 2.0])
        });
        assert!(reported);
        assert!(plant.is_at_rest());
    }
}

#[test]
fn a_frequency_above_its_limit_or_for_a_servo_drive_moves_nothing() {
    let mut plant = Plant::new(&model::VLT);
    let (observer, _) = kept();
    let error = plant.run(&at_frequency(10.0, Some(5.0)), &observer).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Safety, "{error}");
    assert!(plant.is_at_rest());

    let mut plant = Plant::new(&model::AKD);
    let error = plant.run(&at_frequency(10.0, None), &observer).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Usage, "{error}");
    assert_eq!(
        error.to_string(),
        "drive-1: a speed in Hz cannot be converted: it is not a frequency converter"
    );
    assert!(plant.is_at_rest());
}
