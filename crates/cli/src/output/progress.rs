//! What goes on meanwhile, on a terminal that somebody watches.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::{Output, clean};

/// Something is going on; nothing where nobody watches.
#[expect(
    clippy::disallowed_methods,
    reason = "the one place that makes it; its text is cleaned"
)]
pub fn spinner(output: &Output, words: String) -> ProgressBar {
    if !output.progress() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner().with_message(clean(&words));
    bar.enable_steady_tick(Duration::from_millis(120));
    bar
}

/// So many of something are done; nothing where nobody watches.
pub fn bar(output: &Output, length: usize, words: &'static str) -> ProgressBar {
    counter(output, length as u64, "{msg} {bar:30} {pos}/{len}").with_message(words)
}

/// So many octets of a file are read; nothing where nobody watches.
pub fn bytes(output: &Output, length: u64) -> ProgressBar {
    counter(output, length, "{bar:30} {percent:>3}% {bytes}/{total_bytes}")
}

#[expect(
    clippy::disallowed_methods,
    reason = "the one place that makes it; its text is a constant"
)]
fn counter(output: &Output, length: u64, template: &'static str) -> ProgressBar {
    if !output.progress() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(template);
    ProgressBar::new(length).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
