//! Identifies a device without discovery, by its RPC endpoint mapper.
//!
//! DCE 1.1 RPC, endpoint mapper lookup; the object UUID of a PROFINET device carries vendor, device and instance.

use std::collections::VecDeque;
use std::net::{Ipv4Addr, SocketAddrV4};

use profinet::rpc::{self, ClientConfig};
use profinet::wire::rpc::{EPM_LOOKUP, EpmEntry, EpmHandle, Header, LookupRequest, LookupResponse};
use profinet::wire::{Reader, Uuid, UuidSource};
use profinet::{Instant, RPC_PORT, Transmit};

/// Most entries looked at: a device has two.
const MAX_ENTRIES: u32 = 16;
/// Version of the endpoint mapper interface.
const VERSION: u32 = 3;

/// Identity of a device from its endpoint mapper.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Registered {
    /// Vendor.
    pub vendor_id: u16,
    /// Device.
    pub device_id: u16,
    /// Instance.
    pub instance: u16,
    /// Product, order number and revisions as one text.
    pub annotation: String,
}

/// Results that no caller fetched at most; the oldest makes room.
const MAX_RESULTS: usize = 256;

/// Names a query.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QueryId(u32);

/// Queries of several devices at once.
#[derive(Debug)]
pub struct Mapper {
    calls: rpc::Client,
    uuids: UuidSource,
    port: u16,
    next: u32,
    open: Vec<Enumeration>,
    results: VecDeque<(QueryId, Option<Registered>)>,
}

#[derive(Debug)]
struct Enumeration {
    id: QueryId,
    server: SocketAddrV4,
    activity: Uuid,
    /// Calls so far, and their numbers.
    calls: u32,
    open: Option<rpc::CallId>,
}

impl Mapper {
    /// Calls leave from `port`.
    pub fn new(seed: u64, port: u16) -> Self {
        Self {
            calls: rpc::Client::new(ClientConfig::default()),
            uuids: UuidSource::new(seed),
            port,
            next: 0,
            open: Vec::new(),
            results: VecDeque::new(),
        }
    }

    /// Returns the local port of the calls.
    pub const fn port(&self) -> u16 {
        self.port
    }

    /// Starts a query.
    pub fn ask(&mut self, now: Instant, address: Ipv4Addr) -> QueryId {
        self.next = self.next.wrapping_add(1);
        let id = QueryId(self.next);
        let mut query = Enumeration {
            id,
            server: SocketAddrV4::new(address, RPC_PORT),
            activity: self.uuids.uuid(),
            calls: 0,
            open: None,
        };
        self.next_entry(now, &mut query, EpmHandle::default());
        self.open.push(query);
        id
    }

    /// Returns the answer to a query, once there is one: the inner value is `None` when it has no usable entry.
    pub fn take(&mut self, id: QueryId) -> Option<Option<Registered>> {
        let at = self.results.iter().position(|(of, _)| *of == id)?;
        self.results.remove(at).map(|(_, result)| result)
    }

    fn next_entry(&mut self, now: Instant, query: &mut Enumeration, handle: EpmHandle) {
        let header = Header {
            interface_version: VERSION,
            ..Header::request(
                Uuid::NIL,
                Uuid::ENDPOINT_MAPPER,
                query.activity,
                query.calls,
                EPM_LOOKUP,
            )
        };
        let mut stub = Vec::new();
        LookupRequest::all(handle).encode(&mut stub, header.order);
        query.calls += 1;
        query.open = Some(self.calls.call(now, query.server, header, stub));
    }

    fn work(&mut self, now: Instant) {
        while let Some((call, reply)) = self.calls.poll_event() {
            let Some(at) = self.open.iter().position(|query| query.open == Some(call)) else {
                continue;
            };
            let mut query = self.open.swap_remove(at);
            let more = query.calls < MAX_ENTRIES;
            let answer = reply
                .ok()
                .and_then(|reply| LookupResponse::decode(&mut Reader::new(&reply.stub), reply.order).ok());
            let found = match answer {
                Some(answer) if answer.status == 0 => match answer.entries.iter().find_map(device) {
                    None if more => {
                        self.next_entry(now, &mut query, answer.handle);
                        self.open.push(query);
                        continue;
                    }
                    found => found,
                },
                _ => None,
            };
            if self.results.len() >= MAX_RESULTS {
                self.results.pop_front();
            }
            self.results.push_back((query.id, found));
        }
    }

    pub fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, payload: &[u8]) {
        self.calls.handle(now, source, payload);
        self.work(now);
    }

    pub fn handle_timeout(&mut self, now: Instant) {
        self.calls.handle_timeout(now);
        self.work(now);
    }

    pub fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        let (destination, length) = self.calls.poll_transmit(now, buffer)?;
        Some(Transmit::Datagram {
            destination,
            source_port: self.port,
            length,
        })
    }

    pub fn poll_timeout(&self) -> Option<Instant> {
        self.calls.poll_timeout()
    }
}

/// Returns the device behind an entry; the mapper's own entry has none.
fn device(entry: &EpmEntry) -> Option<Registered> {
    let (instance, device_id, vendor_id) = entry.object.object_parts()?;
    if entry.interface.0 != Uuid::DEVICE_INTERFACE {
        return None;
    }
    let text = String::from_utf8_lossy(&entry.annotation);
    let annotation = text
        .trim_end_matches(['\0', ' '])
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    Some(Registered {
        vendor_id,
        device_id,
        instance,
        annotation,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use profinet::wire::rpc::PacketType;

    /// Answers the call that is sent with an entry of the mapper itself; false when nothing is sent.
    fn answer(mapper: &mut Mapper, server: SocketAddrV4) -> bool {
        let mut buffer = [0; profinet::MAX_FRAME];
        let now = Instant::ZERO;
        let Some(Transmit::Datagram { length, .. }) = mapper.poll_transmit(now, &mut buffer) else {
            return false;
        };
        let (header, _) = Header::decode(&buffer[..length]).unwrap();
        let mut stub = Vec::new();
        let entry = EpmEntry {
            object: Uuid::NIL,
            annotation: [0; 64],
            interface: (Uuid::ENDPOINT_MAPPER, 3, 0),
            port: RPC_PORT,
            address: *server.ip(),
        };
        LookupResponse {
            handle: EpmHandle {
                attributes: 0,
                uuid: Uuid([7; 16]),
            },
            entries: vec![entry],
            status: 0,
        }
        .encode(&mut stub, header.order);
        let mut pdu = Vec::new();
        header.reply(PacketType::Response).encode(&mut pdu, stub.len());
        pdu.extend(stub);
        mapper.handle_datagram(now, server, &pdu);
        true
    }

    #[test]
    fn an_enumeration_without_end_is_ended() {
        let server = SocketAddrV4::new(Ipv4Addr::new(10, 0, 0, 1), RPC_PORT);
        let mut mapper = Mapper::new(1, 0xC001);
        let id = mapper.ask(Instant::ZERO, *server.ip());
        for _ in 0..15 {
            assert!(answer(&mut mapper, server));
            assert_eq!(mapper.take(id), None);
        }
        assert!(answer(&mut mapper, server));
        assert_eq!(mapper.take(id), Some(None));
        assert!(!answer(&mut mapper, server), "nothing more is sent");
    }

    /// Each query has its own result, and those that no caller fetches are bounded.
    #[test]
    fn queries_at_once_are_not_mixed_up() {
        let silent = Ipv4Addr::new(10, 0, 0, 9);
        let mut mapper = Mapper::new(1, 0xC001);
        let mut now = Instant::ZERO;
        let queries: Vec<QueryId> = (0..MAX_RESULTS + 10).map(|_| mapper.ask(now, silent)).collect();
        let mut buffer = [0; profinet::MAX_FRAME];
        while let Some(due) = mapper.poll_timeout() {
            now = due;
            mapper.handle_timeout(now);
            while mapper.poll_transmit(now, &mut buffer).is_some() {}
        }
        let (gone, kept) = queries.split_at(10);
        assert!(gone.iter().all(|id| mapper.take(*id).is_none()));
        assert!(kept.iter().all(|id| mapper.take(*id) == Some(None)));
        assert!(kept.iter().all(|id| mapper.take(*id).is_none()), "taken once");
    }
}
