//! `profidrive inject DRIVE fault=439`: injects an event into a drive of a running `profidrive simulate`.

use std::time::Duration;

use clap::Args;
use plant::control_socket::{ControlSocketError, InjectError, InjectRequest, target};
use plant::keys;

use crate::args::duration;
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::Output;
use crate::render::table::{Table, clean};

/// What to let happen to which virtual drive.
#[derive(Debug, Args)]
pub struct Inject {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS of a drive that `profidrive simulate` runs on this computer
    pub drive: Option<String>,
    /// What is to happen, in this order; without any: what can happen
    #[arg(value_name = "KEY=VALUE")]
    pub events: Vec<String>,
    /// Ends it again after this time
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub lasts: Option<Duration>,
}

pub fn run(args: &Inject, output: &Output) -> Result<(), Failure> {
    let Some(drive) = args.drive.as_ref().filter(|_| !args.events.is_empty()) else {
        if args.lasts.is_some() {
            return Err(Failure::usage("--for needs something that happens: KEY=VALUE"));
        }
        print_keys(output);
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
    if output.json() {
        output.document("inject", fields! { "drive": name, "happened": what });
    } else {
        output.say(&format!("{}: {what}", clean(&name)));
    }
    Ok(())
}

/// Returns why nothing happened; the words of another process are cleaned.
fn failure(error: InjectError) -> Failure {
    let text = clean(&error.to_string());
    match error {
        InjectError::NoEnd(event) => Failure::usage(format!(
            "`{event}` has no end of its own, so --for means nothing for it"
        )),
        InjectError::Socket(ControlSocketError::Folder { .. }) => Failure::new(Exit::Failed, text).hint(
            "the folder of running simulations must belong to you alone; XDG_RUNTIME_DIR chooses another place",
        ),
        InjectError::Socket(_) => Failure::new(Exit::Failed, text),
        InjectError::NotFound { drive, others } => {
            let failure = Failure::new(
                Exit::Unreachable,
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
            Exit::Unreachable,
            format!("{drive}: a `profidrive simulate` of yours does not answer: {}", clean(&why)),
        )
        .hint("it is busy or stopped (Ctrl-Z); try again"),
        InjectError::Refused { .. } => Failure::new(Exit::Refused, text),
        _ => Failure::usage(text),
    }
}

fn print_keys(output: &Output) {
    if output.json() {
        let all: Vec<_> = keys()
            .map(|key| fields! { "key": key.key, "example": key.example, "meaning": key.meaning })
            .collect();
        output.document("inject", fields! { "keys": all });
        return;
    }
    let mut table = Table::new(&["example", "what happens"]);
    for key in keys() {
        table.row([key.example.to_owned(), key.meaning.to_owned()]);
    }
    for line in table.lines() {
        output.line(&line);
    }
}
