//! Files of the checkout, and golden files.

use std::path::{Path, PathBuf};

use robotc_core::spec::{KindParameters, Parameter, ParameterDefault, ParameterKind, ParameterTable, Range};
use robotc_core::system::{ReadError, System};

/// The files below a folder, so that findings name paths that are the same everywhere.
pub(crate) struct Disk {
    pub(crate) root: PathBuf,
}

impl Disk {
    /// The files below a folder of the checkout.
    pub(crate) fn of_checkout(folder: &str) -> Self {
        Self { root: Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder) }
    }
}

impl System for Disk {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        std::fs::read(self.root.join(path)).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => ReadError::NotFound,
            _ => ReadError::Unreadable(error.to_string()),
        })
    }

    fn exists(&self, path: &Path) -> bool {
        self.root.join(path).exists()
    }
}

/// Compares a text with a golden file, or writes it where `BLESS` is set; the difference as a message.
pub(crate) fn compare(golden: &Path, found: &str) -> Result<(), String> {
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(golden, found).map_err(|e| format!("{}: {e}", golden.display()))?;
        return Ok(());
    }
    let expected = std::fs::read_to_string(golden).unwrap_or_default();
    if expected == found {
        return Ok(());
    }
    Err(format!("{} differs (BLESS=1 accepts)\n--- expected\n{expected}--- found\n{found}", golden.display()))
}

/// Parameters of a kind that has one of each sort.
pub(crate) fn parameters() -> ParameterTable {
    const GRASP_SET: &[Parameter] = &[
        Parameter {
            name: "rolls",
            kind: ParameterKind::Integer(1, 64),
            default: ParameterDefault::Integer(8),
            unit: "",
            doc: "Turns about the approach.",
        },
        Parameter {
            name: "standoff",
            kind: ParameterKind::Number(Range::NON_NEGATIVE),
            default: ParameterDefault::Automatic("a tenth of the finger length"),
            unit: "m",
            doc: "Distance kept from the surface.",
        },
        Parameter {
            name: "order",
            kind: ParameterKind::Text(&["best", "nearest"]),
            default: ParameterDefault::Text("best"),
            unit: "",
            doc: "Which grasp comes first.",
        },
        Parameter {
            name: "mirror",
            kind: ParameterKind::Bool,
            default: ParameterDefault::Bool(true),
            unit: "",
            doc: "Whether to add the grasp turned by half a turn.",
        },
    ];
    let grasp_set = KindParameters { kind: "grasp_set", doc: "Grasps of an object.", parameters: GRASP_SET };
    ParameterTable { kinds: vec![grasp_set] }
}
