//! A page with a control socket, as tests of several kinds use it, and what becomes of its axis.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::live::{Page, open_at};
use crate::server::Running;

pub const PROTOCOL: &str = "profidrive.control.1";

/// A page with a control socket, and the numbers of its commands.
pub struct Hands {
    pub page: Page,
    pub number: u64,
    begin: Instant,
    pub beats: u64,
    /// When the last beat was sent.
    beaten: Option<Instant>,
}

impl Hands {
    pub fn of(server: &Running, token: &str) -> Self {
        Self::at(server, &server.session(token))
    }

    /// Those of a session that there is.
    pub fn at(server: &Running, session: &str) -> Self {
        let page = open_at(server, "/api/v1/control", session, Some(PROTOCOL));
        let mut page = page.unwrap_or_else(|status| panic!("{status}"));
        page.next("hello");
        Self {
            page,
            number: 0,
            begin: Instant::now(),
            beats: 0,
            beaten: None,
        }
    }

    /// Returns the next STOP that it hears of.
    pub fn stopped(&mut self) -> Value {
        self.page.next("stopped")
    }

    pub fn time(&self) -> f64 {
        self.begin.elapsed().as_secs_f64() * 1000.0
    }

    /// Sends a command; returns its number.
    pub fn send(&mut self, kind: &str, drive: &str, more: &Value) -> u64 {
        self.number += 1;
        let mut message = json!({ "type": kind, "n": self.number, "drive": drive });
        for (key, value) in more.as_object().unwrap() {
            message[key] = value.clone();
        }
        self.page.send(&message);
        self.number
    }

    pub fn beat(&mut self, held: &Value) {
        self.beats += 1;
        self.beaten = Some(Instant::now());
        let t = self.time();
        self.page
            .send(&json!({ "type": "beat", "n": self.beats, "t": t, "held": held }));
    }

    /// Waits until the server closes the socket; returns why.
    pub fn closed(&mut self) -> Option<u16> {
        self.page.closed()
    }

    pub fn take(&mut self, drive: &str) -> Value {
        let number = self.send("take", drive, &json!({ "purpose": "speed", "limit": 300 }));
        self.answer(number)
    }

    /// Beats until a message comes that fits.
    pub fn beats_until(&mut self, held: &Value, fits: impl Fn(&Value) -> bool) -> Value {
        let begin = Instant::now();
        self.page.patience(Duration::from_millis(20));
        loop {
            assert!(begin.elapsed() < Duration::from_secs(30), "it does not come");
            if let Some(message) = self.page.poll().filter(|message| fits(message)) {
                return message;
            }
            let is_due = |beaten: Instant| beaten.elapsed() > Duration::from_millis(50);
            if self.beaten.is_none_or(is_due) {
                self.beat(held);
            }
        }
    }

    /// Beats until a command is answered, and returns the answer.
    pub fn answer(&mut self, number: u64) -> Value {
        self.beats_until(&Value::Null, |message| {
            let kind = message["type"].as_str().unwrap_or_default();
            message["n"] == number && matches!(kind, "accepted" | "refused" | "lease")
        })
    }

    /// Confirms the direction of an axis, once it was jogged at this speed in rpm.
    pub fn confirm(&mut self, drive: &str, lease: u64, speed: f64) {
        let early = self.order("confirm", drive, lease, 0, &json!({}));
        assert!(sentence(&early).contains("after a first motion"), "{early}");
        let jog = json!({ "lease": lease, "epoch": 0, "speed": speed, "rtt": 1, "t": self.time() });
        let jog = self.send("jog", drive, &jog);
        self.beats_until(&json!({ "drive": drive, "n": jog }), |message| {
            let mut axes = message["axes"].as_array().into_iter().flatten();
            axes.any(|axis| axis["drive"] == drive && axis["moved"] == true)
        });
        // the button is up: from now on it only slows down
        self.beats_until(&Value::Null, |message| {
            let mut axes = message["axes"].as_array().into_iter().flatten();
            axes.any(|axis| axis["drive"] == drive && axis["phase"] != "moving")
        });
        let confirmed = self.order("confirm", drive, lease, 0, &json!({}));
        assert_eq!(confirmed["type"], "accepted", "{confirmed}");
    }

    /// Sends a command of this lease and waits for its answer.
    pub fn order(&mut self, kind: &str, drive: &str, lease: u64, epoch: u64, more: &Value) -> Value {
        let mut all = json!({ "lease": lease, "epoch": epoch });
        for (key, value) in more.as_object().unwrap() {
            all[key] = value.clone();
        }
        let number = self.send(kind, drive, &all);
        self.answer(number)
    }
}

pub fn lease(answer: &Value) -> u64 {
    assert_eq!(answer["type"], "lease", "{answer}");
    answer["lease"].as_u64().unwrap()
}

pub fn sentence(answer: &Value) -> &str {
    assert_eq!(answer["type"], "refused", "{answer}");
    answer["sentence"].as_str().unwrap()
}

pub fn speed(server: &Running, id: &str) -> f64 {
    let drives = server
        .ask("GET", "/api/v1/plant/drives", &Running::bearer(&server.view), "")
        .json();
    let mut drives = drives["drives"].as_array().unwrap().iter();
    drives.find(|drive| drive["id"] == *id).unwrap()["speed"]
        .as_f64()
        .unwrap()
}

pub fn position(server: &Running, id: &str) -> f64 {
    let answer = server.ask("GET", "/api/v1/plant/drives", &Running::bearer(&server.view), "");
    let drives = answer.json();
    let mut all = drives["drives"].as_array().unwrap().iter();
    all.find(|drive| drive["id"] == id).unwrap()["position"]
        .as_f64()
        .unwrap()
}

/// Waits until the shaft rests.
pub fn rests(server: &Running, id: &str) {
    let begin = Instant::now();
    while speed(server, id).abs() > 0.1 {
        assert!(begin.elapsed() < Duration::from_secs(10), "it turns");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Beats until the shaft turns.
pub fn turns(server: &Running, hands: &mut Hands, id: &str, held: &Value) {
    let begin = Instant::now();
    while speed(server, id).abs() < 15.0 {
        assert!(begin.elapsed() < Duration::from_secs(10), "it rests");
        hands.beat(held);
        std::thread::sleep(Duration::from_millis(30));
    }
}
