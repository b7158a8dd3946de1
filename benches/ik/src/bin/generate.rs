//! Writes the sources of all arms to `generated/`, and the arms themselves for `peers.py`; an arm that the compiler refuses is left out
//! of the comparison.

use std::fmt::Write as _;
use std::path::Path;

use robotc_ik_bench::ARMS;
use robotc_ikgen::backend::COptions;
use robotc_ikgen::{Options, RustOptions, compile};

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("generated");
    std::fs::create_dir_all(&folder)?;
    let mut modules = String::new();
    let mut contenders = String::new();
    let mut arms = Vec::new();
    for arm in ARMS {
        let name = arm.name;
        let compiled = match compile(&arm.chain(), &Options::default()) {
            Ok(compiled) => compiled,
            Err(refusal) => {
                println!("{name}: {refusal}");
                continue;
            }
        };
        println!("{name}: {}", compiled.class);
        let c = compiled.c_source(name, &COptions::default()).map_err(std::io::Error::other)?;
        std::fs::write(folder.join(format!("{name}.h")), c.header)?;
        std::fs::write(folder.join(format!("{name}.c")), c.source)?;
        let axes = arm.axes.iter().map(|(axis, point)| format!("[{axis:?}, {point:?}]"));
        arms.push(format!(
            "{{\"name\": {name:?}, \"axes\": [{}], \"tip\": {:?}, \"given\": {:?}}}",
            axes.collect::<Vec<_>>().join(", "),
            arm.tip,
            compiled.free
        ));
        for (suffix, std) in [("std", true), ("core", false)] {
            let path = folder.join(format!("{name}_{suffix}.rs"));
            std::fs::write(&path, compiled.rust_source(&RustOptions { std, ..RustOptions::default() }))?;
            let _ = writeln!(modules, "#[path = {:?}]\nmod {name}_{suffix};", path.display().to_string());
            let _ = writeln!(contenders, "    contender!({name:?}, {suffix:?}, {name}_{suffix}),");
        }
    }
    std::fs::write(folder.join("arms.json"), format!("[\n{}\n]\n", arms.join(",\n")))?;
    let list = format!(
        "/// The generated solvers.\npub fn all() -> Vec<Generated> {{\n    vec![\n{contenders}    ]\n}}\n"
    );
    std::fs::write(
        folder.join("mod.rs"),
        format!("use crate::contender::{{Generated, contender}};\n\n{modules}\n{list}"),
    )
}
