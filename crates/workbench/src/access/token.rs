//! The two tokens of a start.

use std::time::{Duration, Instant};

use subtle::{Choice, ConditionallySelectable, ConstantTimeEq};

use super::Role;

/// A secret of 128 bit, as 32 hexadecimal digits.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Secret([u8; 32]);

impl std::fmt::Debug for Secret {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Secret")
    }
}

impl Secret {
    /// Returns a new one from the random numbers of the system.
    pub fn random() -> std::io::Result<Self> {
        let mut octets = [0; 16];
        getrandom::fill(&mut octets).map_err(std::io::Error::other)?;
        let mut digits = [0; 32];
        let (pairs, _) = digits.as_chunks_mut::<2>();
        for (pair, octet) in pairs.iter_mut().zip(octets) {
            *pair = [octet >> 4, octet & 15].map(|nibble| b"0123456789abcdef"[usize::from(nibble)]);
        }
        Ok(Self(digits))
    }

    /// Returns it as text.
    pub fn text(&self) -> String {
        self.0.iter().map(|octet| char::from(*octet)).collect()
    }

    /// Compares it in constant time.
    pub fn is(&self, given: &str) -> Choice {
        self.0.ct_eq(given.as_bytes())
    }
}

/// The tokens of one start: the page of a control token can do all, the page of a view token looks and stops.
#[derive(Debug)]
pub(crate) struct Tokens {
    control: Secret,
    view: Secret,
}

impl Tokens {
    pub fn random() -> std::io::Result<Self> {
        Ok(Self {
            control: Secret::random()?,
            view: Secret::random()?,
        })
    }

    pub fn control(&self) -> String {
        self.control.text()
    }

    pub fn view(&self) -> String {
        self.view.text()
    }

    /// Returns what the holder of a token may do. Takes the same time for each text of the length of a token.
    pub fn role(&self, given: &str) -> Option<Role> {
        let (control, view) = (self.control.is(given), self.view.is(given));
        let found = u8::conditional_select(&u8::conditional_select(&0, &2, view), &1, control);
        match found {
            1 => Some(Role::Control),
            2 => Some(Role::View),
            _ => None,
        }
    }
}

/// The token of a browser that was started here has to be used within this time.
const ONCE: Duration = Duration::from_secs(60);

/// A token that begins one session. All users of a computer see with which arguments a browser was started, so the token in
/// them is worth nothing once that browser has used it.
#[derive(Debug, Default)]
pub(crate) struct Once(Option<(Secret, Instant)>);

impl Once {
    /// Returns a new one, in place of the one before.
    pub fn begin(&mut self, now: Instant) -> std::io::Result<String> {
        let secret = Secret::random()?;
        let text = secret.text();
        self.0 = Some((secret, now + ONCE));
        Ok(text)
    }

    /// Returns whether this is it, and ends it then.
    pub fn take(&mut self, given: &str, now: Instant) -> bool {
        let is_it = |(secret, end): &(Secret, Instant)| bool::from(secret.is(given)) && now < *end;
        self.0.take_if(|once| is_it(once)).is_some()
    }
}

/// Wrong tokens in a second that are answered as such; the rest have to wait.
const RATE: u32 = 10;

/// The bound on wrong tokens, of all clients together.
#[derive(Debug)]
pub(crate) struct Attempts {
    begin: Instant,
    wrong: u32,
}

impl Attempts {
    pub const fn new(now: Instant) -> Self {
        Self { begin: now, wrong: 0 }
    }

    /// Returns whether one more wrong token is answered as such.
    pub fn is_open(&mut self, now: Instant) -> bool {
        if now.saturating_duration_since(self.begin) >= Duration::from_secs(1) {
            *self = Self::new(now);
        }
        self.wrong < RATE
    }

    /// Notes that a token was wrong.
    pub const fn fail(&mut self) {
        self.wrong += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_of_another_start_and_parts_of_tokens_are_no_tokens() {
        let (tokens, others) = (Tokens::random().unwrap(), Tokens::random().unwrap());
        assert_eq!(tokens.role(&tokens.control()), Some(Role::Control));
        assert_eq!(tokens.role(&tokens.view()), Some(Role::View));
        let control = tokens.control();
        for given in [
            &*others.control(),
            &others.view(),
            "",
            &control[1..],
            &format!("{control}0"),
            &control.to_uppercase().replace('A', "B"),
        ] {
            assert_eq!(tokens.role(given), None, "{given}");
        }
        assert_eq!(format!("{tokens:?}"), "Tokens { control: Secret, view: Secret }");
    }

    #[test]
    fn the_token_of_a_started_browser_works_once_and_not_for_long() {
        let start = Instant::now();
        let mut once = Once::default();
        assert!(!once.take("", start), "there is none");
        let token = once.begin(start).unwrap();
        assert!(!once.take(&token[1..], start));
        assert!(once.take(&token, start + Duration::from_secs(59)));
        assert!(!once.take(&token, start + Duration::from_secs(59)), "used");
        let token = once.begin(start).unwrap();
        assert!(!once.take(&token, start + ONCE));
    }

    #[test]
    fn ten_tokens_a_second_are_tried() {
        let mut now = Instant::now();
        let mut attempts = Attempts::new(now);
        let mut tried = 0;
        for _ in 0..1000 {
            if attempts.is_open(now) {
                attempts.fail();
                tried += 1;
            }
            now += Duration::from_millis(3);
        }
        assert!((30..=40).contains(&tried), "{tried} in 3 s");
    }
}
