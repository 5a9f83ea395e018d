//! A server for tests, over real sockets.
#![allow(dead_code, reason = "each test uses a part")]

use std::io::{Read, Write};
use std::net::{IpAddr, TcpStream};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use grouser_view::feed::Feed;
use grouser_view::server::{self, Server, Shown};

/// What takes longer never comes: a loaded machine is slow.
const PATIENCE: Duration = Duration::from_mins(10);

/// A server of its own in a thread, which ends with the tests' process.
pub(crate) struct Running {
    pub(crate) port: u16,
    pub(crate) token: String,
    pub(crate) addresses: Vec<IpAddr>,
}

pub(crate) fn start(shown: Option<Shown>) -> Running {
    start_with(shown, None)
}

pub(crate) fn start_with(shown: Option<Shown>, run: Option<Feed>) -> Running {
    let (ready, started) = mpsc::channel();
    thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .expect("a runtime");
        runtime.block_on(async {
            let mut server = Server::listen(0, shown).await.expect("a free port");
            if let Some(feed) = run {
                let is_live = true;
                server = server.with_run(server::Running { feed, is_live });
            }
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
    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a limit");
        stream
    }

    /// The whole answer to bytes as they stand.
    pub(crate) fn raw(&self, request: &str) -> String {
        let mut stream = self.connect();
        stream.write_all(request.as_bytes()).expect("sent");
        read_all(&mut stream)
    }

    pub(crate) fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    /// A request with this server's host and these further lines.
    pub(crate) fn get(&self, path: &str, lines: &str) -> String {
        let host = self.host();
        self.raw(&format!(
            "GET {path} HTTP/1.1\r\nHost: {host}\r\n{lines}\r\n"
        ))
    }

    pub(crate) fn post(&self, lines: &str, body: &str) -> String {
        let (host, length) = (self.host(), body.len());
        self.raw(&format!(
            "POST /api/answer HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\n{lines}\r\n{body}"
        ))
    }

    /// The cookie for the token.
    pub(crate) fn sign_in(&self) -> String {
        let answer = self.get(&format!("/?token={}", self.token), "");
        assert!(answer.starts_with("HTTP/1.1 303"), "{answer}");
        let cookie = header(&answer, "set-cookie").expect("a cookie");
        assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"));
        let value = cookie.split(';').next().expect("a value");
        format!("Cookie: {value}\r\n")
    }

    /// The lines of a request that may write.
    pub(crate) fn writer(&self, cookie: &str) -> String {
        let host = self.host();
        format!("{cookie}Origin: http://{host}\r\nContent-Type: application/json\r\n")
    }
}

pub(crate) fn read_all(stream: &mut TcpStream) -> String {
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

pub(crate) fn header<'a>(answer: &'a str, name: &str) -> Option<&'a str> {
    let head = answer.split("\r\n\r\n").next()?;
    head.lines().find_map(|line| {
        let (own, value) = line.split_once(": ")?;
        own.eq_ignore_ascii_case(name).then_some(value)
    })
}

pub(crate) fn status(answer: &str) -> u16 {
    let code = answer.split(' ').nth(1).and_then(|code| code.parse().ok());
    code.unwrap_or(0)
}
