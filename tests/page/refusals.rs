//! Who is not let in, and what is not done.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use serde_json::json;

use super::served::Served;

fn network(directory: &std::path::Path) {
    std::fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/data/network.vtp"), directory.join("a.vtp")).unwrap();
}

/// A server, and the lines of a GET with a host.
fn served() -> (Served, String) {
    let served = Served::new("view a.vtp", network);
    let host = format!("Host: 127.0.0.1:{}\r\n", served.port);
    (served, host)
}

#[test]
fn links_are_good_once() {
    let (served, host) = served();
    let token = served.link.split_once("/?").unwrap().1.to_owned();
    let get =
        |path: &str, more: &str| served.said(&format!("GET {path} HTTP/1.1\r\n{host}{more}"), b"").status;
    assert_eq!(get("/", ""), 403);
    assert_eq!(get("/?t=0123456789abcdef0123456789abcdef", ""), 403);
    assert_eq!(get(&format!("/?{token}"), ""), 200);
    assert_eq!(get(&format!("/?{token}"), ""), 403, "used");
    assert_eq!(get("/", "Cookie: gs1=0123\r\n"), 403);
}

#[test]
fn cookies_are_kept_from_others() {
    let (served, host) = served();
    let query = served.link.split_once("/?").unwrap().1.to_owned();
    let entered = served.said(&format!("GET /?{query} HTTP/1.1\r\n{host}"), b"");
    let cookie = entered.head.lines().find_map(|line| line.strip_prefix("set-cookie: ")).unwrap();
    assert!(cookie.starts_with(&format!("gs{}=", served.port)), "{cookie}");
    assert!(cookie.ends_with("; HttpOnly; SameSite=Strict; Path=/"), "{cookie}");
    let page = served.said(&format!("GET / HTTP/1.1\r\n{host}Cookie: {cookie}\r\n"), b"");
    for header in [
        "content-security-policy: default-src 'none'; script-src 'self';",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
        "cross-origin-resource-policy: same-origin",
        "cross-origin-opener-policy: same-origin",
        "cache-control: no-store",
    ] {
        assert!(page.head.contains(header), "{header} in {}", page.head);
    }
    assert!(!page.head.contains("access-control"), "{}", page.head);
}

#[test]
fn hosts_are_this_machine() {
    let (served, _) = served();
    let cookie = served.visitor().cookie;
    let get = |host: &str| {
        served.said(&format!("GET / HTTP/1.1\r\nHost: {host}\r\nCookie: {cookie}\r\n"), b"").status
    };
    assert_eq!([get("evil.example"), get("127.0.0.1.evil.example"), get("127.0.0.1:8x")], [421; 3]);
    // A tunnel has a port of its own.
    assert_eq!([get("localhost:9"), get("127.0.0.1"), get("[::1]:8080")], [200; 3]);
    assert_eq!(served.said(&format!("GET / HTTP/1.1\r\nCookie: {cookie}\r\n"), b"").status, 421);
}

#[test]
fn commands_come_from_this_page() {
    let (served, _) = served();
    let visitor = served.visitor();
    let good = visitor.lines("/open");
    let status = |lines: &str| served.said(lines, b"null").status;
    assert_eq!(status(&good), 200);
    let origin = format!("Origin: http://127.0.0.1:{}\r\n", served.port);
    assert!(good.contains(&origin));
    assert_eq!(status(&good.replace(&origin, "Origin: http://evil.example\r\n")), 403);
    assert_eq!(status(&good.replace(&origin, "Origin: http://127.0.0.1:1\r\n")), 403);
    assert_eq!(status(&good.replace(&origin, "Origin: null\r\n")), 403);
    assert_eq!(status(&good.replace(&origin, "")), 403);
    assert_eq!(status(&format!("{good}Sec-Fetch-Site: cross-site\r\n")), 403);
    assert_eq!(status(&format!("{good}Sec-Fetch-Site: same-site\r\n")), 403);
    assert_eq!(status(&format!("{good}Sec-Fetch-Site: same-origin\r\n")), 200);
    assert_eq!(status(&good.replace("application/json", "text/plain")), 415);
    assert_eq!(status(&good.replace(&visitor.secret, "0")), 403);
    assert_eq!(status(&good.replace(&visitor.cookie, "gs1=0")), 403);
}

#[test]
fn paths_are_no_files_of_the_disk() {
    let (served, host) = served();
    let visitor = served.visitor();
    let get = |path: &str| {
        let lines = format!("GET {path} HTTP/1.1\r\n{host}Cookie: {}\r\n", visitor.cookie);
        served.said(&lines, b"").status
    };
    assert_eq!(
        [get("/a.vtp"), get("/../a.vtp"), get("/%2e%2e/a.vtp"), get("//etc/passwd"), get("/main.js/..")],
        [404; 5]
    );
    assert_eq!(get("/main.js"), 200);
    let delete = format!("DELETE / HTTP/1.1\r\n{host}Cookie: {}\r\n", visitor.cookie);
    assert_eq!(served.said(&delete, b"").status, 405);
    assert_eq!(visitor.ask("/nothing", &json!(null)).status, 404);
}

#[test]
fn commands_are_short_and_well_formed() {
    let (served, host) = served();
    let visitor = served.visitor();
    let lines = visitor.lines("/step");
    assert_eq!(served.said(&lines, b"{\"step\": 0").status, 400);
    assert_eq!(served.said(&lines, b"{\"steps\": 0}").status, 422);
    assert_eq!(served.said(&lines, b"{\"step\": -1}").status, 422);
    let beyond = visitor.ask("/step", &json!({ "step": 1 }));
    assert_eq!((beyond.status, &beyond.why()[..]), (422, "there are 1 steps, counted from 0"));
    assert_eq!(visitor.ask("/array", &json!({ "step": 0, "array": 1000 })).status, 422);
    assert_eq!(served.said(&lines, &vec![b' '; 2 << 20]).status, 413);
    let long = format!("GET / HTTP/1.1\r\n{host}Cookie: {}\r\n", "x".repeat(120_000));
    assert_eq!(served.said(&long, b"").status, 431);
}

/// Whoever sends half a request and no more is told off, or cut off, and holds nobody up meanwhile.
#[test]
fn slow_senders_are_not_waited_for() {
    let (served, host) = served();
    let visitor = served.visitor();
    let half = |text: &str| {
        let mut stream = TcpStream::connect(("127.0.0.1", served.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream.write_all(text.as_bytes()).unwrap();
        stream
    };
    let mut head = half(&format!("GET / HTTP/1.1\r\n{host}Cookie: "));
    let mut body =
        half(&format!("{}Connection: close\r\nContent-Length: 100\r\n\r\n{{", visitor.lines("/step")));
    assert_eq!(visitor.ask("/open", &json!(null)).status, 200);
    let mut said = Vec::new();
    head.read_to_end(&mut said).unwrap();
    assert!(!said.starts_with(b"HTTP/1.1 200"), "{}", String::from_utf8_lossy(&said));
    said.clear();
    body.read_to_end(&mut said).unwrap();
    assert!(said.starts_with(b"HTTP/1.1 408 "), "{}", String::from_utf8_lossy(&said));
}

/// What the program says that refuses to serve.
fn refuses(arguments: &str, prepare: impl FnOnce(&std::path::Path)) -> String {
    let directory = tempfile::TempDir::new().unwrap();
    prepare(directory.path());
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_grainsmooth"))
        .args(arguments.split_whitespace())
        .arg("--no-open")
        .current_dir(directory.path())
        .output()
        .unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn what_cannot_be_shown_is_told() {
    let put = |name: &'static str, text: &'static str| {
        move |directory: &std::path::Path| std::fs::write(directory.join(name), text).unwrap()
    };
    let said = refuses("view a.pvd", |_| ());
    assert!(
        said.starts_with("error: a.pvd: cannot be read: ")
            && said.contains("give the path of a readable file"),
        "{said}"
    );
    assert_eq!(
        refuses("view a.pvd", put("a.pvd", "<VTKFile>")),
        "error: a.pvd: names no files; give a collection as ParaView writes it, or the files themselves\n"
    );
    assert_eq!(
        refuses("view a.vtm", put("a.vtm", "<DataSet index=\"0\" name=\"grains\" file=\"b.vtp\"/>")),
        "error: a.vtm: has no block \"boundaries\"; give the file of the network itself, *.vtp, *.vtu or *.vtk\n"
    );
    let (served, _) = served();
    let said = refuses(&format!("view a.vtp --port {}", served.port), network);
    assert!(said.starts_with(&format!("error: port {} of 127.0.0.1: ", served.port)), "{said}");
    assert!(said.ends_with("; give another --port, or leave it out to use a free one\n"), "{said}");
}

/// It leaves nothing, and that is a good end.
#[test]
fn interruption_is_how_it_ends() {
    let (served, _) = served();
    assert_eq!(served.interrupt(), Some(0));
}
