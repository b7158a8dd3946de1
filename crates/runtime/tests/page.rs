//! The page in a real browser: a picture is taken, and things are looked for where the camera says they are.

mod scene;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use image::RgbImage;
use robotc_runtime::record::Recording;
use robotc_runtime::view::{self, Camera};

const SIZE: [u32; 2] = [640, 480];

/// A browser that can be driven without a screen: the one named by `ROBOTC_BROWSER`, or the first found on the path.
fn browser() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os("ROBOTC_BROWSER") {
        return Some(named.into());
    }
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    let names = ["chromium", "chromium-browser", "google-chrome"];
    names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name))).find(|p| p.is_file())
}

/// What a browser shows of a page at an address with this hash, and what it wrote to its log.
fn picture(browser: &Path, folder: &Path, hash: &str) -> (RgbImage, String) {
    let shot = folder.join("shot.png");
    let log = folder.join("log.txt");
    let page = folder.join("page.html");
    let mut running = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader"])
        .args(["--enable-unsafe-swiftshader", "--disable-quic", "--disable-background-networking"])
        .args(["--disable-component-update", "--disable-sync", "--no-first-run", "--hide-scrollbars"])
        .args(["--force-device-scale-factor=1", "--enable-logging=stderr"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("--window-size={},{}", SIZE[0], SIZE[1]))
        .arg(format!("--screenshot={}", shot.display()))
        .arg(format!("file://{}#{hash}", page.display()))
        .stdout(Stdio::null())
        .stderr(std::fs::File::create(&log).expect("a log file can be made"))
        .spawn()
        .expect("the browser starts");
    let started = Instant::now();
    while running.try_wait().expect("the browser can be asked").is_none() {
        if started.elapsed() > Duration::from_secs(120) {
            running.kill().expect("the browser can be stopped");
            panic!("the browser took longer than two minutes");
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let log = String::from_utf8_lossy(&std::fs::read(log).expect("the log is there")).into_owned();
    let shot = image::open(&shot).unwrap_or_else(|error| panic!("no picture ({error}):\n{log}"));
    (shot.into_rgb8(), log)
}

/// Lines of the log in which the page complains; the browser itself grumbles about machines without a screen.
fn complaints(log: &str) -> Vec<&str> {
    log.lines().filter(|line| line.contains("CONSOLE") && !line.contains("GL Driver Message")).collect()
}

/// Which of red, green, blue clearly leads in a pixel.
fn leading(pixel: &image::Rgb<u8>) -> Option<usize> {
    let c = pixel.0.map(i32::from);
    (0..3).find(|&k| (0..3).all(|other| other == k || c[k] > c[other] + 50))
}

/// Share of pixels within three of a place in which a colour leads.
fn share(picture: &RgbImage, [x, y]: [f64; 2], colour: usize) -> f64 {
    let around = (-3..=3).flat_map(|dx| (-3..=3).map(move |dy| (x as i32 + dx, y as i32 + dy)));
    let seen: Vec<bool> =
        around.map(|(x, y)| leading(picture.get_pixel(x as u32, y as u32)) == Some(colour)).collect();
    seen.iter().filter(|&&s| s).count() as f64 / seen.len() as f64
}

/// Where the middle of a node is seen at a time.
fn seen_at(recording: &Recording, camera: &Camera, name: &str, time: f64) -> [f64; 2] {
    let node = recording.nodes().position(|n| n.name == name).expect("a node of this name");
    let middle = recording.world_from_node(node, time).translation.vector.into();
    camera.project(&middle).expect("it is ahead of the eye")
}

#[test]
#[allow(clippy::print_stderr, reason = "a test that skips says so")]
fn things_are_seen_where_they_are() {
    let Some(browser) = browser() else {
        eprintln!("skipped: no browser found");
        return;
    };
    let recording = scene::sliding_blocks();
    let camera = Camera::opening(&recording, SIZE.map(f64::from));
    let folder = tempfile::tempdir().expect("a folder can be made");
    std::fs::write(folder.path().join("page.html"), view::html(&recording)).expect("the page can be written");

    let cases = [("t=0", 0.0, 1.0), ("t=0.5&theme=dark", 0.5, 2.0), ("t=end", scene::END, 0.0)];
    for (hash, time, other_time) in cases {
        let (picture, log) = picture(&browser, folder.path(), hash);
        assert_eq!(complaints(&log), [""; 0], "at {hash}");
        assert_eq!(picture.dimensions(), (SIZE[0], SIZE[1]));
        for (colour, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let found = share(&picture, seen_at(&recording, &camera, name, time), colour);
            assert!(found > 0.9, "{name} at {hash}: {found}");
        }
        // Where the red box and the green ball are at another time, they are not now.
        for (colour, name) in ["red", "green"].into_iter().enumerate() {
            let found = share(&picture, seen_at(&recording, &camera, name, other_time), colour);
            assert!(found < 0.5, "{name} of {other_time} s at {hash}: {found}");
        }
    }
}

#[test]
fn the_page_needs_nothing_else_and_keeps_text_as_text() {
    let page = view::html(&scene::sliding_blocks());
    for outside in ["http://", "https://", "import ", "export ", "src=", "@import", "url("] {
        assert!(!page.contains(outside), "the page holds {outside:?}");
    }
    assert!(page.contains("<title>Sliding &lt;blocks> &amp; &quot;balls&quot;</title>"));
    assert_eq!(page.matches("<script").count(), page.matches("</script>").count());
    assert!(!page.contains("{{"), "a place of the template was left empty");
}
