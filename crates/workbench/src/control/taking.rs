//! How a page comes to an axis: it takes one that is free, or waits until the page that has it hands it over.

use std::sync::Arc;
use std::time::{Duration, Instant};

use profidrive::motion::Hold;
use tokio::sync::mpsc;
use tokio::time::interval;

use super::axis::{PICTURE, hold};
use super::denied::Denied;
use super::ledger::{Holder, Turn};
use super::messages::Stamped;
use super::running::{Command, Reply, Running, StopBy, conflict};
use super::socket::Page;
use super::{Control, LEASE};
use crate::access::Caller;
use crate::act::{self, Author, Intent};
use crate::settings::Source;
use crate::shared::Shared;

/// Axes of one page, with those that it waits for.
const AXES: usize = 8;
/// A request for an axis ends after this time without an answer.
const ANSWER: Duration = Duration::from_secs(60);

/// On which terms a page wants an axis.
#[derive(Debug)]
pub(super) struct Terms {
    pub hold: Hold,
    pub stop_by: StopBy,
    /// A person has confirmed what a real machine needs.
    pub checks: bool,
    /// Whether it waits where another page has the axis.
    pub wait: bool,
}

/// A page on its way to an axis.
#[derive(Debug)]
pub(super) struct Taking {
    pub caller: Caller,
    pub running: Arc<Running>,
    pub hold: Hold,
    pub checks: bool,
    pub queue: mpsc::Receiver<Command>,
    /// Where the answer goes, and of which message it is.
    pub reply: Reply,
    pub number: u64,
    turn: Turn,
    /// It waits until then for an answer.
    until: Instant,
}

impl Taking {
    /// Takes the axis once it is free, and has it until its page gives it back or is gone.
    async fn attend(mut self, shared: Arc<Shared>) {
        let running = Arc::clone(&self.running);
        let waits = self.turn.is_empty();
        let action = if waits { "request_control" } else { "take" };
        let intent = Intent::of_drive(action, &running.drive, None);
        if waits {
            act::noted_quietly(&shared, &self.caller, &intent, "waiting".to_owned()).await;
        }
        if let Err(denied) = self.begin(&shared).await {
            let reason = denied.to_string();
            self.reply.refused(self.number, &conflict(&reason));
            act::note_refusal(&shared, Author::caller(&self.caller), intent, &reason);
            return;
        }
        // a panic was printed; the axis was dropped, and is ramped down and given back
        let at = Arc::clone(&shared);
        let held = tokio::spawn(async move { hold(&at, self).await });
        let at_rest = held.await.unwrap_or(false);
        shared.feeds.end(&running.drive);
        shared.control.give_back(&running, at_rest);
    }

    /// Waits for the axis, and shows to all pages that it is taken.
    async fn begin(&mut self, shared: &Arc<Shared>) -> Result<(), Denied> {
        let (control, running) = (&shared.control, Arc::clone(&self.running));
        self.turn(control).await?;
        control.axes().insert(running.drive.clone(), Arc::clone(&running));
        let denied = match () {
            () if running.is_ending() => Denied::Withdrawn,
            // after it is there, so that the time of the plant either goes on or is not stopped any more
            () if shared.is_paused() => Denied::StandsStill,
            () => return Ok(()),
        };
        control.give_back(&running, true);
        Err(denied)
    }

    /// Waits until the axis is that of its page.
    async fn turn(&mut self, control: &Control) -> Result<(), Denied> {
        let mut look = interval(PICTURE);
        loop {
            tokio::select! {
                biased;
                // without an answer it was withdrawn
                answer = &mut self.turn => return answer.unwrap_or(Err(Denied::Withdrawn)),
                _ = look.tick() => {}
            }
            if let Some(answer) = self.gives_up(control, Instant::now()) {
                return answer;
            }
        }
    }

    /// Ends the waiting of a page that is silent, or that has no answer. An answer that came meanwhile counts.
    fn gives_up(&mut self, control: &Control, now: Instant) -> Option<Result<(), Denied>> {
        // the ledger is held: it is not accepted meanwhile
        let ledger = control.ledger();
        let running = &self.running;
        let denied = match () {
            () if running.unbeaten() > LEASE => Denied::Withdrawn,
            () if now > self.until && !ledger.is_leaving(&running.drive) => Denied::Unanswered {
                seconds: ANSWER.as_secs(),
            },
            () => return None,
        };
        self.turn.close();
        Some(self.turn.try_recv().unwrap_or(Err(denied)))
    }
}

impl Control {
    /// Notes that an axis was given back.
    fn give_back(&self, running: &Running, at_rest: bool) {
        self.axes().remove(&running.drive);
        self.ledger().give_back(&running.drive, running.lease, at_rest);
    }
}

/// Returns whether a person has to confirm what only a person sees.
const fn needs_checks(source: &Source) -> bool {
    !source.is_simulation()
}

impl Page {
    /// Returns why an axis is not given to this page, whoever has it.
    fn take_refusal(&self, drive: &str, terms: &Terms) -> Option<Denied> {
        if let Some(denied) = self.refusal() {
            return Some(denied);
        }
        let is_positive = |number: f64| number > 0.0 && number.is_finite();
        let is_known = |drive: &str| {
            let board = &self.shared.board;
            board.look(|stations| stations.known.contains_key(drive))
        };
        let Hold { limit, travel, .. } = terms.hold;
        match () {
            () if !terms.checks && needs_checks(&self.shared.source) => Some(Denied::Unchecked),
            () if !is_positive(limit) => Some(Denied::NoLimit),
            () if !travel.is_none_or(is_positive) => Some(Denied::NoTravel),
            () if self.own.len() >= AXES => Some(Denied::TooMany { most: AXES }),
            () if !is_known(drive) => Some(Denied::Unknown),
            () => None,
        }
    }

    pub(super) fn take(&mut self, n: u64, drive: &str, terms: Terms) {
        let refused = |denied: &Denied| self.refuse(n, Some(drive), "take", None, denied);
        if let Some(denied) = self.take_refusal(drive, &terms) {
            return refused(&denied);
        }
        let holder = Holder {
            socket: self.number,
            who: self.caller.who.clone(),
            claimed_name: self.caller.claimed.name(),
        };
        let limit = terms.hold.limit;
        let until = Instant::now() + ANSWER;
        let wait = terms.wait.then_some(until);
        let taken = self
            .shared
            .control
            .ledger()
            .take(drive, holder.clone(), limit, wait);
        let (lease, turn) = match taken {
            Ok(taken) => taken,
            Err(denied) => return refused(&denied),
        };
        let (running, queue) = Running::new(drive, lease, holder, terms.hold.purpose, terms.stop_by);
        self.own.push(Arc::clone(&running));
        let taking = Taking {
            caller: self.caller.clone(),
            running,
            hold: terms.hold,
            checks: terms.checks,
            queue,
            reply: self.reply.clone(),
            number: n,
            turn,
            until,
        };
        tokio::spawn(taking.attend(Arc::clone(&self.shared)));
    }

    /// Gives an axis back, or waits for it no more.
    pub(super) fn release(&self, drive: &str) {
        if let Some(running) = self.own(drive) {
            self.shared.control.let_go(running);
        }
    }

    pub(super) fn hand_over(&self, of: &Stamped, request: u64) {
        let (drive, stamp) = (&of.drive, self.stamp(of));
        let accepted = self.shared.control.ledger().hand_over(drive, stamp, request);
        if accepted.is_ok()
            && let Some(running) = self.own(drive)
        {
            running.end();
        }
        self.answered(of, "hand_over", accepted.map(Some));
    }

    pub(super) fn keep(&self, of: &Stamped, request: u64) {
        let (drive, stamp) = (&of.drive, self.stamp(of));
        let kept = self.shared.control.ledger().keep(drive, stamp, request);
        self.answered(of, "keep", kept.map(Some));
    }

    /// Answers and notes what the ledger has done, with which value.
    pub(super) fn answered(&self, of: &Stamped, action: &'static str, done: Result<Option<String>, Denied>) {
        let value = match done {
            Ok(value) => value,
            Err(denied) => return self.refuse(of.n, Some(&of.drive), action, None, &denied),
        };
        self.reply.accepted(of.n);
        let (shared, caller) = (Arc::clone(&self.shared), self.caller.clone());
        let intent = Intent::of_drive(action, &of.drive, value);
        tokio::spawn(async move { act::noted_quietly(&shared, &caller, &intent, "done".to_owned()).await });
    }
}

#[cfg(test)]
mod tests {
    use super::super::ledger::Stamp;
    use super::*;
    use crate::access::Role;

    fn taking(control: &Control, socket: u64) -> Taking {
        let holder = Holder::of(socket);
        let until = Instant::now() + ANSWER;
        let taken = control.ledger().take("a", holder.clone(), 100.0, Some(until));
        let (lease, turn) = taken.unwrap();
        let hold = Hold::for_speed();
        let (running, queue) = Running::new("a", lease, holder, hold.purpose, StopBy::Off3);
        Taking {
            caller: Caller {
                role: Role::Control,
                session: None,
                who: socket.to_string(),
                claimed: crate::access::Claimed::default(),
                remote: false,
                address: None,
            },
            running,
            hold,
            checks: false,
            queue,
            reply: Reply(mpsc::channel(1).0),
            number: 1,
            turn,
            until,
        }
    }

    #[test]
    fn a_request_without_an_answer_ends_after_a_minute_and_an_accepted_one_does_not() {
        let control = Control::new();
        let first = taking(&control, 1).running;
        let mut second = taking(&control, 2);
        let end = second.until;
        let left = |now| serde_json::to_value(control.ledger().wanted("a", now)).unwrap()["seconds"].clone();
        assert_eq!(
            (left(end - ANSWER), left(end - PICTURE), left(end)),
            (60.into(), 1.into(), 0.into())
        );
        assert_eq!(second.gives_up(&control, end), None);
        let denied = second.gives_up(&control, end + PICTURE);
        let unanswered = Denied::Unanswered { seconds: 60 };
        assert_eq!(denied, Some(Err(unanswered)));
        assert_eq!(control.ledger().wanted("a", end), None);
        let mut third = taking(&control, 3);
        let stamp = Stamp {
            socket: 1,
            lease: first.lease,
            epoch: 0,
            number: 1,
        };
        let request = third.running.lease;
        control.ledger().hand_over("a", stamp, request).unwrap();
        assert_eq!(
            third.gives_up(&control, end + 2 * ANSWER),
            None,
            "it is on its way"
        );
        control.give_back(&first, true);
        assert_eq!(third.turn.try_recv(), Ok(Ok(())));
    }

    #[test]
    fn an_axis_of_a_machine_needs_the_checks_of_a_person() {
        assert!(needs_checks(&Source::Interface("eth0".to_owned())));
        assert!(!needs_checks(&Source::Demo));
    }
}
