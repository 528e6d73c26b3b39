//! What survives, and what does not.

use super::tests::Bench;
use super::*;
use crate::model::AKD;
use crate::store::Image;
use profile::catalogue::Access;
use profile::parameter::ErrorNumber;

/// Returns the text that the drive emits for saving.
fn saved(bench: &mut Bench) -> Option<String> {
    bench.events().into_iter().rev().find_map(|event| match event {
        Event::Save { text, .. } => Some(text),
        _ => None,
    })
}

/// Returns a new drive of the same model that starts with the text.
fn restarted(text: &str) -> Bench {
    let mut bench = Bench::new();
    assert_eq!(bench.drive.start_with(text.as_bytes()), Ok(0));
    bench
}

#[test]
fn only_what_is_marked_and_saved_survives() {
    let mut bench = Bench::new();
    let (mut changed, mut kept) = (0, 0);
    let mut expected = Vec::new();
    for (position, parameter) in AKD.catalogue.parameters.iter().enumerate() {
        let stored = matches!(bench.drive.live[position], Live::Stored);
        let free = parameter.access == Access::ReadWrite && stored && !parameter.is_array();
        // Scalings would change the meaning of the others' limits.
        if !free || parameter.name.contains("SCALING") || parameter.name.contains("POSSCALE") {
            continue;
        }
        let before = bench.drive.element(position, 0).unwrap();
        let other = [before + 1, before - 1]
            .into_iter()
            .find(|raw| bench.drive.set_element(position, 0, *raw).is_ok());
        let Some(other) = other else { continue };
        changed += 1;
        kept += usize::from(parameter.saved);
        expected.push((position, if parameter.saved { other } else { before }));
    }
    assert!(changed > 400 && kept > 300 && kept < changed, "{changed} {kept}");
    assert!(saved(&mut bench).is_none(), "nothing is saved without DRV.NVSAVE");
    bench.write("DRV.NVSAVE", 1).unwrap();
    let text = saved(&mut bench).unwrap();
    let bench = restarted(&text);
    for (position, raw) in expected {
        let parameter = &AKD.catalogue.parameters[position];
        assert_eq!(bench.drive.element(position, 0), Ok(raw), "{parameter:?}");
    }
}

#[test]
fn load_and_reset_do_not_change_saved_values() {
    let mut bench = Bench::new();
    bench.write("DRV.ACC", 5_000_000).unwrap();
    bench.write("DRV.NVSAVE", 1).unwrap();
    let text = saved(&mut bench).unwrap();
    bench.write("DRV.ACC", 6_000_000).unwrap();
    bench.write("DRV.NVLOAD", 1).unwrap();
    assert_eq!(bench.read("DRV.ACC"), 5_000_000);
    bench.write("DRV.RSTVAR", 1).unwrap();
    assert_eq!(bench.read("DRV.ACC"), 3_000_000);
    assert!(saved(&mut bench).is_none());
    bench.write("DRV.NVLOAD", 1).unwrap();
    assert_eq!(bench.read("DRV.ACC"), 5_000_000);
    assert_eq!(restarted(&text).read("DRV.ACC"), 5_000_000);
    bench.run(163);
    for command in ["DRV.NVLOAD", "DRV.RSTVAR"] {
        assert_eq!(bench.write(command, 1), Err(ErrorNumber::NOT_NOW));
    }
    bench.write("DRV.NVSAVE", 1).unwrap(); // may be saved at any time
}

#[test]
fn a_drive_that_never_saved_loads_what_it_was_delivered_with() {
    let mut bench = Bench::new();
    bench.write("DRV.ACC", 5_000_000).unwrap();
    bench.write("DRV.NVLOAD", 1).unwrap();
    assert_eq!(bench.read("DRV.ACC"), 3_000_000);
}

#[test]
fn values_are_saved_in_the_units_of_their_own_scaling() {
    let mut bench = Bench::new();
    bench.write("PN.VELSCALING", 1000).unwrap();
    bench.write("PN.ACCSCALING", 20).unwrap();
    bench.write("Jog v1", 2731).unwrap();
    bench.write("Jog Acc", 25).unwrap();
    bench.write("SWLS.LIMIT0", -(1 << 40)).unwrap();
    bench.write("DRV.NVSAVE", 1).unwrap();
    let text = saved(&mut bench).unwrap();
    for line in [
        "\nJog Acc = 500 # rpm/s\n",
        "\nJog v1 = 1000 # rpm\n",
        "\nSWLS.LIMIT0 = -1099511627776 # counts\n",
    ] {
        assert!(text.contains(line), "{line}");
    }
    let bench = restarted(&text);
    assert_eq!((bench.read("Jog v1"), bench.read("Jog Acc")), (2731, 25));
    assert_eq!(bench.read("SWLS.LIMIT0"), -(1 << 40));
}

#[test]
fn what_does_not_fit_is_left_out_and_counted() {
    let mut image = Image::new("AKD");
    image.push_text("DRV.ACC", "1.000"); // below its limit
    image.push_text("PN.VELSCALING", "2001");
    image.push_text("Jog v1", "60");
    image.push_text("DRV.NVSAVE", "1");
    let mut bench = Bench::new();
    assert_eq!(bench.drive.start_with(image.encode().as_bytes()), Ok(3));
    assert_eq!(
        (bench.read("DRV.ACC"), bench.read("PN.VELSCALING")),
        (3_000_000, 1638)
    );
    assert_eq!(bench.read("Jog v1"), 164);
}

#[test]
fn an_address_set_by_dcp_overwrites_the_mode_and_nothing_else() {
    let mut bench = Bench::new();
    assert!(bench.drive.address_source() == AddressSource::Stored);
    bench.drive.address_set();
    assert!(saved(&mut bench).is_none(), "nothing to overwrite");
    bench.write("IP.MODE", 0).unwrap();
    bench.write("DRV.NVSAVE", 1).unwrap();
    assert!(restarted(&saved(&mut bench).unwrap()).drive.address_source() == AddressSource::Found);
    bench.write("DRV.ACC", 5_000_000).unwrap(); // changed, not saved
    bench.drive.address_set();
    assert_eq!(bench.read("IP.MODE"), 1);
    let restarted = restarted(&saved(&mut bench).unwrap());
    assert!(restarted.drive.address_source() == AddressSource::Stored);
    assert_eq!(restarted.read("DRV.ACC"), 3_000_000);
}

#[test]
fn motion_tasks_are_kept_like_parameters() {
    let mut bench = Bench::new();
    for (name, raw) in [
        ("MT.NUM", 5),
        ("MT.P", 655_360),
        ("MT.V", 300_000),
        ("MT.ACC", 3_000_000),
        ("MT.DEC", 2_000_000),
        ("MT.TNEXT", 250),
        ("MT.SET", 1),
    ] {
        bench.write(name, raw).unwrap();
    }
    bench.write("DRV.NVSAVE", 1).unwrap();
    let text = saved(&mut bench).unwrap();
    assert!(
        text.contains("\nMT[5] = P 10rev, V 300rpm, ACC 3000rpm/s, "),
        "{text}"
    );
    bench.write("MT.CLEAR", 5).unwrap();
    for mut bench in [bench, restarted(&text)] {
        bench.write("DRV.NVLOAD", 1).unwrap();
        bench.write("MT.NUM", 5).unwrap();
        bench.write("MT.LOAD", 1).unwrap();
        let task = ["MT.P", "MT.V", "MT.DEC", "MT.TNEXT"].map(|name| bench.read(name));
        assert_eq!(task, [655_360, 300_000, 2_000_000, 250]);
        bench.write("DRV.RSTVAR", 1).unwrap();
        bench.write("MT.NUM", 5).unwrap();
        bench.write("MT.LOAD", 1).unwrap();
        assert_eq!(bench.read("MT.V"), 0, "as delivered there is none");
    }
}
