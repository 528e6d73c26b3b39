//! Many axes at once in one process, on a network that loses frames, in virtual time: each ends in its own way and the others
//! notice nothing. And what is asked of one drive by many callers.

// helpers of tests fail by panicking, like the tests themselves
#![allow(clippy::panic)]

use std::panic::AssertUnwindSafe;
use std::time::Duration;

use futures::FutureExt;
use futures::future::{join, join_all};
use network::host::{Host, StationId};
use network::segment::Conditions;
use profidrive_client::axis::{Purpose, Trouble};
use profidrive_client::{
    Axis, AxisSettings, Client, DriveAddress, Enabled, Error, Session, StopHandle, StopWay, Wait, World,
    modules_of,
};
use profinet::controller::{ConnectConfig, Resolve, Target};
use profinet::cyclic::Timing;
use profinet::device::Stored;
use profinet::{Endpoint, Instant, IpSuite, MacAddress, Medium};
use testbench::shared::Shared;
use testbench::{Bench, bench_of, find, ip, is_at_rest, parts_of, running_on, select};
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

const SECOND: Duration = Duration::from_secs(1);
const AXES: u8 = 16;
const SPEED: f64 = 300.0;

/// How an axis ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Its owner lets it go.
    Dropped,
    /// The one who has it panics.
    Panic,
    /// Its owner forgets it: its lease is over some time.
    Forgotten,
    /// Its stop handle, while a thousand requests wait for its drive.
    Stopped,
    /// After the others.
    Released,
}

const fn way(number: u8) -> Way {
    match number {
        1 => Way::Dropped,
        2 => Way::Panic,
        3 => Way::Forgotten,
        4 => Way::Stopped,
        _ => Way::Released,
    }
}

fn name(number: u8) -> String {
    format!("axis-{number}")
}

/// Sixteen drives of three vendors.
fn plant() -> (Bench, Vec<StationId>) {
    let station = |number: u8| {
        let models = [&model::AKD, &model::VLT, &model::VACON];
        let model = models[usize::from(number) % models.len()];
        let mut config = StationConfig::new(model, MacAddress([2, 0, 0, 0, 0, number]));
        config.network = Stored {
            name: name(number),
            ip: ip(number),
            ..Stored::default()
        };
        Box::new(Host::new(Station::new(config)))
    };
    bench_of((1..=AXES).map(station).collect())
}

async fn taken(session: &mut Session, number: u8) -> Axis {
    let address: DriveAddress = name(number).parse().expect("an address");
    let mut drive = session.find(&address).await.expect("there");
    let settings = running_on(Purpose::Speed);
    let axis = session.take_axis(&mut drive, settings).await;
    axis.unwrap_or_else(|error| panic!("{}: {error}", name(number)))
}

async fn runs(axis: &mut Axis) -> Enabled<'_> {
    let label = axis.drive().label();
    let mut enabled = axis
        .enable()
        .await
        .unwrap_or_else(|error| panic!("{label}: {error}"));
    let reached = enabled.reach_speed(SPEED, None).await;
    reached.unwrap_or_else(|error| panic!("{label}: {error}"));
    enabled
}

/// What the test knows of what goes on.
#[derive(Clone, Default)]
struct Seen {
    stop: Shared<Option<StopHandle>>,
    stopped: Shared<Option<Instant>>,
}

/// One caller with one axis.
async fn caller(mut session: Session, number: u8, seen: Seen) {
    let way = way(number);
    let mut axis = taken(&mut session, number).await;
    let mut enabled = runs(&mut axis).await;
    match way {
        Way::Dropped => {
            enabled.hold(SECOND * 2).await.expect("undisturbed");
            drop(enabled);
            drop(axis);
        }
        Way::Panic => {
            enabled.hold(SECOND * 2).await.expect("undisturbed");
            panic!("the caller fails");
        }
        Way::Forgotten => {
            enabled.hold(SECOND * 2).await.expect("undisturbed");
            // neither drop is run
            std::mem::forget(enabled);
            std::mem::forget(axis);
        }
        Way::Stopped => {
            *seen.stop.borrow_mut() = Some(enabled.stop_handle());
            let error = enabled.hold(SECOND * 60).await.expect_err("stopped");
            *seen.stopped.borrow_mut() = Some(session.now());
            assert!(
                matches!(
                    error,
                    Error::Axis {
                        trouble: Trouble::Stopped,
                        ..
                    }
                ),
                "{error}"
            );
            drop(enabled);
            axis.release().await.expect("along its ramp");
        }
        Way::Released => {
            enabled
                .keep_speed(SPEED, SECOND * 20)
                .await
                .unwrap_or_else(|error| panic!("{}: {error}", name(number)));
            drop(enabled);
            axis.release().await.expect("along its ramp");
        }
    }
}

/// Loses this share of all frames.
fn lose(network: &Bench, loss: f64) {
    let lossy = Conditions {
        loss,
        ..Conditions::default()
    };
    network.medium().segment_mut().set_all_conditions(lossy);
}

#[test]
fn sixteen_axes_of_three_vendors_end_each_in_its_own_way() {
    let (mut network, ids) = plant();
    lose(&network, 0.01);
    let seen = Seen::default();
    let callers = (1..=AXES).map(|number| {
        let caller = caller(Session::clone(&network), number, seen.clone());
        // a panic ends this caller and no other
        AssertUnwindSafe(caller).catch_unwind()
    });
    // a thousand callers want something of the drive of axis 4, then its axis is stopped
    let mut stopper = Session::clone(&network);
    let begun = Shared::new(None);
    let (clock, handle) = (begun.clone(), seen.stop.clone());
    let waiting = async move {
        while handle.borrow().is_none() {
            stopper.pass(SECOND / 10).await.expect("time passes");
        }
        let address: DriveAddress = name(4).parse().expect("an address");
        let drive = stopper.find(&address).await.expect("there");
        let acceleration = select(&drive, "3-41");
        let jobs = (0..1000).map(|_| {
            let (mut session, mut drive) = (stopper.clone(), drive.clone());
            async move { session.read_one(&mut drive, &acceleration).await }
        });
        let mut later = stopper.clone();
        let stop = async {
            later.pass(SECOND / 10).await.expect("time passes");
            *clock.borrow_mut() = Some(later.now());
            handle.borrow().as_ref().expect("a handle").stop();
        };
        let (answers, ()) = join(join_all(jobs), stop).await;
        (answers, stopper.now())
    };
    let (ends, (answers, answered)) = join(join_all(callers), waiting).wait();
    for (number, end) in (1..).zip(ends) {
        assert_eq!(end.is_err(), way(number) == Way::Panic, "axis {number}");
    }
    let (begun, stopped) = (begun.get().expect("begun"), seen.stopped.get().expect("answered"));
    assert!(
        stopped - begun < Duration::from_millis(50),
        "{:?}",
        stopped - begun
    );
    assert!(answered > stopped + SECOND, "the requests were still waiting");
    let refused = answers.iter().find_map(|answer| answer.as_ref().err());
    assert!(refused.is_none(), "{refused:?}");
    network.settled().wait().expect("undisturbed");
    for (number, id) in (1..).zip(&ids) {
        if way(number) != Way::Forgotten {
            assert!(is_at_rest(&network, *id), "axis {number}");
        }
    }
    // the axis that was forgotten stands, and its connection ends with the network
    let world = network.world();
    assert!(!enabled(&world, ids[2]), "its lease is over");
    drop(network);
    assert!(!exchanging(&world, ids[2]));
}

fn station<T>(
    world: &World<network::segment::SegmentMedium>,
    id: StationId,
    look: impl FnOnce(&Station) -> T,
) -> T {
    let wire = world.wire();
    let host = wire.segment().station::<Host<Station>>(id).expect("the drive");
    look(host.endpoint())
}

fn enabled(world: &World<network::segment::SegmentMedium>, id: StationId) -> bool {
    station(world, id, |station| station.drive().is_enabled())
}

fn exchanging(world: &World<network::segment::SegmentMedium>, id: StationId) -> bool {
    station(world, id, |station| station.device().is_exchanging())
}

/// The same drives, callers and seed: the same run, to the nanosecond.
#[test]
fn a_run_of_many_callers_is_the_same_every_time() {
    let run = || {
        let (network, _) = plant();
        lose(&network, 0.05);
        let callers = (1..=AXES).map(|number| {
            let mut session = Session::clone(&network);
            async move {
                let mut axis = taken(&mut session, number).await;
                let enabled = runs(&mut axis).await;
                drop(enabled);
                axis.release().await.expect("along its ramp");
                session.now()
            }
        });
        join_all(callers).wait()
    };
    assert_eq!(run(), run());
}

/// One axis is refused: its caller fails, and so does the test that it is in.
#[test]
fn a_caller_that_panics_ends_the_run_of_all() {
    let (network, ids) = plant();
    let world = network.world();
    lose(&network, 0.05);
    let callers = (1..=AXES).map(|number| {
        let mut session = Session::clone(&network);
        async move {
            if number == 7 {
                let address: DriveAddress = name(number).parse().expect("an address");
                let mut drive = session.find(&address).await.expect("there");
                let axis = session.take_axis(&mut drive, AxisSettings::default()).await;
                panic!("{:?}", axis.map(|axis| axis.telegram()));
            }
            let mut axis = taken(&mut session, number).await;
            drop(runs(&mut axis).await);
            axis.release().await.expect("along its ramp");
        }
    });
    let callers: Vec<_> = callers.collect();
    let run = AssertUnwindSafe(|| {
        join_all(callers).wait();
        drop(network);
    });
    assert!(std::panic::catch_unwind(run).is_err());
    assert!(ids.iter().all(|id| !exchanging(&world, *id)));
}

/// Every input is there, in order, with what was lost between counted.
#[test]
fn every_cyclic_input_can_be_recorded() {
    let (mut network, _) = plant();
    lose(&network, 0.02);
    let mut session = Session::clone(&network);
    let mut axis = taken(&mut session, 3).wait();
    let mut samples = axis.samples(10_000);
    let mut few = axis.samples(10);
    let mut enabled = runs(&mut axis).wait();
    enabled.hold(SECOND * 5).wait().expect("undisturbed");
    let statistics = enabled.statistics().expect("a network");
    drop(enabled);
    axis.release().wait().expect("along its ramp");
    let mut all = Vec::new();
    while let Some(sample) = samples.next().wait().expect("carried") {
        all.push(sample);
    }
    assert!(
        all.len() > 300 && statistics.missed > 0,
        "{} {statistics:?}",
        all.len()
    );
    for pair in all.windows(2) {
        assert!(
            pair[1].at > pair[0].at && pair[1].number == pair[0].number + 1,
            "{pair:?}"
        );
        assert!(pair[1].missed >= pair[0].missed, "{pair:?}");
    }
    assert_eq!(samples.dropped(), 0);
    assert_eq!(few.dropped(), all.len() as u64 - 10);
    assert_eq!(
        few.take().map(|sample| sample.number),
        Some(all[all.len() - 10].number)
    );
    network.settled().wait().expect("at rest");
}

/// With many connections a carrier may gather frames: each wake-up costs more than a frame.
#[test]
fn frames_may_wait_for_others_only_while_there_are_many_connections() {
    let stations = (1..=AXES).map(|number| {
        let mut config = StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, number]));
        // 4 ms
        config.min_device_interval = Some(128);
        config.network = Stored {
            name: name(number),
            ip: ip(number),
            ..Stored::default()
        };
        Box::new(Host::new(Station::new(config)))
    });
    let (mut medium, config, _) = parts_of(stations.collect());
    let mut client = Client::new(config);
    let device = &model::AKD.catalogue.device;
    let telegram = device.telegram(1).expect("telegram 1");
    let mut connect = |client: &mut Client, number: u8, cycle: u64| {
        let timing = Timing::for_interval(Duration::from_millis(cycle)).expect("a cycle");
        let mut config = ConnectConfig::new(modules_of(device, telegram), timing);
        config.resolve = Resolve::Check;
        let target = Target {
            name: name(number),
            mac: None,
            ip: IpSuite::NONE,
            vendor_id: device.vendor_id,
            device_id: device.device_id,
            instance: 1,
        };
        let now = medium.now();
        let ar = client
            .controller()
            .connect(now, target, config)
            .expect("a request");
        while medium.now() < now + SECOND {
            medium.step(client, now + SECOND).expect("in memory");
        }
        ar
    };
    for number in 1..AXES {
        connect(&mut client, number, 32);
        assert_eq!(client.may_wait(), Duration::ZERO, "{number}");
    }
    let last = connect(&mut client, AXES, 4);
    assert_eq!(
        client.may_wait(),
        Duration::from_micros(250),
        "a part of the shortest"
    );
    client
        .controller()
        .release(medium.now(), last)
        .expect("connected");
    let end = medium.now() + SECOND;
    while medium.now() < end {
        medium.step(&mut client, end).expect("in memory");
    }
    assert_eq!(client.may_wait(), Duration::ZERO);
}

/// What is asked of one drive at once comes one after the other, in order, and nothing is lost.
#[test]
fn many_callers_of_one_drive_are_answered_in_their_order() {
    let (mut network, _) = plant();
    let drive = find(&mut network, "axis-3").expect("there");
    let acceleration = select(&drive, "DRV.ACC");
    let order = Shared::new(Vec::new());
    let callers = (0..100).map(|number| {
        let (mut session, mut drive) = (Session::clone(&network), drive.clone());
        let order = order.clone();
        async move {
            let answer = session.read_one(&mut drive, &acceleration).await;
            order.borrow_mut().push(number);
            answer
        }
    });
    let answers = join_all(callers).wait();
    assert!(answers.iter().all(Result::is_ok));
    assert_eq!(*order.borrow(), (0..100).collect::<Vec<i32>>());
    // one connection for all of it
    assert_eq!(
        network.route(&drive),
        Some(profidrive_client::Route::DeviceAccess)
    );
}

/// Calls may go to other threads, and so may axes.
#[test]
fn calls_and_axes_may_change_threads() {
    fn sent<T: Send>(value: T) -> T {
        value
    }
    let (mut network, ids) = plant();
    let mut session = Session::clone(&network);
    let mut axis = sent(taken(&mut session, 6)).wait();
    let axis = std::thread::spawn(move || {
        drop(sent(runs(&mut axis)).wait());
        axis
    });
    let axis = axis.join().expect("no panic");
    sent(axis.release()).wait().expect("along its ramp");
    let mut drive = find(&mut network, "axis-6").expect("there");
    sent(session.status(&mut drive)).wait().expect("a status");
    sent(session.backup(&mut drive, &mut |_, _| {}))
        .wait()
        .expect("a backup");
    assert!(is_at_rest(&network, ids[5]));
}

/// A caller may change its mind: what a call changes for its own time ends with it, however that is.
#[test]
fn a_call_that_is_dropped_half_way_changes_nothing_for_the_next() {
    let (mut network, ids) = plant();
    let mut session = Session::clone(&network);
    let mut axis = taken(&mut session, 6).wait();
    let mut enabled = runs(&mut axis).wait();
    assert!(enabled.stop().now_or_never().is_none(), "a ramp takes its time");
    drop(enabled);
    axis.stopped().wait().expect("along its ramp");
    // the wish to stop counts again
    let wish = Shared::new(true);
    let wished = wish.clone();
    let (inner, _) = axis.session();
    inner.interrupt_with(move || wished.get());
    let passed = inner.pass(SECOND).wait();
    assert!(matches!(passed, Err(Error::Interrupted)), "{passed:?}");
    wish.set(false);
    axis.release().wait().expect("released");
    // a stop tolerates unanswered parameters; other calls do not
    let mut drive = find(&mut network, "axis-3").expect("there");
    network.medium().segment_mut().cut(ids[2]);
    let stopped = network
        .stop_drive(&mut drive, StopWay::Stop, SECOND)
        .now_or_never();
    assert!(stopped.is_none(), "no answer so soon");
    let selection = select(&drive, "DRV.ACC");
    let read = network.read(&mut drive, &[selection]).wait();
    assert!(read.is_err(), "{read:?}");
}

/// Whoever leaves the network has the last word: an owner who is still at work in another thread starts nothing more.
#[test]
fn an_owner_starts_nothing_once_the_network_is_left() {
    let (network, ids) = plant();
    let world = network.world();
    let mut session = Session::clone(&network);
    let mut axis = taken(&mut session, 3).wait();
    drop(runs(&mut axis).wait());
    let leaving = std::thread::spawn(move || drop(network));
    let error = loop {
        let mut enabled = match axis.enable().wait() {
            Ok(enabled) => enabled,
            Err(error) => break error,
        };
        if let Err(error) = enabled.run(SPEED).wait() {
            break error;
        }
    };
    // virtual time goes on while this thread gets no processor: then its deadline ends the axis first
    let ended = match &error {
        Error::Closed => true,
        Error::Axis { trouble, .. } => *trouble == Trouble::Unattended,
        _ => false,
    };
    assert!(ended, "{error}");
    leaving.join().expect("left");
    assert!(!enabled(&world, ids[2]) && !exchanging(&world, ids[2]));
}

/// Nor does it get an axis without an owner to end it.
#[test]
fn take_axis_fails_after_the_network_is_left() {
    let (network, ids) = plant();
    let world = network.world();
    let mut session = Session::clone(&network);
    let address: DriveAddress = name(3).parse().expect("an address");
    let mut drive = session.find(&address).wait().expect("there");
    let leaving = std::thread::spawn(move || drop(network));
    let error = loop {
        match session.take_axis(&mut drive, running_on(Purpose::Speed)).wait() {
            Ok(axis) => drop(axis),
            Err(error) => break error,
        }
    };
    leaving.join().expect("left");
    assert!(!exchanging(&world, ids[2]), "{error}");
}
