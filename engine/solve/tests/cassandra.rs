//! Files in Cassandra's format: odd but valid ones, and faults with their places.

use pubs_solve::{ParseFault, Pomdp, parse};

const HEAD: &str = "\
discount: 0.9
states: a b c
actions: go stay
observations: x y
";
const BODY: &str = "\
T: * identity
O: * uniform
";

fn good(text: &str) -> Pomdp {
    parse(text).unwrap_or_else(|faults| panic!("{text}\n{}", faults[0]))
}

fn faults(text: &str) -> Vec<ParseFault> {
    match parse(text) {
        Ok(_) => panic!("no fault was found in\n{text}"),
        Err(faults) => faults,
    }
}

fn row(pomdp: &Pomdp, action: usize, state: usize) -> Vec<f64> {
    let mut row = vec![0.0; pomdp.states().len()];
    for (next, probability) in pomdp.transition(action, state) {
        row[next] = probability;
    }
    row
}

fn observed(pomdp: &Pomdp, action: usize, next: usize) -> Vec<f64> {
    let mut row = vec![0.0; pomdp.observations().len()];
    for (observation, probability) in pomdp.observation(action, next) {
        row[observation] = probability;
    }
    row
}

#[test]
fn transitions_are_read_in_all_forms() {
    let cases: [(&str, [f64; 3]); 13] = [
        ("T: go : a : b 1\nT: go : a : a 0", [0.0, 1.0, 0.0]),
        ("T: 0 : 0 : 1 1 T:0:0:0 0", [0.0, 1.0, 0.0]),
        ("T: go : a : b : 1\nT: go : a : a : 0", [0.0, 1.0, 0.0]),
        ("T: go : a\n0.5 .25 2.5e-1", [0.5, 0.25, 0.25]),
        (
            "T : go : a 5e-1\n\n+.25 # a comment 7\n0.25",
            [0.5, 0.25, 0.25],
        ),
        ("T: go : a uniform", [1.0 / 3.0; 3]),
        ("T: go : * : * 0\nT: go : * : c 1.0", [0.0, 0.0, 1.0]),
        ("T: go\n0 0 1\n1 0 0\n0 1 0", [0.0, 0.0, 1.0]),
        ("T: go uniform", [1.0 / 3.0; 3]),
        ("T: go uniform\nT: go identity", [1.0, 0.0, 0.0]),
        ("T: * : a : 0 0.25 T: * : a : 2 0.75", [0.25, 0.0, 0.75]),
        ("T: go : a : 0.5 0.25 0.25", [0.5, 0.25, 0.25]),
        ("T: go : a reset", [0.0, 0.5, 0.5]),
    ];
    for (text, wanted) in cases {
        let pomdp = good(&format!("{HEAD}start include: b 2\n{BODY}{text}"));
        let found = row(&pomdp, 0, 0);
        for (found, wanted) in found.iter().zip(wanted) {
            assert!(
                (found - wanted).abs() < 1e-12,
                "{text}: {found} for {wanted}"
            );
        }
    }
}

#[test]
fn observations_are_read_in_all_forms() {
    let cases: [(&str, [f64; 2]); 5] = [
        ("O: go : a : x 0.25\nO: go : a : 1 0.75", [0.25, 0.75]),
        ("O: go : a\n0.25 0.75", [0.25, 0.75]),
        ("O: go : a : 0.25 0.75", [0.25, 0.75]),
        ("O: go\n.25 .75\n1 0\n0 1", [0.25, 0.75]),
        ("O: *\n.25 .75\n1 0\n0 1\nO: go : a uniform", [0.5, 0.5]),
    ];
    for (text, wanted) in cases {
        let pomdp = good(&format!("{HEAD}{BODY}{text}"));
        assert_eq!(observed(&pomdp, 0, 0), wanted, "{text}");
    }
}

#[test]
fn rewards_are_expected_ones_and_the_last_statement_holds() {
    // From `a`, `go` leads to b (0.25) and c (0.75); both observations are equally likely.
    let cases = [
        ("", 0.0),
        ("R: * : * : * : * 4", 4.0),
        ("R: go : a : c : * 4", 3.0),
        ("R: go : a : b : y 8", 1.0),
        ("R: go : a : b 8 16", 3.0),
        ("R: go : a\n1 1 4 4 0 8", 4.0),
        ("R: go : a : b : * 8\nR: * : * : * : * -1", -1.0),
        ("R: * : * : * : * -1\nR: go : a : b : x - 9", -2.0),
        ("R: go : a : b : x 8\nR: go : a : b 4 4", 1.0),
        ("R: stay : * : * : * 5\nR: * : b : * : * 5", 0.0),
    ];
    for (text, wanted) in cases {
        let rows = "T: go : a 0 .25 .75";
        let reward = good(&format!("{HEAD}{BODY}{rows}\n{text}")).reward(0, 0);
        assert!(
            (reward - wanted).abs() < 1e-12,
            "{text}: {reward} for {wanted}"
        );
        let cost = good(&format!("values: cost\n{HEAD}{BODY}{rows}\n{text}")).reward(0, 0);
        assert!((cost + wanted).abs() < 1e-12, "{text} as a cost: {cost}");
    }
}

#[test]
fn initial_beliefs_are_read_in_all_forms() {
    let third = 1.0 / 3.0;
    let cases = [
        ("", [third; 3]),
        ("start: uniform", [third; 3]),
        ("start:\n0.5 0.25\n0.25", [0.5, 0.25, 0.25]),
        ("start: b", [0.0, 1.0, 0.0]),
        ("start: 2", [0.0, 0.0, 1.0]),
        ("start include: a c", [0.5, 0.0, 0.5]),
        ("start exclude : 0", [0.0, 0.5, 0.5]),
        (
            "start: 0.333 0.333 0.3335",
            [0.333 / 0.9995, 0.333 / 0.9995, 0.3335 / 0.9995],
        ),
    ];
    for (text, wanted) in cases {
        // The words may come before the states that they name.
        for file in [
            format!("{text}\n{HEAD}{BODY}"),
            format!("{HEAD}{text}\n{BODY}"),
        ] {
            let pomdp = good(&file);
            for (found, wanted) in pomdp.start().iter().zip(wanted) {
                assert!(
                    (found - wanted).abs() < 1e-12,
                    "{text}: {found} for {wanted}"
                );
            }
        }
    }
}

#[test]
fn odd_but_valid_files_are_read() {
    let windows = format!("\u{feff}{HEAD}{BODY}").replace('\n', "\r\n");
    assert_eq!(good(&windows).states(), ["a", "b", "c"]);
    let one_line = format!("{HEAD}{BODY}").replace('\n', " ");
    assert_eq!(good(&one_line), good(&format!("{HEAD}{BODY}")));
    let counts = "observations: 2 actions: 2\nstates : 3 values:rewards discount: 0\n";
    let pomdp = good(&format!("{counts}{BODY}"));
    assert_eq!(pomdp.states(), ["0", "1", "2"]);
    assert_eq!(pomdp.discount(), 0.0);
    // Words of the format are names too.
    let words = "discount: .5 states: T uniform actions: R O observations: start\n";
    let pomdp = good(&format!("{words}{BODY}T: R : T : uniform 1 T: R : T : T 0"));
    assert_eq!(row(&pomdp, 0, 0), [0.0, 1.0]);
    // A sum that lacks what was rounded away is scaled to one.
    let rounded = good(&format!("{HEAD}{BODY}T: go : a .3333 .3333 .3333"));
    assert!((row(&rounded, 0, 0).iter().sum::<f64>() - 1.0).abs() < 1e-15);
}

/// What is wrong, on which line and column, and words of the message and of the help.
type Case = (&'static str, usize, usize, &'static str, &'static str);

#[test]
fn faults_name_line_column_and_cure() {
    // The lines of HEAD are 1 to 4, those of BODY 5 and 6.
    let cases: [Case; 24] = [
        ("T: jump identity", 7, 4, "`jump` is no action", "go, stay"),
        ("T: go : d : a 1", 7, 9, "`d` is no state", "a, b, c"),
        (
            "T: go : 3 : a 1",
            7,
            9,
            "no state number 3: there are 3",
            "a, b, c",
        ),
        ("O: go : a : z 1", 7, 13, "`z` is no observation", "x, y"),
        (
            "T: go : a : b 1.5",
            7,
            15,
            "1.5 is no probability",
            "from 0 to 1",
        ),
        (
            "T: go : a : b -1",
            7,
            15,
            "-1 is no probability",
            "from 0 to 1",
        ),
        (
            "T: go : a : b nan",
            7,
            15,
            "`nan` stands where a number",
            "1, 0.25",
        ),
        (
            "T: go : a : b 1e999",
            7,
            15,
            "`1e999` stands where a number",
            "1, 0.25",
        ),
        ("T: go : a : b", 7, 14, "the end of the file", "1, 0.25"),
        (
            "T: go : a : b 0 1",
            7,
            17,
            "`1` follows the probability",
            "should begin here",
        ),
        (
            "T: go : a\n0.5 0.5\nR: * : * : * : * 0",
            8,
            5,
            "has 2 numbers, and 3",
            "add those",
        ),
        (
            "T: go : a\n0.5 0.5 0 0",
            8,
            11,
            "one more than a row of 3",
            "take it away",
        ),
        (
            "T: go\n1 0 0\n0 1 0\n0 0\nR: * : * : * : * 0",
            11,
            1,
            "inside a matrix of 3 rows",
            "all of",
        ),
        (
            "T: go\n1 0 0\n0 1 0\n0 0 1 0",
            10,
            7,
            "`0` follows the matrix",
            "should begin",
        ),
        (
            "T: go : a\n0.5 0.25 0.2",
            8,
            10,
            "`go` and state `a` sums to 0.95",
            "sums to 1",
        ),
        ("T: go : a : a 0.5", 7, 15, "sums to 0.5", "sums to 1"),
        (
            "O: stay : *\n0.9 0.2",
            8,
            5,
            "sums to 1.1 (and 2 more",
            "sums to 1",
        ),
        (
            "O: go identity",
            7,
            7,
            "`identity` stands where a number",
            "1, 0.25",
        ),
        (
            "R: go : a : b : * high",
            7,
            19,
            "`high` stands where a number",
            "1, 0.25",
        ),
        ("R: go 5", 7, 7, "`5` stands where a colon", "write `:`"),
        (
            "start: 0.5 0.5",
            7,
            8,
            "2 probabilities for 3 states",
            "one for each",
        ),
        ("start: 0.5 0.5 0.5", 7, 16, "sums to 1.5", "sum to 1"),
        (
            "start exclude: a b c",
            7,
            16,
            "no state is left",
            "list others",
        ),
        ("states: 4", 7, 1, "`states:` is given twice", "keep one"),
    ];
    for (text, line, column, message, help) in cases {
        let faults = faults(&format!("{HEAD}{BODY}{text}"));
        let first = &faults[0];
        assert!(first.message.contains(message), "{text}: {first}");
        assert!(first.help.contains(help), "{text}: {first}");
        assert_eq!(
            (first.line, first.column),
            (line, column),
            "{text}: {first}"
        );
        assert_eq!(faults.len(), 1, "{text}: {}", faults[faults.len() - 1]);
    }
}

#[test]
fn faults_of_the_preamble_name_line_column_and_cure() {
    let rest = "states: 2 actions: 1 observations: 1\nT: * identity\nO: * uniform\n";
    let cases: [Case; 12] = [
        ("discount: 1", 1, 11, "the discount is 1", "below 1"),
        (
            "discount: -0.5",
            1,
            11,
            "the discount is -0.5",
            "at least 0",
        ),
        ("discount: high", 1, 11, "`high` is no number", "0.95"),
        (
            "discount 0.9",
            1,
            1,
            "`discount` begins no statement",
            "with a colon",
        ),
        (
            "Discount: 0.9",
            1,
            1,
            "`Discount` begins no statement",
            "`discount:`",
        ),
        (
            "discount: 0.9 0.8",
            1,
            15,
            "`0.8` follows the discount",
            "should begin",
        ),
        (
            "discount: 0.9\nvalues: gain",
            2,
            9,
            "`gain` is no kind",
            "`reward` or `cost`",
        ),
        (
            "discount: 0.9\nsize: 3",
            2,
            1,
            "`size` begins no statement",
            "begins with discount:",
        ),
        (
            "discount: 0.9\nT: * identity",
            2,
            1,
            "`states:` is missing",
            "declare them",
        ),
        ("discount: 0.9\nstart: c", 2, 8, "`c` is no state", "0, 1"),
        (
            "discount: 0.9\nstart include: 0 2",
            2,
            18,
            "no state number 2",
            "0, 1",
        ),
        (
            "# nothing",
            4,
            13,
            "`discount:` is missing",
            "discount: 0.95",
        ),
    ];
    for (text, line, column, message, help) in cases {
        let faults = faults(&format!("{text}\n{rest}"));
        let first = &faults[0];
        assert!(first.message.contains(message), "{text}: {first}");
        assert!(first.help.contains(help), "{text}: {first}");
        assert_eq!(
            (first.line, first.column),
            (line, column),
            "{text}: {first}"
        );
    }
    for (text, message) in [
        ("states:", "`states:` is empty"),
        ("states: 0", "there are 0 states"),
        ("states: a a", "the state `a` is named twice"),
        ("states: a *", "`*` is no name"),
        ("states: a b\nactons: go", "`actons` begins no statement"),
    ] {
        let faults = faults(text);
        assert!(faults[0].message.contains(message), "{text}: {}", faults[0]);
    }
}

#[test]
fn what_is_missing_is_said_once() {
    for (text, messages) in [
        (
            "",
            vec!["discount", "states", "actions", "observations", "T:"],
        ),
        (HEAD, vec!["there is no `T:`"]),
        (
            &format!("{HEAD}T: * identity"),
            vec!["no `O:` says anything for action `go` and state `a`, nor for 5 others"],
        ),
        (
            &format!("{HEAD}{BODY}T: go : a : q 1\nT: go : b : b 0.5\nR: go : r : * : * 1"),
            vec!["`q`", "0.5", "`r`"],
        ),
    ] {
        let faults = faults(text);
        assert_eq!(faults.len(), messages.len(), "{text}: {faults:?}");
        for (fault, message) in faults.iter().zip(messages) {
            assert!(fault.message.contains(message), "{text}: {fault}");
        }
    }
}

#[test]
fn no_garbage_makes_the_reader_fall_over() {
    let file = format!("{HEAD}start: uniform\n{BODY}R: go : a : b : x 1\n");
    let words: Vec<&str> = file.split_inclusive([' ', '\n']).collect();
    for cut in 0..words.len() {
        // Without one word, with one twice, and cut short there.
        for text in [
            [&words[..cut], &words[cut + 1..]].concat().concat(),
            [&words[..=cut], &words[cut..]].concat().concat(),
            words[..cut].concat(),
        ] {
            if let Err(faults) = parse(&text) {
                let lines = text.lines().count().max(1);
                assert!(
                    faults.iter().all(|fault| fault.line <= lines),
                    "{text}: {faults:?}"
                );
            }
        }
    }
}
