//! Controller and device of this crate with each other.

use alloc::string::ToString;
use alloc::vec;
use alloc::vec::Vec;
use core::time::Duration;

use super::Pair;
use super::station::{DRIVE, PLC, Station, config, ip, target};
use crate::controller::{
    ConnectConfig, Controller, ControllerConfig, DcpReply, Event, Filter, LostCause, RecordAddress, Resolve,
    ServiceError,
};
use crate::device;
use crate::wire::PnioStatus;
use crate::wire::alarm::{AlarmType, ChannelDiagnosis, DiagnosisItem};
use crate::wire::rt::Iops;
use crate::{Endpoint, IpSuite};

const SECOND: Duration = Duration::from_secs(1);

type Both = Pair<Controller, Station>;

fn pair() -> Both {
    let controller = Controller::new(ControllerConfig::new(PLC, ip(11), "plc", 7));
    Pair::new(controller, Station::new("drive-1", ip(50)), 1)
}

fn event(p: &mut Both, limit: Duration) -> Option<Event> {
    p.until(limit, |p| p.a.poll_event())
}

fn connected(p: &mut Both, config: ConnectConfig) -> crate::controller::ArId {
    let ar = p.a.connect(p.now, target(), config).unwrap();
    assert_eq!(event(p, SECOND), Some(Event::Connected { ar, diff: None }));
    assert_eq!(event(p, SECOND), Some(Event::Ready { ar, diff: None }));
    assert_eq!(event(p, SECOND), Some(Event::Running { ar }));
    ar
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
fn the_whole_way_at_every_interval_and_in_both_start_ups() {
    for power in 0..10 {
        for legacy in [false, true] {
            let mut p = pair();
            let mut config = config(1 << power);
            if legacy {
                config = ConnectConfig::legacy(config.modules, config.timing);
            }
            let ar = p.a.connect(p.now, target(), config).unwrap();
            let running = p.until(5 * SECOND, |p| {
                matches!(p.a.poll_event()?, Event::Running { .. }).then_some(())
            });
            assert!(
                running.is_some(),
                "{power} {legacy} {:?} {:?}",
                p.a.phase(ar),
                p.b.events
            );
            p.a.set_output(ar, 1, 1, &[1, 2, 3, 4]).unwrap();
            let cycles = Duration::from_millis(10 << power);
            p.run(cycles);
            assert_eq!(p.a.input(ar, 1, 1), Some((&[1, 2, 3, 4][..], Iops::GOOD)));
            assert_eq!(p.a.output_consumed(ar, 1, 1), Some(Iops::GOOD));
            let (own, other) = (p.a.statistics(ar).unwrap(), p.b.device.statistics().unwrap());
            assert_eq!((own.missed, other.missed), (0, 0));
            assert!(own.received >= 10 && other.received >= 10);
            p.a.release(p.now, ar).unwrap();
            let end = p.until(SECOND, |p| p.a.poll_event());
            assert_eq!(end, Some(Event::Released { ar }));
            assert!(
                p.b.events
                    .iter()
                    .any(|e| matches!(e, device::Event::Disconnected { .. }))
            );
        }
    }
}

#[test]
fn a_record_written_right_after_start_up_is_accepted() {
    let mut p = pair();
    let ar = p.a.connect(p.now, target(), config(512)).unwrap();
    assert_eq!(event(&mut p, SECOND), Some(Event::Connected { ar, diff: None }));
    assert_eq!(event(&mut p, SECOND), Some(Event::Ready { ar, diff: None }));
    // the device waits for valid outputs for up to another half second
    let write = p.a.write(p.now, ar, CHANNEL, b"record").unwrap();
    let many =
        p.a.write_multiple(p.now, ar, &[(CHANNEL, b"other".to_vec())])
            .unwrap();
    let job = p.a.parameter_job(p.now, ar, CHANNEL, b"job").unwrap();
    let mut done = vec![];
    p.until(2 * SECOND, |p| {
        match p.a.poll_event()? {
            Event::RecordDone { call, result } => done.push((call, result)),
            Event::WritesDone { call, result } => {
                assert_eq!((call, result), (many, Ok(vec![Some(PnioStatus::OK)])));
            }
            _ => {}
        }
        (done.len() == 2).then_some(())
    });
    assert_eq!(done, [(write, Ok(vec![])), (job, Ok(b"job".to_vec()))]);
}

/// The record length given by a device description, both ways.
#[test]
fn the_longest_record_of_a_description_goes_both_ways() {
    let mut p = pair();
    let ar = connected(&mut p, config(512));
    let record: Vec<u8> = (0..4068_u32).map(|n| (n % 251) as u8).collect();
    let call = p.a.parameter_job(p.now, ar, CHANNEL, &record).unwrap();
    let done = event(&mut p, 5 * SECOND);
    assert_eq!(
        done,
        Some(Event::RecordDone {
            call,
            result: Ok(record)
        })
    );
}

#[test]
fn a_new_device_gets_name_and_address_and_is_used() {
    let mut p = pair();
    p.b = Station::new("", IpSuite::NONE);
    p.a.identify(p.now, Filter::all()).unwrap();
    let Some(Event::Identified { station, .. }) = event(&mut p, 2 * SECOND) else {
        panic!()
    };
    assert_eq!(
        (station.mac, station.name.as_str(), station.ip),
        (DRIVE, "", IpSuite::NONE)
    );
    assert_eq!(station.station_type, "AKD");
    let Some(Event::IdentifyDone { count: 1, .. }) = event(&mut p, 2 * SECOND) else {
        panic!()
    };
    let id = p.a.dcp_set_name(p.now, DRIVE, "drive-1", true).unwrap();
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::DcpDone {
            id,
            result: Ok(DcpReply::Done)
        })
    );
    let mut wanted = target();
    wanted.ip = ip(77);
    let ar =
        p.a.connect(
            p.now,
            wanted,
            ConnectConfig {
                resolve: Resolve::SetIp,
                ..config(16)
            },
        )
        .unwrap();
    assert_eq!(
        event(&mut p, 3 * SECOND),
        Some(Event::Connected { ar, diff: None })
    );
    assert_eq!(p.b.ip().address, ip(77).address);
    assert_eq!(
        (p.b.device.name(), p.a.target(ar).unwrap().mac),
        ("drive-1", Some(DRIVE))
    );
}

#[test]
fn records_and_parameter_jobs_beside_cyclic_data() {
    let mut p = pair();
    let ar = connected(&mut p, config(1));
    let call = p.a.read(p.now, ar, IM0, 4096).unwrap();
    let Some(Event::RecordDone { result: Ok(im0), .. }) = event(&mut p, SECOND) else {
        panic!("{call:?}")
    };
    assert_eq!(
        (im0.len(), &im0[..2], &im0[6..8]),
        (60, &[0, 0x20][..], &[0x01, 0x05][..])
    );
    p.b.not_ready = 2;
    let job =
        p.a.parameter_job(p.now, ar, CHANNEL, &[1, 1, 1, 1, 0x10, 1, 3, 0xC4, 0, 0])
            .unwrap();
    let answer = event(&mut p, SECOND);
    assert_eq!(
        answer,
        Some(Event::RecordDone {
            call: job,
            result: Ok(vec![1, 1, 1, 1, 0x10, 1, 3, 0xC4, 0, 0])
        })
    );
    // a tool beside the controller, twice
    let mut here = target();
    here.ip = ip(50);
    for _ in 0..2 {
        let tool =
            p.a.connect_device_access(p.now, here.clone(), Resolve::Trust)
                .unwrap();
        assert_eq!(
            event(&mut p, SECOND),
            Some(Event::Connected { ar: tool, diff: None })
        );
        let job = p.a.parameter_job(p.now, tool, CHANNEL, b"tool").unwrap();
        assert_eq!(
            event(&mut p, SECOND),
            Some(Event::RecordDone {
                call: job,
                result: Ok(b"tool".to_vec())
            })
        );
    }
    let implicit = p.a.read_implicit(p.now, &here, IM0, 4096).unwrap();
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::RecordDone {
            call: implicit,
            result: Ok(im0)
        })
    );
    let none =
        p.a.read(p.now, ar, RecordAddress { index: 0xAFFE, ..IM0 }, 60)
            .unwrap();
    let Some(Event::RecordDone {
        call,
        result: Err(error),
    }) = event(&mut p, SECOND)
    else {
        panic!()
    };
    assert_eq!(
        (call, error.to_string().as_str()),
        (none, "record read: DE 80 B0 00: read refused, invalid index")
    );
    p.run(60 * SECOND);
    assert_eq!(
        p.a.poll_event(),
        None,
        "the tools' connections are kept alive, nothing is lost"
    );
    assert_eq!(p.a.statistics(ar).unwrap().missed, 0);
    let (sent, skipped) = p.a.sent(ar).unwrap();
    assert!(sent >= 60_000 && skipped == 0);
}

#[test]
fn a_broken_link_ends_it_on_both_sides_and_both_recover() {
    let mut p = pair();
    connected(&mut p, config(16));
    p.run(SECOND);
    p.b.events.clear();
    p.wire.cut = true;
    let Some(Event::Lost { cause, .. }) = event(&mut p, SECOND) else {
        panic!()
    };
    assert_eq!(
        cause,
        LostCause::Watchdog {
            hold: Duration::from_millis(48)
        }
    );
    p.run(SECOND);
    let gone = p.b.events.iter().find_map(|e| match e {
        device::Event::Disconnected { cause, .. } => Some(*cause),
        _ => None,
    });
    assert_eq!(gone, Some(PnioStatus::aborted(5)));
    p.wire.cut = false;
    connected(&mut p, config(16));
}

#[test]
fn a_restarted_controller_is_accepted_at_once() {
    let mut p = pair();
    connected(&mut p, config(512));
    // the program is killed and started again: nothing was released
    p.a = Controller::new(ControllerConfig::new(PLC, ip(11), "plc", 8));
    let start = p.now;
    p.a.connect(p.now, target(), config(16)).unwrap();
    let ready = p.until(SECOND, |p| {
        matches!(p.a.poll_event()?, Event::Running { .. }).then_some(())
    });
    assert!(ready.is_some(), "{:?}", p.b.events);
    assert!(p.now - start < SECOND);
}

#[test]
fn a_wrong_module_is_reported_not_refused() {
    let mut p = pair();
    let mut wrong = config(16);
    wrong.modules[1].ident = 0x99;
    let ar = p.a.connect(p.now, target(), wrong).unwrap();
    let Some(Event::Connected { diff: Some(diff), .. }) = event(&mut p, SECOND) else {
        panic!()
    };
    assert_eq!((diff.modules[0].slot, diff.modules[0].ident), (1, 0x10));
    let _ = p.until(SECOND, |p| {
        matches!(p.a.poll_event()?, Event::Running { .. }).then_some(())
    });
    assert_eq!(p.a.input(ar, 1, 1).map(|i| i.1.is_good()), Some(false));
    assert_eq!(p.a.input(ar, 0, 1).map(|i| i.1.is_good()), Some(true));
}

#[test]
fn stop_and_abort() {
    let mut p = pair();
    let ar = connected(&mut p, config(16));
    p.run(SECOND);
    p.b.events.clear();
    p.a.set_run(ar, false).unwrap();
    p.run(SECOND);
    p.a.set_run(ar, true).unwrap();
    p.run(SECOND);
    let runs: Vec<_> =
        p.b.events
            .iter()
            .filter_map(|e| match e {
                device::Event::ProviderState { run, .. } => Some(*run),
                _ => None,
            })
            .collect();
    assert_eq!(runs, [false, true]);
    let key = p.b.device.controller().unwrap();
    p.b.device.abort(p.now, key, 0xFF);
    let Some(Event::Lost { cause, .. }) = event(&mut p, SECOND) else {
        panic!()
    };
    assert_eq!(cause, LostCause::AbortedByPeer(PnioStatus::aborted(0xFF)));
}

#[test]
fn alarms_and_diagnosis_reach_the_controller_and_are_acknowledged() {
    let mut p = pair();
    let patient = ConnectConfig {
        data_hold_factor: 100,
        watchdog_factor: 100,
        rta_retries: 15,
        ..config(16)
    };
    let ar = connected(&mut p, patient);
    p.run(SECOND);
    p.b.events.clear();
    p.wire.loss = 200;
    for number in 0..20u8 {
        p.b.device
            .raise_alarm(p.now, 1, 1, AlarmType::PROCESS, Some(7), &[number])
            .unwrap();
        let Some(Event::Alarm { ar: of, alarm }) = event(&mut p, 2 * SECOND) else {
            panic!("{number}")
        };
        assert_eq!(
            (of, alarm.alarm_type, &alarm.data[..]),
            (ar, AlarmType::PROCESS, &[number][..])
        );
        p.run(2 * SECOND);
    }
    p.wire.loss = 0;
    p.run(SECOND);
    let acknowledged = |e: &&device::Event| matches!(e, device::Event::AlarmAcknowledged { .. });
    assert_eq!(p.b.events.iter().filter(acknowledged).count(), 20);
    let fault = ChannelDiagnosis {
        channel: ChannelDiagnosis::WHOLE_SUBMODULE,
        properties: 0,
        error_type: 5,
        extended: None,
        qualifier: None,
    };
    p.b.device.set_diagnosis(p.now, 1, 1, fault, true);
    let mut seen = vec![];
    p.until(SECOND, |p| {
        seen.extend(p.a.poll_event());
        (seen.len() == 2).then_some(())
    });
    let problem = Event::ProviderState {
        ar,
        run: true,
        problem: true,
    };
    assert!(seen.contains(&problem), "{seen:?}");
    let alarm = seen.iter().find_map(|e| match e {
        Event::Alarm { alarm, .. } => Some(alarm),
        _ => None,
    });
    let items: Vec<_> = alarm.unwrap().items().map(Result::unwrap).collect();
    let expected = ChannelDiagnosis {
        properties: ChannelDiagnosis::APPEARS,
        ..fault
    };
    assert_eq!(items, [DiagnosisItem::Channel(expected)]);
}

#[test]
fn a_name_change_by_another_tool_ends_the_connection() {
    let mut p = pair();
    connected(&mut p, config(16));
    p.run(5 * SECOND);
    p.a.dcp_set_name(p.now, DRIVE, "other", true).unwrap();
    let mut seen = vec![];
    p.until(SECOND, |p| {
        seen.extend(p.a.poll_event());
        (seen.len() == 2).then_some(())
    });
    assert!(
        seen.iter()
            .any(|e| matches!(e, Event::DcpDone { result: Ok(_), .. })),
        "{seen:?}"
    );
    let cause = LostCause::AbortedByPeer(PnioStatus::aborted(0x1F));
    assert!(
        seen.iter()
            .any(|e| matches!(e, Event::Lost { cause: c, .. } if *c == cause)),
        "{seen:?}"
    );
}

#[test]
fn ten_minutes_with_loss_duplication_and_reordering() {
    for seed in [1, 2, 3] {
        let mut p = pair();
        p.wire = Pair::new(
            Controller::new(ControllerConfig::new(PLC, ip(11), "plc", seed)),
            Station::new("drive-1", ip(50)),
            seed,
        )
        .wire;
        p.wire.loss = 10;
        p.wire.duplication = 10;
        p.wire.reordering = 10;
        // 1 % loss takes three frames in a row about once a million: seven intervals make it never
        let patient = ConnectConfig {
            data_hold_factor: 7,
            watchdog_factor: 7,
            ..config(16)
        };
        let ar = p.a.connect(p.now, target(), patient).unwrap();
        let running = p.until(60 * SECOND, |p| {
            matches!(p.a.poll_event()?, Event::Running { .. }).then_some(())
        });
        assert!(running.is_some(), "seed {seed}");
        let end = p.now + 600 * SECOND;
        let (mut jobs, mut late) = (0, 0);
        while p.now < end {
            p.b.not_ready = jobs % 4;
            let job =
                p.a.parameter_job(p.now, ar, CHANNEL, &jobs.to_be_bytes())
                    .unwrap();
            let result = p.until(30 * SECOND, |p| match p.a.poll_event()? {
                Event::RecordDone { call, result } if call == job => Some(result),
                other => panic!("seed {seed}: {other:?}"),
            });
            match result.expect("a job ends") {
                Ok(answer) => assert_eq!(answer, jobs.to_be_bytes(), "seed {seed}"),
                Err(ServiceError::Timeout { .. } | ServiceError::NotReady { .. }) => late += 1,
                Err(other) => panic!("seed {seed}: {other}"),
            }
            jobs += 1;
            p.run(Duration::from_millis(200));
        }
        assert!(
            jobs > 1000 && late * 1000 < jobs,
            "seed {seed}: {jobs} jobs, {late} in vain"
        );
        let statistics = p.a.statistics(ar).unwrap();
        assert!(
            statistics.missed > 100 && statistics.received > 36_000,
            "{statistics:?}"
        );
    }
}
