//! A browser for the replay page's test: the one that is there, or the system's package where that may be installed.

use std::path::Path;
use std::process::{Command, Stdio};

/// Programs that can open a page without a screen, best first.
const NAMES: &[&str] = &["chromium", "chromium-browser", "google-chrome"];

/// Makes a browser available if that is possible without asking anyone; says what it did.
pub(crate) fn prepare() {
    if let Some(name) = NAMES.iter().find(|name| is_there(name)) {
        println!("browser: {name}");
        return;
    }
    if std::env::var_os("ROBOTC_BROWSER").is_some() {
        return;
    }
    let may_install = Path::new("/usr/bin/apt-get").exists() && is_root();
    if !may_install {
        println!(
            "browser: none found and none may be installed here; the page test will say that it was skipped"
        );
        return;
    }
    println!("browser: installing the system's chromium package");
    let quiet = |arguments: &[&str]| {
        Command::new("apt-get")
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|status| status.success())
    };
    let install = ["install", "-y", "--no-install-recommends", "chromium"];
    let installed = quiet(&install) || (quiet(&["update"]) && quiet(&install));
    if !installed {
        println!("browser: the package could not be installed; the page test will say that it was skipped");
    }
}

fn is_there(name: &str) -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&paths).any(|folder| folder.join(name).is_file())
}

fn is_root() -> bool {
    Command::new("id").arg("-u").output().is_ok_and(|out| out.stdout.starts_with(b"0\n"))
}
