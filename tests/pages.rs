//! Figures that pages quote, renewed from results of the gallery:
//!
//! ```sh
//! fractum verify --jobs 2 --threads 1 -o results/gallery
//! cargo run --release -p fractum-tests --bin pages -- results/gallery            # writes the figures anew
//! cargo run --release -p fractum-tests --bin pages -- results/gallery --check    # fails where one has changed
//! ```
//!
//! A figure stands between two comments, the first of which says where it is from:
//! `<!-- run: tension-bar/aligned-coarse; probes.load.max; 0.00 kN -->1.08 kN<!-- -->`. The parts are
//!
//! - the case, whose results are in the folder of that name;
//! - the quantity: a dotted path in its `summary.json`, the name of a probe (its last value), `expect.NAME.error` for a reference, or two of
//!   these with ` / ` between them;
//! - the form: `0.00 kN` for two digits behind the point and the number in kN, `0.00 [kN]` where the unit stands elsewhere, `0.0e` for
//!   4.6e-4, `+0.0 %` with a sign.
//!
//! `<!-- table: neighbours.md -->` and a line `<!-- end -->` have between them the file of that name in the folder.
//!
//! Figures of cases that the folder does not have stay. Times on the clock (`wall.`) are renewed, but never count as changed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::Value;

const BEGIN: &str = "<!-- run: ";
const END: &str = "<!-- -->";

/// Units of figures by their symbols, in SI.
const UNITS: [(&str, f64); 41] = [
    ("", 1.0),
    ("%", 1e-2),
    ("s", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("µs", 1e-6),
    ("m", 1.0),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("µm", 1e-6),
    ("nm", 1e-9),
    ("m²", 1.0),
    ("mm²", 1e-6),
    ("kg", 1.0),
    ("g", 1e-3),
    ("N", 1.0),
    ("kN", 1e3),
    ("MN", 1e6),
    ("Pa", 1.0),
    ("kPa", 1e3),
    ("MPa", 1e6),
    ("GPa", 1e9),
    ("J", 1.0),
    ("mJ", 1e-3),
    ("uJ", 1e-6),
    ("µJ", 1e-6),
    ("kJ", 1e3),
    ("J/m²", 1.0),
    ("W", 1.0),
    ("m/s", 1.0),
    ("km/s", 1e3),
    ("mm/s", 1e-3),
    ("°", std::f64::consts::PI / 180.0),
    ("deg", std::f64::consts::PI / 180.0),
    ("degrees", std::f64::consts::PI / 180.0),
    ("K", 1.0),
    ("steps", 1.0),
    ("bonds", 1.0),
    ("seconds", 1.0),
    ("minutes", 60.0),
];

/// Where a figure of a page is from.
#[derive(Debug, PartialEq)]
struct Marker<'a> {
    case: &'a str,
    quantity: &'a str,
    decimals: usize,
    /// With a plus before what is above zero.
    signed: bool,
    /// With an exponent: `4.6e-4`.
    exponent: bool,
    unit: &'a str,
    /// The unit stands behind the number.
    shown: bool,
}

impl<'a> Marker<'a> {
    /// - `text`: what stands between `<!-- run: ` and ` -->`
    fn parse(text: &'a str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(';').map(str::trim).collect();
        let [case, quantity, form] = parts[..] else {
            return Err(format!("\"{text}\" is not CASE; QUANTITY; FORM"));
        };
        let (digits, unit) = form.split_once(' ').unwrap_or((form, ""));
        let (unit, shown) = match unit.strip_prefix('[').and_then(|unit| unit.strip_suffix(']')) {
            Some(inner) => (inner, false),
            None => (unit, true),
        };
        let (digits, signed) = digits.strip_prefix('+').map_or((digits, false), |digits| (digits, true));
        let (digits, exponent) = digits.strip_suffix('e').map_or((digits, false), |digits| (digits, true));
        let decimals = match digits.split_once('.') {
            None if digits == "0" => 0,
            Some(("0", zeros)) if !zeros.is_empty() && zeros.bytes().all(|digit| digit == b'0') => zeros.len(),
            _ => return Err(format!("\"{form}\" is no form such as \"0.00 kN\"")),
        };
        if !UNITS.iter().any(|(known, _)| *known == unit) {
            return Err(format!("\"{unit}\" is no unit of figures"));
        }
        Ok(Marker { case, quantity, decimals, signed, exponent, unit, shown })
    }

    /// The figure in a summary.
    fn figure(&self, summary: &Value) -> Result<String, String> {
        let value = match self.quantity.split_once(" / ") {
            Some((above, below)) => value(summary, above)? / value(summary, below)?,
            None => value(summary, self.quantity)?,
        };
        let size = UNITS.iter().find(|(known, _)| *known == self.unit).map_or(1.0, |(_, size)| *size);
        let decimals = self.decimals;
        let number = if self.exponent {
            format!("{:.decimals$e}", value / size)
        } else {
            format!("{:.decimals$}", value / size)
        };
        // A minus before nothing but zeros is none.
        let is_zero = number.bytes().all(|digit| !digit.is_ascii_digit() || digit == b'0');
        let number = if is_zero { number.trim_start_matches('-').to_owned() } else { number };
        let plus = if self.signed && !is_zero && value > 0.0 { "+" } else { "" };
        let number = format!("{plus}{number}");
        Ok(match self.unit {
            _ if !self.shown => number,
            "" => number,
            "°" => format!("{number}°"),
            unit => format!("{number} {unit}"),
        })
    }
}

/// A number of `summary.json`.
fn value(summary: &Value, path: &str) -> Result<f64, String> {
    let number = |value: &Value| value.as_f64().ok_or_else(|| format!("\"{path}\" is no number"));
    if let Some((name, field)) = path.strip_prefix("expect.").and_then(|rest| rest.rsplit_once('.')) {
        let lines = summary["expect"].as_array().into_iter().flatten();
        let line = lines.into_iter().find(|line| line["quantity"] == name);
        return number(&line.ok_or_else(|| format!("no reference \"{name}\""))?[field]);
    }
    let found = match summary["probes"].get(path) {
        Some(probe) => &probe["final"],
        None => path.split('.').fold(summary, |value, name| &value[name]),
    };
    number(found)
}

/// Calls `renew` for every figure of a text and puts in its place what that gives.
fn renewed(text: &str, mut renew: impl FnMut(Marker<'_>, &str) -> Option<String>) -> Result<String, String> {
    let mut result = String::new();
    let mut rest = text;
    while let Some(begin) = rest.find(BEGIN) {
        let line = 1 + text[..text.len() - rest.len() + begin].matches('\n').count();
        let fail = |what: String| format!("line {line}: {what}");
        let (before, marker) = rest.split_at(begin + BEGIN.len());
        let (inside, after) = marker.split_once(" -->").ok_or_else(|| fail("a comment without end".into()))?;
        let (figure, next) = after.split_once(END).ok_or_else(|| fail(format!("no \"{END}\" behind a figure")))?;
        let marker = Marker::parse(inside).map_err(fail)?;
        let figure = renew(marker, figure).unwrap_or_else(|| figure.to_owned());
        result.push_str(&format!("{before}{inside} -->{figure}{END}"));
        rest = next;
    }
    Ok(result + rest)
}

/// Puts files of results between their marks, where they are there.
fn with_tables(text: &str, mut file: impl FnMut(&str) -> Option<String>) -> Result<String, String> {
    let mut result = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("<!-- table: ") {
        let (name, after) = after.split_once(" -->\n").ok_or("a mark of a table without end of its line")?;
        let (old, next) = after.split_once("<!-- end -->").ok_or_else(|| format!("no end of the table {name}"))?;
        let table = file(name).unwrap_or_else(|| old.to_owned());
        result.push_str(&format!("{before}<!-- table: {name} -->\n{table}<!-- end -->"));
        rest = next;
    }
    Ok(result + rest)
}

/// All pages of a folder of the project that may quote figures.
fn pages(root: &Path) -> Vec<PathBuf> {
    let mut found = vec![root.join("README.md")];
    let mut folders = vec![root.join("docs"), root.join("cases")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (options, folders): (Vec<&String>, Vec<&String>) = arguments.iter().partition(|text| text.starts_with("--"));
    let check = options.iter().any(|option| *option == "--check");
    let [results] = folders[..] else {
        eprintln!("usage: pages RESULTS [--check]");
        return ExitCode::FAILURE;
    };
    let (mut all, mut changed, mut absent, mut wrong) = (0, 0, 0, 0);
    for page in pages(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..")) {
        let Ok(text) = fs::read_to_string(&page) else { continue };
        let renew = |marker: Marker<'_>, figure: &str| {
            all += 1;
            let summary = fs::read(Path::new(results).join(marker.case).join("summary.json"))
                .ok()
                .and_then(|bytes| serde_json::from_slice::<Value>(&bytes).ok());
            let Some(summary) = summary else {
                absent += 1;
                return None;
            };
            match marker.figure(&summary) {
                Ok(new) => {
                    if new != figure && !marker.quantity.starts_with("wall.") {
                        changed += 1;
                        println!("{}: {} {}: {figure} is now {new}", page.display(), marker.case, marker.quantity);
                    }
                    Some(new)
                }
                Err(error) => {
                    wrong += 1;
                    println!("{}: {}: {error}", page.display(), marker.case);
                    None
                }
            }
        };
        let table = |name: &str| fs::read_to_string(Path::new(results).join(name)).ok();
        let new = renewed(&text, renew).and_then(|text| if check { Ok(text) } else { with_tables(&text, table) });
        match new {
            Ok(new) if !check && new != text => {
                fs::write(&page, new).unwrap_or_else(|error| eprintln!("{}: {error}", page.display()))
            }
            Ok(_) => {}
            Err(error) => {
                wrong += 1;
                println!("{}: {error}", page.display());
            }
        }
    }
    println!("{all} figures: {changed} changed, {absent} of cases that were not run, {wrong} wrong");
    if wrong > 0 || (check && changed > 0) { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary() -> Value {
        serde_json::json!({
            "probes": { "load": { "final": 2.0, "max": 12345.6 }, "angle": { "final": -0.5 } },
            "energy": { "damage": 1.5e-4 },
            "counts": { "fragments": 3 },
            "expect": [{ "quantity": "probes.load.max", "error": -0.01234 }]
        })
    }

    #[test]
    fn figures_are_told_in_the_form_asked_for() {
        for (text, figure) in [
            ("a/b; probes.load.max; 0.0 kN", "12.3 kN"),
            ("a/b; load; 0.000", "2.000"),
            ("a/b; load; +0.0", "+2.0"),
            ("a/b; angle; 0 °", "-29°"),
            ("a/b; energy.damage; 0.00 mJ", "0.15 mJ"),
            ("a/b; counts.fragments; 0", "3"),
            ("a/b; energy.damage; 0.0e", "1.5e-4"),
            ("a/b; probes.load.max; 0.0 [kN]", "12.3"),
            ("a/b; expect.probes.load.max.error; 0.0 %", "-1.2 %"),
            ("a/b; probes.load.max / load; 0", "6173"),
            ("a/b; expect.probes.load.max.error; 0", "0"),
        ] {
            assert_eq!(Marker::parse(text).unwrap().figure(&summary()).unwrap(), figure, "{text}");
        }
        for wrong in ["a/b; load", "a/b; load; 1.0", "a/b; load; 0.0 furlongs", "a/b; load; 0.", "a/b; load; 0 [kN"] {
            assert!(Marker::parse(wrong).is_err(), "{wrong}");
        }
        assert!(Marker::parse("a/b; nothing; 0").unwrap().figure(&summary()).is_err());
    }

    #[test]
    fn a_page_keeps_everything_but_its_figures() {
        let page = "It bears <!-- run: a/b; probes.load.max; 0.0 kN -->11 kN<!-- --> and\nmore. <!-- run: c; load; 0 -->7<!-- -->";
        let new =
            renewed(page, |marker, _| (marker.case == "a/b").then(|| marker.figure(&summary()).unwrap())).unwrap();
        assert_eq!(new, page.replace("11 kN", "12.3 kN"));
        let page = "head\n<!-- table: n.md -->\nold\n<!-- end -->\nfoot\n";
        assert_eq!(with_tables(page, |name| Some(format!("new {name}\n"))).unwrap(), page.replace("old", "new n.md"));
        assert_eq!(with_tables(page, |_| None).unwrap(), page);
        assert!(renewed("<!-- run: a; b; 0 -->7", |_, _| None).unwrap_err().starts_with("line 1"));
    }

    #[test]
    fn markers_name_cases_that_there_are() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut count = 0;
        for page in pages(&root) {
            let text = fs::read_to_string(&page).unwrap();
            let seen = renewed(&text, |marker, figure| {
                count += 1;
                let case = root.join("cases").join(marker.case).with_extension("toml");
                assert!(case.is_file(), "{}: no case {}", page.display(), marker.case);
                assert!(
                    !marker.shown || figure.ends_with(marker.unit),
                    "{}: \"{figure}\" is not in {}",
                    page.display(),
                    marker.unit
                );
                None
            });
            assert_eq!(seen.as_ref(), Ok(&text), "{}", page.display());
            assert_eq!(with_tables(&text, |_| None).as_ref(), Ok(&text), "{}", page.display());
        }
        assert!(count > 20, "{count} figures are marked");
    }

    #[test]
    fn pages_of_notebooks_have_their_cells() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut count = 0;
        for entry in fs::read_dir(root.join("python/examples")).unwrap() {
            let notebook = entry.unwrap().path();
            if notebook.extension().is_none_or(|extension| extension != "ipynb") {
                continue;
            }
            count += 1;
            let name = notebook.file_stem().unwrap().to_str().unwrap();
            let page = fs::read_to_string(root.join("docs/notebooks").join(name).with_extension("md")).unwrap();
            let cells: Value = serde_json::from_slice(&fs::read(&notebook).unwrap()).unwrap();
            let mut rest = page.as_str();
            for cell in cells["cells"].as_array().unwrap() {
                let source: String =
                    cell["source"].as_array().unwrap().iter().map(|line| line.as_str().unwrap()).collect();
                let code = cell["cell_type"] == "code";
                let part = if code { format!("```python\n{source}\n```\n") } else { format!("{source}\n") };
                let Some((_, after)) = rest.split_once(&part) else {
                    panic!(
                        "docs/notebooks/{name}.md lacks a cell of the notebook; .ci/notebook-pages makes it anew:\n{source}"
                    );
                };
                rest = after;
            }
        }
        assert_eq!(count, 8);
    }
}
