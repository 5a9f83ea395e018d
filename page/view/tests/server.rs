//! What a hostile page, program or network sends to the server, over real sockets.

use std::io::{Read, Write};
use std::net::{IpAddr, TcpStream};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use grouser_view::server::{Server, Shown};

/// A server of its own in a thread, which ends with the tests' process.
struct Running {
    port: u16,
    token: String,
    addresses: Vec<IpAddr>,
}

fn start(shown: Option<Shown>) -> Running {
    let (ready, started) = mpsc::channel();
    thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .expect("a runtime");
        runtime.block_on(async {
            let server = Server::listen(0, shown).await.expect("a free port");
            let token = server.address();
            let token = token.split("token=").nth(1).expect("a token").to_owned();
            let addresses = server
                .addresses()
                .iter()
                .map(std::net::SocketAddr::ip)
                .collect();
            ready
                .send(Running {
                    port: server.port(),
                    token,
                    addresses,
                })
                .expect("the test waits");
            server.serve().await.expect("it serves");
        });
    });
    started.recv().expect("it starts")
}

impl Running {
    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream
            .set_read_timeout(Some(Duration::from_secs(30)))
            .expect("a limit");
        stream
    }

    /// The whole answer to bytes as they stand.
    fn raw(&self, request: &str) -> String {
        let mut stream = self.connect();
        stream.write_all(request.as_bytes()).expect("sent");
        read_all(&mut stream)
    }

    fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    /// A request with this server's host and these further lines.
    fn get(&self, path: &str, lines: &str) -> String {
        let host = self.host();
        self.raw(&format!(
            "GET {path} HTTP/1.1\r\nHost: {host}\r\n{lines}\r\n"
        ))
    }

    fn post(&self, lines: &str, body: &str) -> String {
        let (host, length) = (self.host(), body.len());
        self.raw(&format!(
            "POST /api/answer HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\n{lines}\r\n{body}"
        ))
    }

    /// The cookie for the token.
    fn sign_in(&self) -> String {
        let answer = self.get(&format!("/?token={}", self.token), "");
        assert!(answer.starts_with("HTTP/1.1 303"), "{answer}");
        let cookie = header(&answer, "set-cookie").expect("a cookie");
        assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"));
        let value = cookie.split(';').next().expect("a value");
        format!("Cookie: {value}\r\n")
    }

    /// The lines of a request that may write.
    fn writer(&self, cookie: &str) -> String {
        let host = self.host();
        format!("{cookie}Origin: http://{host}\r\nContent-Type: application/json\r\n")
    }
}

fn read_all(stream: &mut TcpStream) -> String {
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

fn header<'a>(answer: &'a str, name: &str) -> Option<&'a str> {
    let head = answer.split("\r\n\r\n").next()?;
    head.lines().find_map(|line| {
        let (own, value) = line.split_once(": ")?;
        own.eq_ignore_ascii_case(name).then_some(value)
    })
}

fn status(answer: &str) -> u16 {
    let code = answer.split(' ').nth(1).and_then(|code| code.parse().ok());
    code.unwrap_or(0)
}

#[test]
fn it_listens_on_this_machine_only_with_a_random_token() {
    let (one, two) = (start(None), start(None));
    assert!(one.addresses.iter().all(IpAddr::is_loopback));
    assert_eq!(one.token.len(), 64); // 256 bits
    assert_ne!(one.token, two.token);
}

#[test]
fn a_host_that_is_not_its_own_is_refused() {
    let server = start(None);
    let cookie = server.sign_in();
    let port = server.port;
    for host in [
        "evil.com".to_owned(),
        format!("evil.com:{port}"),
        format!("127.0.0.1.nip.io:{port}"),
        format!("localhost.:{port}"),
        format!("127.0.0.1:{}", port.wrapping_add(1)),
        "127.0.0.1".to_owned(),
        String::new(),
    ] {
        let answer = server.raw(&format!("GET / HTTP/1.1\r\nHost: {host}\r\n{cookie}\r\n"));
        assert!(matches!(status(&answer), 400 | 403), "{host}: {answer}");
    }
    let own = server.host();
    for request in [
        format!("GET / HTTP/1.1\r\nHost: {own}\r\nHost: evil.com\r\n{cookie}\r\n"),
        format!("GET / HTTP/1.1\r\n{cookie}\r\n"),
        format!("GET http://evil.com/ HTTP/1.1\r\nHost: {own}\r\n{cookie}\r\n"),
    ] {
        let answer = server.raw(&request);
        assert!(matches!(status(&answer), 400 | 403), "{answer}");
    }
    let answer = server.raw(&format!(
        "GET / HTTP/1.1\r\nHost: localhost:{port}\r\n{cookie}\r\n"
    ));
    assert_eq!(status(&answer), 200, "{answer}");
}

#[test]
fn another_sites_page_is_refused() {
    let server = start(None);
    let cookie = server.sign_in();
    let other = format!("http://localhost:{}", server.port.wrapping_add(1));
    for origin in ["https://evil.com", "null", "file://", &other] {
        let lines = format!("{cookie}Origin: {origin}\r\nContent-Type: application/json\r\n");
        assert_eq!(status(&server.post(&lines, "{}")), 403, "{origin}");
        assert_eq!(status(&server.get("/", &lines)), 403, "{origin}");
    }
    for site in ["cross-site", "same-site"] {
        let lines = format!("{cookie}Sec-Fetch-Site: {site}\r\n");
        assert_eq!(status(&server.get("/", &lines)), 403, "{site}");
    }
    // an upgrade to a web socket is no way round: there is none
    let lines = format!(
        "{cookie}Origin: https://evil.com\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
    );
    assert_eq!(status(&server.get("/api/answer", &lines)), 403);
}

#[test]
fn without_its_token_nothing_is_shown_and_a_token_works_once() {
    let server = start(Some(Shown {
        name: "run.csv".into(),
        bytes: b"secret".to_vec(),
    }));
    let prefix = &server.token[..63];
    for path in [
        "/",
        "/main.js",
        "/api/file",
        "/explore.wasm.gz",
        "/?token=",
        "/?token=0",
        &format!("/?token={prefix}"),
        "/?x=1",
    ] {
        let answer = server.get(path, "");
        assert_eq!(status(&answer), 401, "{path}: {answer}");
        assert!(!answer.contains("secret") && !answer.contains(&server.token));
    }
    // not accepted anywhere but in the exchange
    let token = &server.token;
    assert_eq!(
        status(&server.get(&format!("/api/file?token={token}"), "")),
        401
    );
    assert_eq!(
        status(&server.get("/", &format!("Authorization: Bearer {token}\r\n"))),
        401
    );
    let cookie = server.sign_in();
    assert!(
        !cookie.contains(token.as_str()),
        "the session is another secret"
    );
    assert!(server.get("/api/file", &cookie).ends_with("secret"));
    assert_eq!(status(&server.get(&format!("/?token={token}"), "")), 401);
    assert_eq!(
        status(&server.get("/api/file", "Cookie: grouser-view=0\r\n")),
        401
    );
}

#[test]
fn a_form_of_another_site_cannot_write() {
    let server = start(None);
    let cookie = server.sign_in();
    let own = format!("{cookie}Origin: http://{}\r\n", server.host());
    for kind in [
        "text/plain",
        "application/x-www-form-urlencoded",
        "multipart/form-data",
    ] {
        let lines = format!("{own}Content-Type: {kind}\r\n");
        assert_eq!(status(&server.post(&lines, "{}")), 415, "{kind}");
    }
    assert_eq!(status(&server.post(&own, "{}")), 415, "no type");
    let lines = format!("{cookie}Content-Type: application/json\r\n");
    assert_eq!(status(&server.post(&lines, "{}")), 403, "no origin");
}

#[test]
fn bodies_without_end_or_over_the_limit_are_refused_unread() {
    let server = start(None);
    let cookie = server.sign_in();
    let (host, writer) = (server.host(), server.writer(&cookie));
    let begin = format!("POST /api/answer HTTP/1.1\r\nHost: {host}\r\n{writer}");
    let answer = server.raw(&format!("{begin}Content-Length: 2147483648\r\n\r\n{{"));
    assert_eq!(status(&answer), 413, "{answer}");
    let answer = server.raw(&format!("{begin}Transfer-Encoding: chunked\r\n\r\n"));
    assert_eq!(status(&answer), 400, "{answer}");
    for length in ["-1", "1e3", "99999999999999999999999"] {
        let answer = server.raw(&format!("{begin}Content-Length: {length}\r\n\r\n{{}}"));
        assert_eq!(status(&answer), 400, "{length}: {answer}");
    }
    // gzip is not unpacked: the bytes are no request
    let lines = format!("{writer}Content-Encoding: gzip\r\n");
    assert_eq!(status(&server.post(&lines, "\x1f\x08")), 400);
}

#[test]
fn smuggled_and_split_requests_are_refused() {
    let server = start(None);
    let cookie = server.sign_in();
    let (host, writer) = (server.host(), server.writer(&cookie));
    let begin = format!("POST /api/answer HTTP/1.1\r\nHost: {host}\r\n{writer}");
    for lines in [
        "Content-Length: 2\r\nTransfer-Encoding: chunked\r\n",
        "Transfer-Encoding: chunked\r\nContent-Length: 2\r\n",
        "Content-Length: 2\r\nContent-Length: 3\r\n",
    ] {
        let answer = server.raw(&format!("{begin}{lines}\r\n{{}}GET / HTTP/1.1\r\n\r\n"));
        assert_eq!(status(&answer), 400, "{lines}: {answer}");
        assert_eq!(
            answer.matches("HTTP/1.1 ").count(),
            1,
            "one answer: {answer}"
        );
    }
    let answer = server.get("/%0d%0aSet-Cookie:%20x=1", &cookie);
    assert_eq!(status(&answer), 404);
    assert!(header(&answer, "set-cookie").is_none());
}

#[test]
fn no_path_leads_out_of_the_table_of_files() {
    let server = start(None);
    let cookie = server.sign_in();
    let long = format!("/{}", "a".repeat(8000));
    for path in [
        "/../Cargo.toml",
        "/%2e%2e%2fCargo.toml",
        "/%252e%252e/Cargo.toml",
        "/..\\Cargo.toml",
        "//etc/passwd",
        "/etc/passwd",
        "/main.js%00.css",
        "/./main.js",
        "/index.html",
        &long,
    ] {
        let answer = server.get(path, &cookie);
        assert!(
            matches!(status(&answer), 400 | 404 | 414),
            "{path}: {answer}"
        );
    }
    assert_eq!(status(&server.get("/main.js", &cookie)), 200);
}

#[test]
fn requests_that_are_no_requests_are_errors_and_the_server_goes_on() {
    let server = start(None);
    let cookie = server.sign_in();
    let writer = server.writer(&cookie);
    let deep = "[".repeat(100_000);
    let twice = r#"{"call": "catalogue", "call": "fly"}"#;
    for body in [
        deep.as_str(),
        "NaN",
        r#"{"call": 1e999}"#,
        r#"{"call": "wheel", "soil": "x = 1"}"#,
        twice,
        "\u{0}",
    ] {
        let answer = server.post(&writer, body);
        assert_eq!(status(&answer), 400, "{answer}");
        assert!(answer.contains(r#"{"error":"#), "{answer}");
    }
    let answer = server.post(&writer, r#"{"call": "catalogue"}"#);
    assert_eq!(status(&answer), 200);
    assert!(answer.contains(r#""key":"dry-sand""#));
}

#[test]
fn every_answer_has_a_strict_policy_and_names_are_escaped() {
    let name = "\"><img src=x onerror=alert(1)>.csv";
    let server = start(Some(Shown {
        name: name.into(),
        bytes: Vec::new(),
    }));
    let cookie = server.sign_in();
    for (path, lines) in [
        ("/", cookie.as_str()),
        ("/main.js", &cookie),
        ("/none", &cookie),
        ("/", ""),
    ] {
        let answer = server.get(path, lines);
        let policy = header(&answer, "content-security-policy").expect("a policy");
        assert!(
            policy.starts_with("default-src 'none'") && policy.contains("frame-ancestors 'none'")
        );
        assert!(
            !policy.contains("unsafe-inline")
                && !policy.contains("'unsafe-eval'")
                && !policy.contains("http")
        );
        assert_eq!(header(&answer, "x-content-type-options"), Some("nosniff"));
        assert_eq!(header(&answer, "referrer-policy"), Some("no-referrer"));
    }
    let page = server.get("/", &cookie);
    assert!(page.contains("data-file=\"&quot;&gt;&lt;img"), "{page}");
    assert!(!page.contains("<img"));
}

/// One test for all that is slow, since each wait is the server's limit of ten seconds.
#[test]
fn a_thousand_slow_sockets_are_closed_and_delay_nobody() {
    let server = start(None);
    let cookie = server.sign_in();
    let writer = server.writer(&cookie);
    let host = server.host();
    let started = Instant::now();
    let mut slow: Vec<TcpStream> = (0..1000).map(|_| server.connect()).collect();
    for stream in &mut slow {
        stream.write_all(b"G").expect("sent");
    }
    let mut body = server.connect();
    let begin = format!(
        "POST /api/answer HTTP/1.1\r\nHost: {host}\r\n{writer}Content-Length: 100\r\n\r\n{{"
    );
    body.write_all(begin.as_bytes()).expect("sent");
    // a reader that never reads a large answer
    let mut reader = server.connect();
    reader
        .write_all(
            format!("GET /explore.wasm.gz HTTP/1.1\r\nHost: {host}\r\n{cookie}\r\n").as_bytes(),
        )
        .expect("sent");
    // others are answered meanwhile
    for _ in 0..20 {
        let asked = Instant::now();
        assert_eq!(status(&server.get("/main.js", &cookie)), 200);
        assert!(
            asked.elapsed() < Duration::from_secs(2),
            "{:?}",
            asked.elapsed()
        );
    }
    let late = read_all(&mut body);
    assert_eq!(status(&late), 408, "{late}");
    for stream in &mut slow {
        let _ = read_all(stream); // ends when the server closes it
    }
    assert!(
        started.elapsed() < Duration::from_secs(25),
        "{:?}",
        started.elapsed()
    );
    assert_eq!(status(&server.get("/main.js", &cookie)), 200);
}
