//! The examples in help texts are commands of this program.

use clap::{Command, CommandFactory, Parser};

use crate::Program;

/// The commands in what stands below a verb's options, without what a shell would take.
fn examples(command: &Command) -> Vec<Vec<String>> {
    let after = command.get_after_help().map(ToString::to_string);
    let lines = after.unwrap_or_default();
    let mut examples = Vec::new();
    for line in lines.lines() {
        let line = line
            .trim_start_matches("Examples:")
            .trim_start_matches("Example:");
        if line.trim_start().starts_with("pubs-engine ") {
            let own = line.split(['|', '>', '#']).next().unwrap_or_default();
            examples.push(own.split_whitespace().map(str::to_owned).collect());
        }
    }
    examples
}

fn faults(command: &Command, path: &[String]) -> Vec<String> {
    let below = command
        .get_subcommands()
        .filter(|verb| verb.get_name() != "help");
    let verbs: Vec<_> = below.collect();
    let mut faults: Vec<String> = verbs
        .iter()
        .flat_map(|verb| faults_of_verb(verb, path))
        .collect();
    if verbs.is_empty() {
        let examples = examples(command);
        let own = |words: &Vec<String>| words.starts_with(path);
        if !examples.iter().any(own) {
            faults.push(format!("{}: no example", path.join(" ")));
        }
        for words in examples {
            if let Err(error) = Program::try_parse_from(&words) {
                faults.push(format!("{}: {error}", words.join(" ")));
            }
        }
    }
    faults
}

fn faults_of_verb(verb: &Command, path: &[String]) -> Vec<String> {
    let mut path = path.to_vec();
    path.push(verb.get_name().to_owned());
    faults(verb, &path)
}

#[test]
fn every_verb_has_an_example_and_every_example_is_understood() {
    let faults = faults(&Program::command(), &["pubs-engine".to_owned()]);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_command_line_is_consistent() {
    Program::command().debug_assert();
}
