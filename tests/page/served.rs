//! A running server, and requests as bytes.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// The program, serving files in a directory of its own.
pub struct Served {
    child: Child,
    directory: TempDir,
    /// Lines of standard output behind the first.
    pub link: String,
    pub port: u16,
}

/// What a server says.
pub struct Said {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

/// A browser that was let in.
pub struct Visitor {
    port: u16,
    pub cookie: String,
    pub secret: String,
}

impl Served {
    /// Serves with arguments that are split at blanks; `prepare` fills the directory first.
    pub fn new(arguments: &str, prepare: impl FnOnce(&Path)) -> Self {
        let directory = TempDir::new().unwrap();
        prepare(directory.path());
        let mut child = Command::new(env!("CARGO_BIN_EXE_grainsmooth"))
            .args(arguments.split_whitespace())
            .arg("--no-open")
            .current_dir(directory.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut link = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut link).unwrap();
        let link = link.trim_end().to_owned();
        let port = link.split(['/', ':']).nth(4).unwrap().parse().unwrap();
        Self { child, directory, link, port }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    /// How much memory it takes, as Linux tells.
    pub fn megabytes(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        line.split_whitespace().next().unwrap().parse::<f64>().unwrap() / 1024.0
    }

    /// What is served to one who asks with these lines and this body.
    pub fn said(&self, lines: &str, body: &[u8]) -> Said {
        said(self.port, lines, body)
    }

    /// Follows the link.
    pub fn visitor(&self) -> Visitor {
        let query = self.link.split_once("/?").unwrap().1;
        let entered = self.said(&format!("GET /?{query} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n", self.port), b"");
        assert_eq!(entered.status, 200);
        let cookie = entered.head.lines().find_map(|line| line.strip_prefix("set-cookie: ")).unwrap();
        let cookie = cookie.split(';').next().unwrap().to_owned();
        let page = self
            .said(&format!("GET / HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nCookie: {cookie}\r\n", self.port), b"");
        let text = String::from_utf8(page.body).unwrap();
        let secret = text.split("page-secret\" content=\"").nth(1).unwrap().split('"').next().unwrap();
        Visitor { port: self.port, cookie, secret: secret.to_owned() }
    }

    /// Ends it as Ctrl-C does; its exit status.
    pub fn interrupt(mut self) -> Option<i32> {
        let status = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().unwrap();
        assert!(status.success());
        self.child.wait().unwrap().code()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Visitor {
    /// The lines of a command as the page sends it.
    pub fn lines(&self, path: &str) -> String {
        let Self { port, cookie, secret } = self;
        format!(
            "POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\nCookie: {cookie}\r\nX-Page-Secret: {secret}\r\nContent-Type: application/json\r\n"
        )
    }

    pub fn ask(&self, path: &str, words: &Value) -> Said {
        said(self.port, &self.lines(path), words.to_string().as_bytes())
    }
}

impl Said {
    /// Why something was refused.
    pub fn why(&self) -> String {
        let json: Value = serde_json::from_slice(&self.body).unwrap();
        json["refused"].as_str().unwrap().to_owned()
    }

    /// The head of arrays.
    pub fn packed_head(&self) -> Value {
        let length = u32::from_le_bytes(self.body[..4].try_into().unwrap()) as usize;
        serde_json::from_slice(&self.body[4..4 + length]).unwrap()
    }
}

fn said(port: u16, lines: &str, body: &[u8]) -> Said {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    let head = format!("{lines}Connection: close\r\nContent-Length: {}\r\n\r\n", body.len());
    stream.write_all(head.as_bytes()).unwrap();
    // A server that refuses may not read to the end.
    let _ = stream.write_all(body);
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    let end = bytes.windows(4).position(|window| window == b"\r\n\r\n").unwrap();
    let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    Said { status, head, body: bytes[end + 4..].to_vec() }
}
