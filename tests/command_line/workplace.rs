//! A directory in which the program runs.

use std::fs;
use std::path::PathBuf;

use assert_cmd::Command;
use tempfile::TempDir;

/// What `grains.vtp`, where results go by default, holds before any run.
const OLD_RESULT: &[u8] = b"an earlier result";

/// What a mistake on the command line ends with.
pub const USAGE: i32 = 2;
/// What a failed run ends with.
pub const FAILED: i32 = 1;

pub struct Workplace {
    directory: TempDir,
}

impl Workplace {
    pub fn new() -> Self {
        let workplace = Self { directory: TempDir::new().unwrap() };
        workplace.put("grains.vtp", OLD_RESULT);
        workplace
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    pub fn put(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// What a JSON file holds.
    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.bytes(name)).unwrap()
    }

    /// The program with arguments split at blanks, to be run here.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = assert_cmd::cargo::cargo_bin_cmd!("grainsmooth");
        command.current_dir(self.directory.path());
        command.args(arguments.split_whitespace());
        command
    }

    /// Runs the program, which succeeds; returns what it says.
    pub fn run(&self, arguments: &str) -> String {
        let output = self.command(arguments).assert().success().stdout("").get_output().clone();
        String::from_utf8(output.stderr).unwrap()
    }

    /// Checks that the program says `message` in one line, ends with `code`, and touches nothing here.
    ///
    /// ` ... ` in the message stands for what differs between machines.
    pub fn refuses(&self, arguments: &str, code: i32, message: &str) {
        self.refuses_command(&mut self.command(arguments), code, message);
    }

    pub fn refuses_command(&self, command: &mut Command, code: i32, message: &str) {
        let before = self.content();
        let output = command.assert().code(code).stdout("").get_output().clone();
        let said = String::from_utf8(output.stderr).unwrap();
        // Attempts that were given up stand before it.
        let attempts: usize =
            said.split_inclusive('\n').take_while(|line| line.starts_with("given up ")).map(str::len).sum();
        let said = &said[attempts..];
        // clap adds the usage and the way to the help, after an empty line.
        let (first, rest) = said.split_once('\n').unwrap();
        match code {
            USAGE => assert!(rest.ends_with("For more information, try '--help'.\n"), "{said}"),
            _ => assert_eq!(rest, "", "{said}"),
        }
        let expected = format!("error: {message}");
        let fits = match expected.split_once(" ... ") {
            None => first == expected,
            Some((start, end)) => first.starts_with(start) && first.ends_with(end),
        };
        assert!(fits, "said     {first}\nexpected {expected}");
        assert!(self.content() == before, "{message}: files changed");
    }

    /// Names and bytes of all files here.
    fn content(&self) -> Vec<(PathBuf, Option<Vec<u8>>)> {
        let entries = fs::read_dir(self.directory.path()).unwrap();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        // A directory has no bytes.
        paths.into_iter().map(|path| (path.clone(), fs::read(path).ok())).collect()
    }
}
