//! Who may ask. Every program and every page on this machine, and other users of it, can reach a port of 127.0.0.1; one browser is let in.
//!
//! A link holds a token that is good once and becomes a cookie. Other pages in the same browser would send that cookie along, and a name of
//! theirs may lead to this address (DNS rebinding); so `Host` must be this machine, and commands need this page's `Origin` and a secret
//! that stands in the page alone.

use std::io;
use std::sync::{Mutex, PoisonError};

use hyper::http::request::Parts;
use hyper::{Method, StatusCode};

/// Random bytes of a token: as many as nobody guesses.
const TOKEN_BYTES: usize = 16;

/// Names of this machine. Ports may differ: an ssh tunnel has its own.
const HOSTS: [&str; 3] = ["127.0.0.1", "localhost", "[::1]"];

/// The header with the page's secret.
pub(super) const SECRET_HEADER: &str = "x-page-secret";

/// What lets a browser in.
#[derive(Debug)]
pub(super) struct Guard {
    /// Of the link that is good now.
    token: Mutex<Option<String>>,
    /// Cookies know no ports: two servers on one machine need two names.
    cookie_name: String,
    cookie: String,
    secret: String,
}

/// What a request that is let in may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Admission {
    /// The cookie, for a good token.
    Cookie,
    /// A file of the page.
    File,
    /// What a command answers.
    Command,
}

/// Why a request is not let in.
pub(super) type Refusal = (StatusCode, &'static str);

impl Guard {
    /// For a server at a port; no link is good yet.
    pub(super) fn new(port: u16) -> io::Result<Self> {
        let [cookie, secret] = [random()?, random()?];
        Ok(Self { token: Mutex::new(None), cookie_name: format!("gs{port}"), cookie, secret })
    }

    /// The token of a new link; that of the one before is no longer good.
    pub(super) fn new_token(&self) -> io::Result<String> {
        let token = random()?;
        *self.token.lock().unwrap_or_else(PoisonError::into_inner) = Some(token.clone());
        Ok(token)
    }

    /// What stands in the page, for its commands.
    pub(super) fn secret(&self) -> &str {
        &self.secret
    }

    /// What a browser is to keep.
    pub(super) fn set_cookie(&self) -> String {
        format!("{}={}; HttpOnly; SameSite=Strict; Path=/", self.cookie_name, self.cookie)
    }

    /// Whether a request is let in, and to what.
    ///
    /// # Errors
    /// The status and the reason, where it is not.
    pub(super) fn admit(&self, head: &Parts) -> Result<Admission, Refusal> {
        let host = header(head, "host").unwrap_or_default();
        if !HOSTS.iter().any(|name| is_host(host, name)) {
            return Err((
                StatusCode::MISDIRECTED_REQUEST,
                "this server answers to 127.0.0.1 and localhost alone",
            ));
        }
        let is_get = matches!(head.method, Method::GET | Method::HEAD);
        let token = head.uri.query().and_then(|query| query.strip_prefix("t="));
        // A link may be followed from anywhere: from a mail, from a terminal.
        if let (true, "/", Some(token)) = (is_get, head.uri.path(), token) {
            let is_good = self.use_up(token);
            let why = "this link was used already, or never good; press Enter in the terminal for another";
            return if is_good { Ok(Admission::Cookie) } else { Err((StatusCode::FORBIDDEN, why)) };
        }
        let site = header(head, "sec-fetch-site");
        if site == Some("cross-site") {
            return Err((StatusCode::FORBIDDEN, "asked by another site"));
        }
        if !self.has_cookie(head) {
            return Err((
                StatusCode::FORBIDDEN,
                "open the link that the program printed; Enter in its terminal prints another",
            ));
        }
        if is_get {
            return Ok(Admission::File);
        }
        if head.method != Method::POST {
            return Err((StatusCode::METHOD_NOT_ALLOWED, "GET and POST alone"));
        }
        let origin = header(head, "origin").and_then(|origin| origin.strip_prefix("http://"));
        if origin != Some(host) || site.is_some_and(|site| site != "same-origin") {
            return Err((StatusCode::FORBIDDEN, "not asked by this page"));
        }
        if header(head, "content-type") != Some("application/json") {
            return Err((StatusCode::UNSUPPORTED_MEDIA_TYPE, "commands are application/json"));
        }
        if !header(head, SECRET_HEADER).is_some_and(|secret| is_same(secret, &self.secret)) {
            return Err((StatusCode::FORBIDDEN, "the page is of an earlier run; reload it"));
        }
        Ok(Admission::Command)
    }

    /// Whether a token is good, which it is no longer then.
    fn use_up(&self, token: &str) -> bool {
        let mut current = self.token.lock().unwrap_or_else(PoisonError::into_inner);
        let is_good = current.as_deref().is_some_and(|good| is_same(good, token));
        if is_good {
            *current = None;
        }
        is_good
    }

    fn has_cookie(&self, head: &Parts) -> bool {
        let cookies = head.headers.get_all("cookie").iter().filter_map(|value| value.to_str().ok());
        let mut pairs =
            cookies.flat_map(|line| line.split(';')).filter_map(|pair| pair.trim().split_once('='));
        pairs.any(|(name, value)| name == self.cookie_name && is_same(value, &self.cookie))
    }
}

fn header<'a>(head: &'a Parts, name: &str) -> Option<&'a str> {
    head.headers.get(name)?.to_str().ok()
}

/// Whether a host, with or without a port, has this name.
fn is_host(host: &str, name: &str) -> bool {
    let Some(rest) = host.strip_prefix(name) else { return false };
    rest.is_empty() || rest.strip_prefix(':').is_some_and(|port| port.parse::<u16>().is_ok())
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn is_same(first: &str, second: &str) -> bool {
    let differing = first.bytes().zip(second.bytes()).fold(0, |sum, (a, b)| sum | (a ^ b));
    first.len() == second.len() && differing == 0
}

/// Random bytes of the operating system, as hexadecimal digits.
fn random() -> io::Result<String> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}
