//! Callers of every kind on one network: threads, executors, many clients of a server.
#![cfg(feature = "simulate")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "it is a test")]

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use futures::executor::{LocalPool, block_on};
use futures::task::LocalSpawnExt;
use profidrive::client::axis::Move as Order;
use profidrive::client::{AxisSettings, Drive, DriveAddress, Error, Session, StopWay};
use profidrive::motion::{self, Hold, Jog, Move, Observer, Run};
use profidrive::profile::notation::Quantity;
use profidrive::report::PlainWording;
use profidrive::{
    Access, Caller, DriveError, Opening, Transport, Wait, fleet, inspection, open_plan, parameters, scan,
    settings,
};

const PLANT: &str = r#"
    [[drive]]
    name = "akd-1"
    ip = "10.0.0.1/24"
    [[drive]]
    name = "vlt-1"
    model = "vlt"
    ip = "10.0.0.2/24"
"#;

fn opening() -> Opening {
    Opening::new(Access::Cyclic).in_plant(PLANT.parse().unwrap())
}

fn address(name: &str) -> DriveAddress {
    name.parse().unwrap()
}

async fn ramp(network: &mut Session, name: &str) -> String {
    let mut drive = network.find(&address(name)).await.unwrap();
    let wanted = [drive.select("922").unwrap()];
    let readings = network.read(&mut drive, &wanted).await.unwrap();
    format!("{name} {}", readings.len())
}

fn turns_at(network: &Caller) -> f64 {
    speed(network.transport())
}

fn speed(transport: &Transport) -> f64 {
    match transport {
        Transport::Plant(plant) => plant.with_world(|world| world.drive(0).unwrap().drive().axis().speed()),
        transport => panic!("{transport:?}"),
    }
}

#[test]
fn an_executor_carries_a_plant_in_memory() {
    let network = open_plan(PLANT.parse().unwrap()).unwrap();
    let mut first = network.clone();
    assert_eq!(block_on(ramp(&mut first, "akd-1")), "akd-1 1");

    let answers = Arc::new(Mutex::new(Vec::new()));
    let mut pool = LocalPool::new();
    for name in ["akd-1", "vlt-1"] {
        let (mut caller, answers) = (network.clone(), Arc::clone(&answers));
        let task = async move {
            let answer = ramp(&mut caller, name).await;
            answers.lock().unwrap().push(answer);
        };
        pool.spawner().spawn_local(task).unwrap();
    }
    pool.run();
    let mut answers = std::mem::take(&mut *answers.lock().unwrap());
    answers.sort();
    assert_eq!(answers, ["akd-1 1", "vlt-1 1"]);
}

/// The same program gets the same run, whoever looks at its calls.
#[test]
fn one_caller_of_an_executor_gets_the_run_of_one_that_waits() {
    async fn run(mut network: Caller) -> profinet::Instant {
        ramp(&mut network, "akd-1").await;
        ramp(&mut network, "vlt-1").await;
        network.now()
    }
    let [first, second] = [(); 2].map(|()| open_plan(PLANT.parse().unwrap()).unwrap());
    assert_eq!(block_on(run(first.clone())), run(second.clone()).wait());
}

#[test]
fn a_plant_in_real_time_goes_on_while_no_call_waits() {
    let mut network = opening().in_real_time().open().unwrap();
    let mut drive = network.find(&address("akd-1")).wait().unwrap();
    let lease = Duration::from_secs(1);
    let settings = AxisSettings {
        lease,
        ..AxisSettings::default()
    };
    let mut axis = network.take_axis(&mut drive, settings).wait().unwrap();
    let mut enabled = axis.enable().wait().unwrap();
    enabled.reach_speed(60.0, None).wait().unwrap();
    let before = network.now();
    // its owner does nothing: its lease ends, and the plant brings the axis to rest
    let begin = Instant::now();
    while turns_at(&network) != 0.0 {
        assert!(begin.elapsed() < Duration::from_secs(20), "it still turns");
        std::thread::yield_now();
    }
    let (passed, real) = (network.now() - before, begin.elapsed());
    assert!(passed >= lease, "{passed:?}");
    // by the clock, not faster: both were read at slightly different moments
    assert!(
        passed < real + Duration::from_millis(500),
        "{passed:?} in {real:?}"
    );
}

/// A thread that holds a caller cannot keep axes in operation when the program leaves the network.
#[test]
fn callers_do_not_keep_a_network_open() {
    let mut network = open_plan(PLANT.parse().unwrap()).unwrap();
    let mut caller = network.clone();
    let mut drive = caller.find(&address("akd-1")).wait().unwrap();
    let settings = AxisSettings::default();
    let mut axis = caller.take_axis(&mut drive, settings).wait().unwrap();
    let mut enabled = axis.enable().wait().unwrap();
    enabled.reach_speed(60.0, None).wait().unwrap();
    assert!(turns_at(&network) > 59.0);
    let plant = caller.transport().clone();
    assert_eq!(ramp(&mut network, "vlt-1").wait(), "vlt-1 1");
    drop(network);
    assert_eq!(speed(&plant), 0.0);
    assert!(matches!(
        caller.find(&address("vlt-1")).wait(),
        Err(Error::Closed)
    ));
}

#[test]
fn the_wish_to_stop_of_one_client_is_not_that_of_another() {
    let network = open_plan(PLANT.parse().unwrap()).unwrap();
    let (mut first, mut second) = (network.clone(), network.clone());
    let wished = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&wished);
    first.interrupt_with(move || flag.load(Ordering::Relaxed));
    let mut later = first.clone();
    wished.store(true, Ordering::Relaxed);
    assert!(matches!(
        first.find(&address("akd-1")).wait(),
        Err(Error::Interrupted)
    ));
    assert!(matches!(
        later.find(&address("akd-1")).wait(),
        Err(Error::Interrupted)
    ));
    assert!(second.find(&address("akd-1")).wait().is_ok());
}

/// Every call and handle can go to another thread: the compiler decides.
#[test]
fn calls_and_handles_can_go_to_other_threads() {
    fn sent<T: Send>(_: T) {}
    fn shared<T: Clone + Send + Sync>(_: &T) {}
    let mut network = open_plan(PLANT.parse().unwrap()).unwrap();
    shared(&Caller::clone(&network));
    shared(&Session::clone(&network));
    let mut drive = network.find(&address("akd-1")).wait().unwrap();
    shared(&drive);

    let opening = opening();
    let selector = "all".parse().unwrap();
    let second = Duration::from_secs(1);
    sent(scan::discover(&mut network, second));
    sent(scan::survey(&mut network, second, &mut |_, _| {}));
    sent(opening.select(&mut network, &selector));
    sent(fleet::stop(
        &opening,
        &mut network,
        &selector,
        StopWay::Stop,
        second,
    ));
    let read = async |session: &mut Session, drive: &mut Drive| {
        parameters::read(session, drive, &["922".parse().unwrap()])
            .await
            .map_err(DriveError::from)
    };
    sent(fleet::each(&network, Vec::new(), read));
    let session: &mut Session = &mut network;
    sent(inspection::status(session, &mut drive, &PlainWording));
    sent(inspection::info(session, &mut drive));
    sent(inspection::faults(session, &mut drive, true));
    sent(settings::backup(session, &mut drive, &mut |_, _| {}));
    let observer = Observer::new(|_| {});
    sent(motion::run(session, &mut drive, &Run::at(60.0), &observer));
    sent(motion::jog(session, &mut drive, &Jog::lasting(second), &observer));
    let order = Order::to("1rev".parse::<Quantity>().unwrap().position().unwrap(), 60.0);
    sent(motion::move_to(session, &mut drive, &Move::by(order), &observer));
    let mut axis = motion::hold(session, &mut drive, &Hold::for_speed(), &observer)
        .wait()
        .unwrap();
    sent(axis.run(60.0));
    sent(axis.release());
}
