//! The part of an address behind `?`.

use std::convert::Infallible;
use std::str::FromStr;

use axum::extract::FromRequestParts;
use axum::http::StatusCode;
use axum::http::request::Parts;

use crate::problem::Problem;

/// The values of a query by their names, decoded.
#[derive(Debug, Default)]
pub(crate) struct Query(Vec<(String, String)>);

impl Query {
    fn of(text: &str) -> Self {
        let pairs = text.split('&').filter_map(|pair| pair.split_once('='));
        Self(
            pairs
                .map(|(name, value)| (decoded(name), decoded(value)))
                .collect(),
        )
    }

    /// Returns the value of a name; an empty one is none.
    pub fn text(&self, name: &str) -> Option<&str> {
        let found = self.0.iter().find(|(known, _)| known == name);
        found
            .map(|(_, value)| value.as_str())
            .filter(|value| !value.is_empty())
    }

    /// Returns what the value of a name means.
    ///
    /// # Errors
    /// When it means nothing.
    pub fn parsed<T: FromStr>(&self, name: &str) -> Result<Option<T>, Problem> {
        let parsed = self.text(name).map(str::parse).transpose();
        parsed.map_err(|_| {
            let detail = format!("`{name}` has no valid value");
            Problem::new(StatusCode::BAD_REQUEST, "usage", &detail)
        })
    }

    /// Returns whether a name has the value `true`.
    pub fn is_true(&self, name: &str) -> bool {
        self.text(name) == Some("true")
    }
}

impl<S: Sync> FromRequestParts<S> for Query {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Infallible> {
        Ok(Self::of(parts.uri.query().unwrap_or_default()))
    }
}

/// Decodes `%41` and `+`.
fn decoded(text: &str) -> String {
    let mut octets = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((first, behind)) = rest.split_first() {
        let digits = behind
            .get(..2)
            .and_then(|digits| std::str::from_utf8(digits).ok());
        let escaped = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        match (first, escaped) {
            (b'%', Some(octet)) => {
                octets.push(octet);
                rest = behind.get(2..).unwrap_or_default();
                continue;
            }
            (b'+', _) => octets.push(b' '),
            (other, _) => octets.push(*other),
        }
        rest = behind;
    }
    String::from_utf8_lossy(&octets).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_decoded_and_damaged_ones_are_as_they_are() {
        let query = Query::of("a=02%3A00&b=x+y&c=%4&d=%ZZ&e=&f&g=7&h=true&i=%C3%A4%FF");
        let text = |name| query.text(name);
        assert_eq!((text("a"), text("b")), (Some("02:00"), Some("x y")));
        assert_eq!((text("c"), text("d")), (Some("%4"), Some("%ZZ")));
        assert_eq!((text("e"), text("f"), text("nothing")), (None, None, None));
        assert_eq!(text("i"), Some("ä\u{FFFD}"));
        assert_eq!(query.parsed::<u32>("g").ok(), Some(Some(7)));
        assert!(query.parsed::<u32>("b").is_err());
        assert!(query.is_true("h") && !query.is_true("g"));
    }
}
