//! What a hostile page, program or network sends to the server, over real sockets.

mod running;

use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::net::{IpAddr, TcpStream};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use grouser_view::feed::Feed;
use grouser_view::server::Shown;
use running::{header, read_all, start, start_with, status};

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
}

#[test]
fn no_connection_becomes_a_web_socket() {
    let server = start_with(None, Some(Feed::new()));
    let cookie = server.sign_in();
    let upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
        Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    for (origin, expected) in [
        ("https://evil.com", 403),
        (&format!("http://{}", server.host()), 405),
    ] {
        let lines = format!("{cookie}Origin: {origin}\r\n{upgrade}");
        let answer = server.get("/api/answer", &lines);
        let found = status(&answer);
        // with a path that is there, the answer is that of a request without an upgrade
        assert!(found == expected || found == 404, "{origin}: {answer}");
        let page = server.get("/", &lines);
        assert_eq!(
            status(&page),
            if expected == 403 { 403 } else { 200 },
            "{origin}"
        );
        assert!(header(&page, "upgrade").is_none());
    }
}

#[test]
fn nothing_can_be_commanded_and_two_pages_see_the_same() {
    let feed = Feed::new();
    feed.add(b"part\0\0\0\0");
    let server = start_with(None, Some(feed));
    let cookie = server.sign_in();
    let (host, writer) = (server.host(), server.writer(&cookie));
    for method in ["PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT"] {
        for path in ["/", "/api/run/0", "/api/answer", "/api/file"] {
            let answer = server.raw(&format!(
                "{method} {path} HTTP/1.1\r\nHost: {host}\r\n{writer}\r\n"
            ));
            assert!(
                matches!(status(&answer), 400 | 405),
                "{method} {path}: {answer}"
            );
        }
    }
    for path in ["/api/run/0", "/api/file", "/"] {
        let answer = server.raw(&format!(
            "POST {path} HTTP/1.1\r\nHost: {host}\r\n{writer}Content-Length: 2\r\n\r\n{{}}"
        ));
        assert_eq!(status(&answer), 405, "{path}: {answer}");
    }
    // an answer depends on its request alone, whatever another page requested before
    let request = r#"{"call": "catalogue"}"#;
    let body = |answer: &str| {
        answer
            .split("\r\n\r\n")
            .nth(1)
            .unwrap_or_default()
            .to_owned()
    };
    let first = body(&server.post(&writer, request));
    server.post(&writer, r#"{"call": "stop", "speed_m_per_s": 1}"#);
    assert_eq!(body(&server.post(&writer, request)), first);
    let parts = server.get("/api/run/0", &cookie);
    assert_eq!(parts, server.get("/api/run/0", &cookie));
}

#[test]
fn a_run_needs_the_session_and_a_number() {
    let feed = Feed::new();
    feed.add(b"secret\0\0");
    let server = start_with(None, Some(feed));
    let answer = server.get("/api/run/0", "");
    assert_eq!(status(&answer), 401);
    assert!(!answer.contains("secret"));
    let cookie = server.sign_in();
    assert!(server.get("/api/run/0", &cookie).contains("secret"));
    for path in [
        "/api/run/",
        "/api/run/-1",
        "/api/run/1e9",
        "/api/run/0/0",
        "/api/run/99999999999999999999999",
    ] {
        assert_eq!(status(&server.get(path, &cookie)), 404, "{path}");
    }
    // a number that is not there yet is waited for, and answered without parts
    let answer = server.get("/api/run/18446744073709551615", &cookie);
    assert!(status(&answer) == 200 && !answer.contains("secret"));
}

/// The program with few descriptors: connections that it cannot accept wait, and it goes on once others end.
#[test]
#[cfg(unix)]
fn without_descriptors_it_waits_and_goes_on() {
    let program = env!("CARGO_BIN_EXE_grouser-view");
    let mut server = Command::new("sh")
        .args(["-c", "ulimit -n 40; exec \"$0\"", program])
        .stdout(Stdio::piped())
        .spawn()
        .expect("a shell");
    let mut line = String::new();
    BufReader::new(server.stdout.take().expect("its output"))
        .read_line(&mut line)
        .expect("a line");
    let address = line.split_whitespace().nth(1).expect("an address");
    let (host, token) = address
        .trim_start_matches("http://")
        .split_once("/?token=")
        .expect("a token");
    let idle: Vec<TcpStream> = (0..120)
        .filter_map(|_| TcpStream::connect(host).ok())
        .collect();
    assert!(idle.len() >= 100, "{}", idle.len());
    thread::sleep(Duration::from_millis(300));
    assert!(server.try_wait().expect("its state").is_none(), "it lives");
    drop(idle);
    let mut stream = TcpStream::connect(host).expect("it listens");
    stream
        .set_read_timeout(Some(Duration::from_mins(10)))
        .expect("a limit");
    stream
        .write_all(format!("GET /?token={token} HTTP/1.1\r\nHost: {host}\r\n\r\n").as_bytes())
        .expect("sent");
    assert_eq!(status(&read_all(&mut stream)), 303);
    server.kill().expect("it ends");
    let _ = server.wait();
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
        status(&server.get(
            "/api/file",
            &format!("Cookie: grouser-view-{}=0\r\n", server.port)
        )),
        401
    );
}

/// A browser keeps one jar of cookies for all ports of a machine: a cookie replaces another of its name.
#[test]
fn two_servers_of_one_machine_do_not_log_each_other_out() {
    let (one, two) = (start(None), start(None));
    let pair = |cookie: &str| {
        let pair = cookie.trim().strip_prefix("Cookie: ").expect("a cookie");
        let (name, value) = pair.split_once('=').expect("a value");
        (name.to_owned(), value.to_owned())
    };
    let jar: std::collections::BTreeMap<String, String> =
        [&one, &two].map(|server| pair(&server.sign_in())).into();
    let pairs: Vec<String> = jar
        .iter()
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    let sent = format!("Cookie: {}\r\n", pairs.join("; "));
    for server in [one, two] {
        assert_eq!(status(&server.get("/", &sent)), 200);
    }
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
    // others are answered meanwhile, while the slow ones are still open
    assert_eq!(status(&server.get("/main.js", &cookie)), 200);
    body.set_nonblocking(true).expect("set");
    let unanswered = body.peek(&mut [0]).expect_err("no answer yet").kind();
    assert_eq!(unanswered, ErrorKind::WouldBlock);
    body.set_nonblocking(false).expect("set");
    let late = read_all(&mut body);
    assert_eq!(status(&late), 408, "{late}");
    for stream in &mut slow {
        let _ = read_all(stream); // ends when the server closes it
    }
    assert_eq!(status(&server.get("/main.js", &cookie)), 200);
}

/// The old file stays, and nothing lies next to it.
#[test]
fn an_export_is_whole_or_refused() {
    let folder = std::env::temp_dir().join(format!("grouser-view-export-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let out = folder.join("run.html");
    std::fs::write(&out, "old").expect("written");
    let export = |file: &std::path::Path| {
        Command::new(env!("CARGO_BIN_EXE_grouser-view"))
            .arg("--export")
            .arg(&out)
            .arg(file)
            .output()
            .expect("it runs")
    };
    let example =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/five-wheel");
    let no_run = folder.join("no.json");
    std::fs::write(&no_run, "{\"runs\": []}").expect("written");
    for file in ["log.mcap", "log.csv", "robot.toml"]
        .map(|name| example.join(name))
        .iter()
        .chain([&no_run])
    {
        let ended = export(file);
        assert_eq!(ended.status.code(), Some(2), "{}", file.display());
        let words = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert!(words.contains("neither a table"), "{words}");
        assert_eq!(std::fs::read(&out).expect("it is there"), b"old");
    }
    let table = folder.join("table.csv");
    std::fs::write(&table, "time_s,wheel,slip,slip_sigma,motion,health\n").expect("written");
    let run = |limit: &str| {
        Command::new("sh")
            .arg("-c")
            .arg(format!("{limit} exec \"$0\" --export \"$1\" \"$2\""))
            .arg(env!("CARGO_BIN_EXE_grouser-view"))
            .args([&out, &table])
            .output()
            .expect("it runs")
    };
    // as a disk that fills up: the file may have 8 KiB
    let full = run("trap '' XFSZ; ulimit -f 16;");
    assert_ne!(full.status.code(), Some(0));
    assert_eq!(std::fs::read(&out).expect("it is there"), b"old");
    assert_eq!(run("").status.code(), Some(0));
    assert!(std::fs::read(&out).expect("it is there").len() > 100_000);
    let names = std::fs::read_dir(&folder).expect("a folder").count();
    assert_eq!(names, 3, "nothing else lies there");
    std::fs::remove_dir_all(folder).expect("removed");
}
