//! A machine of eight drives of three vendors, commissioned from a file by a program that is killed.

use std::path::Path;
use std::time::{Duration, Instant};

use system_tests::{Lab, Running, Side, built, client, simulate};

/// Station name, model and last octet of the address of each drive.
const DRIVES: [(&str, &str, u8); 8] = [
    ("akd-1", "akd", 51),
    ("akd-2", "akd", 52),
    ("akd-3", "akd", 53),
    ("akd-4", "akd", 54),
    ("vlt-1", "vlt", 61),
    ("vlt-2", "vlt", 62),
    ("vacon-1", "vacon", 71),
    ("vacon-2", "vacon", 72),
];
/// What a person waits for one command on a machine of this size.
const LONGEST: Duration = Duration::from_secs(3);

/// The drives, as they were when they were switched off.
fn switched_on(lab: &Lab) -> [Running; 3] {
    [("akd", "4", "51"), ("vlt", "2", "61"), ("vacon", "2", "71")].map(|(model, count, last)| {
        let (name, ip) = (format!("{model}-1"), format!("192.168.77.{last}/24"));
        let state = lab.folder().join(model);
        let state = state.to_str().unwrap();
        simulate(
            lab,
            &[
                "--model", model, "--name", &name, "--count", count, "--ip", &ip, "--state", state,
            ],
        )
    })
}

/// The machine with ramps of this time, s.
fn machine(ramp: u32) -> String {
    let drive = |(name, model, last)| {
        let parameters = match model {
            "akd" => format!(
                "\"DRV.ACC\" = \"{0}rpm/s\"\n\"DRV.DEC\" = \"{0}rpm/s\"",
                1000 * ramp
            ),
            "vlt" => format!("\"3-41\" = \"{ramp}s\"\n\"3-42\" = \"{ramp}s\""),
            _ => format!("ID103 = \"{ramp}s\"\nID104 = \"{ramp}s\""),
        };
        format!(
            "[[drive]]\nname = \"{name}\"\nmodel = \"{model}\"\nip = \"192.168.77.{last}/24\"\ngroups = [\"{model}s\"]\n\
             [drive.parameters]\n{parameters}\n"
        )
    };
    DRIVES.map(drive).concat()
}

fn notes(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    entries
        .filter(|path| path.extension().is_some_and(|end| end == "unfinished"))
        .count()
}

#[test]
fn a_machine_is_commissioned_by_a_program_that_is_killed() {
    let lab = Lab::new("machine");
    let folder = lab.folder().join("machine");
    std::fs::create_dir(&folder).unwrap();
    let file = folder.join("machine.toml");
    std::fs::write(&file, machine(2)).unwrap();
    let file = file.to_str().unwrap();
    let drives = switched_on(&lab);

    let quick = |arguments: &[&str]| {
        let begin = Instant::now();
        let finished = client(&lab, arguments);
        let took = begin.elapsed();
        assert!(took < LONGEST, "{arguments:?} took {took:?}");
        finished
    };
    quick(&["commission", file, "--yes"]).ok();
    let again = quick(&["commission", file, "--yes"]).ok();
    assert!(again.err.contains("nothing to change"), "{again:?}");

    // killed at moments over the whole run: while it searches, while it writes, while it saves
    let mut amid = 0;
    for number in 0..8_u32 {
        std::fs::write(file, machine(3 + number)).unwrap();
        let arguments = ["-i", Side::Controller.interface(), "commission", file, "--yes"];
        let mut run = lab.spawn(Side::Controller, built("profidrive"), arguments);
        let until = Instant::now() + Duration::from_millis(1000 + u64::from(number) * 60);
        while Instant::now() < until && run.status().is_none() {
            std::thread::yield_now();
        }
        run.kill();
        amid += usize::from(notes(&folder) > 0);
        client(&lab, &["commission", file, "--yes"]).ok();
        assert_eq!(notes(&folder), 0);
        client(&lab, &["diff", file, "all"]).ok();
    }
    println!("{amid} of 8 kills left drives unfinished");

    // the values are saved: the drives have them when they are switched on again
    for drives in drives {
        drives.interrupt(Duration::from_secs(5)).ok();
    }
    let _drives = switched_on(&lab);
    quick(&["diff", file, "all"]).ok();

    let read = quick(&["read", "@vlts", "3-41", "--machine", file]).ok();
    assert!(
        read.out.contains("vlt-1") && read.out.contains("vlt-2") && !read.out.contains("akd"),
        "{read:?}"
    );
    client(&lab, &["write", "akd-2", "DRV.ACC=100rpm/s"]).ok();
    let drift = quick(&["diff", file, "all"]);
    assert_eq!(drift.code, Some(5), "{drift:?}");
    assert!(
        drift.out.contains("akd-2") && drift.err.contains("1 of 8 drives"),
        "{drift:?}"
    );

    // one drive of another model: an error with its line, and nothing is changed on any drive
    let wrong = machine(30).replacen("model = \"vlt\"", "model = \"akd\"", 1);
    let wrong = wrong.replacen("\"3-41\" = \"30s\"\n\"3-42\" = \"30s\"", "", 1);
    std::fs::write(file, wrong).unwrap();
    let refused = quick(&["commission", file, "--yes"]);
    assert_eq!(refused.code, Some(6), "{refused:?}");
    assert!(
        refused
            .err
            .contains("vlt-1 (line 34): the file says AKD, the drive is VLT"),
        "{refused:?}"
    );
    assert!(refused.err.contains("nothing was changed"), "{refused:?}");
    let unchanged = client(&lab, &["read", "akd-1", "DRV.ACC", "--json"]).ok();
    assert!(!unchanged.out.contains("30000"), "{unchanged:?}");
}
