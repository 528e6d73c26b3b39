//! Keeps what drives want kept and says what happened, beside the thread that carries their frames: neither a slow disk nor
//! a terminal that takes no more text may hold up a cycle.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::Duration;

use network::linux::Bell;
use profile::parameter::SaveId;
use profinet::Instant;
use virtual_drive::station::{Station, StationEvent};

use super::Keeping;
use super::saving::{Job, Network, Parameters, Queue};
use crate::failure::Failure;
use crate::fields;
use crate::output::Output;

/// Lines that may wait for a terminal; what comes on top is counted and left out.
const WAITING: usize = 4096;
/// How long the end waits for a terminal that takes nothing.
const PATIENCE: Duration = Duration::from_secs(1);
/// How long the end waits for the disk.
const SAVING: Duration = Duration::from_secs(5);

/// A line to print.
struct Line {
    drive: Arc<Keeping>,
    at: Duration,
    text: String,
    warning: bool,
}

/// The way to the terminal.
#[derive(Clone)]
struct Voice {
    lines: SyncSender<Line>,
    left_out: Arc<AtomicU64>,
}

impl Voice {
    fn say(&self, line: Line) {
        if self.lines.try_send(line).is_err() {
            self.left_out.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// What became of a save, which answers of the drive wait for.
pub struct SaveReport {
    pub drive: Arc<Keeping>,
    pub what: Kept,
    pub save: SaveId,
    pub stored: bool,
}

impl SaveReport {
    /// Gives it to its station.
    pub fn deliver(&self, station: &mut Station, now: Instant) {
        match self.what {
            Kept::Network => station.report_network(now, self.save, self.stored),
            Kept::Parameters => station.report_save(now, self.save, self.stored),
        }
    }
}

/// What a save is of; each has numbers of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    Network,
    Parameters,
}

/// The way of reports to the thread that carries the frames.
struct Reports {
    sender: Sender<SaveReport>,
    bell: Bell,
}

impl Reports {
    fn send(&self, report: SaveReport) {
        // nobody waits for it when the program ends
        let _ = self.sender.send(report);
        self.bell.ring();
    }
}

/// One thread that saves, in order, and one that prints.
pub struct Scribe {
    keep: Arc<Queue>,
    reports: Receiver<SaveReport>,
    voice: Voice,
    talker: JoinHandle<()>,
    output: Output,
}

impl Scribe {
    /// Starts both; `bell` rings for every report.
    pub fn new(output: Output, bell: Bell) -> Self {
        let keep = Arc::new(Queue::default());
        let (lines, spoken) = sync_channel(WAITING);
        let left_out = Arc::new(AtomicU64::new(0));
        let voice = Voice {
            lines,
            left_out: Arc::clone(&left_out),
        };
        let (kept, keeper_voice) = (Arc::clone(&keep), voice.clone());
        let (sender, reports) = channel();
        let to_drives = Reports { sender, bell };
        spawn(move || keep_all(&kept, &keeper_voice, &to_drives));
        let talked = output.clone();
        let talker = spawn(move || talk(&spoken, &left_out, &talked));
        Self {
            keep,
            reports,
            voice,
            talker,
            output,
        }
    }

    /// Says `text` of a drive.
    pub fn say(&self, drive: &Arc<Keeping>, at: Duration, text: String) {
        self.voice.say(Line {
            drive: Arc::clone(drive),
            at,
            text,
            warning: false,
        });
    }

    /// Keeps what the event wants kept, or says what it says.
    pub fn happened(&self, drive: &Arc<Keeping>, at: Duration, event: StationEvent) {
        match event {
            StationEvent::PersistNetwork { network, save } => {
                self.keep.network(drive, at, Network { network, save });
            }
            StationEvent::PersistParameters { text, asked, save } => {
                self.keep.parameters(drive, at, Parameters { text, asked, save });
            }
            said => {
                let warning = matches!(said, StationEvent::ParametersIgnored(_));
                if let Some(text) = said.words(drive.model.catalogue) {
                    self.voice.say(Line {
                        drive: Arc::clone(drive),
                        at,
                        text,
                        warning,
                    });
                }
            }
        }
    }

    /// The next report of a save. Only drives with a state folder wait for theirs.
    pub fn report(&self) -> Option<SaveReport> {
        self.reports.try_recv().ok()
    }

    /// Waits until everything is saved and printed, but not for ever: a disk or a terminal may take nothing.
    pub fn finish(self) {
        let open = self.keep.close(SAVING);
        if !open.is_empty() {
            self.output.warn(&format!(
                "the disk did not take the last changes of {} within {} s: they are lost",
                open.join(", "),
                SAVING.as_secs()
            ));
        }
        drop(self.voice);
        let mut left = PATIENCE;
        while !self.talker.is_finished() && !left.is_zero() {
            let nap = Duration::from_millis(5).min(left);
            sleep(nap);
            left -= nap;
        }
    }
}

fn keep_all(jobs: &Queue, voice: &Voice, reports: &Reports) {
    while let Some(job) = jobs.next() {
        let Job {
            drive,
            at,
            network,
            parameters,
        } = job;
        if let Some(Network { network, save }) = network {
            let result = drive.state.write_network(&network);
            reports.send(SaveReport {
                drive: Arc::clone(&drive),
                what: Kept::Network,
                save,
                stored: result.is_ok(),
            });
            let name = if network.name.is_empty() {
                "no name"
            } else {
                &network.name
            };
            let ip = if network.ip.is_set() {
                network.ip.address.to_string()
            } else {
                "no address".into()
            };
            voice.say(told(
                &drive,
                at,
                result,
                &format!("name and address: {name}, {ip}"),
            ));
        }
        if let Some(parameters) = parameters {
            let result = drive.state.write_parameters(&parameters.text);
            reports.send(SaveReport {
                drive: Arc::clone(&drive),
                what: Kept::Parameters,
                save: parameters.save,
                stored: result.is_ok(),
            });
            if result.is_err() || parameters.asked {
                voice.say(told(&drive, at, result, "parameters saved"));
            }
        }
    }
}

/// What could not be kept is not called kept, and what is not asked to be kept is not either.
fn told(drive: &Arc<Keeping>, at: Duration, result: Result<(), Failure>, text: &str) -> Line {
    let (text, warning) = match result {
        Ok(()) if drive.state.is_kept() => (format!("{text}; kept over a restart"), false),
        Ok(()) => (
            format!("{text}; kept over power-off until this program ends, without --state"),
            false,
        ),
        Err(failure) => (format!("{text}: not kept: {}", failure.message), true),
    };
    Line {
        drive: Arc::clone(drive),
        at,
        text,
        warning,
    }
}

fn talk(lines: &Receiver<Line>, left_out: &AtomicU64, output: &Output) {
    for Line {
        drive,
        at,
        text,
        warning,
    } in lines
    {
        if warning {
            output.warn(&format!("{}: {text}", drive.key));
        } else if output.json() {
            output.event(
                "simulate",
                fields! { "time": at.as_secs_f64(), "drive": drive.key.as_str(), "text": text },
            );
        } else {
            output.line(&format!(
                "{:>10.3} s  {:<16} {}",
                at.as_secs_f64(),
                drive.key,
                text.trim_end()
            ));
        }
        let missing = left_out.swap(0, Ordering::Relaxed);
        if missing > 0 {
            output.warn(&format!(
                "{missing} lines were left out: they came faster than they could be printed"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failure::Exit;
    use crate::state::{DriveState, StateFolder};

    fn drive(state: DriveState) -> Arc<Keeping> {
        Arc::new(Keeping {
            model: &virtual_drive::model::AKD,
            key: "akd-1".into(),
            state,
        })
    }

    #[test]
    fn only_what_was_kept_is_called_kept() {
        let at = Duration::ZERO;
        let path = std::env::temp_dir().join(format!("profidrive-kept-{}", std::process::id()));
        let folder = StateFolder::open(&path).unwrap();
        let line = told(&drive(folder.drive("akd-1")), at, Ok(()), "parameters saved");
        assert_eq!(
            (line.text.as_str(), line.warning),
            ("parameters saved; kept over a restart", false)
        );
        let line = told(&drive(DriveState::default()), at, Ok(()), "parameters saved");
        assert!(line.text.contains("without --state"), "{}", line.text);
        let failed = Err(Failure::new(Exit::Failed, "disk full"));
        let line = told(&drive(folder.drive("akd-1")), at, failed, "parameters saved");
        assert!(
            line.warning && line.text.contains("not kept: disk full"),
            "{}",
            line.text
        );
        drop(folder);
        std::fs::remove_dir_all(path).unwrap();
    }

    #[test]
    fn a_terminal_that_takes_nothing_holds_nobody_up() {
        let (lines, spoken) = sync_channel(2);
        let voice = Voice {
            lines,
            left_out: Arc::default(),
        };
        for _ in 0..10 {
            let (drive, at) = (drive(DriveState::default()), Duration::ZERO);
            voice.say(Line {
                drive,
                at,
                text: "x".into(),
                warning: false,
            });
        }
        assert_eq!(voice.left_out.load(Ordering::Relaxed), 8);
        drop(spoken);
    }
}
