//! What a controller expects in slot 1 and the drive does not have is reported in the ModuleDiffBlock, never refused;
//! what is right beside it works, and the next right Connect works.

use profinet::controller::{ModuleConfig, SubmoduleConfig};
use profinet::wire::block::{DiffModule, DiffSubmodule, ModuleState, SubmoduleState};
use system_tests::bus::{Bus, modules};
use virtual_drive::model::AKD;

const NOT_THERE: u32 = 0x0BAD_1DEA;

fn drive_module(modules: &mut [ModuleConfig]) -> &mut ModuleConfig {
    &mut modules[1]
}

fn submodule(modules: &mut [ModuleConfig]) -> &mut SubmoduleConfig {
    &mut modules[1].submodules[0]
}

fn diff_of(change: impl Fn(&mut Vec<ModuleConfig>)) -> (Bus, Vec<DiffModule>) {
    let mut wish = modules(9);
    change(&mut wish);
    let mut bus = Bus::new();
    let (diff, running) = bus.connect_as(wish);
    assert!(running, "the frames of the access point are exchanged");
    (bus, diff.expect("a difference").modules)
}

/// The controller that wants what there is gets it, on the same drive; the dissector finds nothing wrong in all of it.
#[track_caller]
fn works_afterwards(mut bus: Bus, name: &str) {
    bus.release();
    bus.connect(9);
    assert_eq!(bus.read(922, 0), 9);
    assert_eq!(
        bus.send(&[&[0x04, 0x7E][..], &[0; 18]].concat(), 4)[..2],
        [0x02, 0x31]
    );
    bus.judged(name);
}

#[test]
fn a_module_that_does_not_exist() {
    let (bus, diff) = diff_of(|modules| drive_module(modules).ident = NOT_THERE);
    let [module] = &diff[..] else { panic!("{diff:?}") };
    assert_eq!((module.api, module.slot), (0x3A00, 1));
    // The drive has telegram 1 there until a controller chooses another.
    assert_eq!(
        (module.ident, module.state),
        (
            AKD.catalogue.device.telegram(1).unwrap().module,
            ModuleState::WRONG
        )
    );
    assert!(module.submodules.is_empty());
    works_afterwards(bus, "modules-a-module-that-does-not-exist");
}

#[test]
fn the_access_point_in_slot_1() {
    let (bus, diff) =
        diff_of(|modules| drive_module(modules).ident = AKD.catalogue.device.access_point_module);
    assert_eq!(
        (diff.len(), diff[0].slot, diff[0].state),
        (1, 1, ModuleState::WRONG)
    );
    works_afterwards(bus, "modules-the-access-point-in-slot-1");
}

#[test]
fn a_telegram_in_a_slot_that_the_drive_does_not_have() {
    let (bus, diff) = diff_of(|modules| drive_module(modules).slot = 2);
    assert_eq!(
        (diff.len(), diff[0].slot, diff[0].ident, diff[0].state),
        (1, 2, 0, ModuleState::NO_MODULE)
    );
    works_afterwards(bus, "modules-a-telegram-in-a-slot-that-the-drive-does-not-have");
}

#[test]
fn a_wrong_submodule_a_wrong_length_and_a_wrong_api() {
    let real = AKD.catalogue.device.telegram(9).unwrap();
    type Change = fn(&mut Vec<ModuleConfig>);
    let changes: [Change; 5] = [
        |modules| submodule(modules).ident = NOT_THERE,
        |modules| submodule(modules).output_length -= 2,
        |modules| submodule(modules).input_length += 2,
        |modules| submodule(modules).input_length = 0,
        |modules| drive_module(modules).api = 0,
    ];
    for (number, change) in changes.into_iter().enumerate() {
        let (bus, diff) = diff_of(change);
        let [module] = &diff[..] else {
            panic!("{number}: {diff:?}")
        };
        assert_eq!(
            (module.slot, module.ident, module.state),
            (1, real.module, ModuleState::PROPER),
            "{number}"
        );
        let expected = DiffSubmodule {
            subslot: 1,
            ident: real.submodule,
            state: SubmoduleState::WRONG,
        };
        assert_eq!(module.submodules, [expected], "{number}");
        works_afterwards(bus, &format!("modules-wrong-{number}"));
    }
}

#[test]
fn a_subslot_that_the_module_does_not_have() {
    let (bus, diff) = diff_of(|modules| submodule(modules).subslot = 2);
    let expected = DiffSubmodule {
        subslot: 2,
        ident: 0,
        state: SubmoduleState::NO_SUBMODULE,
    };
    assert_eq!(
        (diff.len(), diff[0].state, &diff[0].submodules[..]),
        (1, ModuleState::PROPER, &[expected][..])
    );
    works_afterwards(bus, "modules-a-subslot-that-the-module-does-not-have");
}

#[test]
fn one_right_and_one_wrong_submodule() {
    let (mut bus, diff) = diff_of(|modules| {
        let mut extra = *submodule(modules);
        extra.subslot = 7;
        drive_module(modules).submodules.push(extra);
    });
    assert_eq!(
        (
            diff.len(),
            diff[0].submodules.len(),
            diff[0].submodules[0].subslot
        ),
        (1, 1, 7)
    );
    let inputs = bus.send(&[&[0x04, 0x7E][..], &[0; 18]].concat(), 4);
    assert_eq!(inputs[..2], [0x02, 0x31], "subslot 1 is exchanged");
    works_afterwards(bus, "modules-one-right-and-one-wrong-submodule");
}

#[test]
fn a_drive_without_its_telegram_does_not_run_and_raises_nothing() {
    let (mut bus, _) = diff_of(|modules| submodule(modules).ident = NOT_THERE);
    bus.run(std::time::Duration::from_secs(2));
    let drive = bus.station().drive();
    assert!(!drive.is_enabled() && !drive.has_fault());
    bus.judged("modules-without-telegram");
}

#[test]
fn no_module_in_slot_1_at_all() {
    let mut bus = Bus::new();
    let mut wish = modules(1);
    wish.truncate(1);
    let (diff, running) = bus.connect_as(wish);
    assert_eq!(
        (diff, running),
        (None, true),
        "nothing is wrong with what is expected"
    );
    assert!(!bus.station().drive().has_fault());
    works_afterwards(bus, "modules-no-module-in-slot-1-at-all");
}
