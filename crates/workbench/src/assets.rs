//! The built page. `web/` has its sources; the files here are committed, so that building and running a server needs no Node.

use std::sync::LazyLock;

use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, ETAG, IF_NONE_MATCH};
use axum::http::{HeaderMap, Method, StatusCode, Uri};
use axum::response::{IntoResponse, Response};

/// One file of the page.
struct Asset {
    path: &'static str,
    media: &'static str,
    content: &'static [u8],
}

const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

macro_rules! assets {
    ($($path:literal: $media:expr),+ $(,)?) => {
        &[$(Asset { path: $path, media: $media, content: include_bytes!(concat!("../assets", $path)) }),+]
    };
}

/// The page, which is the answer for each of its screens too.
const INDEX: &str = "/index.html";

static ASSETS: &[Asset] = assets! {
    "/index.html": HTML,
    "/app.js": SCRIPT,
    "/screens.js": SCRIPT,
    "/scope-worker.js": SCRIPT,
    "/uplot.js": SCRIPT,
    "/app.css": "text/css; charset=utf-8",
    "/icon.svg": "image/svg+xml",
    "/licences.txt": "text/plain; charset=utf-8",
};

/// The screens that are not of one drive.
const SCREENS: &[&str] = &["/", "/network", "/virtual", "/capture", "/log"];

/// Returns what distinguishes this build of program and page from others: a page that was loaded from another one is of another
/// build, and its person has to load it again.
pub(crate) fn build() -> &'static str {
    static BUILD: LazyLock<String> = LazyLock::new(|| {
        let of_all = ASSETS.iter().fold(0, |all: u64, asset| {
            all.rotate_left(1) ^ fingerprint(asset.content)
        });
        format!("{}+{of_all:016x}", env!("CARGO_PKG_VERSION"))
    });
    &BUILD
}

/// Answers everything that is not of the interface. A path without a file is a screen of the page.
pub(crate) async fn serve(method: Method, uri: Uri, headers: HeaderMap) -> Response {
    if method != Method::GET && method != Method::HEAD {
        return StatusCode::METHOD_NOT_ALLOWED.into_response();
    }
    let path = uri.path();
    let is_screen = SCREENS.contains(&path) || path.starts_with("/drives/");
    let wanted = if is_screen { INDEX } else { path };
    let Some(asset) = ASSETS.iter().find(|asset| asset.path == wanted) else {
        return (StatusCode::NOT_FOUND, "there is no such page\n").into_response();
    };
    // the same program serves the same files: a browser asks again after a start, and is answered by a tag
    let tag = format!("\"{:016x}\"", fingerprint(asset.content));
    let known = headers
        .get(IF_NONE_MATCH)
        .is_some_and(|known| known.as_bytes() == tag.as_bytes());
    let cache = [(CACHE_CONTROL, "no-cache".to_owned()), (ETAG, tag)];
    if known {
        return (StatusCode::NOT_MODIFIED, cache).into_response();
    }
    (cache, [(CONTENT_TYPE, asset.media)], asset.content).into_response()
}

/// Returns the FNV-1a hash of a file: it distinguishes versions, and is no proof of anything.
const fn fingerprint(content: &[u8]) -> u64 {
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    let mut at = 0;
    while at < content.len() {
        hash = (hash ^ content[at] as u64).wrapping_mul(0x0100_0000_01B3);
        at += 1;
    }
    hash
}
