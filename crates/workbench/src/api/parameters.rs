//! The parameters of a drive: what it has, what each is, and their values.

use std::sync::Arc;

use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use profidrive::client::Error;
use profidrive::parameters::{self as verbs, List};
use profidrive::profile::notation::ParameterReference;
use profidrive::profile::value::ParameterProblem;
use profidrive::report::{DescribeReport, ListReport, ParametersReport, TelegramLayout};

use super::drives::find;
use crate::problem::Problem;
use crate::query::Query;
use crate::shared::Shared;
use crate::words::PageWords;

/// Parameters in one request.
const AT_ONCE: usize = 200;

/// Lists the parameters of a drive as the tables of its model have them. A drive without tables lists its numbers.
#[utoipa::path(get, path = "/api/v1/drives/{id}/parameters", responses(
    (status = 200, description = "The parameters", body = ref("#/components/schemas/ListReport")),
))]
pub(super) async fn parameters(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
) -> Result<Json<ListReport>, Problem> {
    let (mut network, mut drive) = find(&shared, &id).await?;
    let wanted = List::default();
    let list = verbs::list(&mut network, &mut drive, &wanted, &PageWords, &mut |_, _| {}).await;
    list.map(Json).map_err(|error| Problem::of(&error))
}

/// Reads everything that is known of one parameter, and its values.
#[utoipa::path(get, path = "/api/v1/drives/{id}/parameters/{reference}", params(("reference" = String, Path, description = "Number or name: `DRV.ACC`, `p2108`, `3-41`")), responses(
    (status = 200, description = "The parameter", body = ref("#/components/schemas/DescribeReport")),
    (status = 400, description = "No such parameter"),
    (status = 501, description = "Nothing describes it"),
))]
pub(super) async fn describe(
    State(shared): State<Arc<Shared>>,
    Path((id, reference)): Path<(String, String)>,
) -> Result<Json<DescribeReport>, Problem> {
    let reference = parsed(&reference)?;
    let (mut network, mut drive) = find(&shared, &id).await?;
    let described = verbs::describe(&mut network, &mut drive, &reference).await;
    let described = described.map_err(|error| Problem::of(&error))?;
    Ok(Json(described.report(&drive, &PageWords)))
}

/// Reads values. What the drive refuses has its reason in its place.
#[utoipa::path(get, path = "/api/v1/drives/{id}/values/{references}", params(
    ("references" = String, Path, description = "Numbers or names with commas between them: `DRV.ACC,DRV.DEC`; at most 200"),
    ("present" = Option<bool>, Query, description = "Whether only what the drive has is of interest: what it refuses is left out, and what it has reported not to have is not read again for ten minutes"),
), responses(
    (status = 200, description = "The values, in the order of the request", body = ref("#/components/schemas/ParametersReport")),
    (status = 400, description = "A name that the drive does not have"),
))]
pub(super) async fn values(
    State(shared): State<Arc<Shared>>,
    Path((id, references)): Path<(String, String)>,
    query: Query,
) -> Result<Json<ParametersReport>, Problem> {
    let wanted: Vec<_> = references.split(',').map(parsed).collect::<Result<_, _>>()?;
    if wanted.len() > AT_ONCE {
        let detail = format!(
            "{} parameters in one request: {AT_ONCE} is the most",
            wanted.len()
        );
        return Err(Problem::new(StatusCode::BAD_REQUEST, "usage", &detail));
    }
    let (mut network, mut drive) = find(&shared, &id).await?;
    let values = match query.is_true("present") {
        true => verbs::read_present(&mut network, &mut drive, &wanted).await,
        false => verbs::read(&mut network, &mut drive, &wanted).await,
    };
    let values = values.map_err(|error| Problem::of(&error))?;
    match values.unknown.first() {
        Some(problem) => Err(Problem::of(&Error::from(problem.clone()))),
        None => Ok(Json(values.report(&drive, &PageWords))),
    }
}

/// Reads where signals and parameters stand in the telegram that a drive has selected.
#[utoipa::path(get, path = "/api/v1/drives/{id}/layout", responses(
    (status = 200, description = "The places; none for a telegram that is not known", body = ref("#/components/schemas/TelegramLayout")),
))]
pub(super) async fn layout(
    State(shared): State<Arc<Shared>>,
    Path(id): Path<String>,
) -> Result<Json<TelegramLayout>, Problem> {
    let (mut network, mut drive) = find(&shared, &id).await?;
    let layout = verbs::layout(&mut network, &mut drive).await;
    layout.map(Json).map_err(|error| Problem::of(&error))
}

fn parsed(text: &str) -> Result<ParameterReference, Problem> {
    let reference = text.parse::<ParameterReference>();
    reference.map_err(|error| Problem::of(&Error::from(ParameterProblem::from(error))))
}
