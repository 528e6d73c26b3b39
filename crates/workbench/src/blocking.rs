//! Work that waits for a disk.

use crate::problem::Problem;

/// Lets a disk take its time, in a thread that serves no requests.
pub(crate) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Problem> + Send + 'static,
) -> Result<T, Problem> {
    tokio::task::spawn_blocking(work)
        .await
        .unwrap_or_else(|_| Err(Problem::defect()))
}
