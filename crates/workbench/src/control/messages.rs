//! What a page and its control socket send each other, as JSON.

use serde::{Deserialize, Serialize};

use super::running::StopBy;

/// What an axis is taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum For {
    Speed,
    Position,
}

/// Whom a command is for, and what it has seen.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Stamped {
    pub n: u64,
    pub drive: String,
    pub lease: u64,
    pub epoch: u64,
}

/// The goal whose button is held.
#[derive(Debug, Deserialize)]
pub(super) struct HeldGoal {
    pub drive: String,
    pub n: u64,
}

/// What a page sends.
#[derive(Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(super) enum Request {
    Take {
        n: u64,
        drive: String,
        purpose: For,
        /// Highest speed, rpm.
        limit: Option<f64>,
        /// How far the axis may go from where it is taken, in turns both ways; null for any way.
        #[serde(default)]
        travel: Option<f64>,
        /// Update time of the cyclic connection, ms; null for one that a computer without a real-time system keeps.
        #[serde(default)]
        cycle_ms: Option<u16>,
        /// Puts the drive into the mode that this needs, and back afterwards.
        #[serde(default)]
        set_mode: bool,
        /// Consent to an axis that nothing stops when its controller is lost.
        #[serde(default)]
        may_run_on: bool,
        /// A person has confirmed what a real machine needs: that the axis is in sight, that its way is clear, and that an emergency
        /// stop is at hand.
        #[serde(default)]
        checks: bool,
        /// How STOP stops this axis.
        #[serde(default)]
        stop_by: StopBy,
        /// Waits for an axis that another page has, until that one hands it over or keeps it.
        #[serde(default)]
        wait: bool,
    },
    /// Gives an axis back, or waits for it no more.
    Release {
        drive: String,
    },
    /// Gives an axis back for the page that waits for it with this request.
    HandOver {
        #[serde(flatten)]
        of: Stamped,
        request: u64,
    },
    /// Keeps an axis from the page that waits for it with this request.
    Keep {
        #[serde(flatten)]
        of: Stamped,
        request: u64,
    },
    /// A sign that a person has the page before them.
    Beat {
        n: u64,
        /// Time of the page, ms.
        t: f64,
        held: Option<HeldGoal>,
    },
    Enable(Stamped),
    Disable(Stamped),
    Acknowledge(Stamped),
    Confirm(Stamped),
    Halt {
        drive: String,
        lease: u64,
    },
    Jog {
        #[serde(flatten)]
        of: Stamped,
        t: f64,
        speed: f64,
        /// The round trip that 99 of 100 of its beats keep to, ms, as the page has measured it by their echoes.
        #[serde(default)]
        rtt: Option<f64>,
    },
    Velocity {
        #[serde(flatten)]
        of: Stamped,
        speed: f64,
    },
    Move {
        #[serde(flatten)]
        of: Stamped,
        turns: f64,
        #[serde(default)]
        relative: bool,
        speed: f64,
    },
    Home(Stamped),
    Task {
        #[serde(flatten)]
        of: Stamped,
        number: u16,
    },
    Stop,
    /// Lets axes be enabled again after the STOP of this epoch.
    Reset {
        n: u64,
        epoch: u64,
    },
    /// A message of a newer page.
    #[serde(other)]
    Other,
}

/// The first message to a page.
#[derive(Serialize)]
pub(super) struct Hello<'s> {
    pub r#type: &'static str,
    pub build: &'static str,
    pub boot: &'s str,
    /// What this session is called in the log.
    pub who: &'s str,
    pub epoch: u64,
    pub stopped: bool,
    /// Whether this page may take control; else why not.
    pub refusal: Option<&'static str>,
    /// After so many ms without a beat a motion ends that a button keeps going, and control.
    pub hold_ms: u128,
    pub lease_ms: u128,
}

#[derive(Serialize)]
pub(super) struct Echo {
    pub r#type: &'static str,
    pub n: u64,
    pub t: f64,
    pub fresh: bool,
}

#[derive(Serialize)]
pub(super) struct Reset {
    pub r#type: &'static str,
    pub epoch: u64,
}

impl Reset {
    pub const fn of(epoch: u64) -> Self {
        Self {
            r#type: "reset",
            epoch,
        }
    }
}

#[derive(Serialize)]
pub(super) struct Axes<T> {
    pub r#type: &'static str,
    pub axes: Vec<T>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a message has in the log: `suite/actions.rs` tries each of them. A message that is new does not compile before it is here.
    fn action(request: &Request) -> Option<&'static str> {
        match request {
            Request::Take { wait: true, .. } => Some("request_control"),
            Request::Take { .. } => Some("take"),
            Request::Release { .. } => Some("release"),
            Request::HandOver { .. } => Some("hand_over"),
            Request::Keep { .. } => Some("keep"),
            Request::Enable(_) => Some("enable"),
            Request::Disable(_) => Some("disable"),
            Request::Acknowledge(_) => Some("acknowledge"),
            Request::Confirm(_) => Some("confirm"),
            Request::Jog { .. } => Some("jog"),
            Request::Velocity { .. } => Some("velocity"),
            Request::Move { .. } => Some("move"),
            Request::Home(_) => Some("home"),
            Request::Task { .. } => Some("task"),
            Request::Stop => Some("stop"),
            Request::Reset { .. } => Some("reset"),
            // a sign of life, and the end of a motion that is in the log with its begin
            Request::Beat { .. } | Request::Halt { .. } | Request::Other => None,
        }
    }

    /// What programs read of the sockets.
    const SOCKETS: &str = include_str!("../../../../docs/src/workbench-sockets.md");

    #[test]
    fn each_message_is_described() {
        let (_, control) = SOCKETS.split_once("## Control").unwrap();
        let own = [
            "hello", "lease", "accepted", "refused", "beat", "axes", "stopped", "reset",
        ];
        let page = [
            "take",
            "release",
            "hand_over",
            "keep",
            "beat",
            "enable",
            "disable",
            "acknowledge",
            "confirm",
            "halt",
            "jog",
            "velocity",
            "move",
            "home",
            "task",
            "stop",
            "reset",
        ];
        for name in own.iter().chain(&page) {
            assert!(control.contains(&format!("`{name}`")), "{name}");
        }
    }

    #[test]
    fn a_message_is_in_the_log_or_left_out_on_purpose() {
        for (text, expected) in [
            ("{\"type\":\"stop\"}", Some("stop")),
            ("{\"type\":\"halt\",\"drive\":\"a\",\"lease\":1}", None),
            ("{\"type\":\"what is not known yet\"}", None),
        ] {
            let request: Request = serde_json::from_str(text).unwrap();
            assert_eq!(action(&request), expected, "{text}");
        }
    }
}
