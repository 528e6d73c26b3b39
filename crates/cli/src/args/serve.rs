//! The workbench in the browser.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Where the certificate is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Tls {
    /// The server makes it, and keeps it in its folder
    SelfSigned,
}

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
    /// Encrypt connections with a certificate that the server makes itself: browsers warn of it until it is accepted. Without
    /// encryption the page is for this computer alone
    #[arg(long, value_enum, value_name = "HOW")]
    pub tls: Option<Tls>,
    /// Encrypt connections with this certificate, with its chain (PEM)
    #[arg(long, value_name = "FILE", requires = "key", conflicts_with = "tls")]
    pub cert: Option<PathBuf>,
    /// The key of the certificate (PEM), which other users cannot read
    #[arg(long, value_name = "FILE", requires = "cert", conflicts_with = "tls")]
    pub key: Option<PathBuf>,
    /// Address of this server through a proxy or under another name
    #[arg(long, value_name = "https://HOST")]
    pub public_url: Option<String>,
    /// Let pages on other computers move axes too: whoever moves a machine has to see it
    #[arg(long, conflicts_with_all = ["read_only", "ip"])]
    pub allow_remote_motion: bool,
    /// Also start the browser
    #[arg(long)]
    pub open: bool,
    /// Change nothing: each page is view-only, and can stop axes
    #[arg(long)]
    pub read_only: bool,
    /// Folder for the log of what people change, in place of that in the state folder of the user
    #[arg(long, value_name = "DIR")]
    pub state_dir: Option<PathBuf>,
    /// What people call this server: "line 3"
    #[arg(long, value_name = "TEXT")]
    pub name: Option<String>,
}
