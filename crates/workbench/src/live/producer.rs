//! What brings the topics up to date while visible pages want them.

use std::collections::HashSet;
use std::sync::Arc;
use std::time::Duration;

use profidrive::inspection;
use profidrive::report::{Error, FaultsReport};
use schemars::JsonSchema;
use serde::Serialize;
use tokio::task::JoinSet;
use tokio::time::{MissedTickBehavior, interval, sleep, timeout};

use super::hub::Topic;
use super::samples::{acyclic, cyclic};
use crate::api::{StationsReport, VirtualDrives};
use crate::board::explained;
use crate::shared::Shared;

/// Time between two pictures of the shafts.
const SHAFTS: Duration = Duration::from_millis(100);
/// Time between two readings of faults: one that comes is shown within a second.
const FAULTS: Duration = Duration::from_millis(500);
/// The least time between two pictures of the network, however many drives are read in it, and that for each of its stations: a large
/// one is much work for each page.
const NETWORK: Duration = Duration::from_millis(100);
const STATION: Duration = Duration::from_millis(8);
/// The longest of these times.
const LONGEST: Duration = Duration::from_secs(1);
/// Between two looks whether the time of a plant stands still.
const PAUSED: Duration = Duration::from_millis(500);

/// The faults of a drive, or why they were not read.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct FaultsTopic {
    report: Option<FaultsReport>,
    error: Option<Error>,
}

/// Brings all topics up to date, for ever.
pub(crate) async fn produce(shared: Arc<Shared>) {
    tokio::join!(
        network(Arc::clone(&shared)),
        plant(Arc::clone(&shared)),
        faults(Arc::clone(&shared)),
        cyclic(Arc::clone(&shared)),
        acyclic(shared)
    );
}

async fn network(shared: Arc<Shared>) {
    let mut changes = shared.board.changes();
    loop {
        let paused = shared.is_paused();
        if shared.hub.is_wanted(&Topic::Network) {
            shared.hub.publish(&Topic::Network, &StationsReport::now(&shared));
        }
        let count = shared.board.peek(|stations| stations.known.len());
        let each = STATION.saturating_mul(u32::try_from(count).unwrap_or(u32::MAX));
        sleep(each.clamp(NETWORK, LONGEST)).await;
        // while the time of a plant stands still no station changes
        while let Err(_elapsed) = timeout(PAUSED, changes.changed()).await
            && shared.is_paused() == paused
        {}
    }
}

async fn plant(shared: Arc<Shared>) {
    let mut turn = interval(SHAFTS);
    turn.set_missed_tick_behavior(MissedTickBehavior::Delay);
    while shared.source.is_simulation() {
        turn.tick().await;
        if shared.hub.is_wanted(&Topic::Plant)
            && let Some(drives) = VirtualDrives::now(&shared)
        {
            shared.hub.publish(&Topic::Plant, &drives);
        }
    }
}

async fn faults(shared: Arc<Shared>) {
    let mut turn = interval(FAULTS);
    turn.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut wants = shared.hub.wants();
    let mut busy: HashSet<String> = HashSet::new();
    let mut reading: JoinSet<String> = JoinSet::new();
    loop {
        tokio::select! {
            _ = turn.tick() => {}
            // fails only when the hub is gone
            _ = wants.changed() => {}
            Some(done) = reading.join_next() => {
                match done {
                    Ok(id) => { busy.remove(&id); }
                    // a panic in a reading was printed; its drive is read again
                    Err(_) => busy.clear(),
                }
                continue;
            }
        }
        for topic in shared.hub.wanted() {
            let Topic::Faults(id) = topic else { continue };
            if busy.insert(id.clone()) {
                reading.spawn(read_faults(Arc::clone(&shared), id));
            }
        }
    }
}

async fn read_faults(shared: Arc<Shared>, id: String) -> String {
    let mut network = shared.network.clone();
    let restarts = shared.board.restarts();
    let result = match shared.board.find(&mut network, &id).await {
        Ok(mut drive) => {
            let faults = inspection::faults(&mut network, &mut drive, true).await;
            faults.map_err(|error| explained(&error))
        }
        Err(error) => Err(explained(&error)),
    };
    let (report, error) = match result {
        Ok(report) => (Some(report), None),
        Err(error) => (None, Some(error)),
    };
    if shared.board.restarts() == restarts {
        let topic = Topic::Faults(id.clone());
        shared.hub.publish(&topic, &FaultsTopic { report, error });
    }
    id
}
