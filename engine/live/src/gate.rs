//! Asks for the token before a server that does not.
//!
//! A gate listens where viewers come, reads the head of their request, and only where its query
//! has the token does it join them with the server behind, byte by byte.

use std::io;
use std::net::SocketAddr;
use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt, copy_bidirectional};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::timeout;

use crate::Token;
use crate::background::Background;

/// A request's head is no longer than this.
const LONGEST: usize = 8192;
/// And it comes within this.
const PATIENCE: Duration = Duration::from_secs(5);
/// After a failure to accept, as when all descriptors are used up.
const PAUSE: Duration = Duration::from_millis(100);

const REFUSAL: &str = "HTTP/1.1 403 Forbidden\r\nContent-Type: text/plain\r\nConnection: close\r\n\r\n\
    the token is missing or wrong; the run prints the address with it\n";

/// Opens a gate at `address` before the server at `inner`; where it listens.
pub(crate) fn open(
    background: &Background,
    address: SocketAddr,
    inner: SocketAddr,
    token: Token,
) -> io::Result<SocketAddr> {
    let listener = std::net::TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    let listener = {
        let _runtime = background.enter();
        TcpListener::from_std(listener)?
    };
    let address = listener.local_addr()?;
    background.spawn(async move {
        loop {
            match listener.accept().await {
                Ok((viewer, _)) => _ = tokio::spawn(admit(viewer, inner, token.clone())),
                Err(_) => tokio::time::sleep(PAUSE).await,
            }
        }
    });
    Ok(address)
}

/// Joins a viewer with the server, if they know the token. Either of them may leave at any time.
async fn admit(mut viewer: TcpStream, inner: SocketAddr, token: Token) {
    let Ok(Ok(head)) = timeout(PATIENCE, head(&mut viewer)).await else {
        return;
    };
    if !knows(&head, &token) {
        _ = viewer.write_all(REFUSAL.as_bytes()).await;
        _ = viewer.shutdown().await;
        return;
    }
    let Ok(mut server) = TcpStream::connect(inner).await else {
        return;
    };
    if server.write_all(&head).await.is_ok() {
        _ = copy_bidirectional(&mut viewer, &mut server).await;
    }
}

/// What comes up to the empty line that ends a head, and perhaps a little more.
async fn head(viewer: &mut TcpStream) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    let mut part = [0; 1024];
    while !head.windows(4).any(|window| window == b"\r\n\r\n") {
        let count = viewer.read(&mut part).await?;
        if count == 0 || head.len() + count > LONGEST {
            return Err(io::ErrorKind::InvalidData.into());
        }
        head.extend_from_slice(&part[..count]);
    }
    Ok(head)
}

/// Whether the query in the first line has the token. A token has no letters that an address
/// spells otherwise.
fn knows(head: &[u8], token: &Token) -> bool {
    let first = head.split(|&byte| byte == b'\r').next().unwrap_or_default();
    let first = String::from_utf8_lossy(first);
    let target = first.split(' ').nth(1).unwrap_or_default();
    let Some((_, query)) = target.split_once('?') else {
        return false;
    };
    query
        .split('&')
        .filter_map(|pair| pair.strip_prefix("token="))
        .any(|given| token.is(given))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn the_token_stands_in_the_query_of_the_first_line() {
        let token: Token = "abcdefghijkl".parse().unwrap();
        for (head, expected) in [
            ("GET /?token=abcdefghijkl HTTP/1.1\r\n\r\n", true),
            ("GET /?a=1&token=abcdefghijkl HTTP/1.1\r\n\r\n", true),
            ("GET /?token=abcdefghijk HTTP/1.1\r\n\r\n", false),
            ("GET / HTTP/1.1\r\nX: /?token=abcdefghijkl\r\n\r\n", false),
            ("GET /token=abcdefghijkl HTTP/1.1\r\n\r\n", false),
            ("\r\n\r\n", false),
        ] {
            assert_eq!(knows(head.as_bytes(), &token), expected, "{head}");
        }
    }
}
