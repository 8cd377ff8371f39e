//! "Did you mean ...?"

/// The known word most like `word`; `None` where nothing comes near.
pub(crate) fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let likeness = known.map(|candidate| (strsim::jaro_winkler(word, candidate), candidate));
    let best = likeness.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    (best.0 > 0.7).then_some(best.1)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn finds_a_typo_and_leaves_a_stranger() {
        let known = ["segments", "light-dark", "virtual-arm"];
        for (word, expected) in [
            ("segment", Some("segments")),
            ("virtual_arm", Some("virtual-arm")),
            ("quux", None),
        ] {
            assert_eq!(nearest(word, known.into_iter()), expected, "{word}");
        }
        assert_eq!(nearest("x", std::iter::empty()), None);
    }
}
