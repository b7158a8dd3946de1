//! The knowledge base as commands use it: where it is, and compiling into it with progress shown.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Instant;

use clap::Args;
use robotc_kb::depot::{self, Depot, DepotError, TransferError};
use robotc_kb::explain::Reason;
use robotc_kb::{
    CompileReport, ContentHash, Event, Graph, Observer, Outcome as NodeOutcome, Project, Store, StoreError,
};

use crate::output::{self, Failure, Outcome};
use crate::progress::Progress;

/// Where the knowledge base is.
#[derive(Args, Clone)]
pub(crate) struct StoreArgs {
    /// Knowledge base: a folder, or the address of one that is shared [default: $ROBOTC_STORE, or robotc in the user's cache
    /// folder]
    #[arg(long, value_name = "WHERE", global = true)]
    store: Option<PathBuf>,
}

impl StoreArgs {
    /// Opens the knowledge base; makes an empty one when there is none.
    pub(crate) fn open(&self) -> Outcome<Arc<Store>> {
        let store = Store::open(&self.folder()?)?;
        Ok(Arc::new(match self.address() {
            None => store,
            Some(address) => store.shared_in(open_depot(&address)?),
        }))
    }

    /// The folder of the knowledge base; for a shared one that of its near copy.
    pub(crate) fn folder(&self) -> Outcome<PathBuf> {
        if let Some(address) = self.address() {
            let name = ContentHash::of(address.as_bytes()).short();
            return Ok(cache_folder()?.join("robotc-near").join(name));
        }
        match self.given() {
            Some(folder) => Ok(folder),
            None => Ok(cache_folder()?.join("robotc")),
        }
    }

    fn given(&self) -> Option<PathBuf> {
        self.store.clone().or_else(|| variable("ROBOTC_STORE"))
    }

    fn address(&self) -> Option<String> {
        self.given()?.into_os_string().into_string().ok().filter(|text| depot::is_address(text))
    }
}

/// Opens a depot; what it needs to know beside its address comes from the environment.
pub(crate) fn open_depot(address: &str) -> Outcome<Box<dyn Depot>> {
    let text =
        |(name, value): (OsString, OsString)| Some((name.into_string().ok()?, value.into_string().ok()?));
    let settings: Vec<_> = std::env::vars_os().filter_map(text).collect();
    Ok(depot::open(address, &settings)?)
}

/// The folder for files that can be made again: `$XDG_CACHE_HOME`, or what the system has in its place.
fn cache_folder() -> Outcome<PathBuf> {
    variable("XDG_CACHE_HOME")
        .or_else(|| variable("LOCALAPPDATA"))
        .or_else(|| variable("HOME").map(|home| home.join(".cache")))
        .ok_or_else(|| Failure::Environment("no cache folder: set ROBOTC_STORE or give --store".into()))
}

fn variable(name: &str) -> Option<PathBuf> {
    std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from)
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        Self::Environment(error.to_string())
    }
}

impl From<DepotError> for Failure {
    fn from(error: DepotError) -> Self {
        Self::Environment(error.to_string())
    }
}

impl From<TransferError> for Failure {
    fn from(error: TransferError) -> Self {
        Self::Environment(error.to_string())
    }
}

/// Plans the artefacts of a project.
pub(crate) fn plan(project: &Project) -> Outcome<Arc<Graph>> {
    Graph::plan(project).map(Arc::new).map_err(|error| Failure::Input(error.to_string()))
}

/// Computes what the knowledge base lacks of a project, with progress on standard error. Ctrl-C stops it; what is
/// finished is kept. The error names everything that could not be computed.
pub(crate) fn compile(graph: &Arc<Graph>, store: &Arc<Store>) -> Outcome<CompileReport> {
    let display = Display::new();
    let report = robotc_kb::compile(graph, store, &display)?;
    drop(display);
    if interrupted() && !report.complete() {
        return Err(Failure::Environment(
            "interrupted; finished artefacts are kept, and compiling again goes on from there".into(),
        ));
    }
    let failures = failures(&report);
    if failures.is_empty() { Ok(report) } else { Err(Failure::Input(failures.join("\n"))) }
}

fn failures(report: &CompileReport) -> Vec<String> {
    let graph = report.knowledge.graph();
    let mut lines = Vec::new();
    for (index, outcome) in graph.indices().zip(&report.outcomes) {
        let title = graph.node(index).title();
        match outcome {
            NodeOutcome::Failed(error) => lines.push(format!("{title}: {error}")),
            NodeOutcome::Blocked(input) => {
                lines.push(format!("{title}: not computed, for want of {}", graph.node(*input).title()));
            }
            NodeOutcome::Reused | NodeOutcome::Built(_) | NodeOutcome::Cancelled => {}
        }
    }
    lines
}

/// Whether Ctrl-C was pressed. From the first call on it no longer ends the program at once; a second time it does.
pub(crate) fn interrupted() -> bool {
    static PRESSED: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    let pressed = PRESSED.get_or_init(|| {
        let pressed = Arc::new(AtomicBool::new(false));
        let handler = pressed.clone();
        // Without a handler Ctrl-C ends the program, which the store survives as well.
        let _ = ctrlc::set_handler(move || {
            if handler.swap(true, Ordering::Relaxed) {
                std::process::exit(2);
            }
        });
        pressed
    });
    pressed.load(Ordering::Relaxed)
}

/// Shows events of a compilation: the oldest running artefact on the progress line, finished ones as lines that stay.
pub(crate) struct Display {
    state: Mutex<State>,
}

impl Display {
    pub(crate) fn new() -> Self {
        Self { state: Mutex::new(State { progress: Progress::new(), running: BTreeMap::new() }) }
    }
}

struct State {
    progress: Progress,
    running: BTreeMap<String, Running>,
}

struct Running {
    start: Instant,
    reason: String,
}

impl Observer for Display {
    fn event(&self, event: Event<'_>) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let State { progress, running } = &mut *state;
        match event {
            Event::Waiting => progress.finish("waiting for another robotc that is compiling"),
            Event::Started { kind, subject, reason } => {
                // That something new is computed needs no reason.
                let reason = match reason {
                    Reason::First => String::new(),
                    reason => format!(" ({reason})"),
                };
                let running_now = Running { start: Instant::now(), reason };
                running.insert(format!("{kind} of {subject}"), running_now);
            }
            Event::Progress { kind, subject, done, total } => {
                let title = format!("{kind} of {subject}");
                let oldest = running.iter().min_by_key(|(_, r)| r.start).map(|(title, _)| title);
                if oldest == Some(&title) {
                    progress.update(&title, done as f64 / total.max(1) as f64);
                }
            }
            Event::Warning { kind, subject, message } => {
                progress.finish(&format!("  {kind} of {subject}: warning: {message}"));
            }
            Event::Brought { kind, subject } => {
                progress.finish(&format!("  {kind} of {subject}: from the shared knowledge base"));
            }
            Event::Stored { kind, subject, size } => {
                let title = format!("{kind} of {subject}");
                let (seconds, reason) = match running.remove(&title) {
                    Some(r) => (r.start.elapsed().as_secs_f64(), r.reason),
                    None => (0.0, String::new()),
                };
                progress.finish(&format!("  {title}: {seconds:.1} s, {}{reason}", output::size(size as u64)));
            }
            Event::Failed { kind, subject, error } => {
                let title = format!("{kind} of {subject}");
                running.remove(&title);
                progress.finish(&format!("  {title}: {error}"));
            }
        }
    }

    fn cancelled(&self) -> bool {
        interrupted()
    }
}
