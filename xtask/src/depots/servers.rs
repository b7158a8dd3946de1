//! Servers that a campaign starts for itself on this machine: one that speaks S3, and PostgreSQL.

use std::collections::BTreeMap;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, bail, ensure};

/// Speaks S3 and keeps its objects in memory; in an environment of its own.
const PACKAGE: &str = "moto[s3,server]==5.2.5";

/// A process that ends with its handle.
struct Server(Child);

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A port that nobody listens to.
fn free_port() -> anyhow::Result<u16> {
    Ok(TcpListener::bind(("127.0.0.1", 0))?.local_addr()?.port())
}

fn wait_for(port: u16) -> anyhow::Result<()> {
    let end = Instant::now() + Duration::from_secs(120);
    while TcpStream::connect(("127.0.0.1", port)).is_err() {
        ensure!(Instant::now() < end, "nothing answers at port {port}");
        std::thread::sleep(Duration::from_millis(50));
    }
    Ok(())
}

fn call(command: &mut Command) -> anyhow::Result<()> {
    let output = command.output().with_context(|| format!("could not start {command:?}"))?;
    ensure!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}

/// A server with one bucket.
pub(super) struct Bucket {
    pub(super) name: &'static str,
    /// What clients find in their environment.
    pub(super) settings: BTreeMap<String, String>,
    _server: Server,
}

impl Bucket {
    /// `None`, and a word about it, where it cannot be installed.
    pub(super) fn start(folder: &Path) -> anyhow::Result<Option<Self>> {
        let environment = crate::workspace::root().join("target").join("moto");
        let python = environment.join("bin").join("python");
        if !environment.join("bin").join("moto_server").exists() {
            call(Command::new("python3").args(["-m", "venv"]).arg(&environment))?;
            if let Err(error) = call(Command::new(&python).args(["-m", "pip", "install", "--quiet", PACKAGE]))
            {
                println!("s3: skipped: {error:#}");
                return Ok(None);
            }
        }
        let port = free_port()?;
        let log = std::fs::File::create(folder.join("s3.log"))?;
        let server = Command::new(environment.join("bin").join("moto_server"))
            .args(["-H", "127.0.0.1", "-p", &port.to_string()])
            .stdout(Stdio::null())
            .stderr(log)
            .spawn()?;
        let server = Server(server);
        wait_for(port)?;
        let endpoint = format!("http://127.0.0.1:{port}");
        let settings = BTreeMap::from(
            [
                ("AWS_ENDPOINT", endpoint.as_str()),
                ("AWS_ALLOW_HTTP", "true"),
                ("AWS_REGION", "us-east-1"),
                ("AWS_DEFAULT_REGION", "us-east-1"),
                ("AWS_ACCESS_KEY_ID", "campaign"),
                ("AWS_SECRET_ACCESS_KEY", "campaign"),
            ]
            .map(|(name, value)| (name.to_owned(), value.to_owned())),
        );
        let make =
            "import boto3, sys; boto3.client('s3', endpoint_url=sys.argv[1]).create_bucket(Bucket='depot')";
        call(Command::new(python).args(["-c", make, &endpoint]).envs(&settings))?;
        Ok(Some(Self { name: "depot", settings, _server: server }))
    }
}

/// A PostgreSQL server with one database.
pub(super) struct Database {
    pub(super) address: String,
    _server: Server,
}

impl Database {
    /// `None`, and a word about it, where there is no PostgreSQL.
    pub(super) fn start(folder: &Path) -> anyhow::Result<Option<Self>> {
        let Some(programs) = programs() else {
            println!(
                "postgres: skipped: no initdb and postgres found; on Debian, `apt-get install postgresql`"
            );
            return Ok(None);
        };
        // Neither runs as root, who hands them to the user that came with them.
        let own = folder.join("database");
        std::fs::create_dir(&own)?;
        let root = is_root()?;
        if root {
            call(Command::new("chown").arg("postgres").arg(&own))?;
            call(Command::new("chmod").arg("a+rx").arg(folder))?;
        }
        let program = |name: &str| {
            let path = programs.join(name);
            let mut command = if root { Command::new("setpriv") } else { Command::new(&path) };
            if root {
                command.args(["--reuid", "postgres", "--regid", "postgres", "--clear-groups"]).arg(path);
            }
            command.current_dir(&own);
            command
        };
        call(program("initdb").args(["--auth", "trust", "--username", "robotc", "--pgdata", "data"]))?;
        let port = free_port()?;
        let server = program("postgres")
            .args(["-D", "data", "-h", "127.0.0.1", "-k", "", "-p", &port.to_string()])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()?;
        let server = Server(server);
        wait_for(port)?;
        let address = format!("postgres://robotc@127.0.0.1:{port}/postgres");
        let database = Self { address, _server: server };
        let end = Instant::now() + Duration::from_secs(60);
        while database.ask("SELECT 1").is_err() {
            if Instant::now() > end {
                bail!("the database does not start");
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        Ok(Some(database))
    }

    fn ask(&self, statement: &str) -> anyhow::Result<()> {
        call(Command::new("psql").args(["--no-psqlrc", "--quiet", "-c", statement, &self.address]))
    }

    /// Empties the database.
    pub(super) fn clear(&self) -> anyhow::Result<()> {
        self.ask("DROP SCHEMA IF EXISTS robotc CASCADE")
    }
}

/// The folder of `initdb` and `postgres`: one of the path, or where Debian keeps them, the newest first.
fn programs() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let mut packaged: Vec<PathBuf> = std::fs::read_dir("/usr/lib/postgresql")
        .into_iter()
        .flatten()
        .filter_map(|version| Some(version.ok()?.path().join("bin")))
        .collect();
    packaged.sort();
    std::env::split_paths(&path)
        .chain(packaged.into_iter().rev())
        .find(|folder| folder.join("initdb").exists() && folder.join("postgres").exists())
}

fn is_root() -> anyhow::Result<bool> {
    let output = Command::new("id").arg("-u").output().context("could not ask who this is")?;
    Ok(output.stdout.trim_ascii() == b"0")
}
