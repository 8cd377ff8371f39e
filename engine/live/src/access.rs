//! Where a live view listens, and who may look.

use std::fmt;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::str::FromStr;

use rand::RngExt;

/// Letters of a token that is made up.
const LETTERS: &[u8; 32] = b"abcdefghijkmnpqrstuvwxyz23456789";
/// How many of them: 120 bits.
const LENGTH: usize = 24;
/// A token that somebody chooses is at least so long.
const LEAST: usize = 12;

/// What whoever looks from another machine has to know.
#[derive(Clone, PartialEq, Eq)]
pub struct Token(String);

impl Token {
    /// A new one that nobody can guess.
    pub fn random() -> Self {
        let mut source = rand::rng();
        let letter = |_| char::from(LETTERS[source.random_range(0..LETTERS.len())]);
        Self((0..LENGTH).map(letter).collect())
    }

    /// Its text.
    pub fn text(&self) -> &str {
        &self.0
    }

    /// Whether `given` is this token; the time it takes tells nothing of where they differ.
    pub fn is(&self, given: &str) -> bool {
        let (own, given) = (self.0.as_bytes(), given.as_bytes());
        let differing = own.iter().zip(given).fold(0, |sum, (a, b)| sum | (a ^ b));
        own.len() == given.len() && differing == 0
    }
}

impl FromStr for Token {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let plain = text
            .bytes()
            .all(|byte| byte.is_ascii_alphanumeric() || b"-_".contains(&byte));
        if text.len() < LEAST || !plain {
            return Err(format!(
                "a token has at least {LEAST} letters, digits, - or _; leave it out for a random one"
            ));
        }
        Ok(Self(text.to_owned()))
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("Token(…)")
    }
}

/// An address as it is typed: `HOST:PORT`, `HOST` or `PORT`, where `HOST` is a number such as
/// `0.0.0.0` or `localhost`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Listen {
    host: IpAddr,
    port: Option<u16>,
}

impl Listen {
    /// The address, with `default_port` where none was typed.
    pub fn address(&self, default_port: u16) -> SocketAddr {
        SocketAddr::new(self.host, self.port.unwrap_or(default_port))
    }
}

impl FromStr for Listen {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let loopback = IpAddr::V4(Ipv4Addr::LOCALHOST);
        let host = |text: &str| match text {
            "localhost" => Some(loopback),
            text => text.trim_matches(['[', ']']).parse().ok(),
        };
        let listen = |host, port| Self { host, port };
        if let Ok(port) = text.parse() {
            return Ok(listen(loopback, Some(port)));
        }
        if let Some(host) = host(text) {
            return Ok(listen(host, None));
        }
        let typed = text
            .rsplit_once(':')
            .and_then(|(name, port)| Some(listen(host(name)?, Some(port.parse().ok()?))));
        typed.ok_or_else(|| {
            "expected HOST:PORT, HOST or PORT, such as 127.0.0.1:8780, 0.0.0.0 or 8780; \
             names other than localhost are not looked up"
                .to_owned()
        })
    }
}

/// Who may look.
#[derive(Debug, Clone)]
pub enum Access {
    /// Programs of this machine, and no web page of another site that a browser of this machine
    /// has open.
    Loopback,
    /// Whoever knows the token.
    Token(Token),
}

impl Access {
    /// On loopback everybody unless a token is asked for; elsewhere a token, made up where none is
    /// given.
    pub fn of(address: SocketAddr, token: Option<&Token>) -> Self {
        match token {
            Some(token) => Self::Token(token.clone()),
            None if address.ip().is_loopback() => Self::Loopback,
            None => Self::Token(Token::random()),
        }
    }

    /// Whether a request may see anything: its `Host` and `Origin`, and the token that it gives.
    pub fn admits(&self, host: Option<&str>, origin: Option<&str>, token: Option<&str>) -> bool {
        match self {
            Self::Token(own) => token.is_some_and(|given| own.is(given)),
            Self::Loopback => {
                host.is_some_and(is_loopback_host)
                    && origin.is_none_or(|origin| {
                        let host = origin.strip_prefix("http://");
                        host.is_some_and(is_loopback_host)
                    })
            }
        }
    }

    /// What an address needs behind it.
    pub(crate) fn query(&self) -> String {
        match self {
            Self::Loopback => String::new(),
            Self::Token(token) => format!("?token={}", token.text()),
        }
    }
}

/// Whether a `Host` names this machine by a name that no other site can have. A page of another
/// site may have its own name lead here; then the browser sends that name.
fn is_loopback_host(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    };
    let address = name.trim_matches(['[', ']']).parse::<IpAddr>();
    name == "localhost" || address.is_ok_and(|address| address.is_loopback())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn addresses_are_read_as_people_type_them() {
        for (typed, expected) in [
            ("8081", "127.0.0.1:8081"),
            ("0.0.0.0", "0.0.0.0:8780"),
            ("localhost", "127.0.0.1:8780"),
            ("localhost:0", "127.0.0.1:0"),
            ("192.168.7.4:90", "192.168.7.4:90"),
            ("::1", "[::1]:8780"),
            ("[::]:81", "[::]:81"),
        ] {
            let listen: Listen = typed.parse().unwrap();
            assert_eq!(listen.address(8780).to_string(), expected, "{typed}");
        }
        for typed in [
            "",
            "robot",
            "robot:80",
            "1.2.3:80",
            "127.0.0.1:99999",
            ":80",
        ] {
            assert!(typed.parse::<Listen>().is_err(), "{typed:?} was taken");
        }
    }

    #[test]
    fn other_addresses_than_loopback_have_a_token() {
        let access = |address: &str| Access::of(address.parse().unwrap(), None);
        assert!(matches!(access("127.0.0.1:1"), Access::Loopback));
        assert!(matches!(access("[::1]:1"), Access::Loopback));
        for address in ["0.0.0.0:1", "192.168.0.1:1", "[::]:1"] {
            assert!(matches!(access(address), Access::Token(_)), "{address}");
        }
        assert_ne!(Token::random(), Token::random());
        assert_eq!(Token::random().text().len(), LENGTH);
    }

    #[test]
    fn a_token_is_the_same_or_it_is_not() {
        let token: Token = "abcdefghijkl".parse().unwrap();
        for (given, expected) in [
            ("abcdefghijkl", true),
            ("abcdefghijkm", false),
            ("abcdefghijk", false),
            ("abcdefghijkll", false),
            ("", false),
        ] {
            assert_eq!(token.is(given), expected, "{given}");
        }
        assert!("short".parse::<Token>().is_err());
        assert!("with spaces in it".parse::<Token>().is_err());
        assert_eq!(format!("{token:?}"), "Token(…)");
    }

    #[test]
    fn a_page_of_another_site_sees_nothing() {
        let own = Access::Loopback;
        for (host, origin, expected) in [
            (Some("127.0.0.1:8780"), None, true),
            (Some("localhost:8780"), Some("http://localhost:8780"), true),
            (Some("[::1]:8780"), None, true),
            (Some("127.0.0.1:8780"), Some("http://evil.example"), false),
            (Some("evil.example:8780"), None, false),
            (Some("127.0.0.1.evil.example"), None, false),
            (Some("127.0.0.1:8780"), Some("null"), false),
            (None, None, false),
        ] {
            let admitted = own.admits(host, origin, None);
            assert_eq!(admitted, expected, "{host:?} {origin:?}");
        }
        let access = Access::Token("abcdefghijkl".parse().unwrap());
        assert!(access.admits(None, None, Some("abcdefghijkl")));
        assert!(!access.admits(Some("127.0.0.1:1"), None, None));
        assert!(!access.admits(Some("127.0.0.1:1"), None, Some("abcdefghijk")));
    }
}
