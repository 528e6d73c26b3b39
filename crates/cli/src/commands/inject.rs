//! `profidrive inject DRIVE fault=439`: injects an event into a drive of a running `profidrive simulate`.

use client::ErrorKind;
use plant::control_socket::{ControlSocketError, InjectError, InjectRequest, target};
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
    let request = InjectRequest::new(drive, &args.events, args.lasts).map_err(failure)?;
    let target = target(&request).map_err(failure)?;
    if !target.here {
        output.say(&format!(
            "{} is in another network namespace",
            clean(&target.drive)
        ));
    }
    let name = target.inject(request).map_err(failure)?;
    let what = args.events.join(" ");
    output.report(&InjectReport {
        drive: Some(name),
        happened: Some(what),
        keys: Vec::new(),
    });
    Ok(())
}

/// Returns the reason why nothing happened; the text of another process is cleaned.
fn failure(error: InjectError) -> Failure {
    let text = clean(&error.to_string());
    match error {
        InjectError::NoEnd(event) => Failure::usage(format!(
            "`{event}` has no end of its own, so --for means nothing for it"
        )),
        InjectError::Socket(ControlSocketError::Folder { .. }) => Failure::new(ErrorKind::Local, text).hint(
            "the folder of running simulations must belong to you alone; XDG_RUNTIME_DIR chooses another place",
        ),
        InjectError::Socket(_) => Failure::new(ErrorKind::Local, text),
        InjectError::NotFound { drive, others } => {
            let failure = Failure::new(
                ErrorKind::Unreachable,
                format!("no `profidrive simulate` of yours on this computer has a drive {drive}"),
            );
            failure.hint(if others.is_empty() {
                "start one: `profidrive simulate --name akd-1 -i IFACE`".to_owned()
            } else {
                format!("there are: {}", clean(&others.join(", ")))
            })
        }
        InjectError::Ambiguous { here, .. } => Failure::usage(text).hint(if here {
            "say which one by its IP or MAC address; one process too many ends with Ctrl-C"
        } else {
            "they are in other network namespaces: call `inject` in that of the one meant (nsenter -n -t PROCESS), or say which one by its IP or MAC address"
        }),
        InjectError::NoAnswer { drive, why } => Failure::new(
            ErrorKind::Unreachable,
            format!("{drive}: a `profidrive simulate` of yours does not answer: {}", clean(&why)),
        )
        .hint("it is busy or stopped (Ctrl-Z); try again"),
        InjectError::Refused { .. } => Failure::new(ErrorKind::Refused, text),
        _ => Failure::usage(text),
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
