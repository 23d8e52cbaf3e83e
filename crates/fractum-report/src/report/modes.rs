//! Natural vibrations in the report.

use maud::{Markup, html};

use fractum_output::number::{quantity, significant};
use fractum_output::summary::{NaturalVibrations, Summary};

/// The table of natural vibrations.
pub(super) fn vibrations(summary: &Summary) -> Markup {
    let Some(found) = &summary.modes else { return html! {} };
    // Plane bodies have no mass that moves along z.
    let axes: Vec<usize> = (0..3).filter(|&axis| found.free_mass[axis] > 0.0).collect();
    html! {
        section.keep {
            h2 { "Natural vibrations" }
            p { (in_words(found)) }
            div.scroll { table {
                tr {
                    th.number { "Mode" } th.number { "Frequency" } th.number { "Period" }
                    @for &axis in &axes { th.number { "Mass along " (NAMES[axis]) } }
                }
                @for (number, mode) in (1..).zip(&found.vibrations) {
                    tr {
                        td.number { (number) }
                        td.number { (quantity(mode.frequency, "1/s")) }
                        td.number { (quantity(1.0 / mode.frequency, "s")) }
                        @for &axis in &axes { td.number { (significant(100.0 * mode.mass_share[axis], 3)) " %" } }
                    }
                }
            } }
        }
    }
}

/// Names of the axes.
const NAMES: [&str; 3] = ["x", "y", "z"];

/// What was counted beside the vibrations.
fn in_words(found: &NaturalVibrations) -> String {
    let counted = |count: u64, one: &str, several: &str| match count {
        0 => String::new(),
        1 => format!("; 1 {one}"),
        count => format!("; {count} {several}"),
    };
    let mut text = "Mass: share of the free mass that a motion of the ground along an axis sets in motion".to_owned();
    text += &counted(found.rigid_motions, "rigid motion is not listed", "rigid motions are not listed");
    text += &counted(
        found.mechanisms,
        "motion without stiffness is not listed",
        "motions without stiffness are not listed",
    );
    text
}
