//! Cutting a stub into PDUs and joining it again.

use alloc::vec::Vec;

use crate::Instant;
use crate::wire::rpc::{Flags, Header, MAX_BODY};
use crate::wire::{ByteOrder, Writer};

/// A stub on its way out, one fragment at a time.
#[derive(Debug, Clone)]
pub(super) struct Outgoing {
    stub: Vec<u8>,
    current: u16,
}

impl Outgoing {
    pub(super) const fn new(stub: Vec<u8>) -> Self {
        Self { stub, current: 0 }
    }

    fn last(&self) -> u16 {
        let pieces = self.stub.len().div_ceil(MAX_BODY).max(1);
        u16::try_from(pieces - 1).unwrap_or(u16::MAX)
    }

    /// Returns true while fragments follow that the peer must request by acknowledging this one.
    pub(super) fn awaits_fack(&self) -> bool {
        self.current < self.last()
    }

    /// Takes an acknowledgement, which names the highest fragment received in order; true if the next one may go out
    /// now.
    pub(super) fn acknowledge(&mut self, fragment: u16) -> bool {
        let next = (self.current..self.last()).contains(&fragment);
        if next {
            self.current = fragment + 1;
        }
        next
    }

    /// Starts over.
    pub(super) fn rewind(&mut self) {
        self.current = 0;
    }

    /// Writes the present fragment as a PDU with the flags it needs beside those of `header`.
    pub(super) fn encode(&self, header: &Header, serial: u16, out: &mut impl Writer) {
        let last = self.last();
        let mut flags = header.flags.0;
        if last > 0 {
            flags |= Flags::FRAGMENT;
            if self.current == last {
                flags |= Flags::LAST_FRAGMENT | Flags::NO_FACK;
            } else {
                flags &= !Flags::NO_FACK;
            }
        }
        let start = usize::from(self.current) * MAX_BODY;
        let end = self.stub.len().min(start + MAX_BODY);
        let piece = self.stub.get(start..end).unwrap_or(&[]);
        let header = Header {
            flags: Flags(flags),
            serial,
            fragment: self.current,
            ..*header
        };
        header.encode(out, piece.len());
        out.bytes(piece);
    }
}

/// A stub on its way in.
#[derive(Debug, Clone)]
pub(super) struct Incoming {
    buffer: Vec<u8>,
    next: u16,
    order: ByteOrder,
    /// Until when the rest must have come.
    pub(super) deadline: Instant,
}

/// What a fragment led to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Progress {
    /// It was the last one.
    Complete,
    /// Taken (or had already been): acknowledge this number.
    Acknowledge(u16),
    /// Nothing to send.
    Nothing,
    /// It does not fit what came before, or is too much: give the stub up.
    Broken,
}

impl Incoming {
    pub(super) const fn new(order: ByteOrder, deadline: Instant) -> Self {
        Self {
            buffer: Vec::new(),
            next: 0,
            order,
            deadline,
        }
    }

    /// Takes one PDU of the stub.
    pub(super) fn take(&mut self, header: &Header, body: &[u8], limit: usize) -> Progress {
        if header.order != self.order || self.buffer.len() + body.len() > limit {
            return Progress::Broken;
        }
        let fragment = if header.flags.is_fragment() {
            header.fragment
        } else {
            0
        };
        if fragment < self.next && !header.flags.no_fack() {
            return Progress::Acknowledge(self.next - 1);
        }
        if fragment != self.next {
            return Progress::Nothing;
        }
        self.buffer.extend_from_slice(body);
        self.next = self.next.saturating_add(1);
        if !header.flags.is_fragment() || header.flags.is_last() {
            Progress::Complete
        } else if header.flags.no_fack() {
            Progress::Nothing
        } else {
            Progress::Acknowledge(fragment)
        }
    }

    pub(super) fn into_stub(self) -> Vec<u8> {
        self.buffer
    }
}
