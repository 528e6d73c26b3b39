//! The interface for the page and for programs: `/api/v1`, described by `openapi.json`.

mod acknowledge;
mod addressing;
mod answers;
mod backups;
mod captures;
mod drives;
mod frames;
mod inject;
mod log;
mod parameters;
mod plans;
mod plant;
mod server;
mod session;
mod stations;
mod stop;
mod virtual_drives;

pub(crate) use drives::find;
pub(crate) use log::LogTopic;
pub(crate) use plant::{of_a_simulation, while_it_runs};
pub(crate) use stations::StationsReport;
pub(crate) use virtual_drives::VirtualDrives;

use std::sync::Arc;

use axum::Router;
use axum::http::StatusCode;
use profidrive::report::{
    BlinkReport, DescribeReport, FaultsReport, InfoReport, ListReport, ParametersReport, StateMachine,
    StatusReport,
};
use schemars::generate::SchemaSettings;
use serde_json::Value;
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::audit::LogPage;
use crate::captures::{EventPage, FramePage, FrameReport};
use crate::control;
use crate::frames::{LinkTopic, MachineTopic, TelegramTopic};
use crate::jobs::JobReport;
use crate::live;
use crate::problem::{self, Problem};
use crate::shared::Shared;

#[derive(OpenApi)]
#[openapi(info(
    title = "profidrive workbench",
    description = "What the page of the workbench uses, for programs too. A program sends its token in the header `Authorization: \
                   Bearer TOKEN`; a browser has a session.",
    license(name = "MIT OR Apache-2.0")
))]
struct Description;

fn routes() -> OpenApiRouter<Arc<Shared>> {
    OpenApiRouter::with_openapi(Description::openapi())
        .routes(routes!(server::server))
        .routes(routes!(server::stop))
        .routes(routes!(
            session::begin,
            session::session,
            session::claim,
            session::end
        ))
        .routes(routes!(stations::stations))
        .routes(routes!(stations::scan))
        .routes(routes!(addressing::blink))
        .routes(routes!(addressing::name))
        .routes(routes!(addressing::ip))
        .routes(routes!(drives::status))
        .routes(routes!(drives::info))
        .routes(routes!(drives::faults))
        .routes(routes!(drives::record))
        .routes(routes!(parameters::parameters))
        .routes(routes!(parameters::describe))
        .routes(routes!(parameters::values))
        .routes(routes!(parameters::layout))
        .routes(routes!(plans::plan))
        .routes(routes!(plans::apply))
        .routes(routes!(plans::undo))
        .routes(routes!(plans::unsaved))
        .routes(routes!(backups::kept, backups::upload))
        .routes(routes!(backups::backup))
        .routes(routes!(backups::back_up))
        .routes(routes!(backups::compare))
        .routes(routes!(backups::changed))
        .routes(routes!(backups::job))
        .routes(routes!(acknowledge::acknowledge))
        .routes(routes!(inject::events))
        .routes(routes!(inject::inject))
        .routes(routes!(inject::scenario))
        .routes(routes!(virtual_drives::drives))
        .routes(routes!(plant::check))
        .routes(routes!(plant::restart))
        .routes(routes!(plant::clock))
        .routes(routes!(frames::state_machine))
        .routes(routes!(frames::machine))
        .routes(routes!(frames::telegram))
        .routes(routes!(frames::troubles))
        .routes(routes!(frames::traffic))
        .routes(routes!(log::audit))
        .routes(routes!(log::log_lines))
        .routes(routes!(log::log_table))
        .routes(routes!(captures::captures))
        .routes(routes!(captures::capture, captures::remove_capture))
        .routes(routes!(captures::capture_events))
        .routes(routes!(captures::capture_frames))
        .routes(routes!(captures::capture_frame))
        .routes(routes!(live::live))
        .routes(routes!(control::control))
}

fn long_routes() -> OpenApiRouter<Arc<Shared>> {
    OpenApiRouter::new().routes(routes!(stop::stop_drive))
}

fn large_routes() -> OpenApiRouter<Arc<Shared>> {
    OpenApiRouter::new().routes(routes!(captures::upload_capture))
}

/// Returns the routes of the interface.
pub(crate) fn router() -> Router<Arc<Shared>> {
    routes().split_for_parts().0
}

/// Returns those of them that last as long as a drive needs.
pub(crate) fn long_router() -> Router<Arc<Shared>> {
    long_routes().split_for_parts().0
}

/// Returns those of them whose bodies have a limit of their own.
pub(crate) fn large_router() -> Router<Arc<Shared>> {
    large_routes().split_for_parts().0
}

/// Returns the description of the interface (OpenAPI) as JSON.
#[must_use]
pub fn openapi() -> String {
    let (_, description) = routes()
        .merge(long_routes())
        .merge(large_routes())
        .split_for_parts();
    let mut description = serde_json::to_value(description).unwrap_or_default();
    let mut settings = SchemaSettings::draft2020_12();
    settings.definitions_path = "/components/schemas".into();
    let mut generator = settings.for_serialize().into_generator();
    generator.subschema_for::<server::ServerReport>();
    generator.subschema_for::<server::StoppedReport>();
    generator.subschema_for::<session::Login>();
    generator.subschema_for::<session::ClaimedName>();
    generator.subschema_for::<session::SessionReport>();
    generator.subschema_for::<StationsReport>();
    generator.subschema_for::<BlinkReport>();
    generator.subschema_for::<addressing::StationName>();
    generator.subschema_for::<addressing::Named>();
    generator.subschema_for::<addressing::StationAddress>();
    generator.subschema_for::<addressing::Addressed>();
    generator.subschema_for::<StatusReport>();
    generator.subschema_for::<InfoReport>();
    generator.subschema_for::<FaultsReport>();
    generator.subschema_for::<ListReport>();
    generator.subschema_for::<DescribeReport>();
    generator.subschema_for::<ParametersReport>();
    generator.subschema_for::<profidrive::report::TelegramLayout>();
    generator.subschema_for::<plans::NewPlan>();
    generator.subschema_for::<plans::Unsaved>();
    generator.subschema_for::<JobReport>();
    generator.subschema_for::<backups::BackupsReport>();
    generator.subschema_for::<backups::NewBackup>();
    generator.subschema_for::<backups::BackupName>();
    generator.subschema_for::<backups::Compare>();
    generator.subschema_for::<acknowledge::Acknowledge>();
    generator.subschema_for::<profidrive::motion::Report>();
    generator.subschema_for::<profidrive::motion::StopReport>();
    generator.subschema_for::<VirtualDrives>();
    generator.subschema_for::<plant::PlantText>();
    generator.subschema_for::<plant::PlantCheck>();
    generator.subschema_for::<plant::PlantStart>();
    generator.subschema_for::<plant::PlantStarted>();
    generator.subschema_for::<plant::PlantClock>();
    generator.subschema_for::<inject::Possible>();
    generator.subschema_for::<inject::Inject>();
    generator.subschema_for::<inject::Injected>();
    generator.subschema_for::<drives::RecordReport>();
    generator.subschema_for::<live::FaultsTopic>();
    generator.subschema_for::<StateMachine>();
    generator.subschema_for::<MachineTopic>();
    generator.subschema_for::<TelegramTopic>();
    generator.subschema_for::<LinkTopic>();
    generator.subschema_for::<frames::TroublesReport>();
    generator.subschema_for::<LogPage>();
    generator.subschema_for::<LogTopic>();
    generator.subschema_for::<captures::CapturesReport>();
    generator.subschema_for::<EventPage>();
    generator.subschema_for::<FramePage>();
    generator.subschema_for::<FrameReport>();
    generator.subschema_for::<problem::Body>();
    answers::complete(&mut description);
    description["components"]["schemas"] = Value::Object(generator.take_definitions(true));
    let text = serde_json::to_string_pretty(&description).unwrap_or_default();
    text + "\n"
}

/// Answers a path of the interface that does not exist.
pub(crate) async fn nothing() -> Problem {
    Problem::new(StatusCode::NOT_FOUND, "path", "the interface has no such path")
}
