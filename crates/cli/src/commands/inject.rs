//! `profidrive inject DRIVE fault=439`: injects an event into a drive of a running `profidrive simulate`.

use plant::control_socket::{InjectError, InjectRequest, target};
use plant::keys;
use profidrive::report::{InjectKey, InjectReport};

use crate::args::Inject;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::Page;
use crate::render::table::{Table, clean};

pub fn run(args: &Inject, output: &Output) -> Result<(), Failure> {
    let Some(drive) = args.drive.as_ref().filter(|_| !args.events.is_empty()) else {
        if args.lasts.is_some() {
            return Err(Failure::usage("--for needs something that happens: KEY=VALUE"));
        }
        output.report(&InjectReport {
            drive: None,
            happened: None,
            keys: keys()
                .map(|key| InjectKey {
                    key: key.key,
                    example: key.example,
                    meaning: key.meaning,
                })
                .collect(),
        });
        return Ok(());
    };
    let request = InjectRequest::new(drive, &args.events, args.lasts).map_err(|error| failure(&error))?;
    let target = target(&request).map_err(|error| failure(&error))?;
    if !target.here {
        output.say(&format!(
            "{} is in another network namespace",
            clean(&target.drive)
        ));
    }
    let name = target.inject(request).map_err(|error| failure(&error))?;
    let what = args.events.join(" ");
    output.report(&InjectReport {
        drive: Some(name),
        happened: Some(what),
        keys: Vec::new(),
    });
    Ok(())
}

/// Returns the reason why nothing happened; the text of another process is cleaned.
fn failure(error: &InjectError) -> Failure {
    let failure = Failure::explained(error);
    let failure = Failure {
        message: clean(&failure.message),
        hint: match failure.hint.is_empty() {
            true => failure.hint,
            false => clean(&failure.hint.to_string()).into(),
        },
        ..failure
    };
    match error {
        InjectError::NotFound { others, .. } if others.is_empty() => {
            failure.hint("start one: `profidrive simulate --name akd-1 -i IFACE`")
        }
        _ => failure,
    }
}

impl Page for InjectReport {
    fn print(&self, output: &Output) {
        if let (Some(drive), Some(what)) = (&self.drive, &self.happened) {
            output.say(&format!("{}: {what}", clean(drive)));
        }
        let mut table = Table::new(&["example", "what happens"]);
        for key in &self.keys {
            table.row([key.example.to_owned(), key.meaning.to_owned()]);
        }
        output.table(&table);
    }
}
