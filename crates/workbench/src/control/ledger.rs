//! Who has which axis, and what is permitted: a machine without a clock, threads and drives of its own.
//!
//! One holder at a time has an axis, by its socket and a lease number, and one more may wait for it. A STOP raises the epoch: what
//! was requested before it is refused afterwards, and nothing is enabled or moved before it is reset.

use std::collections::BTreeMap;
use std::time::Instant;

use serde::Serialize;
use tokio::sync::oneshot;

use super::denied::Denied;
use crate::access::person;

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

impl Holder {
    /// Returns what it is called in a sentence.
    fn person(&self) -> String {
        person(&self.who, self.claimed_name.as_deref())
    }
}

#[cfg(test)]
impl Holder {
    /// The page with this socket, called after it.
    pub fn of(socket: u64) -> Self {
        Self {
            socket,
            who: socket.to_string(),
            claimed_name: None,
        }
    }
}

/// What is held of one axis.
#[derive(Debug)]
struct Held {
    holder: Holder,
    lease: u64,
    /// Highest speed of this lease, rpm.
    limit: f64,
    /// The direction was confirmed: the whole limit counts.
    confirmed: bool,
    /// Number of the last command; a later one is higher.
    last: u64,
    /// Its page gives it back: nothing more is carried out.
    leaving: bool,
    /// Who waits for it.
    wish: Option<Wish>,
}

impl Held {
    const fn new(holder: Holder, lease: u64, limit: f64) -> Self {
        Self {
            holder,
            lease,
            limit,
            confirmed: false,
            last: 0,
            leaving: false,
            wish: None,
        }
    }

    /// Returns who waits for it, if that one still does.
    fn wish(&self) -> Option<&Wish> {
        self.wish.as_ref().filter(|wish| !wish.answer.is_closed())
    }
}

/// When an axis is its page's, or why it will not be. Whoever closes it does not wait any more.
pub(crate) type Turn = oneshot::Receiver<Result<(), Denied>>;

/// A page that waits for an axis.
#[derive(Debug)]
struct Wish {
    holder: Holder,
    /// The lease that it will have.
    request: u64,
    limit: f64,
    /// It ends then, without an answer.
    until: Instant,
    answer: oneshot::Sender<Result<(), Denied>>,
}

/// Who waits for an axis, for pages.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Wanted {
    /// By this number the request is answered.
    pub request: u64,
    by: String,
    /// What that one is called by its own words, which nothing verifies.
    claimed_name: Option<String>,
    /// Whether it is handed over, or about to be.
    accepted: bool,
    /// What is left for an answer, s.
    seconds: u64,
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

    /// Gives an axis to a page, or lets it wait until this time for one that another page has. Returns the lease, and when it
    /// begins.
    pub fn take(
        &mut self,
        drive: &str,
        holder: Holder,
        limit: f64,
        wait: Option<Instant>,
    ) -> Result<(u64, Turn), Denied> {
        let (answer, turn) = oneshot::channel();
        let lease = self.leases + 1;
        match self.held.get_mut(drive) {
            None => {
                // the other end is here
                let _ = answer.send(Ok(()));
                self.held
                    .insert(drive.to_owned(), Held::new(holder, lease, limit));
            }
            Some(held) => {
                let until = wait.filter(|_| held.holder.socket != holder.socket);
                let until = until.ok_or_else(|| Denied::Taken {
                    who: held.holder.person(),
                })?;
                if let Some(wish) = held.wish() {
                    return Err(Denied::Requested {
                        who: wish.holder.person(),
                    });
                }
                held.wish = Some(Wish {
                    holder,
                    request: lease,
                    limit,
                    until,
                    answer,
                });
            }
        }
        self.leases = lease;
        Ok((lease, turn))
    }

    /// Returns who waits for an axis, and how long from now.
    pub fn wanted(&self, drive: &str, now: Instant) -> Option<Wanted> {
        let held = self.held.get(drive)?;
        let wish = held.wish()?;
        Some(Wanted {
            request: wish.request,
            by: wish.holder.who.clone(),
            claimed_name: wish.holder.claimed_name.clone(),
            accepted: held.leaving,
            seconds: wish.until.saturating_duration_since(now).as_secs_f64().ceil() as u64,
        })
    }

    /// Returns whether any page has an axis, or takes one.
    pub fn has_axes(&self) -> bool {
        !self.held.is_empty()
    }

    /// Returns whether an axis is held by this lease, or waited for.
    pub fn is_known(&self, drive: &str, lease: u64) -> bool {
        let held = self.held.get(drive);
        held.is_some_and(|held| held.lease == lease || held.wish().is_some_and(|wish| wish.request == lease))
    }

    /// Returns whether an axis is on its way back from the page that has it.
    pub fn is_leaving(&self, drive: &str) -> bool {
        self.held.get(drive).is_some_and(|held| held.leaving)
    }

    /// Notes that an axis is given back, whoever waits for it, or that this lease is not waited for any more.
    pub fn leave(&mut self, drive: &str, lease: u64) {
        if let Some(held) = self.held.get_mut(drive) {
            held.leaving |= held.lease == lease;
            held.wish.take_if(|wish| wish.request == lease);
        }
    }

    /// Gives an axis back for the page with this request, which has it once it is at rest. Returns who that is.
    pub fn hand_over(&mut self, drive: &str, stamp: Stamp, request: u64) -> Result<String, Denied> {
        let held = self.held(drive, stamp)?;
        let wish = held.wish().filter(|wish| wish.request == request);
        // another page must not have it
        let who = wish.ok_or(Denied::Withdrawn)?.holder.person();
        held.leaving = true;
        Ok(who)
    }

    /// Keeps an axis from the page with this request. Returns who that is.
    pub fn keep(&mut self, drive: &str, stamp: Stamp, request: u64) -> Result<String, Denied> {
        let held = self.held(drive, stamp)?;
        let wish = held.wish.take_if(|wish| wish.request == request);
        let Wish { holder, answer, .. } = wish.ok_or(Denied::Withdrawn)?;
        let who = held.holder.person();
        // who does not wait any more needs no answer
        let _ = answer.send(Err(Denied::Kept { who }));
        Ok(holder.person())
    }

    /// Notes that an axis was given back. Where it is at rest, the page that waits for it has it from now on.
    pub fn give_back(&mut self, drive: &str, lease: u64, at_rest: bool) {
        if self.held.get(drive).is_none_or(|held| held.lease != lease) {
            return;
        }
        let Some(wish) = self.held.remove(drive).and_then(|held| held.wish) else {
            return;
        };
        let answer = if at_rest { Ok(()) } else { Err(Denied::NotAtRest) };
        if wish.answer.send(answer).is_ok() && at_rest {
            let held = Held::new(wish.holder, wish.request, wish.limit);
            self.held.insert(drive.to_owned(), held);
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
        if held.leaving {
            return Err(Denied::Leaving);
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

    /// Notes that a person has seen the axis turn in the direction that was meant, where it has moved.
    pub fn confirm(&mut self, drive: &str, stamp: Stamp, moved: bool) -> Result<(), Denied> {
        let held = self.held(drive, stamp)?;
        held.confirmed |= moved;
        match moved {
            true => Ok(()),
            false => Err(Denied::Unmoved),
        }
    }

    /// Returns whether the direction of an axis was confirmed.
    pub fn is_confirmed(&self, drive: &str) -> bool {
        self.held.get(drive).is_some_and(|held| held.confirmed)
    }

    /// Ends the waiting of each page.
    pub fn end_requests(&mut self, denied: &Denied) {
        for wish in self.held.values_mut().filter_map(|held| held.wish.take()) {
            // as in `keep`
            let _ = wish.answer.send(Err(denied.clone()));
        }
    }

    /// Stops everything, and ends all requests for axes. Returns the new epoch.
    pub fn stop(&mut self) -> u64 {
        self.epoch += 1;
        self.stopped = true;
        self.end_requests(&Denied::StoppedWaiting);
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
    use std::time::Duration;

    use tokio::sync::oneshot::error::TryRecvError;

    use super::*;

    fn stamp(socket: u64, lease: u64, epoch: u64, number: u64) -> Stamp {
        Stamp {
            socket,
            lease,
            epoch,
            number,
        }
    }

    fn minute() -> Option<Instant> {
        Some(Instant::now() + Duration::from_secs(60))
    }

    fn wanted(ledger: &Ledger) -> Option<Wanted> {
        ledger.wanted("a", Instant::now())
    }

    fn take(ledger: &mut Ledger, socket: u64) -> u64 {
        let (lease, mut turn) = ledger.take("a", Holder::of(socket), 100.0, None).unwrap();
        assert_eq!(turn.try_recv(), Ok(Ok(())), "at once");
        lease
    }

    fn request(ledger: &mut Ledger, socket: u64) -> (u64, Turn) {
        let (request, mut turn) = ledger.take("a", Holder::of(socket), 100.0, minute()).unwrap();
        assert_eq!(turn.try_recv(), Err(TryRecvError::Empty), "not at once");
        (request, turn)
    }

    #[test]
    fn an_axis_is_handed_over_once_it_was_given_back_at_rest() {
        let mut ledger = Ledger::default();
        let lease = take(&mut ledger, 1);
        let (request, mut turn) = request(&mut ledger, 2);
        assert!(ledger.is_known("a", request) && !wanted(&ledger).unwrap().accepted);
        // the one who has it is not disturbed, and the other one moves nothing
        ledger
            .permit_motion("a", stamp(1, lease, 0, 1), Some(1.0))
            .unwrap();
        let early = ledger.permit_motion("a", stamp(2, request, 0, 1), Some(1.0));
        assert_eq!(early, Err(Denied::NotHeld));
        let other = ledger.hand_over("a", stamp(1, lease, 0, 2), request + 1);
        assert_eq!(other, Err(Denied::Withdrawn), "for another page");
        ledger.hand_over("a", stamp(1, lease, 0, 3), request).unwrap();
        assert!(wanted(&ledger).unwrap().accepted);
        let late = ledger.permit_motion("a", stamp(1, lease, 0, 4), Some(1.0));
        assert_eq!(late, Err(Denied::Leaving));
        assert_eq!(turn.try_recv(), Err(TryRecvError::Empty), "before it is at rest");
        ledger.give_back("a", lease, true);
        assert_eq!(turn.try_recv(), Ok(Ok(())));
        assert!(!ledger.is_known("a", lease) && wanted(&ledger).is_none());
        ledger
            .permit_motion("a", stamp(2, request, 0, 2), Some(1.0))
            .unwrap();
    }

    #[test]
    fn a_request_ends_in_one_way() {
        let end = |end: &mut dyn FnMut(&mut Ledger, u64, u64)| {
            let mut ledger = Ledger::default();
            let lease = take(&mut ledger, 1);
            let (request, mut turn) = request(&mut ledger, 2);
            end(&mut ledger, lease, request);
            assert!(!ledger.is_known("a", request), "it waits for nothing more");
            turn.try_recv().unwrap().unwrap_err()
        };
        let kept = end(&mut |ledger, lease, request| {
            ledger.keep("a", stamp(1, lease, 0, 1), request).unwrap();
            let again = ledger.keep("a", stamp(1, lease, 0, 2), request);
            assert_eq!(again, Err(Denied::Withdrawn));
        });
        assert_eq!(kept.to_string(), "session 1 keeps control of this drive");
        let stopped = end(&mut |ledger, lease, request| {
            ledger.hand_over("a", stamp(1, lease, 0, 1), request).unwrap();
            ledger.stop();
        });
        assert_eq!(stopped, Denied::StoppedWaiting, "accepted or not");
        let lost = end(&mut |ledger, lease, _| ledger.give_back("a", lease, false));
        assert_eq!(lost, Denied::NotAtRest);
    }

    #[test]
    fn one_page_waits_and_who_left_is_nobody() {
        let mut ledger = Ledger::default();
        let lease = take(&mut ledger, 1);
        let (first, turn) = request(&mut ledger, 2);
        let denied = ledger.take("a", Holder::of(3), 100.0, minute()).unwrap_err();
        assert_eq!(denied.to_string(), "session 2 has already requested this drive");
        drop(turn);
        assert_eq!(wanted(&ledger), None);
        let (second, turn) = request(&mut ledger, 3);
        let denied = ledger.hand_over("a", stamp(1, lease, 0, 1), first);
        assert_eq!(denied, Err(Denied::Withdrawn), "what was meant for another one");
        assert_eq!(wanted(&ledger).unwrap().request, second);
        ledger.leave("a", second);
        assert_eq!(wanted(&ledger), None, "withdrawn");
        drop(turn);
        ledger.leave("a", lease);
        ledger.give_back("a", lease, true);
        take(&mut ledger, 4);
    }

    #[test]
    fn an_axis_has_one_holder_by_its_socket_and_its_lease() {
        let mut ledger = Ledger::default();
        let lease = take(&mut ledger, 1);
        let taken = Denied::Taken {
            who: "session 1".to_owned(),
        };
        for (socket, wait) in [(2, None), (1, None), (1, minute())] {
            let denied = ledger.take("a", Holder::of(socket), 100.0, wait).unwrap_err();
            assert_eq!(denied, taken, "nor twice");
        }
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
        ledger.give_back("a", lease + 1, true);
        assert!(ledger.is_known("a", lease), "of another lease");
        ledger.give_back("a", lease, true);
        let again = take(&mut ledger, 1);
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
        let lease = take(&mut ledger, 1);
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
            ..Holder::of(1)
        };
        ledger.take("a", anna, 100.0, None).unwrap();
        let denied = ledger.take("a", Holder::of(2), 100.0, None).unwrap_err();
        assert_eq!(
            denied.to_string(),
            "session 1 (\"Anna\", not verified) has control of this drive"
        );
    }

    #[test]
    fn the_first_motion_is_slow() {
        let mut ledger = Ledger::default();
        let lease = take(&mut ledger, 1);
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
        assert_eq!(
            ledger.confirm("a", stamp(1, lease, 0, 49), false),
            Err(Denied::Unmoved)
        );
        assert!(!ledger.is_confirmed("a"), "of an axis that stood");
        ledger.confirm("a", stamp(1, lease, 0, 50), true).unwrap();
        assert!(ledger.is_confirmed("a"));
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
