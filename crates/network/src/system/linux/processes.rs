//! What this program may do, and which process has a UDP port, by the files of the kernel.

use std::collections::BTreeMap;
use std::net::{IpAddr, Ipv4Addr};

use procfs::process::{FDTarget, Process, all_processes};

use crate::system::Rank;
use crate::system::diagnosis::{Permissions, PortHolder};

// linux/capability.h
const CAP_NET_ADMIN: u32 = 12;
const CAP_NET_RAW: u32 = 13;

/// Returns what this program may do.
pub fn permissions() -> Option<Permissions> {
    let effective = Process::myself().ok()?.status().ok()?.capeff;
    let has = |capability: u32| effective >> capability & 1 != 0;
    Some(Permissions {
        raw: has(CAP_NET_RAW),
        admin: has(CAP_NET_ADMIN),
        // in a namespace of users a capability is not enough, and a limit may be
        first: std::thread::spawn(|| super::run_first(Some(Rank::Frames)))
            .join()
            .unwrap_or(false),
    })
}

/// Returns who has a UDP port, apart from this program.
pub fn holders(port: u16) -> Option<Vec<PortHolder>> {
    let mut sockets: BTreeMap<u64, PortHolder> = BTreeMap::new();
    for entry in procfs::net::udp().ok()? {
        if entry.local_address.port() == port {
            let holder = PortHolder {
                address: match entry.local_address.ip() {
                    IpAddr::V4(address) => address,
                    IpAddr::V6(_) => Ipv4Addr::UNSPECIFIED,
                },
                process: None,
                program: None,
            };
            sockets.insert(entry.inode, holder);
        }
    }
    if sockets.is_empty() {
        return Some(Vec::new());
    }
    let own = std::process::id();
    for process in all_processes().into_iter().flatten().flatten() {
        let pid = u32::try_from(process.pid).ok();
        // the files of another user's process are not to be seen
        for file in process.fd().into_iter().flatten().flatten() {
            let FDTarget::Socket(inode) = file.target else {
                continue;
            };
            let Some(holder) = sockets.get_mut(&inode) else {
                continue;
            };
            if pid == Some(own) {
                sockets.remove(&inode);
                continue;
            }
            holder.process = pid;
            holder.program = process.stat().ok().map(|stat| stat.comm);
        }
    }
    Some(sockets.into_values().collect())
}
