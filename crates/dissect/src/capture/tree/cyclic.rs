//! Cyclic data: the submodules by the layout of the connect, the telegram of each drive in them.

use profinet::wire::ethernet::Frame;

use super::Notes;
use crate::capture::Walker;
use crate::capture::cyclic::iops;
use crate::job::telegram::Half;

/// The cyclic data of a frame. Where its connect is not in the capture, only that it is data.
pub fn data<'a>(walker: &Walker, frame: &Frame<'a>, notes: &mut Notes<'a>) {
    let stream = walker.ars.stream(frame);
    let length = stream.and_then(|stream| stream.data_length());
    let Some((octets, behind)) = length.and_then(|length| frame.payload.split_at_checked(length)) else {
        notes.reader(frame.payload).rest("data");
        return;
    };
    notes.add("data", octets, "");
    let mut trailer = notes.reader(behind);
    // a frame that ends too early has a note
    let _ = trailer
        .u16("CycleCounter")
        .and_then(|_| trailer.u8("DataStatus"))
        .and_then(|_| trailer.u8("TransferStatus"));
    let Some(stream) = stream else { return };
    for object in stream.objects() {
        let place = place(object.slot, object.subslot);
        let Some(part) = octets.get(object.octets()) else {
            continue;
        };
        let Some((data, status)) = part.split_at_checked(object.length) else {
            continue;
        };
        let kind = if object.consumer { "IOCS" } else { "IOPS" };
        // a submodule without data in this direction has its status alone
        if !data.is_empty() {
            notes.add(place.clone(), part, "");
            notes.add("data", data, "");
        }
        notes.add(format!("{kind} of {place}"), status, iops(status));
    }
    let drive = walker.names.drives.known(stream.device());
    for (data_of, data) in stream.telegrams(octets) {
        let half = Half {
            drive: &drive,
            telegram: data_of,
            output: stream.is_output(),
        };
        for part in half.parts(data) {
            notes.add_part(data, part);
        }
    }
}

/// Returns a place in words: subslots of interfaces and ports are written in hexadecimal.
fn place(slot: u16, subslot: u16) -> String {
    if subslot < 0x8000 {
        format!("slot {slot}/{subslot}")
    } else {
        format!("slot {slot}/0x{subslot:04X}")
    }
}
