//! The book: its commands run, its links lead somewhere, and its contents list every page.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::files_below;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the repository")
}

/// All Markdown files below a folder.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let found = files_below(folder, ".md");
    assert!(!found.is_empty(), "no pages in {}", folder.display());
    found
}

fn read(page: &Path) -> String {
    std::fs::read_to_string(page).unwrap_or_else(|error| panic!("{}: {error}", page.display()))
}

/// Targets of the links and pictures of a page, outside of code.
fn links(text: &str) -> Vec<String> {
    let mut code = false;
    let mut targets = Vec::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            code = !code;
        }
        if code {
            continue;
        }
        for piece in line.split("](").skip(1) {
            targets.extend(piece.split_once(')').map(|(target, _)| target.to_owned()));
        }
    }
    targets
}

/// Anchors that a page offers: its headings as sites name them.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut code = false;
    let mut found = BTreeSet::new();
    for line in text.lines() {
        if line.starts_with("```") {
            code = !code;
        }
        let heading = line.trim_start_matches('#');
        if code || heading.len() == line.len() || !heading.starts_with(' ') {
            continue;
        }
        let kept = heading.trim().to_lowercase();
        let kept = kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        found.insert(kept.map(|c| if c == ' ' { '-' } else { c }).collect());
    }
    found
}

#[test]
fn every_link_of_the_pages_leads_somewhere() {
    let root = root();
    let mut all = pages(&root.join("docs"));
    all.extend(pages(&root.join("cases")));
    all.extend(["README.md", "CONTRIBUTING.md", "tests/README.md"].map(|page| root.join(page)));
    let mut broken = Vec::new();
    for page in &all {
        for link in links(&read(page)) {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() { page.clone() } else { page.parent().expect("a folder").join(file) };
            let there = target.exists() && (anchor.is_empty() || anchors(&read(&target)).contains(anchor));
            if !there {
                broken.push(format!("{}: {link}", page.strip_prefix(&root).expect("below the root").display()));
            }
        }
    }
    assert!(broken.is_empty(), "links that lead nowhere:\n{}", broken.join("\n"));
}

#[test]
fn the_contents_list_every_page() {
    let docs = root().join("docs");
    let listed: BTreeSet<PathBuf> = links(&read(&docs.join("SUMMARY.md"))).iter().map(|link| docs.join(link)).collect();
    let missing: Vec<PathBuf> =
        pages(&docs).into_iter().filter(|page| !page.ends_with("SUMMARY.md") && !listed.contains(page)).collect();
    assert!(missing.is_empty(), "pages that docs/SUMMARY.md does not list: {missing:?}");
}

/// Command lines of the shell blocks of a page.
fn commands(text: &str) -> Vec<String> {
    let mut shell = false;
    let mut found = Vec::new();
    for line in text.lines() {
        if line.starts_with("```") {
            shell = line == "```sh";
        } else if shell {
            found.push(line.to_owned());
        }
    }
    found
}

/// Words of a command line; single quotes hold words together.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            c => words.last_mut().expect("a word").push(c),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

#[test]
fn the_commands_of_the_tutorial_run_as_they_stand() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut ran = 0;
    for page in pages(&root().join("docs/tutorial")) {
        for line in commands(&read(&page)) {
            let words = words(&line);
            let (program, arguments) = words.split_first().expect("a command");
            assert_eq!(program, "fractum", "{}: {line}", page.display());
            let output = Command::new(env!("CARGO_BIN_EXE_fractum"))
                .current_dir(folder.path())
                .args(arguments)
                .output()
                .expect("the program starts");
            let told = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{}: {line}\n{told}", page.display());
            ran += 1;
        }
    }
    assert!(ran >= 6, "{ran} commands");
    let history = std::fs::read_to_string(folder.path().join("results/plate/case/history.csv")).expect("a history");
    assert!(history.starts_with("time [s]") && history.contains("pull [N]"), "the columns that the tutorial reads");
}
