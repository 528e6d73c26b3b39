//! A program that runs beside a test: bounded, watched, ended with everything it started.

use std::fs::File;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use crate::programs::wait_until;

/// A program in the background. Dropping it kills it and all it started.
#[derive(Debug)]
pub struct Running {
    name: String,
    child: Child,
    /// The program itself, a child of the tool that entered the namespace for it.
    inner: Option<u32>,
    out: PathBuf,
    err: PathBuf,
}

/// What a program left behind.
#[derive(Debug, Clone)]
pub struct Finished {
    /// Name for messages.
    pub name: String,
    /// Exit code; `None` when a signal ended it.
    pub code: Option<i32>,
    /// All it printed.
    pub out: String,
    /// All its complaints.
    pub err: String,
}

impl Finished {
    /// Fails the test unless the program ended with code 0.
    #[track_caller]
    pub fn ok(self) -> Self {
        assert_eq!(
            self.code,
            Some(0),
            "{} failed\n--- stdout\n{}--- stderr\n{}",
            self.name,
            self.out,
            self.err
        );
        self
    }

    /// Returns the JSON object on each line of the output that is one.
    #[must_use]
    pub fn json_lines(&self) -> Vec<serde_json::Value> {
        self.out
            .lines()
            .filter_map(|line| serde_json::from_str(line).ok())
            .collect()
    }
}

/// Returns the line of a peer about one of its steps; the test fails when the step did not happen.
#[track_caller]
pub fn step<'a>(steps: &'a [serde_json::Value], name: &str) -> &'a serde_json::Value {
    steps
        .iter()
        .find(|step| step["step"] == name)
        .unwrap_or_else(|| panic!("step {name} did not happen: {steps:?}"))
}

impl Running {
    /// Starts `command`; its output goes to `<log>.out` and `<log>.err`. `entered` means that the command is a tool
    /// that forks the program proper.
    pub(crate) fn start(name: &str, mut command: Command, log: &Path, entered: bool) -> Self {
        let out = log.with_extension("out");
        let err = log.with_extension("err");
        command
            .stdin(Stdio::piped())
            .stdout(File::create(&out).unwrap())
            .stderr(File::create(&err).unwrap())
            .process_group(0);
        let child = command
            .spawn()
            .unwrap_or_else(|e| panic!("cannot start {name}: {e}"));
        let mut running = Self {
            name: name.into(),
            child,
            inner: None,
            out,
            err,
        };
        if entered {
            let outer = running.child.id();
            let mut inner = None;
            wait_until(Duration::from_secs(5), || {
                inner = only_child(outer);
                inner.is_some() || !Path::new(&format!("/proc/{outer}/exe")).exists()
            });
            running.inner = inner;
        }
        running
    }

    /// Returns the process number of the program, as seen by the test.
    #[must_use]
    pub fn pid(&self) -> u32 {
        self.inner.unwrap_or_else(|| self.child.id())
    }

    /// Returns its standard output so far.
    #[must_use]
    pub fn out(&self) -> String {
        std::fs::read_to_string(&self.out).unwrap_or_default()
    }

    /// Returns its standard error so far.
    #[must_use]
    pub fn err(&self) -> String {
        std::fs::read_to_string(&self.err).unwrap_or_default()
    }

    /// Waits until `text` was printed (on either stream).
    #[track_caller]
    pub fn wait_for(&mut self, text: &str, limit: Duration) {
        let seen = wait_until(limit, || {
            self.out().contains(text) || self.err().contains(text) || self.status().is_some()
        });
        assert!(
            seen && (self.out().contains(text) || self.err().contains(text)),
            "{} did not say {text:?} within {limit:?}\n--- stdout\n{}--- stderr\n{}",
            self.name,
            self.out(),
            self.err()
        );
    }

    /// Returns its exit status, once it ended.
    pub fn status(&mut self) -> Option<ExitStatus> {
        self.child.try_wait().unwrap()
    }

    /// Sends a signal by name (`INT`, `TERM`, `KILL`, `STOP`, `CONT`) to the program alone.
    pub fn signal(&self, name: &str) {
        let mut named = vec![self.pid().to_string()];
        if name == "CONT" && self.inner.is_some() {
            // the tool that entered the namespace stops itself when the program is stopped, and would never see its end
            named.push(self.child.id().to_string());
        }
        let _ = Command::new("kill")
            .args(["-s", name])
            .args(named)
            .stderr(Stdio::null())
            .status();
    }

    /// CPU time used so far, all threads.
    #[must_use]
    pub fn cpu(&self) -> Duration {
        let nanos = std::fs::read_dir(format!("/proc/{}/task", self.pid()))
            .map(|tasks| {
                tasks
                    .flatten()
                    .filter_map(|task| std::fs::read_to_string(task.path().join("schedstat")).ok())
                    .filter_map(|text| text.split(' ').next().and_then(|n| n.parse::<u64>().ok()))
                    .sum()
            })
            .unwrap_or(0);
        Duration::from_nanos(nanos)
    }

    /// Waits for the end; fails the test (and kills the program) when that takes longer than `limit`.
    #[track_caller]
    pub fn finish(mut self, limit: Duration) -> Finished {
        let until = Instant::now() + limit;
        while self.status().is_none() {
            if Instant::now() > until {
                let (out, err) = (self.out(), self.err());
                self.kill();
                panic!(
                    "{} did not end within {limit:?}\n--- stdout\n{out}--- stderr\n{err}",
                    self.name
                );
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let code = self.status().and_then(|status| status.code());
        Finished {
            name: self.name.clone(),
            code,
            out: self.out(),
            err: self.err(),
        }
    }

    /// Sends SIGINT, as Ctrl-C does, and waits for the end.
    #[track_caller]
    pub fn interrupt(self, limit: Duration) -> Finished {
        self.signal("INT");
        self.finish(limit)
    }

    /// Kills it at once, without an orderly end.
    pub fn kill(&mut self) {
        if self.status().is_none() {
            self.signal("KILL");
            // then the tool around it and everything else of its process group
            let group = format!("-{}", self.child.id());
            let _ = Command::new("kill")
                .args(["-s", "KILL", "--", &group])
                .stderr(Stdio::null())
                .status();
            let _ = self.child.wait();
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.kill();
    }
}

fn only_child(pid: u32) -> Option<u32> {
    let text = std::fs::read_to_string(format!("/proc/{pid}/task/{pid}/children")).ok()?;
    text.split_whitespace().next()?.parse().ok()
}
