//! The server of the live page: on the loopback address only, for pages that it sent itself, bounded in everything.

mod guard;
mod http;
mod systems;

use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use super::ExploreError;
use super::live::Live;
use crate::cancellation::Cancellation;
use guard::Guard;
use http::{Request, Response};
use systems::Systems;

/// Connections that are served side by side. A further one takes the place of that which has been without a token for
/// longest; where all have shown theirs, it is closed at once.
const MOST_CONNECTIONS: usize = 64;
/// How long the server sleeps when nobody asks.
const NAP: Duration = Duration::from_millis(4);

/// A page that solves while one moves its sliders, served to the browsers of this machine.
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use pbif::cancellation::Cancellation;
/// use pbif::explore::LiveServer;
/// use pbif::sweep_file::SweepFile;
///
/// let never = Cancellation::new();
/// let sweep = SweepFile::read("sweeps/coulomb_fc.toml".as_ref())?.validate()?.prepare(&never)?;
/// let server = LiveServer::bind(&sweep, 0)?;
/// println!("{}", server.address());
/// server.serve(&never);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct LiveServer {
    listener: TcpListener,
    guard: Guard,
    systems: Systems,
}

impl LiveServer {
    /// Takes a port of the loopback address, a free one for 0, and composes the page of a sweep.
    ///
    /// # Errors
    /// [`ExploreError::Port`] when the port cannot be had, [`ExploreError::Random`] without random numbers for the
    /// token, and what the page cannot be composed for.
    pub fn bind(sweep: &crate::sweep_file::Sweep, port: u16) -> Result<Self, ExploreError> {
        let taken = |source| ExploreError::Port { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(taken)?;
        listener.set_nonblocking(true).map_err(taken)?;
        let port = listener.local_addr().map_err(taken)?.port();
        Ok(Self {
            listener,
            guard: Guard::new(port)?,
            systems: Systems::new(Live::new(sweep))?,
        })
    }

    /// The address of the page, with its token.
    pub fn address(&self) -> String {
        self.guard.address()
    }

    /// Answers requests, each on a thread of its own, until it is cancelled.
    pub fn serve(&self, cancellation: &Cancellation) {
        let active = AtomicUsize::new(0);
        let strangers = Strangers::default();
        std::thread::scope(|scope| {
            let mut number = 0;
            while !cancellation.is_cancelled() {
                let Ok((mut stream, _)) = self.listener.accept() else {
                    // Nobody asks, or the machine is out of something for a moment.
                    std::thread::sleep(NAP);
                    continue;
                };
                if active.load(Ordering::SeqCst) >= MOST_CONNECTIONS && !strangers.dismiss() {
                    continue;
                }
                active.fetch_add(1, Ordering::SeqCst);
                number += 1;
                strangers.meet(number, &stream);
                let (active, strangers) = (&active, &strangers);
                let started = std::thread::Builder::new().spawn_scoped(scope, move || {
                    // A panic of one conversation must not end the others: unwound, it would end the scope.
                    let known = || strangers.forget(number);
                    let _ = catch_unwind(AssertUnwindSafe(|| self.converse(&mut stream, &known)));
                    strangers.forget(number);
                    active.fetch_sub(1, Ordering::SeqCst);
                });
                if started.is_err() {
                    active.fetch_sub(1, Ordering::SeqCst);
                }
            }
            self.systems.stop();
        });
    }

    /// Answers one request; `known` is called when it has shown the token.
    fn converse(&self, stream: &mut TcpStream, known: &dyn Fn()) {
        // A stream that was accepted takes after its listener on some systems.
        if stream.set_nonblocking(false).is_err() {
            return;
        }
        let response = match http::read(stream) {
            Ok(request) => {
                let answer = self.respond(&request, known);
                answer.unwrap_or_else(|refusal| refusal)
            }
            Err(refusal) => refusal,
        };
        // Without a reader there is nobody to tell.
        let _ = response.send(stream);
    }

    fn respond(&self, request: &Request, known: &dyn Fn()) -> Result<Response, Response> {
        let path = self.guard.admit(request)?;
        known();
        let gone = || {
            Response::refused(
                404,
                "there is nothing of this name, or newer systems have taken its place",
            )
        };
        let (shown, asked) = self.systems.of(path).ok_or_else(gone)?;
        let edit = |live: &Live, body: &[u8]| live.edit(body, |live| self.systems.add(live));
        let answer: &dyn Fn(&Live, &[u8]) -> Vec<u8> = match (request.method.as_str(), asked) {
            ("GET", "") => return Ok(Response::html(&shown.page)),
            (_, "edit") => &edit,
            (_, "starts") => &Live::starts,
            (_, "solve") => &Live::solve,
            (_, "locate") => &Live::locate,
            (_, "sweep-file") => &Live::sweep_file,
            (_, "paths") => &Live::paths,
            (_, "map") => &Live::map,
            (_, "map-progress") => &Live::map_progress,
            (_, "") => return Err(Response::refused(405, "this can only be read")),
            _ => return Err(Response::refused(404, "there is nothing of this name")),
        };
        if request.method != "POST" {
            return Err(Response::refused(405, "this takes a POST"));
        }
        if request.header("content-type") != Some("application/json") {
            return Err(Response::refused(400, "this takes JSON"));
        }
        Ok(Response::json(answer(&shown.live, &request.body)))
    }
}

/// Connections that have not shown the token yet, by their numbers, the oldest first.
#[derive(Default)]
struct Strangers(Mutex<Vec<(u64, TcpStream)>>);

impl Strangers {
    fn all(&self) -> std::sync::MutexGuard<'_, Vec<(u64, TcpStream)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn meet(&self, number: u64, stream: &TcpStream) {
        // One that cannot be held twice is not dismissed.
        self.all()
            .extend(stream.try_clone().map(|stream| (number, stream)));
    }

    fn forget(&self, number: u64) {
        self.all().retain(|(known, _)| *known != number);
    }

    /// Closes the oldest; `false` where there is none.
    fn dismiss(&self) -> bool {
        let mut all = self.all();
        if all.is_empty() {
            return false;
        }
        let (_, stream) = all.remove(0);
        // Whoever waits for it to say something then waits no longer.
        let _ = stream.shutdown(std::net::Shutdown::Both);
        true
    }
}
