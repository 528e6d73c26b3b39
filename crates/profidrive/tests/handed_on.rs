//! What a front end hands on to other programs as it is.
#![cfg(feature = "simulate")]
#![allow(clippy::unwrap_used, reason = "it is a test")]

use std::time::Duration;

use profidrive::client::status::diagnose;
use profidrive::client::{Action, Advice, Choice, ErrorKind};
use profidrive::motion::{self, AxisState, Hold, Observer};
use profidrive::{FindEvent, Wait, open_plan};
use serde_json::{Value, json};

fn value(of: &impl serde::Serialize) -> Value {
    serde_json::to_value(of).unwrap()
}

#[test]
fn kinds_actions_and_advice_are_their_names() {
    let advice = Advice::from("{stop} brings it to rest").then(Action::Choose(Choice::Save).into());
    assert_eq!(
        value(&advice),
        json!([
            {"action": "stop", "arguments": []},
            " brings it to rest",
            "; ",
            {"action": "choose", "arguments": ["save"]},
        ])
    );
    assert_eq!(value(&ErrorKind::NotReached), "not_reached");
    let learning = FindEvent::Learning { done: 1, all: 2 };
    assert_eq!(
        value(&learning),
        json!({"event": "learning", "is": {"done": 1, "all": 2}})
    );
    let address = "akd-1".parse().unwrap();
    let looking = FindEvent::LookingFor(&address);
    assert_eq!(value(&looking), json!({"event": "looking_for", "is": "akd-1"}));
}

#[test]
fn samples_states_and_diagnoses_of_an_axis_serialise() {
    let plant = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
    let mut network = open_plan(plant.parse().unwrap()).unwrap();
    let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
    let diagnosis = value(&diagnose(&network.status(&mut drive).wait().unwrap()));
    assert_eq!(
        (&diagnosis["verdict"], &diagnosis["cause"]),
        (&json!("waits"), &json!("no-controller"))
    );
    let hold = Hold::for_speed();
    let mut axis = motion::hold(&mut network, &mut drive, &hold, &Observer::default())
        .wait()
        .unwrap();
    let mut samples = axis.samples(100);
    axis.enable().wait().unwrap();
    axis.pass(Duration::from_millis(100)).wait().unwrap();
    let sample = value(&std::iter::from_fn(|| samples.take()).last().unwrap());
    assert_eq!((&sample["stw1"], &sample["missed"]), (&json!(0x047F), &json!(0)));
    assert_eq!(sample["inputs"].as_array().map(Vec::len), Some(4));
    let state = value(&AxisState::from(&axis.status().unwrap()));
    assert_eq!(state["speed_actual"]["unit"], "rpm");
    axis.release().wait().unwrap();
}
