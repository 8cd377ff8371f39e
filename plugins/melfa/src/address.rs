//! The addresses of a session.

use std::net::{IpAddr, Ipv4Addr, SocketAddr, ToSocketAddrs};

use crate::params::Params;

/// The controller's services.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Addresses {
    /// R3, TCP.
    pub r3: SocketAddr,
    /// MXT, UDP.
    pub mxt: SocketAddr,
    /// Monitor, UDP.
    pub monitor: SocketAddr,
    /// This computer's own, where it is given.
    pub local: Option<IpAddr>,
}

impl Addresses {
    /// Looks the host up.
    ///
    /// # Errors
    /// Where it has no address, in words.
    pub fn find(params: &Params) -> Result<Self, String> {
        let host = address_of(&params.host).map_err(|error| format!("host: {error}"))?;
        let local = match params.local_address.trim() {
            "" => None,
            name => {
                let parsed = name.parse::<IpAddr>();
                Some(parsed.map_err(|error| format!("local_address `{name}`: {error}"))?)
            }
        };
        Ok(Self {
            r3: SocketAddr::new(host, params.r3_port),
            mxt: SocketAddr::new(host, params.mxt_port),
            monitor: SocketAddr::new(host, params.monitor_port),
            local,
        })
    }

    /// Where a UDP socket of this end is bound.
    pub fn bind(&self, port: u16) -> SocketAddr {
        let any = IpAddr::V4(Ipv4Addr::UNSPECIFIED);
        SocketAddr::new(self.local.unwrap_or(any), port)
    }
}

/// The first IPv4 address of a name: the controllers speak no other.
fn address_of(name: &str) -> Result<IpAddr, String> {
    let name = name.trim();
    let mut found = (name, 0)
        .to_socket_addrs()
        .map_err(|error| format!("`{name}` is no address and no known name ({error})"))?;
    found
        .find(SocketAddr::is_ipv4)
        .map(|address| address.ip())
        .ok_or_else(|| format!("`{name}` has no IPv4 address"))
}
