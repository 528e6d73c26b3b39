//! One priority of an alarm connection: sequence numbers, acknowledgement, repetition.

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::time::Duration;

use crate::Instant;
use crate::wire::alarm::{RtaPdu, RtaType};

/// Number of the first data PDU.
const FIRST: u16 = 0xFFFF;
/// Number "before the first".
const BEFORE_FIRST: u16 = 0xFFFE;
/// Data waiting to be sent at most.
const QUEUE: usize = 16;

const fn following(sequence: u16) -> u16 {
    sequence.wrapping_add(1) & 0x7FFF
}

/// What a received PDU meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Received {
    /// New data: process it. Its acknowledgement is on its way.
    New,
    /// Data received before: acknowledged again, not to be processed.
    Repeated,
    /// Data out of sequence: a NACK is on its way.
    OutOfSequence,
    /// An acknowledgement, or nothing of interest.
    Nothing,
}

/// No acknowledgement after all repetitions: abort with CF 81 FD 08.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotAcknowledged;

#[derive(Debug, Clone)]
struct Outstanding {
    data: Vec<u8>,
    sequence: u16,
    /// Times sent so far.
    sent: u32,
    /// When to send again; `None`: at once.
    due: Option<Instant>,
    /// AckSeqNum of the first sending; repetitions are identical.
    ack: u16,
}

/// One priority of one connection.
///
/// Source: IEC 61158-6-10, alarm protocol machine (RTA): window of one, numbers 0xFFFF, 0, 1 ... 0x7FFF, 0.
#[derive(Debug, Clone)]
pub struct Channel {
    timeout: Duration,
    repetitions: u32,
    next: u16,
    last_sent: u16,
    expected: u16,
    last_received: u16,
    outstanding: Option<Outstanding>,
    queue: VecDeque<Vec<u8>>,
    reply: Option<RtaType>,
}

impl Channel {
    /// Creates a fresh channel: RTATimeoutFactor x 100 ms and RTARetries.
    #[must_use]
    pub const fn new(timeout: Duration, retries: u16) -> Self {
        Self {
            timeout,
            repetitions: retries as u32,
            next: FIRST,
            last_sent: BEFORE_FIRST,
            expected: FIRST,
            last_received: BEFORE_FIRST,
            outstanding: None,
            queue: VecDeque::new(),
            reply: None,
        }
    }

    /// Queues the variable part of a data PDU; false if 16 are waiting already.
    pub fn send(&mut self, data: Vec<u8>) -> bool {
        if self.queue.len() >= QUEUE {
            return false;
        }
        self.queue.push_back(data);
        true
    }

    /// Takes a received PDU of this connection and priority.
    pub fn handle(&mut self, pdu: &RtaPdu<'_>) -> Received {
        let acknowledges = matches!(pdu.kind, RtaType::Ack | RtaType::Data);
        let done = self
            .outstanding
            .as_ref()
            .is_some_and(|o| o.sent > 0 && o.sequence == pdu.ack_sequence);
        if acknowledges && done {
            self.outstanding = None;
        }
        if pdu.kind != RtaType::Data {
            return Received::Nothing;
        }
        if pdu.send_sequence == self.expected {
            self.last_received = self.expected;
            self.expected = following(self.expected);
            self.reply = Some(RtaType::Ack);
            Received::New
        } else if pdu.send_sequence == self.last_received && self.last_received != BEFORE_FIRST {
            self.reply = Some(RtaType::Ack);
            Received::Repeated
        } else {
            self.reply = Some(RtaType::Nack);
            Received::OutOfSequence
        }
    }

    /// Returns the next PDU to send, if any; addresses are left 0 for the caller. The acknowledgement goes before data.
    pub fn poll_transmit(&mut self, now: Instant) -> Option<RtaPdu<'_>> {
        if let Some(kind) = self.reply.take() {
            return Some(self.pdu(kind, RtaPdu::FLAGS, self.last_sent, self.last_received, &[]));
        }
        if self.outstanding.is_none() {
            let data = self.queue.pop_front()?;
            let sequence = self.next;
            self.next = following(sequence);
            self.last_sent = sequence;
            self.outstanding = Some(Outstanding {
                data,
                sequence,
                sent: 0,
                due: None,
                ack: self.last_received,
            });
        }
        let timeout = self.timeout;
        let repetitions = self.repetitions;
        let out = self.outstanding.as_mut()?;
        if out.sent > repetitions || out.due.is_some_and(|due| now < due) {
            return None;
        }
        out.sent += 1;
        out.due = Some(now + timeout);
        let Outstanding { sequence, ack, .. } = *out;
        let out = self.outstanding.as_ref()?;
        Some(self.pdu(RtaType::Data, RtaPdu::FLAGS_DATA, sequence, ack, &out.data))
    }

    const fn pdu<'a>(&self, kind: RtaType, flags: u8, send: u16, ack: u16, data: &'a [u8]) -> RtaPdu<'a> {
        RtaPdu {
            destination: 0,
            source: 0,
            kind,
            version: 1,
            flags,
            send_sequence: send,
            ack_sequence: ack,
            data,
        }
    }

    /// Returns true if the last repetition stayed without an answer.
    ///
    /// # Errors
    /// [`NotAcknowledged`] when it did; the connection is to be aborted.
    pub fn check(&self, now: Instant) -> Result<(), NotAcknowledged> {
        match &self.outstanding {
            Some(out) if out.sent > self.repetitions && out.due.is_some_and(|due| now >= due) => {
                Err(NotAcknowledged)
            }
            _ => Ok(()),
        }
    }

    /// Returns the time of the next repetition or timeout; `None` if nothing is outstanding. An unsent frame is
    /// reported by [`wants_to_send`](Self::wants_to_send).
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Instant> {
        self.outstanding.as_ref().and_then(|out| out.due)
    }

    /// Returns true when [`poll_transmit`](Self::poll_transmit) has something at once.
    #[must_use]
    pub fn wants_to_send(&self) -> bool {
        self.reply.is_some()
            || match &self.outstanding {
                Some(out) => out.due.is_none(),
                None => !self.queue.is_empty(),
            }
    }

    /// Returns true when all data was sent and acknowledged.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.outstanding.is_none() && self.queue.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    fn at(ms: u64) -> Instant {
        Instant::from_millis(ms)
    }

    fn channel() -> Channel {
        Channel::new(Duration::from_millis(100), 3)
    }

    fn data(send: u16, ack: u16) -> RtaPdu<'static> {
        RtaPdu {
            destination: 1,
            source: 1,
            kind: RtaType::Data,
            version: 1,
            flags: 0x11,
            send_sequence: send,
            ack_sequence: ack,
            data: &[],
        }
    }

    fn ack(send: u16, ack: u16) -> RtaPdu<'static> {
        RtaPdu {
            kind: RtaType::Ack,
            flags: 1,
            ..data(send, ack)
        }
    }

    fn numbers(pdu: Option<RtaPdu<'_>>) -> (RtaType, u16, u16) {
        let pdu = pdu.unwrap();
        (pdu.kind, pdu.send_sequence, pdu.ack_sequence)
    }

    #[test]
    fn the_captured_exchange_from_both_sides() {
        let (mut device, mut controller) = (channel(), channel());
        assert!(device.send(vec![1]));
        assert!(device.wants_to_send());
        assert_eq!(
            numbers(device.poll_transmit(at(0))),
            (RtaType::Data, 0xFFFF, 0xFFFE)
        );
        assert_eq!(controller.handle(&data(0xFFFF, 0xFFFE)), Received::New);
        assert_eq!(
            numbers(controller.poll_transmit(at(0))),
            (RtaType::Ack, 0xFFFE, 0xFFFF)
        );
        assert_eq!(device.handle(&ack(0xFFFE, 0xFFFF)), Received::Nothing);
        assert!(device.is_idle());
        assert!(controller.send(vec![2]));
        assert_eq!(
            numbers(controller.poll_transmit(at(0))),
            (RtaType::Data, 0xFFFF, 0xFFFF)
        );
        assert_eq!(device.handle(&data(0xFFFF, 0xFFFF)), Received::New);
        assert_eq!(
            numbers(device.poll_transmit(at(0))),
            (RtaType::Ack, 0xFFFF, 0xFFFF)
        );
        controller.handle(&ack(0xFFFF, 0xFFFF));
        assert!(controller.is_idle());
        // the second alarm
        device.send(vec![3]);
        assert_eq!(numbers(device.poll_transmit(at(9))), (RtaType::Data, 0, 0xFFFF));
        assert_eq!(controller.handle(&data(0, 0xFFFF)), Received::New);
        assert_eq!(
            numbers(controller.poll_transmit(at(9))),
            (RtaType::Ack, 0xFFFF, 0)
        );
    }

    #[test]
    fn a_lost_acknowledgement_leads_to_an_identical_repetition_that_is_not_processed_twice() {
        let (mut device, mut controller) = (channel(), channel());
        device.send(vec![7, 8]);
        let first = device
            .poll_transmit(at(0))
            .map(|p| (p.send_sequence, p.ack_sequence, p.data.to_vec()));
        assert_eq!(controller.handle(&data(0xFFFF, 0xFFFE)), Received::New);
        assert!(controller.poll_transmit(at(0)).is_some(), "lost on the way");
        assert!(device.poll_transmit(at(99)).is_none());
        assert_eq!(device.poll_timeout(), Some(at(100)));
        let second = device
            .poll_transmit(at(100))
            .map(|p| (p.send_sequence, p.ack_sequence, p.data.to_vec()));
        assert_eq!(first, second);
        assert_eq!(
            device.poll_timeout(),
            Some(at(200)),
            "counted from the repetition"
        );
        assert_eq!(controller.handle(&data(0xFFFF, 0xFFFE)), Received::Repeated);
        assert_eq!(
            numbers(controller.poll_transmit(at(100))),
            (RtaType::Ack, 0xFFFE, 0xFFFF)
        );
    }

    #[test]
    fn it_gives_up_after_all_repetitions() {
        let mut device = channel();
        device.send(vec![1]);
        for k in 0..4 {
            assert!(device.poll_transmit(at(k * 100)).is_some(), "sending {k}");
            assert_eq!(device.check(at(k * 100 + 99)), Ok(()));
        }
        assert!(
            device.poll_transmit(at(400)).is_none(),
            "one sending and three repetitions"
        );
        assert_eq!(device.check(at(399)), Ok(()));
        assert_eq!(device.check(at(400)), Err(NotAcknowledged));
    }

    #[test]
    fn data_acknowledges_too() {
        let mut device = channel();
        device.send(vec![1]);
        let _ = device.poll_transmit(at(0));
        assert_eq!(
            device.handle(&data(0xFFFF, 0xFFFF)),
            Received::New,
            "the application's answer overtook the ACK"
        );
        assert!(device.is_idle());
        assert_eq!(device.handle(&ack(0xFFFE, 0xFFFF)), Received::Nothing);
    }

    #[test]
    fn out_of_sequence_is_refused_with_the_last_good_number() {
        let mut channel = channel();
        assert_eq!(channel.handle(&data(5, 0xFFFE)), Received::OutOfSequence);
        assert_eq!(
            numbers(channel.poll_transmit(at(0))),
            (RtaType::Nack, 0xFFFE, 0xFFFE)
        );
        assert_eq!(
            channel.handle(&data(0xFFFE, 0xFFFE)),
            Received::OutOfSequence,
            "never sent by any station"
        );
        assert_eq!(channel.handle(&data(0xFFFF, 0xFFFE)), Received::New);
        assert_eq!(channel.handle(&data(1, 0xFFFE)), Received::OutOfSequence);
        assert_eq!(
            numbers(channel.poll_transmit(at(0))),
            (RtaType::Nack, 0xFFFE, 0xFFFF)
        );
    }

    #[test]
    fn a_wrong_acknowledgement_ends_nothing() {
        let mut channel = channel();
        channel.send(vec![1]);
        channel.handle(&ack(0xFFFE, 0xFFFF));
        assert!(!channel.is_idle(), "not sent yet");
        let _ = channel.poll_transmit(at(0));
        channel.handle(&ack(0xFFFE, 0x1234));
        channel.handle(&RtaPdu {
            kind: RtaType::Nack,
            ..ack(0xFFFE, 0xFFFF)
        });
        assert!(!channel.is_idle());
    }

    #[test]
    fn numbers_wrap_at_seven_fff() {
        let mut sender = channel();
        let mut receiver = channel();
        for k in 0..0x8005u32 {
            sender.send(vec![0]);
            let pdu = sender.poll_transmit(at(0)).unwrap();
            let (send, ack_number) = (pdu.send_sequence, pdu.ack_sequence);
            let expected = if k == 0 { 0xFFFF } else { (k - 1) & 0x7FFF };
            assert_eq!(u32::from(send), expected);
            assert_eq!(receiver.handle(&data(send, ack_number)), Received::New);
            let reply = receiver.poll_transmit(at(0)).unwrap();
            let reply = ack(reply.send_sequence, reply.ack_sequence);
            sender.handle(&reply);
            assert!(sender.is_idle());
        }
    }

    #[test]
    fn the_queue_is_bounded() {
        let mut channel = channel();
        for _ in 0..16 {
            assert!(channel.send(vec![]));
        }
        assert!(!channel.send(vec![]));
    }
}
