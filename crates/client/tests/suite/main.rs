//! The client against virtual drives in memory and in virtual time: one program for all of it.

mod remote_io;

mod at_work;
mod backup;
mod before;
mod calm;
mod campaign;
mod change;
mod conversation;
mod line;
mod lives;
mod lost;
mod many;
mod models;
mod motion;
mod ownerless;
mod positioning;
mod reach;
mod reporting;
mod run_on;
mod session;
mod set_mode;
mod strange;
mod unread;
