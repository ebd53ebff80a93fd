//! Where frames come from and answers go.
//!
//! The streams of the process, or a socket that this machine alone can reach.

use super::error::LiveError;
use crate::Error;
use crate::run::listener::Listener;
use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::str::FromStr;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Where frames come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LivePlace {
    /// Standard input; answers go to standard output.
    Standard,
    /// The first client that connects to that address; answers go back to it.
    Tcp(SocketAddr),
}

/// A stream of frames and one for answers.
pub struct Streams {
    /// Frames.
    pub frames: Box<dyn Read + Send>,
    /// Answers.
    pub answers: Box<dyn Write + Send>,
}

/// Time between two checks for a connection.
const LOOK: Duration = Duration::from_millis(20);

impl FromStr for LivePlace {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        if text == "-" {
            return Ok(Self::Standard);
        }
        let wrong = || Error::from(LiveError::Place(text.to_owned()));
        let address = text.strip_prefix("tcp:").ok_or_else(wrong)?;
        let address =
            address.strip_prefix("localhost").map_or_else(|| address.to_owned(), |port| format!("127.0.0.1{port}"));
        let address: SocketAddr = address.parse().map_err(|_| wrong())?;
        if address.ip().is_loopback() { Ok(Self::Tcp(address)) } else { Err(LiveError::NotLoopback(address).into()) }
    }
}

/// Waits for the first client that connects to an address.
///
/// # Errors
/// [`LiveError::Listen`]; an interrupt.
pub(super) fn connected(address: SocketAddr, listener: &dyn Listener) -> Result<Streams, Error> {
    let failed = |source| LiveError::Listen { address, source };
    let socket = TcpListener::bind(address).map_err(failed)?;
    socket.set_nonblocking(true).map_err(failed)?;
    let stop = listener.stop();
    listener.note(&format!("listening on tcp:{}", socket.local_addr().map_err(failed)?));
    loop {
        match socket.accept() {
            Ok((stream, _)) => return Ok(both_ways(stream).map_err(failed)?),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(failed(error).into()),
        }
        if stop.load(Ordering::Relaxed) {
            return Err(crate::Error::Interrupted("before anybody connected; nothing was written".into()));
        }
        std::thread::sleep(LOOK);
    }
}

fn both_ways(stream: TcpStream) -> std::io::Result<Streams> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    Ok(Streams { frames: Box::new(stream.try_clone()?), answers: Box::new(stream) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_this_machine_is_listened_to() {
        let read = |text: &str| text.parse::<LivePlace>().map_err(|error| error.to_string());
        assert_eq!(read("-"), Ok(LivePlace::Standard));
        assert_eq!(read("tcp:127.0.0.1:7777"), Ok(LivePlace::Tcp(([127, 0, 0, 1], 7777).into())));
        assert_eq!(read("tcp:localhost:7"), read("tcp:127.0.0.1:7"));
        assert!(read("tcp:[::1]:7").is_ok());
        let refused = read("tcp:192.168.1.4:7777").unwrap_err();
        assert!(refused.contains("192.168.1.4:7777") && refused.contains("this machine"), "{refused}");
        for wrong in ["", "tcp", "tcp:7777", "udp:127.0.0.1:7", "tcp:localhost"] {
            assert!(read(wrong).unwrap_err().contains("expected"), "{wrong}");
        }
    }
}
