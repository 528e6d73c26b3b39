//! Progress on a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use profidrive::{Part, Step};

use super::{Output, clean};

/// Shows an activity on a terminal; nothing without one.
#[expect(
    clippy::disallowed_methods,
    reason = "the only constructor; its text is cleaned"
)]
pub fn spinner(output: &Output, words: String) -> ProgressBar {
    if !output.progress() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner().with_message(clean(&words));
    bar.enable_steady_tick(Duration::from_millis(120));
    bar
}

/// Shows a number of finished steps on a terminal; nothing without one.
pub fn bar(output: &Output, length: usize, words: &'static str) -> ProgressBar {
    counter(output, length as u64, "{msg} {bar:30} {pos}/{len}").with_message(words)
}

/// Shows the octets read of a file on a terminal; nothing without one.
pub fn bytes(output: &Output, length: u64) -> ProgressBar {
    counter(output, length, "{bar:30} {percent:>3}% {bytes}/{total_bytes}")
}

/// Shows the parts of long work on one line of a terminal; nothing without one. The line goes with the value.
pub fn steps(output: &Output) -> Steps {
    Steps {
        output: output.clone(),
        shown: None,
    }
}

/// The line of [`steps`].
pub struct Steps {
    output: Output,
    shown: Option<(Part, ProgressBar)>,
}

impl Steps {
    /// Shows how far the work is.
    pub fn show(&mut self, step: &Step) {
        let other = |(part, _): &(Part, ProgressBar)| *part != step.part;
        if self.shown.as_ref().is_none_or(other) {
            self.clear();
            let words = words(step.part);
            let bar = match step.all {
                0 => spinner(&self.output, words.to_owned()),
                all => bar(&self.output, all, words),
            };
            self.shown = Some((step.part, bar));
        }
        if let Some((_, bar)) = &self.shown
            && step.all > 0
        {
            bar.set_length(step.all as u64);
            bar.set_position(step.done as u64);
        }
    }

    fn clear(&mut self) {
        if let Some((_, bar)) = self.shown.take() {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Steps {
    fn drop(&mut self) {
        self.clear();
    }
}

/// What a person reads beside the progress.
const fn words(part: Part) -> &'static str {
    match part {
        Part::Searching => "listening for stations",
        Part::Identities => "reading who they are",
        Part::Requests => "measuring loss and latency",
        Part::Timers => "measuring the timers of this computer",
        Part::Drives => "reading",
        Part::Settings => "writing settings",
        Part::Capture => "capturing",
        Part::Writing => "writing",
        _ => "working",
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "the only constructor; its text is a constant"
)]
fn counter(output: &Output, length: u64, template: &'static str) -> ProgressBar {
    if !output.progress() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(template);
    ProgressBar::new(length).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
