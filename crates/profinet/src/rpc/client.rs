//! Makes calls: sends, repeats, pings, joins the answer, or returns the cause of its absence.

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::net::{Ipv4Addr, SocketAddrV4};
use core::time::Duration;

use super::fragment::{Incoming, Outgoing, Progress};
use super::path::{PathCount, Paths};
use crate::Instant;
use crate::wire::rpc::{FackBody, Flags, Header, PacketType, reject};
use crate::wire::{ByteOrder, Reader, SliceWriter};

/// Names a call of a [`Client`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CallId(u32);

/// How long and how often a [`Client`] tries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClientConfig {
    /// Without an answer a PDU is sent again after this time.
    pub wait: Duration,
    /// How often a PDU is sent before the call fails.
    pub sends: u8,
    /// Time after which a call fails even if the server answers "working".
    pub limit: Duration,
    /// Longest answer in octets.
    pub stub: usize,
}

impl Default for ClientConfig {
    fn default() -> Self {
        Self {
            wait: Duration::from_secs(2),
            sends: 3,
            limit: Duration::from_secs(60),
            stub: 64 * 1024,
        }
    }
}

/// The answer to a call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply {
    /// Byte order of the server.
    pub order: ByteOrder,
    /// Body, all fragments joined.
    pub stub: Vec<u8>,
}

/// Why a call has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CallError {
    /// Nothing came back.
    #[error("no answer after {sends} sends{path}")]
    Timeout {
        /// How often the request was sent.
        sends: u8,
        /// What became of the requests before.
        path: PathCount,
    },
    /// The server was still working when the time was over.
    #[error("the server did not finish within {} s", limit.as_secs())]
    NeverFinished {
        /// The time allowed.
        limit: Duration,
    },
    /// The server did not execute the call.
    #[error("call rejected: {status:#010x} {words}", status = .0, words = reject::words(*.0).unwrap_or("unknown reason"))]
    Rejected(u32),
    /// The call failed in the server.
    #[error("call failed in the server: {status:#010x} {words}", status = .0, words = reject::words(*.0).unwrap_or("unknown reason"))]
    Fault(u32),
    /// The answer is longer than allowed, or its fragments do not fit together.
    #[error("malformed or too long fragmented answer")]
    BadAnswer,
}

#[derive(Debug)]
struct Pending {
    id: CallId,
    server: SocketAddrV4,
    header: Header,
    out: Outgoing,
    send_request: bool,
    send_ping: bool,
    working: bool,
    incoming: Option<Incoming>,
    sends: u8,
    /// Requests and pings since the last answer.
    unanswered: u8,
    due: Instant,
    limit: Instant,
    /// Until then an answer to what was sent last is likely: see [`AWAITED`].
    awaited: Option<Instant>,
}

impl Pending {
    const fn is_to_send(&self) -> bool {
        self.send_request || self.send_ping
    }

    /// Goes on to the next fragment of the request if this one was waited for.
    fn acknowledged(&mut self, fragment: u16) {
        if self.out.acknowledge(fragment) {
            self.sends = 0;
            self.send_request = true;
        }
    }
}

/// Calls whose answers are awaited at the same time. The answers to hundreds of calls arrive at once and are more than the
/// receive buffer of a socket holds; the repetitions of those that are lost would be as many again.
const AWAITED: usize = 32;
/// How long an answer counts as awaited: calls to servers that are slow or gone keep the others waiting no longer.
const LIKELY: Duration = Duration::from_millis(20);
/// Acknowledgements that may wait to be sent.
const QUEUE: usize = 32;

/// Makes calls without sockets. Several calls may be open at once, each in an activity of its own.
///
/// ```
/// use std::net::{Ipv4Addr, SocketAddrV4};
/// use profidrive_profinet::Instant;
/// use profidrive_profinet::rpc::{CallError, Client, ClientConfig};
/// use profidrive_profinet::wire::Uuid;
/// use profidrive_profinet::wire::rpc::{Header, operation};
///
/// let mut client = Client::new(ClientConfig::default());
/// let header = Header::request(Uuid::NIL, Uuid::DEVICE_INTERFACE, Uuid([7; 16]), 0, operation::READ);
/// let device = SocketAddrV4::new(Ipv4Addr::new(10, 0, 0, 2), profidrive_profinet::RPC_PORT);
/// let call = client.call(Instant::ZERO, device, header, b"stub".to_vec());
/// let mut buffer = [0; 1518];
/// for second in [0, 2, 4, 6] {
///     client.handle_timeout(Instant::from_millis(second * 1000));
///     while client.poll_transmit(Instant::from_millis(second * 1000), &mut buffer).is_some() {}
/// }
/// assert_eq!(client.poll_event(), Some((call, Err(CallError::Timeout { sends: 3, path: Default::default() }))));
/// ```
#[derive(Debug)]
pub struct Client {
    config: ClientConfig,
    calls: Vec<Pending>,
    shorts: VecDeque<(SocketAddrV4, Header, Option<FackBody>)>,
    events: VecDeque<(CallId, Result<Reply, CallError>)>,
    next: u32,
    serial: u16,
    paths: Paths,
}

impl Client {
    /// Creates a client without calls.
    #[must_use]
    pub const fn new(config: ClientConfig) -> Self {
        Self {
            config,
            calls: Vec::new(),
            shorts: VecDeque::new(),
            events: VecDeque::new(),
            next: 0,
            serial: 0,
            paths: Paths::new(),
        }
    }

    /// Starts a call. `header` comes from [`Header::request`]; its activity must not have another call open, and
    /// its sequence number is one more than that of the activity's call before.
    pub fn call(&mut self, now: Instant, server: SocketAddrV4, header: Header, stub: Vec<u8>) -> CallId {
        self.next = self.next.wrapping_add(1);
        let id = CallId(self.next);
        self.calls.push(Pending {
            id,
            server,
            header,
            out: Outgoing::new(stub),
            send_request: true,
            send_ping: false,
            working: false,
            incoming: None,
            sends: 0,
            unanswered: 0,
            due: now + self.config.wait,
            limit: now + self.config.limit,
            awaited: None,
        });
        id
    }

    /// Cancels a call; no event follows.
    pub fn cancel(&mut self, id: CallId) {
        self.calls.retain(|call| call.id != id);
        self.events.retain(|event| event.0 != id);
    }

    /// Counts requests of another protocol to a server: so many were sent, the last one was answered.
    pub fn note_answered(&mut self, server: Ipv4Addr, sends: u8) {
        self.paths.ended(server, sends, true);
    }

    /// Returns true while the call has no result.
    #[must_use]
    pub fn is_open(&self, id: CallId) -> bool {
        self.calls.iter().any(|call| call.id == id)
    }

    /// Takes a datagram that arrived at the client's port. True if it belongs to an open call.
    pub fn handle(&mut self, now: Instant, source: SocketAddrV4, pdu: &[u8]) -> bool {
        let Ok((header, body)) = Header::decode(pdu) else {
            return false;
        };
        let config = self.config;
        let Some(index) = self.calls.iter().position(|call| {
            call.header.activity == header.activity
                && call.header.sequence == header.sequence
                && call.server.ip() == source.ip()
        }) else {
            return false;
        };
        let Some(call) = self.calls.get_mut(index) else {
            return false;
        };
        call.awaited = None;
        if call.unanswered > 0 {
            self.paths.ended(*call.server.ip(), call.unanswered, true);
            call.unanswered = 0;
        }
        let mut result = None;
        match header.packet_type {
            PacketType::Working => {
                call.working = true;
                call.sends = 1;
                call.due = now + config.wait;
            }
            PacketType::NoCall => {
                call.working = false;
                if call.sends < config.sends {
                    call.out.rewind();
                    call.send_request = true;
                }
            }
            PacketType::Fack => call.acknowledged(header.fragment),
            PacketType::Reject | PacketType::Fault => {
                let status = Reader::new(body).u32_in(header.order, "status").unwrap_or(0);
                result = Some(Err(if header.packet_type == PacketType::Reject {
                    CallError::Rejected(status)
                } else {
                    CallError::Fault(status)
                }));
            }
            PacketType::Response => {
                let limit = config.stub;
                let incoming = call
                    .incoming
                    .get_or_insert_with(|| Incoming::new(header.order, call.limit));
                call.sends = 1;
                call.due = now + config.wait;
                match incoming.take(&header, body, limit) {
                    Progress::Nothing => {}
                    Progress::Broken => result = Some(Err(CallError::BadAnswer)),
                    Progress::Acknowledge(fragment) => {
                        let mut fack = header.reply(PacketType::Fack);
                        fack.fragment = fragment;
                        self.shorts
                            .push_back((source, fack, Some(FackBody::new(header.serial))));
                    }
                    Progress::Complete => {
                        let stub = call.incoming.take().map(Incoming::into_stub).unwrap_or_default();
                        if header.flags.is_fragment() {
                            self.shorts
                                .push_back((source, header.reply(PacketType::Ack), None));
                        }
                        result = Some(Ok(Reply {
                            order: header.order,
                            stub,
                        }));
                    }
                }
            }
            _ => {}
        }
        // the server repeats what is not acknowledged
        self.shorts.truncate(QUEUE);
        if let Some(result) = result {
            let call = self.calls.swap_remove(index);
            self.events.push_back((call.id, result));
        }
        true
    }

    /// Returns the next call that ended.
    pub fn poll_event(&mut self) -> Option<(CallId, Result<Reply, CallError>)> {
        self.events.pop_front()
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Instant) {
        let config = self.config;
        let (events, paths) = (&mut self.events, &mut self.paths);
        self.calls.retain_mut(|call| {
            call.awaited = call.awaited.filter(|until| now < *until);
            let error = if now >= call.limit {
                CallError::NeverFinished { limit: config.limit }
            } else if now < call.due {
                return true;
            } else if call.sends < config.sends {
                call.due = now + config.wait;
                if call.working || call.incoming.is_some() {
                    call.send_ping = true;
                } else {
                    call.send_request = true;
                }
                return true;
            } else {
                let server = *call.server.ip();
                let path = paths.count(server);
                paths.ended(server, call.unanswered, false);
                CallError::Timeout {
                    sends: call.sends,
                    path,
                }
            };
            events.push_back((call.id, Err(error)));
            false
        });
    }

    /// Returns the time of the next timeout.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Instant> {
        let due = self.calls.iter().map(|call| call.due.min(call.limit)).min();
        // what waits for room is sent once an answer is no longer likely
        let room = || self.calls.iter().filter_map(|call| call.awaited).min();
        let waits = self.calls.iter().any(Pending::is_to_send);
        due.into_iter().chain(waits.then(room).flatten()).min()
    }

    /// Writes the next datagram and returns its destination.
    #[must_use]
    pub fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<(SocketAddrV4, usize)> {
        let mut out = SliceWriter::new(buffer);
        if let Some((to, mut header, body)) = self.shorts.pop_front() {
            self.serial = self.serial.wrapping_add(1);
            header.serial = self.serial;
            header.encode(&mut out, if body.is_some() { 16 } else { 0 });
            if let Some(fack) = body {
                fack.encode(&mut out, header.order);
            }
            return Some((to, out.finish().ok()?));
        }
        let wait = self.config.wait;
        let mut awaited = 0;
        let mut next = None;
        for call in &mut self.calls {
            awaited += usize::from(call.awaited.is_some_and(|until| now < until));
            if next.is_none() && call.is_to_send() {
                next = Some(call);
            }
        }
        let call = next.filter(|_| awaited < AWAITED)?;
        call.awaited = Some(now + LIKELY);
        self.serial = self.serial.wrapping_add(1);
        call.sends = call.sends.saturating_add(1);
        call.unanswered = call.unanswered.saturating_add(1);
        call.due = now + wait;
        if call.send_request {
            call.send_request = false;
            call.out.encode(&call.header, self.serial, &mut out);
        } else {
            let ping = Header {
                packet_type: PacketType::Ping,
                flags: Flags(0),
                serial: self.serial,
                ..call.header
            };
            ping.encode(&mut out, 0);
        }
        call.send_ping = false;
        Some((call.server, out.finish().ok()?))
    }
}
