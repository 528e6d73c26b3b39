//! Settings of a drive that are changed for one piece of work. The engine puts them back when the work is over, however it
//! ends.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use profile::value::Reading;

use super::Session;
use crate::engine::Interest;
use crate::engine::{At, at};
use crate::{Drive, Error};

/// How long putting back may take at a drive that hardly answers.
const LIMIT: Duration = Duration::from_secs(30);

/// A setting as it was before.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Before {
    pub value: Reading,
    /// What is written after the value, where that had to be written.
    pub with: Vec<Reading>,
}

/// A setting that was put back, or could not be.
#[derive(Debug)]
pub struct PutBack {
    /// The value before.
    pub value: Reading,
    /// How that ended.
    pub result: Result<(), Error>,
}

/// Settings of a drive that are changed for one piece of work: see [`Session::temporarily`].
///
/// Dropping it puts them back, once no axis of the drive is being brought to rest. The driver of the network sees to that:
/// the drop itself does not wait, works in a panic, and leaving the network waits for it.
#[derive(Debug)]
pub struct TemporaryChange {
    session: Session,
    work: Arc<Work>,
}

/// State shared by a piece of work and the task that restores values.
pub(super) struct Work {
    at: At,
    over: AtomicBool,
    done: AtomicBool,
    open: Mutex<Open>,
}

#[derive(Default)]
struct Open {
    result: Option<Result<Vec<PutBack>, Error>>,
    restored: Option<Box<dyn FnOnce() + Send>>,
}

impl std::fmt::Debug for Work {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Work")
            .field("over", &self.over)
            .finish_non_exhaustive()
    }
}

impl Work {
    fn open(&self) -> MutexGuard<'_, Open> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_over(&self) -> bool {
        self.over.load(Ordering::Acquire)
    }

    pub(super) fn is_done(&self) -> bool {
        self.done.load(Ordering::Acquire)
    }

    pub(super) fn is_of(&self, drive: &Drive) -> bool {
        self.at == at(drive)
    }

    /// The work is over, and its settings are not put back yet.
    pub(super) fn is_ending(&self) -> bool {
        self.is_over() && !self.is_done()
    }
}

impl Session {
    /// Notes settings of a drive that are about to be changed for one piece of work, with their present values. They are
    /// put back when what this returns is [put back](TemporaryChange::put_back) or dropped, and when the network is left.
    ///
    /// # Errors
    /// [`Error::Closed`] when the network is being left: then nothing may be changed any more.
    pub fn temporarily(&self, drive: &Drive, before: &[Reading]) -> Result<TemporaryChange, Error> {
        let alone = |value: &Reading| Before {
            value: value.clone(),
            with: Vec::new(),
        };
        self.change_for_work(drive, before.iter().map(alone).collect())
    }

    pub(super) fn change_for_work(
        &self,
        drive: &Drive,
        before: Vec<Before>,
    ) -> Result<TemporaryChange, Error> {
        // whoever leaves the network from another thread finds the task, or nothing is changed
        let open = self.engine.stay_open()?;
        let work = Arc::new(Work {
            at: at(drive),
            over: AtomicBool::new(false),
            done: AtomicBool::new(false),
            open: Mutex::default(),
        });
        let restorer = Restorer {
            session: self.clone(),
            drive: drive.clone(),
            before,
            work: Arc::clone(&work),
        };
        self.engine.records().temporary.push(Arc::clone(&work));
        self.engine.spawn(restorer.attend());
        drop(open);
        Ok(TemporaryChange {
            session: self.clone(),
            work,
        })
    }
}

impl TemporaryChange {
    /// Calls `restored` once every setting has its value from before. The driver of the network calls it: it must not wait.
    pub fn once_restored(&self, restored: impl FnOnce() + Send + 'static) {
        self.work.open().restored = Some(Box::new(restored));
    }

    /// Puts the settings back and returns those that the drive had not. A caller's wish to stop does not interrupt it; where
    /// this call is dropped, they are put back anyway.
    ///
    /// # Errors
    /// When what the drive has now cannot be read; a value that is refused is reported in the list.
    pub async fn put_back(mut self) -> Result<Vec<PutBack>, Error> {
        let _meanwhile = self.session.unstoppable();
        self.end();
        loop {
            if let Some(result) = self.work.open().result.take() {
                return result;
            }
            // a failure of the wire is part of the result
            if let Err(error) = self.session.look_again().await
                && error.is_final()
            {
                return Err(error);
            }
        }
    }

    fn end(&self) {
        self.work.over.store(true, Ordering::Release);
        self.session.engine().stir();
    }
}

impl Drop for TemporaryChange {
    fn drop(&mut self) {
        self.end();
    }
}

/// Puts settings back when the work is over or the network is left.
struct Restorer {
    session: Session,
    drive: Drive,
    before: Vec<Before>,
    work: Arc<Work>,
}

impl Restorer {
    async fn attend(mut self) {
        let _meanwhile = self.session.unstoppable();
        let engine = self.session.engine().clone();
        let ends = || self.work.is_over() || engine.is_closing();
        if !engine.until(ends).await {
            return;
        }
        self.work.over.store(true, Ordering::Release);
        // where the network is left, this axis too ends
        while engine.records().holds_axis(&self.drive, engine.is_closing()) {
            if let Err(error) = engine
                .next_turn(engine.now() + super::GLANCE, Interest::Events)
                .await
                && error.is_final()
            {
                return;
            }
        }
        let result = self.put_back().await;
        let restored = matches!(&result, Ok(done) if done.iter().all(|one| one.result.is_ok()));
        let then = {
            let mut open = self.work.open();
            open.result = Some(result);
            open.restored.take()
        };
        if let Some(then) = then.filter(|_| restored) {
            then();
        }
        self.work.done.store(true, Ordering::Release);
        engine.stir();
    }

    async fn put_back(&mut self) -> Result<Vec<PutBack>, Error> {
        let _bound = self.session.bound_by(self.session.now() + LIMIT);
        let mut done = Vec::new();
        for Before { value, with } in std::mem::take(&mut self.before) {
            let now = std::slice::from_ref(&value);
            let mut set = self.session.plan_values(&mut self.drive, now).await?;
            if set.is_done() {
                continue;
            }
            let mut result = self.session.apply(&mut self.drive, &mut set).await;
            result = result.and_then(|()| set.accepted());
            if result.is_ok() {
                result = self.session.put_values_back(&mut self.drive, &with).await;
            }
            done.push(PutBack { value, result });
        }
        Ok(done)
    }
}
