//! One file per verb, or per family of verbs that share their words.

mod address;
mod axis;
mod backup;
mod commission;
mod completions;
mod decode;
mod demo;
mod diff;
mod diff_folder;
mod doctor;
mod documents;
mod each;
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
mod record;
mod record_rows;
mod recorded;
mod remark;
mod restore;
mod run;
mod scan;
mod schema;
#[cfg(feature = "serve")]
mod serve;
mod simulate;
mod status;
mod step;
mod stop;
mod task;

use crate::args::{Cli, Command, DriveOptions, Interface, OnDrive, OnSelected, Target};
use crate::failure::Failure;
use crate::output::Output;

/// Runs what was requested.
pub fn run(cli: &Cli, output: &Output) -> Result<(), Failure> {
    if let Some(name) = &cli.interface.interface
        && is_offline(&cli.command)
    {
        // an interface that is accepted and not used would look like an answer from the network
        return Err(Failure::usage(format!(
            "`{}` does not use the network: -i {name} has no meaning for it",
            cli.name
        ))
        .hint("leave it out"));
    }
    match &cli.command {
        Command::Scan(on) => scan::run(&on.args, interface(cli, &on.interface), output),
        Command::Name(on) => address::name(&on.args, interface(cli, &on.interface), output),
        Command::Ip(on) => address::ip(&on.args, interface(cli, &on.interface), output),
        Command::Blink(on) => address::blink(&on.args, interface(cli, &on.interface), output),
        Command::Reset(on) => address::reset(&on.args, interface(cli, &on.interface), output),
        Command::Info(on) => info::run(&selected(cli, on), output),
        Command::Read(on) => parameters::read(&on.args, &selected(cli, on), output),
        Command::Write(on) => parameters::write(&on.args, &selected(cli, on), output),
        Command::List(on) => parameters::list(&on.args, &target(cli, on), output),
        Command::Describe(on) => parameters::describe(&on.args, &target(cli, on), output),
        Command::Run(on) => run::run(&on.args, &target(cli, on), output),
        Command::Step(on) => step::run(&on.args, &target(cli, on), output),
        Command::Jog(on) => jog::run(&on.args, &target(cli, on), output),
        Command::Move(on) => r#move::run(&on.args, &target(cli, on), output),
        Command::Task(on) => task::run(&on.args, &target(cli, on), output),
        Command::Home(on) => home::run(&on.args, &target(cli, on), output),
        Command::Stop(on) => stop::run(&on.args, &selected(cli, on), output),
        Command::Doctor(on) => doctor::run(&on.args, &options(cli, &on.options), output),
        Command::Bundle(on) => documents::bundle(&on.args, &selected(cli, on), output),
        Command::Report(on) => documents::report(&on.args, &selected(cli, on), output),
        Command::Status(on) => status::run(&on.args, &selected(cli, on), output),
        Command::Ack(on) => motion::ack(&on.args, &selected(cli, on), output),
        Command::Monitor(on) => motion::monitor(&on.args, &selected(cli, on), output),
        Command::Record(on) => record::run(&on.args, &selected(cli, on), output),
        Command::Faults(on) => faults::run(&on.args, &selected(cli, on), output),
        Command::Backup(on) => backup::run(&on.args, &selected(cli, on), output),
        Command::Diff(on) => diff::run(&on.args, &options(cli, &on.options), output),
        Command::Restore(on) => restore::run(&on.args, &target(cli, on), output),
        Command::Commission(on) => commission::run(&on.args, &options(cli, &on.options), output),
        Command::Replace(on) => commission::replace(&on.args, &options(cli, &on.options), output),
        Command::Explain(args) => explain::run(args, output),
        Command::Decode(args) => {
            let interface = args.interface.as_ref().or(cli.interface.interface.as_ref());
            decode::run(args, interface.map(String::as_str), output)
        }
        Command::Gsdml(args) => gsdml::run(args, output),
        Command::Simulate(on) => simulate::run(&on.args, interface(cli, &on.interface), output),
        #[cfg(feature = "serve")]
        Command::Serve(on) => serve::run(&on.args, interface(cli, &on.interface), output),
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

/// Whether a command works without a network.
const fn is_offline(command: &Command) -> bool {
    match command {
        Command::Decode(args) => args.file.is_some() || args.hex.is_some(),
        Command::Explain(_)
        | Command::Gsdml(_)
        | Command::Demo(_)
        | Command::Completions(_)
        | Command::Manual(_)
        | Command::Schema => true,
        _ => false,
    }
}

/// The drive of a command, with its options.
fn target<T: clap::Args>(cli: &Cli, on: &OnDrive<T>) -> Target {
    options(cli, &on.options).target(&on.drive)
}

/// The drives of a command, with its options.
fn selected<T: clap::Args>(cli: &Cli, on: &OnSelected<T>) -> Target {
    options(cli, &on.options).target(&on.drive)
}

/// The options for the drives of a command.
fn options(cli: &Cli, own: &DriveOptions) -> DriveOptions {
    DriveOptions {
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
