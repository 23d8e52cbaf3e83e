//! Whatever the input, an answer and no panic.

use proptest::prelude::*;

use crate::{SMALL, every_key, leaves, parse};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn mutated_cases_never_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0usize..4, "[ -~é\n]{0,6}"), 1..6),
        name in "[a-z.\\[\\]0-9]{0,20}",
        value in "[ -~]{0,12}",
    ) {
        let mut text: Vec<char> = every_key().chars().collect();
        for (index, remove, insert) in edits {
            let at = index.index(text.len());
            let end = (at + remove).min(text.len());
            text.splice(at..end, insert.chars());
        }
        let text: String = text.into_iter().collect();
        let _ = parse(&text, &[]).map_err(|errors| errors.to_string());
        let _ = parse(&every_key(), &[(&name, &value)]).map_err(|errors| errors.to_string());
    }

    #[test]
    fn shuffled_lines_never_panic(
        order in Just((0..every_key().lines().count()).collect::<Vec<_>>()).prop_shuffle(),
        keep in 1usize..200,
    ) {
        let text = every_key();
        let lines: Vec<&str> = text.lines().collect();
        let text: Vec<&str> = order.iter().take(keep).map(|i| lines[*i]).collect();
        let _ = parse(&text.join("\n"), &[]).map_err(|errors| errors.to_string());
    }

    #[test]
    fn any_value_anywhere_never_panics(
        index in any::<prop::sample::Index>(),
        value in prop_oneof![
            Just("true"), Just("[]"), Just("{}"), Just("[[]]"), Just("\"\""), Just("nan"), Just("-inf"), Just("1e308"),
            Just("-1"), Just("0"), Just("\"1 m\""), Just("\"t\""), Just("\"1/0\""), Just("[[[1]]]"), Just("{ a = 1 }"),
            Just("99999999999999999999"), Just("07:32:00"), Just("\"x < 1\""), Just("\"max(load)\""), Just("\"%\""),
        ],
    ) {
        let text = every_key();
        let mut found = Vec::new();
        leaves(&toml::from_str(&text).unwrap(), "", &mut found);
        let _ = parse(&text, &[(found[index.index(found.len())].as_str(), value)]).map_err(|errors| errors.to_string());
    }
}

#[test]
fn huge_cases_are_read_right_or_wrong() {
    let many = |count: usize, entry: fn(usize) -> String| -> String {
        SMALL.to_string() + &(0..count).map(entry).collect::<String>()
    };
    let probe = |i: usize| format!("[[probes]]\nname = \"p{i}\"\nreaction = {{ group = \"bar\", along = \"x\" }}\n");
    assert_eq!(parse(&many(200_000, probe), &[]).unwrap().probes.len(), 200_000);
    let wrong: [fn(usize) -> String; 4] = [
        |i| format!("[[probes]]\nname = \"p{i}\"\nexpression = \"q{i}\"\n"),
        |i| format!("[[expect]]\nquantity = \"q{i}\"\nabove = 1\nsource = \"s\"\n"),
        |_| "[[supports]]\ngroup = \"bar\"\nname = \"n\"\nfix = \"x\"\n".to_string(),
        |i| format!("[[bodies]]\nname = \"bar\"\nkind = \"solid\"\ngroup = \"g{i}\"\nmaterial = \"m{i}\"\n"),
    ];
    for entry in wrong {
        let mistakes = parse(&many(80_000, entry), &[]).unwrap_err().0;
        assert_eq!(mistakes.len(), 21, "the first twenty, and how many more");
        assert!(mistakes[20].found.ends_with("further messages are not listed"), "{}", mistakes[20]);
    }
    let syntax = parse(&many(80_000, |i| format!("a{i} = = 1\n")), &[]).unwrap_err().0;
    assert_eq!(syntax.len(), 21);
}
