//! Sessions of browsers.

use std::time::{Duration, Instant};

use super::Role;
use super::claimed::Claimed;
use super::token::Secret;

/// The longest time of a session.
pub(crate) const LIFETIME: Duration = Duration::from_secs(12 * 3600);
/// A session ends after this time without a request.
pub(crate) const IDLE: Duration = Duration::from_secs(30 * 60);
/// Sessions at once.
pub(crate) const SESSIONS: usize = 16;
/// Of them those that only look at most: whoever may not control does not keep others from it.
const VIEWS: usize = 12;

/// One session.
#[derive(Debug)]
struct Session {
    id: Secret,
    /// What it is called in the log.
    number: u64,
    claimed: Claimed,
    role: Role,
    begin: Instant,
    used: Instant,
}

impl Session {
    fn is_over(&self, now: Instant) -> bool {
        now.saturating_duration_since(self.begin) >= LIFETIME
            || now.saturating_duration_since(self.used) >= IDLE
    }
}

/// The sessions of a server, [`SESSIONS`] at most.
#[derive(Debug, Default)]
pub(crate) struct Sessions(Vec<Session>, u64);

impl Sessions {
    /// Begins a session and returns its identity; `None` while there are too many. A browser has one session: that with the
    /// identity `before` ends.
    pub fn begin(
        &mut self,
        role: Role,
        before: Option<&str>,
        now: Instant,
    ) -> std::io::Result<Option<String>> {
        if let Some(before) = before {
            self.end(before);
        }
        self.0.retain(|session| !session.is_over(now));
        let views = self.0.iter().filter(|session| session.role == Role::View);
        if self.0.len() >= SESSIONS || (role == Role::View && views.count() >= VIEWS) {
            return Ok(None);
        }
        let id = Secret::random()?;
        let text = id.text();
        self.1 += 1;
        self.0.push(Session {
            id,
            number: self.1,
            claimed: Claimed::default(),
            role,
            begin: now,
            used: now,
        });
        Ok(Some(text))
    }

    /// Returns what the session with this identity may do, and notes that it is used.
    pub fn role(&mut self, id: &str, now: Instant) -> Option<Role> {
        let found = self.0.iter_mut().find(|session| session.id.is(id).into())?;
        if found.is_over(now) {
            return None;
        }
        found.used = now;
        Some(found.role)
    }

    /// Returns whether a session lasts, and notes that it is used where its page is looked at.
    pub fn lasts(&mut self, id: &str, used: bool, now: Instant) -> bool {
        if used {
            return self.role(id, now).is_some();
        }
        let mut sessions = self.0.iter();
        sessions.any(|session| session.id.is(id).into() && !session.is_over(now))
    }

    /// Returns what a session is called in the log.
    pub fn number(&self, id: &str) -> Option<u64> {
        let mut sessions = self.0.iter();
        sessions
            .find(|session| session.id.is(id).into())
            .map(|session| session.number)
    }

    /// Returns what the people of a session call themselves.
    pub fn claimed(&self, id: &str) -> Option<Claimed> {
        let mut sessions = self.0.iter();
        sessions
            .find(|session| session.id.is(id).into())
            .map(|session| session.claimed.clone())
    }

    /// Ends a session.
    pub fn end(&mut self, id: &str) {
        self.0.retain(|session| !bool::from(session.id.is(id)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_ends_by_its_owner_by_silence_and_by_age() {
        let start = Instant::now();
        let minutes = |count: u64| start + Duration::from_secs(60 * count);
        let mut sessions = Sessions::default();
        let id = sessions.begin(Role::View, None, start).unwrap().unwrap();
        assert_eq!(sessions.role(&id, minutes(29)), Some(Role::View));
        assert_eq!(sessions.role(&id, minutes(58)), Some(Role::View));
        assert_eq!(sessions.role(&id, minutes(88)), None, "30 min without a request");
        let id = sessions.begin(Role::Control, None, start).unwrap().unwrap();
        assert!(sessions.lasts(&id, false, minutes(29)), "as a hidden page");
        assert!(!sessions.lasts(&id, false, minutes(30)));
        assert!(!sessions.lasts(&id, true, minutes(30)), "too late");
        let id = sessions.begin(Role::Control, None, start).unwrap().unwrap();
        for minute in (0..719).step_by(20) {
            assert_eq!(sessions.role(&id, minutes(minute)), Some(Role::Control));
        }
        assert_eq!(sessions.role(&id, minutes(720)), None, "12 h");
        let id = sessions.begin(Role::Control, None, start).unwrap().unwrap();
        sessions.end(&id);
        assert_eq!(sessions.role(&id, start), None);
    }

    #[test]
    fn sessions_are_bounded_and_make_room_when_they_end() {
        let now = Instant::now();
        let mut sessions = Sessions::default();
        let begin = |sessions: &mut Sessions, before: Option<&str>, now| {
            sessions.begin(Role::View, before, now).unwrap()
        };
        let first = begin(&mut sessions, None, now).unwrap();
        for _ in 1..VIEWS {
            assert!(begin(&mut sessions, None, now).is_some());
        }
        assert_eq!(begin(&mut sessions, None, now), None, "more would only look");
        for _ in VIEWS..SESSIONS {
            assert!(sessions.begin(Role::Control, None, now).unwrap().is_some());
        }
        assert_eq!(sessions.begin(Role::Control, None, now).unwrap(), None);
        assert_eq!(begin(&mut sessions, None, now), None);
        let again = begin(&mut sessions, Some(&first), now).unwrap();
        assert_eq!(sessions.role(&first, now), None, "replaced");
        assert_eq!(sessions.role(&again, now), Some(Role::View));
        assert!(begin(&mut sessions, None, now + IDLE).is_some());
    }
}
