//! Drives that are selected together.
#![cfg(feature = "simulate")]
#![allow(clippy::unwrap_used)]

use client::{Error, Wait};
use profidrive::fleet::{self, Fleet};
use profidrive::{Access, DriveError, Network, Opening, Selector, parameters};

const PLANT: &str = r#"
    [[drive]]
    name = "akd-10"
    ip = "192.168.0.20/24"

    [[drive]]
    name = "akd-2"
    ip = "192.168.0.12/24"

    [[drive]]
    name = "vlt-1"
    model = "vlt"
    ip = "192.168.0.31/24"

    [[drive]]
    name = "vacon-1"
    model = "vacon"
    ip = "192.168.0.41/24"

    [[drive]]
    name = "new"
"#;

fn plant(text: &str) -> (Opening, Network) {
    let opening = Opening::new(Access::Records).in_plant(text.parse().unwrap());
    let network = opening.clone().open().unwrap();
    (opening, network)
}

fn select(opening: &Opening, network: &mut Network, text: &str) -> Fleet {
    let selector: Selector = text.parse().unwrap();
    opening.select(network, &selector).wait().unwrap()
}

fn names(fleet: &Fleet) -> Vec<(&str, bool)> {
    let members = fleet.members.iter();
    members
        .map(|member| (member.name.as_str(), member.drive.is_ok()))
        .collect()
}

#[test]
fn each_way_to_select_finds_its_drives_in_order_and_once() {
    let (opening, mut network) = plant(PLANT);
    for (text, found) in [
        ("akd-*", &[("akd-2", true), ("akd-10", true)][..]),
        ("akd-10,akd-2", &[("akd-10", true), ("akd-2", true)]),
        ("model=vlt,vendor=vacon", &[("vlt-1", true), ("vacon-1", true)]),
        ("192.168.0.12,akd-*", &[("akd-2", true), ("akd-10", true)]),
        ("vlt-1,absent-1", &[("vlt-1", true), ("absent-1", false)]),
        (
            "all",
            &[
                ("akd-2", true),
                ("akd-10", true),
                ("new", false),
                ("vacon-1", true),
                ("vlt-1", true),
            ],
        ),
    ] {
        let fleet = select(&opening, &mut network, text);
        assert_eq!(names(&fleet), found, "{text}");
    }
}

#[test]
fn what_fits_nothing_and_what_has_no_address_is_said() {
    let (opening, mut network) = plant(PLANT);
    let fleet = select(&opening, &mut network, "line-*,new*");
    let errors: Vec<String> = fleet
        .members
        .iter()
        .map(|member| member.drive.as_ref().unwrap_err().to_string())
        .collect();
    assert_eq!(
        errors,
        [
            "`line-*` fits none of the stations that answered: akd-10, akd-2, new, vacon-1, vlt-1",
            "new has no IP address",
        ]
    );
}

#[test]
fn stations_of_one_name_are_not_told_apart() {
    let twins = r#"
        [[drive]]
        name = "akd-1"
        ip = "192.168.0.11/24"

        [[drive]]
        name = "akd-2"
        ip = "192.168.0.12/24"
    "#;
    let (opening, mut network) = plant(twins);
    let second = network.find(&"akd-2".parse().unwrap()).wait().unwrap();
    network.set_name(&second, "akd-1", false).wait().unwrap();
    let fleet = select(&opening, &mut network, "all");
    for member in &fleet.members {
        assert!(
            matches!(&member.drive, Err(DriveError::Client(Error::Ambiguous { macs, .. })) if macs.len() == 2),
            "{member:?}"
        );
    }
    assert_eq!(fleet.members.len(), 2);
}

#[test]
fn one_that_does_not_answer_costs_the_others_nothing() {
    let mut text = String::new();
    for number in 1..=100 {
        text += &format!("[[drive]]\nname = \"akd-{number}\"\nip = \"192.168.0.{number}/24\"\n");
        if number % 10 == 0 {
            // found, and silent from then on
            text += "event = [{ at = \"1500ms\", do = \"cable=pulled\" }]\n";
        }
    }
    let (opening, mut network) = plant(&text);
    let fleet = select(&opening, &mut network, "all");
    assert_eq!(fleet.members.len(), 100);
    network.pass(std::time::Duration::from_secs(1)).wait().unwrap();
    let begin = network.now();
    let wanted = ["DRV.ACC".parse().unwrap()];
    let work = async |session: &mut client::Session, drive: &mut client::Drive| {
        let values = parameters::read(session, drive, &wanted).await;
        values.map_err(DriveError::from)
    };
    let answers = fleet::each(&network, fleet.members, work).wait();
    let (silent, rest): (Vec<_>, Vec<_>) = answers.iter().partition(|member| member.result.is_err());
    assert_eq!((silent.len(), rest.len()), (10, 90));
    assert!(silent.iter().all(|member| member.name.ends_with('0')));
    let spent = network.now() - begin;
    let alone = {
        let begin = network.now();
        let address = "akd-1".parse().unwrap();
        let mut drive = network.find(&address).wait().unwrap();
        drive.station.ip.address = "192.168.0.10".parse().unwrap();
        parameters::read(&mut network, &mut drive, &["DRV.ACC".parse().unwrap()])
            .wait()
            .unwrap_err();
        network.now() - begin
    };
    assert!(spent < alone * 2, "{spent:?}, one alone {alone:?}");
}

/// The machine keeps one set of values: what one drive cannot take, none gets.
#[test]
fn a_write_that_one_drive_cannot_take_changes_no_drive() {
    let (opening, mut network) = plant(PLANT);
    let acceleration = |network: &mut Network| {
        let mut drive = network.find(&"akd-2".parse().unwrap()).wait().unwrap();
        let selection = drive.select("DRV.ACC").unwrap();
        network.read_one(&mut drive, &selection).wait().unwrap().number()
    };
    let wanted = parameters::Write::default();
    let plan = |network: &mut Network, selector: &str| {
        let fleet = select(&opening, network, selector);
        let assignments = ["DRV.ACC=4000rpm/s".parse().unwrap()];
        fleet::plan_write(network, fleet.members, &assignments, wanted).wait()
    };
    let mixed = plan(&mut network, "akd-2,vlt-1");
    assert_eq!((mixed.changing(), mixed.is_whole()), (1, false));
    let refused = mixed.carry_out(&network).wait().unwrap_err();
    assert!(refused.members()[1].result.is_err());
    assert_eq!(acceleration(&mut network), Some(3000.0));

    let same = plan(&mut network, "akd-*");
    assert_eq!((same.changing(), same.is_whole()), (2, true));
    let written = same.carry_out(&network).wait().unwrap();
    assert!(written.iter().all(|member| member.result.is_ok()));
    assert_eq!(acceleration(&mut network), Some(4000.0));
}

/// One that is found and answers no parameters holds up the others for two seconds, not for ten.
#[test]
fn one_without_an_answer_to_parameters_is_given_up_soon() {
    let text = PLANT.replace(
        "ip = \"192.168.0.12/24\"\n",
        "ip = \"192.168.0.12/24\"\nevent = [{ at = \"0s\", do = \"answers=silent\" }]\n",
    );
    let (opening, mut network) = plant(&text);
    let fleet = select(&opening, &mut network, "akd-*");
    let begin = network.now();
    let wanted = ["DRV.ACC".parse().unwrap()];
    let work = async |session: &mut client::Session, drive: &mut client::Drive| {
        let values = parameters::read(session, drive, &wanted).await;
        values.map_err(DriveError::from)
    };
    let answers = fleet::each(&network, fleet.members, work).wait();
    let spent = network.now() - begin;
    let answered: Vec<bool> = answers.iter().map(|member| member.result.is_ok()).collect();
    assert_eq!(answered, [false, true]);
    assert!((1.9..2.5).contains(&spent.as_secs_f64()), "{spent:?}");
}

/// The shorter time is that of the first answer: later ones have the usual time.
#[test]
fn a_drive_that_answered_has_the_usual_time() {
    let (opening, mut network) = plant(PLANT);
    let fleet = select(&opening, &mut network, "akd-2");
    let profidrive::Transport::Plant(joined) = network.transport().clone() else {
        unreachable!("a plant is in memory");
    };
    let wanted = ["DRV.ACC".parse().unwrap()];
    let work = async |session: &mut client::Session, drive: &mut client::Drive| {
        parameters::read(session, drive, &wanted).await?;
        let late = "answers=late 3s".parse().unwrap();
        joined
            .with_world(|world| world.inject("akd-2", late, None))
            .unwrap();
        let values = parameters::read(session, drive, &wanted).await;
        values.map_err(DriveError::from)
    };
    let answers = fleet::each(&network, fleet.members, work).wait();
    assert!(answers[0].result.is_ok(), "{:?}", answers[0].result);
}
