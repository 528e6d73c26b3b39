//! Answers calls: joins fragments, never executes a call twice, reports the state of a call.

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::net::{Ipv4Addr, SocketAddrV4};
use core::time::Duration;

use super::fragment::{Incoming, Outgoing, Progress};
use crate::Instant;
use crate::wire::rpc::{FackBody, Flags, Header, MAX_PDU, PacketType, reject};
use crate::wire::{ByteOrder, SliceWriter, Uuid, Writer};

/// How long a fragment may wait for its acknowledgement before it is sent again.
const FACK_WAIT: Duration = Duration::from_secs(2);
/// How often a fragment is sent before the answer is given up.
const FACK_SENDS: u8 = 3;
/// How long the next fragment of a request may take.
const REASSEMBLY: Duration = Duration::from_secs(5);
/// Time for which an answer is stored for a client that did not get it.
const KEEP: Duration = Duration::from_secs(60);
/// Short answers (working, nocall, fack, reject) that may wait to be sent.
const QUEUE: usize = 32;

/// An interface a [`Server`] offers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interface {
    /// Its UUID.
    pub uuid: Uuid,
    /// Operations below this number exist.
    pub operations: u16,
}

/// What a [`Server`] spends on its clients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ServerLimits {
    /// Clients (activities) stored at once.
    pub activities: usize,
    /// Maximum number of activities of one address, so that one client cannot displace all others.
    pub activities_per_address: usize,
    /// Longest request stub in octets.
    pub stub: usize,
}

impl Default for ServerLimits {
    fn default() -> Self {
        Self {
            activities: 24,
            activities_per_address: 12,
            stub: 64 * 1024,
        }
    }
}

/// Names one call: needed to answer it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct CallKey {
    /// Address of the client.
    pub address: Ipv4Addr,
    /// Its activity.
    pub activity: Uuid,
    /// Number of the call.
    pub sequence: u32,
}

/// A call to execute and then to [answer](Server::respond).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Call {
    /// Its name.
    pub key: CallKey,
    /// Where it came from.
    pub source: SocketAddrV4,
    /// Target object.
    pub object: Uuid,
    /// Interface called.
    pub interface: Uuid,
    /// Operation called.
    pub operation: u16,
    /// Byte order of the client; the answer uses the same.
    pub order: ByteOrder,
    /// Body, all fragments joined.
    pub stub: Vec<u8>,
}

#[derive(Debug)]
enum State {
    Receiving(Incoming),
    Executing,
    Answering {
        kind: PacketType,
        out: Outgoing,
        pending: bool,
        resend: Option<Instant>,
        sends: u8,
    },
    /// Answered and no longer stored: repetitions are dropped.
    Forgotten,
    /// Never complete, so nothing was executed: its first fragment may come again.
    Dropped,
}

#[derive(Debug)]
struct Activity {
    peer: SocketAddrV4,
    header: Header,
    /// Digest of the body of the first PDU of the call: distinguishes a repetition from another call with the same
    /// number.
    digest: u64,
    state: State,
    used: Instant,
}

#[derive(Debug, Clone, Copy)]
enum Short {
    Empty,
    Status(u32),
    Fack(FackBody),
}

/// Serves calls without sockets: datagrams in, calls out, answers in, datagrams out.
///
/// Per client activity the last call number and its answer are kept: a repeated request gets the same answer
/// again, a request still being executed is answered "working", an older one is dropped. Memory is bounded by
/// [`ServerLimits`].
///
/// ```
/// use std::net::{Ipv4Addr, SocketAddrV4};
/// use profidrive_profinet::Instant;
/// use profidrive_profinet::rpc::{Interface, Server, ServerLimits};
/// use profidrive_profinet::wire::Uuid;
/// use profidrive_profinet::wire::rpc::{Header, operation};
///
/// let interface = Interface { uuid: Uuid::DEVICE_INTERFACE, operations: operation::COUNT };
/// let mut server = Server::new(vec![interface], ServerLimits::default());
/// let mut request = Vec::new();
/// Header::request(Uuid::NIL, Uuid::DEVICE_INTERFACE, Uuid([7; 16]), 0, operation::READ).encode(&mut request, 0);
/// let client = SocketAddrV4::new(Ipv4Addr::new(10, 0, 0, 1), 50000);
/// let call = server.handle(Instant::ZERO, client, &request).unwrap();
/// server.respond(Instant::ZERO, call.key, b"the answer".to_vec());
/// let mut buffer = [0; 1518];
/// assert_eq!(server.poll_transmit(Instant::ZERO, &mut buffer), Some((client, 80 + 10)));
/// // the same request again: not executed, answered again
/// assert_eq!(server.handle(Instant::ZERO, client, &request), None);
/// assert_eq!(server.poll_transmit(Instant::ZERO, &mut buffer), Some((client, 80 + 10)));
/// ```
#[derive(Debug)]
pub struct Server {
    interfaces: Vec<Interface>,
    limits: ServerLimits,
    activities: Vec<Activity>,
    shorts: VecDeque<(SocketAddrV4, Header, Short)>,
    serial: u16,
    /// Nothing is waiting to be sent.
    quiet: bool,
    /// When something is due next: kept, because a controller of many devices stores as many activities and looks at
    /// each turn.
    next: Option<Instant>,
}

/// FNV-1a.
fn digest(body: &[u8]) -> u64 {
    body.iter().fold(0xCBF2_9CE4_8422_2325, |hash, octet| {
        (hash ^ u64::from(*octet)).wrapping_mul(0x0000_0100_0000_01B3)
    })
}

impl Server {
    /// Offers these interfaces.
    #[must_use]
    pub fn new(interfaces: Vec<Interface>, limits: ServerLimits) -> Self {
        Self {
            interfaces,
            limits,
            activities: Vec::new(),
            shorts: VecDeque::new(),
            serial: 0,
            quiet: true,
            next: None,
        }
    }

    /// Sets the maximum number of stored activities of all clients together.
    pub const fn set_activities(&mut self, most: usize) {
        self.limits.activities = most;
    }

    fn find(&self, address: Ipv4Addr, activity: Uuid) -> Option<usize> {
        self.activities
            .iter()
            .position(|a| *a.peer.ip() == address && a.header.activity == activity)
    }

    fn short(&mut self, to: SocketAddrV4, header: &Header, kind: PacketType, body: Short) {
        if self.shorts.len() < QUEUE {
            let mut reply = header.reply(kind);
            reply.fragment = header.fragment;
            self.shorts.push_back((to, reply, body));
        }
    }

    /// Takes a datagram that arrived at the server's port. Anything but a PDU of a client is dropped.
    #[must_use]
    pub fn handle(&mut self, now: Instant, source: SocketAddrV4, pdu: &[u8]) -> Option<Call> {
        let call = self.take(now, source, pdu);
        self.settle();
        call
    }

    fn take(&mut self, now: Instant, source: SocketAddrV4, pdu: &[u8]) -> Option<Call> {
        let (header, body) = Header::decode(pdu).ok()?;
        match header.packet_type {
            PacketType::Request => return self.request(now, source, pdu.len(), &header, body),
            PacketType::Ping => self.ping(now, source, &header),
            PacketType::Fack => self.fack(now, source, &header),
            PacketType::Ack => {
                if let Some(activity) = self.same_call(source, &header)
                    && matches!(activity.state, State::Answering { .. })
                {
                    activity.state = State::Forgotten;
                }
            }
            PacketType::Cancel => self.short(source, &header, PacketType::CancelAck, Short::Empty),
            _ => {}
        }
        None
    }

    fn same_call(&mut self, source: SocketAddrV4, header: &Header) -> Option<&mut Activity> {
        let index = self.find(*source.ip(), header.activity)?;
        self.activities
            .get_mut(index)
            .filter(|a| a.header.sequence == header.sequence)
    }

    fn request(
        &mut self,
        now: Instant,
        source: SocketAddrV4,
        length: usize,
        header: &Header,
        body: &[u8],
    ) -> Option<Call> {
        let refused = if length > MAX_PDU {
            Some(reject::PROTOCOL_ERROR)
        } else {
            match self.interfaces.iter().find(|i| i.uuid == header.interface) {
                None => Some(reject::UNKNOWN_INTERFACE),
                Some(interface) if header.operation >= interface.operations => Some(reject::OP_RANGE),
                Some(_) => None,
            }
        };
        if let Some(status) = refused {
            self.short(source, header, PacketType::Reject, Short::Status(status));
            return None;
        }
        let index = match self.find(*source.ip(), header.activity) {
            Some(index) => {
                let activity = self.activities.get_mut(index)?;
                // numbers wrap: older means less than half the number space back
                let ahead = header.sequence.wrapping_sub(activity.header.sequence);
                if ahead > u32::MAX / 2 {
                    return None;
                }
                let other = header.fragment == 0 && digest(body) != activity.digest;
                let restarted = match activity.state {
                    State::Answering { .. } | State::Forgotten => other,
                    State::Dropped => header.fragment == 0,
                    State::Receiving(_) | State::Executing => false,
                };
                if ahead > 0 || restarted {
                    // A client that always begins with the same activity and number has restarted when its request
                    // differs: the answer to its former life is not for it.
                    if header.flags.is_fragment() && header.fragment != 0 {
                        return None;
                    }
                    activity.header = *header;
                    activity.digest = digest(body);
                    activity.state = State::Receiving(Incoming::new(header.order, now + REASSEMBLY));
                }
                activity.peer = source;
                activity.used = now;
                index
            }
            None if header.flags.is_fragment() && header.fragment != 0 => return None,
            None => {
                let Some(index) = self.room(*source.ip()) else {
                    self.short(
                        source,
                        header,
                        PacketType::Reject,
                        Short::Status(reject::TOO_BUSY),
                    );
                    return None;
                };
                let state = State::Receiving(Incoming::new(header.order, now + REASSEMBLY));
                let activity = Activity {
                    peer: source,
                    header: *header,
                    digest: digest(body),
                    state,
                    used: now,
                };
                match self.activities.get_mut(index) {
                    Some(place) => *place = activity,
                    None => self.activities.push(activity),
                }
                index
            }
        };
        self.feed(now, index, source, header, body)
    }

    /// Gives a request PDU to its activity, which has the same call number.
    fn feed(
        &mut self,
        now: Instant,
        index: usize,
        source: SocketAddrV4,
        header: &Header,
        body: &[u8],
    ) -> Option<Call> {
        let limit = self.limits.stub;
        let activity = self.activities.get_mut(index)?;
        match &mut activity.state {
            State::Executing => self.short(source, header, PacketType::Working, Short::Empty),
            State::Answering { pending, .. } => *pending = true,
            State::Forgotten | State::Dropped => {}
            State::Receiving(incoming) => match incoming.take(header, body, limit) {
                Progress::Nothing => {}
                Progress::Acknowledge(fragment) => {
                    incoming.deadline = now + REASSEMBLY;
                    let acknowledged = Header { fragment, ..*header };
                    let fack = Short::Fack(FackBody::new(header.serial));
                    self.short(source, &acknowledged, PacketType::Fack, fack);
                }
                Progress::Broken => {
                    activity.state = State::Dropped;
                    self.short(
                        source,
                        header,
                        PacketType::Reject,
                        Short::Status(reject::PROTOCOL_ERROR),
                    );
                }
                Progress::Complete => {
                    let state = core::mem::replace(&mut activity.state, State::Executing);
                    let State::Receiving(incoming) = state else {
                        return None;
                    };
                    return Some(Call {
                        key: CallKey {
                            address: *source.ip(),
                            activity: header.activity,
                            sequence: header.sequence,
                        },
                        source,
                        object: header.object,
                        interface: header.interface,
                        operation: header.operation,
                        order: header.order,
                        stub: incoming.into_stub(),
                    });
                }
            },
        }
        None
    }

    /// Returns the place for a new activity of `address`: a free place, or the place of the longest unused one that is
    /// not being executed.
    fn room(&self, address: Ipv4Addr) -> Option<usize> {
        let own = |a: &&(usize, &Activity)| *a.1.peer.ip() == address;
        let all: Vec<_> = self.activities.iter().enumerate().collect();
        let idle = |a: &&(usize, &Activity)| !matches!(a.1.state, State::Executing);
        let oldest =
            |a: &&(usize, &Activity)| (!matches!(a.1.state, State::Forgotten | State::Dropped), a.1.used);
        if all.iter().filter(own).count() >= self.limits.activities_per_address {
            all.iter()
                .filter(own)
                .filter(idle)
                .min_by_key(oldest)
                .map(|a| a.0)
        } else if all.len() < self.limits.activities {
            Some(all.len())
        } else {
            all.iter().filter(idle).min_by_key(oldest).map(|a| a.0)
        }
    }

    fn ping(&mut self, now: Instant, source: SocketAddrV4, header: &Header) {
        let answer = match self.same_call(source, header) {
            None => Some(PacketType::NoCall),
            Some(activity) => {
                activity.used = now;
                match &mut activity.state {
                    State::Executing => Some(PacketType::Working),
                    State::Answering { pending, .. } => {
                        *pending = true;
                        None
                    }
                    State::Receiving(_) | State::Forgotten | State::Dropped => Some(PacketType::NoCall),
                }
            }
        };
        if let Some(kind) = answer {
            self.short(source, header, kind, Short::Empty);
        }
    }

    fn fack(&mut self, now: Instant, source: SocketAddrV4, header: &Header) {
        if let Some(activity) = self.same_call(source, header) {
            activity.used = now;
            if let State::Answering {
                out,
                pending,
                resend,
                sends,
                ..
            } = &mut activity.state
                && out.acknowledge(header.fragment)
            {
                *pending = true;
                *resend = None;
                *sends = 0;
            }
        }
    }

    fn answer(&mut self, now: Instant, key: CallKey, kind: PacketType, stub: Vec<u8>) {
        let Some(index) = self.find(key.address, key.activity) else {
            return;
        };
        if let Some(activity) = self.activities.get_mut(index)
            && activity.header.sequence == key.sequence
            && matches!(activity.state, State::Executing)
        {
            activity.used = now;
            let out = Outgoing::new(stub);
            activity.state = State::Answering {
                kind,
                out,
                pending: true,
                resend: None,
                sends: 0,
            };
            self.settle();
        }
    }

    /// Answers a call. Does nothing if the client has gone on to another call, or the call was already answered.
    pub fn respond(&mut self, now: Instant, key: CallKey, stub: Vec<u8>) {
        self.answer(now, key, PacketType::Response, stub);
    }

    /// Reports that a call was not executed; see [`reject`] for the numbers.
    pub fn reject(&mut self, now: Instant, key: CallKey, order: ByteOrder, status: u32) {
        let mut stub = Vec::new();
        stub.u32_in(order, status);
        self.answer(now, key, PacketType::Reject, stub);
    }

    /// Returns true while a call waits for its answer.
    #[must_use]
    pub fn is_executing(&self, key: &CallKey) -> bool {
        self.activities.iter().any(|a| {
            a.header.activity == key.activity
                && a.header.sequence == key.sequence
                && *a.peer.ip() == key.address
                && matches!(a.state, State::Executing)
        })
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Instant) {
        if self.next.is_none_or(|next| now < next) {
            return;
        }
        for activity in &mut self.activities {
            match &mut activity.state {
                State::Receiving(incoming) if incoming.deadline <= now => activity.state = State::Dropped,
                State::Answering {
                    pending,
                    resend,
                    sends,
                    ..
                } if resend.is_some_and(|at| at <= now) => {
                    *resend = None;
                    if *sends >= FACK_SENDS {
                        // silent until the client pings again
                        *sends = 0;
                    } else {
                        *pending = true;
                    }
                }
                _ => {}
            }
        }
        self.activities
            .retain(|a| matches!(a.state, State::Executing) || a.used + KEEP > now);
        self.settle();
    }

    /// Returns the time of the next timeout.
    #[must_use]
    pub const fn poll_timeout(&self) -> Option<Instant> {
        self.next
    }

    /// Notes what has changed for [`poll_timeout`](Self::poll_timeout) and [`poll_transmit`](Self::poll_transmit).
    fn settle(&mut self) {
        self.quiet = false;
        self.next = self.earliest();
    }

    fn earliest(&self) -> Option<Instant> {
        let due = |a: &Activity| match &a.state {
            State::Executing => None,
            State::Receiving(incoming) => Some(incoming.deadline.min(a.used + KEEP)),
            State::Answering {
                resend: Some(resend), ..
            } => Some((*resend).min(a.used + KEEP)),
            State::Answering { .. } | State::Forgotten | State::Dropped => Some(a.used + KEEP),
        };
        self.activities.iter().filter_map(due).min()
    }

    /// Writes the next datagram and returns its destination.
    #[must_use]
    pub fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<(SocketAddrV4, usize)> {
        if self.quiet {
            return None;
        }
        let sent = self.transmit(now, buffer);
        self.quiet = sent.is_none();
        self.next = self.earliest();
        sent
    }

    fn transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<(SocketAddrV4, usize)> {
        let mut out = SliceWriter::new(buffer);
        if let Some((to, mut header, body)) = self.shorts.pop_front() {
            self.serial = self.serial.wrapping_add(1);
            header.serial = self.serial;
            header.flags = Flags(Flags::NO_FACK);
            match body {
                Short::Empty => header.encode(&mut out, 0),
                Short::Status(status) => {
                    header.encode(&mut out, 4);
                    out.u32_in(header.order, status);
                }
                Short::Fack(fack) => {
                    header.flags = Flags(0);
                    header.encode(&mut out, 16);
                    fack.encode(&mut out, header.order);
                }
            }
            return Some((to, out.finish().ok()?));
        }
        for activity in &mut self.activities {
            if let State::Answering {
                kind,
                out: stub,
                pending,
                resend,
                sends,
            } = &mut activity.state
                && *pending
            {
                *pending = false;
                self.serial = self.serial.wrapping_add(1);
                let mut header = activity.header.reply(*kind);
                header.flags = Flags(Flags::IDEMPOTENT | Flags::NO_FACK);
                stub.encode(&header, self.serial, &mut out);
                if stub.awaits_fack() {
                    *sends = sends.saturating_add(1);
                    *resend = Some(now + FACK_WAIT);
                }
                return Some((activity.peer, out.finish().ok()?));
            }
        }
        None
    }
}
