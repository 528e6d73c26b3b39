//! Whatever comes, the device neither panics nor hangs nor loses its controller.

use proptest::collection::vec;
use proptest::prelude::*;

use super::*;

/// Valid requests of every kind, to be damaged.
fn requests(rig: &mut Rig) -> Vec<Vec<u8>> {
    let wish = Wish::controller(2);
    let tool = Wish::tool(3);
    let mut all = vec![
        rig.request(operation::CONNECT, &wish.blocks()),
        rig.request(operation::CONNECT, &tool.blocks()),
        rig.write_pdu(Uuid([1; 16]), DRIVE_API, (1, 1, 0xB02E), b"0123456789"),
        rig.write_pdu(Uuid([1; 16]), 0, (0, 1, 0xAFF1), &[0; 60]),
    ];
    for (number, block_type, command) in [
        (operation::RELEASE, BlockType::RELEASE, ControlCommand::RELEASE),
        (operation::CONTROL, BlockType::PRM_END, ControlCommand::PRM_END),
    ] {
        let mut blocks = Vec::new();
        ControlBlock::new(block_type, Uuid([1; 16]), 5, command).encode(&mut blocks);
        all.push(rig.request(number, &blocks));
    }
    let mut inner = Vec::new();
    write_request(Uuid([1; 16]), DRIVE_API, (1, 1, 7), b"abcd").encode(&mut inner);
    inner.extend_from_slice(b"abcd");
    let mut blocks = Vec::new();
    WriteRequest::multiple(1, Uuid([1; 16]), inner.len() as u32).encode(&mut blocks);
    blocks.extend_from_slice(&inner);
    all.push(rig.request(operation::WRITE, &blocks));
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_datagram_is_survived(bytes in vec(any::<u8>(), 0..300), port in prop_oneof![Just(RPC_PORT), Just(CLIENT_PORT)]) {
        let mut rig = Rig::new(config());
        rig.exchange(&Wish::controller(1));
        let source = SocketAddrV4::new(STRANGER, 1);
        rig.device.handle_datagram(rig.now, source, port, &bytes);
        let mut header = rig.request(operation::WRITE, &[]);
        header.extend_from_slice(&bytes);
        let length = (header.len() - 80) as u16;
        header[74..76].copy_from_slice(&length.to_be_bytes());
        rig.device.handle_datagram(rig.now, source, port, &header);
        rig.drain();
        prop_assert!(rig.device.is_exchanging());
    }

    #[test]
    fn damaged_requests_of_another_host_never_end_the_ar(
        which in 0usize..7, flips in vec((any::<u16>(), 0u8..8), 1..4), cut in proptest::option::of(any::<u16>()),
    ) {
        let mut rig = Rig::new(config());
        let mut provider = rig.exchange(&Wish::controller(1));
        let mut pdu = requests(&mut rig).swap_remove(which);
        for (at, bit) in flips {
            let at = usize::from(at) % pdu.len();
            pdu[at] ^= 1 << bit;
        }
        if let Some(cut) = cut {
            // the header has the length of the shorter body
            let end = 80 + usize::from(cut) % (pdu.len() - 80);
            pdu.truncate(end);
            pdu[74..76].copy_from_slice(&((end - 80) as u16).to_be_bytes());
        }
        rig.device.handle_datagram(rig.now, SocketAddrV4::new(STRANGER, 9), RPC_PORT, &pdu);
        rig.drain();
        rig.output(&mut provider);
        prop_assert!(rig.device.is_exchanging());
        prop_assert!(disconnected(&rig.events()).is_none());
    }

    #[test]
    fn damaged_requests_of_the_controller_are_survived(
        which in 0usize..7, flips in vec((any::<u16>(), 0u8..8), 1..4),
    ) {
        let mut rig = Rig::new(config());
        rig.connect(&Wish::controller(1)).unwrap();
        let mut pdu = requests(&mut rig).swap_remove(which);
        for (at, bit) in flips {
            let at = 80 + usize::from(at) % (pdu.len() - 80);
            pdu[at] ^= 1 << bit;
        }
        rig.send(&pdu);
        rig.pass(40_000);
    }

    #[test]
    fn any_frame_is_survived(
        bytes in vec(any::<u8>(), 0..200),
        id in prop_oneof![
            Just(0x8000u16), Just(0xFC01), Just(0xFE01), Just(0xFEFD), Just(0xFEFE), Just(0xFEFF), any::<u16>(),
        ],
        own in any::<bool>(),
    ) {
        let mut rig = Rig::new(config());
        rig.exchange(&Wish::controller(1));
        let mut frame = Vec::new();
        frame.extend_from_slice(if id == 0xFEFE { &DCP_IDENTIFY.0 } else { &DEVICE.0 });
        frame.extend_from_slice(if own { &CONTROLLER.0 } else { &[2, 2, 2, 2, 2, 2] });
        frame.extend_from_slice(&[0x88, 0x92]);
        frame.extend_from_slice(&id.to_be_bytes());
        frame.extend_from_slice(&bytes);
        for end in 0..=frame.len() {
            rig.device.handle_frame(rig.now, &frame[..end]);
        }
        rig.drain();
        prop_assert!(own || rig.device.is_exchanging());
        rig.pass(1000);
    }
}

#[test]
fn a_flood_of_record_accesses_is_bounded() {
    let mut rig = Rig::new(config());
    let wish = Wish::tool(1);
    rig.connect(&wish).unwrap();
    for _ in 0..500 {
        let pdu = rig.write_pdu(wish.ar.ar_uuid, DRIVE_API, (1, 1, 5), &[0; 100]);
        rig.send(&pdu);
        rig.drain();
    }
    assert!(rig.device.jobs.len() <= 16);
    assert!(rig.events().len() <= 17);
    rig.pass(100_000);
    assert!(rig.device.jobs.is_empty());
}

#[test]
fn frames_and_events_that_nobody_fetches_are_bounded() {
    let mut rig = Rig::new(config());
    let _ = rig.events();
    for _ in 0..1000 {
        rig.device.send_frame(vec![0; 60]);
        rig.device.event(Event::Signal);
    }
    assert_eq!(rig.device.frames.len(), 16);
    assert_eq!(rig.events().len(), 256);
}
