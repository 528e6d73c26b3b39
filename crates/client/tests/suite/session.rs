//! The client against virtual drives on an in-memory segment, in virtual time.

use std::net::SocketAddrV4;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;
use testbench::shared::{On, Shared};

use network::host::{Host, StationId};
use network::segment::{Conditions, Pace, Segment, SegmentMedium};
use profidrive_client::axis::{Goal, Trouble};
use profidrive_client::change::Step;
use profidrive_client::{
    AxisSettings, Client, Drive, DriveAddress, Error, Network, Session, Wait, WriteMode,
};
use profile::catalogue::AKD;
use profile::value::{Assignment, Selection};
use profinet::controller::ControllerConfig;
use profinet::device::Stored;
use profinet::wire::ethernet::Frame;
use profinet::{Endpoint, Instant, IpSuite, MacAddress, Medium, Transmit};
use proptest::prelude::*;
use testbench::{Bench, bench, drive_at, find, ip, is_at_rest, other_controller, select, station};
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

#[test]
fn no_one_or_two_stations_with_a_name() {
    let (mut session, _) = bench(&[("akd-1", 1), ("akd-2", 2), ("akd-2", 3)]);
    for text in ["akd-1", "10.0.0.1", "02:00:00:00:00:01"] {
        assert_eq!(find(&mut session, text).expect(text).station.name, "akd-1");
    }
    let Err(Error::Ambiguous { macs, .. }) = find(&mut session, "akd-2") else {
        panic!("two of them")
    };
    assert_eq!(macs.len(), 2);
    let Err(Error::NotFound { answered, .. }) = find(&mut session, "akd-9") else {
        panic!("no station")
    };
    assert_eq!(answered.len(), 3);
}

/// Of many drives only the one that is meant answers, and the search does not wait for others.
#[test]
fn a_mac_address_is_asked_alone() {
    let (mut session, _) = bench(&[("akd-1", 1), ("akd-2", 2)]);
    let by_name = find(&mut session, "akd-1").expect("by name").station;
    let begin = session.now();
    let by_mac = find(&mut session, "02:00:00:00:00:01")
        .expect("by its address")
        .station;
    assert_eq!(by_mac, by_name);
    assert!(session.now() - begin < Duration::from_millis(50));
    let Err(Error::NotFound { answered, .. }) = find(&mut session, "02:00:00:00:00:09") else {
        panic!("no station")
    };
    assert_eq!(answered.len(), 2);
}

/// A station that answers too late to its name stands among all that answer: then it is there.
#[test]
fn a_station_that_answers_late_is_found() {
    // the window of one name is 400 ms, that of all 1 s
    let slow = Conditions {
        delay: Duration::from_millis(600),
        ..Conditions::default()
    };
    let (mut session, ids) = bench(&[("akd-1", 1), ("akd-2", 2), ("akd-2", 3)]);
    for id in ids {
        session.medium().segment_mut().set_conditions(id, slow);
    }
    let drive = find(&mut session, "akd-1").expect("it answered, only late");
    assert_eq!(drive.station.mac, MacAddress([2, 0, 0, 0, 0, 1]));
    let by_mac = find(&mut session, "02:00:00:00:00:01").expect("late too");
    assert_eq!(by_mac.station, drive.station);
    // two of one name are two, however late
    let Err(Error::Ambiguous { macs, .. }) = find(&mut session, "akd-2") else {
        panic!("two of them")
    };
    assert_eq!(macs.len(), 2);
    let Err(Error::NotFound { answered, .. }) = find(&mut session, "akd-9") else {
        panic!("no station")
    };
    assert_eq!(answered.len(), 3);
}

#[test]
fn without_discovery_the_endpoint_mapper_identifies_the_device() {
    let (session, _) = bench(&[("akd-1", 1)]);
    let mut session = session.without_discovery();
    let mut drive = find(&mut session, "10.0.0.1").expect("by address");
    assert_eq!(
        (drive.station.vendor_id, drive.station.device_id),
        (AKD.device.vendor_id, AKD.device.device_id)
    );
    let selection = select(&drive, "DRV.ACC");
    assert_eq!(
        session
            .read_one(&mut drive, &selection)
            .wait()
            .expect("read")
            .number(),
        Some(3000.0)
    );
    assert!(matches!(
        find(&mut session, "akd-1"),
        Err(Error::NeedsDiscovery { .. })
    ));
    assert!(matches!(
        find(&mut session, "10.0.0.99"),
        Err(Error::NotFound { .. })
    ));
}

#[test]
fn a_parameter_written_twice_is_a_mistake() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let twice: Vec<Assignment> = ["DRV.ACC=5000", "2108=6000"]
        .iter()
        .map(|text| text.parse().expect("an assignment"))
        .collect();
    let error = session
        .write(&mut drive, &twice, WriteMode::Write)
        .wait()
        .expect_err("refused");
    assert_eq!(
        error.to_string(),
        "DRV.ACC (p2108) is written twice; give it one value"
    );
    let selection = select(&drive, "DRV.ACC");
    let reading = session.read_one(&mut drive, &selection).wait().expect("read");
    assert_eq!(reading.number(), Some(3000.0), "nothing was written");
}

#[test]
fn refusals_of_the_present_state_are_reported_per_parameter() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    for (text, advice) in [
        ("DRV.EN=1", "[status] shows what prevents it"),
        ("915[0]=2", "PNU 922"),
    ] {
        let assignment: Assignment = text.parse().expect("an assignment");
        let outcomes = session
            .write(&mut drive, &[assignment], WriteMode::Write)
            .wait()
            .expect("an answer");
        let Some(refusal) = outcomes.changes()[0].refusal() else {
            panic!("{text} was written")
        };
        let remedy = refusal.remedy().unwrap_or_default().to_string();
        assert!(remedy.contains(advice), "{text}: {remedy}");
        assert!(!remedy.contains("disabled"), "{text}: {remedy}");
    }
}

/// AKD PROFINET manual 5.8: the AKD calls signal 101 MT.FEEDRATE.
#[test]
fn mt_feedrate_is_signal_101_in_percent() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let assignment: Assignment = "MT.FEEDRATE=50%".parse().expect("an assignment");
    session
        .write(&mut drive, &[assignment], WriteMode::Write)
        .wait()
        .expect("written");
    let selection = select(&drive, "101");
    let reading = session.read_one(&mut drive, &selection).wait().expect("read");
    assert_eq!((reading.number(), reading.unit), (Some(50.0), "%"));
}

/// DRV.REBOOT is a double word and a command: nothing is read before or after it, as the drive restarts.
#[test]
fn reboot_is_executed_and_not_read_back() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let assignment: Assignment = "DRV.REBOOT=1".parse().expect("an assignment");
    let outcomes = session
        .write(&mut drive, &[assignment], WriteMode::Write)
        .wait()
        .expect("an answer");
    let reboot = &outcomes.changes()[0];
    assert_eq!(reboot.step, Step::Written);
    assert!(reboot.acts && reboot.old.is_none() && reboot.read_back.is_none() && reboot.is_done());
}

#[test]
fn a_silent_drive_is_reported_while_waiting() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let reports = Shared::new(0);
    let look = |session: &mut Bench, drive: &mut Drive| {
        let reports = reports.clone();
        session
            .reporting_silence(
                Duration::from_secs(1),
                async |session: &mut Session| {
                    session.snapshot(drive, &[]).await.map(|snapshot| snapshot.zsw1)
                },
                move || reports.set(reports.get() + 1),
            )
            .wait()
    };
    assert_eq!(look(&mut session, &mut drive).expect("answers"), Some(0x0240));
    session.pass(Duration::from_secs(5)).wait().expect("time passes");
    assert_eq!(reports.get(), 0, "a drive that answers is not called silent");
    session.medium().segment_mut().detach(ids[0]);
    look(&mut session, &mut drive).expect_err("gone");
    assert_eq!(reports.get(), 1, "once");
    let begin = session.now();
    session.forget(&drive);
    session.close().wait().expect("no connection to release");
    assert_eq!(session.now(), begin);
}

#[test]
fn naming_and_addressing() {
    let (mut session, _) = bench(&[("", 1)]);
    let drive = find(&mut session, "02:00:00:00:00:01").expect("by MAC");
    session.set_name(&drive, "press-7", true).wait().expect("a name");
    session.set_ip(&drive, ip(77), true).wait().expect("an address");
    session.blink(&drive).wait().expect("blinks");
    let drive = find(&mut session, "press-7").expect("by its new name");
    assert_eq!(drive.station.ip.address, ip(77).address);
    assert!(matches!(
        session.set_name(&drive, "Bad_Name", true).wait(),
        Err(Error::Misuse(_))
    ));
}

#[test]
fn all_parameters_in_few_requests() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let all: Vec<Selection> = AKD
        .parameters
        .iter()
        .map(|row| select(&drive, &row.pnu.to_string()))
        .collect();
    let frames = session.medium().segment().statistics().sent;
    let readings = session.read(&mut drive, &all).wait().expect("read");
    let frames = session.medium().segment().statistics().sent - frames;
    assert!(readings.len() > AKD.parameters.len());
    assert_eq!(readings.iter().filter(|reading| reading.is_err()).count(), 0);
    // a job is four datagrams; one parameter per job would be more than 3200
    assert!(frames < 400, "{frames} frames");
    session.close().wait().expect("closed");
}

#[test]
fn a_write_shows_old_and_new_and_reads_back() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let assignments: Vec<Assignment> = ["DRV.ACC=5000", "PN.VELSCALING=1000"]
        .iter()
        .map(|text| text.parse().expect("an assignment"))
        .collect();
    let dry = session
        .write(&mut drive, &assignments, WriteMode::DryRun)
        .wait()
        .expect("checked");
    assert!(dry.changes().iter().all(|change| change.step == Step::NotWritten));
    let selection = select(&drive, "DRV.ACC");
    assert_eq!(
        session
            .read_one(&mut drive, &selection)
            .wait()
            .expect("read")
            .number(),
        Some(3000.0)
    );
    let done = session
        .write(&mut drive, &assignments, WriteMode::Write)
        .wait()
        .expect("written");
    assert!(done.changes().iter().all(|change| change.step == Step::ReadBack));
    assert_eq!(
        session
            .read_one(&mut drive, &selection)
            .wait()
            .expect("read")
            .number(),
        Some(5000.0)
    );
    // the scale of speeds changed with it, and is used at once
    let setpoint = select(&drive, "5");
    session
        .write(
            &mut drive,
            &["5=10rpm".parse().expect("an assignment")],
            WriteMode::Write,
        )
        .wait()
        .expect("written");
    let reading = session.read_one(&mut drive, &setpoint).wait().expect("read");
    assert_eq!(
        (reading.raw(), drive.parameters.scaling.velocity),
        (Some(45), 1000)
    );
    // nothing is written when one of them is wrong
    let wrong: Vec<Assignment> = ["DRV.ACC=6000", "VL.FB_32=1"]
        .iter()
        .map(|text| text.parse().expect("an assignment"))
        .collect();
    assert!(
        session
            .write(&mut drive, &wrong, WriteMode::Write)
            .wait()
            .is_err()
    );
    assert_eq!(
        session
            .read_one(&mut drive, &selection)
            .wait()
            .expect("read")
            .number(),
        Some(5000.0)
    );
}

#[test]
fn leaving_the_scope_stops_and_releases() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    {
        let mut axis = session
            .take_axis(&mut drive, AxisSettings::default())
            .wait()
            .expect("connected");
        let mut axis = axis.enable().wait().expect("enabled");
        axis.run(100.0).wait().expect("runs");
        axis.hold(Duration::from_secs(1)).wait().expect("keeps running");
        assert!(
            axis.status()
                .and_then(|status| status.speed_actual)
                .is_some_and(|speed| (speed - 100.0).abs() < 3.0)
        );
    }
    session.settle();
    assert!(is_at_rest(&session, ids[0]));
    assert!(!drive_at(&session, ids[0]).drive().has_fault());
}

#[test]
fn an_interrupt_stops_and_releases() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let flag = Shared::new(false);
    let seen = flag.clone();
    session.interrupt_with(move || seen.get());
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(100.0).wait().expect("runs");
    let pulled = flag.clone();
    enabled.watch(move |status| pulled.set(status.time > Duration::from_secs(2)));
    assert!(matches!(
        enabled.hold(Duration::from_secs(60)).wait(),
        Err(Error::Interrupted)
    ));
    drop(enabled);
    axis.release().wait().expect("released");
    assert!(is_at_rest(&session, ids[0]));
    assert!(!drive_at(&session, ids[0]).drive().has_fault());
}

/// Opens the way to the records of a drive and is interrupted before the drive has answered.
fn interrupted_connect() -> (Bench, StationId, Drive, Shared<bool>) {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let drive = find(&mut session, "akd-1").expect("there");
    let flag = Shared::new(false);
    let seen = flag.clone();
    // the connect request leaves in the first step, its answer comes later than the second look
    let slow = Conditions {
        delay: Duration::from_millis(200),
        ..Conditions::default()
    };
    session.medium().segment_mut().set_conditions(ids[0], slow);
    let mut steps = 0;
    session.interrupt_with(move || {
        steps += 1;
        seen.get() && steps > 1
    });
    flag.set(true);
    assert!(matches!(session.open(&drive).wait(), Err(Error::Interrupted)));
    flag.set(false);
    let mut medium = session.medium();
    medium.segment_mut().set_conditions(ids[0], Conditions::default());
    drop(medium);
    (session, ids[0], drive, flag)
}

#[test]
fn an_interrupted_connect_is_taken_up_again() {
    let (mut session, _, mut drive, _) = interrupted_connect();
    session.open(&drive).wait().expect("opens after all");
    let acceleration = select(&drive, "DRV.ACC");
    assert!(session.read(&mut drive, &[acceleration]).wait().expect("read")[0].is_ok());
}

/// A medium owned outside, so that it outlives the session.
struct Kept(Shared<SegmentMedium>);

impl Medium for Kept {
    type Error = <SegmentMedium as Medium>::Error;

    fn now(&self) -> Instant {
        self.0.borrow().now()
    }

    fn step(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> Result<(), Self::Error> {
        self.0.borrow_mut().step(endpoint, until)
    }
}

#[test]
fn a_session_that_is_left_closes_its_connections() {
    let mut segment = Segment::new(7);
    let id = segment.attach(station("akd-1", 1));
    let kept = Shared::new(SegmentMedium::new(segment, Pace::Virtual));
    let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", 1);
    let mut session = On::new(Network::on(Kept(kept.clone()), config));
    let drive = session
        .find(&"akd-1".parse::<DriveAddress>().expect("an address"))
        .wait()
        .expect("there");
    session.open(&drive).wait().expect("open");
    let ars = || {
        let medium = kept.borrow();
        let host = medium.segment().station::<Host<Station>>(id).expect("the drive");
        host.endpoint().device().ars()
    };
    assert_eq!(ars(), 1);
    // as an error does that leaves a command by the shortest way, while the caller wants to stop
    session.interrupt_with(|| true);
    drop(session);
    assert_eq!(ars(), 0);
}

#[test]
fn an_interrupted_connect_leaves_nothing_at_the_drive() {
    let (mut session, id, _, flag) = interrupted_connect();
    flag.set(true);
    session.close().wait().expect("closed");
    flag.set(false);
    session.pass(Duration::from_secs(1)).wait().expect("passes");
    assert_eq!(drive_at(&session, id).device().ars(), 0);
}

#[test]
fn a_watcher_that_panics_does_not_keep_the_axis_from_stopping() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let result = catch_unwind(AssertUnwindSafe(|| {
        let mut axis = session
            .take_axis(&mut drive, AxisSettings::default())
            .wait()
            .expect("connected");
        let mut axis = axis.enable().wait().expect("enabled");
        axis.run(100.0).wait().expect("runs");
        axis.watch(|_| panic!("the terminal is gone"));
        axis.hold(Duration::from_secs(1)).wait()
    }));
    assert!(result.is_err());
    session.settle();
    assert!(is_at_rest(&session, ids[0]));
    assert!(!drive_at(&session, ids[0]).drive().has_fault());
}

/// A drive whose telegram carries a bad IOPS while the flag is set.
struct Muddled {
    station: Station,
    bad: Shared<bool>,
}

impl Endpoint for Muddled {
    fn mac(&self) -> MacAddress {
        self.station.mac()
    }

    fn ip(&self) -> IpSuite {
        self.station.ip()
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        self.station.handle_frame(now, frame);
    }

    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]) {
        self.station.handle_datagram(now, source, local_port, payload);
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.station.handle_timeout(now);
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        let transmit = self.station.poll_transmit(now, buffer);
        if let Some(Transmit::Frame { length }) = transmit
            && self.bad.get()
            && let Some(frame) = Frame::parse(&buffer[..length])
            && frame.frame_id.is_cyclic()
        {
            // three status octets of slot 0, four octets of telegram 1, its IOPS
            let iops = length - frame.payload.len() + 3 + 4;
            buffer[iops] = 0;
        }
        transmit
    }

    fn poll_timeout(&self) -> Option<Instant> {
        self.station.poll_timeout()
    }
}

fn muddled() -> (Bench, StationId, Shared<bool>) {
    let mut config = StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, 1]));
    config.network = Stored {
        name: "akd-1".into(),
        ip: ip(1),
        ..Stored::default()
    };
    let bad = Shared::new(false);
    let station = Muddled {
        station: Station::new(config),
        bad: bad.clone(),
    };
    let mut segment = Segment::new(7);
    let id = segment.attach(Box::new(Host::new(station)));
    let medium = SegmentMedium::new(segment, Pace::Virtual);
    let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", 1);
    (On::new(Network::on(medium, config)), id, bad)
}

fn is_enabled(session: &Bench, id: StationId) -> bool {
    let medium = session.medium();
    let host = medium.segment().station::<Host<Muddled>>(id);
    host.expect("the drive").endpoint().station.drive().is_enabled()
}

const NO_INPUTS: fn(&Result<(), Error>) -> bool = |result| {
    matches!(
        result,
        Err(Error::Axis {
            trouble: Trouble::NoInputs,
            ..
        })
    )
};

/// Whoever records only values gets none that are not valid; whoever shows the connection sees that they are not.
#[test]
fn inputs_that_are_not_valid_are_samples_without_values() {
    let (mut session, _, bad) = muddled();
    let mut drive = find(&mut session, "akd-1").expect("there");
    let axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    let (mut all, mut valid) = (axis.all_samples(100), axis.samples(100));
    session.pass(Duration::from_millis(100)).wait().expect("carried");
    bad.set(true);
    session.pass(Duration::from_millis(100)).wait().expect("carried");
    bad.set(false);
    session.pass(Duration::from_millis(100)).wait().expect("carried");
    let mut marks = Vec::new();
    let mut before = None;
    while let Some(sample) = all.take() {
        assert_eq!(sample.inputs.is_empty(), !sample.valid, "{sample:?}");
        assert!(!sample.outputs.is_empty(), "{sample:?}");
        assert!(
            before.is_none_or(|before| sample.number == before + 1),
            "each is there"
        );
        before = Some(sample.number);
        if marks.last() != Some(&sample.valid) {
            marks.push(sample.valid);
        }
    }
    assert_eq!(marks, [true, false, true]);
    let mut counted = 0;
    while let Some(sample) = valid.take() {
        assert!(sample.valid);
        counted += 1;
    }
    assert!(counted > 5, "{counted}");
    axis.release().wait().expect("at rest");
}

/// A frame that has left is a fact; that a stop was posted is none.
#[test]
fn a_stop_is_sent_once_a_frame_with_it_has_left() {
    let (mut session, _, _) = muddled();
    let mut drive = find(&mut session, "akd-1").expect("there");
    let settings = AxisSettings {
        cycle: Some(Duration::from_millis(16)),
        ..AxisSettings::default()
    };
    let mut axis = session.take_axis(&mut drive, settings).wait().expect("connected");
    let handle = axis.stop_handle();
    assert!(!handle.quick_stop(), "nothing was in operation");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(100.0).wait().expect("runs");
    enabled
        .hold(Duration::from_millis(300))
        .wait()
        .expect("undisturbed");
    let posted = session.now();
    assert!(handle.quick_stop(), "it was in operation");
    let sent = handle.sent().wait().expect("carried").expect("connected");
    assert!(
        sent >= posted && sent - posted <= Duration::from_millis(17),
        "{posted:?} {sent:?}"
    );
    // a second one has a frame of its own
    session.pass(Duration::from_millis(40)).wait().expect("carried");
    let posted = session.now();
    assert!(handle.quick_stop(), "it is on its way out of operation");
    let again = handle.sent().wait().expect("carried").expect("connected");
    assert!(again >= posted, "{again:?}");
    drop(enabled);
    axis.release().wait().expect("at rest");
    handle.quick_stop();
    assert_eq!(handle.sent().wait().expect("carried"), None, "it was given back");
}

#[test]
fn inputs_that_are_never_valid_end_in_an_error() {
    let (mut session, id, bad) = muddled();
    let mut drive = find(&mut session, "akd-1").expect("there");
    bad.set(true);
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    assert!(NO_INPUTS(&axis.ready().wait()));
    assert!(NO_INPUTS(&axis.enable().wait().map(|_| ())));
    drop(axis);
    assert!(!is_enabled(&session, id));
}

#[test]
fn inputs_that_become_bad_stop_the_axis() {
    let (mut session, id, bad) = muddled();
    let mut drive = find(&mut session, "akd-1").expect("there");
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(100.0).wait().expect("runs");
    bad.set(true);
    assert!(NO_INPUTS(&enabled.hold(Duration::from_secs(1)).wait()));
    assert!(NO_INPUTS(&enabled.run(50.0).wait()), "this operation is over");
    drop(enabled);
    axis.session()
        .0
        .pass(Duration::from_secs(1))
        .wait()
        .expect("time passes");
    assert!(!is_enabled(&session, id));
    bad.set(false);
    axis.session()
        .0
        .pass(Duration::from_secs(1))
        .wait()
        .expect("time passes");
    let mut enabled = axis.enable().wait().expect("the caller knows and wants it again");
    enabled.run(100.0).wait().expect("runs");
    drop(enabled);
    axis.release().wait().expect("released");
    assert!(!is_enabled(&session, id));
}

#[test]
fn an_axis_that_stopped_by_itself_restarts_only_after_the_caller_was_informed() {
    let (mut session, id, bad) = muddled();
    let mut drive = find(&mut session, "akd-1").expect("there");
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    let mut axis = axis.enable().wait().expect("enabled");
    axis.run(100.0).wait().expect("runs");
    // while the caller is busy with something else
    bad.set(true);
    axis.session()
        .0
        .pass(Duration::from_secs(1))
        .wait()
        .expect("time passes");
    bad.set(false);
    axis.session()
        .0
        .pass(Duration::from_secs(1))
        .wait()
        .expect("time passes");
    assert!(NO_INPUTS(&axis.run(200.0).wait()));
    assert!(!is_enabled(&session, id));
}

#[test]
fn a_broken_link_ends_on_both_sides_and_both_recover() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    {
        let mut axis = session
            .take_axis(&mut drive, AxisSettings::default())
            .wait()
            .expect("connected");
        let mut axis = axis.enable().wait().expect("enabled");
        axis.run(100.0).wait().expect("runs");
        session.medium().segment_mut().cut(ids[0]);
        assert!(matches!(
            axis.hold(Duration::from_secs(5)).wait(),
            Err(Error::ConnectionLost { .. })
        ));
    }
    session.pass(Duration::from_secs(1)).wait().expect("time passes");
    assert!(is_at_rest(&session, ids[0]));
    assert_eq!(drive_at(&session, ids[0]).drive().fault_number(0), 702);
    session.medium().segment_mut().uncut(ids[0]);
    let mut drive = find(&mut session, "akd-1").expect("there again");
    assert_eq!(session.faults(&mut drive).wait().expect("faults")[0].number, 702);
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    assert!(matches!(
        axis.enable().wait(),
        Err(Error::Axis {
            trouble: Trouble::Fault,
            ..
        })
    ));
    axis.acknowledge().wait().expect("acknowledged");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(100.0).wait().expect("runs");
    drop(enabled);
    axis.release().wait().expect("released");
}

#[test]
fn limits_are_kept_before_anything_moves() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let settings = AxisSettings {
        speed_limit: 50.0,
        ..AxisSettings::default()
    };
    let mut axis = session.take_axis(&mut drive, settings).wait().expect("connected");
    assert_eq!(axis.status().map(|status| status.view.goal), Some(Goal::Released));
    let mut enabled = axis.enable().wait().expect("enabled");
    for wrong in [50.5, -50.5, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(enabled.run(wrong).wait(), Err(Error::SpeedLimit { .. })),
            "{wrong}"
        );
    }
    assert_eq!(
        enabled.status().map(|status| status.view.goal),
        Some(Goal::Enabled)
    );
    // after a stop it is over: nothing moves on an old permission
    enabled.stop().wait().expect("stopped");
    assert!(matches!(enabled.run(30.0).wait(), Err(Error::NotEnabled { .. })));
    drop(enabled);
    drop(axis);
    session.settle();
    assert!(is_at_rest(&session, ids[0]));
}

#[test]
fn beside_another_controller_reads_work_and_control_is_refused() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    session.medium().segment_mut().attach(other_controller().0);
    session.pass(Duration::from_secs(3)).wait().expect("time passes");
    assert!(
        drive_at(&session, ids[0]).device().is_exchanging(),
        "the other controller runs"
    );
    let mut drive = find(&mut session, "akd-1").expect("there");
    let snapshot = session.snapshot(&mut drive, &[]).wait().expect("a look");
    assert!(snapshot.zsw1.is_some());
    let error = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .map(|_| ())
        .expect_err("refused");
    assert!(matches!(error, Error::OwnedByController { .. }), "{error}");
    session.pass(Duration::from_secs(1)).wait().expect("time passes");
    assert!(
        drive_at(&session, ids[0]).device().is_exchanging(),
        "the other controller was not disturbed"
    );
}

#[test]
fn parameters_over_a_bad_network() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let conditions = Conditions {
        loss: 0.01,
        duplicate: 0.01,
        ..Conditions::default()
    };
    session.medium().segment_mut().set_all_conditions(conditions);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let selection = select(&drive, "DRV.ACC");
    for _ in 0..200 {
        assert_eq!(
            session
                .read_one(&mut drive, &selection)
                .wait()
                .expect("read")
                .number(),
            Some(3000.0)
        );
    }
}

proptest! {
    #[test]
    fn garbage_disturbs_nothing(
        frames in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..120), 0..20),
    ) {
        let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", 1);
        let mut client = Client::new(config);
        let mut now = Instant::ZERO;
        for frame in &frames {
            now += Duration::from_millis(1);
            let mut pn = vec![2, 0, 0, 0, 1, 0, 2, 0, 0, 0, 0, 9, 0x88, 0x92];
            pn.extend(frame);
            client.handle_frame(now, &pn);
            client.handle_frame(now, frame);
            client.handle_datagram(now, SocketAddrV4::new(ip(9).address, 34964), 34964, frame);
            client.handle_timeout(now);
        }
        let mut buffer = [0; profinet::MAX_FRAME];
        for _ in 0..1000 {
            if client.poll_transmit(now, &mut buffer).is_none() {
                break;
            }
        }
    }
}
