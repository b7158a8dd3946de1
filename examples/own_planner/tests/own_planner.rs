//! The example as users run it.

use std::path::Path;
use std::process::{Command, Output};

fn run(name: &str, text: &str) -> Output {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let file = folder.join(format!("{name}.json"));
    std::fs::write(&file, text).expect("the folder for tests is there");
    Command::new(env!("CARGO_BIN_EXE_robotc-own-planner")).arg(file).output().expect("it starts")
}

fn problem() -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("problem.json")).expect("it is there")
}

#[test]
fn the_own_planner_is_compared_with_those_of_the_library() {
    let output = run("good", &problem());
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let line =
        |name: &str| text.lines().find(|l| l.contains(name)).unwrap_or_else(|| panic!("no {name}: {text}"));
    assert!(line("grid").starts_with('*') && line("grid").contains("goal"), "{text}");
    assert!(line("rrt_connect").starts_with(' ') && line("rrt_connect").contains("smoothed"), "{text}");
    assert!(line("straight").contains("no path"), "{text}");
    assert!(text.contains("the point touches the wall"), "{text}");
}

#[test]
fn mistakes_are_named() {
    let unknown = run("gird", &problem().replace("\"grid\"", "\"gird\""));
    let message = String::from_utf8_lossy(&unknown.stderr).into_owned();
    assert!(
        message.contains("there is no planner gird; there are rrt_connect, rrt_lazy, rrt, straight, grid"),
        "{message}"
    );
    let wrong = run("sead", &problem().replace("\"seed\"", "\"sead\""));
    let message = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert_eq!(message, "warning: `sead` is not known, and ignored; did you mean `seed`?\n");
}
