//! As much of HTTP/1.1 as one page needs: one request a connection, bounded in size and in time.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Bytes of the request line and the headers at most.
const MOST_HEAD: usize = 16 << 10;
/// Bytes of a body at most.
const MOST_BODY: usize = 64 << 10;
/// Time within which a request must have come, and within which an answer must have gone.
const PATIENCE: Duration = Duration::from_secs(3);

/// A request whose head and body have come.
#[derive(Debug, PartialEq)]
pub(super) struct Request {
    pub(super) method: String,
    pub(super) path: String,
    /// Names in lower case.
    headers: Vec<(String, String)>,
    pub(super) body: Vec<u8>,
}

impl Request {
    /// The value of a header that is there once; `None` where it is not there, or more than once.
    pub(super) fn header(&self, name: &str) -> Option<&str> {
        let mut found = self.headers.iter().filter(|header| header.0 == name);
        match (found.next(), found.next()) {
            (Some(header), None) => Some(&header.1),
            _ => None,
        }
    }

    /// Whether a header is there at all.
    pub(super) fn has(&self, name: &str) -> bool {
        self.headers.iter().any(|header| header.0 == name)
    }
}

/// What is sent back.
#[derive(Debug, PartialEq)]
pub(super) struct Response {
    pub(super) status: u16,
    pub(super) kind: &'static str,
    pub(super) body: Vec<u8>,
}

impl Response {
    pub(super) fn json(body: Vec<u8>) -> Self {
        Self {
            status: 200,
            kind: "application/json",
            body,
        }
    }

    pub(super) fn html(body: &str) -> Self {
        Self {
            status: 200,
            kind: "text/html; charset=utf-8",
            body: body.as_bytes().to_vec(),
        }
    }

    /// A refusal, with its reason for people.
    pub(super) fn refused(status: u16, reason: &str) -> Self {
        Self {
            status,
            kind: "text/plain; charset=utf-8",
            body: format!("{reason}\n").into_bytes(),
        }
    }

    /// Sends it; nobody is told when the other side has gone.
    pub(super) fn send(&self, stream: &mut TcpStream) -> io::Result<()> {
        let reason = match self.status {
            200 => "OK",
            400 => "Bad Request",
            403 => "Forbidden",
            404 => "Not Found",
            405 => "Method Not Allowed",
            408 => "Request Timeout",
            413 => "Content Too Large",
            _ => "Error",
        };
        let head = format!(
            "HTTP/1.1 {} {reason}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
             X-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\nReferrer-Policy: no-referrer\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n\r\n",
            self.status,
            self.kind,
            self.body.len()
        );
        stream.set_write_timeout(Some(PATIENCE))?;
        stream.write_all(head.as_bytes())?;
        stream.write_all(&self.body)?;
        stream.flush()
    }
}

/// Reads one request; the refusal where it is not one, is too large, or takes too long.
pub(super) fn read(stream: &mut TcpStream) -> Result<Request, Response> {
    let deadline = Instant::now() + PATIENCE;
    let mut bytes = Vec::new();
    let end = loop {
        if let Some(end) = end_of_head(&bytes) {
            break end;
        }
        if bytes.len() > MOST_HEAD {
            return Err(Response::refused(
                413,
                "the head of the request is too large",
            ));
        }
        read_more(stream, &mut bytes, deadline)?;
    };
    let mut request = parse(&bytes[..end])?;
    let length = length(&request)?;
    let mut body = bytes.split_off(end + 4);
    while body.len() < length {
        read_more(stream, &mut body, deadline)?;
    }
    body.truncate(length);
    request.body = body;
    Ok(request)
}

fn end_of_head(bytes: &[u8]) -> Option<usize> {
    bytes.windows(4).position(|four| four == b"\r\n\r\n")
}

fn read_more(
    stream: &mut TcpStream,
    bytes: &mut Vec<u8>,
    deadline: Instant,
) -> Result<(), Response> {
    let late = || Response::refused(408, "the request took too long");
    let left = deadline.saturating_duration_since(Instant::now());
    if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
        return Err(late());
    }
    let mut chunk = [0; 4096];
    match stream.read(&mut chunk) {
        Ok(0) => Err(Response::refused(400, "the request is not complete")),
        Ok(count) => {
            bytes.extend_from_slice(&chunk[..count]);
            Ok(())
        }
        Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(()),
        Err(_) => Err(late()),
    }
}

/// Request line and headers.
fn parse(head: &[u8]) -> Result<Request, Response> {
    let wrong = || Response::refused(400, "this is not a request of HTTP/1.1");
    let text = std::str::from_utf8(head).map_err(|_| wrong())?;
    let mut lines = text.split("\r\n");
    let line: Vec<&str> = lines.next().unwrap_or_default().split(' ').collect();
    let [method, path, "HTTP/1.1"] = line[..] else {
        return Err(wrong());
    };
    let header = |line: &str| {
        let (name, value) = line.split_once(':')?;
        let sound = !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_graphic());
        sound.then(|| (name.to_ascii_lowercase(), value.trim().to_owned()))
    };
    let headers: Option<Vec<(String, String)>> = lines.map(header).collect();
    Ok(Request {
        method: method.to_owned(),
        path: path.to_owned(),
        headers: headers.ok_or_else(wrong)?,
        body: Vec::new(),
    })
}

/// Length of the body, which must be stated.
fn length(request: &Request) -> Result<usize, Response> {
    if request.has("transfer-encoding") {
        return Err(Response::refused(400, "state the length of the body"));
    }
    if !request.has("content-length") {
        return Ok(0);
    }
    let stated = request.header("content-length");
    let digits = stated.filter(|text| text.bytes().all(|byte| byte.is_ascii_digit()));
    match digits.and_then(|text| text.parse().ok()) {
        Some(length) if length <= MOST_BODY => Ok(length),
        Some(_) => Err(Response::refused(
            413,
            "the body of the request is too large",
        )),
        None => Err(Response::refused(
            400,
            "the length of the body is not a number",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_is_taken_apart() {
        let request = parse(b"POST /a/b HTTP/1.1\r\nHost: 127.0.0.1:80\r\nX-A:  b ").unwrap();
        assert_eq!(
            (request.method.as_str(), request.path.as_str()),
            ("POST", "/a/b")
        );
        assert_eq!(request.header("host"), Some("127.0.0.1:80"));
        assert_eq!(request.header("x-a"), Some("b"));
        assert_eq!(request.header("origin"), None);
    }

    #[test]
    fn what_is_no_request_is_refused() {
        for head in [
            "",
            "GET /",
            "GET / HTTP/1.0",
            "GET  / HTTP/1.1",
            "GET / HTTP/1.1\r\nno colon",
            "GET / HTTP/1.1\r\n: x",
        ] {
            assert_eq!(parse(head.as_bytes()).unwrap_err().status, 400, "{head}");
        }
        assert_eq!(parse(b"GET /\xff HTTP/1.1").unwrap_err().status, 400);
    }

    #[test]
    fn a_header_that_is_there_twice_is_not_believed() {
        let request = parse(b"GET / HTTP/1.1\r\nHost: a\r\nHost: b").unwrap();
        assert_eq!(request.header("host"), None);
        assert!(request.has("host"));
        let status = |headers: &str| {
            let request = parse(format!("POST / HTTP/1.1\r\n{headers}").as_bytes()).unwrap();
            length(&request).map_err(|refused| refused.status)
        };
        assert_eq!(status("Content-Length: 12"), Ok(12));
        assert_eq!(status("Content-Length: 12\r\nContent-Length: 12"), Err(400));
        assert_eq!(status("Content-Length: -1"), Err(400));
        assert_eq!(status("Content-Length: 99999999"), Err(413));
        assert_eq!(status("Transfer-Encoding: chunked"), Err(400));
    }
}
