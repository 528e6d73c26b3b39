//! Wrong answers, garbage, loss.

use super::*;

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
        LostCause::Service(ServiceError::Timeout {
            what: "connect",
            path: rpc::PathCount::default()
        })
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
        // half noise, half a real frame with a few octets changed, from another station
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
