//! Records, parameter jobs, device access.

use super::*;

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
    assert_eq!(
        error,
        ServiceError::Timeout {
            what: "record read",
            path: rpc::PathCount::default()
        }
    );
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
fn a_flood_of_plug_alarms_leads_to_a_bounded_number_of_records() {
    let record = |index| StartupRecord {
        api: 0,
        slot: 0,
        subslot: 1,
        index,
        data: vec![1, 2],
    };
    let with_records = ConnectConfig {
        records: (0..100).map(record).collect(),
        ..config()
    };
    let mut p = pair();
    let ar = connected(&mut p, with_records);
    p.b.fault.mute = true;
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
    for _ in 0..50 {
        p.b.alarms.as_mut().unwrap().raise(p.now, plug.clone()).unwrap();
        assert!(matches!(event(&mut p, SECOND), Some(Event::Alarm { .. })));
    }
    // ten times the records and the end of them; one of these is under way
    assert_eq!(p.a.ars[0].ops.len(), 10 * 101 - 1);
    assert_eq!(p.a.phase(ar), Some(Phase::Data));
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

/// For a device that accepts no connection for records alone: nothing valid is ever sent to it.
#[test]
fn a_connection_for_records_holds_the_start_up_and_never_sends_valid_outputs() {
    let mut p = pair();
    let modules = config().modules;
    let timing = Timing::for_interval(Duration::from_millis(64)).unwrap();
    let records = ConnectConfig::for_records(modules, timing);
    let ar = p.a.connect(p.now, target(), records).unwrap();
    assert_eq!(event(&mut p, SECOND), Some(Event::Connected { ar, diff: None }));
    let request = p.b.ar.clone().unwrap();
    assert_eq!(p.a.ar_uuid(ar), Some(request.ar_uuid));
    let own = Uuid::object(1, 1, 0xFFFF);
    assert_ne!(
        request.initiator_object, own,
        "another initiator than a controller of this program"
    );
    let job = p.a.parameter_job(p.now, ar, CHANNEL, b"one").unwrap();
    let done = |call, text: &[u8]| {
        Some(Event::RecordDone {
            call,
            result: Ok(text.to_vec()),
        })
    };
    assert_eq!(event(&mut p, SECOND), done(job, b"one!"));
    // no PrmEnd, kept alive by reads
    p.run(60 * SECOND);
    assert_eq!(p.a.phase(ar), Some(Phase::Parameterize));
    assert!(p.b.reads.iter().filter(|index| **index == 0xFBFF).count() > 5);
    // a device that expects data first receives it, but not one valid word
    p.a.end_start_up(p.now, ar).unwrap();
    assert_eq!(event(&mut p, SECOND), Some(Event::Ready { ar, diff: None }));
    assert_eq!(event(&mut p, SECOND), Some(Event::Running { ar }));
    assert_eq!(p.a.end_start_up(p.now, ar), Err(Misuse::NotOpenYet));
    p.run(SECOND);
    assert!(p.b.last_output.len() > 10);
    for (status, iops, data) in &p.b.last_output {
        assert!(!status.is_run() && !iops.is_good(), "{status:?} {iops:?}");
        assert_eq!(data, &[0; 4]);
    }
    let job = p.a.parameter_job(p.now, ar, CHANNEL, b"two").unwrap();
    assert_eq!(event(&mut p, SECOND), done(job, b"two!"));
    p.a.release(p.now, ar).unwrap();
    assert_eq!(event(&mut p, SECOND), Some(Event::Released { ar }));
    assert!(p.b.released && p.b.aborted.is_none());
}

#[test]
fn a_job_may_have_a_time_of_its_own() {
    let mut p = pair();
    let ar = connected(&mut p, config());
    p.b.not_ready = u32::MAX;
    let begin = p.now;
    let limit = Duration::from_millis(500);
    p.a.parameter_job_within(p.now, ar, CHANNEL, b"x", limit).unwrap();
    let Some(Event::RecordDone { result, .. }) = event(&mut p, 20 * SECOND) else {
        panic!("no end")
    };
    assert!(matches!(result, Err(ServiceError::NotReady { .. })), "{result:?}");
    assert!(p.now - begin < SECOND);
}
