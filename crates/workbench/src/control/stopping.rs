//! A STOP on its way: from the moment it was pressed until the frames with it have left.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use axum::extract::ws::Utf8Bytes;
use chrono::{DateTime, Utc};
use futures::future::join_all;
use profidrive::client::StopHandle;
use schemars::JsonSchema;
use serde::Serialize;
use tokio::time::timeout;

use super::Control;
use super::messages::Reset;
use super::running::StopBy;

/// The longest time until a STOP is reported. A frame leaves once in each update time, so more is a sign that none leaves; a page
/// reports after 500 ms by itself that nothing confirms its STOP.
const CONFIRM: Duration = Duration::from_millis(400);

/// A STOP that was posted to the engine.
#[derive(Debug, Clone)]
pub(crate) struct Stopping {
    /// How often STOP was pressed.
    pub epoch: u64,
    /// Who pressed it.
    pub by: String,
    /// What that one is called by its own words, which nothing verifies.
    pub claimed_name: Option<String>,
    /// The axes that are stopped, as they are called in paths.
    pub axes: Vec<(String, Posted)>,
}

/// The stop of one axis that was posted to the engine.
#[derive(Debug, Clone)]
pub(crate) enum Posted {
    /// The axis is being taken: there is nothing that could be enabled before the STOP is reset.
    Untaken,
    /// How it stops, where it was in operation, and where its frame is looked for.
    To(Option<StopBy>, StopHandle),
}

/// What became of the stop of one axis.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct StopFrame {
    /// The drive, as it is called in paths.
    drive: String,
    /// How it stops; null where its power stage was not switched on by this server, so that there was nothing to stop.
    by: Option<StopBy>,
    /// What became of it.
    state: StopState,
    /// Time of day in ms since 1970 when the frame with it was handed to the network; null in other states than `sent`.
    sent_unix_ms: Option<u64>,
}

/// How far the stop of an axis came.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StopState {
    /// The first frame with it was handed to the network.
    Sent,
    /// The axis is being taken: no frame is sent to it yet, and it cannot be enabled before the STOP is reset.
    Taking,
    /// Its connection is lost, or it was given back meanwhile: no frame reaches it.
    Lost,
    /// No frame with it has left within 400 ms.
    Unconfirmed,
}

/// What a STOP did.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Stopped {
    r#type: &'static str,
    /// How often STOP was pressed.
    pub epoch: u64,
    /// Who pressed it.
    pub by: String,
    /// What that one is called by its own words, which nothing verifies.
    pub claimed_name: Option<String>,
    /// The axes that are stopped, as they are called in paths.
    pub drives: Vec<String>,
    /// Whether the stop of each of them is on its way to the drive.
    pub confirmed: bool,
    /// The stop of each of them.
    pub axes: Vec<StopFrame>,
}

/// What is sent to pages about STOP: the last one, and whether it was reset.
#[derive(Debug, Clone, Default)]
pub(super) struct StopNews {
    /// With how often STOP was pressed then.
    pub stopped: Option<(u64, Utf8Bytes)>,
    pub reset: Option<(u64, Utf8Bytes)>,
}

/// What of it was sent to one page.
#[derive(Debug, Default)]
pub(super) struct StopsSent {
    stopped: u64,
    reset: u64,
}

impl StopNews {
    /// Returns what is sent to a page next; a reset comes after its STOP.
    pub fn next(&self, sent_before: &mut StopsSent) -> Option<Utf8Bytes> {
        if let Some((epoch, text)) = &self.stopped
            && *epoch > sent_before.stopped
        {
            sent_before.stopped = *epoch;
            return Some(text.clone());
        }
        if let Some((epoch, text)) = &self.reset
            && *epoch > sent_before.reset
        {
            sent_before.reset = *epoch;
            return (*epoch >= sent_before.stopped).then(|| text.clone());
        }
        None
    }

    /// Returns what a new page needs no more, as its first message has the present state.
    pub fn all_sent(&self) -> StopsSent {
        let of = |news: &Option<(u64, Utf8Bytes)>| news.as_ref().map_or(0, |(epoch, _)| *epoch);
        StopsSent {
            stopped: of(&self.stopped),
            reset: of(&self.reset),
        }
    }
}

impl Stopping {
    /// Returns what is known of it before its frames were looked for.
    pub fn unconfirmed(&self) -> Stopped {
        Stopped {
            r#type: "stopped",
            epoch: self.epoch,
            by: self.by.clone(),
            claimed_name: self.claimed_name.clone(),
            drives: self.axes.iter().map(|(drive, _)| drive.clone()).collect(),
            confirmed: false,
            axes: Vec::new(),
        }
    }

    /// Waits until the frames with the stop have left, or for as long as that may take.
    pub async fn confirmed(self) -> Stopped {
        let axes = self.axes.into_iter().map(|(drive, posted)| async move {
            let (by, state, sent_unix_ms) = match posted {
                Posted::Untaken => (None, StopState::Taking, None),
                Posted::To(by, handle) => match timeout(CONFIRM, handle.sent()).await {
                    Ok(Ok(Some(at))) => (by, StopState::Sent, Some(unix_ms(handle.now() - at))),
                    Ok(Ok(None) | Err(_)) => (by, StopState::Lost, None),
                    Err(_) => (by, StopState::Unconfirmed, None),
                },
            };
            StopFrame {
                drive,
                by,
                state,
                sent_unix_ms,
            }
        });
        let axes = join_all(axes).await;
        Stopped {
            r#type: "stopped",
            epoch: self.epoch,
            by: self.by,
            claimed_name: self.claimed_name,
            drives: axes.iter().map(|axis| axis.drive.clone()).collect(),
            confirmed: axes.iter().all(StopFrame::is_confirmed),
            axes,
        }
    }
}

/// Returns the time of day of something that was so long ago. The clock of a network has another zero than that of a server, and that of
/// a plant can stand still.
fn unix_ms(ago: Duration) -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.saturating_sub(ago).as_millis()).unwrap_or_default()
}

impl StopFrame {
    /// Returns whether the stop is on its way, or nothing needs it.
    pub fn is_confirmed(&self) -> bool {
        matches!(self.state, StopState::Sent | StopState::Taking)
    }

    pub fn drive(&self) -> &str {
        &self.drive
    }

    /// Returns whether it ended an operation, or may have.
    pub const fn ends_operation(&self) -> bool {
        self.by.is_some()
    }

    /// Returns what became of it in words, with what the drive is called.
    pub fn words(&self, name: &str) -> String {
        let by = self.by.map_or("STOP", StopBy::name);
        match (self.state, self.sent_unix_ms) {
            _ if self.by.is_none() && self.state == StopState::Sent => format!("{name} was not in operation"),
            (StopState::Sent, Some(ms)) => {
                let time = DateTime::<Utc>::from(UNIX_EPOCH + Duration::from_millis(ms));
                format!("{name}: {by} sent at {} UTC", time.format("%H:%M:%S%.3f"))
            }
            (StopState::Taking, _) => format!("{name} was being taken"),
            (StopState::Lost, _) => format!("{name}: no frame with {by} reaches it, its connection is lost"),
            _ => format!("{name}: no frame with {by} has left"),
        }
    }
}

impl Control {
    /// Reports a STOP to all pages, once it is known what became of it.
    pub fn report_stopped(&self, stopped: &Stopped) {
        self.stop_news.send_if_modified(|news| {
            // one that was slow to be confirmed takes nothing back
            let is_newest = news
                .stopped
                .as_ref()
                .is_none_or(|(epoch, _)| stopped.epoch > *epoch);
            if is_newest {
                news.stopped = Some((stopped.epoch, text(stopped)));
            }
            is_newest
        });
    }

    /// Reports to all pages the STOP that a flood of them has come to.
    pub(super) fn report_newest(&self, stopped: Stopped) {
        let epoch = self.stops();
        self.report_stopped(&Stopped { epoch, ..stopped });
    }

    /// Reports to all pages that the STOP of this epoch was reset.
    pub(super) fn report_reset(&self, epoch: u64) {
        self.stop_news
            .send_modify(|news| news.reset = Some((epoch, text(&Reset::of(epoch)))));
    }
}

fn text(message: &impl Serialize) -> Utf8Bytes {
    serde_json::to_string(message).unwrap_or_default().into()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use profidrive::motion::{self, Hold, Observer};
    use profidrive::profile::notation::figures;
    use profidrive::{Transport, client};

    use super::*;
    use crate::settings::Source;

    fn stopped(epoch: u64) -> Stopped {
        Stopped {
            r#type: "stopped",
            epoch,
            by: "1".to_owned(),
            claimed_name: None,
            drives: Vec::new(),
            confirmed: true,
            axes: Vec::new(),
        }
    }

    fn kinds(news: &StopNews, sent_before: &mut StopsSent) -> Vec<String> {
        let mut all = Vec::new();
        while let Some(text) = news.next(sent_before) {
            let message: serde_json::Value = serde_json::from_str(&text).unwrap();
            let epoch = message["epoch"].as_f64().unwrap();
            all.push(format!(
                "{} {}",
                message["type"].as_str().unwrap(),
                figures(epoch)
            ));
        }
        all
    }

    #[test]
    fn the_log_has_the_reaction_of_each_axis_and_when_its_frame_left() {
        let words = |by, state, sent_unix_ms| {
            let frame = StopFrame {
                drive: "1".to_owned(),
                by,
                state,
                sent_unix_ms,
            };
            frame.words("axis-1")
        };
        let off1 = Some(StopBy::Off1);
        let at = Some(1_700_000_000_123);
        for (text, expected) in [
            (
                words(off1, StopState::Sent, at),
                "axis-1: OFF1 sent at 22:13:20.123 UTC",
            ),
            (words(None, StopState::Sent, at), "axis-1 was not in operation"),
            (words(None, StopState::Taking, None), "axis-1 was being taken"),
            (
                words(off1, StopState::Unconfirmed, None),
                "axis-1: no frame with OFF1 has left",
            ),
            (
                words(off1, StopState::Lost, None),
                "axis-1: no frame with OFF1 reaches it, its connection is lost",
            ),
        ] {
            assert_eq!(text, expected);
        }
    }

    #[test]
    fn the_newest_stop_is_sent_to_a_page_and_a_reset_only_behind_its_stop() {
        let control = Control::new();
        let now = || control.stop_news.borrow().clone();
        let mut sent_before = now().all_sent();
        for _ in 0..3 {
            control.ledger().stop();
        }
        control.report_stopped(&stopped(2));
        // its frame was late: the newer one is what counts
        control.report_stopped(&stopped(1));
        assert_eq!(kinds(&now(), &mut sent_before), ["stopped 2"]);
        control.report_newest(stopped(2));
        control.report_reset(3);
        assert_eq!(kinds(&now(), &mut sent_before), ["stopped 3", "reset 3"]);
        assert_eq!(kinds(&now(), &mut sent_before), [""; 0]);
        // a reset that was overtaken by a STOP is not sent
        control.report_reset(3);
        control.ledger().stop();
        control.report_stopped(&stopped(4));
        let mut late = StopsSent::default();
        assert_eq!(kinds(&now(), &mut late), ["stopped 4"]);
        assert_eq!(kinds(&now(), &mut now().all_sent()), [""; 0]);
    }

    /// The time of a plant that stands still is that of a thread that hangs: nothing leaves.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn a_stop_whose_frame_does_not_leave_is_not_confirmed() {
        let network = Source::Demo.opening().unwrap().open().unwrap();
        let mut caller: profidrive::Caller = network.clone();
        let address: client::DriveAddress = "axis-1".parse().unwrap();
        let mut drive = caller.find(&address).await.unwrap();
        let observer = Observer::default();
        let hold = Hold::for_speed();
        let mut axis = motion::hold(&mut caller, &mut drive, &hold, &observer)
            .await
            .unwrap();
        axis.enable().await.unwrap();
        let posted = |handle: &StopHandle| Stopping {
            epoch: 1,
            by: "1".to_owned(),
            claimed_name: None,
            axes: vec![
                (
                    "axis-1".to_owned(),
                    Posted::To(Some(StopBy::Off3), handle.clone()),
                ),
                ("axis-2".to_owned(), Posted::Untaken),
            ],
        };
        let Transport::Plant(plant) = network.transport() else {
            panic!("it is a plant");
        };
        let handle = axis.stop_handle();
        plant.pause(true);
        // a step that was under way ends
        while {
            let before = network.now();
            tokio::time::sleep(Duration::from_millis(10)).await;
            network.now() != before
        } {}
        handle.quick_stop();
        let late = posted(&handle).confirmed().await;
        assert!(!late.confirmed, "{late:?}");
        assert_eq!(
            (late.axes[0].state, late.axes[0].sent_unix_ms),
            (StopState::Unconfirmed, None)
        );
        plant.pause(false);
        let sent = posted(&handle).confirmed().await;
        assert!(sent.confirmed, "{sent:?}");
        assert_eq!(
            (sent.axes[0].state, sent.axes[1].state),
            (StopState::Sent, StopState::Taking)
        );
        assert_eq!(sent.axes[0].by, Some(StopBy::Off3));
        let ago = unix_ms(Duration::ZERO) - sent.axes[0].sent_unix_ms.unwrap();
        assert!(ago < 5000, "{ago} ms");
        // that a stop has ended its operation is what this reports
        let _ = axis.release().await;
        handle.quick_stop();
        let gone = posted(&handle).confirmed().await;
        assert_eq!(gone.axes[0].state, StopState::Lost);
    }
}
