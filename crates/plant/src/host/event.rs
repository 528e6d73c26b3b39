//! Events that a running simulation reports to its front end.

use std::fmt;
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::sleep;
use std::time::Duration;

use profinet::{IpSuite, MacAddress};
use virtual_drive::model::Model;
use virtual_drive::station::StationEvent;

use super::duplicate_check::Duplicate;
use super::load::{Load, Overload};
use crate::event::PlantEvent;
use crate::text::count;
use crate::timeline::Played;
use crate::trace::EventKind;

/// Events that may wait for their receiver; further ones are counted and left out.
const WAITING: usize = 4096;
/// How long a receiver is waited for before the first cycle, in all: then there are more events at once than may wait.
const PATIENCE: Duration = Duration::from_secs(1);

/// Something that happened to a simulation.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Event {
    /// Something happened to one drive.
    Drive {
        /// Name of the drive in this simulation.
        drive: Arc<str>,
        /// Time since the start of the simulation.
        at: Duration,
        /// What.
        what: Box<DriveEvent>,
    },
    /// All drives run.
    Running {
        /// How many.
        drives: usize,
        /// Network interface or serial port.
        place: String,
        /// It is a serial port.
        serial: bool,
    },
    /// What the simulation does, at the times wished for.
    Load(Load),
    /// The drives came too late, as the processor had too much to do.
    Overload(Overload),
    /// Interface or port failed, for this reason; the drives go on without it.
    CarrierLost(String),
    /// Interface or port is back.
    CarrierBack(String),
    /// A name or address is in use.
    Duplicate(Duplicate),
    /// A saved file is not valid and was set aside.
    SetAside(String),
    /// The drive has the address that it saved, not the planned one.
    SavedAddress {
        /// Name of the drive in this simulation.
        drive: Arc<str>,
        /// The address of the state folder.
        saved: Ipv4Addr,
        /// The address of the plan.
        planned: Ipv4Addr,
    },
    /// There is no control socket, for this reason; everything else works.
    NoControlSocket(String),
    /// The last changes of these drives were not written in time and are lost.
    Unsaved {
        /// Names of the drives in this simulation.
        drives: Vec<Arc<str>>,
        /// How long was waited for the disk.
        waited: Duration,
    },
    /// So many events were left out because their receiver was too slow.
    LeftOut(u64),
}

/// Something that happened to one drive.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum DriveEvent {
    /// It runs on a network.
    Ready {
        /// Name of station; may be empty.
        name: String,
        /// Its MAC address.
        mac: MacAddress,
        /// Its IP address, or none yet.
        ip: IpSuite,
        /// It looks for an address by itself (DHCP, AutoIP).
        acquires_address: bool,
    },
    /// It runs at a serial line, as the slave with this address.
    ReadyAtLine(u8),
    /// Something of its time line or of the control socket happened.
    Played(Played),
    /// A request of the control socket happened at a serial line.
    Injected(String),
    /// Something that was to last for a time has ended.
    Ended(PlantEvent),
    /// The station of this model reported something.
    Station(&'static Model, StationEvent),
    /// Its state was saved, or not.
    Saved(Saved, SaveResult),
}

/// State that a drive saves.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Saved {
    /// Name and IP address.
    Network(String, IpSuite),
    /// Parameters.
    Parameters,
}

/// What became of a save.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SaveResult {
    /// It is in the state folder.
    Stored,
    /// There is no state folder: the state is discarded at the end of the simulation.
    NoFolder,
    /// It could not be written, for this reason.
    Failed(String),
}

impl Event {
    /// Returns true for an event that requires attention.
    #[must_use]
    pub const fn is_warning(&self) -> bool {
        match self {
            Self::Drive { what, .. } => what.is_warning(),
            Self::Running { .. } | Self::CarrierBack(_) | Self::Load(_) => false,
            _ => true,
        }
    }
}

impl DriveEvent {
    /// Returns the event as a trace has it.
    #[must_use]
    pub fn kind(&self) -> EventKind {
        let typed = match self {
            Self::Played(played) => Some((*played).into()),
            Self::Ended(event) => Some(EventKind::Restored {
                action: event.to_string(),
            }),
            Self::Station(model, event) => EventKind::of_station(event, model.catalogue),
            _ => None,
        };
        typed.unwrap_or_else(|| EventKind::note(&self.to_string()))
    }

    /// Returns true for a requested event: by a time line, by the control socket, or its end.
    #[must_use]
    pub const fn is_commanded(&self) -> bool {
        matches!(self, Self::Played(_) | Self::Injected(_) | Self::Ended(_))
    }

    const fn is_warning(&self) -> bool {
        matches!(
            self,
            Self::Saved(_, SaveResult::Failed(_)) | Self::Station(_, StationEvent::ParametersIgnored(_))
        )
    }
}

impl Event {
    pub(super) fn of(drive: &Arc<str>, at: Duration, what: DriveEvent) -> Self {
        Self::Drive {
            drive: Arc::clone(drive),
            at,
            what: Box::new(what),
        }
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drive { drive, what, .. } => write!(f, "{drive}: {what}"),
            Self::Running {
                drives,
                place,
                serial,
            } => {
                let drives = count(*drives);
                let at = if *serial { "at" } else { "on" };
                write!(f, "{drives} {at} {place}")
            }
            Self::Load(load) => load.fmt(f),
            Self::Overload(overload) => overload.fmt(f),
            Self::CarrierLost(why) => {
                write!(f, "{why}: waiting until it is back; the drives go on without it")
            }
            Self::CarrierBack(place) => write!(f, "{place} is back"),
            Self::Duplicate(duplicate) => duplicate.fmt(f),
            Self::SetAside(why) => f.write_str(why),
            Self::SavedAddress {
                drive,
                saved,
                planned,
            } => {
                write!(f, "{drive}: the saved address {saved} counts, not {planned}")
            }
            Self::NoControlSocket(why) => write!(f, "no control socket: {why}"),
            Self::Unsaved { drives, waited } => write!(
                f,
                "the disk did not take the last changes of {} within {} s: they are lost",
                drives.join(", "),
                waited.as_secs()
            ),
            Self::LeftOut(missing) => write!(
                f,
                "{missing} lines were left out: they came faster than they could be printed"
            ),
        }
    }
}

impl fmt::Display for DriveEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ready {
                name,
                mac,
                ip,
                acquires_address,
            } => {
                let name = if name.is_empty() { "no name" } else { name };
                write!(f, "ready: {name}, {mac}, ")?;
                match (ip.is_set(), acquires_address) {
                    (true, _) => write!(f, "{}", ip.address),
                    (false, true) => f.write_str("looks for an address (DHCP, AutoIP)"),
                    (false, false) => f.write_str("waits for its address"),
                }
            }
            Self::ReadyAtLine(number) => write!(f, "ready: address {number}"),
            Self::Played(played) => EventKind::from(*played).fmt(f),
            Self::Injected(text) => f.write_str(text),
            Self::Ended(event) => event.fmt(f),
            Self::Station(model, event) => {
                f.write_str(event.words(model.catalogue).as_deref().unwrap_or_default())
            }
            Self::Saved(saved, result) => {
                saved.fmt(f)?;
                match result {
                    SaveResult::Stored => f.write_str("; kept over a restart"),
                    SaveResult::NoFolder => f.write_str("; kept over power-off until this program ends"),
                    SaveResult::Failed(why) => write!(f, ": not kept: {why}"),
                }
            }
        }
    }
}

impl fmt::Display for Saved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Network(name, ip) = self else {
            return f.write_str("parameters saved");
        };
        let name = if name.is_empty() { "no name" } else { name };
        write!(f, "name and address: {name}, ")?;
        if ip.is_set() {
            write!(f, "{}", ip.address)
        } else {
            f.write_str("no address")
        }
    }
}

/// Returns a channel for events: sending never waits, so that a slow receiver cannot hold up a cycle.
#[must_use]
pub fn events() -> (EventSender, Events) {
    channel(WAITING)
}

fn channel(waiting: usize) -> (EventSender, Events) {
    let (sender, events) = sync_channel(waiting);
    let left_out = Arc::new(AtomicU64::new(0));
    let receiver = Events {
        events,
        left_out: Arc::clone(&left_out),
    };
    (EventSender { sender, left_out }, receiver)
}

/// Sends events; made by [`events`].
#[derive(Debug, Clone)]
pub struct EventSender {
    sender: SyncSender<Event>,
    left_out: Arc<AtomicU64>,
}

impl EventSender {
    pub(super) fn send(&self, event: Event) {
        if self.sender.try_send(event).is_err() {
            self.left_out.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Sends what happened before the first cycle, which a receiver that is slow does not hold up.
    pub(super) fn begin(&self, events: impl IntoIterator<Item = Event>) {
        self.wait_for(PATIENCE, events);
    }

    fn wait_for(&self, mut patience: Duration, events: impl IntoIterator<Item = Event>) {
        let nap = Duration::from_millis(1);
        for mut event in events {
            while let Err(refused) = self.sender.try_send(event) {
                let TrySendError::Full(back) = refused else {
                    return;
                };
                if patience.is_zero() {
                    self.left_out.fetch_add(1, Ordering::Relaxed);
                    break;
                }
                event = back;
                sleep(nap);
                patience = patience.saturating_sub(nap);
            }
        }
    }

    pub(super) fn drive(&self, drive: &Arc<str>, at: Duration, what: DriveEvent) {
        self.send(Event::of(drive, at, what));
    }
}

/// Receives events until the simulation has ended; made by [`events`].
#[derive(Debug)]
pub struct Events {
    events: Receiver<Event>,
    left_out: Arc<AtomicU64>,
}

impl Iterator for Events {
    type Item = Event;

    /// Waits for the next event.
    fn next(&mut self) -> Option<Event> {
        match self.left_out.swap(0, Ordering::Relaxed) {
            0 => self.events.recv().ok(),
            missing => Some(Event::LeftOut(missing)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_receiver_blocks_no_sender_and_gets_the_number_of_missed_events() {
        let (sender, mut events) = channel(2);
        for number in 0..10 {
            sender.drive(&"akd-1".into(), Duration::ZERO, DriveEvent::ReadyAtLine(number));
        }
        assert!(matches!(events.next(), Some(Event::LeftOut(8))));
        drop(sender);
        let text: Vec<String> = events.map(|event| event.to_string()).collect();
        assert_eq!(text, ["akd-1: ready: address 0", "akd-1: ready: address 1"]);
    }

    #[test]
    fn before_the_first_cycle_a_receiver_is_waited_for() {
        let (sender, events) = channel(2);
        let ready = || {
            (0..100).map(|number| Event::of(&"akd-1".into(), Duration::ZERO, DriveEvent::ReadyAtLine(number)))
        };
        let received = std::thread::scope(|scope| {
            let receiver = scope.spawn(|| events.map(|event| event.to_string()).collect::<Vec<_>>());
            sender.wait_for(Duration::MAX, ready());
            drop(sender);
            receiver.join().unwrap()
        });
        assert_eq!(received.len(), 100, "{received:?}");
        // not for ever
        let (sender, mut events) = channel(2);
        sender.wait_for(Duration::ZERO, ready());
        assert!(matches!(events.next(), Some(Event::LeftOut(98))));
    }

    #[test]
    fn only_what_was_kept_is_called_kept() {
        let event = |result| DriveEvent::Saved(Saved::Parameters, result);
        let stored = event(SaveResult::Stored);
        assert_eq!(stored.to_string(), "parameters saved; kept over a restart");
        let volatile = event(SaveResult::NoFolder);
        assert_eq!(
            volatile.to_string(),
            "parameters saved; kept over power-off until this program ends"
        );
        let failed = event(SaveResult::Failed("disk full".into()));
        assert_eq!(failed.to_string(), "parameters saved: not kept: disk full");
        assert!(failed.is_warning() && !stored.is_warning() && !volatile.is_warning());
    }
}
