//! Text inside XML and HTML, and what all pages begin with.

use maud::{Markup, PreEscaped, html};

/// Head of a page with the style of all pages.
pub(crate) fn head(title: &str) -> Markup {
    html! {
        head {
            meta charset="utf-8";
            meta name="viewport" content="width=device-width, initial-scale=1";
            title { (title) " - fractum" }
            style { (PreEscaped(include_str!("report/style.css"))) }
        }
    }
}

/// `text` with what has a meaning in markup written out, for content and quoted attributes. Control characters, which
/// XML does not know even escaped, become spaces.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            control if control.is_control() => escaped.push(' '),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_becomes_text() {
        assert_eq!(escape("a<b> & \"c\"\n\u{7}µ"), "a&lt;b&gt; &amp; &quot;c&quot;  µ");
    }
}
