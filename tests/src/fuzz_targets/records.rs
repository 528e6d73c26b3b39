//! Records that a controller or a tool reads from a device.

use profinet::wire::block::BlockType;
use profinet::wire::record::{
    DiagnosisHeader, Identification, Im0, ImText, InterfaceReal, LogData, RecordInput, decode_apis,
    decode_ar_list, encode_apis, encode_im,
};
use profinet::wire::{DecodeError, Reader, Writer};

/// Record data behind its index of two octets, read as every kind of record there is: the index only says where a seed is
/// from.
pub fn records(data: &[u8]) {
    let data = data.get(2..).unwrap_or(&[]);
    again(data, Im0::decode, |im0, out| im0.encode(out));
    for number in 0..=5 {
        again(
            data,
            |reader| ImText::decode(reader, number).map(|text| text.body.to_vec()),
            |body, out| encode_im(number, body, out),
        );
    }
    for (kind, low) in [
        (BlockType::REAL_IDENTIFICATION, 1),
        (BlockType::EXPECTED_IDENTIFICATION, 1),
        (BlockType::IM0_FILTER_SUBMODULE, 0),
        (BlockType::IM0_FILTER_MODULE, 0),
        (BlockType::IM0_FILTER_DEVICE, 0),
    ] {
        again(
            data,
            |mut reader| Identification::decode(&mut reader, kind),
            |identification, out| identification.encode(kind, low, out),
        );
    }
    again(data, decode_apis, |apis, out| encode_apis(apis, out));
    again(data, LogData::decode, |log, out| log.encode(out));
    let input = |reader: Reader<'_>| {
        RecordInput::decode(reader).map(|input| (input.iocs, input.iops, input.data.to_vec()))
    };
    again(data, input, |(iocs, iops, data), out| {
        let (iocs, iops) = (*iocs, *iops);
        RecordInput { iocs, iops, data }.encode(out);
    });
    let interface = |reader: Reader<'_>| {
        InterfaceReal::decode(reader).map(|real| (real.name.to_vec(), real.mac, real.ip))
    };
    again(data, interface, |(name, mac, ip), out| {
        let (mac, ip) = (*mac, *ip);
        InterfaceReal { name, mac, ip }.encode(out);
    });
    let diagnosis = |mut reader: Reader<'_>| {
        DiagnosisHeader::decode(&mut reader).map(|(header, items)| (header, items.to_vec()))
    };
    again(data, diagnosis, |(header, items), out| {
        header.encode(out, |out| out.bytes(items));
    });
    let mut reader = Reader::new(data);
    let mut blocks = 0;
    while DiagnosisHeader::decode(&mut reader).is_ok() {
        blocks += 1;
        assert!(blocks <= data.len(), "a block without octets");
    }
    if let Ok(Some(ars)) = decode_ar_list(&mut Reader::new(data)) {
        assert!(ars.len() <= data.len());
    }
}

/// A parsed file is written and parsed again with the same result.
fn again<T: PartialEq + std::fmt::Debug>(
    data: &[u8],
    decode: impl Fn(Reader<'_>) -> Result<T, DecodeError>,
    encode: impl Fn(&T, &mut Vec<u8>),
) {
    // a block cannot encode a length beyond this
    if data.len() > 60_000 {
        return;
    }
    if let Ok(first) = decode(Reader::new(data)) {
        let mut out = Vec::new();
        encode(&first, &mut out);
        assert_eq!(decode(Reader::new(&out)).as_ref(), Ok(&first));
    }
}
