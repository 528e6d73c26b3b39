//! No allocation on the hot paths, shown by an allocator that counts.

use std::hint::black_box;
use std::time::Duration;

use allocations::made_by as allocations;
use profile::parameter::{Attributes, Dialect, ErrorNumber, Format, Keep, ParameterAccess, ParameterAddress};
use profile::parameter::{RequestId, Response, encode_read, serve};
use profinet::cyclic::{Consumer, Provider, ProviderConfig, SubmoduleSize, Timing, pack};
use profinet::wire::ethernet::{Frame, FrameId, Tag};
use profinet::wire::rt::Iops;
use profinet::{Instant, MacAddress};

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| drop(black_box(vec![1_u8; 10]))), 1);
    assert_eq!(
        allocations(|| {
            black_box(1);
        }),
        0
    );
}

const A: MacAddress = MacAddress([2, 0, 0, 0, 0, 1]);
const B: MacAddress = MacAddress([2, 0, 0, 0, 0, 2]);

#[test]
fn cyclic_frames_both_directions() {
    let timing = Timing::for_interval(Duration::from_millis(1)).unwrap();
    let (layout, _) = pack(&[SubmoduleSize::new(0x3A00, 1, 1, 4, 4)]).unwrap();
    let config = ProviderConfig {
        destination: A,
        source: B,
        tag: Some(Tag::PRIORITY_6),
        frame_id: FrameId(0x8000),
        timing,
        origin: Instant::ZERO,
    };
    let mut provider = Provider::new(config, layout.clone(), Instant::ZERO);
    let mut consumer = Consumer::new(B, FrameId(0x8000), timing, 3, layout);
    let mut buffer = [0; 1518];
    let mut run = |cycles: u64| {
        for _ in 0..cycles {
            let now = provider.next_send();
            provider.set_data(1, 1, &[0x04, 0x7F, 0, 164], Iops::GOOD);
            let length = provider.emit(now, &mut buffer).unwrap();
            let frame = Frame::parse(&buffer[..length]).unwrap();
            consumer.handle(now, &frame).unwrap();
            assert_eq!(consumer.data(1, 1).unwrap().0, [0x04, 0x7F, 0, 164]);
        }
    };
    run(10);
    assert_eq!(allocations(|| run(10_000)), 0);
    assert_eq!(consumer.statistics().missed, 0);
}

struct Drive;

impl ParameterAccess for Drive {
    fn attributes(&self, _: u16, _: u16) -> Option<Attributes> {
        Some(Attributes::simple(Format::UNSIGNED32, 4, true))
    }
    fn read(&mut self, pnu: u16, _: u16) -> Result<u64, ErrorNumber> {
        Ok(pnu.into())
    }
    fn write(&mut self, _: u16, _: u16, _: u64, _: Keep) -> Result<(), ErrorNumber> {
        Ok(())
    }
}

#[test]
fn parameter_requests_and_answers() {
    let addresses = [ParameterAddress::value(930, 0), ParameterAddress::value(922, 0)];
    let mut request = [0; 240];
    let mut answer = [0; 240];
    let mut run = || {
        let asked = encode_read(5, &Dialect::AKD, &addresses, &mut request).unwrap();
        let answered = serve(&request[..asked], &Dialect::AKD, &mut Drive, &mut answer).unwrap();
        let response =
            Response::parse(&answer[..answered], RequestId::Read, 5, &addresses, &Dialect::AKD).unwrap();
        assert_eq!(response.answers().count(), 2);
        let change = [5, 2, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x43, 1, 0, 0, 0, 2];
        assert_eq!(serve(&change, &Dialect::AKD, &mut Drive, &mut answer), Ok(6));
        // what the dialects of VLT and Vacon have beside that: double words, kept values, texts, own error numbers
        for (dialect, id, octets) in [
            (&Dialect::VLT, RequestId::ReadWide, 16),
            (&Dialect::VLT, RequestId::Read, 16),
            (&Dialect::VACON, RequestId::Read, 16),
            (&Dialect::VACON, RequestId::ReadWide, 12),
        ] {
            request[..asked].copy_from_slice(&[
                5,
                id.octet(),
                dialect.axis,
                2,
                0x10,
                1,
                0x03,
                0xA2,
                0,
                0,
                0x10,
                1,
                0x03,
                0x9A,
                0,
                0,
            ]);
            assert_eq!(
                serve(&request[..asked], dialect, &mut Drive, &mut answer),
                Ok(octets)
            );
        }
        let keep = [5, 0x42, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x43, 1, 0, 0, 0, 2];
        assert_eq!(serve(&keep, &Dialect::VLT, &mut Drive, &mut answer), Ok(4));
        for attribute in [0x20, 0x30, 0x50] {
            let other = [5, 1, 0, 1, attribute, 1, 0x03, 0xA2, 0, 0];
            assert_eq!(serve(&other, &Dialect::VLT, &mut Drive, &mut answer), Ok(8));
        }
    };
    run();
    assert_eq!(allocations(run), 0);
}

/// One cycle of the virtual AKD without its PROFINET part, and its parameter service.
#[test]
fn the_drive_ticks_and_answers() {
    let mut drive = virtual_drive::drive::Drive::new(&virtual_drive::model::AKD);
    drive.connect(1, Duration::from_millis(48)).unwrap();
    let mut now = Instant::ZERO;
    let mut inputs = [0; 4];
    let mut send = |drive: &mut virtual_drive::drive::Drive, word: u16, speed: i16, cycles: u32| {
        let [a, b] = word.to_be_bytes();
        let [c, d] = speed.to_be_bytes();
        for _ in 0..cycles {
            now += Duration::from_millis(1);
            drive.tick(now, Some(&[a, b, c, d]), &mut inputs);
        }
        u16::from_be_bytes([inputs[0], inputs[1]])
    };
    send(&mut drive, 0x047E, 0, 10);
    send(&mut drive, 0x047F, 0, 10);
    assert_eq!(send(&mut drive, 0x047F, 164, 100) & 7, 7, "in operation");
    let running = || {
        send(&mut drive, 0x047F, 164, 10_000);
    };
    assert_eq!(allocations(running), 0);
    // events of the state changes are taken before the next measurement
    while drive.poll_event().is_some() {}
    let mut out = [0; 240];
    let read = [5, 1, 0, 2, 0x10, 1, 0x03, 0xA2, 0, 0, 0x10, 1, 0x03, 0x9A, 0, 0];
    assert_eq!(
        allocations(|| {
            assert!(drive.serve(&read, &mut out).is_ok());
        }),
        0
    );
    assert_eq!(out[..6], [5, 1, 0, 2, 0x42, 1]);
}
