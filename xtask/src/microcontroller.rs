//! Whether a microcontroller computes the same bits as the host, and what a tick costs it.

use std::path::Path;
use std::process::Command;

const TARGET: &str = "thumbv7em-none-eabihf";

/// The most instructions that a tick of the firmware may take on the Cortex-M4F.
const BUDGET: u64 = 10_000;

/// What compiles for the microcontroller.
struct Compiler {
    cargo: String,
    /// Where the compiler has no library for it and must make one: of a distribution.
    rustc: Option<String>,
}

impl Compiler {
    /// That of `$FIRMWARE_CARGO` and `$FIRMWARE_RUSTC`, or the one that runs this, if it knows the target.
    fn found() -> Option<Self> {
        if let (Ok(cargo), Ok(rustc)) = (std::env::var("FIRMWARE_CARGO"), std::env::var("FIRMWARE_RUSTC")) {
            return Some(Self { cargo, rustc: Some(rustc) });
        }
        let asked =
            Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]).output().ok()?;
        let libraries = String::from_utf8(asked.stdout).ok()?;
        Path::new(libraries.trim()).exists().then(|| Self { cargo: env!("CARGO").to_owned(), rustc: None })
    }

    fn command(&self) -> Command {
        let mut command = Command::new(&self.cargo);
        command.args(["run", "--release", "--locked", "--target", TARGET]);
        if let Some(rustc) = &self.rustc {
            command
                .arg("-Zbuild-std=core")
                .env("RUSTC", rustc)
                .env("RUSTC_BOOTSTRAP", "1")
                .env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", "ld.lld");
        }
        command
    }
}

/// Drives the firmware's robot on the host and on an emulated board, and compares what they print.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let Some(compiler) = Compiler::found() else {
        eprintln!("microcontroller: skipped, this needs `rustup target add {TARGET}`");
        return Ok(());
    };
    if Command::new("qemu-system-arm").arg("--version").output().is_err() {
        eprintln!("microcontroller: skipped, this needs qemu-system-arm");
        return Ok(());
    }
    let host = on_host(root)?;
    let board = printed(root, "board", &mut compiler.command())?;
    let Some((told, cost)) = board.trim_end().rsplit_once('\n') else {
        return Err(format!("the board says too little:\n{board}"));
    };
    if told.trim_end() != host.trim_end() {
        return Err(format!("the microcontroller computes something else.\nhost:\n{host}\nboard:\n{board}"));
    }
    println!("{told}\n{cost}, budget {BUDGET}");
    let instructions = cost.rsplit(' ').next().and_then(|count| count.parse::<u64>().ok());
    match instructions {
        Some(count) if count <= BUDGET => Ok(()),
        Some(_) => Err("over budget".to_owned()),
        None => Err(format!("the board does not say what a tick costs: {cost}")),
    }
}

/// Hash of the bits of every tick on the host, as the firmware prints it.
pub(crate) fn host_hash(root: &Path) -> Result<String, String> {
    let printed = on_host(root)?;
    let hash = printed.split_whitespace().last().filter(|hash| u64::from_str_radix(hash, 16).is_ok());
    hash.map(str::to_owned).ok_or_else(|| format!("the firmware prints no hash:\n{printed}"))
}

fn on_host(root: &Path) -> Result<String, String> {
    printed(root, "host", Command::new(env!("CARGO")).args(["run", "--release", "--locked"]))
}

/// What a command prints in the folder of the firmware.
fn printed(root: &Path, target: &str, command: &mut Command) -> Result<String, String> {
    eprintln!("== firmware on the {target}");
    let command = command
        .current_dir(root.join("firmware"))
        .env("CARGO_TARGET_DIR", root.join("target/firmware").join(target));
    let output = command
        .output()
        .map_err(|error| format!("{} does not start: {error}", command.get_program().to_string_lossy()))?;
    if !output.status.success() {
        return Err(format!("the firmware fails:\n{}", String::from_utf8_lossy(&output.stderr)));
    }
    String::from_utf8(output.stdout).map_err(|error| format!("the firmware prints no text: {error}"))
}
