//! What a virtual drive costs in memory.
#![allow(clippy::unwrap_used)]

use profidrive_plant::DrivePlan;
use profidrive_plant::host::DRIVE_MEMORY;
use virtual_drive::model;

/// Two thousand of them fit into 100 MB, connections included; [`DRIVE_MEMORY`] has room for these and for the receive ring.
const LIMIT: i64 = 40 * 1024;

#[test]
fn a_drive_keeps_less_than_40_kib() {
    let plan = DrivePlan::new("akd-1", &model::AKD);
    // what is made once for all drives is not counted
    let first = plan.build(plan.config(), 1).unwrap();
    let (second, octets) = allocations::kept_by(|| Box::new(plan.build(plan.config(), 2).unwrap()));
    assert!(
        octets < LIMIT,
        "{octets} octets, {} in the box",
        size_of_val(&*second)
    );
    // connection, saved state and its part of the ring come on top
    assert!(u64::try_from(octets).unwrap() + 16 * 1024 < DRIVE_MEMORY);
    drop(first);
}
