//! The command line as users meet it: transcripts of sessions, compared word for word.
//!
//! Each file of `transcripts/` is a session in a folder of its own, into which `fixtures/` is copied. A line that starts
//! with `$ ` is a command, what follows up to the next one is what it prints: standard output, then standard error with
//! `! ` before each line, then the exit code unless it is 0. Text before the first command says what is shown. Commands:
//!
//! - `robotc ...`, words separated by spaces; ` | head N` at the end keeps the first N lines of standard output;
//! - `replace FILE: OLD => NEW` edits a file; `\n` in what is new starts a line;
//! - `ship FOLDER` copies a folder of `specs/` into the folder of the session;
//! - `cat FILE`.
//!
//! What depends on machine, time or revision is replaced: `<seconds>`, `<time>`, `<size>`, `<hash>`, `<version>`, `<folder>`.
//! `BLESS=1` writes the transcripts anew.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

#[test]
fn sessions_are_as_written() {
    let mut wrong = Vec::new();
    for path in files("transcripts") {
        let written = std::fs::read_to_string(&path).expect("a transcript is text");
        let played = play(&written);
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(&path, &played).expect("a transcript can be written");
        } else if played != written {
            wrong.push(format!("{}:\n{}", path.display(), first_difference(&written, &played)));
        }
    }
    assert!(wrong.is_empty(), "BLESS=1 accepts what is played now\n{}", wrong.join("\n"));
}

#[test]
fn no_file_is_forgotten() {
    let transcripts = files("transcripts");
    let strange: Vec<_> = transcripts.iter().filter(|p| p.extension().is_none_or(|e| e != "txt")).collect();
    assert!(strange.is_empty(), "not transcripts: {strange:?}");
    let read = |path: &PathBuf| std::fs::read_to_string(path).expect("it is text");
    let fixtures = files("fixtures");
    let all: Vec<String> = transcripts.iter().chain(&fixtures).map(read).collect();
    for fixture in fixtures {
        let name = fixture.file_name().expect("a file").to_string_lossy().into_owned();
        assert!(all.iter().any(|text| text.contains(&name)), "no session uses {name}");
    }
}

#[test]
fn the_help_of_every_command_is_in_a_session() {
    let folder = tempfile::tempdir().expect("a folder");
    let sessions: BTreeSet<String> = files("transcripts")
        .iter()
        .flat_map(|path| commands(&std::fs::read_to_string(path).expect("it is text")))
        .collect();
    let mut waiting = vec!["robotc".to_owned()];
    while let Some(command) = waiting.pop() {
        let line = format!("{command} --help");
        assert!(sessions.contains(&line), "add `$ {line}` to tests/transcripts/help.txt, and bless it");
        let (help, _) = run(&line, folder.path());
        let list = help.split("Commands:\n").nth(1).unwrap_or_default();
        // A command is indented by two spaces; what is indented more goes on from the line before.
        let names = list.lines().take_while(|l| !l.is_empty()).filter(|l| !l.starts_with("   "));
        let names = names.filter_map(|l| l.split_whitespace().next()).filter(|name| *name != "help");
        waiting.extend(names.map(|name| format!("{command} {name}")));
    }
}

/// All files in a folder beside this one, sorted.
fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(folder);
    let mut found: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").path()).collect();
    found.sort();
    found
}

/// The commands of a session.
fn commands(session: &str) -> Vec<String> {
    session.lines().filter_map(|line| line.strip_prefix("$ ")).map(str::to_owned).collect()
}

/// Runs the commands of a session in a new folder and writes down what happens.
fn play(written: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    for fixture in files("fixtures") {
        std::fs::copy(&fixture, folder.path().join(fixture.file_name().expect("a file"))).expect("a copy");
    }
    let mut played: String =
        written.lines().take_while(|line| !line.starts_with("$ ")).map(|line| format!("{line}\n")).collect();
    for command in commands(written) {
        let (output, code) = match command.split_once(' ') {
            Some(("replace", edit)) => (replace(edit, folder.path()), 0),
            Some(("ship", name)) => {
                copy(
                    &Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs").join(name),
                    &folder.path().join(name),
                );
                (String::new(), 0)
            }
            _ => run(&command, folder.path()),
        };
        write!(played, "$ {command}\n{}", normal(&output, folder.path())).expect("text");
        if code != 0 {
            writeln!(played, "[exit code {code}]").expect("text");
        }
    }
    played
}

/// Copies a folder with all that is in it.
fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder of `specs/`") {
        let from = entry.expect("an entry").path();
        let to = to.join(from.file_name().expect("a name"));
        if from.is_dir() {
            copy(&from, &to);
        } else {
            std::fs::copy(&from, &to).expect("a copy");
        }
    }
}

/// `FILE: OLD => NEW`.
fn replace(edit: &str, folder: &Path) -> String {
    let (file, change) = edit.split_once(": ").expect("replace FILE: OLD => NEW");
    let (old, new) = change.split_once(" => ").expect("replace FILE: OLD => NEW");
    let path = folder.join(file);
    let text = std::fs::read_to_string(&path).expect("the file is there");
    assert_eq!(text.matches(old).count(), 1, "`{old}` in {file}");
    std::fs::write(path, text.replace(old, &new.replace("\\n", "\n"))).expect("the file can be written");
    String::new()
}

/// Standard output and marked standard error, and the exit code.
fn run(command: &str, folder: &Path) -> (String, i32) {
    let (command, most) = match command.split_once(" | head ") {
        Some((command, lines)) => (command, lines.parse().expect("a number of lines")),
        None => (command, usize::MAX),
    };
    let mut words = command.split_whitespace();
    match words.next() {
        Some("robotc") => {}
        Some("cat") => {
            let file = folder.join(words.next().expect("cat FILE"));
            return (std::fs::read_to_string(file).expect("the file is there"), 0);
        }
        other => panic!("sessions know no command {other:?}"),
    }
    let output = Command::new(env!("CARGO_BIN_EXE_robotc"))
        .args(words)
        .current_dir(folder)
        .env("ROBOTC_STORE", folder.join("store"))
        .env_remove("COLUMNS")
        .stdin(Stdio::null())
        .output()
        .expect("robotc starts");
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let mut text: String = out.lines().take(most).map(|line| format!("{line}\n")).collect();
    for line in err.lines() {
        writeln!(text, "{}", format!("! {line}").trim_end()).expect("text");
    }
    (text, output.status.code().unwrap_or(-1))
}

/// The text without what depends on machine, time or revision.
fn normal(text: &str, folder: &Path) -> String {
    let text = text.replace(&*folder.to_string_lossy(), "<folder>");
    let text = text.replace(&format!("robotc {}", env!("CARGO_PKG_VERSION")), "robotc <version>");
    let mut normal = String::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let mut out: Vec<String> = Vec::new();
        let mut i = 0;
        while i < words.len() {
            let unit = words.get(i + 1).map_or("", |next| next.trim_end_matches([',', ')']));
            let is_number = words[i].trim_start_matches('(').parse::<f64>().is_ok();
            let what = match unit {
                "s" if words[i].contains('.') => "<seconds>",
                "us" => "<time>",
                "B" | "kB" | "MB" | "bytes" => "<size>",
                _ => "",
            };
            if is_number && !what.is_empty() {
                let (open, close) =
                    (if words[i].starts_with('(') { "(" } else { "" }, &words[i + 1][unit.len()..]);
                // The number was aligned by the spaces before it.
                while out.len() > 1 && out.last().is_some_and(String::is_empty) {
                    out.pop();
                }
                out.push(format!("{open}{what}{close}"));
                i += 2;
            } else {
                out.push(without_hash(words[i]));
                i += 1;
            }
        }
        writeln!(normal, "{}", out.join(" ")).expect("text");
    }
    normal
}

/// Replaces a word of 12 or 64 hexadecimal digits; it may stand in parentheses or before a comma.
fn without_hash(word: &str) -> String {
    let digits = word.trim_matches(|c| "(),;:\"".contains(c));
    let is_hash = [12, 64].contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_hexdigit());
    if is_hash { word.replace(digits, "<hash>") } else { word.to_owned() }
}

/// The first line that differs, with its number.
fn first_difference(written: &str, played: &str) -> String {
    let (mut a, mut b) = (written.lines(), played.lines());
    for number in 1.. {
        let (a, b) = (a.next(), b.next());
        if a != b || a.is_none() {
            let show = |line: Option<&str>| line.unwrap_or("(the end)").to_owned();
            return format!("  line {number}\n  written: {}\n  played:  {}", show(a), show(b));
        }
    }
    unreachable!("texts end")
}
