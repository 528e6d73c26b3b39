//! A cable between two pseudo-terminals, and a simulation at its far end.

// each test program uses a part of it
#![allow(dead_code)]

use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::{Duration, Instant};

use network::serial::Port;

/// Two ends, and the thread between them.
pub struct Cable {
    near: String,
    far: String,
    state: Arc<State>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct State {
    end: AtomicBool,
    cut: AtomicBool,
    echo: AtomicBool,
    /// Every so many lumps of octets one is spoiled; 0 for none.
    every: AtomicU64,
    spoiled: AtomicU64,
}

impl Cable {
    /// Creates a cable that is whole.
    pub fn lay() -> Self {
        let (near_end, near) = Port::pair().expect("a pseudo-terminal");
        let (far_end, far) = Port::pair().expect("a pseudo-terminal");
        let state = Arc::new(State::default());
        let shared = Arc::clone(&state);
        let thread = spawn(move || carry(near_end, far_end, &shared));
        Self {
            near,
            far,
            state,
            thread: Some(thread),
        }
    }

    /// Returns a drive as the user writes it.
    pub fn drive(&self, protocol: &str, number: u8) -> String {
        format!("{protocol}:{}/{number}", self.near)
    }

    /// Returns a drive as the simulation calls it: by its own end.
    pub fn far_drive(&self, protocol: &str, number: u8) -> String {
        format!("{protocol}:{}/{number}", self.far)
    }

    /// Whether the user's end hears itself.
    pub fn echo(&self, on: bool) {
        self.state.echo.store(on, Ordering::SeqCst);
    }

    /// Spoils one lump of octets in so many: noise in front of it, a changed octet, or half of it lost.
    pub fn spoil_every(&self, lumps: u64) {
        self.state.every.store(lumps, Ordering::SeqCst);
    }

    /// Returns the number of spoiled frames.
    pub fn spoiled(&self) -> u64 {
        self.state.spoiled.load(Ordering::SeqCst)
    }

    /// Nothing passes any more after this time.
    pub fn cut_after(&self, time: Duration) -> JoinHandle<()> {
        let state = Arc::clone(&self.state);
        spawn(move || {
            sleep(time);
            state.cut.store(true, Ordering::SeqCst);
        })
    }
}

impl Drop for Cable {
    fn drop(&mut self) {
        self.state.end.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn carry(mut near: Port, mut far: Port, state: &State) {
    let mut buffer = [0; 512];
    let mut lumps = 0;
    while !state.end.load(Ordering::SeqCst) {
        let mut idle = true;
        for towards_drive in [true, false] {
            let (from, to) = if towards_drive {
                (&mut near, &mut far)
            } else {
                (&mut far, &mut near)
            };
            // an end that is not open sends nothing
            let length = from.read(&mut buffer).unwrap_or(0);
            if length == 0 || state.cut.load(Ordering::SeqCst) {
                continue;
            }
            idle = false;
            lumps += 1;
            let octets = buffer[..length].to_vec();
            if towards_drive && state.echo.load(Ordering::SeqCst) {
                let _ = from.write(&octets);
            }
            let _ = to.write(&spoil(octets, lumps, state));
        }
        if idle {
            sleep(Duration::from_micros(300));
        }
    }
}

fn spoil(mut octets: Vec<u8>, lump: u64, state: &State) -> Vec<u8> {
    let every = state.every.load(Ordering::SeqCst);
    if every == 0 || !lump.is_multiple_of(every) {
        return octets;
    }
    match state.spoiled.fetch_add(1, Ordering::SeqCst) % 3 {
        0 => {
            octets.splice(0..0, [0xFF, 0x02, 0x00]);
        }
        1 => {
            let middle = octets.len() / 2;
            octets[middle] ^= 0x40;
        }
        _ => octets.truncate(octets.len() / 2),
    }
    octets
}

/// `profidrive simulate --serial` at the far end; ends with it.
pub struct Simulated {
    process: Child,
    lines: BufReader<ChildStdout>,
}

impl Simulated {
    /// Starts AKDs and waits until they are there.
    pub fn start(cable: &Cable, more: &[&str]) -> Self {
        Self::start_model(cable, "akd", more)
    }

    /// Starts drives of this model and waits until they are there.
    pub fn start_model(cable: &Cable, model: &str, more: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_profidrive"))
            .args(["simulate", "--model", model, "--serial", &cable.far])
            .args(more)
            .env("NO_COLOR", "1")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary runs");
        let lines = BufReader::new(process.stdout.take().expect("piped"));
        let mut ready = BufReader::new(process.stderr.take().expect("piped"));
        // it says so once the port is open
        let mut line = String::new();
        while !line.contains("Ctrl-C ends") {
            line.clear();
            let length = ready.read_line(&mut line).expect("text");
            assert!(length > 0, "the simulation ended: {line}");
        }
        spawn(move || ready.lines().map_while(Result::ok).for_each(drop));
        Self { process, lines }
    }

    /// Ends it as Ctrl-C does, and waits until it has put its things away.
    pub fn end_in_order(mut self) {
        let number = self.process.id().to_string();
        let sent = Command::new("kill").args(["-INT", &number]).status();
        assert!(sent.expect("kill runs").success());
        let (mut left, limit) = (None, Instant::now() + Duration::from_secs(30));
        while left.is_none() && Instant::now() < limit {
            sleep(Duration::from_millis(20));
            left = self.process.try_wait().expect("its state");
        }
        assert!(left.is_some_and(|status| status.success()), "{left:?}");
    }

    /// Returns its output until a line contains this text.
    pub fn output_until(&mut self, words: &str) -> String {
        let (mut all, limit) = (String::new(), Instant::now() + Duration::from_secs(30));
        while !all.contains(words) && Instant::now() < limit {
            if self.lines.read_line(&mut all).expect("text") == 0 {
                break;
            }
        }
        all
    }
}

impl Drop for Simulated {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
