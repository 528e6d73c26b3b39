//! The ways to the records of a drive: device access, implicit reads, a connection as IO controller; on devices that refuse
//! some of them, in virtual time.

use std::time::Duration;
use testbench::shared::{On, Shared};

use crate::remote_io::remote_io;
use network::host::{Host, StationId};
use network::segment::{Conditions, Pace, Segment, SegmentMedium};
use profidrive_client::{
    AxisSettings, Client, Drive, Error, Network, Route, RouteNotice, StopWay, VendorModule, Wait, WriteMode,
    modules_of,
};
use profile::parameter::{Keep, ParameterAccess};
use profinet::controller::{
    ArId, ConnectConfig, ControllerConfig, ModuleConfig, RecordAddress, Resolve, SubmoduleConfig, Target,
};
use profinet::cyclic::Timing;
use profinet::device::{Device, Refusals, Stored};
use profinet::wire::PnioStatus;
use profinet::{Instant, IpSuite, MacAddress};
use testbench::{Bench, bench_of, command, drive_at, drive_mut, find, ip, other_controller, select};
use virtual_drive::model::{self, Model};
use virtual_drive::station::{Station, StationConfig, StationEvent};

/// Faulty ARBlockReq: ARType.
const NO_AR_TYPE: PnioStatus = PnioStatus::connect(0x01, 0x04);
/// Wrong number of AlarmCRs: the device wants one in every connect.
const NO_ALARM_CR: PnioStatus = PnioStatus::connect(0x40, 0x03);
/// ARUUID unknown: a device that wants a connection for every read.
const NO_IMPLICIT: PnioStatus = PnioStatus::new(0xDE, 0x81, 0x40, 0x05);
const NOT_NOW: PnioStatus = PnioStatus::write(0xB5);
/// Connect: resource.
const NO_CONTROLLER: PnioStatus = PnioStatus::connect(0x3D, 0x01);

const IM0: RecordAddress = RecordAddress {
    api: 0,
    slot: 0,
    subslot: 1,
    index: 0xAFF0,
};

/// The ramp of each model, which is changed, and how it is put into local operation with the motor turning.
const MODELS: [(&Model, &str, &str); 3] = [
    (&model::AKD, "DRV.ACC", "4000"),
    (&model::VLT, "3-41", "5"),
    (&model::VACON, "ID103", "5"),
];

fn station(model: &'static Model, refusals: Refusals) -> Box<Host<Station>> {
    let mut config = StationConfig::new(model, MacAddress([2, 0, 0, 0, 0, 1]));
    config.refusals = refusals;
    config.network = Stored {
        name: "drive-1".into(),
        ip: ip(1),
        ..Stored::default()
    };
    Box::new(Host::new(Station::new(config)))
}

type Notices = Shared<Vec<RouteNotice>>;

fn follow(session: &mut Bench) -> Notices {
    let notices = Notices::default();
    let follower = notices.clone();
    session.follow_routes(move |drive, notice| {
        assert_eq!(drive, "drive-1");
        follower.borrow_mut().push(notice.clone());
    });
    notices
}

fn reach(model: &'static Model, refusals: Refusals) -> (Bench, Drive, StationId, Notices) {
    let (mut session, ids) = bench_of(vec![station(model, refusals)]);
    let notices = follow(&mut session);
    let drive = find(&mut session, "drive-1").expect("there");
    (session, drive, ids[0], notices)
}

/// Ways in the order in which they were taken or found closed.
fn steps(notices: &Notices) -> Vec<(Route, bool)> {
    let step = |notice: &RouteNotice| match notice {
        RouteNotice::Taken { route, .. } => Some((*route, true)),
        RouteNotice::Closed(closed) => Some((closed.route, false)),
        RouteNotice::StartUpEnded => None,
    };
    notices.borrow().iter().filter_map(step).collect()
}

fn write(session: &mut Bench, drive: &mut Drive, name: &str, value: &str) -> Result<(), Error> {
    let assignment = format!("{name}={value}").parse().expect("an assignment");
    let outcomes = session.write(drive, &[assignment], WriteMode::Write).wait()?;
    outcomes.accepted()
}

fn read(session: &mut Bench, drive: &mut Drive, name: &str) -> Result<f64, Error> {
    let selection = select(drive, name);
    let reading = session.read_one(drive, &selection).wait()?;
    Ok(reading.number().expect("a number"))
}

fn events(session: &mut Bench, id: StationId) -> Vec<StationEvent> {
    let mut medium = session.medium();
    let segment = medium.segment_mut();
    let host = segment.station_mut::<Host<Station>>(id).expect("the drive");
    let station = host.endpoint_mut();
    std::iter::from_fn(|| station.poll_event()).collect()
}

fn ars(session: &Bench, id: StationId) -> usize {
    drive_at(session, id).device().ars()
}

/// What a read or a write must not change.
#[derive(Debug, PartialEq)]
struct Seen {
    enabled: bool,
    state: profile::state::State,
    fault: bool,
    warning: bool,
    control: u16,
    module: Option<u32>,
    speed: i64,
}

fn look(session: &Bench, id: StationId) -> Seen {
    let station = drive_at(session, id);
    let drive = station.drive();
    Seen {
        enabled: drive.is_enabled(),
        state: drive.state(),
        fault: drive.has_fault(),
        warning: drive.has_warning(),
        control: drive.control_word().0,
        module: station.device().plugged(1),
        speed: (drive.axis().measured_speed() / 5.0).round() as i64,
    }
}

#[test]
fn device_access_is_the_first_way_and_nothing_else_is_tried() {
    for (model, name, value) in MODELS {
        let (mut session, mut drive, id, notices) = reach(model, Refusals::default());
        session.read_record(&drive, IM0).wait().expect("I&M0");
        write(&mut session, &mut drive, name, value).expect("written");
        assert_eq!(steps(&notices), [(Route::DeviceAccess, true)]);
        assert_eq!(session.route(&drive), Some(Route::DeviceAccess));
        assert_eq!(ars(&session, id), 1);
        session.close().wait().expect("closed");
    }
}

/// Records need no connection; parameters get one as IO controller, which changes nothing at the drive.
#[test]
fn a_device_without_device_access_is_read_implicitly_and_its_parameters_over_a_controller_connection() {
    for status in [NO_AR_TYPE, NO_ALARM_CR, PnioStatus::connect(0x40, 0x04)] {
        for (model, name, value) in MODELS {
            let refusals = Refusals {
                device_access: Some(status),
                ..Refusals::default()
            };
            let (mut session, mut drive, id, notices) = reach(model, refusals);
            session.pass(Duration::from_secs(1)).wait().expect("time passes");
            let before = look(&session, id);
            session.read_record(&drive, IM0).wait().expect("I&M0");
            session.read_record(&drive, IM0).wait().expect("again");
            let implicit = [(Route::DeviceAccess, false), (Route::Implicit, true)];
            assert_eq!(steps(&notices), implicit, "the choice holds");
            assert_eq!(session.route(&drive), Some(Route::Implicit));
            assert_eq!(ars(&session, id), 0, "no connection for that");
            assert!(session.closed_routes(&drive)[0].reason.starts_with("connect: "));

            events(&mut session, id);
            write(&mut session, &mut drive, name, value).expect("written");
            assert_eq!(
                read(&mut session, &mut drive, name).expect("read"),
                value.parse::<f64>().unwrap()
            );
            let all = [implicit.to_vec(), vec![(Route::Controller, true)]].concat();
            assert_eq!(steps(&notices), all);
            assert_eq!(ars(&session, id), 1);
            {
                let station = drive_at(&session, id);
                let device = station.device();
                assert!(device.send_interval() >= Some(Duration::from_millis(16)));
                assert!(device.watchdog() >= Some(Duration::from_millis(100)));
            }
            // idle for longer than any time-out of the connection
            session.pass(Duration::from_secs(70)).wait().expect("time passes");
            read(&mut session, &mut drive, name).expect("still open");
            assert_eq!(steps(&notices), all, "one connection for all of it");
            assert_eq!(look(&session, id), before);
            session.close().wait().expect("closed");
            session.pass(Duration::from_secs(5)).wait().expect("time passes");
            assert_eq!(ars(&session, id), 0, "released");
            assert_eq!(look(&session, id), before, "{}", model.catalogue.model);
            for event in events(&mut session, id) {
                let harmless = matches!(
                    event,
                    StationEvent::Connected { .. }
                        | StationEvent::Disconnected { .. }
                        | StationEvent::PersistParameters { .. }
                        | StationEvent::Written(_)
                );
                assert!(harmless, "{event:?}");
            }
        }
    }
}

/// Turning without any controller: enabled at the drive itself.
fn turn_locally(session: &mut Bench, id: StationId, model: &Model) {
    let mut drive = drive_mut(session, id);
    if std::ptr::eq(model, &raw const model::AKD) {
        let number = |name: &str| model.catalogue.by_name(name).expect("known").pnu;
        let mut set = |name: &str, value: u64| {
            let pnu = number(name);
            drive.write(pnu, 0, value, Keep::Volatile).expect(name);
        };
        set("DRV.CMDSOURCE", 0);
        set("DRV.EN", 1);
        set("VL.CMDU_32", 100_000);
    } else {
        drive.inject("local-speed=300rpm".parse().expect("an injection"));
    }
    drop(drive);
    session.pass(Duration::from_secs(10)).wait().expect("time passes");
}

#[test]
fn a_drive_that_turns_by_its_panel_or_service_channel_goes_on_undisturbed() {
    for (model, name, value) in MODELS {
        let refusals = Refusals {
            device_access: Some(NO_AR_TYPE),
            ..Refusals::default()
        };
        let (mut session, mut drive, id, _) = reach(model, refusals);
        turn_locally(&mut session, id, model);
        let before = look(&session, id);
        assert!(before.enabled && before.speed != 0 && !before.fault, "{before:?}");
        write(&mut session, &mut drive, name, value).expect("written");
        read(&mut session, &mut drive, name).expect("read");
        assert_eq!(look(&session, id), before, "while connected");
        session.close().wait().expect("closed");
        session.pass(Duration::from_secs(5)).wait().expect("time passes");
        assert_eq!(look(&session, id), before, "{}", model.catalogue.model);
    }
}

/// A controller of a VLT that runs it, as a station of the segment.
fn vlt_controller() -> (Box<Host<Client>>, ArId) {
    let mut client = Client::new(ControllerConfig::new(
        MacAddress([2, 0, 0, 0, 1, 1]),
        ip(201),
        "plc",
        2,
    ));
    let device = &model::VLT.catalogue.device;
    let telegram = device.telegram(1).expect("telegram 1");
    let timing = Timing::for_interval(Duration::from_millis(16)).expect("16 ms");
    let mut config = ConnectConfig::new(modules_of(device, telegram), timing);
    config.resolve = Resolve::Check;
    let target = Target {
        name: "drive-1".into(),
        mac: None,
        ip: IpSuite::NONE,
        vendor_id: device.vendor_id,
        device_id: device.device_id,
        instance: 1,
    };
    let ar = client
        .controller()
        .connect(Instant::ZERO, target, config)
        .expect("a request");
    (Box::new(Host::new(client)), ar)
}

fn run_vlt(session: &mut Bench, plc: (StationId, ArId)) {
    let place = model::VLT.catalogue.device.layout.telegram;
    for (word, seconds) in [(0x047E_u16, 1), (0x047F, 10)] {
        let mut medium = session.medium();
        let host = medium.segment_mut().station_mut::<Host<Client>>(plc.0);
        let client = host.expect("the controller").endpoint_mut();
        let [high, low] = word.to_be_bytes();
        client
            .controller()
            .set_output(plc.1, 1, place, &[high, low, 0x20, 0])
            .expect("its telegram");
        drop(medium);
        session
            .pass(Duration::from_secs(seconds))
            .wait()
            .expect("time passes");
    }
}

#[test]
fn a_vlt_that_turns_on_without_its_controller_is_not_touched_by_a_read() {
    let refusals = Refusals {
        device_access: Some(NO_AR_TYPE),
        ..Refusals::default()
    };
    let (plc, ar) = vlt_controller();
    let mut segment = Segment::new(7);
    let id = segment.attach(station(&model::VLT, refusals));
    let plc = (segment.attach(plc), ar);
    let medium = SegmentMedium::new(segment, Pace::Virtual);
    let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", 1);
    let mut session = On::new(Network::on(medium, config));
    session.pass(Duration::from_secs(2)).wait().expect("time passes");
    run_vlt(&mut session, plc);
    let mut drive = find(&mut session, "drive-1").expect("there");
    // with its controller: only what needs no connection
    session.read_record(&drive, IM0).wait().expect("I&M0");
    let error = read(&mut session, &mut drive, "3-41").expect_err("owned");
    let Error::ParametersOwned {
        controller, closed, ..
    } = &error
    else {
        panic!("{error}")
    };
    assert_eq!((controller.as_deref(), closed.len()), (Some("plc"), 1), "{error}");
    let message = error.to_string();
    assert!(
        message.contains("controller \"plc\" has its only connection"),
        "{message}"
    );
    let hint = error.advice().expect("what is possible").to_string();
    assert!(
        hint.contains("can be read beside the controller") && hint.contains("disconnect the controller"),
        "{hint}"
    );
    let info = session.info(&mut drive).wait().expect("identity");
    assert!(info.identity.is_some() && info.modules.len() == 2);
    assert_eq!(info.controller, Some(Some("plc".into())));
    assert!(info.readings.is_empty() && info.refused.iter().any(|text| text.contains("plc")));
    assert_eq!(ars(&session, id), 1, "the controller's alone");

    session.medium().segment_mut().detach(plc.0);
    session.pass(Duration::from_secs(5)).wait().expect("time passes");
    let before = look(&session, id);
    assert!(before.enabled && before.speed != 0, "8-04 is off: {before:?}");
    assert!(read(&mut session, &mut drive, "3-41").is_ok());
    assert_eq!(look(&session, id), before);
    session.close().wait().expect("closed");
    session.pass(Duration::from_secs(5)).wait().expect("time passes");
    assert_eq!(look(&session, id), before, "turns on as before");
}

/// The worst that may be: the device wants data first, and gets outputs that say nothing.
#[test]
fn a_device_that_takes_jobs_only_with_data_gets_invalid_outputs_that_move_nothing() {
    for (model, name, value) in MODELS {
        let refusals = Refusals {
            device_access: Some(NO_ALARM_CR),
            start_up_write: Some(NOT_NOW),
            ..Refusals::default()
        };
        for turning in [false, true] {
            let (mut session, mut drive, id, notices) = reach(model, refusals);
            if turning {
                turn_locally(&mut session, id, model);
            }
            let before = look(&session, id);
            write(&mut session, &mut drive, name, value).expect("written");
            assert!(notices.borrow().contains(&RouteNotice::StartUpEnded));
            assert!(drive_at(&session, id).device().is_exchanging());
            assert!(!drive_at(&session, id).device().provider_running());
            session.pass(Duration::from_secs(5)).wait().expect("time passes");
            read(&mut session, &mut drive, name).expect("read");
            assert_eq!(look(&session, id), before, "{}", model.catalogue.model);
            session.close().wait().expect("closed");
            session.pass(Duration::from_secs(5)).wait().expect("time passes");
            if !turning {
                assert_eq!(look(&session, id), before, "{}", model.catalogue.model);
            }
        }
    }
}

#[test]
fn without_implicit_reads_everything_goes_over_the_controller_connection() {
    let refusals = Refusals {
        device_access: Some(NO_AR_TYPE),
        implicit_read: Some(NO_IMPLICIT),
        ..Refusals::default()
    };
    for (model, name, value) in MODELS {
        let (mut session, mut drive, id, notices) = reach(model, refusals);
        let before = look(&session, id);
        session.read_record(&drive, IM0).wait().expect("I&M0");
        write(&mut session, &mut drive, name, value).expect("written");
        assert_eq!(
            steps(&notices),
            [
                (Route::DeviceAccess, false),
                (Route::Implicit, false),
                (Route::Controller, true)
            ]
        );
        assert_eq!(session.route(&drive), Some(Route::Controller));
        assert_eq!(
            session.owner(&drive).wait().expect("answered"),
            Some(None),
            "not ourselves"
        );
        session.close().wait().expect("closed");
        assert_eq!(look(&session, id), before, "{}", model.catalogue.model);
    }
}

#[test]
fn a_device_that_refuses_everything_is_reported_with_every_answer() {
    let refusals = Refusals {
        device_access: Some(NO_AR_TYPE),
        implicit_read: Some(NO_IMPLICIT),
        controller: Some(NO_CONTROLLER),
        start_up_write: None,
    };
    let (mut session, mut drive, id, _) = reach(&model::AKD, refusals);
    let error = read(&mut session, &mut drive, "DRV.ACC").expect_err("no way");
    let Error::NoRoute { closed, .. } = &error else {
        panic!("{error}")
    };
    let routes: Vec<Route> = closed.iter().map(|closed| closed.route).collect();
    assert_eq!(routes, [Route::DeviceAccess, Route::Implicit, Route::Controller]);
    let error = session.read_record(&drive, IM0).wait().expect_err("no way");
    let message = error.to_string();
    for part in [
        "no way to its records",
        "device access: connect: ",
        "implicit reads: record read: ",
        "connection as IO controller: connect: ",
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
    assert!(error.advice().is_some());
    // what is known by discovery is still shown
    let info = session.info(&mut drive).wait().expect("no error");
    assert!(info.identity.is_none() && info.refused.iter().any(|text| text.contains("no way")));
    assert_eq!(ars(&session, id), 0);
}

#[test]
fn a_device_description_that_declares_no_device_access_skips_the_try() {
    let (mut session, mut drive, id, notices) = reach(&model::AKD, Refusals::default());
    drive.device_access = Some(false);
    session.read_record(&drive, IM0).wait().expect("I&M0");
    assert_eq!(
        steps(&notices),
        [(Route::DeviceAccess, false), (Route::Implicit, true)]
    );
    assert!(
        session.closed_routes(&drive)[0]
            .reason
            .contains("device description")
    );
    let tried = events(&mut session, id);
    let connected = |event: &StationEvent| matches!(event, StationEvent::Connected { .. });
    assert!(!tried.iter().any(connected), "{tried:?}");
}

/// Ident numbers that no table has: the vendor's device description gives the lengths, without it the module is left out.
#[test]
fn the_device_description_completes_modules_that_are_not_in_the_tables() {
    let file = "GSDML-V2.1-KOLLMORGEN-AKDLIKE-20140301.xml";
    let mut config = StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, 1]));
    config.description = testbench::description(file);
    config.refusals.device_access = Some(NO_AR_TYPE);
    config.network = Stored {
        name: "drive-1".into(),
        ip: ip(1),
        ..Stored::default()
    };
    let vendor_modules: Vec<VendorModule> = config
        .description
        .telegrams
        .iter()
        .map(|telegram| VendorModule {
            telegram: telegram.telegram,
            place: (telegram.slot, telegram.subslot),
            modules: vec![ModuleConfig {
                api: config.description.api,
                slot: telegram.slot,
                ident: telegram.module.ident,
                submodules: telegram
                    .module
                    .submodules
                    .iter()
                    .map(|submodule| SubmoduleConfig {
                        subslot: submodule.subslot,
                        ident: submodule.ident,
                        input_length: submodule.input_length,
                        output_length: submodule.output_length,
                    })
                    .collect(),
            }],
        })
        .collect();
    for (vendor_modules, complete) in [(vendor_modules, true), (Vec::new(), false)] {
        let (mut session, ids) = bench_of(vec![Box::new(Host::new(Station::new(config.clone())))]);
        let notices = follow(&mut session);
        let mut drive = find(&mut session, "drive-1").expect("there");
        drive.vendor_modules = vendor_modules;
        let plugged = drive_at(&session, ids[0]).device().plugged(1);
        write(&mut session, &mut drive, "DRV.ACC", "4000").expect("written");
        let expected = notices.borrow().iter().any(|notice| {
            matches!(notice, RouteNotice::Taken { route: Route::Controller, details } if details.contains("slot 1 "))
        });
        assert_eq!(expected, complete);
        session.close().wait().expect("closed");
        let station = drive_at(&session, ids[0]);
        assert_eq!(station.device().plugged(1), plugged, "nothing is plugged again");
        assert!(!station.drive().has_fault());
    }
}

/// The one place for a controller is given to the axis, and taken again for parameters afterwards.
#[test]
fn an_axis_takes_the_place_of_the_connection_for_parameters() {
    let refusals = Refusals {
        device_access: Some(NO_AR_TYPE),
        ..Refusals::default()
    };
    let (mut session, mut drive, id, _) = reach(&model::AKD, refusals);
    read(&mut session, &mut drive, "DRV.ACC").expect("read");
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(60.0).wait().expect("runs");
    enabled
        .hold(Duration::from_secs(1))
        .wait()
        .expect("keeps running");
    drop(enabled);
    axis.release().wait().expect("released");
    assert_eq!(read(&mut session, &mut drive, "DRV.ACC").expect("read"), 3000.0);
    let outcome = session
        .stop_drive(&mut drive, StopWay::Stop, Duration::from_secs(1))
        .wait()
        .expect("a look");
    assert!(outcome.at_rest);
    session.close().wait().expect("closed");
    session.pass(Duration::from_secs(1)).wait().expect("time passes");
    assert!(!drive_at(&session, id).drive().has_fault(), "no F702");
    assert_eq!(ars(&session, id), 0);
}

#[test]
fn a_controller_is_named_before_a_port_that_is_in_use() {
    let refusals = Refusals {
        device_access: Some(NO_AR_TYPE),
        ..Refusals::default()
    };
    let (plc, _) = vlt_controller();
    let mut segment = Segment::new(7);
    segment.attach(station(&model::VLT, refusals));
    let plc = segment.attach(plc);
    let medium = SegmentMedium::new(segment, Pace::Virtual);
    let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", 1);
    // the program that is the controller has it: on the same computer
    let mut session = On::new(Network::on(medium, config)).without_calls();
    session.pass(Duration::from_secs(2)).wait().expect("time passes");
    let mut drive = find(&mut session, "drive-1").expect("there");
    for _ in 0..2 {
        let error = read(&mut session, &mut drive, "3-41").expect_err("owned");
        let Error::ParametersOwned { controller, .. } = &error else {
            panic!("{error}")
        };
        assert_eq!(controller.as_deref(), Some("plc"), "{error}");
    }
    session.medium().segment_mut().detach(plc);
    session.pass(Duration::from_secs(5)).wait().expect("time passes");
    let error = read(&mut session, &mut drive, "3-41").expect_err("no calls");
    assert!(error.to_string().contains("UDP port 34964"), "{error}");
}

#[test]
fn beside_a_controller_that_the_device_does_not_report_the_refusal_is_an_owner() {
    let refusals = Refusals {
        device_access: Some(NO_AR_TYPE),
        implicit_read: Some(NO_IMPLICIT),
        ..Refusals::default()
    };
    let mut config = StationConfig::new(&model::AKD, MacAddress([2, 0, 0, 0, 0, 1]));
    config.refusals = refusals;
    config.network = Stored {
        name: "akd-1".into(),
        ip: ip(1),
        ..Stored::default()
    };
    let (plc, ar) = other_controller();
    let mut segment = Segment::new(7);
    let id = segment.attach(Box::new(Host::new(Station::new(config))));
    let plc = (segment.attach(plc), ar);
    let medium = SegmentMedium::new(segment, Pace::Virtual);
    let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", 1);
    let mut session = On::new(Network::on(medium, config));
    session.pass(Duration::from_secs(2)).wait().expect("time passes");
    command(&session, plc, &[0x04, 0x7E, 0, 0]);
    session.pass(Duration::from_secs(1)).wait().expect("time passes");
    let mut drive = find(&mut session, "akd-1").expect("there");
    let error = read(&mut session, &mut drive, "DRV.ACC").expect_err("owned");
    assert!(matches!(error, Error::ParametersOwned { .. }), "{error}");
    session.pass(Duration::from_secs(1)).wait().expect("time passes");
    assert!(drive_at(&session, id).device().is_exchanging(), "it runs on");
}

/// A cable that loses frames leaves no connection behind either.
#[test]
fn every_way_stands_lost_frames() {
    for seed in 0..8 {
        let refusals = Refusals {
            device_access: (seed % 2 == 0).then_some(NO_AR_TYPE),
            start_up_write: (seed % 4 == 0).then_some(NOT_NOW),
            ..Refusals::default()
        };
        let mut segment = Segment::new(seed);
        let id = segment.attach(station(&model::VACON, refusals));
        let conditions = Conditions {
            loss: 0.05,
            ..Conditions::default()
        };
        segment.set_conditions(id, conditions);
        let medium = SegmentMedium::new(segment, Pace::Virtual);
        let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", seed);
        let mut session = On::new(Network::on(medium, config));
        let mut drive = find(&mut session, "drive-1").unwrap_or_else(|error| panic!("{seed}: {error}"));
        for _ in 0..5 {
            if let Err(error) = read(&mut session, &mut drive, "ID103") {
                assert!(
                    matches!(error, Error::ConnectionLost { .. } | Error::NoRoute { .. }),
                    "{seed}: {error}"
                );
            }
        }
        session
            .close()
            .wait()
            .unwrap_or_else(|error| panic!("{seed}: {error}"));
        session.pass(Duration::from_secs(60)).wait().expect("time passes");
        assert_eq!(ars(&session, id), 0, "{seed}");
        assert!(!drive_at(&session, id).drive().is_enabled(), "{seed}");
    }
}

#[test]
fn a_device_that_is_no_drive_shows_identity_and_modules_and_is_not_connected_to() {
    let mut segment = Segment::new(7);
    let stored = Stored {
        name: "rio-1".into(),
        ip: ip(9),
        ..Stored::default()
    };
    let device = remote_io(MacAddress([2, 0, 0, 0, 0, 9]), stored, 0);
    let id = segment.attach(Box::new(Host::new(device)));
    let medium = SegmentMedium::new(segment, Pace::Virtual);
    let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", 1);
    let mut session = On::new(Network::on(medium, config));
    let mut device = find(&mut session, "rio-1").expect("there");
    let error = session
        .recognise(&mut device, &mut |_, _| {})
        .wait()
        .expect_err("no parameters");
    assert!(matches!(error, Error::NotADrive { .. }), "{error}");
    let info = session.info(&mut device).wait().expect("identity");
    assert!(!info.is_drive(&device));
    assert_eq!(info.route, Some(Route::Implicit));
    let identity = info.identity.as_ref().expect("I&M0");
    assert_eq!(
        (identity.order_id.as_str(), identity.serial_number.as_str()),
        ("RIO-16", "4711")
    );
    let modules: Vec<_> = info
        .modules
        .iter()
        .map(|module| (module.slot, module.ident))
        .collect();
    assert_eq!(modules, [(0, 0x10), (1, 0x21), (2, 0x31)]);
    assert!(
        info.refused.iter().any(|text| text.contains("is not a drive")),
        "{:?}",
        info.refused
    );
    let mut medium = session.medium();
    let segment = medium.segment_mut();
    let host = segment.station_mut::<Host<Device>>(id).expect("the device");
    let device = host.endpoint_mut();
    let mut events = std::iter::from_fn(|| device.poll_event());
    let connected =
        |event: &profinet::device::Event| matches!(event, profinet::device::Event::Connected { .. });
    assert!(!events.any(|event| connected(&event)), "not connected");
}

#[test]
fn of_a_device_with_very_many_application_processes_some_are_read() {
    let mut segment = Segment::new(7);
    let stored = Stored {
        name: "rio-1".into(),
        ip: ip(9),
        ..Stored::default()
    };
    let device = remote_io(MacAddress([2, 0, 0, 0, 0, 9]), stored, 30);
    segment.attach(Box::new(Host::new(device)));
    let medium = SegmentMedium::new(segment, Pace::Virtual);
    let config = ControllerConfig::new(MacAddress([2, 0, 0, 0, 1, 0]), ip(200), "client", 1);
    let mut session = On::new(Network::on(medium, config));
    let device = find(&mut session, "rio-1").expect("there");
    let modules = session.modules(&device).wait().expect("answered");
    // API 0 has three
    let slots: Vec<u16> = modules.iter().map(|module| module.slot).collect();
    assert_eq!(slots, (0..3 + 15).collect::<Vec<_>>());
}
