//! Work on a drive that may take longer than a request: planning, writing, saving and comparing settings.

use std::collections::{BTreeSet, HashMap, VecDeque};
use std::future::Future;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use axum::http::StatusCode;
use profidrive::report::{DiffReport, Error};
use schemars::JsonSchema;
use serde::Serialize;
use tokio::sync::{Semaphore, watch};
use tokio::time::timeout;

use crate::plan::{PlanReport, Planned};
use crate::problem::Problem;

/// Jobs that are kept; the oldest goes first.
const KEPT: usize = 64;
/// Jobs that work at once; others wait for their turn.
const WORKING: usize = 16;
/// A request waits so long for the end of its job.
const BRIEFLY: Duration = Duration::from_secs(3);

/// How far a job is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Phase {
    /// It reads or writes.
    Working,
    /// A plan is made, and nothing is written yet.
    Planned,
    /// What was planned was written, as far as its changes say.
    Applied,
    /// The values before were written again, as far as its changes say.
    Undone,
    /// Settings were read or compared.
    Done,
    /// It ended by a problem.
    Failed,
}

/// A job: how far it is, and what came of it.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct JobReport {
    /// What it is called in paths.
    pub id: u64,
    /// The drive, as it is called in paths; null where it is about files.
    pub drive: Option<String>,
    /// How far it is.
    pub phase: Phase,
    /// How much of the work is done.
    pub done: usize,
    /// How much there is; 0 where that is not known.
    pub total: usize,
    /// The changes of a plan.
    pub plan: Option<PlanReport>,
    /// What differs.
    pub differences: Option<DiffReport>,
    /// What a person is to know of it.
    pub remarks: Vec<String>,
    /// The file that was made.
    pub file: Option<String>,
    /// The problem that ended it.
    pub problem: Option<Error>,
}

/// One job.
#[derive(Debug)]
pub(crate) struct Job {
    pub id: u64,
    /// How many plants were started in the place of the first one when it began.
    restarts: u64,
    view: watch::Sender<(JobReport, Option<Problem>)>,
    /// What was planned or applied; taken out while something is done with it.
    planned: Mutex<Option<Planned>>,
    /// Room to work.
    turns: Arc<Semaphore>,
}

impl Job {
    /// Returns how far it is.
    pub fn report(&self) -> JobReport {
        self.view.borrow().0.clone()
    }

    /// Returns a problem where the plant that it is of is no more.
    pub fn of_present(&self, restarts: u64) -> Result<(), Problem> {
        if self.restarts == restarts {
            return Ok(());
        }
        let detail = "the plant was started again since this plan was made, so its drives are others: make the plan again";
        Err(Problem::new(StatusCode::CONFLICT, "plan", detail))
    }

    /// Notes how much of the work is done.
    pub fn progress(&self, done: usize, total: usize) {
        self.view
            .send_modify(|(report, _)| (report.done, report.total) = (done, total));
    }

    fn planned(&self) -> MutexGuard<'_, Option<Planned>> {
        self.planned.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes what was planned, to work on it; `None` while another caller does, and where there is no plan.
    pub fn take(&self, wanted: Phase) -> Option<Planned> {
        let mut planned = self.planned();
        if self.view.borrow().0.phase != wanted {
            return None;
        }
        let taken = planned.take()?;
        self.view.send_modify(|(report, _)| {
            (report.phase, report.done, report.total) = (Phase::Working, 0, 0);
        });
        Some(taken)
    }

    /// Notes what became of a plan.
    pub fn put(
        &self,
        phase: Phase,
        planned: Planned,
        report: PlanReport,
        remarks: Vec<String>,
        problem: Option<Problem>,
    ) {
        *self.planned() = Some(planned);
        self.view.send_modify(|(view, failure)| {
            view.phase = phase;
            view.plan = Some(report);
            view.remarks = remarks;
            view.problem = problem.as_ref().map(|problem| problem.error().clone());
            failure.clone_from(&problem);
        });
    }

    fn fail(&self, problem: Problem) {
        self.view.send_modify(|(view, failure)| {
            view.phase = Phase::Failed;
            view.problem = Some(problem.error().clone());
            *failure = Some(problem);
        });
    }

    /// Carries on in the background; a problem is noted.
    pub fn run(self: &Arc<Self>, work: impl Future<Output = Result<(), Problem>> + Send + 'static) {
        let job = Arc::clone(self);
        tokio::spawn(async move {
            // nothing closes it
            let _turn = job.turns.acquire().await;
            // a panic was printed, and must not leave a job without an end
            let ended = tokio::spawn(work)
                .await
                .unwrap_or_else(|_| Err(Problem::defect()));
            if let Err(problem) = ended {
                job.fail(problem);
            }
        });
    }

    /// Notes the end of a job that is no plan.
    pub fn end(&self, note: impl FnOnce(&mut JobReport)) {
        self.view.send_modify(|(report, _)| {
            report.phase = Phase::Done;
            note(report);
        });
    }

    /// Waits a short time for its end. Returns how far it is then, or the problem that ended it.
    pub async fn settled(&self) -> Result<JobReport, Problem> {
        let mut view = self.view.subscribe();
        let settled = view.wait_for(|(report, _)| report.phase != Phase::Working);
        let _ = timeout(BRIEFLY, settled).await;
        let (report, problem) = self.view.borrow().clone();
        match problem {
            Some(problem) if report.phase == Phase::Failed => Err(problem),
            _ => Ok(report),
        }
    }
}

/// The jobs of a server.
#[derive(Debug)]
pub(crate) struct Jobs {
    turns: Arc<Semaphore>,
    state: Mutex<(u64, VecDeque<Arc<Job>>)>,
    /// For each drive that was written to: who writes has it.
    drives: Mutex<HashMap<String, Arc<tokio::sync::Mutex<()>>>>,
    /// What was written to each drive of this plant and is not saved in it, as requests name it.
    unsaved: Mutex<HashMap<String, BTreeSet<String>>>,
}

impl Default for Jobs {
    fn default() -> Self {
        Self {
            turns: Arc::new(Semaphore::new(WORKING)),
            state: Mutex::default(),
            drives: Mutex::default(),
            unsaved: Mutex::default(),
        }
    }
}

impl Jobs {
    fn state(&self) -> MutexGuard<'_, (u64, VecDeque<Arc<Job>>)> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a job; `restarts` is how many plants were started in the place of the first one.
    pub fn begin(&self, drive: Option<&str>, restarts: u64) -> Arc<Job> {
        let mut state = self.state();
        let (last, jobs) = &mut *state;
        *last += 1;
        let report = JobReport {
            id: *last,
            drive: drive.map(str::to_owned),
            phase: Phase::Working,
            done: 0,
            total: 0,
            plan: None,
            differences: None,
            remarks: Vec::new(),
            file: None,
            problem: None,
        };
        let job = Arc::new(Job {
            id: *last,
            restarts,
            view: watch::Sender::new((report, None)),
            planned: Mutex::new(None),
            turns: Arc::clone(&self.turns),
        });
        jobs.push_back(Arc::clone(&job));
        if jobs.len() > KEPT {
            jobs.pop_front();
        }
        job
    }

    /// Returns a job.
    pub fn get(&self, id: u64) -> Result<Arc<Job>, Problem> {
        let found = self.state().1.iter().find(|job| job.id == id).cloned();
        found.ok_or_else(|| {
            let detail = "there is no such job: it was too long ago, or of another start of this server";
            Problem::new(StatusCode::NOT_FOUND, "job", detail)
        })
    }

    fn unsaved(&self) -> MutexGuard<'_, HashMap<String, BTreeSet<String>>> {
        self.unsaved.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes what a plan has made of a drive.
    pub fn note_written(&self, drive: &str, report: &PlanReport) {
        report.note_unsaved(self.unsaved().entry(drive.to_owned()).or_default());
    }

    /// Returns what was written to a drive and is not saved in it.
    pub fn unsaved_of(&self, drive: &str) -> Vec<String> {
        let unsaved = self.unsaved();
        unsaved.get(drive).into_iter().flatten().cloned().collect()
    }

    /// Forgets what was written: the drives are others.
    pub fn forget_written(&self) {
        self.unsaved().clear();
    }

    /// Returns what whoever writes to a drive holds, so that two plans are not carried out at once.
    pub fn drive(&self, id: &str) -> Arc<tokio::sync::Mutex<()>> {
        let mut drives = self.drives.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(drives.entry(id.to_owned()).or_default())
    }
}
