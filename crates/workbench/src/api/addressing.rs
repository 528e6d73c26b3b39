//! Signal, name and IP address of a station.

use std::net::Ipv4Addr;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::rejection::JsonRejection;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::{Extension, Json};
use profidrive::IpSuite;
use profidrive::addressing::{self, AddressingError, NewAddress, NewName};
use profidrive::client::{Drive, DriveAddress};
use profidrive::report::{BlinkReport, Error, IpReport, NameReport};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drives::unknown;
use crate::access::Caller;
use crate::act::{Intent, carry_out};
use crate::board::explained;
use crate::problem::Problem;
use crate::query::Query;
use crate::shared::Shared;

/// How long a station blinks: long enough to walk to a cabinet and look.
const BLINK: Duration = Duration::from_secs(6);

/// A name for a station.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct StationName {
    /// The name; empty to take it away.
    name: String,
    /// Whether it is kept over power-off. A temporary name deletes the permanent one.
    permanent: bool,
}

/// An IP address for a station.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct StationAddress {
    /// The address.
    ip: Ipv4Addr,
    /// Its subnet mask.
    mask: Ipv4Addr,
    /// The gateway; null for none.
    gateway: Option<Ipv4Addr>,
    /// Whether it is kept over power-off. A temporary address deletes the permanent one.
    permanent: bool,
}

/// What a station is called, or would be.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Named {
    /// Old and new name; null where a dry run is refused.
    report: Option<NameReport>,
    /// Why the name is refused; only of a dry run.
    refusal: Option<Error>,
    /// A valid name that resembles one that is not valid.
    converted: Option<String>,
}

/// Which address a station has, or would have.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Addressed {
    /// The new address; null where a dry run is refused.
    report: Option<IpReport>,
    /// Why the address is refused; only of a dry run.
    refusal: Option<Error>,
}

/// Lets a station blink for six seconds, and answers after that.
#[utoipa::path(post, path = "/api/v1/stations/{id}/blink", responses(
    (status = 200, description = "It has blinked", body = ref("#/components/schemas/BlinkReport")),
    (status = 501, description = "This server reaches drives by their addresses only"),
    (status = 503, description = "It cannot be logged"),
))]
pub(super) async fn blink(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
) -> Result<Json<BlinkReport>, Problem> {
    let (mut network, drive) = station(&shared, &id).await?;
    let intent = intent("blink", &drive, None);
    let work = async move {
        let blinked = addressing::blink(&mut network, &drive, BLINK, || ()).await;
        blinked.map_err(|error| Problem::of(&error))
    };
    carry_out(shared, &caller, intent, work).await.map(Json)
}

/// Gives a station its name, when no other station has it and no controller is connected.
#[utoipa::path(post, path = "/api/v1/stations/{id}/name", params(
    ("dry_run" = Option<bool>, Query, description = "Everything is checked, nothing is changed; what speaks against it is in the answer"),
), request_body(content = ref("#/components/schemas/StationName"), content_type = "application/json"), responses(
    (status = 200, description = "The name, or what a dry run has found", body = ref("#/components/schemas/Named")),
    (status = 400, description = "The name is not valid"),
    (status = 409, description = "A controller is connected, or another station has the name"),
    (status = 501, description = "This server reaches drives by their addresses only"),
    (status = 503, description = "It cannot be logged"),
))]
pub(super) async fn name(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    query: Query,
    wanted: Result<Json<StationName>, JsonRejection>,
) -> Result<Json<Named>, Problem> {
    let Json(StationName { name, permanent }) = wanted.map_err(|error| Problem::of_body(&error))?;
    let (mut network, drive) = station(&shared, &id).await?;
    let wanted = NewName {
        permanent,
        dry_run: query.is_true("dry_run"),
        ..NewName::new(&name)
    };
    if wanted.dry_run {
        return Ok(Json(
            match addressing::set_name(&mut network, &drive, &wanted).await {
                Ok(report) => Named::of(report),
                Err(error) => Named {
                    report: None,
                    refusal: Some(explained(&error)),
                    converted: match error {
                        AddressingError::BadName { legal, .. } => legal,
                        _ => None,
                    },
                },
            },
        ));
    }
    let change = change(&drive.station.name, &name, permanent);
    let intent = intent("name", &drive, Some(change));
    let at = Arc::clone(&shared);
    let work = async move {
        let _writer = at.jobs.drive(&drive.station.mac.to_string()).lock_owned().await;
        let _alone = at.naming.lock().await;
        let report = addressing::set_name(&mut network, &drive, &wanted).await;
        look_again(&at);
        report.map(Named::of).map_err(|error| Problem::of(&error))
    };
    carry_out(shared, &caller, intent, work).await.map(Json)
}

impl Named {
    const fn of(report: NameReport) -> Self {
        Self {
            report: Some(report),
            refusal: None,
            converted: None,
        }
    }
}

/// Gives a station its IP address, when no other station has it, its axis is at rest and no controller is connected.
#[utoipa::path(post, path = "/api/v1/stations/{id}/ip", params(
    ("dry_run" = Option<bool>, Query, description = "Everything is checked, nothing is changed; what speaks against it is in the answer"),
), request_body(content = ref("#/components/schemas/StationAddress"), content_type = "application/json"), responses(
    (status = 200, description = "The address, or what a dry run has found", body = ref("#/components/schemas/Addressed")),
    (status = 400, description = "The address is not valid"),
    (status = 409, description = "A controller is connected, the axis is not at rest, or another station has the address"),
    (status = 501, description = "This server reaches drives by their addresses only"),
    (status = 503, description = "It cannot be logged"),
))]
pub(super) async fn ip(
    State(shared): State<Arc<Shared>>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    query: Query,
    wanted: Result<Json<StationAddress>, JsonRejection>,
) -> Result<Json<Addressed>, Problem> {
    let Json(wanted) = wanted.map_err(|error| Problem::of_body(&error))?;
    let (mut network, drive) = station(&shared, &id).await?;
    let wanted = NewAddress {
        permanent: wanted.permanent,
        dry_run: query.is_true("dry_run"),
        ..NewAddress::new(IpSuite {
            address: wanted.ip,
            mask: wanted.mask,
            gateway: wanted.gateway.unwrap_or(Ipv4Addr::UNSPECIFIED),
        })
    };
    let done = |report| Addressed {
        report: Some(report),
        refusal: None,
    };
    if wanted.dry_run {
        let checked = addressing::set_ip(&mut network, &drive, &wanted).await;
        let refused = |error| Addressed {
            report: None,
            refusal: Some(explained(&error)),
        };
        return Ok(Json(checked.map_or_else(refused, done)));
    }
    let change = change(&suite(drive.station.ip), &suite(wanted.ip), wanted.permanent);
    let intent = intent("ip", &drive, Some(change));
    let at = Arc::clone(&shared);
    let work = async move {
        let _writer = at.jobs.drive(&drive.station.mac.to_string()).lock_owned().await;
        let _alone = at.naming.lock().await;
        let report = addressing::set_ip(&mut network, &drive, &wanted).await;
        look_again(&at);
        report.map(done).map_err(|error| Problem::of(&error))
    };
    carry_out(shared, &caller, intent, work).await.map(Json)
}

/// Finds a station by its MAC address, as it answers now: it may have no address, and its parameters do not matter.
async fn station(shared: &Shared, id: &str) -> Result<(profidrive::Caller, Drive), Problem> {
    let id = id.to_lowercase();
    if !shared.board.look(|stations| stations.known.contains_key(&id)) {
        return Err(unknown());
    }
    // a drive that is given by its address has no other name here
    let Ok(mac) = id.parse() else {
        let detail = "a name, an IP address and a signal travel in raw Ethernet frames, and this server reaches its drives by UDP only";
        return Err(Problem::new(StatusCode::NOT_IMPLEMENTED, "unsupported", detail));
    };
    let mut network = shared.network.clone();
    let drive = network.find(&DriveAddress::Mac(mac)).await;
    drive
        .map(|drive| (network, drive))
        .map_err(|error| Problem::of(&error))
}

fn intent(action: &'static str, drive: &Drive, value: Option<String>) -> Intent {
    Intent::of_drive(action, &drive.station.mac.to_string(), value)
}

/// `none -> axis-3, kept over power-off`
fn change(old: &str, new: &str, permanent: bool) -> String {
    let named = |text: &str| {
        if text.is_empty() {
            "none".to_owned()
        } else {
            text.to_owned()
        }
    };
    let kept = if permanent {
        "kept over power-off"
    } else {
        "until power-off"
    };
    format!("{} -> {}, {kept}", named(old), named(new))
}

/// `10.0.0.2 mask 255.255.255.0 gateway 10.0.0.1`; empty without an address.
fn suite(ip: IpSuite) -> String {
    if !ip.is_set() {
        return String::new();
    }
    let gateway = match ip.gateway.is_unspecified() {
        true => String::new(),
        false => format!(" gateway {}", ip.gateway),
    };
    format!("{} mask {}{gateway}", ip.address, ip.mask)
}

/// Searches for stations in the background, so that all pages have the change soon.
fn look_again(shared: &Arc<Shared>) {
    let shared = Arc::clone(shared);
    tokio::spawn(async move { shared.board.search_now().await });
}
