//! One file per verb, or per family of verbs that share their words.

mod address;
mod axis;
mod backup;
mod completions;
mod decode;
mod demo;
mod diff;
mod explain;
mod faults;
pub mod gsdml;
mod home;
mod info;
mod inject;
mod jog;
mod manual;
mod motion;
mod r#move;
mod parameters;
mod restore;
mod run;
mod scan;
mod schema;
mod simulate;
mod status;
mod stop;
mod task;

use crate::args::{Cli, Command, Interface, OnDrive, Towards, Way};
use crate::failure::Failure;
use crate::output::Output;

/// Runs what was requested.
pub fn run(cli: &Cli, output: &Output) -> Result<(), Failure> {
    if let (Some(name), Some(verb)) = (&cli.interface.interface, offline(&cli.command)) {
        // an interface that is taken and not used would look like an answer from the network
        return Err(Failure::usage(format!(
            "`{verb}` does not use the network: -i {name} has no meaning for it"
        ))
        .hint("leave it out"));
    }
    match &cli.command {
        Command::Scan(on) => scan::run(&on.args, interface(cli, &on.interface), output),
        Command::Name(on) => address::name(&on.args, interface(cli, &on.interface), output),
        Command::Ip(on) => address::ip(&on.args, interface(cli, &on.interface), output),
        Command::Blink(on) => address::blink(&on.args, interface(cli, &on.interface), output),
        Command::Reset(on) => address::reset(&on.args, interface(cli, &on.interface), output),
        Command::Info(on) => info::run(&towards(cli, on), output),
        Command::Read(on) => parameters::read(&on.args, &towards(cli, on), output),
        Command::Write(on) => parameters::write(&on.args, &towards(cli, on), output),
        Command::List(on) => parameters::list(&on.args, &towards(cli, on), output),
        Command::Describe(on) => parameters::describe(&on.args, &towards(cli, on), output),
        Command::Run(on) => run::run(&on.args, &towards(cli, on), output),
        Command::Jog(on) => jog::run(&on.args, &towards(cli, on), output),
        Command::Move(on) => r#move::run(&on.args, &towards(cli, on), output),
        Command::Task(on) => task::run(&on.args, &towards(cli, on), output),
        Command::Home(on) => home::run(&on.args, &towards(cli, on), output),
        Command::Stop(on) => stop::run(&on.args, &towards(cli, on), output),
        Command::Status(on) => status::run(&on.args, &towards(cli, on), output),
        Command::Ack(on) => motion::ack(&on.args, &towards(cli, on), output),
        Command::Monitor(on) => motion::monitor(&on.args, &towards(cli, on), output),
        Command::Faults(on) => faults::run(&on.args, &towards(cli, on), output),
        Command::Backup(on) => backup::run(&on.args, &towards(cli, on), output),
        Command::Diff(on) => diff::run(&on.args, &way(cli, &on.way), output),
        Command::Restore(on) => restore::run(&on.args, &towards(cli, on), output),
        Command::Explain(args) => explain::run(args, output),
        Command::Decode(args) => {
            let interface = args.interface.as_ref().or(cli.interface.interface.as_ref());
            decode::run(args, interface.map(String::as_str), output)
        }
        Command::Gsdml(args) => gsdml::run(args, output),
        Command::Simulate(on) => simulate::run(&on.args, interface(cli, &on.interface), output),
        Command::Inject(args) => inject::run(args, output),
        Command::Demo(args) => demo::run(args, output),
        Command::Completions(args) => completions::run(args, output),
        Command::Manual(args) => manual::run(args),
        Command::Schema => {
            schema::run(output);
            Ok(())
        }
    }
}

/// The drive of a command, as the person called it; `None` where there is none, or more than one.
pub fn drive(command: &Command) -> Option<&str> {
    Some(match command {
        Command::Name(on) => &on.args.drive,
        Command::Ip(on) => &on.args.drive,
        Command::Blink(on) => &on.args.drive,
        Command::Reset(on) => &on.args.drive,
        Command::Info(on) => &on.drive,
        Command::Read(on) => &on.drive,
        Command::Write(on) => &on.drive,
        Command::List(on) => &on.drive,
        Command::Describe(on) => &on.drive,
        Command::Run(on) => &on.drive,
        Command::Jog(on) => &on.drive,
        Command::Move(on) => &on.drive,
        Command::Task(on) => &on.drive,
        Command::Home(on) => &on.drive,
        Command::Stop(on) => &on.drive,
        Command::Status(on) => &on.drive,
        Command::Ack(on) => &on.drive,
        Command::Monitor(on) => &on.drive,
        Command::Faults(on) => &on.drive,
        Command::Backup(on) => &on.drive,
        Command::Restore(on) => &on.drive,
        Command::Inject(args) => args.drive.as_deref()?,
        Command::Scan(_)
        | Command::Diff(_)
        | Command::Explain(_)
        | Command::Decode(_)
        | Command::Gsdml(_)
        | Command::Simulate(_)
        | Command::Demo(_)
        | Command::Completions(_)
        | Command::Manual(_)
        | Command::Schema => return None,
    })
}

/// The name of a command that works without a network.
const fn offline(command: &Command) -> Option<&'static str> {
    match command {
        Command::Explain(_) => Some("explain"),
        Command::Decode(args) if args.file.is_some() || args.hex.is_some() => Some("decode"),
        Command::Gsdml(_) => Some("gsdml"),
        Command::Demo(_) => Some("demo"),
        Command::Completions(_) => Some("completions"),
        Command::Manual(_) => Some("manual"),
        Command::Schema => Some("schema"),
        _ => None,
    }
}

/// The drive of a command and the way to it.
fn towards<T: clap::Args>(cli: &Cli, on: &OnDrive<T>) -> Towards {
    way(cli, &on.way).to(&on.drive)
}

/// The way to the drives of a command.
fn way(cli: &Cli, own: &Way) -> Way {
    Way {
        interface: interface(cli, &own.interface).clone(),
        ..own.clone()
    }
}

/// `-i` may stand before the verb or after it; the one after it counts.
const fn interface<'a>(cli: &'a Cli, own: &'a Interface) -> &'a Interface {
    if own.interface.is_some() {
        own
    } else {
        &cli.interface
    }
}
