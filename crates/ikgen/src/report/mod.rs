//! Proof of a solver over random and singular poses.

pub mod poses;
