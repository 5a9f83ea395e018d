//! Pages that do not read cost a run nothing. Alone in its file: it measures time.

mod running;

use std::fmt::Write as _;
use std::io::Write as _;
use std::net::TcpStream;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use grouser_view::run::RecordedRun;
use running::start_with;

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/five-wheel");

/// How long the example's log takes, a hundred times over, with the server's pages reading or not.
fn estimating_time(log: &Path, slow: usize) -> Duration {
    let robot = Path::new(EXAMPLE).join("robot.toml");
    let map = Path::new(EXAMPLE).join("columns.toml");
    let run = RecordedRun::open(log, &robot, Some(&map), false).expect("a log");
    let started = Instant::now();
    let feed = run.start();
    let server = start_with(None, Some(feed.clone()));
    let cookie = server.sign_in();
    let sockets: Vec<TcpStream> = (0..slow)
        .map(|i| {
            let mut stream = server.connect();
            let host = server.host();
            // half never end their head, half request the run and never read it
            let request = if i % 2 == 0 {
                "G".to_owned()
            } else {
                format!("GET /api/run/0 HTTP/1.1\r\nHost: {host}\r\n{cookie}\r\n")
            };
            stream.write_all(request.as_bytes()).expect("sent");
            stream
        })
        .collect();
    let mut next = 0;
    loop {
        let answer = feed.from(next);
        next = answer.next;
        for part in answer.parts {
            let text = String::from_utf8_lossy(&part);
            assert!(!text.contains("\"failed\""), "{text}");
            if text.contains("{\"end\":") {
                drop(sockets);
                return started.elapsed();
            }
        }
        thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_thousand_slow_sockets_do_not_slow_a_run() {
    let text = std::fs::read_to_string(Path::new(EXAMPLE).join("log.csv")).expect("the example");
    let folder = std::env::temp_dir().join(format!("grouser-view-slow-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let log = folder.join("log.csv");
    let (head, rows) = text.split_once('\n').expect("a header");
    let mut long = format!("{head}\n");
    for lap in 0..100 {
        for row in rows.lines() {
            let (time, rest) = row.split_once(',').expect("columns");
            let time: u64 = time.parse().expect("a time");
            let _ = writeln!(long, "{},{rest}", time + lap * 40_020);
        }
    }
    std::fs::write(&log, long).expect("written");
    let best = |slow| {
        (0..3)
            .map(|_| estimating_time(&log, slow))
            .min()
            .expect("three")
    };
    let (alone, attacked) = (best(0), best(1000));
    let _ = std::fs::remove_dir_all(&folder);
    println!("alone {alone:?}, with a thousand slow sockets {attacked:?}");
    // opening a thousand sockets takes a while beside the run on a machine of two processors
    assert!(
        attacked < alone * 3 / 2 + Duration::from_millis(400),
        "{alone:?}, {attacked:?}"
    );
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
