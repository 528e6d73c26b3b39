//! Who has which axis, and what is permitted: a machine without time, threads and drives of its own.
//!
//! One holder at a time has an axis, by its socket and a lease number. A STOP raises the epoch: what was requested before it is
//! refused afterwards, and nothing is enabled or moved before it is reset.

use std::collections::BTreeMap;

use profidrive::profile::notation::figures;

use crate::access::person;
use crate::problem::STANDS_STILL;

/// What a new holder may do at most before the direction is confirmed, of its own limit.
const FIRST: f64 = 0.1;

/// Who wants something: a socket, and its name in the log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Holder {
    /// Number of the socket. A second page of the same session is another one.
    pub socket: u64,
    /// What it is called in the log.
    pub who: String,
    /// What its people called themselves when the axis was taken, which nothing verifies.
    pub claimed_name: Option<String>,
}

/// What is held of one axis.
#[derive(Debug, Clone)]
struct Held {
    holder: Holder,
    lease: u64,
    /// Highest speed of this lease, rpm.
    limit: f64,
    /// The direction was confirmed: the whole limit counts.
    confirmed: bool,
    /// Number of the last command; a later one is higher.
    last: u64,
}

/// Why something is not permitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum Denied {
    #[error("this session is view-only: open the link for control to move an axis")]
    View,
    #[error("this server was started view-only: pages can look and stop")]
    ReadOnly,
    #[error(
        "this page is on another computer: whoever moves a machine must see it, and this server was not started to permit it from there"
    )]
    Remote,
    #[error("drives that are given by their addresses have parameters only: control needs an interface")]
    Addresses,
    #[error(
        "on a machine a person confirms first that the axis is in sight, that its way is clear and that an emergency stop is at hand"
    )]
    Unchecked,
    #[error("the highest speed has to be a number above 0 rpm")]
    NoLimit,
    #[error("the longest travel has to be a number above 0 rev")]
    NoTravel,
    #[error("this page has control of {most} axes, which is the most")]
    TooMany { most: usize },
    #[error("no such drive has answered")]
    Unknown,
    #[error("{}", STANDS_STILL)]
    StandsStill,
    #[error("this jog came too late: the button may be up by now")]
    LateJog,
    #[error("{who} has control of this drive")]
    Taken { who: String },
    #[error("this page has no control of the drive, or has it no more")]
    NotHeld,
    #[error("STOP was pressed meanwhile: what was requested before it is not carried out")]
    Outdated,
    #[error("STOP was pressed: it has to be reset before anything is enabled or moved")]
    Stopped,
    #[error("this command came before another one and is not carried out")]
    Replayed,
    #[error(
        "{} rpm is above {} rpm: the first motion is limited to a tenth until its direction is confirmed",
        figures(*.speed), figures(*.limit)
    )]
    Unconfirmed { speed: f64, limit: f64 },
    #[error(
        "the speed of this motion is stored in the drive: it waits until the direction of a first motion, at {} rpm at most, is confirmed",
        figures(*.limit)
    )]
    UnconfirmedStored { limit: f64 },
    #[error("{} rpm is above the limit of this page, {} rpm", figures(*.speed), figures(*.limit))]
    Limit { speed: f64, limit: f64 },
    #[error(
        "a jog needs the round trip of the beats of its page, which this command does not have: send it as `rtt`, in ms"
    )]
    NoRoundTrip,
    #[error(
        "the round trip to the page is {} ms, above {} ms: an axis would be jogged by what its page shows too late",
        figures(*.ms), figures(ROUND_TRIP)
    )]
    RoundTrip { ms: f64 },
}

/// The longest round trip of the beats of a page that jogs, in ms: that which 99 of 100 keep to.
const ROUND_TRIP: f64 = 100.0;

/// Permits a jog by the round trip that its page reports. No other side knows it: the answer to a beat ends at the page.
pub(crate) fn permit_round_trip(ms: Option<f64>) -> Result<(), Denied> {
    match ms {
        None => Err(Denied::NoRoundTrip),
        // not a number is no short one
        Some(ms) if (0.0..=ROUND_TRIP).contains(&ms) => Ok(()),
        Some(ms) => Err(Denied::RoundTrip { ms }),
    }
}

impl Denied {
    /// Returns the stable name of what is denied to a page whatever it requests; nothing of other refusals.
    pub const fn of_page(&self) -> Option<&'static str> {
        Some(match self {
            Self::View => "view",
            Self::ReadOnly => "read_only",
            Self::Remote => "remote",
            Self::Addresses => "addresses",
            _ => return None,
        })
    }
}

/// What a command comes with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Stamp {
    pub socket: u64,
    pub lease: u64,
    /// The epoch that its page has seen.
    pub epoch: u64,
    /// Grows with each command of a page.
    pub number: u64,
}

/// What is permitted.
#[derive(Debug, Default)]
pub(crate) struct Ledger {
    epoch: u64,
    stopped: bool,
    leases: u64,
    held: BTreeMap<String, Held>,
}

impl Ledger {
    /// Counts the stops.
    pub const fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Returns whether a stop is to be reset before anything moves.
    pub const fn is_stopped(&self) -> bool {
        self.stopped
    }

    /// Gives an axis to a page. Returns the lease.
    pub fn take(&mut self, drive: &str, holder: Holder, limit: f64) -> Result<u64, Denied> {
        if let Some(held) = self.held.get(drive) {
            let who = person(&held.holder.who, held.holder.claimed_name.as_deref());
            return Err(Denied::Taken { who });
        }
        self.leases += 1;
        let held = Held {
            holder,
            lease: self.leases,
            limit,
            confirmed: false,
            last: 0,
        };
        self.held.insert(drive.to_owned(), held);
        Ok(self.leases)
    }

    /// Notes that an axis was given back.
    pub fn give_back(&mut self, drive: &str, lease: u64) {
        if self.held.get(drive).is_some_and(|held| held.lease == lease) {
            self.held.remove(drive);
        }
    }

    fn held(&mut self, drive: &str, stamp: Stamp) -> Result<&mut Held, Denied> {
        let held = self.held.get_mut(drive).ok_or(Denied::NotHeld)?;
        if (held.holder.socket, held.lease) != (stamp.socket, stamp.lease) {
            return Err(Denied::NotHeld);
        }
        if stamp.number <= held.last {
            return Err(Denied::Replayed);
        }
        held.last = stamp.number;
        Ok(held)
    }

    /// Permits something that ends a motion, or lets none begin.
    pub fn permit(&mut self, drive: &str, stamp: Stamp) -> Result<(), Denied> {
        self.held(drive, stamp).map(|_| ())
    }

    /// Permits enabling.
    pub fn permit_enable(&mut self, drive: &str, stamp: Stamp) -> Result<(), Denied> {
        let (epoch, stopped) = (self.epoch, self.stopped);
        self.held(drive, stamp)?;
        match stamp.epoch == epoch {
            false => Err(Denied::Outdated),
            true if stopped => Err(Denied::Stopped),
            true => Ok(()),
        }
    }

    /// Permits a motion at this speed in rpm; without one the drive has the speed, which may be above a first one.
    pub fn permit_motion(&mut self, drive: &str, stamp: Stamp, speed: Option<f64>) -> Result<(), Denied> {
        self.permit_enable(drive, stamp)?;
        let held = self.held.get(drive).ok_or(Denied::NotHeld)?;
        let (limit, confirmed) = (held.limit, held.confirmed);
        let Some(speed) = speed.map(f64::abs) else {
            // whether it is within the whole limit is known once the drive was read
            return match confirmed {
                true => Ok(()),
                false => Err(Denied::UnconfirmedStored { limit: limit * FIRST }),
            };
        };
        // not a number is above each limit
        let within = |limit: f64| speed <= limit;
        match () {
            () if !within(limit) => Err(Denied::Limit { speed, limit }),
            () if !confirmed && !within(limit * FIRST) => Err(Denied::Unconfirmed {
                speed,
                limit: limit * FIRST,
            }),
            () => Ok(()),
        }
    }

    /// Notes that a person has seen the axis turn in the direction that was meant.
    pub fn confirm(&mut self, drive: &str, stamp: Stamp) -> Result<(), Denied> {
        self.held(drive, stamp)?.confirmed = true;
        Ok(())
    }

    /// Stops everything. Returns the new epoch.
    pub const fn stop(&mut self) -> u64 {
        self.epoch += 1;
        self.stopped = true;
        self.epoch
    }

    /// Lets axes be enabled again, where STOP was not pressed since the epoch that the page has seen.
    pub fn reset(&mut self, epoch: u64) -> Result<(), Denied> {
        if epoch != self.epoch {
            return Err(Denied::Outdated);
        }
        self.stopped = false;
        Ok(())
    }

    /// Returns whether a command that waited for its turn may still be carried out.
    pub fn is_current(&self, drive: &str, stamp: Stamp) -> bool {
        let held = self.held.get(drive);
        !self.stopped && stamp.epoch == self.epoch && held.is_some_and(|held| held.lease == stamp.lease)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(socket: u64) -> Holder {
        Holder {
            socket,
            who: socket.to_string(),
            claimed_name: None,
        }
    }

    fn stamp(socket: u64, lease: u64, epoch: u64, number: u64) -> Stamp {
        Stamp {
            socket,
            lease,
            epoch,
            number,
        }
    }

    #[test]
    fn an_axis_has_one_holder_by_its_socket_and_its_lease() {
        let mut ledger = Ledger::default();
        let lease = ledger.take("a", page(1), 100.0).unwrap();
        let taken = Denied::Taken {
            who: "session 1".to_owned(),
        };
        assert_eq!(ledger.take("a", page(2), 100.0), Err(taken.clone()));
        assert_eq!(ledger.take("a", page(1), 100.0), Err(taken), "nor twice");
        assert_eq!(
            ledger.permit_enable("a", stamp(2, lease, 0, 1)),
            Err(Denied::NotHeld)
        );
        assert_eq!(
            ledger.permit_enable("b", stamp(1, lease, 0, 1)),
            Err(Denied::NotHeld)
        );
        ledger.permit_enable("a", stamp(1, lease, 0, 1)).unwrap();
        assert_eq!(
            ledger.permit_enable("a", stamp(1, lease, 0, 1)),
            Err(Denied::Replayed)
        );
        ledger.give_back("a", lease + 1);
        assert!(ledger.take("a", page(2), 100.0).is_err(), "of another lease");
        ledger.give_back("a", lease);
        let again = ledger.take("a", page(1), 100.0).unwrap();
        assert_eq!(
            ledger.permit("a", stamp(1, lease, 0, 9)),
            Err(Denied::NotHeld),
            "an old lease"
        );
        ledger.permit("a", stamp(1, again, 0, 1)).unwrap();
    }

    #[test]
    fn after_a_stop_nothing_moves_before_it_is_reset() {
        let mut ledger = Ledger::default();
        let lease = ledger.take("a", page(1), 100.0).unwrap();
        assert!(ledger.is_current("a", stamp(1, lease, 0, 0)));
        assert_eq!(ledger.stop(), 1);
        assert!(!ledger.is_current("a", stamp(1, lease, 0, 0)));
        let late = stamp(1, lease, 0, 1);
        assert_eq!(ledger.permit_motion("a", late, Some(1.0)), Err(Denied::Outdated));
        let seen = stamp(1, lease, 1, 2);
        assert_eq!(ledger.permit_motion("a", seen, Some(1.0)), Err(Denied::Stopped));
        assert_eq!(
            ledger.reset(0),
            Err(Denied::Outdated),
            "by a page that has not seen it"
        );
        ledger.reset(1).unwrap();
        ledger
            .permit_motion("a", stamp(1, lease, 1, 3), Some(1.0))
            .unwrap();
        // what ends a motion is permitted at any time
        ledger.stop();
        ledger.permit("a", stamp(1, lease, 0, 4)).unwrap();
    }

    #[test]
    fn a_refusal_names_the_holder_as_it_calls_itself_and_that_nothing_verifies_it() {
        let mut ledger = Ledger::default();
        let anna = Holder {
            claimed_name: Some("Anna".to_owned()),
            ..page(1)
        };
        ledger.take("a", anna, 100.0).unwrap();
        let denied = ledger.take("a", page(2), 100.0).unwrap_err();
        assert_eq!(
            denied.to_string(),
            "session 1 (\"Anna\", not verified) has control of this drive"
        );
    }

    #[test]
    fn a_page_that_answers_late_or_reports_no_round_trip_jogs_nothing() {
        for short in [0.0, 7.5, 100.0] {
            permit_round_trip(Some(short)).unwrap();
        }
        for long in [100.1, 1e308, f64::INFINITY, f64::NAN, -1.0] {
            let denied = permit_round_trip(Some(long)).unwrap_err();
            assert!(matches!(denied, Denied::RoundTrip { .. }), "{denied}");
            assert!(denied.to_string().len() < 120, "{denied}");
        }
        let none = permit_round_trip(None).unwrap_err();
        assert!(none.to_string().contains("rtt"), "{none}");
    }

    #[test]
    fn numbers_of_any_size_fit_into_a_sentence() {
        for (speed, text) in [
            (1e308, "1e308 rpm"),
            (12.5, "12.5 rpm"),
            (f64::INFINITY, "inf rpm"),
        ] {
            let denied = Denied::Limit { speed, limit: 300.0 }.to_string();
            assert!(denied.starts_with(text) && denied.len() < 80, "{denied}");
        }
    }

    #[test]
    fn the_first_motion_is_slow() {
        let mut ledger = Ledger::default();
        let lease = ledger.take("a", page(1), 100.0).unwrap();
        let mut number = 0;
        let mut at = |ledger: &mut Ledger, speed| {
            number += 1;
            ledger.permit_motion("a", stamp(1, lease, 0, number), speed)
        };
        assert!(matches!(
            at(&mut ledger, Some(10.1)),
            Err(Denied::Unconfirmed { .. })
        ));
        at(&mut ledger, Some(-10.0)).unwrap();
        assert!(matches!(
            at(&mut ledger, None),
            Err(Denied::UnconfirmedStored { .. })
        ));
        assert!(matches!(
            at(&mut ledger, Some(f64::NAN)),
            Err(Denied::Limit { .. })
        ));
        ledger.confirm("a", stamp(1, lease, 0, 50)).unwrap();
        number = 50;
        let mut at = |ledger: &mut Ledger, speed| {
            number += 1;
            ledger.permit_motion("a", stamp(1, lease, 0, number), speed)
        };
        at(&mut ledger, Some(-100.0)).unwrap();
        assert!(matches!(at(&mut ledger, Some(100.1)), Err(Denied::Limit { .. })));
        at(&mut ledger, None).unwrap();
    }
}
