//! Log book and pending diagnosis.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use crate::Instant;
use crate::wire::alarm::ChannelDiagnosis;
use crate::wire::record::{DiagnosisHeader, LogData, LogEntry};
use crate::wire::{PnioStatus, Uuid, Writer};

/// Maximum number of log book entries.
const LOG_ENTRIES: usize = 32;
/// Diagnoses that may be pending at once.
const DIAGNOSES: usize = 64;

/// The latest ends of ARs.
#[derive(Debug, Default)]
pub(super) struct LogBook {
    entries: VecDeque<LogEntry>,
}

impl LogBook {
    pub(super) fn note(&mut self, now: Instant, ar_uuid: Uuid, status: PnioStatus) {
        if self.entries.len() >= LOG_ENTRIES {
            self.entries.pop_front();
        }
        self.entries.push_back(LogEntry {
            time: now.as_nanos(),
            ar_uuid,
            status,
            detail: 0,
        });
    }

    pub(super) fn record(&self, now: Instant) -> LogData {
        LogData {
            time: now.as_nanos(),
            entries: self.entries.iter().copied().collect(),
        }
    }
}

/// A diagnosis of a submodule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pending {
    pub(super) api: u32,
    pub(super) slot: u16,
    pub(super) subslot: u16,
    pub(super) item: ChannelDiagnosis,
}

/// All pending diagnoses.
#[derive(Debug, Default)]
pub(super) struct Diagnoses {
    pending: Vec<Pending>,
}

impl Diagnoses {
    /// Adds one; an equal channel and error type is replaced. False if there are too many.
    pub(super) fn add(&mut self, new: Pending) -> bool {
        self.remove(new.slot, new.subslot, &new.item);
        let room = self.pending.len() < DIAGNOSES;
        if room {
            self.pending.push(new);
        }
        room
    }

    /// Removes one; true if it was there.
    pub(super) fn remove(&mut self, slot: u16, subslot: u16, item: &ChannelDiagnosis) -> bool {
        let before = self.pending.len();
        let extended = |item: &ChannelDiagnosis| item.extended.map(|(error, _)| error);
        self.pending.retain(|p| {
            (
                p.slot,
                p.subslot,
                p.item.channel,
                p.item.error_type,
                extended(&p.item),
            ) != (slot, subslot, item.channel, item.error_type, extended(item))
        });
        self.pending.len() < before
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pending.is_empty()
    }

    pub(super) fn has(&self, slot: u16, subslot: u16) -> bool {
        self.pending
            .iter()
            .any(|p| (p.slot, p.subslot) == (slot, subslot))
    }

    /// Writes the blocks of all diagnoses that `keep` takes; nothing if there is none.
    pub(super) fn encode(&self, out: &mut impl Writer, keep: impl Fn(&Pending) -> bool) {
        let mut chosen: Vec<&Pending> = self.pending.iter().filter(|p| keep(p)).collect();
        chosen.sort_by_key(|p| (p.api, p.slot, p.subslot, p.item.usi()));
        for run in chosen.chunk_by(|a, b| {
            (a.api, a.slot, a.subslot, a.item.usi()) == (b.api, b.slot, b.subslot, b.item.usi())
        }) {
            let Some(first) = run.first() else { continue };
            let header = DiagnosisHeader {
                api: first.api,
                slot: first.slot,
                subslot: first.subslot,
                usi: first.item.usi(),
            };
            header.encode(out, |out| {
                for pending in run {
                    pending.item.encode(out);
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_book_keeps_the_newest_ends() {
        let mut log = LogBook::default();
        for number in 0..100 {
            log.note(Instant::from_millis(number), Uuid::NIL, PnioStatus::OK);
        }
        let entries = log.record(Instant::ZERO).entries;
        assert_eq!(entries.len(), LOG_ENTRIES);
        let newest = entries.last().map(|entry| entry.time);
        assert_eq!(newest, Some(Instant::from_millis(99).as_nanos()));
    }

    #[test]
    fn diagnoses_are_bounded() {
        let mut diagnoses = Diagnoses::default();
        let pending = |channel| Pending {
            api: 0,
            slot: 1,
            subslot: 1,
            item: ChannelDiagnosis {
                channel,
                properties: 0,
                error_type: 1,
                extended: None,
                qualifier: None,
            },
        };
        let kept = (0..1000)
            .filter(|channel| diagnoses.add(pending(*channel)))
            .count();
        assert_eq!((kept, diagnoses.pending.len()), (DIAGNOSES, DIAGNOSES));
        // one that is there already needs no room
        assert!(diagnoses.add(pending(0)));
    }
}
