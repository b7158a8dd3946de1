//! Tests of the compiler as a whole.

#![allow(clippy::print_stdout)]

mod arms;
mod classes;
mod closest;
mod coupled;
mod families;
mod generated;
mod goals;
mod golden;
mod language;
mod preferences;
mod properties;
mod real_arms;
mod redundancy;
