//! Loads a compiled knowledge base, plans, executes and records, with no generator linked.

pub mod record;
pub mod view;
