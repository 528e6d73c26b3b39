//! The PROFIdrive drive profile: parameters, state machine, telegrams, units and faults.
//!
//! Independent of PROFINET, sockets and clocks; it decodes and encodes bytes. A drive and a client are built from
//! the same modules: [`parameter`] (base mode parameter access), [`pkw`] (the
//! older parameter channel in cyclic words and on serial lines), [`state`] (S1 to S5), [`telegram`] (what is where in
//! the cyclic data), [`mod@unit`] (what a raw number means), [`fault`] (the fault buffer), [`catalogue`] (the tables of each
//! drive model), [`model`] (what is known about a kind of drive before it is asked), [`notation`] (how people write
//! parameters and values), [`value`] (a parameter as a person means it: name in, engineering value with unit out).
#![no_std]
#![forbid(unsafe_code)]
extern crate alloc;

pub mod catalogue;
pub mod fault;
pub mod model;
pub mod notation;
pub mod parameter;
pub mod pkw;
pub mod state;
pub mod telegram;
pub mod unit;
pub mod value;
