//! Checks that a microcontroller computes the same bits as the host, and the cost of a tick.

use std::path::Path;
use std::process::Command;

const TARGET: &str = "thumbv7em-none-eabihf";

/// Largest number of instructions per firmware tick on the Cortex-M4F.
const BUDGET: u64 = 13_300;

/// Toolchain for the microcontroller.
struct Compiler {
    cargo: String,
    /// Compiler for `-Zbuild-std`. `None`: the default compiler has a library for the target.
    rustc: Option<String>,
}

impl Compiler {
    /// Finds `$FIRMWARE_CARGO` and `$FIRMWARE_RUSTC`, or the current toolchain. `None`: no toolchain supports
    /// the target.
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

/// Runs the firmware on the host and on an emulated board, and compares the outputs.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let Some(compiler) = Compiler::found() else {
        eprintln!("microcontroller: skipped (needs `rustup target add {TARGET}`)");
        return Ok(());
    };
    if Command::new("qemu-system-arm").arg("--version").output().is_err() {
        eprintln!("microcontroller: skipped (needs qemu-system-arm)");
        return Ok(());
    }
    let host = on_host(root)?;
    let board = printed(root, "board", &mut compiler.command())?;
    let Some((results, cost)) = board.trim_end().rsplit_once('\n') else {
        return Err(format!(
            "microcontroller: incomplete output of the board (expected results and cost):\n{board}"
        ));
    };
    if results.trim_end() != host.trim_end() {
        return Err(format!(
            "microcontroller: results differ from the host:\nhost:\n{host}\nboard:\n{board}"
        ));
    }
    println!("{results}\n{cost}, budget {BUDGET}");
    let instructions = cost.rsplit(' ').next().and_then(|count| count.parse::<u64>().ok());
    match instructions {
        Some(count) if count <= BUDGET => Ok(()),
        Some(_) => Err("microcontroller: over budget".to_owned()),
        None => Err(format!("microcontroller: no instruction count in the output of the board: {cost}")),
    }
}

/// Hash of the bits of all ticks on the host, as the firmware prints it.
pub(crate) fn host_hash(root: &Path) -> Result<String, String> {
    let printed = on_host(root)?;
    let hash = printed.split_whitespace().last().filter(|hash| u64::from_str_radix(hash, 16).is_ok());
    hash.map(str::to_owned).ok_or_else(|| format!("firmware: no hash in the output:\n{printed}"))
}

fn on_host(root: &Path) -> Result<String, String> {
    printed(root, "host", Command::new(env!("CARGO")).args(["run", "--release", "--locked"]))
}

/// Output of a command in the firmware folder.
fn printed(root: &Path, target: &str, command: &mut Command) -> Result<String, String> {
    eprintln!("== firmware on the {target}");
    let command = command
        .current_dir(root.join("firmware"))
        .env("CARGO_TARGET_DIR", root.join("target/firmware").join(target));
    let output = command
        .output()
        .map_err(|error| format!("{}: start failed: {error}", command.get_program().to_string_lossy()))?;
    if !output.status.success() {
        return Err(format!("firmware: failed:\n{}", String::from_utf8_lossy(&output.stderr)));
    }
    String::from_utf8(output.stdout).map_err(|error| format!("firmware: output is not valid UTF-8: {error}"))
}
