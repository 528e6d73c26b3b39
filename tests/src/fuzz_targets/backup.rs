//! Backup files, which are edited by hand.

use client::backup::{Backup, Pattern, compare};
use client::change::{Choice, Plan};

/// A backup file: what is read prints as something that reads the same, is no different from itself, and is planned onto
/// itself without a change.
pub fn backup(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    if let Some(line) = text.lines().last()
        && let Ok(pattern) = line.parse::<Pattern>()
    {
        let _ = pattern.names("DRV.ACC");
    }
    let backup = match Backup::read(data) {
        Ok(backup) => backup,
        Err(error) => {
            let lines = text.lines().count().max(1);
            assert!(!error.problems.is_empty() && error.problems.len() <= 20);
            for problem in &error.problems {
                assert!((1..=lines).contains(&problem.line), "{problem} of {lines} lines");
                assert!(!problem.to_string().contains('\n'));
            }
            return;
        }
    };
    let printed = backup.to_string();
    let again = Backup::read(&printed).unwrap_or_else(|error| panic!("{error}: {printed}"));
    assert_eq!(again, backup);
    assert_eq!(again.to_string(), printed);
    assert!(compare(&again, &backup).is_empty());
    let choice = Choice {
        network: true,
        beyond_limits: true,
        ..Choice::default()
    };
    let plan = Plan::new(&backup, &again, &choice);
    assert!(plan.set.changes().is_empty());
    let journal = plan.set.to_string();
    assert!(Backup::read(&journal).is_ok(), "{journal}");
}
