//! Which requests are served: host, origin and token of a request, checked before anything else is read.

use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE, COOKIE, HOST, ORIGIN, TRANSFER_ENCODING};
use axum::http::{HeaderMap, HeaderValue, Method, Request, StatusCode};

/// What a request is checked against.
#[derive(Clone, Debug)]
pub(crate) struct Gate {
    /// The values of `Host` that name this server, with its port.
    hosts: Vec<String>,
    /// The cookie that holds the session: browsers send it to every port of the machine, so each server has another.
    cookie_name: String,
    /// The session that the cookie must hold.
    session: String,
}

/// Why a request is refused.
pub(crate) type Refused = (StatusCode, &'static str);

impl Gate {
    pub(crate) fn new(port: u16, session: String) -> Self {
        let hosts = ["127.0.0.1", "localhost", "[::1]"]
            .iter()
            .map(|name| format!("{name}:{port}"))
            .collect();
        Self {
            hosts,
            cookie_name: format!("grouser-view-{port}"),
            session,
        }
    }

    /// The header that sets the cookie.
    pub(crate) fn set_cookie(&self) -> String {
        let (name, session) = (&self.cookie_name, &self.session);
        format!("{name}={session}; HttpOnly; SameSite=Strict; Path=/")
    }

    /// Host and origin: what keeps other sites' pages out, whatever they know.
    pub(crate) fn check_origin<B>(&self, request: &Request<B>) -> Result<(), Refused> {
        let headers = request.headers();
        if request.uri().authority().is_some() {
            return Err((StatusCode::BAD_REQUEST, "the address must be a path"));
        }
        let mut hosts = headers.get_all(HOST).iter();
        let (Some(host), None) = (hosts.next(), hosts.next()) else {
            return Err((StatusCode::BAD_REQUEST, "exactly one host is needed"));
        };
        if !self
            .hosts
            .iter()
            .any(|own| own.as_bytes() == host.as_bytes())
        {
            return Err((StatusCode::FORBIDDEN, "this is not the host's server"));
        }
        let mut origins = headers.get_all(ORIGIN).iter();
        let origin = origins.next();
        if origins.next().is_some() {
            return Err((StatusCode::BAD_REQUEST, "at most one origin is allowed"));
        }
        let own_origin = origin.is_none_or(|origin| {
            let own = origin.as_bytes().strip_prefix(b"http://");
            own == Some(host.as_bytes())
        });
        if !own_origin {
            return Err((
                StatusCode::FORBIDDEN,
                "requests of another site's page are refused",
            ));
        }
        let site = headers.get("sec-fetch-site").map(HeaderValue::as_bytes);
        if !matches!(site, None | Some(b"same-origin" | b"none")) {
            return Err((
                StatusCode::FORBIDDEN,
                "requests of another site's page are refused",
            ));
        }
        if headers.contains_key(TRANSFER_ENCODING) {
            return Err((StatusCode::BAD_REQUEST, "a body needs a length"));
        }
        if request.method() == Method::POST {
            check_write(headers, origin.is_some())?;
        }
        Ok(())
    }

    /// The session in the cookie.
    pub(crate) fn check_session(&self, headers: &HeaderMap) -> Result<(), Refused> {
        let cookies = headers
            .get_all(COOKIE)
            .iter()
            .filter_map(|cookies| cookies.to_str().ok());
        let held = cookies
            .flat_map(|cookies| cookies.split(';'))
            .filter_map(|cookie| cookie.trim().split_once('='))
            .any(|(name, value)| name == self.cookie_name && same(value, &self.session));
        if held {
            Ok(())
        } else {
            Err((
                StatusCode::UNAUTHORIZED,
                "open the address that the program printed",
            ))
        }
    }
}

fn check_write(headers: &HeaderMap, has_origin: bool) -> Result<(), Refused> {
    if !has_origin {
        return Err((
            StatusCode::FORBIDDEN,
            "a request that writes names its origin",
        ));
    }
    let json = headers.get(CONTENT_TYPE).is_some_and(|kind| {
        kind.as_bytes().split(|b| *b == b';').next() == Some(b"application/json")
    });
    if !json {
        return Err((
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            "application/json is needed",
        ));
    }
    let mut lengths = headers.get_all(CONTENT_LENGTH).iter();
    if lengths.next().is_none() || lengths.next().is_some() {
        return Err((StatusCode::LENGTH_REQUIRED, "a body needs one length"));
    }
    Ok(())
}

/// Are two secrets the same? The time does not depend on where they differ.
pub(crate) fn same(left: &str, right: &str) -> bool {
    left.len() == right.len()
        && left
            .bytes()
            .zip(right.bytes())
            .fold(0, |differ, (l, r)| differ | (l ^ r))
            == 0
}
