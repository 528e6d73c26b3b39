//! Both priorities of one connection: alarms raised, received, acknowledged.

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::time::Duration;

use super::channel::{Channel, Received};
use crate::wire::alarm::{Alarm, AlarmAck, Notification, Priority, RtaPdu, RtaType};
use crate::wire::ethernet::{self, Frame, FrameId, FrameKind, Tag};
use crate::wire::status::abort;
use crate::wire::{PnioStatus, SliceWriter};
use crate::{Instant, MacAddress};

/// Alarms of one priority waiting for their turn at most.
const WAITING: usize = 16;

/// Parameters of an [`Alarms`], as agreed in both AlarmCR blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AlarmConfig {
    /// Own address.
    pub local: MacAddress,
    /// The peer's address.
    pub peer: MacAddress,
    /// Own LocalAlarmReference.
    pub local_reference: u16,
    /// The peer's LocalAlarmReference.
    pub peer_reference: u16,
    /// RTATimeoutFactor x 100 ms.
    pub timeout: Duration,
    /// RTARetries.
    pub retries: u16,
    /// Tag of high priority.
    pub tag_high: Tag,
    /// Tag of low priority.
    pub tag_low: Tag,
    /// Longest alarm block in octets: the smaller MaxAlarmDataLength.
    pub max_length: u16,
    /// AlarmCRProperties bit 0: everything travels with low priority.
    pub low_only: bool,
}

/// What came out of a frame or a deadline.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AlarmEvent {
    /// The peer raised an alarm; answer with [`Alarms::acknowledge`].
    Raised(Notification<'static>),
    /// The peer answered an alarm raised here.
    Acknowledged(AlarmAck),
    /// The peer took an alarm but never answered it; the connection stays.
    Unanswered {
        /// Channel.
        priority: Priority,
        /// Its sequence number.
        sequence: u16,
    },
    /// The peer ended the connection with an ERR PDU.
    AbortedByPeer(PnioStatus),
    /// The connection must be aborted with this status: the peer acknowledges nothing any more.
    Failed(PnioStatus),
}

/// An alarm cannot be raised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum AlarmError {
    /// Too many wait already.
    #[error("{WAITING} alarms of this priority wait already")]
    Full,
    /// Longer than the connection allows.
    #[error("the alarm has {length} octets, the connection allows {limit}")]
    TooLong {
        /// Octets of the block.
        length: usize,
        /// Limit agreed at connect time.
        limit: u16,
    },
}

#[derive(Debug, Clone)]
struct Side {
    channel: Channel,
    sequence: u16,
    waiting: VecDeque<Notification<'static>>,
    /// Alarm sent, and until when its answer may come.
    active: Option<(Notification<'static>, Instant)>,
}

impl Side {
    fn new(config: &AlarmConfig) -> Self {
        Self {
            channel: Channel::new(config.timeout, config.retries),
            sequence: 0,
            waiting: VecDeque::new(),
            active: None,
        }
    }

    /// Passes the next alarm to the channel if none is unanswered.
    fn start_next(&mut self, now: Instant, timeout: Duration) {
        if self.active.is_some() {
            return;
        }
        let Some(alarm) = self.waiting.pop_front() else {
            return;
        };
        let mut block = Vec::with_capacity(alarm.len());
        alarm.encode(&mut block);
        self.channel.send(block);
        self.active = Some((alarm, now + timeout));
    }
}

/// The alarm connection of one application AR.
///
/// One alarm per priority is under way at a time; up to 16 more wait. An alarm that is taken but not answered within
/// ten times the RTA time-out is dropped, the connection stays.
///
/// ```
/// # use core::time::Duration;
/// # use std::borrow::Cow;
/// use profidrive_profinet::alarm::{AlarmConfig, AlarmEvent, Alarms};
/// use profidrive_profinet::wire::alarm::{AlarmSpecifier, AlarmType, Notification, Priority};
/// use profidrive_profinet::wire::ethernet::{Frame, Tag};
/// use profidrive_profinet::{Instant, MacAddress};
///
/// let (a, b) = (MacAddress([2, 0, 0, 0, 0, 1]), MacAddress([2, 0, 0, 0, 0, 2]));
/// let config = AlarmConfig {
///     local: a, peer: b, local_reference: 1, peer_reference: 7, timeout: Duration::from_millis(100), retries: 3,
///     tag_high: Tag::PRIORITY_6, tag_low: Tag::PRIORITY_5, max_length: 200, low_only: false,
/// };
/// let mut device = Alarms::new(config);
/// let mut controller =
///     Alarms::new(AlarmConfig { local: b, peer: a, local_reference: 7, peer_reference: 1, ..config });
/// let alarm = Notification {
///     priority: Priority::Low, alarm_type: AlarmType::RETURN_OF_SUBMODULE, api: 0, slot: 1, subslot: 1,
///     module_ident: 1, submodule_ident: 1, specifier: AlarmSpecifier(0), usi: None, data: Cow::Borrowed(&[]),
/// };
/// let now = Instant::ZERO;
/// device.raise(now, alarm).unwrap();
/// let mut buffer = [0; 1518];
/// let length = device.poll_transmit(now, &mut buffer).unwrap();
/// let event = controller.handle_frame(now, &Frame::parse(&buffer[..length]).unwrap());
/// assert!(matches!(event, Some(AlarmEvent::Raised(_))));
/// ```
#[derive(Debug, Clone)]
pub struct Alarms {
    config: AlarmConfig,
    high: Side,
    low: Side,
    error: Option<PnioStatus>,
}

impl Alarms {
    /// Creates a fresh connection.
    #[must_use]
    pub fn new(config: AlarmConfig) -> Self {
        Self {
            config,
            high: Side::new(&config),
            low: Side::new(&config),
            error: None,
        }
    }

    /// Returns its settings.
    #[must_use]
    pub const fn config(&self) -> &AlarmConfig {
        &self.config
    }

    const fn side(&mut self, priority: Priority) -> &mut Side {
        match priority {
            Priority::High => &mut self.high,
            Priority::Low => &mut self.low,
        }
    }

    fn timeout(&self) -> Duration {
        self.config.timeout * (u32::from(self.config.retries) + 1) * 10
    }

    /// Raises an alarm. Its priority follows from its type and the connection; its sequence number is given here and
    /// returned.
    ///
    /// # Errors
    /// When it is too long for the connection, or too many wait.
    pub fn raise(&mut self, now: Instant, mut alarm: Notification<'static>) -> Result<u16, AlarmError> {
        let limit = self.config.max_length;
        if alarm.len() > usize::from(limit) {
            return Err(AlarmError::TooLong {
                length: alarm.len(),
                limit,
            });
        }
        alarm.priority = if self.config.low_only {
            Priority::Low
        } else {
            alarm.alarm_type.priority()
        };
        let timeout = self.timeout();
        let side = self.side(alarm.priority);
        if side.waiting.len() >= WAITING {
            return Err(AlarmError::Full);
        }
        let sequence = side.sequence;
        side.sequence = (sequence + 1) & 0x07FF;
        alarm.specifier = alarm.specifier.with_sequence(sequence);
        side.waiting.push_back(alarm);
        side.start_next(now, timeout);
        Ok(sequence)
    }

    /// Answers a received alarm; false if too many answers wait already.
    pub fn acknowledge(&mut self, alarm: &Notification<'_>, status: PnioStatus) -> bool {
        let mut block = Vec::with_capacity(22);
        AlarmAck::to(alarm, status).encode(&mut block);
        self.side(alarm.priority).channel.send(block)
    }

    /// Returns true if this frame belongs to this connection: kind of frame, sender and both alarm references. The
    /// peer's reference distinguishes its former connection from this one when our own reference is the same in both.
    #[must_use]
    pub fn is_for_us(&self, frame: &Frame<'_>) -> bool {
        let references = frame
            .payload
            .first_chunk::<4>()
            .map(|[a, b, c, d]| (u16::from_be_bytes([*a, *b]), u16::from_be_bytes([*c, *d])));
        matches!(frame.frame_id.kind(), FrameKind::AlarmHigh | FrameKind::AlarmLow)
            && frame.source == self.config.peer
            && references == Some((self.config.local_reference, self.config.peer_reference))
    }

    /// Takes a received frame; frames of others and malformed ones are ignored.
    pub fn handle_frame(&mut self, now: Instant, frame: &Frame<'_>) -> Option<AlarmEvent> {
        if !self.is_for_us(frame) {
            return None;
        }
        let pdu = RtaPdu::parse(frame.payload).ok().filter(|pdu| pdu.version == 1)?;
        if pdu.kind == RtaType::Err {
            return pdu.error().ok().map(AlarmEvent::AbortedByPeer);
        }
        let priority = match frame.frame_id.kind() {
            FrameKind::AlarmHigh => Priority::High,
            _ => Priority::Low,
        };
        // frames that cannot be decoded are not acknowledged either
        let alarm = match pdu.kind {
            RtaType::Data => Some(pdu.alarm().ok()?),
            _ => None,
        };
        let timeout = self.timeout();
        let side = self.side(priority);
        if side.channel.handle(&pdu) != Received::New {
            return None;
        }
        match alarm? {
            Alarm::Notification(alarm) => Some(AlarmEvent::Raised(Notification {
                priority,
                ..alarm.into_owned()
            })),
            Alarm::Ack(ack) => {
                let answered = side.active.as_ref().is_some_and(|(alarm, _)| {
                    (alarm.alarm_type, alarm.specifier.sequence())
                        == (ack.alarm_type, ack.specifier.sequence())
                });
                if !answered {
                    return None;
                }
                side.active = None;
                side.start_next(now, timeout);
                Some(AlarmEvent::Acknowledged(ack))
            }
        }
    }

    /// Does what is due; call until it gives nothing.
    pub fn handle_timeout(&mut self, now: Instant) -> Option<AlarmEvent> {
        let timeout = self.timeout();
        for priority in [Priority::High, Priority::Low] {
            let side = self.side(priority);
            if side.channel.check(now).is_err() {
                return Some(AlarmEvent::Failed(PnioStatus::aborted(abort::ALARM_SEND)));
            }
            if side.active.as_ref().is_some_and(|(_, until)| now >= *until) {
                let sequence = side
                    .active
                    .take()
                    .map_or(0, |(alarm, _)| alarm.specifier.sequence());
                side.start_next(now, timeout);
                return Some(AlarmEvent::Unanswered { priority, sequence });
            }
        }
        None
    }

    /// Queues an ERR PDU that ends the connection; it is sent before anything else.
    pub const fn abort(&mut self, status: PnioStatus) {
        self.error = Some(status);
    }

    /// Writes the ERR PDU requested by [`abort`](Self::abort), and nothing else.
    pub fn poll_error(&mut self, buffer: &mut [u8]) -> Option<usize> {
        let status = self.error.take()?;
        emit_error(buffer, &self.config, status)
    }

    /// Writes the next frame to send; returns its length.
    pub fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        if let Some(length) = self.poll_error(buffer) {
            return Some(length);
        }
        let config = self.config;
        for (side, id, tag) in [
            (&mut self.high, FrameId::ALARM_HIGH, config.tag_high),
            (&mut self.low, FrameId::ALARM_LOW, config.tag_low),
        ] {
            if let Some(pdu) = side.channel.poll_transmit(now) {
                return emit(buffer, &config, id, tag, pdu);
            }
        }
        None
    }

    /// Returns the time at which [`handle_timeout`](Self::handle_timeout) or [`poll_transmit`](Self::poll_transmit) is
    /// due.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Instant> {
        let until = |side: &Side| side.active.as_ref().map(|(_, until)| *until);
        Instant::earliest([
            self.high.channel.poll_timeout(),
            until(&self.high),
            self.low.channel.poll_timeout(),
            until(&self.low),
        ])
    }
}

fn emit(buffer: &mut [u8], config: &AlarmConfig, id: FrameId, tag: Tag, pdu: RtaPdu<'_>) -> Option<usize> {
    let pdu = RtaPdu {
        destination: config.peer_reference,
        source: config.local_reference,
        ..pdu
    };
    let header = ethernet::emit_header(buffer, config.peer, config.local, Some(tag), id)?;
    let mut out = SliceWriter::new(buffer.get_mut(header..)?);
    pdu.encode(&mut out);
    let length = header + out.finish().ok()?;
    Some(ethernet::pad(buffer, length))
}

/// Writes the frame of an ERR PDU without a connection: the last word of one that is already gone.
#[must_use]
pub fn emit_error(buffer: &mut [u8], config: &AlarmConfig, status: PnioStatus) -> Option<usize> {
    let bytes = status.to_u32().to_be_bytes();
    let pdu = RtaPdu {
        destination: 0,
        source: 0,
        kind: RtaType::Err,
        version: 1,
        flags: RtaPdu::FLAGS,
        send_sequence: 0xFFFE,
        ack_sequence: 0xFFFE,
        data: &bytes,
    };
    emit(buffer, config, FrameId::ALARM_LOW, config.tag_low, pdu)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::alarm::{AlarmSpecifier, AlarmType};
    use alloc::borrow::Cow;
    use alloc::vec;

    const A: MacAddress = MacAddress([2, 0x50, 0x4e, 0, 0, 1]);
    const B: MacAddress = MacAddress([2, 0x50, 0x4e, 0, 0, 2]);

    fn pair() -> (Alarms, Alarms) {
        let config = AlarmConfig {
            local: A,
            peer: B,
            local_reference: 1,
            peer_reference: 1,
            timeout: Duration::from_millis(100),
            retries: 3,
            tag_high: Tag::PRIORITY_6,
            tag_low: Tag::PRIORITY_5,
            max_length: 200,
            low_only: false,
        };
        (
            Alarms::new(config),
            Alarms::new(AlarmConfig {
                local: B,
                peer: A,
                ..config
            }),
        )
    }

    fn alarm(kind: AlarmType, size: usize) -> Notification<'static> {
        Notification {
            priority: Priority::Low,
            alarm_type: kind,
            api: 0,
            slot: 1,
            subslot: 1,
            module_ident: 0x30,
            submodule_ident: 0x130,
            specifier: AlarmSpecifier(0),
            usi: Some(0x10),
            data: Cow::Owned(vec![1; size]),
        }
    }

    fn at(ms: u64) -> Instant {
        Instant::from_millis(ms)
    }

    /// Carries all frames once from one side to the other.
    fn carry(now: Instant, from: &mut Alarms, to: &mut Alarms) -> Vec<AlarmEvent> {
        let mut events = vec![];
        let mut buffer = [0xA5; 1518];
        while let Some(length) = from.poll_transmit(now, &mut buffer) {
            assert!(length >= 60);
            events.extend(to.handle_frame(now, &Frame::parse(&buffer[..length]).unwrap()));
        }
        events
    }

    #[test]
    fn the_first_frame_equals_the_capture() {
        let (mut device, _) = pair();
        device.raise(at(0), alarm(AlarmType::PROCESS, 1)).unwrap();
        let mut buffer = [0; 1518];
        let length = device.poll_transmit(at(0), &mut buffer).unwrap();
        let golden = [
            0x02, 0x50, 0x4e, 0x00, 0x00, 0x02, 0x02, 0x50, 0x4e, 0x00, 0x00, 0x01, 0x81, 0x00, 0xc0, 0x00,
            0x88, 0x92, 0xfc, 0x01, 0x00, 0x01, 0x00, 0x01, 0x11, 0x11, 0xff, 0xff, 0xff, 0xfe, 0x00, 0x1d,
            0x00, 0x01, 0x00, 0x19, 0x01, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0x01,
            0x00, 0x00, 0x00, 0x30, 0x00, 0x00, 0x01, 0x30, 0x00, 0x00, 0x00, 0x10, 0x01,
        ];
        assert_eq!(&buffer[..length], golden);
    }

    #[test]
    fn the_last_word_of_a_former_connection_is_not_for_this_one() {
        let (device, mut controller) = pair();
        let former = AlarmConfig {
            local_reference: 2,
            ..*device.config()
        };
        let mut buffer = [0; 1518];
        let cause = PnioStatus::aborted(abort::DATA_HOLD);
        for (config, expected) in [
            (former, None),
            (*device.config(), Some(AlarmEvent::AbortedByPeer(cause))),
        ] {
            let length = emit_error(&mut buffer, &config, cause).unwrap();
            let frame = Frame::parse(&buffer[..length]).unwrap();
            assert_eq!(controller.handle_frame(at(0), &frame), expected);
        }
    }

    #[test]
    fn raise_receive_acknowledge() {
        let (mut device, mut controller) = pair();
        assert_eq!(device.raise(at(0), alarm(AlarmType::DIAGNOSIS, 4)), Ok(0));
        assert_eq!(
            device.raise(at(0), alarm(AlarmType::DIAGNOSIS_DISAPPEARS, 4)),
            Ok(1)
        );
        assert_eq!(
            device.raise(at(0), alarm(AlarmType::PROCESS, 4)),
            Ok(0),
            "counts per priority"
        );
        let events = carry(at(0), &mut device, &mut controller);
        let [AlarmEvent::Raised(high), AlarmEvent::Raised(low)] = &events[..] else {
            panic!("{events:?}")
        };
        assert_eq!((high.priority, low.priority), (Priority::High, Priority::Low));
        assert!(controller.acknowledge(low, PnioStatus::OK));
        let events = carry(at(1), &mut controller, &mut device);
        let [AlarmEvent::Acknowledged(ack)] = events[..] else {
            panic!("{events:?}")
        };
        assert_eq!(ack.alarm_type, AlarmType::DIAGNOSIS);
        let events = carry(at(2), &mut device, &mut controller);
        let [AlarmEvent::Raised(second)] = &events[..] else {
            panic!("{events:?}")
        };
        assert_eq!(
            (second.alarm_type, second.specifier.sequence()),
            (AlarmType::DIAGNOSIS_DISAPPEARS, 1)
        );
    }

    #[test]
    fn a_lost_frame_is_repeated_and_a_silent_peer_ends_the_connection() {
        let (mut device, mut controller) = pair();
        device.raise(at(0), alarm(AlarmType::PROCESS, 1)).unwrap();
        let mut buffer = [0; 1518];
        assert!(device.poll_transmit(at(0), &mut buffer).is_some(), "lost");
        assert_eq!(device.poll_timeout(), Some(at(100)));
        assert_eq!(carry(at(100), &mut device, &mut controller).len(), 1);
        // its acknowledgement is lost as well: the repetition is not an alarm again
        assert!(controller.poll_transmit(at(100), &mut buffer).is_some());
        assert_eq!(carry(at(200), &mut device, &mut controller), []);
        assert!(controller.poll_transmit(at(200), &mut buffer).is_some());
        assert_eq!(carry(at(300), &mut device, &mut controller), []);
        assert_eq!(device.handle_timeout(at(399)), None);
        assert_eq!(
            device.handle_timeout(at(400)),
            Some(AlarmEvent::Failed(PnioStatus::aborted(8)))
        );
    }

    #[test]
    fn an_unanswered_alarm_is_dropped_and_the_next_one_sent() {
        let (mut device, mut controller) = pair();
        device.raise(at(0), alarm(AlarmType::DIAGNOSIS, 1)).unwrap();
        device.raise(at(0), alarm(AlarmType::DIAGNOSIS, 2)).unwrap();
        assert_eq!(carry(at(0), &mut device, &mut controller).len(), 1);
        carry(at(0), &mut controller, &mut device);
        assert_eq!(device.poll_timeout(), Some(at(4000)));
        assert_eq!(device.handle_timeout(at(3999)), None);
        let event = device.handle_timeout(at(4000));
        assert_eq!(
            event,
            Some(AlarmEvent::Unanswered {
                priority: Priority::Low,
                sequence: 0
            })
        );
        assert_eq!(carry(at(4000), &mut device, &mut controller).len(), 1);
    }

    #[test]
    fn err_ends_it_and_foreign_frames_do_not() {
        let (mut device, mut controller) = pair();
        device.abort(PnioStatus::aborted(5));
        let mut buffer = [0; 1518];
        let length = device.poll_transmit(at(0), &mut buffer).unwrap();
        let frame = Frame::parse(&buffer[..length]).unwrap();
        assert_eq!(frame.frame_id, FrameId::ALARM_LOW);
        assert_eq!(
            controller.handle_frame(at(0), &Frame { source: B, ..frame }),
            None
        );
        let mut other = frame.payload.to_vec();
        other[1] = 2;
        assert_eq!(
            controller.handle_frame(
                at(0),
                &Frame {
                    payload: &other,
                    ..frame
                }
            ),
            None
        );
        for cut in 0..16 {
            assert_eq!(
                controller.handle_frame(
                    at(0),
                    &Frame {
                        payload: &frame.payload[..cut],
                        ..frame
                    }
                ),
                None
            );
        }
        let event = controller.handle_frame(at(0), &frame);
        assert_eq!(event, Some(AlarmEvent::AbortedByPeer(PnioStatus::aborted(5))));
    }

    #[test]
    fn limits() {
        let (mut device, _) = pair();
        assert!(device.raise(at(0), alarm(AlarmType::PROCESS, 172)).is_ok());
        assert_eq!(
            device.raise(at(0), alarm(AlarmType::PROCESS, 173)),
            Err(AlarmError::TooLong {
                length: 201,
                limit: 200
            })
        );
        for _ in 0..16 {
            device.raise(at(0), alarm(AlarmType::PROCESS, 1)).unwrap();
        }
        assert_eq!(
            device.raise(at(0), alarm(AlarmType::PROCESS, 1)),
            Err(AlarmError::Full)
        );
        let mut low = Alarms::new(AlarmConfig {
            low_only: true,
            ..*device.config()
        });
        low.raise(at(0), alarm(AlarmType::PROCESS, 1)).unwrap();
        let mut buffer = [0; 1518];
        let length = low.poll_transmit(at(0), &mut buffer).unwrap();
        assert_eq!(
            Frame::parse(&buffer[..length]).unwrap().frame_id,
            FrameId::ALARM_LOW
        );
    }
}
