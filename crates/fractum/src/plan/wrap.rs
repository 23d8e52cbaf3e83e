//! Text broken into lines of a width.

/// Column at which the text of a topic begins.
pub(super) const INDENT: usize = 13;
/// Narrowest text that is still broken: below it a terminal breaks by itself.
const NARROWEST: usize = 30;

/// The lines of a text that stands beside a topic, each of at most `width` characters less the indent.
///
/// Lines break at spaces; a word that is longer than a line has one of its own.
pub(super) fn lines(text: &str, width: usize) -> Vec<String> {
    let room = width.saturating_sub(INDENT);
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if room < NARROWEST || line.chars().count() + 1 + word.chars().count() <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::lines;

    #[test]
    fn lines_break_at_spaces_and_keep_every_word() {
        let text = "elasticity, damage and removal of elements, discrete elements (from the first removal)";
        let broken = lines(text, 60);
        assert!(broken.len() > 1 && broken.iter().all(|line| line.chars().count() <= 47), "{broken:?}");
        assert_eq!(broken.join(" "), text);
        assert_eq!(lines(text, 20), [text]);
        assert_eq!(lines("short", 80), ["short"]);
        assert_eq!(lines(&"x".repeat(100), 80).len(), 1);
    }
}
