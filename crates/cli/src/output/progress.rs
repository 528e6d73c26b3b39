//! Progress on a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

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
