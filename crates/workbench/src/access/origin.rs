//! Which names this server has.

use std::net::{IpAddr, SocketAddr};

use axum::http::Uri;
use axum::http::uri::{Authority, Scheme};
use profidrive::InterfaceInfo;

/// What each computer calls itself.
const OF_EACH: [&str; 3] = ["localhost", "127.0.0.1", "[::1]"];

/// Where a connection comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Peer(pub SocketAddr);

/// The hosts that a request may be for, and the origins that it may come from.
///
/// A browser that was led here by a foreign name (DNS rebinding) sends that name as host and as origin, equal to each other. So
/// both are compared with this list.
#[derive(Debug, Clone)]
pub(crate) struct Places {
    scheme: &'static str,
    /// Addresses and names of this computer, without the port.
    names: Vec<String>,
    hosts: Vec<String>,
    public: Option<(Scheme, Authority)>,
}

impl Places {
    /// Returns the names of a server on this address. `public` is the address of a page elsewhere that leads here; what is none
    /// is returned as the error.
    pub fn new(listen: SocketAddr, encrypted: bool, public: Option<&str>) -> Result<Self, String> {
        let (scheme, usual) = if encrypted { ("https", 443) } else { ("http", 80) };
        let mut names = OF_EACH.map(str::to_owned).to_vec();
        if listen.ip().is_unspecified() {
            let own = InterfaceInfo::list().unwrap_or_default().into_iter();
            let own = own.flat_map(|info| info.addresses);
            names.extend(own.map(|ip| ip.address.to_string()));
        } else {
            names.push(host(listen.ip()));
        }
        let port = listen.port();
        let mut hosts: Vec<String> = names.iter().map(|name| format!("{name}:{port}")).collect();
        if port == usual {
            hosts.extend(names.iter().cloned());
        }
        let public = public
            .map(|text| origin(text).ok_or_else(|| text.to_owned()))
            .transpose()?;
        Ok(Self {
            scheme,
            names,
            hosts,
            public,
        })
    }

    /// Returns the names that a certificate of this server has.
    pub fn names(&self) -> Vec<String> {
        let public = self.public.iter().map(|(_, authority)| authority.host());
        let all = self.names.iter().map(String::as_str).chain(public);
        let mut names: Vec<String> = Vec::new();
        for name in all.map(|name| name.trim_matches(['[', ']'])) {
            if !names.iter().any(|known| known == name) {
                names.push(name.to_owned());
            }
        }
        names
    }

    /// Returns the address of the page for a browser, without a path.
    pub fn url(&self, listen: SocketAddr) -> String {
        match &self.public {
            Some((scheme, authority)) => format!("{scheme}://{authority}"),
            None if listen.ip().is_unspecified() => {
                // those of this computer for itself stand first
                let mut others = self.names.iter().skip(OF_EACH.len());
                let name = others.find(|name| !name.starts_with("127."));
                let name = name.map_or("localhost", String::as_str);
                format!("{}://{name}:{}", self.scheme, listen.port())
            }
            None => format!("{}://{listen}", self.scheme),
        }
    }

    /// Returns whether a `Host` header names this server.
    pub fn is_host(&self, host: &str) -> bool {
        // an authority with a user in it is none
        let plain = host
            .parse::<Authority>()
            .is_ok_and(|host| !host.as_str().contains('@'));
        let known = self.hosts.iter().any(|known| known.eq_ignore_ascii_case(host));
        plain && (known || self.is_public(host))
    }

    /// Returns whether a `Host` header is that of the address elsewhere.
    pub fn is_public(&self, host: &str) -> bool {
        let public = self.public.as_ref();
        public.is_some_and(|(_, authority)| authority.as_str().eq_ignore_ascii_case(host))
    }

    /// Returns whether an `Origin` header names a page of this server.
    pub fn is_origin(&self, text: &str) -> bool {
        let own = text.split_once("://").is_some_and(|(scheme, host)| {
            scheme == self.scheme && self.hosts.iter().any(|known| known.eq_ignore_ascii_case(host))
        });
        own || self.is_public_origin(text)
    }

    /// Returns whether an `Origin` header is that of the address elsewhere.
    pub fn is_public_origin(&self, text: &str) -> bool {
        let public = self.public.as_ref().zip(text.split_once("://"));
        public.is_some_and(|((own, _), (scheme, host))| own.as_str() == scheme && self.is_public(host))
    }
}

/// Writes an address as the host of a URL.
fn host(ip: IpAddr) -> String {
    match ip {
        IpAddr::V4(ip) => ip.to_string(),
        IpAddr::V6(ip) => format!("[{ip}]"),
    }
}

/// Reads the address of a page: `https://line3.example`, with nothing behind the host.
fn origin(text: &str) -> Option<(Scheme, Authority)> {
    let parts = text.parse::<Uri>().ok()?.into_parts();
    let path = parts.path_and_query.is_none_or(|path| path == "/");
    let (scheme, authority) = (parts.scheme?, parts.authority?);
    let web = scheme == Scheme::HTTP || scheme == Scheme::HTTPS;
    (web && path && !authority.as_str().contains('@')).then_some((scheme, authority))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_names_of_this_server_are_hosts_and_origins() {
        let places = Places::new("127.0.0.1:8934".parse().unwrap(), false, None).unwrap();
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

    #[test]
    fn an_encrypted_server_has_other_origins_and_a_public_one() {
        let listen = "192.168.0.5:443".parse().unwrap();
        let places = Places::new(listen, true, Some("https://line3.example:8443/")).unwrap();
        for host in [
            "192.168.0.5:443",
            "192.168.0.5",
            "localhost",
            "line3.example:8443",
        ] {
            assert!(places.is_host(host), "{host}");
            assert!(places.is_origin(&format!("https://{host}")), "{host}");
            assert!(!places.is_origin(&format!("http://{host}")), "{host}");
        }
        assert!(places.is_public("line3.example:8443") && !places.is_public("localhost"));
        assert!(!places.is_host("line3.example"));
        assert_eq!(places.url(listen), "https://line3.example:8443");
        assert_eq!(
            places.names(),
            ["localhost", "127.0.0.1", "::1", "192.168.0.5", "line3.example"]
        );
        for text in [
            "line3.example",
            "ftp://line3.example",
            "https://line3.example/page",
            "https://a@line3.example",
            "",
        ] {
            assert_eq!(Places::new(listen, true, Some(text)).unwrap_err(), text);
        }
    }

    #[test]
    fn a_server_on_all_addresses_has_each_of_them() {
        let listen: SocketAddr = "0.0.0.0:8934".parse().unwrap();
        let places = Places::new(listen, true, None).unwrap();
        assert!(places.is_host("127.0.0.1:8934"));
        assert!(!places.is_host("0.0.0.0:8934"));
        assert!(places.url(listen).ends_with(":8934"));
    }
}
