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

/// Runs a test that compares what the clock decides, such as a speed on its ramp, up to three times: a busy machine holds
/// a program up for longer than the figure allows, which says nothing about the program. Whatever is not a matter of such a
/// pause must fail at once, by panicking.
#[track_caller]
pub fn undisturbed(mut run: impl FnMut() -> Result<(), String>) {
    let mut disturbed = Vec::new();
    for _ in 0..3 {
        let Err(found) = run() else { return };
        eprintln!("disturbed, run again: {found}");
        disturbed.push(found);
    }
    panic!("disturbed three times: {}", disturbed.join("; "));
}
