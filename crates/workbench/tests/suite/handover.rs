//! Two pages that want one axis: it is handed over when the one who has it accepts, and once it is at rest.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::change::known;
use crate::hands::{Hands, lease, rests, sentence, speed, turns};
use crate::server::Running;

/// Requests the axis, and waits until `holder` sees that. Returns the number of the message and that of the request.
fn request(page: &mut Hands, holder: &mut Hands, id: &str) -> (u64, u64) {
    let terms = json!({ "purpose": "speed", "limit": 300, "wait": true });
    let number = page.send("take", id, &terms);
    let begin = Instant::now();
    loop {
        assert!(begin.elapsed() < Duration::from_secs(10), "it is not requested");
        keep_alive(&mut [page, holder]);
        let wanted = &picture(holder)["wanted"];
        if let Some(request) = wanted["request"].as_u64() {
            assert_eq!(wanted["accepted"], false, "{wanted}");
            return (number, request);
        }
    }
}

fn keep_alive(pages: &mut [&mut Hands]) {
    for page in pages {
        page.beat(&Value::Null);
    }
}

/// Returns the next picture of the axis that a page gets.
fn picture(page: &mut Hands) -> Value {
    page.page.next("axes")["axes"][0].clone()
}

/// Beats until no page waits.
fn unwanted(holder: &mut Hands) {
    let begin = Instant::now();
    while picture(holder)["wanted"] != Value::Null {
        assert!(begin.elapsed() < Duration::from_secs(10), "it is requested still");
        holder.beat(&Value::Null);
    }
}

/// A page that has the axis and turns it, and its lease.
fn turning(server: &Running, id: &str) -> (Hands, u64) {
    let mut page = Hands::of(server, &server.control);
    let lease = lease(&page.take(id));
    for (kind, more) in [("enable", json!({})), ("velocity", json!({ "speed": 20 }))] {
        let answer = page.order(kind, id, lease, 0, &more);
        assert_eq!(answer["type"], "accepted", "{answer}");
    }
    turns(server, &mut page, id, &Value::Null);
    (page, lease)
}

#[test]
fn an_axis_is_handed_over_when_its_page_accepts_and_once_it_is_at_rest() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let (mut first, of_first) = turning(&server, &id);
    let mut second = Hands::of(&server, &server.control);
    let (number, wanted) = request(&mut second, &mut first, &id);
    // the axis goes on, and who waits moves nothing
    let early = second.order("velocity", &id, wanted, 0, &json!({ "speed": 5 }));
    assert!(sentence(&early).contains("not have control"), "{early}");
    assert!(speed(&server, &id) > 15.0);
    // another one learns who was before it
    let mut third = Hands::of(&server, &server.control);
    let terms = json!({ "purpose": "speed", "wait": true });
    let late = third.send("take", &id, &terms);
    let late = third.answer(late);
    assert!(sentence(&late).contains("already requested this drive"), "{late}");
    // an answer that was meant for another request answers nothing
    let other = json!({ "request": wanted + 1 });
    let wrong = first.order("hand_over", &id, of_first, 0, &other);
    assert!(sentence(&wrong).contains("withdrawn"), "{wrong}");
    keep_alive(&mut [&mut first, &mut second]);
    let yes = json!({ "request": wanted });
    let accepted = first.order("hand_over", &id, of_first, 0, &yes);
    assert_eq!(accepted["type"], "accepted", "{accepted}");
    let over = first.order("velocity", &id, of_first, 0, &json!({ "speed": 20 }));
    assert!(sentence(&over).contains("giving the drive back"), "{over}");
    let taken = second.answer(number);
    assert_eq!(lease(&taken), wanted, "{taken}");
    assert!(speed(&server, &id).abs() < 0.1, "at rest");
    for (kind, more) in [("enable", json!({})), ("velocity", json!({ "speed": 20 }))] {
        let answer = second.order(kind, &id, wanted, 0, &more);
        assert_eq!(answer["type"], "accepted", "{answer}");
    }
    turns(&server, &mut second, &id, &Value::Null);
    second.send("release", &id, &json!({}));
    let log = server.logged(|log| log.iter().filter(|one| one["action"] == "release").count() == 2);
    let actions: Vec<&str> = log
        .iter()
        .filter(|record| !record["result"].is_null())
        .filter_map(|record| record["action"].as_str())
        .collect();
    let place = |action: &str| actions.iter().position(|one| *one == action);
    assert!(
        place("request_control").is_some() && place("request_control") < place("hand_over"),
        "{actions:?}"
    );
    let hand_over = log
        .iter()
        .find(|record| record["action"] == "hand_over" && record["result"] == "done");
    let hand_over = hand_over.unwrap();
    assert_eq!(
        (&hand_over["who"], &hand_over["value"]),
        (&"1".into(), &"session 2".into())
    );
}

#[test]
fn a_request_ends_when_it_is_refused_withdrawn_or_stopped_and_when_its_page_is_silent() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let (mut first, of_first) = turning(&server, &id);
    let mut second = Hands::of(&server, &server.control);
    let (number, wanted) = request(&mut second, &mut first, &id);
    let no = json!({ "request": wanted });
    assert_eq!(first.order("keep", &id, of_first, 0, &no)["type"], "accepted");
    let kept = second.answer(number);
    assert_eq!(sentence(&kept), "session 1 keeps control of this drive");
    unwanted(&mut first);
    // withdrawn
    let (number, _) = request(&mut second, &mut first, &id);
    second.send("release", &id, &json!({}));
    assert!(sentence(&second.answer(number)).contains("withdrawn"));
    unwanted(&mut first);
    // silent: it may be abandoned. The axis goes on
    request(&mut second, &mut first, &id);
    unwanted(&mut first);
    assert!(speed(&server, &id) > 15.0, "all the time");
    // STOP
    let mut second = Hands::of(&server, &server.control);
    let (number, _) = request(&mut second, &mut first, &id);
    first.page.send(&json!({ "type": "stop" }));
    assert!(sentence(&second.answer(number)).contains("STOP"));
    rests(&server, &id);
}

#[test]
fn what_waits_when_an_axis_is_given_back_is_refused() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let mut page = Hands::of(&server, &server.control);
    // the moment at which the first one has its turn is another one each time
    for pause in 0..12 {
        let lease = lease(&page.take(&id));
        let terms = json!({ "lease": lease, "epoch": 0, "speed": 20 });
        let commands = ["enable", "velocity", "disable", "enable"];
        let sent: Vec<u64> = commands.map(|kind| page.send(kind, &id, &terms)).to_vec();
        std::thread::sleep(Duration::from_millis(pause));
        page.send("release", &id, &json!({}));
        let answers: Vec<Value> = sent.iter().map(|number| page.answer(*number)).collect();
        assert_eq!(answers[3]["type"], "refused", "{answers:?}");
        let begin = Instant::now();
        loop {
            assert!(begin.elapsed() < Duration::from_secs(10), "it is not given back");
            let axis = picture(&mut page);
            if axis.is_null() {
                break;
            }
            assert_ne!(axis["phase"], "moving", "{axis}");
        }
    }
}

#[test]
fn who_waits_has_the_axis_of_a_page_that_is_silent_or_whose_drive_has_a_fault() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let (mut first, of_first) = turning(&server, &id);
    let mut second = Hands::of(&server, &server.control);
    let (number, wanted) = request(&mut second, &mut first, &id);
    // frozen: its lease ends, and with it what it could answer
    let taken = second.answer(number);
    assert_eq!(lease(&taken), wanted, "{taken}");
    assert!(speed(&server, &id).abs() < 0.1, "at rest");
    let late = first.order("keep", &id, of_first, 0, &json!({ "request": wanted }));
    assert!(sentence(&late).contains("not have control"), "{late}");
    let enabled = second.order("enable", &id, wanted, 0, &json!({}));
    assert_eq!(enabled["type"], "accepted", "{enabled}");
    // a fault ends the operation, and the axis stands all the same
    let mut third = Hands::of(&server, &server.control);
    let (number, next) = request(&mut third, &mut second, &id);
    let fault = json!({ "drive": id, "event": "fault=439", "seconds": null });
    assert_eq!(server.post("/api/v1/plant/inject", &fault).status, 200);
    let begin = Instant::now();
    while picture(&mut second)["phase"] != "off" {
        assert!(begin.elapsed() < Duration::from_secs(10), "it is on");
        keep_alive(&mut [&mut second, &mut third]);
    }
    let yes = json!({ "request": next });
    let accepted = second.order("hand_over", &id, wanted, 0, &yes);
    assert_eq!(accepted["type"], "accepted", "{accepted}");
    assert_eq!(lease(&third.answer(number)), next);
}

#[test]
fn who_waits_has_the_axis_when_its_page_is_gone_and_it_is_at_rest() {
    let server = Running::demo();
    let id = known(&server, "axis-1");
    let (mut first, _) = turning(&server, &id);
    let mut second = Hands::of(&server, &server.control);
    let (number, wanted) = request(&mut second, &mut first, &id);
    drop(first);
    let taken = second.answer(number);
    assert_eq!(lease(&taken), wanted, "{taken}");
    assert!(speed(&server, &id).abs() < 0.1, "at rest");
    // one that is free is not waited for
    second.send("release", &id, &json!({}));
    server.logged(|log| log.iter().filter(|one| one["action"] == "release").count() == 2);
    let number = second.send("take", &id, &json!({ "purpose": "speed", "wait": true }));
    let taken = second.answer(number);
    assert!(lease(&taken) > wanted, "{taken}");
}
