//! Tests of the compiler as a whole.

mod arms;
mod classes;
mod generated;
mod golden;
mod language;
mod real_arms;
