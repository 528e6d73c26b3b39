//! Which new values outlive the power of the drive.

use client::change::{Change, ChangeSet, Kept, Persistence, Step};
use client::{Action, Choice};
use dissect::value;

use crate::{Remark, listed};

/// Returns which of the values that were written are lost at the next power cycle, and which are not.
#[must_use]
pub fn lasting(set: &ChangeSet) -> Vec<Remark> {
    let Kept {
        with_set,
        by_itself,
        lost,
        persistence,
    } = set.kept();
    let names =
        |changes: &[&Change]| -> Vec<String> { changes.iter().map(|change| change.label()).collect() };
    let (mut with_set, by_itself, lost) = (names(&with_set), names(&by_itself), names(&lost));
    let tasks = set.tasks().iter().filter(|task| task.step.is_written());
    with_set.extend(tasks.map(|task| format!("MT[{}]", task.number)));
    let only = by_itself.is_empty() && lost.is_empty();
    let mut remarks = Vec::new();
    // what the drive had before can be saved too
    let saved = !matches!(
        persistence,
        Persistence::EveryWrite | Persistence::NotRequested | Persistence::NotAsPlanned
    );
    if !with_set.is_empty() || (saved && only) {
        remarks.push(of_most(&with_set, only, persistence));
    }
    if !by_itself.is_empty() {
        remarks.push(Remark::news(format!(
            "saved in the drive: {} (at a serial line it saves text with every write)",
            listed(&by_itself)
        )));
    }
    if !lost.is_empty() {
        let which = if lost.len() == 1 { "it" } else { "them" };
        let sentence = format!(
            "not saved: {} lost at the next power cycle, the drive cannot save {which}",
            with_verb(&lost)
        );
        remarks.push(match set.is_to_be_saved() {
            true => Remark::warning(sentence),
            false => Remark::news(sentence),
        });
    }
    remarks
}

/// Returns each change in one line, as for a log: `DRV.ACC (p2108): 3000 rpm/s -> 8000 rpm/s`, behind it how far it is where that is
/// more than planned.
#[must_use]
pub fn in_lines(set: &ChangeSet) -> Vec<String> {
    let reached = |step: &Step| match step {
        Step::NotWritten => String::new(),
        other => format!(", {other}"),
    };
    let line = |change: &Change| {
        let (new, reached) = (value::full(&change.new), reached(&change.step));
        match &change.old {
            Some(Ok(old)) => format!("{}: {} -> {new}{reached}", change.label(), value::full(old)),
            _ => format!("{}: {new}{reached}", change.label()),
        }
    };
    let changes = set.changes().iter().chain(set.save_command()).map(line);
    let tasks = set
        .tasks()
        .iter()
        .map(|task| format!("MT[{}]: another task{}", task.number, reached(&task.step)));
    changes.chain(tasks).collect()
}

/// What becomes of the values that the drive can save; `only`: there are no others.
fn of_most(values: &[String], only: bool, persistence: Persistence) -> Remark {
    let named = match only {
        true => String::new(),
        false => format!(": {}", listed(values)),
    };
    let unsaved = |why: &str| {
        let lost = match values {
            [] => String::new(),
            values => format!(", {} lost at the next power cycle", with_verb(values)),
        };
        Remark::warning(format!("not saved: {why}{lost}"))
    };
    match persistence {
        Persistence::EveryWrite => Remark::news(format!("saved in the drive{named} (it saves every write)")),
        Persistence::Saved { by_command: true } => Remark::news(format!(
            "saved in the drive{named}, with everything else that it can save"
        )),
        Persistence::Saved { by_command: false } => Remark::news(format!("saved in the drive{named}")),
        Persistence::NotRequested => {
            let values = match only {
                true => String::new(),
                false => format!("{} ", with_verb(values)),
            };
            Remark::news(format!("not saved: {values}lost at the next power cycle"))
                .and(Some(Action::Choose(Choice::Save).into()))
        }
        Persistence::NotAsPlanned => {
            unsaved("the save command was not sent because not every value is as planned")
        }
        Persistence::InDoubt => {
            let values = if values.is_empty() {
                "its values"
            } else {
                &listed(values)
            };
            Remark::warning(format!(
                "it is not known whether the drive saved {values}: requested, not answered"
            ))
        }
        Persistence::Refused(refusal) => unsaved(&format!("the drive refused to save ({})", refusal.words())),
    }
}

/// `DRV.ACC is`, `DRV.ACC, DRV.DEC are`.
fn with_verb(names: &[String]) -> String {
    let verb = if names.len() == 1 { "is" } else { "are" };
    format!("{} {verb}", listed(names))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_not_saved_are_named() {
        let names = ["922".to_owned(), "HOME.V".to_owned()];
        let remark = |names, only, persistence| of_most(names, only, persistence).sentence;
        assert_eq!(
            remark(&names, false, Persistence::NotAsPlanned),
            "not saved: the save command was not sent because not every value is as planned, 922, HOME.V are lost at \
             the next power cycle"
        );
        assert_eq!(
            remark(&names[..1], false, Persistence::NotRequested),
            "not saved: 922 is lost at the next power cycle"
        );
        let many: Vec<String> = (0..10).map(|number| number.to_string()).collect();
        assert_eq!(
            remark(&many, false, Persistence::EveryWrite),
            "saved in the drive: 0, 1, 2, 3, 4, 5, 6, 7 and 2 more (it saves every write)"
        );
    }
}
