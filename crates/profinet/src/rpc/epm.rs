//! The endpoint mapper: reports the RPC servers and the identity of this station to tools.

use alloc::vec::Vec;
use core::fmt::Write as _;
use core::net::Ipv4Addr;
use core::time::Duration;

use crate::wire::rpc::{
    EPM_LOOKUP, EPM_LOOKUP_FREE, EPM_NOT_REGISTERED, EpmEntry, EpmHandle, LookupRequest, LookupResponse,
    reject,
};
use crate::wire::{ByteOrder, Reader, Uuid, UuidSource, Writer};
use crate::{Instant, RPC_PORT};

/// Enumerations that may be open at once.
const HANDLES: usize = 8;
/// An enumeration ends when it is not continued within this time.
const IDLE: Duration = Duration::from_secs(5);

/// What the endpoint mapper reports about a station.
#[derive(Debug, Clone, Copy)]
pub struct Registration {
    /// Interface it serves.
    pub interface: Uuid,
    /// Its object UUID.
    pub object: Uuid,
    /// Words about it, from [`annotation`].
    pub annotation: [u8; 64],
    /// Its address.
    pub address: Ipv4Addr,
}

/// Annotation of a PROFINET station: product name (25), order number (20), hardware revision (5 digits), software
/// prefix letter and three numbers, separated by blanks, closed by NUL.
///
/// ```
/// let text = profidrive_profinet::rpc::annotation("AKD", "AKD-P00306", 1, b'V', [1, 11, 0]);
/// assert_eq!(&text[..63], b"AKD                       AKD-P00306               1 V  1 11  0");
/// ```
#[must_use]
pub fn annotation(product: &str, order_id: &str, hardware: u16, prefix: u8, software: [u8; 3]) -> [u8; 64] {
    struct Text([u8; 64], usize);
    impl core::fmt::Write for Text {
        fn write_str(&mut self, text: &str) -> core::fmt::Result {
            for byte in text.bytes() {
                // the last octet stays NUL
                if let Some(place) = self.0[..63].get_mut(self.1) {
                    *place = byte;
                    self.1 += 1;
                }
            }
            Ok(())
        }
    }
    let mut text = Text([0; 64], 0);
    let [a, b, c] = software;
    let prefix = char::from(prefix);
    // writing into this buffer cannot fail
    let _ = write!(
        text,
        "{product:<25.25} {order_id:<20.20} {hardware:>5} {prefix}{a:>3}{b:>3}{c:>3}"
    );
    text.0
}

/// One enumeration in progress.
#[derive(Debug)]
struct Enumeration {
    handle: Uuid,
    finished: bool,
    used: Instant,
}

/// Serves lookups: first the mapper itself, then the station's interface, one entry per call.
#[derive(Debug)]
pub struct EndpointMapper {
    open: Vec<Enumeration>,
    uuids: UuidSource,
}

impl EndpointMapper {
    /// Creates a mapper whose handles come from `seed`.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self {
            open: Vec::new(),
            uuids: UuidSource::new(seed),
        }
    }

    /// Executes a call; gives the stub of the answer.
    ///
    /// # Errors
    /// The status to reject the call with.
    pub fn call(
        &mut self,
        now: Instant,
        operation: u16,
        order: ByteOrder,
        stub: &[u8],
        station: &Registration,
    ) -> Result<Vec<u8>, u32> {
        self.open.retain(|enumeration| enumeration.used + IDLE > now);
        let mut reader = Reader::new(stub);
        let mut out = Vec::new();
        match operation {
            EPM_LOOKUP => {
                let request = LookupRequest::decode(&mut reader, order);
                let request = request.map_err(|_| reject::PROTOCOL_ERROR)?;
                self.lookup(now, &request, station).encode(&mut out, order);
            }
            EPM_LOOKUP_FREE => {
                let handle = EpmHandle::decode(&mut reader, order).map_err(|_| reject::PROTOCOL_ERROR)?;
                self.open.retain(|enumeration| enumeration.handle != handle.uuid);
                EpmHandle::default().encode(&mut out, order);
                out.u32_in(order, 0);
            }
            _ => return Err(reject::OP_RANGE),
        }
        Ok(out)
    }

    fn lookup(&mut self, now: Instant, request: &LookupRequest, station: &Registration) -> LookupResponse {
        let answer = |uuid, object, interface, version| LookupResponse {
            handle: EpmHandle { attributes: 0, uuid },
            entries: alloc::vec![EpmEntry {
                object,
                annotation: station.annotation,
                interface: (interface, version, 0),
                port: RPC_PORT,
                address: station.address,
            }],
            status: 0,
        };
        let handle = request.handle.uuid;
        if request.inquiry == 0 && handle.is_nil() {
            if self.open.len() >= HANDLES {
                self.open.remove(0);
            }
            let handle = self.uuids.uuid();
            self.open.push(Enumeration {
                handle,
                finished: false,
                used: now,
            });
            return answer(handle, Uuid::NIL, Uuid::ENDPOINT_MAPPER, 3);
        }
        let open = self
            .open
            .iter_mut()
            .find(|enumeration| enumeration.handle == handle);
        if let Some(enumeration) = open
            && request.inquiry == 0
            && !enumeration.finished
        {
            enumeration.finished = true;
            enumeration.used = now;
            return answer(handle, station.object, station.interface, 1);
        }
        self.open.retain(|enumeration| enumeration.handle != handle);
        LookupResponse {
            handle: EpmHandle::default(),
            entries: Vec::new(),
            status: EPM_NOT_REGISTERED,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_enumeration_ends_behind_the_second_entry() {
        let mut mapper = EndpointMapper::new(1);
        let station = Registration {
            interface: Uuid::DEVICE_INTERFACE,
            object: Uuid::object(1, 1, 0x0105),
            annotation: annotation("AKD", "AKD-P00306", 1, b'V', [1, 11, 0]),
            address: Ipv4Addr::new(10, 0, 0, 2),
        };
        let mut handle = EpmHandle::default();
        let mut seen = Vec::new();
        for order in [ByteOrder::Big, ByteOrder::Little, ByteOrder::Big] {
            let mut stub = Vec::new();
            LookupRequest::all(handle).encode(&mut stub, order);
            let answer = mapper
                .call(Instant::ZERO, EPM_LOOKUP, order, &stub, &station)
                .unwrap();
            let answer = LookupResponse::decode(&mut Reader::new(&answer), order).unwrap();
            handle = answer.handle;
            seen.push((answer.entries.first().map(|e| e.interface.0), answer.status));
        }
        assert_eq!(
            seen,
            [
                (Some(Uuid::ENDPOINT_MAPPER), 0),
                (Some(Uuid::DEVICE_INTERFACE), 0),
                (None, EPM_NOT_REGISTERED)
            ]
        );
        assert!(mapper.open.is_empty());
    }

    #[test]
    fn handles_are_bounded_and_expire() {
        let mut mapper = EndpointMapper::new(1);
        let station = Registration {
            interface: Uuid::DEVICE_INTERFACE,
            object: Uuid::NIL,
            annotation: [0; 64],
            address: Ipv4Addr::LOCALHOST,
        };
        let mut stub = Vec::new();
        LookupRequest::all(EpmHandle::default()).encode(&mut stub, ByteOrder::Big);
        for _ in 0..100 {
            mapper
                .call(Instant::ZERO, EPM_LOOKUP, ByteOrder::Big, &stub, &station)
                .unwrap();
        }
        assert_eq!(mapper.open.len(), HANDLES);
        mapper
            .call(
                Instant::from_millis(6000),
                EPM_LOOKUP,
                ByteOrder::Big,
                &stub,
                &station,
            )
            .unwrap();
        assert_eq!(mapper.open.len(), 1);
        assert_eq!(
            mapper.call(Instant::ZERO, EPM_LOOKUP, ByteOrder::Big, &stub[1..], &station),
            Err(reject::PROTOCOL_ERROR)
        );
    }
}
