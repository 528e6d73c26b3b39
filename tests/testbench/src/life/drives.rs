//! The drives of a life: what is known of their models, their disks, and what their values were.

use std::collections::VecDeque;

use network::host::{Host, StationId};
use profile::parameter::{Keep, ParameterAccess, SaveId};
use profinet::Instant;
use virtual_drive::drive::Drive as VirtualDrive;
use virtual_drive::model;
use virtual_drive::model::Model as Virtual;
use virtual_drive::station::{Station, StationConfig};

/// What a value was, and when.
#[derive(Debug)]
pub(super) struct Log<T>(pub(super) Vec<(Instant, T)>);

impl<T: PartialEq + Copy> Log<T> {
    pub(super) fn note(&mut self, now: Instant, value: T) {
        if self.0.last().is_none_or(|(_, last)| *last != value) {
            self.0.push((now, value));
        }
    }

    /// True if it was this at some time from `from` on until `to`.
    pub(super) fn had(&self, from: Instant, to: Instant, value: T) -> bool {
        let ends = self.0.iter().skip(1).map(|(end, _)| *end).chain([Instant::MAX]);
        let mut spans = self.0.iter().zip(ends);
        spans.any(|((begin, is), end)| *is == value && *begin <= to && end >= from)
    }
}

/// What is known of a model.
pub(super) struct Kind {
    pub(super) model: &'static Virtual,
    /// Two parameters that are free, and saved: how people and the vendor call them.
    pub(super) pair: [(&'static str, u16); 2],
    /// Decimal places of both.
    pub(super) decimals: usize,
    pub(super) fault: u16,
    /// What decides what the drive does without its controller, the values that are tried, and those with which it stops.
    pub(super) loss: Option<(u16, &'static [u64], &'static [i64])>,
}

pub(super) const KINDS: [Kind; 3] = [
    Kind {
        model: &model::AKD,
        pair: [("USER.INT1", 2497), ("USER.INT2", 2498)],
        decimals: 0,
        fault: 439,
        loss: None,
    },
    Kind {
        model: &model::VLT,
        pair: [("3-61", 361), ("3-62", 362)],
        decimals: 2,
        fault: 14,
        // 8-04: off, freeze output, stop, stop and trip
        loss: Some((804, &[0, 1, 2, 5], &[2, 5])),
    },
    Kind {
        model: &model::VACON,
        pair: [("id502", 502), ("id503", 503)],
        decimals: 1,
        fault: 14,
        // ID 733: no action, warning, fault with stop, fault with coasting
        loss: Some((733, &[0, 1, 2, 3], &[2, 3])),
    },
];

pub(super) type Pair = [i64; 2];

/// The disk behind a drive: one save at a time, each needs a while.
#[derive(Default)]
pub(super) struct Disk {
    pub(super) stored: Option<Vec<u8>>,
    /// The pair in it, where something is stored.
    pub(super) pair: Option<Pair>,
    /// When each is stored, its number, text and pair.
    pub(super) writing: VecDeque<(Instant, SaveId, String, Pair)>,
    pub(super) full: bool,
}

pub(super) struct Place {
    pub(super) kind: &'static Kind,
    pub(super) id: StationId,
    pub(super) config: StationConfig,
    pub(super) disk: Disk,
    pub(super) powered: bool,
    pub(super) cut: bool,
    pub(super) values: [Log<i64>; 2],
    pub(super) enabled: Log<bool>,
    /// When a client could last send to it.
    pub(super) carried: Instant,
    pub(super) exchanging: bool,
}

pub(super) fn drive_of(station: &mut Host<Station>) -> &mut VirtualDrive {
    station.endpoint_mut().drive_mut()
}

pub(super) fn value_of(drive: &mut VirtualDrive, number: u16) -> i64 {
    let parameter = drive.model().numbered(number).expect("known");
    let index = parameter.base.unwrap_or(0);
    let pnu = parameter.pnu;
    let raw = ParameterAccess::read(drive, pnu, index).expect("readable");
    raw as i64
}

pub(super) fn set_value(drive: &mut VirtualDrive, number: u16, value: i64) {
    let parameter = drive.model().numbered(number).expect("known");
    let index = parameter.base.unwrap_or(0);
    ParameterAccess::write(drive, parameter.pnu, index, value as u64, Keep::Volatile).expect("taken");
}

impl Kind {
    pub(super) fn pair_of(&self, drive: &mut VirtualDrive) -> Pair {
        self.pair.map(|(_, number)| value_of(drive, number))
    }

    /// Returns true if the drive, by its settings, stops without a controller.
    pub(super) fn stops(&self, drive: &mut VirtualDrive) -> bool {
        self.loss
            .is_none_or(|(number, _, stopping)| stopping.contains(&value_of(drive, number)))
    }
}

/// The drive as it comes up.
pub(super) fn started(config: &StationConfig) -> Box<Host<Station>> {
    let mut station = Station::new(config.clone());
    station.confirm_saves();
    Box::new(Host::new(station))
}
