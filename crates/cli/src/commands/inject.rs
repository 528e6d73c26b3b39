//! `profidrive inject DRIVE fault=439`: lets something happen to a drive of a running `profidrive simulate`.

use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use plant::{Happening, keys};

use crate::args::duration;
use crate::desk::{Answer, Question, Request, ask, namespace, sockets};
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
    pub happenings: Vec<String>,
    /// Ends it again after this time
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub lasts: Option<Duration>,
}

pub fn run(args: &Inject, output: &Output) -> Result<(), Failure> {
    let Some(drive) = args.drive.as_ref().filter(|_| !args.happenings.is_empty()) else {
        if args.lasts.is_some() {
            return Err(Failure::usage("--for needs something that happens: KEY=VALUE"));
        }
        tell_keys(output);
        return Ok(());
    };
    for text in &args.happenings {
        let happening: Happening = text.parse().map_err(|error| Failure::usage(format!("{error}")))?;
        if args.lasts.is_some() && happening.undo().is_none() {
            return Err(Failure::usage(format!(
                "`{happening}` has no end of its own, so --for means nothing for it"
            )));
        }
    }
    let lasts = args
        .lasts
        .map(|lasts| u64::try_from(lasts.as_nanos()).unwrap_or(u64::MAX));
    let request = Request {
        drive: drive.clone(),
        from: namespace(),
        happenings: args.happenings.clone(),
        lasts,
    };
    let socket = owner(&request, output)?;
    let refused = |why: &str| Failure::new(Exit::Refused, format!("{drive}: {}", clean(why)));
    match ask(&socket, &Question::Inject(request)) {
        Ok(Some(Answer::Done { drive: name, .. })) => {
            let what = args.happenings.join(" ");
            if output.json() {
                output.document(
                    "inject",
                    fields! { "drive": name.as_str(), "happened": what.as_str() },
                );
            } else {
                output.say(&format!("{}: {what}", clean(&name)));
            }
            Ok(())
        }
        Ok(Some(Answer::Refused(why))) => Err(refused(&why)),
        Ok(Some(Answer::NotHere(_) | Answer::Drives(_)) | None) => {
            Err(refused("the simulation does not know it any more"))
        }
        Err(error) => Err(refused(&error.to_string())),
    }
}

/// The socket of the one simulation that has the drive.
fn owner(request: &Request, output: &Output) -> Result<PathBuf, Failure> {
    let question = Question::Inject(Request {
        happenings: Vec::new(),
        lasts: None,
        ..request.clone()
    });
    let drive = &request.drive;
    let (mut found, mut others, mut silent) = (Vec::<Found>::new(), Vec::new(), None);
    for socket in sockets()? {
        match ask(&socket, &question) {
            Ok(Some(Answer::Done { drive, here })) => found.push(Found { socket, drive, here }),
            Ok(Some(Answer::NotHere(drives))) => others.extend(drives),
            Ok(Some(Answer::Refused(why))) => {
                return Err(Failure::new(Exit::Refused, format!("{drive}: {}", clean(&why))));
            }
            Ok(Some(Answer::Drives(_)) | None) => {
                silent = Some(format!("{}: no answer to the request", socket.display()));
            }
            // left behind by a process that was killed
            Err(error) if error.kind() == ErrorKind::ConnectionRefused => {
                let _ = fs::remove_file(&socket);
            }
            Err(error) => silent = Some(format!("{}: {error}", socket.display())),
        }
    }
    if let Some(only) = meant(drive, found)? {
        if !only.here {
            output.say(&format!("{} is in another network namespace", clean(&only.drive)));
        }
        return Ok(only.socket);
    }
    if let Some(why) = silent {
        return Err(unanswered(drive, &why));
    }
    let failure = Failure::new(
        Exit::Unreachable,
        format!("no `profidrive simulate` of yours on this computer has a drive {drive}"),
    );
    Err(if others.is_empty() {
        failure.hint("start one: `profidrive simulate --name akd-1 -i IFACE`")
    } else {
        failure.hint(format!("there are: {}", clean(&others.join(", "))))
    })
}

/// A simulation that runs may have the drive.
fn unanswered(drive: &str, why: &str) -> Failure {
    let message = format!("{drive}: a `profidrive simulate` of yours does not answer: {why}");
    Failure::new(Exit::Unreachable, message).hint("it is busy or stopped (Ctrl-Z); try again")
}

/// A simulation that has the drive.
struct Found {
    socket: PathBuf,
    /// The drive in words.
    drive: String,
    /// In the network namespace of this process, or at a serial line.
    here: bool,
}

/// The one that is meant: one of the own network namespace before all others.
fn meant(drive: &str, mut found: Vec<Found>) -> Result<Option<Found>, Failure> {
    if found.iter().any(|one| one.here) {
        found.retain(|one| one.here);
    }
    if found.len() < 2 {
        return Ok(found.pop());
    }
    let all: Vec<_> = found.iter().map(|one| clean(&one.drive)).collect();
    let failure = Failure::usage(format!(
        "{} simulations have a drive {drive}: {}",
        all.len(),
        all.join("; ")
    ));
    Err(failure.hint(if found.iter().all(|one| one.here) {
        "say which one by its IP or MAC address; one process too many ends with Ctrl-C"
    } else {
        "they are in other network namespaces: call `inject` in that of the one meant (nsenter -n -t PROCESS), or say which one by its IP or MAC address"
    }))
}

fn tell_keys(output: &Output) {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn found(drive: &str, here: bool) -> Found {
        Found {
            socket: PathBuf::from(drive),
            drive: drive.into(),
            here,
        }
    }

    #[test]
    fn a_simulation_of_the_own_network_is_meant_first() {
        let one = meant("a", vec![found("far", false), found("near", true)]);
        assert_eq!(one.map(|one| one.map(|one| one.drive)), Ok(Some("near".into())));
        let one = meant("a", vec![found("far", false)]);
        assert_eq!(one.map(|one| one.map(|one| one.here)), Ok(Some(false)));
        assert!(meant("a", Vec::new()).is_ok_and(|none| none.is_none()));
        let error = |places: [bool; 2]| {
            let both = places.map(|here| found("a, process 7", here));
            meant("a", both.into()).err().expect("two of them")
        };
        let near = error([true, true]);
        assert!(
            near.message
                .contains("2 simulations have a drive a: a, process 7; a"),
            "{near:?}"
        );
        assert!(
            error([false, false])
                .hint
                .is_some_and(|hint| hint.contains("nsenter"))
        );
    }
}
