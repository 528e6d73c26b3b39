//! Settings saved and brought back.

use profidrive_client::Wait;
use profidrive_client::change::Saved;
use profile::parameter::{Keep, ParameterAccess};

use super::*;

#[test]
fn settings_go_there_and_back() {
    for (at, (name, way)) in NAMES.into_iter().zip(WAYS).enumerate() {
        let mut session = all_models();
        let mut drive = find(&mut session, name).expect("there");
        let first = session.backup(&mut drive, &mut |_, _| {}).wait().expect("saved");
        assert!(first.readings().len() > 30, "{name}: {}", first.readings().len());
        let text = first.to_string();
        assert!(text.contains(&format!("\n{} ", way.shown)), "{text}");
        assert_eq!(
            Backup::read(&text).expect("read back").to_string(),
            text,
            "{name}"
        );
        let change = format!("{}=7.5", way.ramp);
        write(&mut session, &mut drive, &change, WriteMode::Write).expect("taken");
        let changed = session.backup(&mut drive, &mut |_, _| {}).wait().expect("saved");
        let differences = compare(&first, &changed);
        assert_eq!(differences.len(), 1, "{name}: {differences:?}");
        let mut plan = session
            .plan(&mut drive, &first, &Choice::default())
            .wait()
            .expect("a plan");
        assert_eq!(plan.set.changes().len(), 1, "{name}");
        let set = &mut plan.set;
        set.save(&drive).expect("a way to save");
        session
            .apply(&mut drive, set)
            .wait()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(set.is_done(), "{name}: {set}");
        let last = session.backup(&mut drive, &mut |_, _| {}).wait().expect("saved");
        assert_eq!(last.to_string(), text, "{name} {at}");
    }
}

/// A VLT whose option does not know request 0x42; only PROFIBUS manuals name it.
fn vlt_without_request() -> &'static model::Model {
    static DIALECT: Dialect = Dialect {
        requests: &[RequestId::Read, RequestId::Change],
        ..Dialect::VLT
    };
    static KNOWN: Model = Model {
        dialect: &DIALECT,
        ..profile::model::VLT
    };
    Box::leak(Box::new(model::Model {
        known: &KNOWN,
        derived: std::sync::OnceLock::new(),
        ..model::VLT
    }))
}

/// A VLT saves by 9-71 what a request cannot.
#[test]
fn values_are_saved_by_a_parameter_where_the_request_that_saves_is_unknown() {
    for (model, saves) in [(vlt_without_request(), true), (&model::VLT, false)] {
        let (mut session, _) = bench_of(vec![station_of(model, "vlt-1", 1, None)]);
        let mut drive = find(&mut session, "vlt-1").expect("there");
        let outcomes = session
            .write(&mut drive, &[assign("3-41=7.5")], WriteMode::Save)
            .wait()
            .expect("saved");
        assert!(
            outcomes.is_done() && outcomes.saved() == Saved::Yes,
            "{outcomes:?}"
        );
        let command = outcomes.save_command().map(|command| command.selection.pnu);
        assert_eq!(command, saves.then_some(971));
    }
}

/// What `restore --save` brings back is there after a restart too, whether or not the drive has a request that saves.
#[test]
fn what_a_restore_saves_survives_a_restart() {
    for model in [vlt_without_request(), &model::VLT] {
        for save in [false, true] {
            let (mut session, ids) = bench_of(vec![station_of(model, "vlt-1", 1, None)]);
            let mut drive = find(&mut session, "vlt-1").expect("there");
            write(&mut session, &mut drive, "3-41=7.5", WriteMode::Write).expect("taken");
            let wanted = session.backup(&mut drive, &mut |_, _| {}).wait().expect("read");
            write(&mut session, &mut drive, "3-41=9", WriteMode::Save).expect("saved");
            let mut plan = session
                .plan(&mut drive, &wanted, &Choice::default())
                .wait()
                .expect("a plan");
            let set = &mut plan.set;
            if save {
                set.save(&drive).expect("a way to save");
            }
            session.apply(&mut drive, set).wait().expect("restored");
            assert_eq!(set.saved() == Saved::Yes, save, "{set}");
            with_drive(&session, ids[0], |drive| {
                drive.write(972, 0, 1, Keep::Volatile).expect("restarts");
            });
            session
                .pass(Duration::from_secs(5))
                .wait()
                .expect("a segment cannot fail");
            let mut drive = find(&mut session, "vlt-1").expect("there again");
            let expected = if save { 7.5 } else { 9.0 };
            assert_eq!(number(&mut session, &mut drive, "3-41"), expected, "{save}");
        }
    }
}
