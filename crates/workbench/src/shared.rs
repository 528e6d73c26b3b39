//! What the requests of a server share.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use axum::http::StatusCode;
use profidrive::plant::{Happened, PlantSource};
use profidrive::{Caller as Network, Transport};
use tokio::sync::Semaphore;

use crate::access::{Attempts, Once, Places, Role, Sessions, Tokens};
use crate::audit::{Audit, Flood};
use crate::board::Board;
use crate::captures::Captures;
use crate::control::Control;
use crate::frames::Frames;
use crate::jobs::Jobs;
use crate::live::{Feeds, Hub};
use crate::problem::Problem;
use crate::settings::Source;

/// What all requests share.
#[derive(Debug)]
pub(crate) struct Shared {
    pub tokens: Tokens,
    pub once: Mutex<Once>,
    /// Whether looking and stopping is all that is permitted.
    pub read_only: bool,
    /// Whether pages on other computers may control axes.
    pub moves_remotely: bool,
    /// Whether connections are encrypted.
    pub encrypted: bool,
    pub places: Places,
    /// Name of the cookie. Browsers send the cookies of a host to each of its ports, so each server has its own name.
    pub cookie: String,
    pub source: Source,
    /// What people call this server.
    pub name: Option<String>,
    /// Distinguishes this start from others.
    pub boot: String,
    /// What this server controls.
    pub control: Control,
    pub network: Network,
    pub board: Arc<Board>,
    pub hub: Hub,
    /// The samples of axes under control.
    pub feeds: Feeds,
    pub frames: Frames,
    pub audit: Arc<Audit>,
    /// The folder with the settings of drives; `None` where there is none.
    pub backups: Option<PathBuf>,
    pub jobs: Jobs,
    /// Held while a station gets its name or address: that no other one has it is true until it is set.
    pub naming: tokio::sync::Mutex<()>,
    pub captures: Captures,
    /// The plant of virtual drives as it was started last; `None` of real ones.
    pub plant: Mutex<Option<PlantSource>>,
    /// What was let happen to virtual drives, in the order of time.
    pub happened: Mutex<Vec<Happened>>,
    /// Room for sockets.
    pub sockets: Arc<Semaphore>,
    /// Room for sockets that control: no socket that only shows takes the place of one that stops.
    pub control_sockets: Arc<Semaphore>,
    pub sessions: Mutex<Sessions>,
    pub attempts: Mutex<Attempts>,
    /// How many refusals were logged.
    pub refusals: Mutex<Flood>,
    /// How many stops that ended nothing were logged.
    pub idle_stops: Mutex<Flood>,
}

impl Shared {
    pub fn sessions(&self) -> MutexGuard<'_, Sessions> {
        self.sessions.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn idle_stops(&self) -> MutexGuard<'_, Flood> {
        self.idle_stops.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn refusals(&self) -> MutexGuard<'_, Flood> {
        self.refusals.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the plant of virtual drives as it was started last.
    pub fn plant(&self) -> MutexGuard<'_, Option<PlantSource>> {
        self.plant.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns whether the time of the plant stands still, so that no drive answers.
    pub fn is_paused(&self) -> bool {
        matches!(self.network.transport(), Transport::Plant(plant) if plant.is_paused())
    }

    pub fn happened(&self) -> MutexGuard<'_, Vec<Happened>> {
        self.happened.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn once(&self) -> MutexGuard<'_, Once> {
        self.once.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns what the holder of a token may do who begins a session: also that of the browser that this program started.
    pub fn try_login(&self, token: &str) -> Result<Role, Problem> {
        match self.once().take(token, Instant::now()) {
            true if self.read_only => Ok(Role::View),
            true => Ok(Role::Control),
            false => self.try_token(token),
        }
    }

    /// Returns what the holder of a token may do.
    pub fn try_token(&self, token: &str) -> Result<Role, Problem> {
        // a STOP does not wait for those who try wrong ones
        if let Some(role) = self.tokens.role(token) {
            return Ok(role);
        }
        let mut attempts = self.attempts.lock().unwrap_or_else(PoisonError::into_inner);
        if !attempts.is_open(Instant::now()) {
            return Err(Problem::new(
                StatusCode::TOO_MANY_REQUESTS,
                "rate",
                "too many wrong tokens were tried: wait a second",
            ));
        }
        attempts.fail();
        Err(Problem::new(
            StatusCode::UNAUTHORIZED,
            "token",
            "this is no token of this start: open the address that the server printed last",
        ))
    }
}
