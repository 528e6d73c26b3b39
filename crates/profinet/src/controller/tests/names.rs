//! Discovery, naming, and the checks before connecting.

use super::*;

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
    assert_eq!(
        event(&mut p, SECOND),
        Some(Event::IdentifyDone {
            id,
            count: 1,
            more: false
        })
    );
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
    p.a.dcp_get(p.now, DRIVE, &[DcpOption::ALIAS, DcpOption::NAME])
        .unwrap();
    let Some(Event::DcpDone {
        result: Ok(DcpReply::Values(station)),
        ..
    }) = event(&mut p, SECOND)
    else {
        panic!()
    };
    assert_eq!((station.name.as_str(), station.alias.as_str()), ("akd-7", ""));
    p.a.dcp_get(p.now, DRIVE, &[DcpOption::ALIAS]).unwrap();
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
fn two_stations_of_one_name_are_reported() {
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
fn stations_of_one_name_are_bounded() {
    let mut p = pair();
    p.a.connect(p.now, target(), config()).unwrap();
    p.step(p.now + SECOND);
    let mut answer = p
        .sent
        .iter()
        .find(|f| f[14..16] == [0xFE, 0xFF])
        .cloned()
        .unwrap();
    for number in 100..200 {
        answer[11] = number;
        p.a.handle_frame(p.now, &answer);
    }
    let LostCause::SeveralStations { macs, .. } = lost(&mut p, SECOND) else {
        panic!("one station")
    };
    let first = (100..116).map(|number| MacAddress([2, 0x50, 0x4e, 0, 0, number]));
    assert_eq!(macs, first.collect::<Vec<_>>());
}

#[test]
fn a_running_connection_needs_none_of_the_requests_that_can_be_open() {
    let mut p = pair();
    connected(&mut p, config());
    // its own lookup would go on for another second
    let open = (0..2_000)
        .take_while(|_| p.a.identify(p.now, Filter::all()).is_ok())
        .count();
    assert_eq!(open, 1024);
}
