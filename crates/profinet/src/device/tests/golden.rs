//! A recorded session of an independent controller (profinet-py 0.6.6) with an independent device (p-net): our device
//! in the place of the latter gives the same answers. Source: captures/pnet-profinetpy-full.pcapng; the number is the
//! frame's.

use super::*;
use crate::wire::record::Im0;

/// Frame 28.
const CONNECT: &str = "\
    0400200000000000dea000006c9711d18271000100020493dea000016c9711d1827100a02442df7dcf54420198aabe53\
    009261e2ea6ba7f80000000000000001000000000000ffffffff01fe0000000000000fa0000001ea00000fa000000000\
    000001ea0101003801000001ff22fb8075848cb3eb6d6e2549f1b98ff26d02504e000002dea000006c9711d182710001\
    76543210000000110064889200027470010200680100000100018892000000010028c0010020002000010000ffffffff\
    000a000ac000000000000000000100000000000600000001000000008000000100008001000200010001000300030001\
    00050004000100070003000200010010000300010011000400010012010200680100000200028892000000010028ffff\
    0020002000010000ffffffff000a000ac000000000000000000100000000000300020001000000030001000200040001\
    0004000600000001000d00008000000e00008001000f0001000100100003000100110004000100120103001601000001\
    88920000000000010003000100c8c000a000010400b80100000500000000000000000001000000030001000000010000\
    000100000101800000008000000000010000010180010000800100000001000001010000000000010000003000000001\
    000100000130000100010001010100000000000200000031000000010001000001310002000200010101000000000003\
    000000320000000100010000013200030001000101010002000101010000000000040000004000000001000100000140\
    0003000100080101000200080101";
/// Frame 30.
const CONNECT_ANSWER: &str = "\
    0402280000000000dea000006c9711d18271000100020493dea000016c9711d1827100a02442df7dcf54420198aabe53\
    009261e2ea6ba7f80000000000000001000000000000ffffffff005a00000000000000000000004600000fa000000000\
    000000468101001e01000001ff22fb8075848cb3eb6d6e2549f1b98ff26d02504e000001889281020008010000010001\
    c00181020008010000020002c0008103000801000001000100c8";
/// Frame 31.
const PRM_END: &str = "\
    0400200000000000dea000006c9711d18271000100020493dea000016c9711d1827100a02442df7dcf54420198aabe53\
    009261e2ea6ba7f80000000000000001000000010004ffffffff00340000000000000fa00000002000000fa000000000\
    000000200110001c01000000ff22fb8075848cb3eb6d6e2549f1b98ff26d000000010000";
/// Frame 32.
const PRM_END_ANSWER: &str = "\
    0402280000000000dea000006c9711d18271000100020493dea000016c9711d1827100a02442df7dcf54420198aabe53\
    009261e2ea6ba7f80000000000000001000000010004ffffffff003400000000000000000000002000000fa000000000\
    000000208110001c01000000ff22fb8075848cb3eb6d6e2549f1b98ff26d000000080000";
/// Frame 33.
const READY: &str = "\
    0400200000000000dea000006c9711d18271000176543210dea000026c9711d1827100a02442df7d5814c1fb12341056\
    807902504e0000010000000000000001000000000004ffffffff0034000000000000053c000000200000053c00000000\
    000000200112001c01000000ff22fb8075848cb3eb6d6e2549f1b98ff26d000000020000";
/// Frame 35.
const IM0: &str = "\
    0400200000000000dea000006c9711d18271000100020493dea000016c9711d1827100a02442df7dcf54420198aabe53\
    009261e2ea6ba7f80000000000000001000000020002ffffffff00540000000000000fa00000004000000fa000000000\
    000000400009003c01000000ff22fb8075848cb3eb6d6e2549f1b98f00000000000000010000aff00000100000000000\
    0000000000000000000000000000000000000000";
/// Frame 171.
const WRITE_123: &str = "\
    0400200000000000dea000006c9711d18271000100020493dea000016c9711d1827100a02442df7dcf54420198aabe53\
    009261e2ea6ba7f80000000000000001000000050003ffffffff00580000000000000fa00000004400000fa000000000\
    000000440008003c01000000ff22fb8075848cb3eb6d6e2549f1b98f00000000000300010000007b0000000400000000\
    000000000000000000000000000000000000000000000001";
/// Frame 172.
const WRITE_123_ANSWER: &str = "\
    0402280000000000dea000006c9711d18271000100020493dea000016c9711d1827100a02442df7dcf54420198aabe53\
    009261e2ea6ba7f80000000000000001000000050003ffffffff005400000000000000000000004000000fa000000000\
    000000408008003c01000000ff22fb8075848cb3eb6d6e2549f1b98f00000000000300010000007b0000000000000000\
    0000000000000000000000000000000000000000";
/// Frame 182.
const RELEASE: &str = "\
    0400200000000000dea000006c9711d18271000100020493dea000016c9711d1827100a02442df7dcf54420198aabe53\
    009261e2ea6ba7f800000000000000010000000a0001ffffffff00340000000000000fa00000002000000fa000000000\
    000000200114001c01000000ff22fb8075848cb3eb6d6e2549f1b98ff26d000000040000";
/// Frame 184.
const RELEASE_ANSWER: &str = "\
    0402280000000000dea000006c9711d18271000100020493dea000016c9711d1827100a02442df7dcf54420198aabe53\
    009261e2ea6ba7f800000000000000010000000a0001ffffffff003400000000000000000000002000000fa000000000\
    000000208114001c01000000ff22fb8075848cb3eb6d6e2549f1b98ff26d000000080000";
/// DeviceAccess connect of another controller (profinet-rs), captures/pnet-profinetrs.pcapng frame 10.
const TOOL_CONNECT: &str = "\
    0400200000000000dea000006c9711d18271000100020493dea000016c9711d1827100a02442df7dd4aa85512f1006b5\
    42724651a267b8cc0000000000000001000000000000ffffffff00500000000000000fa00000003c00000fa000000000\
    0000003c010100380100000673b860dadb0ce4f0bdc6ce079a709731174602504e000002dea000006c9711d182710001\
    76543210000001110064889200027470";

fn bytes(hex: &str) -> Vec<u8> {
    let digit = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
    (0..hex.len()).step_by(2).map(digit).collect()
}

/// Returns the recorded device: digital in, digital out, both, and an echo of eight octets.
fn recorded_device() -> DeviceConfig {
    let mut config = config();
    let module = |ident, slot, submodules| ModuleDescription {
        ident,
        slots: vec![slot],
        submodules,
    };
    let submodule = |subslot, ident, input_length, output_length| SubmoduleDescription {
        subslot,
        ident,
        api: 0,
        input_length,
        output_length,
    };
    let access_point = vec![
        submodule(1, 1, 0, 0),
        submodule(0x8000, 0x8000, 0, 0),
        submodule(0x8001, 0x8001, 0, 0),
    ];
    config.modules = vec![
        module(1, 0, access_point),
        module(0x30, 1, vec![submodule(1, 0x130, 1, 0)]),
        module(0x31, 2, vec![submodule(1, 0x131, 0, 1)]),
        module(0x32, 3, vec![submodule(1, 0x132, 1, 1)]),
        module(0x40, 4, vec![submodule(1, 0x140, 8, 8)]),
    ];
    DeviceConfig {
        plugged: vec![(0, 1)],
        ..config
    }
}

/// Sends a recorded request; gives the stub of the answer.
fn replay(rig: &mut Rig, hex: &str) -> Vec<u8> {
    rig.send(&bytes(hex));
    let sent = rig.drain();
    let answer = sent.iter().find_map(|sent| match sent {
        Sent::Datagram(_, RPC_PORT, pdu) => Some(pdu.clone()),
        _ => None,
    });
    let answer = answer.expect("an answer");
    // everything but serial number is echoed as the recorded device did
    assert_eq!(answer[..3], [4, 2, 0x28]);
    answer[80..].to_vec()
}

#[test]
fn a_recorded_controller_is_served_as_it_was() {
    let mut rig = Rig::new(recorded_device());
    let answer = replay(&mut rig, CONNECT);
    let recorded = bytes(CONNECT_ANSWER);
    let blocks = |stub: &[u8]| {
        let mut reader = Reader::new(stub);
        let ndr = NdrResponse::decode(&mut reader, ByteOrder::Big).unwrap();
        assert_eq!(ndr.args_maximum, 4000);
        ConnectResponse::decode(reader).unwrap()
    };
    let (mine, theirs) = (blocks(&answer), blocks(&recorded[80..]));
    assert_eq!(mine.ar, theirs.ar);
    assert_eq!(mine.iocrs, theirs.iocrs);
    assert_eq!(
        (mine.diff, mine.server.is_some()),
        (theirs.diff, theirs.server.is_some())
    );
    assert_eq!(answer.len() + 80, recorded.len());

    assert_eq!(replay(&mut rig, PRM_END), bytes(PRM_END_ANSWER)[80..]);
    let ar = rig.device.controller().unwrap();
    assert!(rig.device.application_ready(rig.now, ar));
    let (header, body) = ready_request(&rig.drain()).unwrap();
    let theirs = bytes(READY);
    let (their_header, their_body) = Header::decode(&theirs).unwrap();
    assert_eq!(
        (header.object, header.interface),
        (their_header.object, their_header.interface)
    );
    assert_eq!((header.operation, header.sequence), (their_header.operation, 0));
    assert_eq!(body[20..], their_body[20..]);

    let im0 = replay(&mut rig, IM0);
    assert!(Im0::decode(Reader::new(&im0[84..])).is_ok());
    rig.events();
    rig.device.controller.as_mut().unwrap().phase = ar::Phase::Data;
    rig.send(&bytes(WRITE_123));
    let Some(Event::RecordWrite {
        token, address, data, ..
    }) = rig.device.poll_event()
    else {
        panic!("no write")
    };
    assert_eq!(
        (address.slot, address.subslot, address.index, data.len()),
        (3, 1, 123, 4)
    );
    rig.device.answer_write(rig.now, token, Ok(()));
    // the answer comes again for the repeated request
    assert_eq!(replay(&mut rig, WRITE_123), bytes(WRITE_123_ANSWER)[80..]);
    assert_eq!(replay(&mut rig, RELEASE), bytes(RELEASE_ANSWER)[80..]);
    assert!(rig.device.controller().is_none());
}

#[test]
fn a_recorded_tool_gets_the_ar_that_the_other_device_refused() {
    let mut rig = Rig::new(config());
    let answer = replay(&mut rig, TOOL_CONNECT);
    assert_eq!(answer[..4], [0; 4]);
    assert!(matches!(
        rig.events()[..],
        [Event::Connected {
            kind: ArKind::DeviceAccess,
            ..
        }]
    ));
}

#[test]
fn every_truncation_and_flipped_bit_of_the_recorded_connect_is_survived() {
    let whole = bytes(CONNECT);
    for end in 0..whole.len() {
        let mut rig = Rig::new(recorded_device());
        rig.send(&whole[..end]);
        assert!(rig.drain().is_empty() && rig.device.controller().is_none());
        for bit in [0, 3, 7] {
            let mut damaged = whole.clone();
            damaged[end] ^= 1 << bit;
            let mut rig = Rig::new(recorded_device());
            rig.send(&damaged);
            rig.drain();
        }
    }
}
