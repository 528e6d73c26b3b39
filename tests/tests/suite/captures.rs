//! The recorded captures of independent stacks, frame by frame through our decoders and back through our builders.

use std::collections::HashMap;

use network::pcap::Writer;
use profile::parameter::Dialect;
use profinet::wire::block::{Block, BlockType, IocrRequest, IocrResponse, IocrType};
use profinet::wire::ethernet::{self, Frame, FrameId};
use profinet::wire::rpc::{Header, NdrRequest, NdrResponse, PacketType, operation};
use profinet::wire::{DecodeError, Reader, rt};
use profinet::{Instant, MacAddress};
use system_tests::traffic::{Content, content, frames, streams};
use system_tests::{capture_files, compare, judge, rewrite};

const DEVICE: MacAddress = MacAddress([2, 0x50, 0x4E, 0, 0, 1]);

/// Data length of each FrameID as the connects of a capture agreed on it.
#[derive(Default)]
struct Agreed {
    asked: Vec<(u16, u16)>,
    lengths: HashMap<(FrameId, MacAddress), u16>,
}

impl Agreed {
    fn listen(
        &mut self,
        payload: &[u8],
        device: MacAddress,
        controller: MacAddress,
    ) -> Result<(), DecodeError> {
        let (header, body) = Header::decode(payload)?;
        if header.operation != operation::CONNECT
            || header.interface != profinet::wire::Uuid::DEVICE_INTERFACE
        {
            return Ok(());
        }
        let mut reader = Reader::new(body);
        if header.packet_type == PacketType::Request {
            NdrRequest::decode(&mut reader, header.order)?;
            self.asked.clear();
        } else {
            NdrResponse::decode(&mut reader, header.order)?;
        }
        while !reader.is_empty() {
            let block = Block::decode(&mut reader)?;
            match block.block_type {
                BlockType::IOCR_REQUEST => {
                    let iocr = IocrRequest::decode(block.body)?;
                    self.asked.push((iocr.reference, iocr.data_length));
                }
                BlockType::IOCR_RESPONSE => {
                    let iocr = IocrResponse::decode(block.body)?;
                    let length = self
                        .asked
                        .iter()
                        .find(|(reference, _)| *reference == iocr.reference)
                        .unwrap()
                        .1;
                    let source = if iocr.iocr_type == IocrType::INPUT {
                        device
                    } else {
                        controller
                    };
                    self.lengths.insert((FrameId(iocr.frame_id), source), length);
                }
                _ => {}
            }
        }
        Ok(())
    }
}

#[test]
fn every_captured_frame_decodes_and_round_trips() {
    let mut total = 0;
    for file in capture_files() {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let mut agreed = Agreed::default();
        let mut kinds: HashMap<&str, usize> = HashMap::new();
        for (number, bytes) in frames(&file) {
            let kind = match content(&bytes) {
                Content::Profinet(frame) => profinet_frame(&name, number, &bytes, frame, &agreed),
                Content::Rpc { payload, .. } => {
                    // whoever is not the device is the controller
                    let source = MacAddress(bytes[6..12].try_into().unwrap());
                    let target = MacAddress(bytes[..6].try_into().unwrap());
                    let controller = if source == DEVICE { target } else { source };
                    agreed.listen(payload, DEVICE, controller).unwrap();
                    let again = rewrite::rpc(payload).unwrap_or_else(|e| panic!("{name} {number}: {e}"));
                    assert_eq!(again, payload, "{name} {number}");
                    "rpc"
                }
                Content::Other => "other",
            };
            *kinds.entry(kind).or_default() += 1;
            total += 1;
        }
        println!("{name}: {kinds:?}");
        assert!(kinds["rpc"] >= 2 && kinds["dcp"] >= 2, "{name}: {kinds:?}");
    }
    assert!(total > 700, "{total} frames");
}

fn profinet_frame(
    name: &str,
    number: usize,
    bytes: &[u8],
    frame: Frame<'_>,
    agreed: &Agreed,
) -> &'static str {
    let Frame {
        destination,
        source,
        tag,
        frame_id,
        payload,
    } = frame;
    let mut buffer = vec![0; bytes.len() + 64];
    let length = ethernet::emit(&mut buffer, destination, source, tag, frame_id, payload).unwrap();
    assert_eq!(buffer[..bytes.len()], *bytes, "{name} {number}");
    assert!(buffer[bytes.len()..length].iter().all(|octet| *octet == 0));
    match frame_id.0 {
        0x8000..=0xF7FF => {
            let length = agreed.lengths.get(&(frame_id, source));
            let length =
                *length.unwrap_or_else(|| panic!("{name} {number}: no connect agreed on {frame_id:?}"));
            let cyclic = rt::Cyclic::parse(payload, length.into()).unwrap();
            assert_eq!(cyclic.trailer.transfer_status, 0, "{name} {number}");
            assert_eq!(cyclic.trailer.cycle_counter % 1024, 0, "{name} {number}: 32 ms");
            "cyclic"
        }
        0xFC01 | 0xFE01 => {
            let again = rewrite::alarm(payload).unwrap_or_else(|e| panic!("{name} {number}: {e}"));
            assert_eq!(again, payload[..again.len()], "{name} {number}");
            "alarm"
        }
        0xFEFC..=0xFEFF => {
            rewrite::dcp(payload).unwrap_or_else(|e| panic!("{name} {number}: {e}"));
            "dcp"
        }
        other => panic!("{name} {number}: FrameID {other:#06x}"),
    }
}

/// Our reader and our writer of capture files against the dissector's.
#[test]
fn what_we_write_the_dissector_reads() {
    for file in capture_files() {
        let out = system_tests::root().join("target/system/rewritten.pcapng");
        std::fs::create_dir_all(out.parent().unwrap()).unwrap();
        let mut writer = Writer::new(
            std::fs::File::create(&out).unwrap(),
            "test",
            std::time::Duration::from_secs(1),
        )
        .unwrap();
        for (number, bytes) in frames(&file) {
            writer.write(Instant::from_millis(number as u64), &bytes).unwrap();
        }
        writer.flush().unwrap();
        let columns = ["frame.number", "frame.len", "_ws.col.Protocol", "_ws.col.Info"];
        assert_eq!(
            judge::fields(&file, "frame", &columns),
            judge::fields(&out, "frame", &columns)
        );
    }
}

/// The stream counter used by the other tests, on recordings whose counts are known.
#[test]
fn no_cycle_is_lost_in_the_recordings() {
    let file = system_tests::root().join("captures/pnio-profinetpy-full.pcapng");
    let streams = streams(&file, 1024);
    assert_eq!(streams.len(), 2, "{streams:?}");
    for stream in streams.values() {
        assert!(stream.frames > 50, "{streams:?}");
        assert_eq!(stream.lost, 0, "{streams:?}");
    }
}

/// The requests in the recordings (no device in them answers any) as the dissector and as we read them.
#[test]
fn the_dissector_and_we_read_the_same_parameter_jobs() {
    let mut jobs = 0;
    for file in capture_files() {
        jobs += compare::same_parameters(&file, &Dialect::STANDARD);
    }
    assert!(jobs >= 2, "{jobs}");
}
