//! The controller against a device that can be made to misbehave.

mod fake;

use alloc::borrow::Cow;
use alloc::string::ToString;
use alloc::vec;
use alloc::vec::Vec;
use core::time::Duration;

use self::fake::{Fake, Fault};
use super::*;
use crate::cyclic::Timing;
use crate::pair::Pair;
use crate::wire::PnioStatus;
use crate::wire::alarm::{AlarmSpecifier, AlarmType, Notification, Priority};
use crate::wire::block::{DiffModule, ModuleDiff, ModuleState};
use crate::wire::dcp::{BlockError, DcpOption};
use crate::wire::rt::{DataStatus, Iops};
use crate::{Endpoint, IpSuite, MacAddress, RPC_PORT};

const PLC: MacAddress = MacAddress([2, 0x50, 0x4e, 0, 0, 2]);
const DRIVE: MacAddress = MacAddress([2, 0x50, 0x4e, 0, 0, 1]);
const SECOND: Duration = Duration::from_secs(1);

fn ip(last: u8) -> IpSuite {
    IpSuite {
        address: [192, 168, 77, last].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0; 4].into(),
    }
}

fn pair() -> Pair<Controller, Fake> {
    let controller = Controller::new(ControllerConfig::new(PLC, ip(11), "plc", 7));
    Pair::new(controller, Fake::new(DRIVE, ip(50), "drive-1"), 1)
}

fn target() -> Target {
    Target {
        name: "drive-1".into(),
        mac: None,
        ip: IpSuite::NONE,
        vendor_id: 0x0105,
        device_id: 1,
        instance: 1,
    }
}

fn config() -> ConnectConfig {
    let none = |subslot, ident| SubmoduleConfig {
        subslot,
        ident,
        input_length: 0,
        output_length: 0,
    };
    let dap = vec![none(1, 1), none(0x8000, 2), none(0x8001, 3)];
    let telegram = vec![SubmoduleConfig {
        subslot: 1,
        ident: 9,
        input_length: 4,
        output_length: 4,
    }];
    let modules = vec![
        ModuleConfig {
            api: 0,
            slot: 0,
            ident: 1,
            submodules: dap,
        },
        ModuleConfig {
            api: 0x3A00,
            slot: 1,
            ident: 8,
            submodules: telegram,
        },
    ];
    ConnectConfig::new(modules, Timing::for_interval(Duration::from_millis(16)).unwrap())
}

fn event(pair: &mut Pair<Controller, Fake>, limit: Duration) -> Option<Event> {
    pair.until(limit, |p| p.a.poll_event())
}

fn connected(pair: &mut Pair<Controller, Fake>, config: ConnectConfig) -> ArId {
    let ar = pair.a.connect(pair.now, target(), config).unwrap();
    assert_eq!(event(pair, SECOND), Some(Event::Connected { ar, diff: None }));
    assert_eq!(event(pair, SECOND), Some(Event::Ready { ar, diff: None }));
    assert_eq!(event(pair, SECOND), Some(Event::Running { ar }));
    ar
}

fn lost(pair: &mut Pair<Controller, Fake>, limit: Duration) -> LostCause {
    pair.until(limit, |p| match p.a.poll_event() {
        Some(Event::Lost { cause, .. }) => Some(cause),
        _ => None,
    })
    .expect("the connection is lost")
}

const IM0: RecordAddress = RecordAddress {
    api: 0,
    slot: 0,
    subslot: 1,
    index: 0xAFF0,
};
const CHANNEL: RecordAddress = RecordAddress {
    api: 0x3A00,
    slot: 1,
    subslot: 1,
    index: 0xB02E,
};

#[test]
fn finds_names_and_addresses() {
    let mut p = pair();
    let id = p.a.identify(p.now, Filter::all()).unwrap();
    let Some(Event::Identified { station, .. }) = event(&mut p, SECOND) else {
        panic!()
    };
    assert_eq!(
        (station.name.as_str(), station.mac, station.ip),
        ("drive-1", DRIVE, ip(50))
    );
    assert_eq!(
        (
            station.vendor_id,
            station.device_id,
            station.station_type.as_str()
        ),
        (0x105, 1, "fake")
    );
    assert_eq!(event(&mut p, SECOND), Some(Event::IdentifyDone { id, count: 1 }));
    assert_eq!(p.now.as_millis(), 1000, "factor 64 and a margin");
    let done = |p: &mut Pair<_, _>, id| {
        assert_eq!(
            event(p, SECOND),
            Some(Event::DcpDone {
                id,
                result: Ok(DcpReply::Done)
            })
        );
    };
    let id = p.a.dcp_set_name(p.now, DRIVE, "akd-7", true).unwrap();
    done(&mut p, id);
    let id = p.a.dcp_set_ip(p.now, DRIVE, ip(60), true).unwrap();
    done(&mut p, id);
    let id = p.a.dcp_signal(p.now, DRIVE).unwrap();
    done(&mut p, id);
    let id = p.a.dcp_reset(p.now, DRIVE, 2).unwrap();
    done(&mut p, id);
    assert_eq!((p.b.name.as_str(), p.b.ip), ("akd-7", ip(60)));
    p.a.dcp_get(p.now, DRIVE, &[DcpOption::NAME]).unwrap();
    let Some(Event::DcpDone {
        result: Ok(DcpReply::Values(station)),
        ..
    }) = event(&mut p, SECOND)
    else {
        panic!()
    };
    assert_eq!(station.name, "akd-7");
    p.a.dcp_get(p.now, DRIVE, &[DcpOption::NAME, DcpOption::ALIAS])
        .unwrap();
    let Some(Event::DcpDone {
        result: Err(error), ..
    }) = event(&mut p, SECOND)
    else {
        panic!()
    };
    let expected = DcpError::Refused {
        option: DcpOption::ALIAS,
        error: BlockError::SuboptionUnsupported,
    };
    assert_eq!(error, expected);
}

#[test]
fn dcp_errors() {
    let mut p = pair();
    p.b.fault.set = Some(BlockError::InOperation);
    p.a.dcp_set_name(p.now, DRIVE, "x", true).unwrap();
    let Some(Event::DcpDone {
        result: Err(error), ..
    }) = event(&mut p, SECOND)
    else {
        panic!()
    };
    assert_eq!(
        error.to_string(),
        "2/2 name of station: in operation, set not possible"
    );
    p.wire.cut = true;
    let start = p.now;
    p.a.dcp_signal(p.now, DRIVE).unwrap();
    let Some(Event::DcpDone {
        result: Err(error), ..
    }) = event(&mut p, 9 * SECOND)
    else {
        panic!()
    };
    assert_eq!(error, DcpError::Timeout { mac: DRIVE, sends: 3 });
    assert_eq!(p.now - start, 3 * SECOND);
    assert!(matches!(
        p.a.dcp_set_name(p.now, DRIVE, "Upper", true),
        Err(Misuse::Name(_))
    ));
    assert!(matches!(
        p.a.dcp_set_ip(
            p.now,
            DRIVE,
            IpSuite {
                mask: [1; 4].into(),
                ..ip(3)
            },
            true
        ),
        Err(Misuse::Ip(_))
    ));
    assert!(matches!(
        p.a.dcp_signal(p.now, MacAddress::BROADCAST),
        Err(Misuse::Address(_))
    ));
    assert!(matches!(p.a.dcp_reset(p.now, DRIVE, 5), Err(Misuse::Range(_))));
}

#[test]
fn connects_exchanges_and_releases() {
    let mut p = pair();
    let start = p.now;
    let ar = connected(&mut p, config());
    assert!(p.now - start < Duration::from_millis(40), "{:?}", p.now);
    p.a.set_output(ar, 1, 1, &[0x04, 0x7E, 0, 0]).unwrap();
    assert!(
        p.b.last_output.iter().all(|o| !o.1.is_good()),
        "no output was valid before the device was ready"
    );
    p.b.provider
        .as_mut()
        .unwrap()
        .set_data(1, 1, &[9, 8, 7, 6], Iops::GOOD);
    p.run(SECOND);
    assert_eq!(p.a.input(ar, 1, 1), Some((&[9, 8, 7, 6][..], Iops::GOOD)));
    assert_eq!(p.a.output_taken(ar, 1, 1), Some(Iops::GOOD));
    assert_eq!(
        p.b.last_output.last(),
        Some(&(DataStatus::GOOD, Iops::GOOD, vec![0x04, 0x7E, 0, 0]))
    );
    let statistics = p.a.statistics(ar).unwrap();
    assert!((62..=65).contains(&statistics.received), "{statistics:?}");
    assert_eq!(
        (statistics.missed, statistics.out_of_order, statistics.rejected),
        (0, 0, 0)
    );
    p.a.set_run(ar, false).unwrap();
    p.run(Duration::from_millis(50));
    let (status, iops, _) = p.b.last_output.last().unwrap();
    assert_eq!((*status, *iops), (DataStatus::STOP, Iops::BAD_CONTROLLER));
    p.a.set_run(ar, true).unwrap();
    p.b.provider.as_mut().unwrap().set_status(DataStatus::STOP);
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::ProviderState {
            ar,
            run: false,
            problem: false
        })
    );
    p.a.release(p.now, ar).unwrap();
    assert_eq!(event(&mut p, SECOND), Some(Event::Released { ar }));
    assert!(p.b.released);
    assert_eq!(p.a.release(p.now, ar), Err(Misuse::UnknownConnection));
    let frames = p.sent.len();
    p.run(SECOND);
    assert_eq!(p.sent.len(), frames, "nobody sends any more");
}

#[test]
fn the_connect_request_says_what_was_configured() {
    let mut p = pair();
    connected(&mut p, config());
    let ar = p.b.ar.clone().unwrap();
    assert_eq!((ar.properties.0, ar.activity_timeout_factor), (0x4000_0011, 200));
    assert_eq!((&ar.station_name[..], ar.initiator_mac), (&b"plc"[..], PLC));
    let [input, output] = &p.b.iocrs[..] else { panic!() };
    assert_eq!(
        (input.properties, input.frame_id, output.frame_id),
        (2, 0x8000, 0xFFFF)
    );
    assert_eq!(
        (input.send_clock_factor, input.reduction_ratio, input.data_length),
        (32, 16, 40)
    );
    assert_eq!(input.apis.iter().map(|a| a.api).collect::<Vec<_>>(), [0, 0x3A00]);
    let mut p = pair();
    connected(&mut p, ConnectConfig::legacy(config().modules, config().timing));
    assert_eq!(p.b.ar.clone().unwrap().properties.0, 0x11);
    assert_eq!((p.b.iocrs[0].properties, p.b.iocrs[0].frame_id), (1, 0xC000));
    let wrong = ConnectConfig {
        rt_class: RtClass::Class1,
        ..config()
    };
    assert_eq!(p.a.connect(p.now, target(), wrong), Err(Misuse::ClassAndStartUp));
}

#[test]
fn names_are_checked_before_connecting() {
    let mut p = pair();
    p.b.name = "other".into();
    p.a.connect(p.now, target(), config()).unwrap();
    assert_eq!(
        lost(&mut p, 3 * SECOND),
        LostCause::NoStation {
            name: "drive-1".into()
        }
    );
    p.b.name = "drive-1".into();
    p.b.device = (7, 7);
    p.a.connect(p.now, target(), config()).unwrap();
    assert_eq!(
        lost(&mut p, SECOND).to_string(),
        "\"drive-1\" is vendor 0x0007 device 0x0007, expected vendor 0x0105 device 0x0001"
    );
    p.b.device = (0x105, 1);
    let mut other_ip = target();
    other_ip.ip = ip(99);
    p.a.connect(p.now, other_ip.clone(), config()).unwrap();
    assert!(matches!(lost(&mut p, SECOND), LostCause::OtherIp { .. }));
    p.b.ip = IpSuite::NONE;
    p.a.connect(p.now, target(), config()).unwrap();
    assert!(matches!(lost(&mut p, SECOND), LostCause::NoIp { .. }));
    let set = ConnectConfig {
        resolve: Resolve::SetIp,
        ..config()
    };
    p.b.fault.set = Some(BlockError::InOperation);
    p.a.connect(p.now, other_ip.clone(), set.clone()).unwrap();
    assert!(matches!(
        lost(&mut p, SECOND),
        LostCause::SetIp(DcpError::Refused { .. })
    ));
    p.b.fault.set = None;
    let ar = p.a.connect(p.now, other_ip, set).unwrap();
    assert_eq!(event(&mut p, SECOND), Some(Event::Connected { ar, diff: None }));
    assert_eq!(p.b.ip, ip(99));
    assert_eq!(p.a.target(ar).unwrap().mac, Some(DRIVE));
}

#[test]
fn two_stations_of_one_name_are_told() {
    let mut p = pair();
    p.a.connect(p.now, target(), config()).unwrap();
    p.step(p.now + SECOND);
    let twin = MacAddress([2, 0x50, 0x4e, 0, 0, 3]);
    let answer = p
        .sent
        .iter()
        .find(|f| f[14..16] == [0xFE, 0xFF])
        .cloned()
        .expect("an answer");
    let mut from_twin = answer.clone();
    from_twin[6..12].copy_from_slice(&twin.0);
    p.a.handle_frame(p.now, &answer);
    p.a.handle_frame(p.now, &from_twin);
    let cause = lost(&mut p, SECOND);
    assert_eq!(
        cause,
        LostCause::SeveralStations {
            name: "drive-1".into(),
            macs: vec![DRIVE, twin]
        }
    );
}

#[test]
fn records_one_after_the_other() {
    let mut p = pair();
    let ar = connected(&mut p, config());
    let read = p.a.read(p.now, ar, IM0, 4096).unwrap();
    let long =
        p.a.read(p.now, ar, RecordAddress { index: 0x1000, ..IM0 }, 32768)
            .unwrap();
    let none =
        p.a.read(p.now, ar, RecordAddress { index: 5, ..IM0 }, 100)
            .unwrap();
    let write =
        p.a.write(p.now, ar, RecordAddress { index: 123, ..IM0 }, &[1, 2, 3])
            .unwrap();
    let records = [7, 9, 8].map(|index| {
        (
            RecordAddress { index, ..IM0 },
            vec![index as u8; usize::from(index)],
        )
    });
    let many = p.a.write_multiple(p.now, ar, &records).unwrap();
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::RecordDone {
            call: read,
            result: Ok(vec![0x20; 60])
        })
    );
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::RecordDone {
            call: long,
            result: Ok(vec![0x5A; 20_000])
        }),
        "fragmented"
    );
    let refused = ServiceError::Refused {
        what: "record read",
        status: PnioStatus::read(0xB0),
    };
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::RecordDone {
            call: none,
            result: Err(refused)
        })
    );
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::RecordDone {
            call: write,
            result: Ok(vec![])
        })
    );
    let results = vec![
        Some(PnioStatus::OK),
        Some(PnioStatus::write(0xB0)),
        Some(PnioStatus::OK),
    ];
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::WritesDone {
            call: many,
            result: Ok(results)
        })
    );
    assert_eq!(p.b.writes.len(), 4);
    assert_eq!(p.b.writes[3], (8, vec![8; 8]));
}

#[test]
fn parameter_jobs_wait_for_their_answer_in_turn() {
    let mut p = pair();
    let ar = connected(&mut p, config());
    p.b.not_ready = 3;
    let first = p.a.parameter_job(p.now, ar, CHANNEL, b"one").unwrap();
    let second = p.a.parameter_job(p.now, ar, CHANNEL, b"two").unwrap();
    let between = p.a.read(p.now, ar, IM0, 60).unwrap();
    let start = p.now;
    assert!(matches!(event(&mut p, SECOND), Some(Event::RecordDone { call, .. }) if call == between));
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::RecordDone {
            call: first,
            result: Ok(b"one!".to_vec())
        })
    );
    let took = p.now - start;
    assert!(
        took > Duration::from_millis(70) && took < Duration::from_millis(80),
        "{took:?}"
    );
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::RecordDone {
            call: second,
            result: Ok(b"two!".to_vec())
        })
    );
    p.b.not_ready = u32::MAX;
    let never = p.a.parameter_job(p.now, ar, CHANNEL, b"x").unwrap();
    let start = p.now;
    let Some(Event::RecordDone {
        call,
        result: Err(error),
    }) = event(&mut p, 20 * SECOND)
    else {
        panic!()
    };
    assert_eq!(call, never);
    assert!(matches!(error, ServiceError::NotReady { .. }), "{error}");
    let took = p.now - start;
    assert!(took >= 10 * SECOND && took < 11 * SECOND, "{took:?}");
}

#[test]
fn device_access_is_kept_alive() {
    let mut p = pair();
    let ar =
        p.a.connect_device_access(p.now, target(), Resolve::Check)
            .unwrap();
    assert_eq!(event(&mut p, SECOND), Some(Event::Connected { ar, diff: None }));
    let request = p.b.ar.clone().unwrap();
    assert_eq!((request.ar_type.0, request.properties.0), (6, 0x111));
    p.run(60 * SECOND);
    let signs = p.b.reads.iter().filter(|index| **index == 0xFBFF).count();
    assert!((16..=19).contains(&signs), "{signs}");
    let job = p.a.parameter_job(p.now, ar, CHANNEL, b"one").unwrap();
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::RecordDone {
            call: job,
            result: Ok(b"one!".to_vec())
        })
    );
    p.b.fault.forgot = true;
    let Some(Event::Lost { cause, .. }) = event(&mut p, 10 * SECOND) else {
        panic!()
    };
    assert!(
        matches!(cause, LostCause::Service(ServiceError::Refused { .. })),
        "{cause}"
    );
}

#[test]
fn implicit_reads_need_no_connection() {
    let mut p = pair();
    let mut here = target();
    assert_eq!(
        p.a.read_implicit(p.now, &here, IM0, 60),
        Err(Misuse::Incomplete("IP address"))
    );
    here.ip = ip(50);
    let calls: Vec<_> = (0..5)
        .map(|_| p.a.read_implicit(p.now, &here, IM0, 4096).unwrap())
        .collect();
    for call in calls {
        assert_eq!(
            event(&mut p, SECOND),
            Some(Event::RecordDone {
                call,
                result: Ok(vec![0x20; 60])
            })
        );
    }
    p.b.fault.mute = true;
    let call = p.a.read_implicit(p.now, &here, IM0, 4096).unwrap();
    let Some(Event::RecordDone {
        result: Err(error), ..
    }) = event(&mut p, 100 * SECOND)
    else {
        panic!("{call:?}")
    };
    assert_eq!(error, ServiceError::Timeout { what: "record read" });
}

#[test]
fn start_up_records_come_before_the_end_of_parameterization() {
    let record = |index| StartupRecord {
        api: 0,
        slot: 0,
        subslot: 1,
        index,
        data: vec![1, 2],
    };
    let with_records = ConnectConfig {
        records: vec![record(100), record(101)],
        ..config()
    };
    let mut p = pair();
    let ar = connected(&mut p, with_records.clone());
    assert_eq!(p.b.writes, [(100, vec![1, 2]), (101, vec![1, 2])]);
    // a plugged submodule gets its records again
    let plug = Notification {
        priority: Priority::Low,
        alarm_type: AlarmType::PLUG,
        api: 0,
        slot: 0,
        subslot: 1,
        module_ident: 1,
        submodule_ident: 1,
        specifier: AlarmSpecifier(0),
        usi: None,
        data: Cow::Borrowed(&[]),
    };
    p.b.alarms.as_mut().unwrap().raise(p.now, plug.clone()).unwrap();
    assert_eq!(event(&mut p, SECOND), Some(Event::Alarm { ar, alarm: plug }));
    p.run(SECOND);
    assert_eq!(p.b.writes.len(), 4);
    assert_eq!(p.a.phase(ar), Some(Phase::Data));
    let mut p = pair();
    p.b.fault.write = Some(PnioStatus::write(0xB1));
    p.a.connect(p.now, target(), with_records).unwrap();
    assert!(matches!(
        lost(&mut p, SECOND),
        LostCause::StartupRecord { index: 100, .. }
    ));
    p.run(SECOND);
    assert_eq!(p.b.aborted, Some(PnioStatus::aborted(0x17)));
}

#[test]
fn alarms_are_told_and_acknowledged_once() {
    let mut p = pair();
    let ar = connected(&mut p, config());
    let alarm = Notification {
        priority: Priority::High,
        alarm_type: AlarmType::PROCESS,
        api: 0x3A00,
        slot: 1,
        subslot: 1,
        module_ident: 8,
        submodule_ident: 9,
        specifier: AlarmSpecifier(0),
        usi: Some(3),
        data: Cow::Borrowed(&[1, 2]),
    };
    p.wire.duplication = 1000;
    for number in 0..5 {
        p.b.alarms.as_mut().unwrap().raise(p.now, alarm.clone()).unwrap();
        let expected = Notification {
            specifier: AlarmSpecifier(number),
            ..alarm.clone()
        };
        assert_eq!(event(&mut p, SECOND), Some(Event::Alarm { ar, alarm: expected }));
        p.run(Duration::from_millis(300));
    }
    assert_eq!(p.a.poll_event(), None);
    assert_eq!(p.a.phase(ar), Some(Phase::Data));
    p.b.alarms.as_mut().unwrap().abort(PnioStatus::aborted(0x1F));
    assert_eq!(
        lost(&mut p, SECOND),
        LostCause::AbortedByPeer(PnioStatus::aborted(0x1F))
    );
}

#[test]
fn the_watchdog_ends_it_and_the_device_is_told() {
    let mut p = pair();
    let ar = connected(&mut p, config());
    p.run(SECOND);
    p.b.fault.no_frames = true;
    let start = p.now;
    let cause = lost(&mut p, SECOND);
    assert_eq!(
        cause,
        LostCause::Watchdog {
            hold: Duration::from_millis(48)
        }
    );
    let took = p.now - start;
    assert!(
        took <= Duration::from_millis(48) && took > Duration::from_millis(31),
        "{took:?}"
    );
    p.run(Duration::from_millis(10));
    assert_eq!(p.b.aborted, Some(PnioStatus::aborted(5)));
    assert_eq!(p.a.input(ar, 1, 1).unwrap().1, Iops::BAD_CONTROLLER);
    // and again
    p.b.fault.no_frames = false;
    connected(&mut p, config());
    let silent = Fault {
        no_frames: true,
        ..Fault::default()
    };
    let mut p = pair();
    p.b.fault = silent;
    p.a.connect(p.now, target(), config()).unwrap();
    assert!(
        matches!(lost(&mut p, 10 * SECOND), LostCause::Watchdog { .. }),
        "no frame ever came"
    );
}

#[test]
fn a_device_that_is_early_late_or_never_ready() {
    let mut p = pair();
    p.b.fault.early_ready = true;
    connected(&mut p, config());
    let mut p = pair();
    p.b.fault.never_ready = true;
    let ready_limit = 30 * SECOND;
    p.a.connect(
        p.now,
        target(),
        ConnectConfig {
            ready_limit,
            ..config()
        },
    )
    .unwrap();
    assert_eq!(
        lost(&mut p, 40 * SECOND),
        LostCause::ReadyTimeout { limit: ready_limit }
    );
    p.run(SECOND);
    assert_eq!(p.b.aborted, Some(PnioStatus::aborted(0x28)));
    assert!(p.b.reads.contains(&0xFBFF), "signs of life while waiting");
}

#[test]
fn differences_are_reported() {
    let module = DiffModule {
        api: 0x3A00,
        slot: 1,
        ident: 5,
        state: ModuleState::WRONG,
        submodules: vec![],
    };
    let diff = Some(ModuleDiff {
        modules: vec![module],
    });
    let mut p = pair();
    p.b.diff.clone_from(&diff);
    let ar = p.a.connect(p.now, target(), config()).unwrap();
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::Connected {
            ar,
            diff: diff.clone()
        })
    );
    assert_eq!(event(&mut p, SECOND), Some(Event::Ready { ar, diff }));
}

#[test]
fn a_refused_or_unanswered_connect() {
    let mut p = pair();
    let status = PnioStatus::connect(0x01, 0x04);
    p.b.fault.connect = Some(status);
    p.a.connect(p.now, target(), config()).unwrap();
    let refused = ServiceError::Refused {
        what: "connect",
        status,
    };
    assert_eq!(lost(&mut p, SECOND), LostCause::Service(refused));
    p.b.fault = Fault {
        mute: true,
        ..Fault::default()
    };
    let start = p.now;
    let ar = p.a.connect(p.now, target(), config()).unwrap();
    assert_eq!(p.a.read(p.now, ar, IM0, 60), Err(Misuse::NotOpenYet));
    let cause = lost(&mut p, 100 * SECOND);
    assert_eq!(
        cause,
        LostCause::Service(ServiceError::Timeout { what: "connect" })
    );
    assert!(p.now - start > 5 * SECOND);
}

#[test]
fn every_wrong_octet_and_every_cut_of_every_answer_ends_clearly() {
    for at in 0..110 {
        for fault in [
            Fault {
                octet: Some(at),
                ..Fault::default()
            },
            Fault {
                cut: Some(at),
                ..Fault::default()
            },
        ] {
            let mut p = pair();
            p.b.fault = fault;
            let ar = p.a.connect(p.now, target(), config()).unwrap();
            let mut ended = false;
            let limit = p.now + 10 * SECOND;
            while p.step(limit) {
                while let Some(event) = p.a.poll_event() {
                    ended |= matches!(event, Event::Lost { .. } | Event::Running { .. });
                }
            }
            assert!(ended, "{fault:?} {:?}", p.a.phase(ar));
        }
    }
}

#[test]
fn calls_end_with_the_connection() {
    let mut p = pair();
    let ar = connected(&mut p, config());
    p.b.fault.mute = true;
    let one = p.a.read(p.now, ar, IM0, 60).unwrap();
    let two = p.a.write(p.now, ar, IM0, &[1]).unwrap();
    let job = p.a.parameter_job(p.now, ar, CHANNEL, b"x").unwrap();
    p.run(Duration::from_millis(100));
    p.a.abort(p.now, ar).unwrap();
    let mut closed = vec![];
    let mut last = None;
    while let Some(event) = p.a.poll_event() {
        match event {
            Event::RecordDone {
                call,
                result: Err(ServiceError::Closed { .. }),
            } => closed.push(call),
            other => last = Some(other),
        }
    }
    assert_eq!(closed, [one, two, job]);
    assert_eq!(
        last,
        Some(Event::Lost {
            ar,
            cause: LostCause::Aborted
        })
    );
    p.run(SECOND);
    assert_eq!(p.b.aborted, Some(PnioStatus::aborted(0x0D)));
    assert_eq!(p.a.set_output(ar, 1, 1, &[0; 4]), Err(Misuse::UnknownConnection));
}

#[test]
fn a_release_ends_even_without_answer() {
    let mut p = pair();
    let ar = connected(&mut p, config());
    p.b.fault.mute = true;
    p.a.release(p.now, ar).unwrap();
    assert_eq!(event(&mut p, 10 * SECOND), Some(Event::Released { ar }));
    let again = connected_fresh(&mut p);
    assert_ne!(ar, again);
    assert_eq!(p.a.phase(ar), None, "its place is taken");
}

fn connected_fresh(p: &mut Pair<Controller, Fake>) -> ArId {
    p.b.fault = Fault::default();
    connected(p, config())
}

#[test]
fn garbage_does_not_disturb_a_running_connection() {
    let mut p = pair();
    let ar = connected(&mut p, config());
    let mut seed = 1u64;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as u8
    };
    let source = core::net::SocketAddrV4::new([192, 168, 77, 66].into(), 50000);
    for round in 0..4000usize {
        // half noise, half a real frame with a few octets changed, from somebody else
        let mut bytes: Vec<u8> = match p.sent.get(round % p.sent.len()) {
            Some(frame) if round % 2 == 0 => frame.clone(),
            _ => (0..usize::from(random()) + 20).map(|_| random()).collect(),
        };
        for _ in 0..3 {
            let at = usize::from(random()) % bytes.len();
            bytes[at] = random();
        }
        bytes[..6].copy_from_slice(&PLC.0);
        bytes[6..12].copy_from_slice(&[2, 9, 9, 9, 9, 9]);
        let now = p.now;
        p.a.handle_frame(now, &bytes);
        p.a.handle_datagram(now, source, RPC_PORT, &bytes);
        p.a.handle_datagram(now, source, 0xC000, &bytes);
        if round % 10 == 0 {
            p.run(Duration::from_millis(2));
        }
    }
    p.run(SECOND);
    assert_eq!(p.a.phase(ar), Some(Phase::Data));
    assert_eq!(p.a.statistics(ar).unwrap().missed, 0);
    let unexpected = |e: &Event| !matches!(e, Event::Hello { .. });
    while let Some(event) = p.a.poll_event() {
        assert!(!unexpected(&event), "{event:?}");
    }
}

#[test]
fn start_up_survives_loss_and_duplication() {
    for seed in 0..60 {
        let mut p = pair();
        p.wire = Pair::new(
            Controller::new(ControllerConfig::new(PLC, ip(11), "plc", 7)),
            Fake::new(DRIVE, ip(50), "d"),
            seed,
        )
        .wire;
        p.wire.loss = 100;
        p.wire.duplication = 100;
        p.wire.reordering = 100;
        let slow = ConnectConfig {
            data_hold_factor: 30,
            watchdog_factor: 30,
            ..config()
        };
        let ar = p.a.connect(p.now, target(), slow).unwrap();
        let end = p.until(60 * SECOND, |p| match p.a.poll_event() {
            Some(Event::Running { .. }) => Some(true),
            Some(Event::Lost { .. }) => Some(false),
            _ => None,
        });
        let end = end.unwrap_or_else(|| panic!("seed {seed}: neither running nor lost, {:?}", p.a.phase(ar)));
        if end {
            let job = p.a.parameter_job(p.now, ar, CHANNEL, b"one").unwrap();
            let answer = p.until(30 * SECOND, |p| match p.a.poll_event() {
                Some(Event::RecordDone { call, result }) if call == job => Some(result),
                _ => None,
            });
            assert!(answer.is_some(), "seed {seed}");
        }
    }
}
