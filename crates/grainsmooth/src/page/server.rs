//! The server: one thread for requests, one for geometry, which owns what is shown.

use std::convert::Infallible;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

use http_body_util::{BodyExt, Full, LengthLimitError, Limited};
use hyper::body::{Bytes, Incoming};
use hyper::header::{HeaderName, HeaderValue};
use hyper::http::request::Parts;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::sync::{Notify, oneshot, watch};

use super::answer::Answer;
use super::assets;
use super::document::PageDocument;
use super::guard::{Admission, Guard};
use crate::Error;

/// Largest body of a command, in bytes: a ray or an edit takes some hundred.
const LARGEST_BODY: usize = 1 << 20;

/// Largest head of a request, in bytes.
const LARGEST_HEAD: usize = 1 << 15;

/// For how long a request may be on its way.
const PATIENCE: Duration = Duration::from_secs(10);

/// After how long a page that waits for news hears that there are none.
const NEWS: Duration = Duration::from_secs(20);

/// What all answers carry: nothing from elsewhere is loaded, and nothing here is framed, kept or told on.
const HEADERS: [(&str, &str); 6] = [
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cache-control", "no-store"),
];

/// A server that listens.
#[derive(Debug)]
pub struct PageServer {
    listener: TcpListener,
    shared: Arc<Shared>,
    document: PageDocument,
    questions: Receiver<Question>,
    revisions: watch::Sender<u64>,
    stop: Arc<Notify>,
}

/// Makes links to a server.
#[derive(Debug, Clone)]
pub struct PageLinks(Arc<Shared>);

/// Ends a server.
#[derive(Debug, Clone)]
pub struct PageStop(Arc<Notify>);

#[derive(Debug)]
struct Shared {
    port: u16,
    guard: Guard,
    geometry: Sender<Question>,
    revision: watch::Receiver<u64>,
}

/// A command for the geometry.
#[derive(Debug)]
struct Question {
    path: String,
    body: Bytes,
    answer: oneshot::Sender<Answer>,
}

impl PageServer {
    /// Listens on 127.0.0.1, at a port or at one that is free.
    ///
    /// # Errors
    /// [`Error::PortTaken`].
    pub fn new(document: PageDocument, port: Option<u16>) -> Result<Self, Error> {
        let taken = |cause| Error::PortTaken { port: port.unwrap_or_default(), cause };
        let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port.unwrap_or_default()));
        let listener = TcpListener::bind(address).map_err(taken)?;
        listener.set_nonblocking(true).map_err(taken)?;
        let port = listener.local_addr().map_err(taken)?.port();
        let guard = Guard::new(port).map_err(taken)?;
        let (geometry, questions) = channel();
        let (revisions, revision) = watch::channel(document.revision());
        let shared = Arc::new(Shared { port, guard, geometry, revision });
        Ok(Self { listener, shared, document, questions, revisions, stop: Arc::default() })
    }

    /// What makes links.
    pub fn links(&self) -> PageLinks {
        PageLinks(Arc::clone(&self.shared))
    }

    /// What ends the server.
    pub fn stop(&self) -> PageStop {
        PageStop(Arc::clone(&self.stop))
    }

    /// Serves until it is stopped.
    ///
    /// # Errors
    /// Where the operating system lacks what a server needs.
    pub fn run(self) -> io::Result<()> {
        let Self { listener, shared, mut document, questions, revisions, stop } = self;
        thread::Builder::new().name("geometry".to_owned()).spawn(move || {
            for Question { path, body, answer } in questions {
                let said = document.answer(&path, &body);
                // Nobody may wait any more, for the answer or for news.
                let _ = answer.send(said);
                revisions.send_if_modified(|revision| {
                    std::mem::replace(revision, document.revision()) != *revision
                });
            }
        })?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            tokio::spawn(accept(listener, shared));
            stop.notified().await;
            Ok(())
        })
    }
}

impl PageLinks {
    /// A link that is good once; the one before is no longer.
    ///
    /// # Errors
    /// Where the operating system has no random numbers.
    pub fn link(&self) -> io::Result<String> {
        Ok(format!("http://127.0.0.1:{}/?t={}", self.0.port, self.0.guard.new_token()?))
    }

    /// The port.
    pub fn port(&self) -> u16 {
        self.0.port
    }
}

impl PageStop {
    /// Ends the server, now or as soon as it runs.
    pub fn stop(&self) {
        self.0.notify_one();
    }
}

async fn accept(listener: tokio::net::TcpListener, shared: Arc<Shared>) {
    loop {
        // Too many open files pass; a server that ends with them does not help.
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        let shared = Arc::clone(&shared);
        let service = service_fn(move |request| {
            let shared = Arc::clone(&shared);
            async move { Ok::<_, Infallible>(response(shared.answer(request).await)) }
        });
        let connection = http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(PATIENCE)
            .max_buf_size(LARGEST_HEAD)
            .serve_connection(TokioIo::new(stream), service);
        // A connection that breaks off concerns its browser alone.
        tokio::spawn(async move { drop(connection.await) });
    }
}

fn response(answer: Answer) -> Response<Full<Bytes>> {
    let mut response = Response::new(Full::new(Bytes::from(answer.body)));
    *response.status_mut() = answer.status;
    let headers = response.headers_mut();
    for (name, value) in HEADERS.into_iter().chain([("content-type", answer.kind)]) {
        headers.insert(HeaderName::from_static(name), HeaderValue::from_static(value));
    }
    if let Some(cookie) = answer.cookie.and_then(|cookie| HeaderValue::try_from(cookie).ok()) {
        headers.insert("set-cookie", cookie);
    }
    response
}

impl Shared {
    async fn answer(&self, request: Request<Incoming>) -> Answer {
        let (head, body) = request.into_parts();
        match self.guard.admit(&head) {
            Err((status, why)) => Answer::refused(status, why),
            Ok(Admission::Cookie) => assets::entrance(self.guard.set_cookie()),
            Ok(Admission::File) => self.file(head.uri.path()),
            Ok(Admission::Command) => self.command(head, body).await,
        }
    }

    fn file(&self, path: &str) -> Answer {
        let page = || (path == "/").then(|| assets::page(self.guard.secret()));
        page()
            .or_else(|| assets::file(path))
            .unwrap_or_else(|| Answer::refused(StatusCode::NOT_FOUND, "there is no such file"))
    }

    async fn command(&self, head: Parts, body: Incoming) -> Answer {
        debug_assert_eq!(head.method, Method::POST);
        let body = match tokio::time::timeout(PATIENCE, Limited::new(body, LARGEST_BODY).collect()).await {
            Ok(Ok(body)) => body.to_bytes(),
            Ok(Err(error)) if error.is::<LengthLimitError>() => {
                return Answer::refused(StatusCode::PAYLOAD_TOO_LARGE, "commands take at most 1 MB");
            }
            Ok(Err(error)) => return Answer::refused(StatusCode::BAD_REQUEST, &error.to_string()),
            Err(_) => return Answer::refused(StatusCode::REQUEST_TIMEOUT, "the command did not come"),
        };
        let path = head.uri.path().to_owned();
        if path == "/news" {
            return self.news(&body).await;
        }
        let (answer, said) = oneshot::channel();
        let failed = || {
            Answer::refused(StatusCode::INTERNAL_SERVER_ERROR, "the program failed; its terminal says why")
        };
        if self.geometry.send(Question { path, body, answer }).is_err() {
            return failed();
        }
        said.await.unwrap_or_else(|_| failed())
    }

    /// Waits until the document is no longer at the revision that a page knows.
    async fn news(&self, body: &[u8]) -> Answer {
        let known: u64 = match serde_json::from_slice(body) {
            Ok(known) => known,
            Err(error) => return Answer::refused(StatusCode::UNPROCESSABLE_ENTITY, &error.to_string()),
        };
        let mut revision = self.revision.clone();
        let changed = revision.wait_for(|now| *now != known);
        let now = match tokio::time::timeout(NEWS, changed).await {
            Ok(Ok(now)) => *now,
            _ => known,
        };
        Answer::json(&now)
    }
}
