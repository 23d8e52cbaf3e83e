//! The steps of `docs/extending.md`, applied to a copy of the sources and checked by the compiler; files and names that the pages for
//! developers quote.
//!
//! The copy lies below the folder of build results and stays there, so that a second run compiles what has changed only. With
//! `FRACTUM_EXTEND=run` the tests of the changed crates run in the copy as well.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What is copied of the tree.
const COPIED: [&str; 6] = ["Cargo.toml", "Cargo.lock", "crates", "tests", "docs", "cases"];

/// A change of one file.
enum Step {
    /// The whole file.
    New(String),
    /// Lines below a line.
    After(String, String),
    /// A text in place of another one, wherever it stands.
    For(String, String),
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The text between the first backticks, single or double, and what follows.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let text = &text[text.find('`')?..];
    let fence = if text.starts_with("``") { "``" } else { "`" };
    text[fence.len()..].split_once(fence)
}

/// The steps of a document by section, each with its file.
fn steps(document: &str) -> BTreeMap<String, Vec<(String, Step)>> {
    let mut sections: BTreeMap<String, Vec<(String, Step)>> = BTreeMap::new();
    let mut section = String::new();
    let mut lines = document.lines();
    while let Some(line) = lines.next() {
        if let Some(title) = line.strip_prefix("## ") {
            section = title.to_owned();
        }
        let is_new = line.starts_with("New file ");
        if !is_new && !line.starts_with("In `") {
            continue;
        }
        let (file, rest) = quoted(line).unwrap_or_else(|| panic!("no file: {line}"));
        let mut block = || {
            assert!(line.ends_with(':'), "a block follows: {line}");
            assert_eq!(lines.next(), Some(""), "after {line}");
            assert!(lines.next().is_some_and(|l| l.starts_with("```")), "a block after {line}");
            let block: Vec<&str> = lines.by_ref().take_while(|l| *l != "```").collect();
            block.join("\n") + "\n"
        };
        let step = if is_new {
            Step::New(block())
        } else if let Some((_, anchor)) = rest.split_once("after ") {
            Step::After(quoted(anchor).unwrap_or_else(|| panic!("no line: {line}")).0.to_owned(), block())
        } else {
            let (old, rest) = quoted(rest).unwrap_or_else(|| panic!("no text: {line}"));
            let (new, _) = quoted(rest).unwrap_or_else(|| panic!("no other text: {line}"));
            Step::For(old.to_owned(), new.to_owned())
        };
        sections.entry(section.clone()).or_default().push((file.to_owned(), step));
    }
    sections
}

/// The file after a step.
fn applied(file: &str, text: Option<String>, step: &Step) -> String {
    match (step, text) {
        (Step::New(whole), None) => whole.clone(),
        (Step::New(_), Some(_)) => panic!("{file} is there already"),
        (_, None) => panic!("there is no {file}"),
        (Step::After(anchor, block), Some(text)) => {
            let anchor = format!("\n{anchor}\n");
            assert_eq!(text.matches(&anchor).count(), 1, "{file} should have this line once: {anchor}");
            text.replace(&anchor, &format!("{anchor}{block}"))
        }
        (Step::For(old, new), Some(text)) => {
            assert!(text.contains(old.as_str()), "{file} does not have {old}");
            text.replace(old.as_str(), new)
        }
    }
}

/// Files below the copied parts of the tree, by their paths in it.
fn tree() -> BTreeMap<String, String> {
    let root = root();
    let mut found = BTreeMap::new();
    let mut open: Vec<PathBuf> = COPIED.iter().map(|part| root.join(part)).collect();
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()));
        } else if let Ok(text) = fs::read_to_string(&path) {
            found.insert(path.strip_prefix(&root).unwrap().to_str().unwrap().to_owned(), text);
        }
    }
    found
}

/// Takes away the files below a path that are no longer there, and the folders that they leave empty.
fn clear(folder: &Path, path: &Path, tree: &BTreeMap<String, String>) {
    for entry in fs::read_dir(path).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            clear(folder, &path, tree);
            // A folder that still holds something stays.
            let _ = fs::remove_dir(&path);
        } else if !tree.contains_key(path.strip_prefix(folder).unwrap().to_str().unwrap()) {
            fs::remove_file(path).unwrap();
        }
    }
}

/// Writes what differs, and takes away what is no longer there.
fn write(folder: &Path, tree: &BTreeMap<String, String>) {
    clear(folder, folder, tree);
    for (file, text) in tree {
        let path = folder.join(file);
        if fs::read_to_string(&path).ok().as_ref() != Some(text) {
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
    }
}

#[test]
fn additions_touch_as_many_files_as_the_document_says() {
    let document = fs::read_to_string(root().join("docs/extending.md")).unwrap();
    for (section, steps) in steps(&document) {
        let files: BTreeSet<&str> = steps.iter().map(|(file, _)| file.as_str()).collect();
        let count = |is: &dyn Fn(&str) -> bool| files.iter().filter(|file| is(file)).count();
        let sources = count(&|file| file.contains("/src/"));
        let documents = count(&|file| file.starts_with("docs/"));
        let tests = files.len() - sources - documents;
        let row = document.lines().find(|line| line.starts_with(&format!("| [{section}](")));
        let row = row.unwrap_or_else(|| panic!("no row for {section}"));
        assert!(row.ends_with(&format!("| {sources} | {documents} | {tests} |")), "{section}: {files:?}\n{row}");
    }
    // What it quotes of the toy in the tree.
    let toy = fs::read_to_string(root().join("crates/fractum-dem/src/bond/softening_spring.rs")).unwrap();
    let quoted = document.split("```").nth(1).and_then(|block| block.strip_prefix("rust\n")).unwrap();
    assert!(toy.contains(quoted), "{quoted}");
}

/// What stands between backticks in a text.
fn spans(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

#[test]
fn the_walk_names_files_and_what_is_in_them() {
    let walk = fs::read_to_string(root().join("docs/walk.md")).unwrap();
    let is_step =
        |line: &&str| line.strip_prefix("| ").is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    let mut rows = 0;
    for row in walk.lines().filter(is_step) {
        let cells: Vec<&str> = row.split('|').collect();
        let [_, _, file, names, ..] = cells[..] else { panic!("{row}") };
        let file = spans(file).next().unwrap_or_else(|| panic!("no file: {row}"));
        let text = fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        let missing: Vec<&str> = spans(names).filter(|name| !text.contains(*name)).collect();
        assert!(missing.is_empty(), "{file} lacks {missing:?}");
        rows += 1;
    }
    assert!(rows > 50, "{rows} rows");
}

#[test]
fn pages_for_developers_name_files_that_there_are() {
    let docs = root().join("docs");
    let mut pages: Vec<PathBuf> =
        fs::read_dir(docs.join("decisions")).unwrap().map(|entry| entry.unwrap().path()).collect();
    pages.extend(["architecture.md", "walk.md", "glossary.md", "notation.md"].map(|page| docs.join(page)));
    for page in pages {
        let text = fs::read_to_string(&page).unwrap();
        let is_path = |span: &&str| {
            let is_below = |folder: &&str| span.starts_with(*folder);
            ["crates/", "tests/", "cases/", ".ci/"].iter().any(is_below)
                && !span.contains(|c: char| c.is_whitespace() || c == '{' || c == '*')
        };
        let missing: Vec<&str> = spans(&text).filter(is_path).filter(|path| !root().join(path).exists()).collect();
        assert!(missing.is_empty(), "{}: {missing:?}", page.display());
    }
}

/// The tree after all steps of the document.
fn extended() -> BTreeMap<String, String> {
    let mut tree = tree();
    let sections = steps(&tree["docs/extending.md"]);
    assert_eq!(sections.len(), 9);
    for (file, step) in sections.values().flatten() {
        let changed = applied(file, tree.remove(file), step);
        tree.insert(file.clone(), changed);
    }
    tree
}

#[test]
fn the_steps_of_the_document_find_their_places() {
    assert!(extended().len() > tree().len());
}

#[test]
#[ignore = "checks all crates once more; part heavy of .ci/nightly runs it"]
fn the_compiler_takes_all_steps_of_the_document() {
    let mut tree = extended();
    // Cargo knows packages by their paths in their workspace: other ones, so that both can share what does not change.
    let manifest = tree.remove("Cargo.toml").unwrap();
    let lock = tree.remove("Cargo.lock").unwrap();
    let mut tree: BTreeMap<String, String> =
        tree.into_iter().map(|(file, text)| (format!("extended/{file}"), text)).collect();
    let manifest = manifest.replace("\"python\", ", "");
    let manifest = manifest.replace("\"crates/", "\"extended/crates/").replace("\"tests", "\"extended/tests");
    tree.extend([("Cargo.toml".to_owned(), manifest), ("Cargo.lock".to_owned(), lock)]);
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("..");
    let folder = target.join("extending");
    write(&folder, &tree);
    let cargo = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO"));
        command.args(arguments).args(["--offline", "--quiet"]).current_dir(&folder).env("CARGO_TARGET_DIR", &target);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{arguments:?}\n{}", String::from_utf8_lossy(&output.stderr));
    };
    cargo(&["check", "--workspace", "--tests"]);
    if std::env::var("FRACTUM_EXTEND").is_ok_and(|value| value == "run") {
        cargo(&["test", "--release", "--workspace", "--test", "case", "--test", "verification"]);
        for part in ["fractum-kernels", "fractum-dem", "fractum-fem", "fractum-scene"] {
            cargo(&["test", "--release", "--lib", "-p", part]);
        }
    }
}

/// Laws are functions of plain values: they need no memory to allocate, no files and no threads, nor the standard library's `f64`.
#[test]
fn the_kernels_need_no_standard_library() {
    let mut command = Command::new(env!("CARGO"));
    command.args(["check", "--package", "fractum-kernels", "--no-default-features", "--offline", "--quiet"]);
    command.current_dir(root()).env("CARGO_TARGET_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join("../without-std"));
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !text.contains("warning"), "{text}");
    let page = fs::read_to_string(root().join("crates/fractum-kernels/src/lib.rs")).unwrap();
    assert!(page.contains("#![cfg_attr(not(any(feature = \"std\", test)), no_std)]"));
}
