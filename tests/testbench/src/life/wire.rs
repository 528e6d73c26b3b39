//! The wire between clients and drives, which carries the accidents too.

use std::time::Duration;

use client::{Client, Engine, Error, ErrorKind, Network, Wire};
use profinet::controller::ControllerConfig;
use profinet::{Instant, IpSuite};

use super::accident::Act;
use super::state::State;
use super::{CLIENT, SETTLED};
use crate::ip;
use crate::shared::{On, Shared};
use crate::world::Gone;

/// Drives and the wire to them; each client has a clone.
#[derive(Clone)]
pub(super) struct Life(pub(super) Shared<State>);

impl Wire for Life {
    type Error = Gone;

    fn now(&self) -> Instant {
        self.0.borrow().now()
    }

    fn step(&mut self, client: &mut Engine, until: Instant) -> Result<(), Gone> {
        loop {
            let due = self.0.borrow_mut().due();
            match due {
                Some(Act::Kill) => {
                    let mut state = self.0.borrow_mut();
                    state.killed = true;
                    state.tally.kills += 1;
                }
                Some(Act::Freeze(time)) => self.pass(time),
                Some(act) => self.0.borrow_mut().happen(act),
                None => break,
            }
        }
        let mut state = self.0.borrow_mut();
        // nothing is to be learned from what comes after
        if state.killed || state.broken.is_some() {
            return Err(Gone);
        }
        let next = state.plan.front().map_or(until, |(at, _)| until.min(*at));
        state.go(client, next, true);
        Ok(())
    }
}

impl Life {
    /// Lets time pass without a client.
    pub(super) fn pass(&self, time: Duration) {
        let until = Wire::now(self) + time;
        let idle = ControllerConfig::new(CLIENT, IpSuite::NONE, "idle", 99);
        let mut idle = Engine::new(Client::new(idle));
        let mut state = self.0.borrow_mut();
        // whoever is frozen or gone has to begin anew
        state.well = state.well.max(until + SETTLED);
        while state.now() < until && state.broken.is_none() {
            while let Some(act) = state.due() {
                state.happen(act);
            }
            let next = state.plan.front().map_or(until, |(at, _)| until.min(*at));
            state.go(&mut idle, next, false);
        }
    }

    pub(super) fn client(&self, number: u64) -> On<Self> {
        self.0.borrow_mut().killed = false;
        let seed = self.0.borrow().seed ^ number << 56;
        let mut config = ControllerConfig::new(CLIENT, ip(200), "client", seed);
        config.client_port = 0xC000 + number as u16 * 0x100;
        On::new(Network::on(self.clone(), config))
    }

    pub(super) fn below(&self, limit: usize) -> usize {
        self.0.borrow_mut().random.below(limit as u64) as usize
    }

    pub(super) fn time(&self, limit: Duration) -> Duration {
        self.0.borrow_mut().time(limit)
    }

    pub(super) fn breaks(&self, what: String) {
        self.0.borrow_mut().breaks(what);
    }

    /// Takes the end of a call to a drive. One that `must` succeed fails only while not all is well.
    pub(super) fn ended<T>(
        &self,
        call: &str,
        place: usize,
        begun: Instant,
        must: bool,
        result: Result<T, Error>,
    ) -> Option<T> {
        let mut state = self.0.borrow_mut();
        let report = match &result {
            Ok(_) => format!("drive-{}: {call}", place + 1),
            Err(error) => format!("drive-{}: {call}: {error}", place + 1),
        };
        state.note(&report);
        match result {
            Ok(value) => {
                state.tally.answered += 1;
                Some(value)
            }
            Err(error) => {
                state.tally.failed += 1;
                let well = begun > state.well && !state.killed && state.plan.is_empty();
                let defect = matches!(error, Error::Misuse(_)) || error.kind() == ErrorKind::Internal;
                if defect || must && well {
                    state.breaks(report);
                }
                None
            }
        }
    }
}
