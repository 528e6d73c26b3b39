//! Waiting for the library in a thread of Python, which has its signals meanwhile.

use std::cell::Cell;
use std::future::{Future, poll_fn};
use std::pin::pin;
use std::task::Poll;
use std::time::{Duration, Instant as Clock};

use client::ErrorKind;
use profidrive::{Caller, StopRequests, Wait as _};
use pyo3::prelude::*;

use crate::errors::{Failure, closed, of_client};
use crate::time::seconds;

/// Time of this computer between two looks at the signals of Python.
pub const LOOK: Duration = Duration::from_millis(50);

/// What signals raised while a call waited: each is a request to stop.
pub struct Signals<'r> {
    requests: &'r [StopRequests],
    looked: Clock,
    raised: Option<PyErr>,
}

impl<'r> Signals<'r> {
    pub fn new(requests: &'r [StopRequests]) -> Self {
        Self {
            requests,
            looked: Clock::now(),
            raised: None,
        }
    }

    /// Looks at them where that is due. Python handles signals in its main thread only.
    pub fn look(&mut self) {
        if self.looked.elapsed() < LOOK {
            return;
        }
        self.looked = Clock::now();
        if let Err(raised) = Python::attach(|py| py.check_signals()) {
            self.raised.get_or_insert(raised);
            self.requests.iter().for_each(StopRequests::request);
        }
    }

    /// Fails with what the first one raised.
    pub fn raised(self) -> PyResult<()> {
        self.raised.map_or(Ok(()), Err)
    }
}

/// Gives a call up when it lasts longer. What it did not end is dropped.
pub async fn within<T>(
    caller: &Caller,
    limit: Option<Duration>,
    call: impl Future<Output = Result<T, Failure>>,
) -> Result<T, Failure> {
    let Some(limit) = limit else {
        return call.await;
    };
    let mut clock = caller.clone();
    let (mut call, mut end) = (pin!(call), pin!(clock.pass(limit)));
    poll_fn(|context| match call.as_mut().poll(context) {
        Poll::Ready(result) => Poll::Ready(result),
        Poll::Pending => end.as_mut().poll(context).map(|passed| {
            passed.map_err(|error| of_client(&error))?;
            let late = format!("no answer within {} s", seconds(limit));
            Err(Failure::new(ErrorKind::Unreachable, late).of_class("DriveTimeout"))
        }),
    })
    .await
}

thread_local! {
    /// Whether this thread waits for a call.
    static WAITS: Cell<bool> = const { Cell::new(false) };
}

/// A wait of this thread.
pub struct Waiting(());

impl Waiting {
    /// Begins one. Fails inside of another one, in the handler of a signal: what that waits for goes on only when the handler has
    /// returned, and may be what this one would wait for.
    pub fn begin() -> Result<Self, Failure> {
        if WAITS.replace(true) {
            return Err(closed(
                "a call of this thread waits already: a handler of a signal calls network.stop_all(), which does not wait, or raises \
                 an exception, which stops the axis of that call",
            ));
        }
        Ok(Self(()))
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        WAITS.set(false);
    }
}

/// Waits for a call, detached from Python. A signal requests a stop; the third one ends the wait at once.
pub fn wait<T>(requests: &[StopRequests], call: impl Future<Output = Result<T, Failure>>) -> PyResult<T> {
    let _waiting = Waiting::begin()?;
    let mut signals = Signals::new(requests);
    let result = call.wait_unless(LOOK, || {
        signals.look();
        requests.iter().any(StopRequests::is_final)
    });
    // the error of an interrupted call is that of the signal
    signals.raised()?;
    let given_up = || Failure::new(ErrorKind::Interrupted, "the call was given up");
    Ok(result.ok_or_else(given_up)??)
}
