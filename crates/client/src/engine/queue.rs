//! Whose turn it is with the parameters and records of a drive: one request at a time, in the order they came.

use std::collections::VecDeque;
use std::future::poll_fn;
use std::net::Ipv4Addr;
use std::pin::Pin;
use std::task::{Context, Poll, Waker};

use profinet::{Instant, MacAddress};
use uss::SlaveId;

use super::{Engine, Interest, NextTurn, wait};
use crate::{Drive, Error};

/// Most requests that wait for one drive.
const MOST_WAITING: usize = 8192;

/// Where a drive is.
pub(crate) type At = (MacAddress, Ipv4Addr, Option<SlaveId>);

/// Where this drive is.
pub(crate) const fn at(drive: &Drive) -> At {
    (drive.station.mac, drive.station.ip.address, drive.slave)
}

/// Callers that use the drives.
#[derive(Debug, Default)]
pub(crate) struct Queues {
    tickets: u64,
    queues: Vec<(At, VecDeque<Place>)>,
}

/// A caller in a queue; the one at its head has the turn.
#[derive(Debug)]
struct Place {
    ticket: u64,
    urgent: bool,
    waker: Option<Waker>,
}

impl Queues {
    fn queue(&mut self, at: At) -> &mut VecDeque<Place> {
        let known = self.queues.iter().position(|(place, _)| *place == at);
        let index = known.unwrap_or_else(|| {
            self.queues.push((at, VecDeque::new()));
            self.queues.len() - 1
        });
        &mut self.queues[index].1
    }

    /// Adds a caller to the queue of a drive: behind all others, or, if urgent, behind the one that has the turn and
    /// other urgent ones.
    fn join(&mut self, at: At, urgent: bool) -> Option<u64> {
        let ticket = self.tickets;
        self.tickets += 1;
        let queue = self.queue(at);
        if queue.len() >= MOST_WAITING {
            return None;
        }
        let ordinary = queue.iter().skip(1).position(|place| !place.urgent);
        let index = match ordinary.filter(|_| urgent) {
            Some(behind) => behind + 1,
            None => queue.len(),
        };
        queue.insert(
            index,
            Place {
                ticket,
                urgent,
                waker: None,
            },
        );
        Some(ticket)
    }

    /// Removes a request from its queue. Returns the waker of the request whose turn it is now.
    fn leave(&mut self, at: At, ticket: u64) -> Option<Waker> {
        let known = self.queues.iter().position(|(place, _)| *place == at)?;
        let queue = &mut self.queues[known].1;
        let index = queue.iter().position(|place| place.ticket == ticket)?;
        queue.remove(index);
        if queue.is_empty() {
            // a program that runs for weeks meets many addresses
            self.queues.swap_remove(known);
            return None;
        }
        let next = queue.front_mut().filter(|_| index == 0)?;
        next.waker.take()
    }
}

/// The turn of one request; the next one has it when this goes.
#[derive(Debug)]
pub(crate) struct Turn {
    engine: Engine,
    at: At,
    ticket: u64,
}

impl Drop for Turn {
    fn drop(&mut self) {
        let next = self.engine.records().queues.leave(self.at, self.ticket);
        if let Some(next) = next {
            next.wake();
        }
    }
}

impl Turn {
    fn is_mine(&self, context: &Context<'_>) -> bool {
        let mut records = self.engine.records();
        let queue = records.queues.queue(self.at);
        let mine = queue.front().is_none_or(|place| place.ticket == self.ticket);
        if !mine && let Some(place) = queue.iter_mut().find(|place| place.ticket == self.ticket) {
            place.waker = Some(context.waker().clone());
        }
        mine
    }
}

impl Engine {
    /// Waits for the turn at a drive. An urgent request overtakes those that wait; `due` is when this one is given up.
    ///
    /// # Errors
    /// [`Error::Busy`] when too many wait, [`Error::Timeout`] when it is not the turn of this one by then.
    pub(crate) async fn turn_at(
        &self,
        drive: &Drive,
        urgent: bool,
        due: Option<Instant>,
    ) -> Result<Turn, Error> {
        let at = at(drive);
        let ticket = self.records().queues.join(at, urgent);
        let turn = Turn {
            engine: self.clone(),
            at,
            ticket: ticket.ok_or_else(|| Error::Busy { drive: drive.label() })?,
        };
        let mut until: Option<NextTurn> = None;
        let mine = poll_fn(|context| {
            if turn.is_mine(context) {
                return Poll::Ready(true);
            }
            while let Some(due) = due {
                let next = until.get_or_insert_with(|| self.next_turn(due, Interest::Events));
                match Pin::new(next).poll(context) {
                    Poll::Pending => break,
                    Poll::Ready(Ok(())) if self.now() < due => until = None,
                    Poll::Ready(_) => return Poll::Ready(false),
                }
            }
            wait::driven_by(self.shared.driver.get(), context.waker());
            Poll::Pending
        });
        let begin = self.now();
        if mine.await {
            Ok(turn)
        } else {
            Err(Error::Timeout {
                drive: drive.label(),
                what: "its turn among other requests",
                limit: self.now() - begin,
            })
        }
    }
}
