//! Where the programs under test and their peers are.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Once;
use std::time::{Duration, Instant};

/// Returns the folder of the workspace.
#[must_use]
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_path_buf()
}

/// Returns a program of this workspace, built like the test that requests it.
#[must_use]
pub fn built(name: &str) -> PathBuf {
    static BUILD: Once = Once::new();
    // .../target/<profile>/deps/<test> or .../target/<profile>/<program>
    let own = std::env::current_exe().unwrap();
    let profile = own
        .ancestors()
        .find(|p| p.ends_with("debug") || p.ends_with("release"))
        .unwrap()
        .to_path_buf();
    BUILD.call_once(|| {
        let mut cargo = Command::new(std::env::var("CARGO").unwrap_or_else(|_| "cargo".into()));
        cargo
            .current_dir(root())
            .args(["build", "-q", "--workspace", "--bins"]);
        // benchmarks start no examples, and linking them all for a release takes minutes
        cargo.arg(if profile.ends_with("release") {
            "--release"
        } else {
            "--examples"
        });
        assert!(
            cargo.status().unwrap().success(),
            "the programs under test do not build"
        );
    });
    let program = profile.join(name);
    assert!(program.exists(), "{} is not built", program.display());
    program
}

/// Returns the Python of the peers' environment.
#[must_use]
pub fn python() -> PathBuf {
    let python = root().join("target/peers-venv/bin/python");
    assert!(
        python.exists(),
        "the Python peers are not installed: run `make setup`"
    );
    python
}

/// Returns a script that plays a peer.
#[must_use]
pub fn peer(script: &str) -> PathBuf {
    root().join("tests/peers").join(script)
}

/// Returns the recorded captures.
#[must_use]
pub fn capture_files() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(root().join("captures"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "pcapng"))
        .collect();
    files.sort();
    files
}

/// Polls until `done` or the limit; returns whether it was done.
pub fn wait_until(limit: Duration, mut done: impl FnMut() -> bool) -> bool {
    let until = Instant::now() + limit;
    loop {
        if done() {
            return true;
        }
        if Instant::now() > until {
            return false;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Processor time that the host of this virtual machine has taken from it since it started: the kernel counts it.
/// Whoever loses a cycle then is not to blame. Zero where nothing is taken.
#[must_use]
pub fn stolen() -> Duration {
    let text = std::fs::read_to_string("/proc/stat").unwrap_or_default();
    let all = text.lines().next().unwrap_or_default();
    // user, nice, system, idle, iowait, irq, softirq, steal: in hundredths of a second
    let ticks = all.split_whitespace().nth(8).and_then(|ticks| ticks.parse().ok());
    Duration::from_millis(10 * ticks.unwrap_or(0))
}

/// A measurement that is not clean.
#[derive(Debug)]
pub struct Disturbed {
    /// What was seen.
    pub what: String,
    /// Time that is missing in it, as far as the host can have taken it.
    pub lost: Option<Duration>,
}

impl From<String> for Disturbed {
    fn from(what: String) -> Self {
        Self { what, lost: None }
    }
}

/// Measures up to three times and passes with the first measurement that is clean, or from which no more time is missing
/// than the host of this virtual machine took meanwhile, and not more than a fortieth of it.
///
/// A test machine may be held up for longer than a cycle by what else it has to do; then a sender leaves an interval out, which
/// says nothing about the sender. Whatever is not a matter of such a pause must fail at once, by panicking.
#[track_caller]
pub fn undisturbed<D: Into<Disturbed>>(mut measure: impl FnMut() -> Result<(), D>) {
    let mut disturbed = Vec::new();
    for _ in 0..3 {
        let (before, start) = (stolen(), Instant::now());
        let Err(found) = measure() else { return };
        let Disturbed { what, lost } = found.into();
        let taken = stolen().saturating_sub(before);
        let excused = taken.min(start.elapsed() / 40);
        if lost.is_some_and(|lost| lost <= excused) {
            eprintln!("the host took {taken:?} of processor time, which explains: {what}");
            return;
        }
        eprintln!("disturbed, measured again: {what}");
        disturbed.push(what);
    }
    panic!("disturbed three times: {}", disturbed.join("; "));
}
