//! The page from this machine, for this machine: 127.0.0.1 and `::1`, with a random token.
//!
//! The program prints an address with a token that works once: it is exchanged for a cookie, which every other
//! request needs. Files come from a table in the program, never from the disk.

use std::fmt::Write as _;
use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::State;
use axum::http::header::{self, HeaderValue};
use axum::http::{Method, Request, Response, StatusCode};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::time::{sleep, timeout};

use grouser_page::{attribute, files, server_policy};

use crate::assets;
use crate::feed::{Feed, PartsFrom};
use crate::gate::{Gate, Refused, same};

/// Longest body of a request, bytes.
const MAX_BODY_BYTES: usize = 1 << 20;
/// How long a request may take to come, and a response to go.
const MAX_REQUEST_TIME: Duration = Duration::from_secs(10);
/// Connections at once; more wait in the system's queue.
const MAX_CONNECTIONS: usize = 4096;
/// Computations at once.
const MAX_COMPUTATIONS: usize = 2;
/// Pause after the system refused a connection, for want of descriptors say.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);

/// A file that the page opens.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Its name.
    pub name: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}

impl Shown {
    /// Does the page show it alone: a table of `grouser estimate -o`, or a report of a run or an answer?
    ///
    /// ```
    /// use grouser_view::server::Shown;
    ///
    /// let shown = |bytes: &[u8]| Shown { name: "run".into(), bytes: bytes.to_vec() };
    /// assert!(shown(b"time_s,wheel,slip,slip_sigma\n").is_of_page());
    /// assert!(!shown(b"[[wheel]]\n").is_of_page());
    /// ```
    #[must_use]
    pub fn is_of_page(&self) -> bool {
        let text = self
            .bytes
            .strip_prefix(b"\xef\xbb\xbf")
            .unwrap_or(&self.bytes);
        if text.starts_with(b"time_s,wheel,slip,") {
            return true;
        }
        let report = serde_json::from_slice::<serde_json::Value>(text).unwrap_or_default();
        let has_runs = report["runs"]
            .as_array()
            .is_some_and(|runs| !runs.is_empty());
        has_runs || report["answer"].is_object()
    }
}

/// A run that the page shows while it is read.
#[derive(Clone, Debug)]
pub struct Running {
    /// Its parts.
    pub feed: Feed,
    /// Is its log still written?
    pub is_live: bool,
}

struct Shared {
    gate: Gate,
    /// The token of the printed address, until it is used.
    token: Mutex<Option<String>>,
    shown: Option<Shown>,
    running: Option<Running>,
    computing: Semaphore,
}

/// A server that listens and does not serve yet.
#[derive(Debug)]
pub struct Server {
    listeners: Vec<TcpListener>,
    port: u16,
    token: String,
    shown: Option<Shown>,
    running: Option<Running>,
}

impl Server {
    /// Listens on 127.0.0.1, and on `::1` where the machine has it; port 0 takes a free one.
    ///
    /// # Errors
    /// What the system refuses: a port that is taken, no randomness.
    pub async fn listen(port: u16, shown: Option<Shown>) -> io::Result<Self> {
        let first = TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port))).await?;
        let port = first.local_addr()?.port();
        let mut listeners = vec![first];
        if let Ok(second) = TcpListener::bind(SocketAddr::from((Ipv6Addr::LOCALHOST, port))).await {
            listeners.push(second);
        }
        Ok(Self {
            listeners,
            port,
            token: secret()?,
            shown,
            running: None,
        })
    }

    /// The same server with a run.
    #[must_use]
    pub fn with_run(self, running: Running) -> Self {
        Self {
            running: Some(running),
            ..self
        }
    }

    /// The port.
    #[must_use]
    pub const fn port(&self) -> u16 {
        self.port
    }

    /// The address to open: its token works once.
    #[must_use]
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.token)
    }

    /// The addresses that it listens on.
    #[must_use]
    pub fn addresses(&self) -> Vec<SocketAddr> {
        self.listeners
            .iter()
            .filter_map(|listener| listener.local_addr().ok())
            .collect()
    }

    /// Serves until the process ends.
    ///
    /// # Errors
    /// No randomness for a session.
    pub async fn serve(self) -> io::Result<()> {
        let shared = Arc::new(Shared {
            gate: Gate::new(self.port, secret()?),
            token: Mutex::new(Some(self.token)),
            shown: self.shown,
            running: self.running,
            computing: Semaphore::new(MAX_COMPUTATIONS),
        });
        let router = Router::new().fallback(answer).with_state(shared);
        let room = Arc::new(Semaphore::new(MAX_CONNECTIONS));
        let mut loops = Vec::new();
        for listener in self.listeners {
            loops.push(tokio::spawn(accept(
                listener,
                router.clone(),
                Arc::clone(&room),
            )));
        }
        for accepting in loops {
            let _ = accepting.await;
        }
        Ok(())
    }
}

/// 256 bits as text.
fn secret() -> io::Result<String> {
    let mut bytes = [0_u8; 32];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        // writing to a string cannot fail
        let _ = write!(text, "{byte:02x}");
    }
    Ok(text)
}

async fn accept(listener: TcpListener, router: Router, room: Arc<Semaphore>) {
    loop {
        let Ok(place) = Arc::clone(&room).acquire_owned().await else {
            return;
        };
        match listener.accept().await {
            Ok((stream, _)) => {
                let router = router.clone();
                tokio::spawn(async move {
                    connection(stream, router).await;
                    drop(place);
                });
            }
            // no descriptor left, say: others end, and the loop goes on
            Err(_) => sleep(ACCEPT_PAUSE).await,
        }
    }
}

/// One connection: a request whose head does not come in time, or a reader that does not read, ends it.
async fn connection(stream: TcpStream, router: Router) {
    let served = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(MAX_REQUEST_TIME)
        .max_buf_size(64 * 1024)
        .keep_alive(false)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router));
    // head, body and response have their own limits; a reader that never reads has this one
    let _ = timeout(4 * MAX_REQUEST_TIME, served).await;
}

async fn answer(State(shared): State<Arc<Shared>>, request: Request<Body>) -> Response<Body> {
    let mut response = match respond(&shared, request).await {
        Ok(response) => response,
        Err((status, reason)) => text(status, reason),
    };
    let headers = response.headers_mut();
    let policy = HeaderValue::from_str(&server_policy());
    for (name, value) in [
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (
            header::HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
        (
            header::HeaderName::from_static("cross-origin-opener-policy"),
            "same-origin",
        ),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if let Ok(policy) = policy {
        headers.insert(header::CONTENT_SECURITY_POLICY, policy);
    }
    response
}

async fn respond(shared: &Arc<Shared>, request: Request<Body>) -> Result<Response<Body>, Refused> {
    shared.gate.check_origin(&request)?;
    let path = request.uri().path().to_owned();
    if request.method() == Method::GET
        && path == "/"
        && let Some(query) = request.uri().query()
    {
        return exchange(shared, query);
    }
    shared.gate.check_session(request.headers())?;
    match (request.method(), path.as_str()) {
        (&Method::GET, "/") => index(shared),
        (&Method::GET, "/api/file") => match &shared.shown {
            Some(shown) => Ok(bytes("application/octet-stream", shown.bytes.clone())),
            None => Err((StatusCode::NOT_FOUND, "no file was given")),
        },
        (&Method::GET, path) if path.starts_with("/api/run/") => match &shared.running {
            Some(running) => {
                let next = path["/api/run/".len()..].parse();
                let next = next.map_err(|_| (StatusCode::NOT_FOUND, "no such part"))?;
                Ok(parts(running.feed.wait_from(next).await))
            }
            None => Err((StatusCode::NOT_FOUND, "no log was given")),
        },
        (&Method::POST, "/api/answer") => compute(shared, request).await,
        (&Method::GET, path) => {
            let name = path.strip_prefix('/').unwrap_or_default();
            let file = assets::find(name).filter(|_| name != "index.html");
            let file = file.ok_or((StatusCode::NOT_FOUND, "no such file"))?;
            Ok(bytes(assets::content_type(name), file))
        }
        _ => Err((StatusCode::METHOD_NOT_ALLOWED, "not here")),
    }
}

/// The token of the printed address for a cookie, once.
fn exchange(shared: &Shared, query: &str) -> Result<Response<Body>, Refused> {
    let wrong = (
        StatusCode::UNAUTHORIZED,
        "the token is wrong or was used: start the program again",
    );
    let given = query.strip_prefix("token=").ok_or(wrong)?;
    let Ok(mut token) = shared.token.lock() else {
        return Err(wrong);
    };
    if !token.as_deref().is_some_and(|token| same(token, given)) {
        return Err(wrong);
    }
    *token = None;
    let cookie = shared.gate.set_cookie();
    let mut response = text(StatusCode::SEE_OTHER, "");
    let headers = response.headers_mut();
    headers.insert(header::LOCATION, HeaderValue::from_static("/"));
    if let Ok(cookie) = HeaderValue::from_str(&cookie) {
        headers.insert(header::SET_COOKIE, cookie);
    }
    Ok(response)
}

fn index(shared: &Shared) -> Result<Response<Body>, Refused> {
    let html = files::text("index.html")
        .map_err(|_| (StatusCode::INTERNAL_SERVER_ERROR, "the page is missing"))?;
    let file = shared.shown.as_ref().map_or_else(String::new, |shown| {
        format!(" data-file=\"{}\"", attribute(&shown.name))
    });
    let run = shared.running.as_ref().map_or("", |running| {
        if running.is_live {
            " data-run=\"live\""
        } else {
            " data-run=\"file\""
        }
    });
    let html = html.replacen(
        "<main id=\"main\"",
        &format!("<main id=\"main\" data-server=\"true\"{file}{run}"),
        1,
    );
    Ok(bytes("text/html; charset=utf-8", html.into_bytes()))
}

async fn compute(shared: &Arc<Shared>, request: Request<Body>) -> Result<Response<Body>, Refused> {
    let too_large = (StatusCode::PAYLOAD_TOO_LARGE, "at most 1 MiB is read");
    let length = request.headers().get(header::CONTENT_LENGTH);
    let length = length
        .and_then(|length| length.to_str().ok()?.parse::<usize>().ok())
        .ok_or((StatusCode::BAD_REQUEST, "the length is no number"))?;
    if length > MAX_BODY_BYTES {
        return Err(too_large);
    }
    let body = timeout(
        MAX_REQUEST_TIME,
        to_bytes(request.into_body(), MAX_BODY_BYTES),
    )
    .await
    .map_err(|_| (StatusCode::REQUEST_TIMEOUT, "the body did not come"))?
    .map_err(|_| too_large)?;
    let request = String::from_utf8(body.to_vec())
        .map_err(|_| (StatusCode::BAD_REQUEST, "the request is no UTF-8"))?;
    let _place = shared
        .computing
        .acquire()
        .await
        .map_err(|_| (StatusCode::SERVICE_UNAVAILABLE, "the server ends"))?;
    let answer = tokio::task::spawn_blocking(move || grouser_page_wasm::answer(&request))
        .await
        .map_err(|_| (StatusCode::INTERNAL_SERVER_ERROR, "the computation failed"))?;
    let refused = answer.starts_with("{\"error\":");
    let mut response = bytes("application/json", answer.into_bytes());
    if refused {
        *response.status_mut() = StatusCode::BAD_REQUEST;
    }
    Ok(response)
}

fn parts(found: PartsFrom) -> Response<Body> {
    let length = found.length();
    let pieces = found.pieces().map(Ok::<_, std::convert::Infallible>);
    let body = Body::from_stream(futures_util::stream::iter(pieces));
    let mut response = bytes("application/octet-stream", body);
    response
        .headers_mut()
        .insert(header::CONTENT_LENGTH, length.into());
    response
}

fn text(status: StatusCode, text: &'static str) -> Response<Body> {
    let mut response = bytes("text/plain; charset=utf-8", text);
    *response.status_mut() = status;
    response
}

fn bytes(kind: &'static str, body: impl Into<Body>) -> Response<Body> {
    let mut response = Response::new(body.into());
    response
        .headers_mut()
        .insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    response
}
