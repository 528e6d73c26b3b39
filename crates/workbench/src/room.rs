//! Room for connections: so many at once, and none of them idle while another one waits.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::Instant;

use axum::body::{Body, Bytes, HttpBody};
use axum::extract::Request;
use axum::middleware::Next;
use axum::response::Response;
use hyper::body::{Frame, SizeHint};
use tokio::sync::Notify;

use crate::access::Caller;

/// Connections served at once.
pub(crate) const CONNECTIONS: usize = 256;

/// The connections that are served. A socket is none any more: those have bounds of their own.
#[derive(Debug, Default)]
pub(crate) struct Room {
    seats: Mutex<Vec<Arc<Seat>>>,
    /// A connection has ended, or is idle.
    free: Notify,
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
    /// Requests of a session or with a token that are not answered to their end.
    requests: u32,
    /// When it came, or when its last request was answered.
    idle: Instant,
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
    /// Gives a place to a new connection: at once, as long as any of those that have one is not within a request. The one that has been
    /// idle for longest goes then. A client that opens connections and sends nothing thus delays no other one.
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
                .filter_map(|(place, seat)| Some((place, seat.idle()?)));
            let (place, _) = idle.min_by_key(|(_, since)| *since)?;
            seats.swap_remove(place).ended.notify_one();
        }
        let seat = Arc::new(Seat {
            state: Mutex::new(Activity {
                requests: 0,
                idle: Instant::now(),
            }),
            ended: Notify::new(),
        });
        seats.push(Arc::clone(&seat));
        Some(seat)
    }
}

impl Seat {
    /// Returns since when it is idle; `None` within a request.
    fn idle(&self) -> Option<Instant> {
        let state = locked(&self.state);
        (state.requests == 0).then_some(state.idle)
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

/// A request that is not answered to its end.
struct Within(Requests);

impl Within {
    fn begin(requests: Requests) -> Self {
        locked(&requests.seat.state).requests += 1;
        Self(requests)
    }
}

impl Drop for Within {
    fn drop(&mut self) {
        let Self(Requests { room, seat }) = self;
        {
            let mut state = locked(&seat.state);
            state.requests = state.requests.saturating_sub(1);
            state.idle = Instant::now();
        }
        room.free.notify_one();
    }
}

/// Notes that a connection is within a request, until its answer was handed over to the end. This stands behind the guard: what has neither
/// a session nor a token, a login too, keeps no place from others.
pub(crate) async fn note(request: Request, next: Next) -> Response {
    let is_known = request.extensions().get::<Caller>().is_some();
    let requests = request
        .extensions()
        .get::<Requests>()
        .filter(|_| is_known)
        .cloned();
    let Some(within) = requests.map(Within::begin) else {
        return next.run(request).await;
    };
    next.run(request).await.map(|body| {
        Body::new(Answer {
            body,
            _within: within,
        })
    })
}

/// The body of an answer, which keeps its connection within the request.
struct Answer {
    body: Body,
    _within: Within,
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
