//! A drive as it was at one moment.

use std::sync::Arc;

use profile::catalogue::Parameter;
use profile::state::{State, Stw1, Zsw1};

use crate::digest::Digest;
use crate::expect::{Observed, Quantity};

/// What a trace keeps of a drive at one moment: everything that an expectation can look at, but parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    state: State,
    stw1: Stw1,
    zsw1: Zsw1,
    positioning: bool,
    moving: bool,
    connected: Option<bool>,
    messages: Arc<Messages>,
    /// In the order of [`Quantity::ALL`].
    quantities: [f64; Quantity::ALL.len()],
}

/// Faults and warnings that are present; snapshots share them while they are the same.
#[derive(Debug, Default, PartialEq)]
struct Messages {
    faults: Vec<u16>,
    warnings: Vec<u16>,
}

impl Snapshot {
    /// Returns what a drive is like now; `before` is an earlier snapshot of it.
    pub(crate) fn of(seen: &dyn Observed, before: Option<&Self>) -> Self {
        let messages = Messages {
            faults: seen.messages(false),
            warnings: seen.messages(true),
        };
        let same = before.filter(|before| *before.messages == messages);
        Self {
            state: seen.state(),
            stw1: seen.stw1(),
            zsw1: seen.zsw1(),
            positioning: seen.is_positioning(),
            moving: seen.is_moving(),
            connected: seen.connected(),
            messages: same.map_or_else(|| Arc::new(messages), |before| Arc::clone(&before.messages)),
            quantities: Quantity::ALL.map(|(quantity, _)| seen.quantity(quantity)),
        }
    }

    /// Octets that it takes, messages that it does not share with `before` included.
    pub(crate) fn size(&self, before: Option<&Self>) -> usize {
        let shared = before.is_some_and(|before| Arc::ptr_eq(&before.messages, &self.messages));
        let Messages { faults, warnings } = &*self.messages;
        let own = if shared {
            0
        } else {
            size_of::<Messages>() + size_of_val(&faults[..]) + size_of_val(&warnings[..])
        };
        size_of::<Self>() + own
    }

    /// Takes all that is in it into the digest of a run.
    pub(crate) fn digest(&self, digest: &mut Digest) {
        digest.octets(&[
            self.state.number(),
            u8::from(self.positioning),
            u8::from(self.moving),
            self.connected.map_or(2, u8::from),
        ]);
        digest.number(u64::from(self.stw1.0) << 16 | u64::from(self.zsw1.0));
        for list in [&self.messages.faults, &self.messages.warnings] {
            digest.number(list.len() as u64);
            list.iter().for_each(|number| digest.number((*number).into()));
        }
        for value in self.quantities {
            digest.number(value.to_bits());
        }
    }
}

impl Observed for Snapshot {
    fn state(&self) -> State {
        self.state
    }

    fn stw1(&self) -> Stw1 {
        self.stw1
    }

    fn zsw1(&self) -> Zsw1 {
        self.zsw1
    }

    fn is_positioning(&self) -> bool {
        self.positioning
    }

    fn is_moving(&self) -> bool {
        self.moving
    }

    fn connected(&self) -> Option<bool> {
        self.connected
    }

    fn messages(&self, warnings: bool) -> Vec<u16> {
        let Messages { faults, warnings: of } = &*self.messages;
        if warnings { of.clone() } else { faults.clone() }
    }

    fn quantity(&self, quantity: Quantity) -> f64 {
        let place = Quantity::ALL.iter().position(|(other, _)| *other == quantity);
        place
            .and_then(|place| self.quantities.get(place))
            .copied()
            .unwrap_or(f64::NAN)
    }

    /// A snapshot has no parameters.
    fn parameter(&self, _: &'static Parameter, _: u16) -> Option<f64> {
        None
    }
}
