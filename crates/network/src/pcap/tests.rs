//! Written is read back; other writers' files; damage.

use std::io::{self, Cursor, Read};
use std::time::Duration;

use profinet::Instant;
use proptest::prelude::*;

use super::*;

const ORIGIN: Duration = Duration::new(1_700_000_000, 5);

fn written(frames: &[(u64, Vec<u8>)]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut writer = Writer::new(&mut file, "segment", ORIGIN).unwrap();
    for (at, frame) in frames {
        writer.write(Instant::from_nanos(*at), frame).unwrap();
    }
    writer.flush().unwrap();
    drop(writer);
    file
}

fn read(file: Vec<u8>) -> Result<Vec<Captured>, ReadError> {
    Reader::new(Cursor::new(file))?.collect()
}

#[test]
fn a_golden_file() {
    let file = written(&[(1, vec![0xAB; 5])]);
    let expected = [
        &[
            0x0A, 0x0D, 0x0D, 0x0A, 48, 0, 0, 0, 0x4D, 0x3C, 0x2B, 0x1A, 1, 0, 0, 0,
        ][..],
        &[0xFF; 8],
        &[4, 0, 10, 0],
        b"profidrive\0\0",
        &[0, 0, 0, 0, 48, 0, 0, 0],
        &[1, 0, 0, 0, 44, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 7, 0],
        b"segment\0",
        &[9, 0, 1, 0, 9, 0, 0, 0, 0, 0, 0, 0, 44, 0, 0, 0],
        &[6, 0, 0, 0, 40, 0, 0, 0, 0, 0, 0, 0],
        &((1_700_000_000_000_000_006u64 >> 32) as u32).to_le_bytes(),
        &(1_700_000_000_000_000_006u64 as u32).to_le_bytes(),
        &[
            5, 0, 0, 0, 5, 0, 0, 0, 0xAB, 0xAB, 0xAB, 0xAB, 0xAB, 0, 0, 0, 40, 0, 0, 0,
        ],
    ]
    .concat();
    assert_eq!(file, expected);
}

#[test]
fn reads_legacy_files_of_either_order_and_precision() {
    for (magic, nanos) in [(0xA1B2_C3D4u32, 7_000), (0xA1B2_3C4D, 7)] {
        for big in [false, true] {
            let word = |n: u32| if big { n.to_be_bytes() } else { n.to_le_bytes() };
            let mut file = Vec::new();
            let version = if big { [0, 2, 0, 4] } else { [2, 0, 4, 0] };
            file.extend([word(magic), version].concat());
            file.extend([0, 0, 65535, 1].map(word).concat());
            file.extend([10, 7, 3, 60].map(word).concat());
            file.extend([1, 2, 3]);
            let frames = read(file).unwrap();
            let expected = Captured {
                time: Duration::new(10, nanos),
                frame: vec![1, 2, 3],
                original_length: 60,
            };
            assert_eq!(frames, [expected]);
        }
    }
}

#[test]
fn errors_name_the_cause() {
    let good = written(&[(0, vec![1; 60]), (1, vec![2; 60])]);
    let frame_at = |n: usize| 48 + 44 + n * 92;
    assert!(matches!(read(Vec::new()), Err(ReadError::NotACapture)));
    assert!(matches!(
        read(b"GET / HTTP/1.1\r\n\r\n".to_vec()),
        Err(ReadError::NotACapture)
    ));
    let cut = good[..good.len() - 1].to_vec();
    assert!(matches!(read(cut), Err(ReadError::Truncated { offset }) if offset == frame_at(1) as u64));
    let mut long = good.clone();
    long[frame_at(0) + 4..frame_at(0) + 8].copy_from_slice(&0x4000_0000u32.to_le_bytes());
    let error = read(long).unwrap_err();
    assert!(
        matches!(error, ReadError::TooLong { offset } if offset == frame_at(0) as u64),
        "{error}"
    );
    let mut odd = good.clone();
    odd[frame_at(0) + 88] ^= 4;
    let error = read(odd).unwrap_err();
    assert!(
        matches!(error, ReadError::Damaged { offset, .. } if offset == frame_at(0) as u64),
        "{error}"
    );
    let mut stray = good.clone();
    stray[frame_at(1) + 8] = 1;
    assert!(matches!(read(stray), Err(ReadError::Damaged { .. })));
    let mut other = good;
    other[56] = 113;
    assert!(matches!(read(other), Err(ReadError::LinkType { link_type: 113 })));
}

#[test]
fn power_of_two_resolutions_and_offsets_count() {
    let mut file = written(&[]);
    // an interface with 2^-10 s and an offset of 100 s
    let body = [
        &[1u8, 0, 0, 0, 0, 0, 0, 0, 9, 0, 1, 0, 0x8A, 0, 0, 0, 14, 0, 8, 0][..],
        &100i64.to_le_bytes(),
        &[0, 0, 0, 0],
    ]
    .concat();
    let length = (body.len() as u32 + 12).to_le_bytes();
    file.extend([&1u32.to_le_bytes()[..], &length, &body, &length].concat());
    let packet = [1u32, 0, 1536, 0, 0].map(u32::to_le_bytes).concat();
    file.extend(
        [
            &6u32.to_le_bytes()[..],
            &32u32.to_le_bytes(),
            &packet,
            &32u32.to_le_bytes(),
        ]
        .concat(),
    );
    assert_eq!(read(file).unwrap()[0].time, Duration::from_millis(101_500));
}

/// Cut anywhere, a capture has the frames that are whole, and an error that says where it ends.
#[test]
fn a_capture_that_is_cut_at_any_octet_has_what_is_whole() {
    let golden = include_bytes!("../../../../captures/pnio-profinetpy-rtclass1-refused.pcapng");
    for file in [&golden[..], &written(&[(0, vec![1; 60]), (1, vec![2; 61])])] {
        let whole = read(file.to_vec()).unwrap();
        let head = u32::from_le_bytes([file[4], file[5], file[6], file[7]]) as usize;
        let mut before = 0;
        for end in 0..file.len() {
            let reader = match Reader::new(Cursor::new(file[..end].to_vec())) {
                Ok(reader) => reader,
                Err(cut) => {
                    assert!(end < head, "{end}: its head is whole");
                    assert!(matches!(cut, ReadError::NotACapture), "{end}: {cut}");
                    continue;
                }
            };
            let (mut frames, mut error) = (Vec::new(), None);
            for next in reader {
                match next {
                    Ok(frame) => frames.push(frame),
                    Err(cut) => error = Some(cut),
                }
            }
            let same = frames
                .iter()
                .zip(&whole)
                .all(|(one, other)| (one.time, &one.frame) == (other.time, &other.frame));
            assert!(same && frames.len() >= before, "{end}");
            before = frames.len();
            match error {
                // between two blocks
                None => {}
                Some(ReadError::Truncated { offset }) => assert!(offset < end as u64, "{end}: at {offset}"),
                Some(other) => panic!("{end}: {other}"),
            }
        }
        assert!(before + 1 >= whole.len());
    }
}

#[test]
fn a_failing_source_is_reported() {
    struct Failing(usize, Cursor<Vec<u8>>);
    impl Read for Failing {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            self.0 += 1;
            if self.0 > 1 {
                Err(io::Error::other("the disk is gone"))
            } else {
                self.1.read(&mut buffer[..200])
            }
        }
    }
    let file = written(&[(0, vec![0; 60]), (0, vec![0; 60])]);
    let error = Reader::new(Failing(0, Cursor::new(file))).unwrap_err();
    assert!(error.to_string().contains("the disk is gone"), "{error}");
}

#[test]
fn reads_in_small_pieces_and_large_files() {
    struct Dripping(Cursor<Vec<u8>>);
    impl Read for Dripping {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let few = buffer.len().min(7);
            self.0.read(&mut buffer[..few])
        }
    }
    let frames: Vec<_> = (0..40_000).map(|n| (n, vec![n as u8; 60])).collect();
    let reader = Reader::new(Dripping(Cursor::new(written(&frames)))).unwrap();
    let mut count = 0;
    for (captured, (at, frame)) in reader.zip(&frames) {
        let captured = captured.unwrap();
        assert_eq!(
            (captured.time, &captured.frame),
            (ORIGIN + Duration::from_nanos(*at), frame)
        );
        count += 1;
    }
    assert_eq!(count, 40_000);
}

proptest! {
    #[test]
    fn written_is_read_back(frames in prop::collection::vec((0u64..1 << 50, prop::collection::vec(any::<u8>(), 0..1518)), 0..20)) {
        let read: Vec<_> = read(written(&frames)).unwrap();
        let read: Vec<_> = read.into_iter().map(|c| ((c.time - ORIGIN).as_nanos() as u64, c.frame)).collect();
        prop_assert_eq!(read, frames);
    }

    #[test]
    fn damage_ends_in_an_error_or_in_fewer_frames(
        flips in prop::collection::vec((0usize..400, 0..8u8), 1..10),
        cut in 0usize..400,
    ) {
        let mut file = written(&[(0, vec![1; 60]), (1, vec![2; 61]), (2, vec![3; 62])]);
        for (index, bit) in flips {
            let index = index % file.len();
            file[index] ^= 1 << bit;
        }
        file.truncate(file.len().saturating_sub(cut % 64));
        if let Ok(reader) = Reader::new(Cursor::new(file)) {
            prop_assert!(reader.count() <= 100);
        }
    }

    #[test]
    fn garbage_ends(head in 0..3usize, body in prop::collection::vec(any::<u8>(), 0..600)) {
        let mut file = [&written(&[])[..], &[0xD4, 0xC3, 0xB2, 0xA1, 2, 0, 4, 0][..], &[][..]][head].to_vec();
        file.extend(body);
        if let Ok(reader) = Reader::new(Cursor::new(file)) {
            prop_assert!(reader.count() <= 100);
        }
    }
}

/// Found by a fuzzer: the parser subtracted the block frame from a length below it.
#[test]
fn a_block_shorter_than_its_frame_is_damage() {
    let mut file = Vec::new();
    let mut writer = Writer::new(&mut file, "x", Duration::ZERO).unwrap();
    writer.write(Instant::ZERO, &[0xFF; 60]).unwrap();
    writer.flush().unwrap();
    drop(writer);
    for kind in [1_u32, 2, 3, 4, 5, 6, 0x0A0D_0D0A, 0x8000_0001, 0xBAD, 0x4000_0BAD] {
        for length in 0_u32..12 {
            let mut damaged = file.clone();
            damaged.extend_from_slice(&kind.to_le_bytes());
            damaged.extend_from_slice(&length.to_le_bytes());
            damaged.extend_from_slice(&[0; 64]);
            let read: Vec<_> = Reader::new(Cursor::new(damaged)).unwrap().collect();
            assert_eq!(read.len(), 2, "{kind:#x} {length}");
            assert!(
                matches!(read[1], Err(ReadError::Damaged { .. })),
                "{kind:#x} {length}"
            );
        }
    }
}

#[test]
fn the_interfaces_of_a_section_are_bounded() {
    let mut file = written(&[]);
    // the block of the only interface
    let interface = file[48..92].to_vec();
    for _ in 0..5000 {
        file.extend_from_slice(&interface);
    }
    let error = read(file).unwrap_err();
    assert!(
        matches!(error, ReadError::Damaged { what, .. } if what == "too many interfaces"),
        "{error}"
    );
}
