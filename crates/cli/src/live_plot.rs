//! A recording in the terminal while it goes on. A thread draws it and reads the keys; the terminal is restored whatever happens.

use std::panic;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use client::ErrorKind;
use profidrive::recording::{RecordingStop, Row, Table};
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use ratatui::crossterm::terminal;

use crate::failure::Failure;
use crate::output::Output;
use crate::render::chart::Scroll;

/// Time between two pictures.
const PICTURE: Duration = Duration::from_millis(100);

/// Something has panicked: the terminal is restored by then, and nothing is drawn to it any more.
static PANICKED: AtomicBool = AtomicBool::new(false);

/// The terminal with the curves of a recording. Dropping it restores the terminal.
pub struct LivePlot {
    scroll: Arc<Mutex<Scroll>>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl LivePlot {
    /// Checks that there is a terminal to draw on.
    pub fn check(output: &Output) -> Result<(), Failure> {
        let draws = "--plot FILE.svg draws to a file";
        if !output.live() {
            let message =
                "--live draws on a terminal: the output is no terminal, or --json or --quiet is given";
            return Err(Failure::usage(message).hint(draws));
        }
        // stdout may be a terminal that is not that of this program: its keys cannot be read
        let keys = terminal::enable_raw_mode().and_then(|()| terminal::disable_raw_mode());
        keys.map_err(|error| {
            let message = format!("--live draws on a terminal, and this one cannot be used: {error}");
            Failure::usage(message).hint(draws)
        })
    }

    /// Takes the terminal. `stop` ends the recording with a key.
    pub fn begin(table: &Table, stop: RecordingStop) -> Result<Self, Failure> {
        let terminal = ratatui::try_init().map_err(|error| {
            Failure::new(ErrorKind::Local, format!("cannot draw on the terminal: {error}"))
        })?;
        // the hook of ratatui restores the terminal
        let restores = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            PANICKED.store(true, Ordering::Release);
            restores(info);
        }));
        let scroll = Arc::new(Mutex::new(Scroll::new(table)));
        let ended = Arc::new(AtomicBool::new(false));
        let screen = Screen {
            terminal,
            scroll: Arc::clone(&scroll),
            ended: Arc::clone(&ended),
            stop,
        };
        let thread = std::thread::spawn(move || screen.attend());
        Ok(Self {
            scroll,
            ended,
            thread: Some(thread),
        })
    }

    /// Adds a row.
    pub fn push(&self, row: &Row) {
        locked(&self.scroll).push(row);
    }

    /// Shows a message.
    pub fn note(&self, text: &str) {
        locked(&self.scroll).note(text);
    }
}

impl Drop for LivePlot {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn locked(scroll: &Mutex<Scroll>) -> MutexGuard<'_, Scroll> {
    scroll.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the thread has.
struct Screen {
    terminal: DefaultTerminal,
    scroll: Arc<Mutex<Scroll>>,
    ended: Arc<AtomicBool>,
    stop: RecordingStop,
}

impl Screen {
    /// Draws until the recording ended.
    fn attend(mut self) {
        while !self.ended.load(Ordering::Acquire) && !PANICKED.load(Ordering::Acquire) {
            let drawn = self.terminal.draw(|frame| locked(&self.scroll).draw(frame));
            if drawn.is_err() || self.read_keys().is_err() {
                // the terminal is gone, which is no wish to stop a motor
                self.stop.stop_once();
                break;
            }
        }
        ratatui::restore();
    }

    fn read_keys(&mut self) -> std::io::Result<()> {
        if !event::poll(PICTURE)? {
            return Ok(());
        }
        let Event::Key(key) = event::read()? else {
            return Ok(());
        };
        let interrupts = key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL);
        match key.code {
            _ if key.kind == KeyEventKind::Release => {}
            KeyCode::Char('q') | KeyCode::Esc => self.stop.stop(),
            _ if interrupts => self.stop.stop(),
            KeyCode::Char('+') => locked(&self.scroll).zoom(0.5),
            KeyCode::Char('-') => locked(&self.scroll).zoom(2.0),
            _ => {}
        }
        Ok(())
    }
}
