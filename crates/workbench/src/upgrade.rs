//! How a socket is opened.

use std::sync::Arc;

use axum::extract::WebSocketUpgrade;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::http::StatusCode;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::access::Role;
use crate::problem::Problem;

/// Sockets of pages at once, of each kind.
pub(crate) const SOCKETS: usize = 64;
/// Of them those that only pages with control have: whoever may not control does not keep others from it.
const KEPT: u32 = 16;

/// Agrees on a protocol, with messages of at most `longest` octets, and takes a place among the sockets of this caller.
///
/// # Errors
/// No WebSocket, another protocol, or no place.
pub(crate) fn agree(
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
    protocol: &'static str,
    longest: usize,
    places: &Arc<Semaphore>,
    role: Role,
) -> Result<(WebSocketUpgrade, OwnedSemaphorePermit), Problem> {
    let other = |detail: &str| Problem::new(StatusCode::UPGRADE_REQUIRED, "protocol", detail);
    let upgrade = upgrade.map_err(|error| other(&error.to_string()))?;
    let upgrade = upgrade
        .max_message_size(longest)
        .max_frame_size(longest)
        .protocols([protocol]);
    if upgrade.selected_protocol().is_none() {
        let detail = format!("this server has the protocol {protocol}: load the page again");
        return Err(other(&detail));
    }
    let kept = match role {
        Role::Control => 0,
        Role::View => KEPT,
    };
    let place = Arc::clone(places).try_acquire_many_owned(kept + 1).ok();
    let place = place.and_then(|mut all| all.split(1)).ok_or_else(|| {
        let detail = "too many pages are open: close one of them";
        Problem::new(StatusCode::TOO_MANY_REQUESTS, "sockets", detail)
    })?;
    Ok((upgrade, place))
}
