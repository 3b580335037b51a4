//! Runs the program as a process, within limits of time and memory.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, bail};

/// Processor time that a run may take, in seconds.
pub const MOST_SECONDS: u32 = 60;

/// Address space that a run may take, in KiB: 6 GiB, of which a run of 400 grains needs a tenth.
const MOST_MEMORY: u32 = 6 << 20;

/// Wall-clock time after which a run is taken to hang, in seconds: busy neighbours may slow it down much.
const MOST_PATIENCE: u32 = 1200;

/// What the shell does: limits, the program with its output in two files, and then the processor time of what it ran.
const SCRIPT: &str = r#"
ulimit -S -t "$1"; ulimit -v "$2"; patience=$3; out=$4; err=$5; shift 5
timeout -k 5 "$patience" "$@" >"$out" 2>"$err" </dev/null
code=$?; times; exit $code"#;

/// How a process ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Ended {
    /// Its exit code; 128 and more where a signal ended it, and 124 where it hung.
    pub code: i32,
    /// Processor time, in seconds.
    pub seconds: f64,
    /// Standard output.
    pub out: Vec<u8>,
    /// Standard error.
    pub err: String,
}

impl Ended {
    /// Whether the limit of processor time ended it, or it hung.
    pub fn is_out_of_time(&self) -> bool {
        // 128 + SIGXCPU; `timeout`'s own code; 128 + SIGKILL after that.
        [152, 124, 137].contains(&self.code)
    }
}

/// Runs a program in a directory.
///
/// # Errors
/// When there is no shell, or no place for its output.
pub fn run(program: &Path, words: &[String], directory: &Path) -> anyhow::Result<Ended> {
    // Beside the directory, not in it: what the run leaves there is looked at.
    let aside = tempfile::tempdir()?;
    let (out, err) = (aside.path().join("out"), aside.path().join("err"));
    File::create(&out)?;
    File::create(&err)?;
    let output = Command::new("sh")
        .args(["-c", SCRIPT, "sh"])
        .args([MOST_SECONDS, MOST_MEMORY, MOST_PATIENCE].map(|limit| limit.to_string()))
        .args([&out, &err])
        .arg(program)
        .args(words)
        .current_dir(directory)
        .stdin(Stdio::null())
        .output()
        .context("the campaign needs a POSIX shell and coreutils")?;
    let times = String::from_utf8_lossy(&output.stdout);
    let Some(code) = output.status.code() else { bail!("the shell ended by a signal") };
    Ok(Ended {
        code,
        seconds: children_seconds(&times).with_context(|| format!("no times in {times:?}"))?,
        out: fs::read(out)?,
        err: String::from_utf8_lossy(&fs::read(err)?).into_owned(),
    })
}

/// The second line of what `times` prints: user and system time of the shell's children, such as `0m1.25s 0m0.5s`.
fn children_seconds(times: &str) -> Option<f64> {
    let line = times.lines().nth(1)?;
    let seconds = |time: &str| {
        let (minutes, seconds) = time.strip_suffix('s')?.split_once('m')?;
        Some(60.0 * minutes.parse::<f64>().ok()? + seconds.parse::<f64>().ok()?)
    };
    line.split_whitespace().map(seconds).sum()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn times_of_children_are_read() {
        assert_eq!(children_seconds("0m9.0s 0m9.0s\n1m2.5s 0m0.25s\n"), Some(62.75));
        assert_eq!(children_seconds("nothing"), None);
    }

    #[test]
    fn process_is_run_with_its_output_apart() {
        let directory = tempfile::tempdir().unwrap();
        let words = ["-c", "echo out; echo err >&2; exit 3"].map(str::to_owned);
        let ended = run(Path::new("/bin/sh"), &words, directory.path()).unwrap();
        assert_eq!((ended.code, ended.out, ended.err), (3, b"out\n".to_vec(), "err\n".to_owned()));
        assert!(!run(Path::new("/bin/sh"), &words, directory.path()).unwrap().is_out_of_time());
    }
}
