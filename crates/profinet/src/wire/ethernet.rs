//! Ethernet frames of EtherType 0x8892: header, optional 802.1Q tag, FrameID.
//!
//! Source: IEC 61158-6-10 clause 4.2 and 802.1Q. A receiver accepts every frame tagged or untagged and ignores the tag;
//! a sender tags cyclic data and alarms.

use core::fmt;

use crate::MacAddress;

/// EtherType of PROFINET real-time frames.
pub const ETHERTYPE: u16 = 0x8892;

/// TPID of an 802.1Q tag.
pub const TPID: u16 = 0x8100;

/// Shortest Ethernet frame without FCS; shorter ones are filled with zeros.
pub const MIN_FRAME: usize = 60;

/// Octets in front of the FrameID's payload when a tag is written.
pub const TAGGED_HEADER: usize = 20;

/// Octets in front of the FrameID's payload without a tag.
pub const UNTAGGED_HEADER: usize = 16;

/// Multicast address of DCP Identify requests.
pub const DCP_IDENTIFY: MacAddress = MacAddress([0x01, 0x0E, 0xCF, 0, 0, 0]);

/// Multicast address of DCP Hello requests.
pub const DCP_HELLO: MacAddress = MacAddress([0x01, 0x0E, 0xCF, 0, 0, 1]);

/// Tag control information: priority in the top three bits, VLAN number in the low twelve.
///
/// Source: 802.1Q; the values are those of IEC 61158-6-10, IOCRTagHeader and AlarmCRTagHeader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Tag(pub u16);

impl Tag {
    /// Priority 6: cyclic data and alarms of high priority.
    pub const PRIORITY_6: Self = Self(0xC000);
    /// Priority 5: alarms of low priority.
    pub const PRIORITY_5: Self = Self(0xA000);
    /// Priority 0: DCP, where it is tagged at all.
    pub const PRIORITY_0: Self = Self(0);

    /// Priority code point, 0 to 7.
    #[must_use]
    pub const fn priority(self) -> u8 {
        (self.0 >> 13) as u8
    }

    /// VLAN number, 0 to 4095; 0 means priority only.
    #[must_use]
    pub const fn vlan(self) -> u16 {
        self.0 & 0x0FFF
    }
}

/// Kind of a frame, by the first two octets behind the EtherType.
///
/// Source: IEC 61158-6-10, coding of the field FrameID.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FrameId(pub u16);

/// The use of a [`FrameId`] range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FrameKind {
    /// Clock synchronisation, not handled here.
    Ptcp,
    /// Isochronous data (RT_CLASS_3), not handled here.
    RtClass3,
    /// Cyclic data, IOCRProperties.RTClass 2, 0x8000 to 0xBBFF.
    RtClass2,
    /// The same to a group of receivers, 0xBC00 to 0xBFFF.
    RtClass2Multicast,
    /// Cyclic data, IOCRProperties.RTClass 1, 0xC000 to 0xF7FF.
    RtClass1,
    /// The same to a group of receivers, 0xF800 to 0xFBFF.
    RtClass1Multicast,
    /// Alarm of high priority, 0xFC01.
    AlarmHigh,
    /// Alarm of low priority, 0xFE01.
    AlarmLow,
    /// Remote service interface, 0xFE02, not handled here.
    Rsi,
    /// DCP Hello, 0xFEFC.
    DcpHello,
    /// DCP Get and Set, requests and responses, 0xFEFD.
    DcpGetSet,
    /// DCP Identify request, 0xFEFE.
    DcpIdentifyRequest,
    /// DCP Identify response, 0xFEFF.
    DcpIdentifyResponse,
    /// Fragmentation of frames, 0xFF80 to 0xFF8F, not handled here.
    Fragmentation,
    /// Any other value.
    Unknown(u16),
}

impl FrameId {
    /// Alarm of high priority.
    pub const ALARM_HIGH: Self = Self(0xFC01);
    /// Alarm of low priority.
    pub const ALARM_LOW: Self = Self(0xFE01);
    /// DCP Hello request.
    pub const DCP_HELLO: Self = Self(0xFEFC);
    /// DCP Get or Set, request or response.
    pub const DCP_GET_SET: Self = Self(0xFEFD);
    /// DCP Identify request.
    pub const DCP_IDENTIFY_REQUEST: Self = Self(0xFEFE);
    /// DCP Identify response.
    pub const DCP_IDENTIFY_RESPONSE: Self = Self(0xFEFF);
    /// In a connect request: the device chooses.
    pub const CHOOSE: Self = Self(0xFFFF);

    /// Returns the range this number lies in.
    #[must_use]
    pub const fn kind(self) -> FrameKind {
        match self.0 {
            0x0020..=0x003F | 0x0080..=0x0081 | 0xFF00..=0xFF43 => FrameKind::Ptcp,
            0x0100..=0x7FFF => FrameKind::RtClass3,
            0x8000..=0xBBFF => FrameKind::RtClass2,
            0xBC00..=0xBFFF => FrameKind::RtClass2Multicast,
            0xC000..=0xF7FF => FrameKind::RtClass1,
            0xF800..=0xFBFF => FrameKind::RtClass1Multicast,
            0xFC01 => FrameKind::AlarmHigh,
            0xFE01 => FrameKind::AlarmLow,
            0xFE02 => FrameKind::Rsi,
            0xFEFC => FrameKind::DcpHello,
            0xFEFD => FrameKind::DcpGetSet,
            0xFEFE => FrameKind::DcpIdentifyRequest,
            0xFEFF => FrameKind::DcpIdentifyResponse,
            0xFF80..=0xFF8F => FrameKind::Fragmentation,
            other => FrameKind::Unknown(other),
        }
    }

    /// Returns true for cyclic data to one receiver, of class 1 or 2.
    #[must_use]
    pub const fn is_cyclic(self) -> bool {
        matches!(self.kind(), FrameKind::RtClass1 | FrameKind::RtClass2)
    }
}

impl fmt::Display for FrameId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "0x{:04X}", self.0)
    }
}

impl fmt::Debug for FrameId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "FrameId(0x{:04X})", self.0)
    }
}

/// One received PROFINET frame, tag looked through.
///
/// ```
/// use profidrive_profinet::wire::ethernet::{Frame, FrameId, Tag};
/// let bytes = [
///     2, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 2, 0x81, 0x00, 0xC0, 0x00, 0x88, 0x92, 0x80, 0x00, 0x80,
/// ];
/// let frame = Frame::parse(&bytes).unwrap();
/// assert_eq!(frame.tag, Some(Tag::PRIORITY_6));
/// assert_eq!(frame.frame_id, FrameId(0x8000));
/// assert_eq!(frame.payload, [0x80]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Receiver.
    pub destination: MacAddress,
    /// Sender.
    pub source: MacAddress,
    /// 802.1Q tag if one was there.
    pub tag: Option<Tag>,
    /// What the payload is.
    pub frame_id: FrameId,
    /// Octets behind the FrameID, with whatever padding the frame carries.
    pub payload: &'a [u8],
}

impl<'a> Frame<'a> {
    /// Looks at one Ethernet frame without FCS; `None` if it is no PROFINET frame or ends before its FrameID.
    #[must_use]
    pub fn parse(bytes: &'a [u8]) -> Option<Self> {
        let (destination, rest) = bytes.split_first_chunk::<6>()?;
        let (source, rest) = rest.split_first_chunk::<6>()?;
        let (kind, mut rest) = rest.split_first_chunk::<2>()?;
        let mut kind = u16::from_be_bytes(*kind);
        let mut tag = None;
        if kind == TPID {
            let (tci, after) = rest.split_first_chunk::<2>()?;
            let (inner, after) = after.split_first_chunk::<2>()?;
            tag = Some(Tag(u16::from_be_bytes(*tci)));
            kind = u16::from_be_bytes(*inner);
            rest = after;
        }
        if kind != ETHERTYPE {
            return None;
        }
        let (id, payload) = rest.split_first_chunk::<2>()?;
        Some(Self {
            destination: MacAddress(*destination),
            source: MacAddress(*source),
            tag,
            frame_id: FrameId(u16::from_be_bytes(*id)),
            payload,
        })
    }
}

/// Writes the header up to and including the FrameID; returns its length (16 or 20), `None` if `buffer` is too small.
#[must_use]
pub fn emit_header(
    buffer: &mut [u8],
    destination: MacAddress,
    source: MacAddress,
    tag: Option<Tag>,
    frame_id: FrameId,
) -> Option<usize> {
    let length = if tag.is_some() {
        TAGGED_HEADER
    } else {
        UNTAGGED_HEADER
    };
    let header = buffer.get_mut(..length)?;
    let (to, rest) = header.split_first_chunk_mut::<6>()?;
    *to = destination.0;
    let (from, mut rest) = rest.split_first_chunk_mut::<6>()?;
    *from = source.0;
    if let Some(tag) = tag {
        let (field, after) = rest.split_first_chunk_mut::<4>()?;
        let [a, b] = TPID.to_be_bytes();
        let [c, d] = tag.0.to_be_bytes();
        *field = [a, b, c, d];
        rest = after;
    }
    let (field, _) = rest.split_first_chunk_mut::<4>()?;
    let [a, b] = ETHERTYPE.to_be_bytes();
    let [c, d] = frame_id.0.to_be_bytes();
    *field = [a, b, c, d];
    Some(length)
}

/// Fills `buffer` with zeros from `length` up to the shortest frame; returns the length to send.
#[must_use]
pub fn pad(buffer: &mut [u8], length: usize) -> usize {
    if length >= MIN_FRAME {
        return length;
    }
    match buffer.get_mut(length..MIN_FRAME) {
        Some(rest) => {
            rest.fill(0);
            MIN_FRAME
        }
        None => length,
    }
}

/// Writes a whole frame: header, FrameID, payload, padding. Returns its length, `None` if `buffer` is too small.
#[must_use]
pub fn emit(
    buffer: &mut [u8],
    destination: MacAddress,
    source: MacAddress,
    tag: Option<Tag>,
    frame_id: FrameId,
    payload: &[u8],
) -> Option<usize> {
    let header = emit_header(buffer, destination, source, tag, frame_id)?;
    let end = header.checked_add(payload.len())?;
    buffer.get_mut(header..end)?.copy_from_slice(payload);
    Some(pad(buffer, end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const A: MacAddress = MacAddress([2, 0x50, 0x4e, 0, 0, 1]);
    const B: MacAddress = MacAddress([2, 0x50, 0x4e, 0, 0, 2]);

    #[test]
    fn tagged_and_untagged_are_the_same_frame() {
        let mut buffer = [0xA5; 128];
        let tagged = emit(
            &mut buffer,
            A,
            B,
            Some(Tag::PRIORITY_6),
            FrameId(0x8000),
            &[1, 2, 3],
        )
        .unwrap();
        assert_eq!(tagged, 60);
        assert_eq!(&buffer[12..23], [0x81, 0, 0xC0, 0, 0x88, 0x92, 0x80, 0, 1, 2, 3]);
        assert!(buffer[23..60].iter().all(|b| *b == 0));
        assert_eq!(buffer[60], 0xA5);
        let stripped: alloc::vec::Vec<u8> = [&buffer[..12], &buffer[16..60]].concat();
        let one = Frame::parse(&buffer[..60]).unwrap();
        let two = Frame::parse(&stripped).unwrap();
        assert_eq!(one.payload, two.payload);
        assert_eq!(
            (one.source, one.destination, one.frame_id),
            (B, A, FrameId(0x8000))
        );
        assert_eq!(two.tag, None);
    }

    #[test]
    fn other_frames_are_none() {
        assert_eq!(Frame::parse(&[]), None);
        let mut arp = [0; 60];
        arp[12] = 0x08;
        arp[13] = 0x06;
        assert_eq!(Frame::parse(&arp), None);
        // a tag inside a tag is not a PROFINET frame
        let mut twice = [0; 60];
        twice[12..22].copy_from_slice(&[0x81, 0, 0, 0, 0x81, 0, 0, 0, 0x88, 0x92]);
        assert_eq!(Frame::parse(&twice), None);
    }

    #[test]
    fn every_cut_is_none_or_shorter_payload() {
        let mut buffer = [0; 64];
        let length = emit(
            &mut buffer,
            A,
            B,
            Some(Tag::PRIORITY_5),
            FrameId::ALARM_LOW,
            &[7; 40],
        )
        .unwrap();
        for cut in 0..length {
            match Frame::parse(&buffer[..cut]) {
                Some(frame) => assert_eq!(frame.payload.len(), cut - TAGGED_HEADER),
                None => assert!(cut < TAGGED_HEADER),
            }
        }
        let mut small = [0; 19];
        assert_eq!(emit_header(&mut small, A, B, Some(Tag(0)), FrameId(0)), None);
        assert_eq!(emit(&mut small, A, B, None, FrameId(0), &[0; 4]), None);
    }

    #[test]
    fn ranges_meet_without_gap() {
        let edges = [
            (0x7FFF, FrameKind::RtClass3),
            (0x8000, FrameKind::RtClass2),
            (0xBBFF, FrameKind::RtClass2),
            (0xBC00, FrameKind::RtClass2Multicast),
            (0xC000, FrameKind::RtClass1),
            (0xF7FF, FrameKind::RtClass1),
            (0xF800, FrameKind::RtClass1Multicast),
            (0xFBFF, FrameKind::RtClass1Multicast),
            (0xFC00, FrameKind::Unknown(0xFC00)),
            (0xFC01, FrameKind::AlarmHigh),
            (0xFE01, FrameKind::AlarmLow),
            (0xFEFE, FrameKind::DcpIdentifyRequest),
            (0xFF80, FrameKind::Fragmentation),
            (0x0000, FrameKind::Unknown(0)),
        ];
        for (id, kind) in edges {
            assert_eq!(FrameId(id).kind(), kind, "{id:04x}");
        }
        assert!(FrameId(0xC000).is_cyclic() && FrameId(0x8000).is_cyclic() && !FrameId(0xBC00).is_cyclic());
    }

    proptest! {
        #[test]
        fn any_bytes_parse_without_panic(bytes in proptest::collection::vec(any::<u8>(), 0..80)) {
            let _ = Frame::parse(&bytes);
        }

        #[test]
        fn round_trip(to: [u8; 6], from: [u8; 6], tag: Option<u16>, id: u16,
                      payload in proptest::collection::vec(any::<u8>(), 0..100)) {
            let mut buffer = [0xA5; 160];
            let n = emit(&mut buffer, MacAddress(to), MacAddress(from), tag.map(Tag), FrameId(id), &payload).unwrap();
            let frame = Frame::parse(&buffer[..n]).unwrap();
            prop_assert_eq!(frame.destination.0, to);
            prop_assert_eq!(frame.source.0, from);
            prop_assert_eq!(frame.tag, tag.map(Tag));
            prop_assert_eq!(frame.frame_id, FrameId(id));
            prop_assert_eq!(&frame.payload[..payload.len()], &payload[..]);
            prop_assert!(n >= MIN_FRAME);
        }
    }
}
