//! Two network namespaces joined by a cable, made for one test and gone with it.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::Duration;

use crate::process::{Finished, Running};
use crate::programs::{root, wait_until};

/// An end of the cable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Interface `ctl0`, MAC 02:50:4e:00:00:02, address 192.168.77.11/24.
    Controller,
    /// Interface `dev0`, MAC 02:50:4e:00:00:01, without an address: a virtual drive brings its own.
    Device,
}

impl Side {
    /// Returns the interface at this end.
    #[must_use]
    pub const fn interface(self) -> &'static str {
        match self {
            Self::Controller => "ctl0",
            Self::Device => "dev0",
        }
    }

    /// Returns the MAC of the interface at this end.
    #[must_use]
    pub const fn mac(self) -> &'static str {
        match self {
            Self::Controller => "02:50:4e:00:00:02",
            Self::Device => "02:50:4e:00:00:01",
        }
    }

    const fn namespace(self) -> &'static str {
        match self {
            Self::Controller => "controller",
            Self::Device => "device",
        }
    }
}

/// Laboratories run beside each other, as each has namespaces of its own; one that measures times runs alone.
static LABS: RwLock<()> = RwLock::new(());

/// The share that a laboratory has of this machine.
#[derive(Debug)]
enum Share {
    /// Others run beside it.
    Shared { _guard: RwLockReadGuard<'static, ()> },
    /// No other laboratory runs.
    Whole { _guard: RwLockWriteGuard<'static, ()> },
}

impl Share {
    fn shared() -> Self {
        let guard = LABS.read().unwrap_or_else(PoisonError::into_inner);
        Self::Shared { _guard: guard }
    }

    fn whole() -> Self {
        let guard = LABS.write().unwrap_or_else(PoisonError::into_inner);
        Self::Whole { _guard: guard }
    }
}

// Runs as the first process of fresh user, network, mount and process-number namespaces. When its standard input closes,
// because the test has ended or crashed, it ends, and the kernel ends everything else in there.
const FIRST_PROCESS: &str = r#"set -e
read -r pid rest </proc/self/stat
mount -t tmpfs lab /run
mkdir /run/netns
for name in controller device; do
    ip netns add $name
    ip netns exec $name sh -c 'echo 1 >/proc/sys/net/ipv6/conf/all/disable_ipv6
        echo 1 >/proc/sys/net/ipv6/conf/default/disable_ipv6' 2>/dev/null || true
done
ip link add name ctl0 address 02:50:4e:00:00:02 netns controller type veth \
    peer name dev0 address 02:50:4e:00:00:01 netns device
ip -n controller link set lo up
ip -n device link set lo up
ip -n controller addr add 192.168.77.11/24 dev ctl0
ip -n controller link set ctl0 up
ip -n device link set dev0 up
echo $pid
exec cat
"#;

/// Two namespaces, one cable, a folder for what the test leaves behind.
#[derive(Debug)]
pub struct Lab {
    first: Child,
    pid: u32,
    user: bool,
    folder: PathBuf,
    count: AtomicUsize,
    captures: AtomicUsize,
    _share: Share,
}

impl Lab {
    /// Makes the namespaces; logs and captures go to `target/system/<name>`.
    ///
    /// # Panics
    /// When this machine allows no namespaces; `make setup` reports it too.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self::with(name, Share::shared())
    }

    /// The same for a test that measures times or loads the machine: no other laboratory runs beside it.
    ///
    /// # Panics
    /// As [`new`](Self::new).
    #[must_use]
    pub fn alone(name: &str) -> Self {
        Self::with(name, Share::whole())
    }

    fn with(name: &str, share: Share) -> Self {
        Self::start(name, &[true, false], share)
            .unwrap_or_else(|complaint| panic!("no network namespaces on this machine: {complaint}"))
    }

    fn start(name: &str, ways: &[bool], share: Share) -> Result<Self, String> {
        let folder = root().join("target/system").join(name);
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        for &user in ways {
            let mut command = Command::new("unshare");
            if user {
                command.args(["--user", "--map-root-user"]);
            }
            let mut first = command
                .args([
                    "--net",
                    "--mount",
                    "--pid",
                    "--fork",
                    "--kill-child",
                    "sh",
                    "-c",
                    FIRST_PROCESS,
                ])
                .stdin(Stdio::piped())
                .stdout(Stdio::piped())
                .stderr(File::create(folder.join("lab.err")).unwrap())
                .spawn()
                .unwrap_or_else(|e| panic!("cannot run unshare ({e}): run `make setup`"));
            let mut line = String::new();
            let _ = BufReader::new(first.stdout.take().unwrap()).read_line(&mut line);
            if let Ok(pid) = line.trim().parse() {
                return Ok(Self {
                    first,
                    pid,
                    user,
                    folder,
                    count: AtomicUsize::new(0),
                    captures: AtomicUsize::new(0),
                    _share: share,
                });
            }
            let _ = first.wait();
        }
        Err(std::fs::read_to_string(folder.join("lab.err")).unwrap_or_default())
    }

    /// Returns the folder for logs and captures.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn command<S: AsRef<OsStr>>(
        &self,
        side: Side,
        program: &Path,
        arguments: impl IntoIterator<Item = S>,
    ) -> Command {
        let mut command = Command::new("nsenter");
        command.arg("--target").arg(self.pid.to_string());
        if self.user {
            command.args(["--user", "--preserve-credentials"]);
        }
        // another mount namespace begins at its root: the folder below is relative
        command.arg(format!("--wd={}", root().display()));
        command.args([
            "--mount",
            "--net",
            "--pid",
            "--",
            "ip",
            "netns",
            "exec",
            side.namespace(),
        ]);
        // simulations that run beside the tests are none of theirs; relative, as names of sockets are short
        let own = self.folder.strip_prefix(root()).unwrap_or(&self.folder);
        command.env("XDG_RUNTIME_DIR", own);
        command.env("XDG_STATE_HOME", self.folder.join("state"));
        // nor are the configuration and the cache of whoever runs the tests
        command.env("XDG_CONFIG_HOME", self.folder.join("config"));
        command.env("XDG_CACHE_HOME", self.folder.join("cache"));
        command.arg(program).args(arguments).current_dir(root());
        command
    }

    /// Starts a program at one end.
    #[must_use]
    pub fn spawn<S: AsRef<OsStr>>(
        &self,
        side: Side,
        program: impl AsRef<Path>,
        arguments: impl IntoIterator<Item = S>,
    ) -> Running {
        let program = program.as_ref();
        let name = program
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let number = self.count.fetch_add(1, Ordering::Relaxed);
        let log = self.folder.join(format!("{number:02}-{name}"));
        Running::start(&name, self.command(side, program, arguments), &log, true)
    }

    /// Runs a program at one end to its end.
    #[track_caller]
    pub fn run<S: AsRef<OsStr>>(
        &self,
        side: Side,
        program: impl AsRef<Path>,
        arguments: impl IntoIterator<Item = S>,
        limit: Duration,
    ) -> Finished {
        self.spawn(side, program, arguments).finish(limit)
    }

    /// Gives an interface an address of the kernel's (a peer that uses the kernel's IP stack needs one).
    #[track_caller]
    pub fn address(&self, side: Side, address: &str) {
        let dev = ["addr", "add", address, "dev", side.interface()];
        self.run(side, "ip", dev, Duration::from_secs(5)).ok();
    }

    /// Pulls or plugs the cable at one end.
    #[track_caller]
    pub fn link(&self, side: Side, up: bool) {
        let set = ["link", "set", side.interface(), if up { "up" } else { "down" }];
        self.run(side, "ip", set, Duration::from_secs(5)).ok();
    }

    /// Records the controller's end into `<folder>/<name>.pcapng` from now on.
    #[must_use]
    #[track_caller]
    pub fn capture(&self, name: &str) -> Capture {
        let file = self.folder.join(format!("{name}.pcapng"));
        let path = file.to_string_lossy().into_owned();
        let arguments = ["-q", "-i", Side::Controller.interface(), "-B", "64", "-w", &path];
        let mut recorder = self.spawn(Side::Controller, "dumpcap", arguments);
        recorder.wait_for("File:", Duration::from_secs(10));
        let absent = absent(self.captures.fetch_add(1, Ordering::Relaxed));
        let mut last_frame = self.command(
            Side::Controller,
            Path::new("ping"),
            ["-c", "1", "-W", "1", &absent.to_string()],
        );
        last_frame.stdout(Stdio::null()).stderr(Stdio::null());
        Capture {
            file,
            recorder,
            last_frame,
            absent,
        }
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        drop(self.first.stdin.take());
        let _ = self.first.wait();
    }
}

/// An address that no station has: the controller's end requests its MAC by ARP, in vain. Each capture has its own, as no new
/// request goes out while an earlier one waits for its answer.
fn absent(capture: usize) -> Ipv4Addr {
    let host = [254, 253, 252, 251, 250, 249, 248, 247];
    Ipv4Addr::new(192, 168, 77, host[capture % host.len()])
}

/// A running recording.
#[derive(Debug)]
pub struct Capture {
    file: PathBuf,
    recorder: Running,
    /// Sends a frame that nothing else sends.
    last_frame: Command,
    /// The address that it looks for.
    absent: Ipv4Addr,
}

impl Capture {
    /// Ends the recording and gives its file. Fails the test when the recorder missed frames.
    #[track_caller]
    pub fn stop(mut self) -> PathBuf {
        // the recorder gets frames in blocks and in their order: with this one in its file it has all before
        let mut file = File::open(&self.file).unwrap();
        let end = file.seek(SeekFrom::End(0)).unwrap();
        // target of the request: no MAC yet, and the address
        let target = [&[0; 6][..], &self.absent.octets()].concat();
        let mut sender = self.last_frame.spawn().unwrap();
        let complete = wait_until(Duration::from_secs(10), || {
            let mut recorded = Vec::new();
            file.seek(SeekFrom::Start(end)).unwrap();
            file.read_to_end(&mut recorded).unwrap();
            recorded.windows(target.len()).any(|octets| octets == target)
        });
        let _ = sender.kill();
        let _ = sender.wait();
        assert!(complete, "the recorder did not record its last frame");
        let finished = self.recorder.interrupt(Duration::from_secs(10)).ok();
        let dropped = finished
            .err
            .lines()
            .find(|line| line.contains("dropped on interface"));
        let clean = dropped.is_some_and(|line| line.contains("/0 (pcap:0/"));
        assert!(
            clean,
            "the recorder missed frames or did not report: {}",
            finished.err
        );
        self.file
    }
}
