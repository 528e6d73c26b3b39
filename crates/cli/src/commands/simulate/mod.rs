//! `profidrive simulate --model akd --name akd-1 -i IFACE`

mod description;
mod failure;
mod judgement;
mod report;
mod virtual_time;

use std::net::SocketAddr;
use std::path::Path;
use std::time::Duration;

use client::ErrorKind;
use client::LineAddress;
use network::system::{Stop, now};
use plant::PlantPlan;
use plant::host::{
    Drives, Fleet, ForeignDescription, Host, HostConfig, MacChoice, SerialHost, SerialHostConfig, StatePlace,
};
use plant::metrics::MetricsServer;
use profidrive::serial_settings;
use virtual_drive::model::{self, Model as DriveModel};

use crate::args::{DcpInOperation, Interface, Protocol, Simulate};
use crate::connect;
use crate::failure::Failure;
use crate::output::Output;

use judgement::{Ran, ReportFile, judge};
use report::Printer;

/// Of more drives a summary is shown, not what happens to each.
const FEW: usize = 16;

const EACH_SECOND: Duration = Duration::from_secs(1);

impl From<Protocol> for uss::Protocol {
    fn from(protocol: Protocol) -> Self {
        match protocol {
            Protocol::Fc => Self::Fc,
            Protocol::Uss => Self::Uss,
        }
    }
}

pub fn run(args: &Simulate, on: &Interface, output: &Output) -> Result<(), Failure> {
    let mut plant = args.plant.as_deref().map(PlantPlan::read).transpose()?;
    let mut more = Vec::new();
    if let (Some(plant), Some(file)) = (&plant, &args.expect) {
        more = plant.read_expectations(file)?;
        if more.is_empty() {
            let message = format!("--expect {}: the file has no expectations", file.display());
            return Err(Failure::usage(message));
        }
    }
    check_outputs(args)?;
    if let Some(plant) = plant.as_mut().filter(|_| args.virtual_time) {
        plant.expectations.extend(more);
        return virtual_time::run(plant, args, output);
    }
    if let Some(port) = &args.line.serial {
        return at_line(args, port, output);
    }
    let interface = connect::interface(on)?.ok_or_else(connect::no_interface)?;
    let description = description::read(args, plant.as_ref(), output)?;
    if args.junit.is_some() && more.is_empty() {
        let message = "--junit: on an interface there are no expectations but those of --expect FILE";
        return Err(Failure::usage(message));
    }
    let report = ReportFile::create(args)?;
    let mut config = on_network(args, interface, plant, description, output)?;
    config.expectations = more;
    let (seed, begin) = (config.seed, now());
    let summary = config.drives.count() > FEW;
    let metrics = args.metrics.map(metrics).transpose()?;
    if let Some(metrics) = &metrics {
        output.say(&format!("metrics: http://{}/metrics", metrics.address()));
    }
    // a processor that is too slow is reported for few drives too
    config.load_every = Some(EACH_SECOND);
    let printer = Printer::new(output, summary, metrics);
    let results = printer.show(|events| Host::open(config, events)?.run())?;
    let took = now() - begin;
    let ran = Ran {
        seed,
        simulated: took,
        took,
    };
    judge(results, report, ran, output)
}

/// What is written must not replace what is read.
fn check_outputs(args: &Simulate) -> Result<(), Failure> {
    let place = |path: &Path| path.canonicalize().ok();
    let read = [args.plant.as_deref(), args.expect.as_deref()];
    let read: Vec<_> = read.into_iter().flatten().filter_map(place).collect();
    let outputs = [
        ("junit", &args.junit),
        ("trace", &args.trace),
        ("pcap", &args.pcap),
    ];
    for (option, path) in outputs {
        if let Some(path) = path
            && place(path).is_some_and(|place| read.contains(&place))
        {
            let message = format!(
                "--{option} {}: this file is read by the same command",
                path.display()
            );
            return Err(Failure::usage(message));
        }
    }
    Ok(())
}

fn metrics(address: SocketAddr) -> Result<MetricsServer, Failure> {
    MetricsServer::open(address).map_err(|error| {
        Failure::new(ErrorKind::Local, format!("--metrics {address}: {error}"))
            .hint("give an address of this computer and a free port, for example 127.0.0.1:9464")
    })
}

fn on_network(
    args: &Simulate,
    interface: String,
    plant: Option<PlantPlan>,
    description: Option<ForeignDescription>,
    output: &Output,
) -> Result<HostConfig, Failure> {
    if plant.as_ref().is_some_and(|plant| !plant.controllers.is_empty()) {
        output.warn("the controllers of the plant are left out: they exist in virtual time only");
    }
    if plant.as_ref().is_some_and(|plant| !plant.expectations.is_empty()) {
        output.warn(
            "the expectations of the plant file are left out: their times are those of virtual time; --expect FILE has those of an interface",
        );
    }
    let model = description.as_ref().map(|description| description.model);
    Ok(HostConfig {
        interface,
        seed: plant.as_ref().map_or(1, |plant| plant.seed),
        load_every: None,
        trace: None,
        expectations: Vec::new(),
        time: args.time.or_else(|| plant.as_ref()?.duration),
        drives: match plant {
            None => Drives::Fleet(fleet(args, model)?),
            Some(plant) => Drives::Plans(plant.drives),
        },
        state: args.state.as_deref().map(state),
        description,
        refuses_in_operation: args.dcp_in_operation == DcpInOperation::Refuse,
        capture: args.pcap.clone(),
        stop: stop()?,
    })
}

fn at_line(args: &Simulate, port: &str, output: &Output) -> Result<(), Failure> {
    let config = SerialHostConfig {
        port: LineAddress::path(port),
        protocol: args.line.protocol.into(),
        settings: serial_settings(args.line.baud, args.line.parity),
        address: args.line.address,
        fleet: fleet(args, None)?,
        state: args.state.as_deref().map(state),
        time: args.time,
        stop: stop()?,
    };
    Printer::new(output, false, None).show(|events| SerialHost::open(config, events)?.run())
}

/// The drives that the options describe, of the model that was chosen, else that of a device description.
fn fleet(args: &Simulate, described: Option<&'static DriveModel>) -> Result<Fleet, Failure> {
    let model = args.model.or(described).unwrap_or(&model::AKD);
    Ok(Fleet {
        name: args.name.clone(),
        count: args.count,
        ip: args.ip.map(|ip| (ip.address, ip.prefix)),
        mac: match args.mac.as_deref() {
            None => MacChoice::Derived,
            Some("host") => MacChoice::Host,
            Some(text) => MacChoice::This(
                text.parse()
                    .map_err(|error| Failure::usage(format!("--mac {text}: {error}")))?,
            ),
        },
        min_cycle: args.min_cycle,
        rotary: args.rotary,
        ..Fleet::new(model)
    })
}

fn state(folder: &Path) -> StatePlace {
    StatePlace {
        folder: folder.to_owned(),
        holder: format!("`profidrive simulate`, process {}", std::process::id()),
    }
}

fn stop() -> Result<Stop, Failure> {
    Stop::on_signals()
        .map_err(|error| Failure::new(ErrorKind::Internal, format!("cannot watch for Ctrl-C: {error}")))
}
