//! `profidrive serve`

use client::ErrorKind;
use network::system::{ForcedExit, Stop};
use plant::PlantSource;
use profidrive::report::ServeReport;
use workbench::{Certificate, ServeError, Server, Settings, Source};

use crate::args::{Interface, Serve, Tls};
use crate::connect::{named, without_permission};
use crate::failure::Failure;
use crate::output::Output;

/// The ways to start it.
const FORMS: [&str; 4] = [
    "profidrive serve --demo         six virtual drives in memory: no network, no hardware",
    "profidrive serve --plant FILE   the virtual drives of a plant file, in memory",
    "profidrive serve -i eth0        the drives on a network interface",
    "profidrive serve --ip A.B.C.D   parameters of drives by their addresses, without a permission",
];

pub fn run(args: &Serve, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let source = source(args, interface)?;
    let simulation = source.is_simulation();
    let mut settings = Settings {
        listen: args.listen,
        tls: certificate(args),
        public_url: args.public_url.clone(),
        moves_remotely: args.allow_remote_motion,
        name: args.name.clone(),
        read_only: args.read_only,
        ..Settings::new(source)
    };
    if let Some(folder) = &args.state_dir {
        settings.log = Some(folder.clone());
    }
    let stop = Stop::on_signals_with(ForcedExit::Third)
        .map_err(|error| Failure::new(ErrorKind::Internal, format!("cannot watch for Ctrl-C: {error}")))?;
    let server = Server::open(settings, stop).map_err(failed)?;
    if output.json() {
        output.json_event(&ServeReport {
            event: "ready",
            url: server.url(),
            view_url: server.view_url(),
            simulation,
            fingerprint: server.fingerprint().map(str::to_owned),
        });
    } else {
        output.line(&format!("open {}", server.url()));
        if !args.read_only {
            output.say(&format!("view-only address: {}", server.view_url()));
        }
        if let (Some(fingerprint), None) = (server.fingerprint(), &args.cert) {
            output.say(&format!(
                "its certificate has the fingerprint (SHA-256) {fingerprint}"
            ));
        }
        output.say(
            "Ctrl-C ends the server, its axes at rest first; again after a second: quick stop; a third time: at once",
        );
    }
    if let Some(why) = server.unlogged() {
        output.warn(&format!(
            "{why}: what is not logged is refused, so nothing can be changed and no axis moved; STOP works. --state-dir names another folder"
        ));
    }
    if args.open {
        let opened = server.url_once().and_then(open::that_detached);
        if let Err(error) = opened {
            output.say(&format!("cannot start a browser: {error}"));
        }
    }
    server.run().map_err(failed)
}

/// Returns what encrypts connections.
fn certificate(args: &Serve) -> Option<Certificate> {
    match (args.tls, &args.cert, &args.key) {
        (_, Some(certificate), Some(key)) => Some(Certificate::Files {
            certificate: certificate.clone(),
            key: key.clone(),
        }),
        (how, ..) => how.map(|Tls::SelfSigned| Certificate::SelfSigned),
    }
}

/// Returns where the drives are.
fn source(args: &Serve, interface: &Interface) -> Result<Source, Failure> {
    let simulation = args.demo || args.plant.is_some();
    if let Some(name) = &interface.interface
        && (simulation || !args.ip.is_empty())
    {
        return Err(Failure::usage(format!(
            "-i {name} and another place for the drives: a server has one"
        )));
    }
    if args.demo {
        return Ok(Source::Demo);
    }
    if let Some(path) = &args.plant {
        let plant = PlantSource::read(path).map_err(profidrive::OpenError::from)?;
        return Ok(Source::Plant(Box::new(plant)));
    }
    if !args.ip.is_empty() {
        return Ok(Source::Addresses(args.ip.clone()));
    }
    named(interface).map(Source::Interface).ok_or_else(|| Failure {
        details: FORMS.map(str::to_owned).into(),
        ..Failure::usage("where are the drives?")
    })
}

fn failed(error: ServeError) -> Failure {
    match error {
        ServeError::Open(error) => without_permission(error),
        ServeError::Listen { .. } => {
            Failure::explained(&error).hint("--listen 127.0.0.1:0 takes a free port")
        }
        ServeError::NotLocal(_) => Failure::explained(&error).and_hint("--tls self-signed encrypts it"),
        error => Failure::explained(&error),
    }
}
