//! Why a page is denied what it requests.

use profidrive::profile::notation::figures;

use crate::problem::STANDS_STILL;

/// Why something is not permitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum Denied {
    #[error("this session is view-only: open the link for control to move an axis")]
    View,
    #[error("this server was started view-only: pages can look and stop")]
    ReadOnly,
    #[error(
        "this page is on another computer: whoever moves a machine must see it, and this server was not started to permit it from there"
    )]
    Remote,
    #[error("drives that are given by their addresses have parameters only: control needs an interface")]
    Addresses,
    #[error(
        "on a machine a person confirms first that the axis is in sight, that its way is clear and that an emergency stop is at hand"
    )]
    Unchecked,
    #[error("the highest speed has to be a number above 0 rpm")]
    NoLimit,
    #[error("the longest travel has to be a number above 0 rev")]
    NoTravel,
    #[error("this page has control of {most} axes, which is the most")]
    TooMany { most: usize },
    #[error("no such drive has answered")]
    Unknown,
    #[error("{}", STANDS_STILL)]
    StandsStill,
    #[error("this jog came too late: the button may be up by now")]
    LateJog,
    #[error("{who} has control of this drive")]
    Taken { who: String },
    #[error("{who} has already requested this drive")]
    Requested { who: String },
    #[error("{who} keeps control of this drive")]
    Kept { who: String },
    #[error(
        "no answer to the request for this drive within {seconds} s: whoever has control may be away from the computer"
    )]
    Unanswered { seconds: u64 },
    #[error(
        "the page that waited for this drive has withdrawn its request, is hidden or is no longer connected"
    )]
    Withdrawn,
    #[error("STOP was pressed while this page waited for the drive: request it again")]
    StoppedWaiting,
    #[error(
        "the axis turned when control of it was given back, or its drive could not be reached any more: look at it before you take control"
    )]
    NotAtRest,
    #[error("the server is shutting down")]
    ServerEnds,
    #[error("this page is giving the drive back")]
    Leaving,
    #[error("this page does not have control of the drive")]
    NotHeld,
    #[error("STOP was pressed meanwhile: what was requested before it is not carried out")]
    Outdated,
    #[error("STOP was pressed: it has to be reset before anything is enabled or moved")]
    Stopped,
    #[error("this command came before another one and is not carried out")]
    Replayed,
    #[error(
        "{} rpm is above {} rpm: the first motion is limited to a tenth until its direction is confirmed",
        figures(*.speed), figures(*.limit)
    )]
    Unconfirmed { speed: f64, limit: f64 },
    #[error(
        "the speed of this motion is stored in the drive: it waits until the direction of a first motion, at {} rpm at most, is confirmed",
        figures(*.limit)
    )]
    UnconfirmedStored { limit: f64 },
    #[error("the axis has not moved since this page has it: its direction is confirmed after a first motion")]
    Unmoved,
    #[error("{} rpm is above the limit of this page, {} rpm", figures(*.speed), figures(*.limit))]
    Limit { speed: f64, limit: f64 },
    #[error(
        "a jog needs the round trip of the beats of its page, which this command does not have: send it as `rtt`, in ms"
    )]
    NoRoundTrip,
    #[error(
        "the round trip to the page is {} ms, above {} ms: an axis would be jogged by what its page shows too late",
        figures(*.ms), figures(ROUND_TRIP)
    )]
    RoundTrip { ms: f64 },
}

impl Denied {
    /// Returns the stable name of what is denied to a page whatever it requests; nothing of other refusals.
    pub const fn of_page(&self) -> Option<&'static str> {
        Some(match self {
            Self::View => "view",
            Self::ReadOnly => "read_only",
            Self::Remote => "remote",
            Self::Addresses => "addresses",
            _ => return None,
        })
    }
}

/// The longest round trip of the beats of a page that jogs, in ms: that which 99 of 100 keep to.
const ROUND_TRIP: f64 = 100.0;

/// Permits a jog by the round trip that its page reports. No other side knows it: the answer to a beat ends at the page.
pub(crate) fn permit_round_trip(ms: Option<f64>) -> Result<(), Denied> {
    match ms {
        None => Err(Denied::NoRoundTrip),
        // not a number is no short one
        Some(ms) if (0.0..=ROUND_TRIP).contains(&ms) => Ok(()),
        Some(ms) => Err(Denied::RoundTrip { ms }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_that_answers_late_or_reports_no_round_trip_jogs_nothing() {
        for short in [0.0, 7.5, 100.0] {
            permit_round_trip(Some(short)).unwrap();
        }
        for long in [100.1, 1e308, f64::INFINITY, f64::NAN, -1.0] {
            let denied = permit_round_trip(Some(long)).unwrap_err();
            assert!(matches!(denied, Denied::RoundTrip { .. }), "{denied}");
            assert!(denied.to_string().len() < 120, "{denied}");
        }
        let none = permit_round_trip(None).unwrap_err();
        assert!(none.to_string().contains("rtt"), "{none}");
    }

    #[test]
    fn numbers_of_any_size_fit_into_a_sentence() {
        for (speed, text) in [
            (1e308, "1e308 rpm"),
            (12.5, "12.5 rpm"),
            (f64::INFINITY, "inf rpm"),
        ] {
            let denied = Denied::Limit { speed, limit: 300.0 }.to_string();
            assert!(denied.starts_with(text) && denied.len() < 80, "{denied}");
        }
    }
}
