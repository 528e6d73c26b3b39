//! What each request must have before a handler sees it.

use std::sync::Arc;
use std::time::Instant;

use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, COOKIE, HOST, ORIGIN, UPGRADE};
use axum::http::{HeaderMap, HeaderName, Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::{Claimed, Peer, Role};
use crate::act::{self, Author, Intent};
use crate::problem::Problem;
use crate::shared::Shared;

/// Who makes a request that passed.
#[derive(Debug, Clone)]
pub(crate) struct Caller {
    pub role: Role,
    /// The identity of its session; `None` for a program that gave a token.
    pub session: Option<String>,
    /// What it is called in the log: the number of its session, or `token`.
    pub who: String,
    /// What its people call themselves, which nothing verifies.
    pub claimed: Claimed,
    /// Whether it is on another computer.
    pub remote: bool,
    /// The address that its connection came from; that of a proxy or a tunnel where one is between.
    pub address: Option<String>,
}

/// Refuses requests for other hosts, from other origins and without a session. What passes carries its [`Caller`].
pub(crate) async fn guard(State(shared): State<Arc<Shared>>, mut request: Request, next: Next) -> Response {
    match check(&shared, &request) {
        Ok(caller) => {
            if let Some(caller) = caller {
                request.extensions_mut().insert(caller);
            }
            next.run(request).await
        }
        Err(problem) => {
            note(&shared, &request, &problem);
            problem.into_response()
        }
    }
}

/// What is refused that no page of this server does.
const FOREIGN: [&str; 5] = ["host", "origin", "token", "rate", "view"];
/// The longest path and origin in the log, in characters.
const LONGEST: usize = 100;

/// Notes a refusal, with where it came from. What is in a query is not logged: it may be a token.
fn note(shared: &Arc<Shared>, request: &Request, problem: &Problem) {
    if !FOREIGN.contains(&problem.error().kind) {
        return;
    }
    let short = |text: &str| text.chars().take(LONGEST).collect::<String>();
    let origin = text(request.headers(), &ORIGIN)
        .map_or_else(String::new, |origin| format!(", from {}", short(origin)));
    let author = Author {
        who: address_of(request).unwrap_or_default(),
        claimed_name: None,
        address: address_of(request),
    };
    let intent = Intent {
        action: "request",
        value: Some(format!(
            "{} {}{origin}",
            request.method(),
            short(request.uri().path())
        )),
        ..Intent::default()
    };
    act::note_refusal(shared, author, intent, problem.message());
}

fn address_of(request: &Request) -> Option<String> {
    let Peer(peer) = request.extensions().get::<Peer>()?;
    Some(peer.ip().to_canonical().to_string())
}

fn check(shared: &Shared, request: &Request) -> Result<Option<Caller>, Problem> {
    let headers = request.headers();
    let (method, path) = (request.method(), request.uri().path());
    // a proxy would be asked like this, and this server is none
    let hosts: Vec<_> = headers.get_all(HOST).iter().collect();
    let is_host = match hosts.as_slice() {
        [host] => host.to_str().is_ok_and(|host| shared.places.is_host(host)),
        _ => false,
    };
    if request.uri().authority().is_some() || !is_host {
        return Err(Problem::new(
            StatusCode::MISDIRECTED_REQUEST,
            "host",
            "this server has another name: use the address that it printed at its start",
        ));
    }
    if !path.starts_with("/api/") {
        return Ok(None);
    }
    let remote = is_remote(shared, request);
    let address = address_of(request);
    let bearer = text(headers, &AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer "));
    if bearer.is_none() {
        from_here(shared, headers, method)?;
    }
    let login = path == "/api/v1/session" && method == Method::POST;
    if login && bearer.is_none() {
        return Ok(None);
    }
    let caller = match bearer {
        Some(token) => Caller {
            role: shared.try_token(token)?,
            session: None,
            who: "token".to_owned(),
            claimed: Claimed::default(),
            remote,
            address,
        },
        None => {
            let id = session_of(headers, &shared.cookie);
            let role = id.and_then(|id| shared.sessions().role(id, Instant::now()));
            let number = id.and_then(|id| shared.sessions().number(id));
            let claimed = id.and_then(|id| shared.sessions().claimed(id));
            Caller {
                role: role.ok_or_else(Problem::no_session)?,
                session: id.map(str::to_owned),
                who: number.unwrap_or_default().to_string(),
                claimed: claimed.unwrap_or_default(),
                remote,
                address,
            }
        }
    };
    let always = Stops::of(method, path).is_some() || path == "/api/v1/session";
    if caller.role == Role::View && !is_safe(method) && !always {
        let detail = match shared.read_only {
            true => "this server was started view-only: pages can look and stop",
            false => "this session is view-only; open the link for control to change something",
        };
        return Err(Problem::new(StatusCode::FORBIDDEN, "view", detail));
    }
    Ok(Some(caller))
}

/// What a request stops: it passes where others do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stops {
    /// All axes of this server.
    All,
    /// One drive.
    Drive,
}

impl Stops {
    /// Returns what a request with this method and path stops, if anything.
    pub fn of(method: &Method, path: &str) -> Option<Self> {
        let of_drive = |path: &str| path.starts_with("/api/v1/drives/") && path.ends_with("/stop");
        match path {
            _ if method != Method::POST => None,
            "/api/v1/stop" => Some(Self::All),
            path if of_drive(path) => Some(Self::Drive),
            _ => None,
        }
    }
}

/// Headers by which a proxy says that it passes on what another computer sent.
const PASSED_ON: [&str; 4] = ["forwarded", "via", "x-forwarded-for", "x-real-ip"];

/// Returns whether a request comes from another computer, by itself or through a proxy on this one. Many proxies replace the host of
/// a request by that of this server; the origin of a page and what they add show it then.
fn is_remote(shared: &Shared, request: &Request) -> bool {
    let headers = request.headers();
    let peer = request.extensions().get::<Peer>();
    let here = peer.is_some_and(|Peer(peer)| peer.ip().to_canonical().is_loopback());
    let elsewhere = text(headers, &HOST).is_none_or(|host| shared.places.is_public(host))
        || text(headers, &ORIGIN).is_some_and(|origin| shared.places.is_public_origin(origin));
    !here || elsewhere || PASSED_ON.iter().any(|name| headers.contains_key(*name))
}

/// Checks that a browser makes the request for a page of this server.
fn from_here(shared: &Shared, headers: &HeaderMap, method: &Method) -> Result<(), Problem> {
    let site = headers.get(HeaderName::from_static("sec-fetch-site"));
    let foreign_site = site.is_some_and(|site| site != "same-origin" && site != "none");
    let origins: Vec<_> = headers.get_all(ORIGIN).iter().collect();
    let own = |origin: &axum::http::HeaderValue| {
        origin
            .to_str()
            .is_ok_and(|origin| shared.places.is_origin(origin))
    };
    // a browser names the origin of each socket, and no rule of it keeps one page from the sockets of another
    let is_socket = headers.contains_key(UPGRADE);
    let is_own = match origins.as_slice() {
        [] => is_safe(method) && !is_socket,
        [origin] => own(origin),
        _ => false,
    };
    if foreign_site || !is_own {
        return Err(Problem::new(
            StatusCode::FORBIDDEN,
            "origin",
            "only the page of this server may do this; a program gives its token (Authorization: Bearer)",
        ));
    }
    Ok(())
}

fn is_safe(method: &Method) -> bool {
    method == Method::GET || method == Method::HEAD
}

fn text<'h>(headers: &'h HeaderMap, name: &HeaderName) -> Option<&'h str> {
    headers.get(name)?.to_str().ok()
}

/// Returns the identity in the cookie of this server.
pub(crate) fn session_of<'h>(headers: &'h HeaderMap, cookie: &str) -> Option<&'h str> {
    let all = headers
        .get_all(COOKIE)
        .iter()
        .filter_map(|value| value.to_str().ok());
    let mut pairs = all
        .flat_map(|value| value.split(';'))
        .filter_map(|pair| pair.trim().split_once('='));
    pairs.find(|(name, _)| *name == cookie).map(|(_, id)| id)
}
