//! The workbench in the browser.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
pub struct Serve {
    /// Six virtual drives in memory: no network, no hardware
    #[arg(long, conflicts_with_all = ["plant", "ip"])]
    pub demo: bool,
    /// The virtual drives of a plant file, in memory
    #[arg(long, value_name = "FILE", conflicts_with = "ip")]
    pub plant: Option<PathBuf>,
    /// Drives by their addresses: parameters only, without a permission
    #[arg(long, value_name = "A.B.C.D,..", value_delimiter = ',')]
    pub ip: Vec<Ipv4Addr>,
    /// Address and port of the page; port 0 takes a free one
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8934")]
    pub listen: SocketAddr,
    /// Also start the browser
    #[arg(long)]
    pub open: bool,
    /// Change nothing: each page only looks and stops
    #[arg(long)]
    pub read_only: bool,
    /// Let pages move axes of real drives too, on an interface. How soon STOP reaches many drives is not proven yet
    #[arg(long, conflicts_with_all = ["read_only", "demo", "plant", "ip"])]
    pub allow_real_motion: bool,
    /// Folder for the log of what people change, in place of that in the state folder of the user
    #[arg(long, value_name = "DIR")]
    pub state_dir: Option<PathBuf>,
    /// What people call this server: "line 3"
    #[arg(long, value_name = "TEXT")]
    pub name: Option<String>,
}
