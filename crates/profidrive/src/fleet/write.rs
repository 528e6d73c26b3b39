//! One write to many drives: all of them or none.

use client::{Drive, Session};
use futures::{StreamExt, stream};
use profile::value::Assignment;

use super::{AT_ONCE, Member, Selected, each};
use crate::drive::DriveError;
use crate::parameters::{self, Write, Written};

/// What a write would change on each of many drives. Nothing is written yet.
#[derive(Debug)]
pub struct WritePlan {
    members: Vec<Member<Result<Written, DriveError>>>,
}

/// What came of a write to many drives.
pub type WrittenMembers = Vec<Member<Result<Written, DriveError>>>;

/// Plans a write to drives, side by side: [`parameters::plan`] for each.
pub async fn plan_write(
    session: &Session,
    members: Vec<Selected>,
    assignments: &[Assignment],
    wanted: Write,
) -> WritePlan {
    let plan = async |session: &mut Session, drive: &mut Drive| {
        let planned = parameters::plan(session, drive, assignments, wanted).await;
        planned.map_err(DriveError::from)
    };
    WritePlan {
        members: each(session, members, plan).await,
    }
}

impl WritePlan {
    /// Returns the plan of each drive, or why there is none.
    #[must_use]
    pub fn members(&self) -> &[Member<Result<Written, DriveError>>] {
        &self.members
    }

    /// Returns the plans, without the drives whose plan failed.
    pub fn plans(&self) -> impl Iterator<Item = &Written> {
        self.members
            .iter()
            .filter_map(|member| member.result.as_ref().ok())
    }

    /// Returns how many drives would be changed.
    #[must_use]
    pub fn changing(&self) -> usize {
        self.plans().filter(|planned| planned.is_change()).count()
    }

    /// Returns true when every drive has a plan. Otherwise [`carry_out`](Self::carry_out) writes nothing.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.members.iter().all(|member| member.result.is_ok())
    }

    /// Returns the members with their plans, to be shown.
    #[must_use]
    pub fn into_members(self) -> WrittenMembers {
        self.members
    }

    /// Writes to all drives side by side: [`parameters::carry_out`] for each. With one plan that failed nothing is written to any
    /// drive, so that they keep the same settings.
    ///
    /// # Errors
    /// The plan itself, where one of its members failed.
    pub async fn carry_out(self, session: &Session) -> Result<WrittenMembers, Self> {
        if !self.is_whole() {
            return Err(self);
        }
        let all = stream::iter(self.members).map(|Member { name, drive, result }| {
            let mut session = session.clone();
            async move {
                let (mut drive, planned) = drive.zip(result.ok())?;
                let written = parameters::carry_out(&mut session, &mut drive, planned).await;
                Some(Member {
                    name,
                    drive: Some(drive),
                    result: written.map_err(DriveError::from),
                })
            }
        });
        let all: Vec<_> = all.buffered(AT_ONCE).collect().await;
        Ok(all.into_iter().flatten().collect())
    }
}
