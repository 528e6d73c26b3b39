//! A question that the person at the terminal answers before something is done.

use std::io::{self, BufRead, IsTerminal};
use std::sync::mpsc;
use std::time::Duration;

use client::{Error, ErrorKind, Wait};

use crate::connect::Live;
use crate::failure::Failure;
use crate::output::Output;

/// A question, and what becomes of a no.
pub struct Question<'a> {
    /// The question itself.
    pub text: &'a str,
    /// What is not done without a yes: `not reset`.
    pub undone: &'static str,
    /// What does it without asking.
    pub unasked: &'static str,
}

/// Requests a confirmation on the terminal; without a terminal or after Ctrl-C it is denied.
pub fn confirm(session: &mut Live, question: &Question<'_>, output: &Output) -> Result<(), Failure> {
    /// How often Ctrl-C is looked at.
    const GLANCE: Duration = Duration::from_millis(50);
    let denied = || Failure::new(ErrorKind::Safety, question.undone);
    if !io::stdin().is_terminal() {
        let message = format!("{}: no terminal to confirm on", question.undone);
        return Err(Failure::new(ErrorKind::Safety, message).hint(question.unasked));
    }
    output.ask(&format!("{} [y/N]", question.text));
    // reading a line cannot be interrupted, so another thread waits for it
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mut answer = String::new();
        let read = io::stdin().lock().read_line(&mut answer);
        let _ = sender.send(read.is_ok() && is_yes(&answer));
    });
    loop {
        match receiver.try_recv() {
            Ok(true) => return Ok(()),
            Ok(false) | Err(mpsc::TryRecvError::Disconnected) => return Err(denied()),
            Err(mpsc::TryRecvError::Empty) => {}
        }
        match session.pass(GLANCE).wait() {
            Err(Error::Interrupted) => {
                output.say("");
                return Err(denied());
            }
            other => other?,
        }
    }
}

fn is_yes(answer: &str) -> bool {
    matches!(answer.trim().to_ascii_lowercase().as_str(), "y" | "yes")
}
