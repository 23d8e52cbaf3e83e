//! What all pages begin with.

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
