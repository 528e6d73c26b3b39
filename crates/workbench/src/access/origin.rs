//! Which names this server has.

use std::net::SocketAddr;

use axum::http::uri::Authority;

/// The hosts that a request may be for, and the origins that it may come from.
///
/// A browser that was led here by a foreign name (DNS rebinding) sends that name as host and as origin, equal to each other. So
/// both are compared with this list.
#[derive(Debug, Clone)]
pub(crate) struct Places {
    hosts: Vec<String>,
}

impl Places {
    /// Returns the names of a server on this address.
    pub fn new(listen: SocketAddr) -> Self {
        let port = listen.port();
        let mut hosts = vec![
            format!("localhost:{port}"),
            format!("127.0.0.1:{port}"),
            format!("[::1]:{port}"),
            listen.to_string(),
        ];
        if port == 80 {
            hosts.extend(["localhost", "127.0.0.1", "[::1]"].map(str::to_owned));
        }
        Self { hosts }
    }

    /// Returns whether a `Host` header names this server.
    pub fn is_host(&self, host: &str) -> bool {
        // an authority with a user in it is none
        let plain = host
            .parse::<Authority>()
            .is_ok_and(|host| !host.as_str().contains('@'));
        plain && self.hosts.iter().any(|known| known.eq_ignore_ascii_case(host))
    }

    /// Returns whether an `Origin` header names a page of this server.
    pub fn is_origin(&self, origin: &str) -> bool {
        origin
            .strip_prefix("http://")
            .is_some_and(|host| self.is_host(host))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_names_of_this_server_are_hosts_and_origins() {
        let places = Places::new("127.0.0.1:8934".parse().unwrap());
        for host in ["127.0.0.1:8934", "localhost:8934", "LOCALHOST:8934", "[::1]:8934"] {
            assert!(places.is_host(host), "{host}");
            assert!(places.is_origin(&format!("http://{host}")), "{host}");
        }
        for host in [
            "evil.example",
            "evil.example:8934",
            "localhost",
            "localhost:8935",
            "localhost:8934.evil.example",
            "user@localhost:8934",
            "127.1:8934",
            "",
        ] {
            assert!(!places.is_host(host), "{host}");
        }
        for origin in [
            "null",
            "https://localhost:8934",
            "http://localhost:8934/",
            "localhost:8934",
            "",
        ] {
            assert!(!places.is_origin(origin), "{origin}");
        }
    }
}
