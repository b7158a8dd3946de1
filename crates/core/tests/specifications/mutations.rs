//! Texts made worse on purpose: whatever they say, there are findings or a value, and never a panic.

use std::path::Path;

use robotc_core::diag::Sources;
use robotc_core::rng::{Rng, Seed};
use robotc_core::spec::{load_robot, load_task};
use robotc_core::system::{MemorySystem, System};

use super::disk::{Disk, parameters};

/// Pieces of text that upset parsers.
const PIECES: &[&str] = &[
    "[",
    "]",
    "[[",
    "\"",
    "'''",
    "{",
    "}",
    "=",
    "\n",
    "#",
    ",",
    ".",
    "-",
    "nan",
    "inf",
    "1e400",
    "0x",
    "9999999999999999999",
    "\u{0}",
    "é",
    "[[arm]]",
    "[arm]",
    "xyz",
    "name",
    "true",
    "[]",
    "{}",
    "\"palm\"",
    "-1",
    "1e-320",
    "1979-05-27",
    "\\u0000",
];

/// Another digit in place of the first one after `at`.
fn change_digit(text: &mut [char], at: usize, rng: &mut Rng) {
    if let Some(digit) = text[at..].iter_mut().find(|c| c.is_ascii_digit()) {
        *digit = char::from_digit(rng.below(10) as u32, 10).unwrap();
    }
}

/// Takes the line around `at` out and, every other time, puts it in elsewhere.
fn move_line(text: &mut Vec<char>, at: usize, rng: &mut Rng) {
    let start = text[..at].iter().rposition(|&c| c == '\n').map_or(0, |i| i + 1);
    let end = text[at..].iter().position(|&c| c == '\n').map_or(text.len(), |i| at + i + 1);
    let line: Vec<char> = text.drain(start..end).collect();
    if rng.below(2) == 0 && !text.is_empty() {
        let to = rng.below(text.len());
        let to = text[..to].iter().rposition(|&c| c == '\n').map_or(0, |i| i + 1);
        text.splice(to..to, line);
    }
    if text.is_empty() {
        text.push('\n');
    }
}

#[test]
fn mutated_specifications_never_panic() {
    let disk = Disk::of_checkout("tests/specs");
    let mut system = MemorySystem::new();
    for file in
        ["files/arm.urdf", "files/wedge.obj", "files/small.robot.toml", "files/scan.xyz", "files/heights.csv"]
    {
        system.insert(file, disk.read(Path::new(file)).unwrap());
    }
    let robot = String::from_utf8(disk.read(Path::new("files/small.robot.toml")).unwrap()).unwrap();
    let task = "format = 1\nname = \"t\"\nrobot = \"small.robot.toml\"\nseed = 3\nstart = { elbow = 0.5 }\n\
                [[object]]\nname = \"wedge\"\nmesh = \"wedge.obj\"\nup = \"y\"\nmass = 0.1\ncolour = \"#102030\"\n\
                [[obstacle]]\nname = \"can\"\ncylinder = { radius = 0.1, length = 0.2 }\n\
                [[obstacle]]\nname = \"scan\"\ncloud = { file = \"scan.xyz\", radius = 0.01 }\n\
                [[obstacle]]\nname = \"hill\"\nheights = { file = \"heights.csv\", spacing = [0.1, 0.2], floor = -2.0 }\n\
                [[goal]]\nplace = \"wedge\"\nregion = { pose = { xyz = [0, 0, 1] }, size = [0.1, 0.2] }\n\
                [parameters.grasp_set]\nrolls = 4\n";
    let mut rng = Seed::new(7).rng();
    let mut accepted = 0;
    for round in 0..1500 {
        let original = if round % 2 == 0 { robot.as_str() } else { task };
        let mut text: Vec<char> = original.chars().collect();
        for _ in 0..1 + rng.below(3) {
            let at = rng.below(text.len());
            match rng.below(3) {
                0 => {
                    let end = (at + rng.below(12)).min(text.len());
                    let piece: Vec<char> = PIECES[rng.below(PIECES.len())].chars().collect();
                    text.splice(at..end, piece);
                }
                1 => change_digit(&mut text, at, &mut rng),
                _ => move_line(&mut text, at, &mut rng),
            }
        }
        let path = Path::new("files/mutant.toml");
        system.insert(path, text.into_iter().collect::<String>());
        let mut sources = Sources::new();
        let (some, found) = if round % 2 == 0 {
            let (spec, found) = load_robot(&system, &mut sources, path, &parameters());
            (spec.is_some(), found)
        } else {
            let (spec, found) = load_task(&system, &mut sources, path, &parameters());
            (spec.is_some(), found)
        };
        let rendered = found.to_plain_text(&sources);
        assert_ne!(some, found.has_errors(), "{rendered}");
        accepted += usize::from(some);
    }
    // Both outcomes must be met often for the test to mean something.
    assert!((50..1450).contains(&accepted), "{accepted} accepted");
}
