//! The controller against a device that can be made to misbehave.

mod fake;
mod hostile;
mod names;
mod records;

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
    assert_eq!(p.a.output_consumed(ar, 1, 1), Some(Iops::GOOD));
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
    assert_eq!(p.sent.len(), frames, "no station sends any more");
}

#[test]
fn the_connect_request_has_the_configuration() {
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
fn alarms_are_reported_and_acknowledged_once() {
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
fn the_watchdog_ends_the_connection_and_the_device_is_notified() {
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
