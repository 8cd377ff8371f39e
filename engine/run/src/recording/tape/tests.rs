#![allow(clippy::unwrap_used)]

use std::sync::mpsc::channel;

use super::*;

fn guard(number: u64) -> Entry {
    Entry::Guard(number, String::new())
}

#[test]
fn a_full_queue_drops_and_counts_and_never_waits() {
    let (open, gate) = channel();
    let (log, arrived) = channel();
    // A disk that takes nothing until the gate is opened.
    let (entries, thread) = start(3, move |entries| {
        let () = gate.recv().unwrap();
        for entry in entries {
            match entry {
                Entry::Guard(number, _) => log.send(number).unwrap(),
                _ => return Ok(()),
            }
        }
        Ok(())
    })
    .unwrap();
    let tape = Tape {
        way: Way::Queued(entries),
        shared: Arc::default(),
    };
    let found_room: Vec<bool> = (0..5).map(|number| tape.send(guard(number))).collect();
    assert_eq!(found_room, [true, true, true, false, false]);
    assert_eq!(tape.clone().shared.dropped.load(Ordering::Acquire), 2);
    open.send(()).unwrap();
    tape.send_and_wait(guard(5));
    tape.send_and_wait(Entry::End);
    assert_eq!(thread.join().unwrap(), Ok(()));
    assert!(tape.send(guard(6)), "after the end nothing is missed");
    let arrived: Vec<u64> = arrived.iter().collect();
    assert_eq!(arrived, [0, 1, 2, 5]);
}
