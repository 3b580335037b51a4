//! Chromium, driven over a pipe by its DevTools protocol: messages of JSON, each with a zero behind it.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::programs;

/// For how long a page may take to become what is waited for.
const PATIENCE: Duration = Duration::from_secs(60);

pub struct Browser {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    session: Option<String>,
    messages: u64,
    /// What the console of the page said.
    pub console: Vec<Value>,
    _profile: TempDir,
}

impl Browser {
    /// A browser; nothing where there is none.
    pub fn new(test: &str) -> Option<Self> {
        let profile = TempDir::new().unwrap();
        programs::run(test, Command::new("chromium").arg("--version"))?;
        // The shell gives the browser its third and fourth file. Root's needs no sandbox; drawing needs no graphics card.
        let command = format!(
            "exec chromium --headless=new --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader --disable-dev-shm-usage \
             --window-size=1280,800 --user-data-dir='{}' --remote-debugging-pipe about:blank 3<&0 4>&1 0</dev/null 1>/dev/null",
            profile.path().display()
        );
        let mut child = Command::new("sh")
            .args(["-c", &command])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let input = child.stdin.take().unwrap();
        let output = BufReader::new(child.stdout.take().unwrap());
        let mut browser =
            Self { child, input, output, session: None, messages: 0, console: Vec::new(), _profile: profile };
        let targets = browser.call("Target.getTargets", json!({}));
        let targets = targets["targetInfos"].as_array().unwrap();
        let page = targets.iter().find(|target| target["type"] == "page").unwrap();
        let attached = json!({ "targetId": page["targetId"], "flatten": true });
        let attached = browser.call("Target.attachToTarget", attached);
        browser.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, json!({}));
        }
        Some(browser)
    }

    /// What the browser answers to a command of the protocol.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.messages += 1;
        let mut message = json!({ "id": self.messages, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.input.write_all(format!("{message}\0").as_bytes()).unwrap();
        loop {
            let mut bytes = Vec::new();
            self.output.read_until(0, &mut bytes).unwrap();
            assert_eq!(bytes.pop(), Some(0), "the browser ended");
            let said: Value = serde_json::from_slice(&bytes).unwrap();
            if said["id"] == json!(self.messages) {
                // What follows a link goes on to the page by itself, and takes with it what is asked meanwhile: nothing is known then.
                let has_gone_on = method == "Runtime.evaluate"
                    && said["error"]["message"] == json!("Inspected target navigated or closed");
                assert!(said["error"].is_null() || has_gone_on, "{method}: {said}");
                return said["result"].clone();
            }
            let is_console = ["Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded"];
            if is_console.iter().any(|name| said["method"] == *name) {
                self.console.push(said);
            }
        }
    }

    /// Opens a page, and waits until it is ready.
    pub fn open(&mut self, link: &str) {
        self.call("Page.navigate", json!({ "url": link }));
        self.wait("document.body?.dataset.ready === 'true'");
    }

    /// The value of an expression.
    pub fn value(&mut self, expression: &str) -> Value {
        let evaluated = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let said = self.call("Runtime.evaluate", evaluated);
        assert!(said["exceptionDetails"].is_null(), "{expression}: {said}");
        said["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    pub fn wait(&mut self, expression: &str) {
        let start = Instant::now();
        while self.value(expression) != json!(true) {
            let status = "document.getElementById('status')?.textContent";
            assert!(start.elapsed() < PATIENCE, "{expression}; {} {:?}", self.value(status), self.console);
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Sets a control, as a user does.
    pub fn set(&mut self, id: &str, value: &str) {
        self.value(&format!(
            "{{ const control = document.getElementById('{id}'); control.value = '{value}'; control.dispatchEvent(new Event('input')); }}"
        ));
    }

    /// Presses a button, as a user does.
    pub fn press(&mut self, id: &str) {
        self.value(&format!("document.getElementById('{id}').click()"));
    }

    fn mouse(&mut self, kind: &str, [x, y]: [f64; 2], buttons: u32) {
        let button = if kind == "mouseMoved" && buttons == 0 { "none" } else { "left" };
        let event =
            json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", event);
    }

    pub fn hover(&mut self, at: [f64; 2]) {
        self.mouse("mouseMoved", at, 0);
    }

    pub fn click(&mut self, at: [f64; 2]) {
        self.hover(at);
        self.mouse("mousePressed", at, 1);
        self.mouse("mouseReleased", at, 0);
    }

    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.hover(from);
        self.mouse("mousePressed", from, 1);
        for step in 1..=4 {
            let share = f64::from(step) / 4.0;
            self.mouse("mouseMoved", [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis])), 1);
        }
        self.mouse("mouseReleased", to, 0);
    }

    /// The pixels of a part of the page: red, green, blue and alpha each.
    pub fn screenshot(&mut self) -> Vec<u8> {
        let said = self.call("Page.captureScreenshot", json!({}));
        BASE64.decode(said["data"].as_str().unwrap()).unwrap()
    }

    /// Leaves a screenshot for people where `GRAINSMOOTH_SCREENSHOTS` names a directory.
    pub fn leave_screenshot(&mut self, name: &str) {
        if let Some(directory) = std::env::var_os("GRAINSMOOTH_SCREENSHOTS") {
            let bytes = self.screenshot();
            std::fs::write(Path::new(&directory).join(name), bytes).unwrap();
        }
    }

    /// Checks that the console of the page is empty.
    pub fn assert_quiet(&self) {
        assert!(self.console.is_empty(), "{:?}", self.console);
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
