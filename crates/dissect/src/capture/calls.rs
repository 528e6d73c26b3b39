//! Remote procedure calls: requests matched with their answers, repetitions, and unanswered requests.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::wire::rpc::{Header, PacketType, reject};
use profinet::wire::{DecodeError, Reader, Uuid};

use super::assembly::Assembly;
use super::cyclic::CyclicArs;
use super::event::{Detail, Origin, Sink, Trouble};
use super::jobs::Jobs;
use super::names::{Names, seconds};
use super::pending::{CUT_OFF, Pending};
use super::services::{self, Context};
use super::udp::Datagram;
use crate::Weight;

/// A call is over when none of its packets comes for so long: a request with the same number is then another call. Clients
/// repeat a request every 2 to 5 s.
const OVER: Duration = Duration::from_secs(10);

/// Client, server and call: activities are distinguished by their client, and a client may use one towards several.
type Key = (Ipv4Addr, Ipv4Addr, Uuid, u32);

/// All calls of a capture that may still be answered or repeated.
#[derive(Debug, Default)]
pub struct Calls {
    open: Pending<Key, Call>,
    jobs: Jobs,
    seen: u64,
}

#[derive(Debug, Default)]
struct Call {
    origin: Origin,
    /// What is called, in words.
    what: String,
    /// How often the request was sent; 0 where only the answer is in the capture.
    sent: u32,
    /// Of an unfragmented request.
    digest: u64,
    request: Assembly,
    response: Assembly,
    context: Context,
}

impl Call {
    /// Returns true for a request that has the number of this call and is not its repetition.
    fn is_other_value(&self, header: &Header, digest: u64) -> bool {
        self.request.is_done() && !header.flags.is_fragment() && self.digest != digest
    }
}

/// What the services of a call work with.
pub struct Scene<'a> {
    pub jobs: &'a mut Jobs,
    pub ars: &'a mut CyclicArs,
    pub names: &'a mut Names,
}

impl Calls {
    /// RPC packets received.
    pub const fn seen(&self) -> u64 {
        self.seen
    }

    /// Returns the parameter request that the last response answered.
    pub fn answered(&self) -> Option<&[u8]> {
        self.jobs.answered()
    }

    /// Looks at one datagram; other protocols are passed over.
    pub fn datagram(
        &mut self,
        datagram: &Datagram<'_>,
        ars: &mut CyclicArs,
        names: &mut Names,
        sink: &mut Sink<'_>,
    ) -> Result<(), DecodeError> {
        let Ok((header, body)) = Header::decode(datagram.payload) else {
            return Ok(());
        };
        let known = [
            Uuid::DEVICE_INTERFACE,
            Uuid::CONTROLLER_INTERFACE,
            Uuid::ENDPOINT_MAPPER,
        ];
        if !known.contains(&header.interface) {
            return Ok(());
        }
        self.seen += 1;
        if header.interface == Uuid::ENDPOINT_MAPPER {
            return Ok(());
        }
        let (source, destination) = (*datagram.source.ip(), *datagram.destination.ip());
        let (client, server) = match header.packet_type {
            PacketType::Request | PacketType::Ping | PacketType::Ack | PacketType::Cancel => {
                (source, destination)
            }
            _ => (destination, source),
        };
        let key = (client, server, header.activity, header.sequence);
        let Self { open, jobs, .. } = self;
        let mut scene = Scene { jobs, ars, names };
        match header.packet_type {
            PacketType::Request => {
                let call = requested(open, key, &header, body, sink);
                if let Some(whole) = call.request.add(&header, body) {
                    let asked = services::request(&header, &whole, datagram, &mut scene, sink)?;
                    let call = entry(open, key, sink);
                    (call.what, call.context) = asked;
                }
            }
            PacketType::Response => {
                let call = entry(open, key, sink);
                if let Some(whole) = call.response.add(&header, body) {
                    let context = std::mem::take(&mut call.context);
                    answered(call, &header, sink);
                    let asked = call.origin.frame;
                    services::response(&header, &whole, context, asked, &mut scene, sink)?;
                }
            }
            PacketType::Fault | PacketType::Reject => {
                entry(open, key, sink).response.finish();
                let status = Reader::new(body).u32_in(header.order, "reject status")?;
                let words = reject::words(status).unwrap_or("unknown reason");
                let text = format!("call refused: {words} (0x{status:08X})");
                sink.report(
                    Weight::Error,
                    "RPC",
                    text,
                    Detail::Trouble(Trouble::Rejected { status }),
                );
            }
            PacketType::NoCall => {
                let trouble = Trouble::Rejected { status: 0 };
                sink.report(
                    Weight::Warning,
                    "RPC",
                    "the receiver does not know this call (NOCALL)",
                    Detail::Trouble(trouble),
                );
            }
            // the call goes on
            _ => open.postpone(&key, sink.at + OVER),
        }
        Ok(())
    }

    /// Reports the calls and parameter requests unanswered until `now`; with the largest time all, as at the end of a
    /// capture.
    pub fn give_up(&mut self, now: Duration, sink: &mut Sink<'_>) {
        while let Some((deadline, call)) = self.open.due(now) {
            let waited = deadline.min(sink.at).saturating_sub(call.origin.at);
            if call.sent == 0 || call.response.is_done() || waited < CUT_OFF {
                continue;
            }
            let what = call.what;
            let text = format!("{what}: no answer within {}{}", seconds(waited), times(call.sent));
            let trouble = Trouble::Unanswered {
                what,
                sent: call.sent,
                waited,
            };
            sink.report_of(call.origin, Weight::Error, "RPC", text, Detail::Trouble(trouble));
        }
        self.jobs.give_up(now, sink);
    }
}

/// Returns the call of a request packet: a new one, or the one that it repeats.
fn requested<'c>(
    open: &'c mut Pending<Key, Call>,
    key: Key,
    header: &Header,
    body: &[u8],
    sink: &Sink<'_>,
) -> &'c mut Call {
    let mut hasher = DefaultHasher::new();
    body.hash(&mut hasher);
    let digest = hasher.finish();
    if open
        .get_mut(&key)
        .is_some_and(|call| call.is_other_value(header, digest))
    {
        open.remove(&key);
    }
    let call = entry(open, key, sink);
    if header.fragment == 0 {
        if call.sent == 0 {
            call.origin = sink.origin();
            call.digest = digest;
            call.what = services::operation_name(header).into();
        }
        call.sent = call.sent.saturating_add(1);
    }
    call
}

/// Returns the call of a packet; the call stays stored for a limited time.
fn entry<'c>(open: &'c mut Pending<Key, Call>, key: Key, sink: &Sink<'_>) -> &'c mut Call {
    open.renew(key, sink.at + OVER)
}

/// Reports an answer without its request, and one that took repetitions.
fn answered(call: &Call, header: &Header, sink: &mut Sink<'_>) {
    if call.sent == 0 {
        let what = services::operation_name(header);
        let text = format!("answer to a {what} that is not in the capture");
        let trouble = Trouble::Unasked { what: what.into() };
        sink.report(Weight::Warning, "RPC", text, Detail::Trouble(trouble));
    } else if call.sent > 1 {
        let waited = sink.at.saturating_sub(call.origin.at);
        let text = format!(
            "{}: answered after {}{}",
            call.what,
            seconds(waited),
            times(call.sent)
        );
        let trouble = Trouble::Late {
            what: call.what.clone(),
            sent: call.sent,
            waited,
        };
        sink.report(Weight::Warning, "RPC", text, Detail::Trouble(trouble));
    }
}

fn times(sent: u32) -> String {
    if sent > 1 {
        format!(", sent {sent} times")
    } else {
        String::new()
    }
}
