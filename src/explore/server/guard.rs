//! Who may ask: pages that this server sent, and nobody else.
//!
//! A page of another origin can make a browser send requests here, and a name of another host can be made to lead here
//! (DNS rebinding). Neither knows the token, and both are told apart by what the browser says of them.

use super::http::{Request, Response};

/// What a request must have.
#[derive(Debug)]
pub(super) struct Guard {
    token: String,
    hosts: [String; 2],
}

impl Guard {
    /// A guard of the server at this port, with a token of 128 random bits.
    pub(super) fn new(port: u16) -> Result<Self, getrandom::Error> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes)?;
        Ok(Self {
            token: bytes.iter().map(|byte| format!("{byte:02x}")).collect(),
            hosts: [format!("127.0.0.1:{port}"), format!("localhost:{port}")],
        })
    }

    /// The address of the page.
    pub(super) fn address(&self) -> String {
        format!("http://{}/{}/", self.hosts[0], self.token)
    }

    /// What is asked for below the token's folder.
    pub(super) fn admit<'r>(&self, request: &'r Request) -> Result<&'r str, Response> {
        let refuse = |reason: &str| Err(Response::refused(403, reason));
        let is_own = |host: &str| self.hosts.iter().any(|own| own.eq_ignore_ascii_case(host));
        if !request.header("host").is_some_and(is_own) {
            return refuse("this host is not served");
        }
        let origin = request
            .header("origin")
            .and_then(|origin| origin.strip_prefix("http://"));
        if request.has("origin") && !origin.is_some_and(is_own) {
            return refuse("other origins are not served");
        }
        let site = request.header("sec-fetch-site").unwrap_or("none");
        if request.method != "GET" && !matches!(site, "same-origin" | "none") {
            return refuse("other sites are not served");
        }
        let path = request.path.strip_prefix('/').unwrap_or_default();
        let Some((token, rest)) = path.split_once('/') else {
            return refuse("the address needs the token that pbif explore printed");
        };
        if !is_same(token.as_bytes(), self.token.as_bytes()) {
            return refuse("the address needs the token that pbif explore printed");
        }
        Ok(rest.split('?').next().unwrap_or_default())
    }
}

/// Compares all bytes, so that the time says nothing of where they differ.
fn is_same(one: &[u8], other: &[u8]) -> bool {
    let differing = one.iter().zip(other).fold(0, |sum, (a, b)| sum | (a ^ b));
    one.len() == other.len() && differing == 0
}
