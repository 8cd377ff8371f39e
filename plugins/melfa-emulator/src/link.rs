//! A direction of a UDP service, and how it loses, delays and mangles packets on demand.

use std::net::SocketAddr;

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A packet held back to be overtaken goes on after this at the latest, s.
const LONGEST_HOLD_S: f64 = 0.1;

/// A fault that may end by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timed<T> {
    /// What it is.
    pub fault: T,
    /// When it ends, s; infinite: when it is cleared.
    pub until_s: f64,
}

fn active<T: Copy>(timed: &Option<Timed<T>>, now_s: f64) -> Option<T> {
    timed
        .filter(|timed| now_s < timed.until_s)
        .map(|timed| timed.fault)
}

/// Losses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drop {
    /// Of a loss to begin at a packet.
    pub probability: f64,
    /// Packets lost in a row.
    pub burst: u32,
}

/// Delays, evenly distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// Least, s.
    pub least_s: f64,
    /// Greatest, s.
    pub most_s: f64,
}

/// Cut packets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Short {
    /// Of a packet to be cut.
    pub probability: f64,
    /// What is left of it.
    pub bytes: usize,
}

/// What goes wrong in a direction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LinkFaults {
    /// Nothing gets through.
    pub silent: Option<Timed<()>>,
    /// Losses.
    pub drop: Option<Timed<Drop>>,
    /// Delays.
    pub delay: Option<Timed<Delay>>,
    /// Probability of a packet to come twice.
    pub duplicate: Option<Timed<f64>>,
    /// Probability of a packet to be overtaken by the next.
    pub reorder: Option<Timed<f64>>,
    /// Cut packets.
    pub short: Option<Timed<Short>>,
}

#[derive(Debug, Clone)]
struct Packet {
    due_s: f64,
    address: SocketAddr,
    bytes: Vec<u8>,
}

/// The packets under way.
#[derive(Debug, Clone)]
pub struct Link {
    random: Xoshiro256PlusPlus,
    losing: u32,
    overtaken: Option<Packet>,
    under_way: Vec<Packet>,
}

impl Link {
    /// Nothing under way.
    pub fn new(seed: u64) -> Self {
        Self {
            random: Xoshiro256PlusPlus::seed_from_u64(seed),
            losing: 0,
            overtaken: None,
            under_way: vec![],
        }
    }

    fn happens(&mut self, probability: f64) -> bool {
        self.random.random::<f64>() < probability
    }

    /// Sends a packet on its way.
    pub fn push(&mut self, now_s: f64, faults: &LinkFaults, address: SocketAddr, bytes: Vec<u8>) {
        if active(&faults.silent, now_s).is_some() || self.is_lost(now_s, faults) {
            return;
        }
        let mut packet = Packet {
            due_s: now_s,
            address,
            bytes,
        };
        if let Some(short) = active(&faults.short, now_s)
            && self.happens(short.probability)
        {
            packet.bytes.truncate(short.bytes);
        }
        if let Some(delay) = active(&faults.delay, now_s) {
            let share = self.random.random::<f64>();
            packet.due_s += delay.least_s + (delay.most_s - delay.least_s) * share;
        }
        if let Some(probability) = active(&faults.duplicate, now_s)
            && self.happens(probability)
        {
            self.under_way.push(packet.clone());
        }
        let overtaken = active(&faults.reorder, now_s);
        if let Some(probability) = overtaken
            && self.overtaken.is_none()
            && self.happens(probability)
        {
            packet.due_s += LONGEST_HOLD_S;
            self.overtaken = Some(packet);
            return;
        }
        let due_s = packet.due_s;
        self.under_way.push(packet);
        if let Some(mut waited) = self.overtaken.take() {
            waited.due_s = due_s;
            self.under_way.push(waited);
        }
    }

    fn is_lost(&mut self, now_s: f64, faults: &LinkFaults) -> bool {
        if self.losing > 0 {
            self.losing -= 1;
            return true;
        }
        let Some(drop) = active(&faults.drop, now_s) else {
            return false;
        };
        let lost = self.happens(drop.probability);
        if lost {
            self.losing = drop.burst.saturating_sub(1);
        }
        lost
    }

    /// What has arrived by now, in the order of arrival.
    pub fn arrived(&mut self, now_s: f64) -> Vec<(SocketAddr, Vec<u8>)> {
        if let Some(packet) = self.overtaken.take_if(|packet| packet.due_s <= now_s) {
            self.under_way.push(packet);
        }
        let packets = std::mem::take(&mut self.under_way);
        let (mut due, left): (Vec<_>, Vec<_>) = packets
            .into_iter()
            .partition(|packet| packet.due_s <= now_s);
        self.under_way = left;
        due.sort_by(|a, b| a.due_s.total_cmp(&b.due_s));
        due.into_iter()
            .map(|packet| (packet.address, packet.bytes))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const ALWAYS: f64 = f64::INFINITY;

    fn timed<T>(fault: T, until_s: f64) -> Option<Timed<T>> {
        Some(Timed { fault, until_s })
    }

    /// Numbers of packets as they arrive, one sent each millisecond and all others fetched later.
    fn arrivals(faults: &LinkFaults, count: u8) -> Vec<u8> {
        let mut link = Link::new(3);
        let address = "127.0.0.1:1".parse().unwrap();
        let mut found = vec![];
        for number in 0..count {
            let now_s = f64::from(number) * 0.001;
            link.push(now_s, faults, address, vec![number; 196]);
            found.extend(link.arrived(now_s));
        }
        found.extend(link.arrived(10.0));
        found.iter().map(|(_, bytes)| bytes[0]).collect()
    }

    #[test]
    fn without_faults_everything_arrives_at_once() {
        let wanted: Vec<u8> = (0..50).collect();
        assert_eq!(arrivals(&LinkFaults::default(), 50), wanted);
    }

    #[test]
    fn losses_come_in_bursts_of_their_length_and_end() {
        let drop = Drop {
            probability: 0.05,
            burst: 4,
        };
        let faults = LinkFaults {
            drop: timed(drop, 0.150),
            ..LinkFaults::default()
        };
        let found = arrivals(&faults, 200);
        assert!(found.len() < 190, "{} of 200 arrived", found.len());
        for pair in found.windows(2) {
            let lost = pair[1] - pair[0] - 1;
            assert!(
                lost % 4 == 0,
                "{lost} packets lost in a row, not bursts of 4"
            );
        }
        assert!(found.ends_with(&(155..200).collect::<Vec<u8>>()));
    }

    #[test]
    fn overtaken_packets_come_after_the_next() {
        let faults = LinkFaults {
            reorder: timed(1.0, ALWAYS),
            ..LinkFaults::default()
        };
        assert_eq!(arrivals(&faults, 6), [1, 0, 3, 2, 5, 4]);
        assert_eq!(arrivals(&faults, 3), [1, 0, 2], "the last comes late");
    }

    #[test]
    fn duplicates_delays_and_silence() {
        let twice = LinkFaults {
            duplicate: timed(1.0, ALWAYS),
            ..LinkFaults::default()
        };
        assert_eq!(arrivals(&twice, 3), [0, 0, 1, 1, 2, 2]);
        let late = Delay {
            least_s: 0.002,
            most_s: 0.002,
        };
        let late = LinkFaults {
            delay: timed(late, 0.0015),
            ..LinkFaults::default()
        };
        assert_eq!(arrivals(&late, 4), [0, 2, 1, 3], "0 and 1 come 2 ms late");
        let silent = LinkFaults {
            silent: timed((), 0.002),
            ..LinkFaults::default()
        };
        assert_eq!(arrivals(&silent, 4), [2, 3]);
    }

    #[test]
    fn cut_packets_have_what_is_left() {
        let mut link = Link::new(1);
        let short = Short {
            probability: 1.0,
            bytes: 100,
        };
        let faults = LinkFaults {
            short: timed(short, ALWAYS),
            ..LinkFaults::default()
        };
        link.push(0.0, &faults, "127.0.0.1:1".parse().unwrap(), vec![0; 196]);
        assert_eq!(link.arrived(0.0)[0].1.len(), 100);
    }
}
