//! Asking a person, one question at a time, until each answer is one that can be taken.

use std::io::{self, BufRead, Write};

use pubs_host::Registry;

use super::draft::Draft;
use super::question::Question;

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
pub enum DialogueError {
    /// The other side has gone.
    #[error("the questions were not answered to the end; nothing is written")]
    Ended,
    /// Reading or writing failed.
    #[error("the questions cannot be asked: {0}")]
    Broken(#[from] io::Error),
}

/// Asks for everything that the draft does not have yet.
///
/// # Errors
/// Where the input ends before the last answer.
pub fn ask(
    mut draft: Draft,
    registry: &Registry,
    input: &mut impl BufRead,
    output: &mut impl Write,
) -> Result<Draft, DialogueError> {
    // An answer may raise questions of its own, such as a driver's parameters.
    while let Some(question) = open_question(&draft, registry) {
        writeln!(output, "{}", question.explanation(&draft, registry))?;
        draft = answered(&question, &draft, registry, input, output)?;
    }
    Ok(draft)
}

fn open_question(draft: &Draft, registry: &Registry) -> Option<Question> {
    Question::of(draft, registry)
        .into_iter()
        .find(|question| !question.is_answered(draft))
}

fn answered(
    question: &Question,
    draft: &Draft,
    registry: &Registry,
    input: &mut impl BufRead,
    output: &mut impl Write,
) -> Result<Draft, DialogueError> {
    let usual = question.usual(draft);
    loop {
        match &usual {
            Some(usual) => write!(output, "  [{usual}] > ")?,
            None => write!(output, "  > ")?,
        }
        output.flush()?;
        let mut line = String::new();
        if input.read_line(&mut line)? == 0 {
            writeln!(output)?;
            return Err(DialogueError::Ended);
        }
        let answer = match (line.trim(), &usual) {
            ("", Some(usual)) => usual,
            (answer, _) => answer,
        };
        match question.answer(draft, answer, registry) {
            Ok(draft) => return Ok(draft),
            Err(reason) => writeln!(output, "  {reason}")?,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::draft::Joint;
    use super::*;
    use crate::built_in;

    fn told(answers: &str) -> (Result<Draft, DialogueError>, String) {
        let registry = built_in::registry(&[]);
        let mut output = Vec::new();
        let draft = ask(
            Draft::default(),
            &registry,
            &mut answers.as_bytes(),
            &mut output,
        );
        (draft, String::from_utf8(output).unwrap())
    }

    #[test]
    fn empty_answers_take_what_is_offered() {
        // Joint, limits, radius, three directions, tolerance, driver; no world can be offered.
        let (draft, output) = told("\n\n\n\n\n\n\n\ndoor2\n");
        let draft = draft.unwrap();
        assert_eq!(draft.limits, Some([0.0, 110.0]));
        assert_eq!(draft.hinge, Some([1.0, 0.0, 0.0]));
        assert_eq!(draft.tolerance, Some(9.0));
        assert_eq!(draft.driver.as_deref(), Some("virtual-arm"));
        assert_eq!(draft.parameters["world"], "door2");
        assert_eq!(output.matches(" > ").count(), 9, "{output}");
    }

    #[test]
    fn a_slide_is_asked_for_no_hinge() {
        let (draft, output) = told("slide\n0,30cm\n-z\n+x\n2cm\nvirtual-arm\ndrawer1\n");
        let draft = draft.unwrap();
        assert_eq!(draft.joint, Some(Joint::Prismatic));
        assert_eq!((draft.radius_m, draft.hinge), (None, None));
        assert!(!output.contains("hinge axis"), "{output}");
    }

    #[test]
    fn wrong_answers_are_asked_again_with_the_reason() {
        let cases = [
            ("door\n", "revolute (a hinge) or prismatic"),
            ("\n110\n", "the closed and the open limit"),
            ("\n0,110\n", "an angle with its unit"),
            ("\n110deg,0deg\n", "the second must be larger"),
            ("\n0,700deg\n", "each from -360 to 360"),
            ("\n\n0\n", "`--radius` is 0"),
            ("\n\n40deg\n", "a length with its unit"),
            (
                "\n\n\n0,0,0\n",
                "`--opening` is [0.0, 0.0, 0.0], which points nowhere",
            ),
            ("\n\n\n-z\n+z\n", "from the line of motion"),
            ("\n\n\n-z\n+y\n-z\n", "a handle on a hinge moves at 90°"),
            ("\n\n\n\n\n\n60deg\n", "half the range is 55"),
            ("\n\n\n\n\n\n\nnobody\n", "nobody"),
            ("\n\n\n\n\n\n\n\nnowhere\n", "`world` is \"nowhere\""),
            ("\n\n\n\n\n\n\n\nnowhere.toml\n", "cannot be read"),
            ("\n\n\n\n\n\n\n\ndrawer1\n", "has a slide"),
        ];
        for (answers, reason) in cases {
            let (draft, output) = told(answers);
            assert!(
                output.contains(reason),
                "{answers:?}: no `{reason}` in {output}"
            );
            let ended = matches!(draft, Err(DialogueError::Ended));
            assert!(ended, "{answers:?}: the answer was taken: {output}");
            let last = output.trim_end().lines().last().unwrap_or_default();
            assert!(
                last.trim_end().ends_with('>'),
                "{answers:?}: not asked again: {output}"
            );
        }
    }
}
