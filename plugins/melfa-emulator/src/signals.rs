//! Input and output signals, by number.

use std::collections::BTreeSet;

/// The signals that are on.
#[derive(Debug, Clone, Default)]
pub struct Signals {
    on: BTreeSet<u16>,
}

impl Signals {
    /// 16 signals from number `first` on, the lowest in bit 0.
    pub fn word(&self, first: u16) -> u16 {
        self.bits(first, 16) as u16
    }

    /// 32 signals from number `first` on.
    pub fn double_word(&self, first: u16) -> u32 {
        self.bits(first, 32)
    }

    fn bits(&self, first: u16, count: u16) -> u32 {
        let set = |bit: &u16| {
            let number = first.checked_add(*bit);
            number.is_some_and(|number| self.on.contains(&number))
        };
        (0..count).filter(set).fold(0, |bits, bit| bits | 1 << bit)
    }

    /// Sets those of 16 signals that the mask has.
    pub fn set_word(&mut self, first: u16, mask: u16, value: u16) {
        for bit in (0..16).filter(|bit| mask & 1 << bit != 0) {
            let Some(number) = first.checked_add(bit) else {
                return;
            };
            if value & 1 << bit == 0 {
                self.on.remove(&number);
            } else {
                self.on.insert(number);
            }
        }
    }

    /// Whether a signal is on.
    pub fn is_on(&self, number: u16) -> bool {
        self.on.contains(&number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_overlap_as_their_numbers_do() {
        let mut signals = Signals::default();
        signals.set_word(900, 0xffff, 0x0081);
        assert_eq!(signals.word(900), 0x0081);
        assert_eq!(signals.word(907), 0x0001);
        assert_eq!(signals.double_word(892), 0x0000_8100);
        signals.set_word(900, 0x0001, 0x0000);
        assert_eq!(signals.word(900), 0x0080, "the mask spares the others");
        assert!(signals.is_on(907) && !signals.is_on(900));
        assert_eq!(signals.word(u16::MAX), 0, "nothing is beyond the last");
    }
}
