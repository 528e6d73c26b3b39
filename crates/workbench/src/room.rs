//! Room for connections and for what they request. A new connection always has a place: there are more places than requests at once,
//! and whoever is idle, waits or is slow to take its answer makes room. No request but a STOP is carried out by the threads that serve
//! the connections.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::Instant;

use axum::body::{Body, Bytes, HttpBody};
use axum::extract::Request;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use hyper::body::{Frame, SizeHint};
use tokio::runtime::Handle;
use tokio::sync::{Notify, Semaphore};
use tokio::task::JoinSet;

use crate::access::{Caller, Stops};
use crate::problem::Problem;

/// Connections served at once.
const CONNECTIONS: usize = 256;
/// Requests carried out at once, without stops; others wait for their turn.
const REQUESTS: usize = 128;
/// Stops of single drives at once, each until its axis is at rest.
const STOPS: usize = 64;

/// The connections that are served. A socket is none any more: those have bounds of their own.
#[derive(Debug)]
pub(crate) struct Room {
    seats: Mutex<Vec<Arc<Seat>>>,
    /// A connection has ended, or is idle.
    free: Notify,
    requests: Semaphore,
    stops: Semaphore,
    /// Carries out requests.
    work: Handle,
}

/// What is known of one connection.
#[derive(Debug)]
struct Seat {
    state: Mutex<Activity>,
    /// Its place is given to another one.
    ended: Notify,
}

#[derive(Debug)]
struct Activity {
    /// Requests of a session or with a token that are carried out.
    requests: u32,
    /// Answers to such requests that are being handed over. How long that takes is up to the client.
    answers: u32,
    /// When it came, or when one of these numbers last changed.
    since: Instant,
}

/// The place of one connection, until this is dropped.
#[derive(Debug)]
pub(crate) struct Place {
    room: Arc<Room>,
    seat: Arc<Seat>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Room {
    /// With the threads that carry out requests.
    pub fn new(work: Handle) -> Self {
        Self {
            seats: Mutex::default(),
            free: Notify::new(),
            requests: Semaphore::new(REQUESTS),
            stops: Semaphore::new(STOPS),
            work,
        }
    }

    /// Gives a place to a new connection. When there is none left, the one that has been idle for longest goes, or has waited for its
    /// turn; where none has, the one that has been taking its answer for longest. A client that opens connections and sends nothing, sends
    /// much or reads nothing thus delays no other one.
    pub async fn enter(self: &Arc<Self>) -> Place {
        loop {
            if let Some(seat) = self.find_seat() {
                let room = Arc::clone(self);
                return Place { room, seat };
            }
            self.free.notified().await;
        }
    }

    fn find_seat(&self) -> Option<Arc<Seat>> {
        let mut seats = locked(&self.seats);
        if seats.len() >= CONNECTIONS {
            let idle = seats
                .iter()
                .enumerate()
                .filter_map(|(place, seat)| Some((place, seat.spare()?)));
            let (place, _) = idle.min_by_key(|(_, spare)| *spare)?;
            seats.swap_remove(place).ended.notify_one();
        }
        let seat = Arc::new(Seat {
            state: Mutex::new(Activity {
                requests: 0,
                answers: 0,
                since: Instant::now(),
            }),
            ended: Notify::new(),
        });
        seats.push(Arc::clone(&seat));
        Some(seat)
    }
}

impl Seat {
    /// Returns whether an answer is handed over to it, and since when; `None` within a request.
    fn spare(&self) -> Option<(bool, Instant)> {
        let state = locked(&self.state);
        (state.requests == 0).then_some((state.answers > 0, state.since))
    }
}

impl Place {
    /// Waits until the place is given to another connection.
    pub async fn ended(&self) {
        self.seat.ended.notified().await;
    }

    /// Returns what notes the requests of this connection: the state of [`note`].
    pub fn requests(&self) -> Requests {
        Requests {
            room: Arc::clone(&self.room),
            seat: Arc::clone(&self.seat),
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        locked(&self.room.seats).retain(|seat| !Arc::ptr_eq(seat, &self.seat));
        self.room.free.notify_one();
    }
}

/// Notes the requests of one connection.
#[derive(Debug, Clone)]
pub(crate) struct Requests {
    room: Arc<Room>,
    seat: Arc<Seat>,
}

impl Requests {
    fn change(&self, change: impl FnOnce(&mut Activity)) {
        {
            let mut state = locked(&self.seat.state);
            change(&mut state);
            state.since = Instant::now();
        }
        self.room.free.notify_one();
    }
}

/// One more of what a connection has, until this is dropped: a request that is carried out, or an answer that is handed over.
struct Counted {
    requests: Requests,
    count: fn(&mut Activity) -> &mut u32,
}

impl Counted {
    fn begin(requests: Requests, count: fn(&mut Activity) -> &mut u32) -> Self {
        requests.change(|state| *count(state) += 1);
        Self { requests, count }
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.requests.change(|state| *(self.count)(state) -= 1);
    }
}

/// Carries out the request of a connection: a STOP and the begin of a socket at once, others in their turn and by other threads. Notes
/// that the connection is within a request, and until when the answer is handed over. This stands behind the guard: what has neither a
/// session nor a token, a login too, keeps no place from others.
pub(crate) async fn carry_out(request: Request, next: Next) -> Response {
    let extensions = request.extensions();
    let is_known = extensions.get::<Caller>().is_some();
    let Some(requests) = extensions.get::<Requests>().filter(|_| is_known).cloned() else {
        return next.run(request).await;
    };
    let room = Arc::clone(&requests.room);
    let stops = Stops::of(request.method(), request.uri().path());
    let turns = match stops {
        Some(Stops::All) => None,
        Some(Stops::Drive) => Some(&room.stops),
        None => Some(&room.requests),
    };
    let _turn = match turns {
        // nothing closes it
        Some(turns) => turns.acquire().await.ok(),
        None => None,
    };
    let within = Counted::begin(requests.clone(), |state| &mut state.requests);
    // by its path: whoever writes a header does not choose the threads
    let is_socket = matches!(request.uri().path(), "/api/v1/live" | "/api/v1/control");
    let answer = match stops.is_some() || is_socket {
        true => next.run(request).await,
        false => {
            // it ends with its connection
            let mut working = JoinSet::new();
            working.spawn_on(next.run(request), &room.work);
            let worked = working.join_next().await.and_then(Result::ok);
            // a panic was printed
            worked.unwrap_or_else(|| Problem::defect().into_response())
        }
    };
    let handing = Counted::begin(requests, |state| &mut state.answers);
    drop(within);
    answer.map(|body| {
        Body::new(Answer {
            body,
            _handing: handing,
        })
    })
}

/// The body of an answer, which keeps its connection from being idle.
struct Answer {
    body: Body,
    _handing: Counted,
}

impl HttpBody for Answer {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
