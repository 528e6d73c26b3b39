//! A network of its own for a test: the test runs itself again inside fresh user and network namespaces.

#![allow(clippy::panic)]

use std::process::{Child, Command, Stdio};

/// Set in the process that is inside.
const INSIDE: &str = "PROFIDRIVE_TEST_NAMESPACE";

/// Returns true inside; outside, runs the test `name` inside and fails if it fails there. Works as root and as a plain
/// user.
pub fn inside(name: &str) -> bool {
    if std::env::var_os(INSIDE).is_some() {
        run("ip link set lo up");
        return true;
    }
    let program = std::env::current_exe().expect("the test knows its own file");
    let with = |namespaces: &[&str]| {
        // whatever started the tests may ignore SIGHUP (nohup), and children inherit that
        Command::new("env")
            .args(["--default-signal=HUP", "unshare"])
            .args(namespaces)
            .arg(&program)
            .args(["--exact", name, "--nocapture", "--test-threads=1"])
            .env(INSIDE, "1")
            .output()
            .expect("unshare is needed: apt-get install util-linux")
    };
    let mut output = with(&["--user", "--map-root-user", "--net"]);
    if String::from_utf8_lossy(&output.stderr).contains("unshare failed") {
        // User namespaces are switched off here: as root a network namespace alone will do.
        output = with(&["--net"]);
    }
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        output.status.success(),
        "inside:\n{}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
    assert!(
        text(&output.stdout).contains("1 passed"),
        "`{name}` is not the name of the test"
    );
    false
}

/// Runs a command that must succeed; returns what it printed.
pub fn run(command: &str) -> String {
    let mut words = command.split_whitespace();
    let program = words.next().expect("a command");
    let output = Command::new(program)
        .args(words)
        .output()
        .unwrap_or_else(|error| panic!("{program}: {error}"));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{command}: {text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    text
}

/// A pair of connected interfaces `va` and `vb`, both up.
#[allow(dead_code)]
pub fn veth() {
    run("ip link add va type veth peer name vb");
    run("ip link set va up");
    run("ip link set vb up");
}

/// Runs a command beside the test.
#[allow(dead_code)]
pub fn start(command: &str) -> Child {
    let mut words = command.split_whitespace();
    let program = words.next().expect("a command");
    Command::new(program)
        .args(words)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| panic!("{program}: {error}"))
}
