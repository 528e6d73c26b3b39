//! Parameters of drives in a plant in memory: read, listed, described and written by one call each.
#![cfg(feature = "simulate")]

use profidrive::client::change::Persistence;
use profidrive::client::{Action, Drive, ErrorKind};
use profidrive::parameters::{self, List, ParameterError, Write};
use profidrive::report::{PlainWording, TelegramLayout};
use profidrive::{Network, Outcome, Wait};

const PLANT: &str = r#"
[[drive]]
name = "akd-1"
ip = "10.0.0.1/24"
"#;

fn open(name: &str) -> (Network, Drive) {
    let mut network = profidrive::open_plan(PLANT.parse().expect("a plant")).expect("opens");
    let drive = network
        .find(&name.parse().expect("a name"))
        .wait()
        .expect("there");
    (network, drive)
}

fn list(wanted: &List) -> Result<profidrive::report::ListReport, ParameterError> {
    let (mut network, mut drive) = open("akd-1");
    let mut steps = Vec::new();
    let mut progress = |done, all| steps.push((done, all));
    let listed = parameters::list(&mut network, &mut drive, wanted, &PlainWording, &mut progress).wait();
    if let Ok(report) = &listed
        && wanted.values
    {
        let all = report.values.len();
        assert_eq!(
            (steps.first(), steps.last()),
            (Some(&(0, all)), Some(&(all, all)))
        );
    }
    listed
}

#[test]
fn parameters_are_listed_with_and_without_values() {
    let described = list(&List::default()).expect("listed");
    assert!(described.parameters.len() > 700 && described.values.is_empty());
    let wanted = List {
        filter: Some("DRV.ACC".into()),
        values: true,
    };
    let valued = list(&wanted).expect("listed");
    assert!(valued.parameters.is_empty());
    let found = valued
        .values
        .iter()
        .find(|value| value.name.as_deref() == Some("DRV.ACC"));
    assert_eq!(found.expect("there").text.as_deref(), Some("3000"));
    let nothing = List {
        filter: Some("nothing like it".into()),
        values: false,
    };
    let error = list(&nothing).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unsupported);
    assert_eq!(
        error.to_string(),
        "no parameter of the AKD matches `nothing like it`"
    );
}

#[test]
fn the_places_in_a_telegram_have_the_parameters_with_the_same_values() {
    let plant = "[[drive]]\nname = \"akd-1\"\nip = \"192.168.0.11/24\"\n\
                 [[drive]]\nname = \"akd-2\"\nip = \"192.168.0.12/24\"\nparameters = { 922 = 400, 930 = 2 }\n\
                 [[drive]]\nname = \"vlt-1\"\nmodel = \"vlt\"\nip = \"192.168.0.13/24\"\n\
                 [[drive]]\nname = \"vlt-2\"\nmodel = \"vlt\"\nip = \"192.168.0.14/24\"\nparameters = { \"9-22\" = 102, \"9-16[2]\" = 1614 }";
    let mut network = profidrive::open_plan(plant.parse().expect("a plant")).expect("opens");
    let mut layout = |name: &str| {
        let mut drive = network
            .find(&name.parse().expect("a name"))
            .wait()
            .expect("there");
        parameters::layout(&mut network, &mut drive).wait().expect("read")
    };
    let places = |layout: &TelegramLayout| -> Vec<String> {
        let all = layout.places.iter().map(|place| {
            let signal = place.signal.unwrap_or("-");
            let (direction, octet, octets) = (place.direction, place.octet, place.octets);
            format!(
                "{direction} {octet}+{octets} {signal} {}",
                place.parameters.join(" ")
            )
        });
        all.map(|line| line.trim_end().to_owned()).collect()
    };
    let all = ["akd-1", "akd-2", "vlt-1", "vlt-2"].map(|name| {
        let layout = layout(name);
        (layout.telegram, places(&layout))
    });
    let of = |telegram, places: &[&str]| {
        let places: Vec<String> = places.iter().map(|place| (*place).to_owned()).collect();
        (Some(telegram), places)
    };
    let expected = [
        of(
            1,
            &[
                "setpoint 0+2 STW1 r0001",
                "setpoint 2+2 NSOLL_A p0005",
                "actual 0+2 ZSW1 r0002",
                "actual 2+2 NIST_A r0006 r2428",
            ],
        ),
        // as its settings have it (PNU 915 and 916)
        of(
            400,
            &[
                "setpoint 0+2 STW1 r0001",
                "setpoint 2+2 SATZANW p0032",
                "setpoint 4+2 STW2",
                "setpoint 6+4 MDI_TARPOS p0034",
                "setpoint 10+4 MDI_VELOCITY p0035",
                "setpoint 14+2 MDI_ACC p0036",
                "setpoint 16+2 MDI_DEC p0037",
                "setpoint 18+2 MDI_MOD p0038",
                "actual 0+2 ZSW1 r0002",
                "actual 2+2 AKTSATZ r0033",
                "actual 4+2 ZSW2",
                "actual 6+4 XIST_A r0028",
            ],
        ),
        of(
            1,
            &[
                "setpoint 0+2 STW1",
                "setpoint 2+2 NSOLL_A",
                "actual 0+2 ZSW1",
                "actual 2+2 NIST_A 16-17",
            ],
        ),
        // behind the parameter channel, with a word that 9-16 chooses
        of(
            102,
            &[
                "setpoint 8+2 STW1",
                "setpoint 10+2 NSOLL_A",
                "actual 8+2 ZSW1",
                "actual 10+2 NIST_A 16-17",
                "actual 12+2 - 16-14",
            ],
        ),
    ];
    assert_eq!(all, expected);
}

#[test]
fn the_high_half_of_a_value_leads_to_the_whole() {
    let (mut network, mut drive) = open("akd-1");
    let high = "2109".parse().expect("a number");
    let error = parameters::describe(&mut network, &mut drive, &high)
        .wait()
        .unwrap_err();
    let expected = Action::Describe {
        parameter: "DRV.ACC".into(),
    };
    assert_eq!(
        error.advice().actions().collect::<Vec<_>>(),
        [&expected],
        "{error}"
    );
    let whole = "DRV.ACC".parse().expect("a name");
    let known = parameters::describe(&mut network, &mut drive, &whole)
        .wait()
        .expect("described");
    assert_eq!(known.readings.len(), 1);
    let report = known.report(&drive, &PlainWording);
    assert_eq!(report.scaling.as_deref(), Some("raw 1000 = 1 rpm/s"));
}

#[test]
fn what_is_written_is_read_back_and_outlives_power_or_not() {
    let (mut network, mut drive) = open("akd-1");
    let assignments = ["DRV.ACC=4000", "922=1"].map(|text| text.parse().expect("an assignment"));
    let look = Write {
        dry_run: true,
        ..Write::default()
    };
    let planned = parameters::write(&mut network, &mut drive, &assignments, look)
        .wait()
        .expect("planned");
    assert_eq!(
        (planned.affected_controller(), planned.outcome()),
        (None, Outcome::Complete)
    );
    let acceleration = ["DRV.ACC".parse().expect("a name")];
    let value = |network: &mut Network, drive: &mut Drive| {
        let values = parameters::read(network, drive, &acceleration)
            .wait()
            .expect("read");
        values.readings[0].as_ref().expect("readable").number()
    };
    assert_eq!(
        value(&mut network, &mut drive),
        Some(3000.0),
        "a dry run writes nothing"
    );
    let written = parameters::write(&mut network, &mut drive, &assignments[..1], Write::default());
    let written = written.wait().expect("written");
    let kept = written.set.kept();
    assert_eq!(kept.with_set.len(), 1);
    assert!(
        matches!(kept.persistence, Persistence::NotRequested),
        "{:?}",
        kept.persistence
    );
    assert!(written.problems("akd-1").is_empty());
    assert_eq!(value(&mut network, &mut drive), Some(4000.0));
    // a parameter that can only be read
    let refused = ["VL.FB=1".parse().expect("an assignment")];
    let error = parameters::write(&mut network, &mut drive, &refused, Write::default()).wait();
    let error = error.map(|_| ()).unwrap_err();
    assert!(error.to_string().contains("VL.FB"), "{error}");
}

/// What every front end shows of values that do not reach the drive as they were written.
#[test]
fn a_rounded_value_and_a_raw_one_are_remarks() {
    let (mut network, mut drive) = open("akd-1");
    let assignments = ["1004=99rpm", "DRV.ACC=5000rpm/s", "DRV.DEC=0x300000"].map(|text| text.parse());
    let assignments = assignments.map(|assignment| assignment.expect("an assignment"));
    let written = parameters::write(&mut network, &mut drive, &assignments, Write::default()).wait();
    let sentences: Vec<String> = written
        .expect("written")
        .of_values()
        .into_iter()
        .map(|remark| remark.sentence)
        .collect();
    assert_eq!(
        sentences,
        [
            "Jog v1 (p1004): 99 rpm -> 98.877 rpm, rounded to the nearest representable value",
            "DRV.DEC (p2115): 0x300000 is the raw value, that is 3145.728 rpm/s"
        ]
    );
}
