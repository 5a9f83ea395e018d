//! What a hostile page, program or network sends to the server, over real sockets.

mod running;

use std::io::{BufRead, BufReader, Write};
use std::net::{IpAddr, TcpStream};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

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
        .set_read_timeout(Some(Duration::from_secs(30)))
        .expect("a limit");
    stream
        .write_all(format!("GET /?token={token} HTTP/1.1\r\nHost: {host}\r\n\r\n").as_bytes())
        .expect("sent");
    assert_eq!(status(&read_all(&mut stream)), 303);
    server.kill().expect("it ends");
    let _ = server.wait();
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
