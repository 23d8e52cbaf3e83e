//! Which modules of a crate name which, by the paths that begin with `crate`, `super` or a child, through re-exports.
//!
//! Only siblings count: a module and those below it may know each other.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Path of a module from the root of its crate.
type Module = Vec<String>;

/// What the source of a module names: paths as they are written, and under which name each is known there.
struct Source {
    /// Imports: the name, and the path.
    imports: Vec<(String, Vec<String>)>,
    /// All paths, those of imports included.
    paths: Vec<Vec<String>>,
    /// Names of the things that it defines.
    defined: BTreeSet<String>,
}

/// Module of a source file below `src`.
fn module_of(file: &Path) -> Module {
    let mut parts: Module = file.with_extension("").iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if parts.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
        parts.pop();
    }
    parts
}

/// The code without comments and texts.
fn bare(code: &str) -> String {
    let lines = code.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// Every path of a tree such as `a::{b, c::{self, d as e}}`, with the name it goes by; and what follows the tree.
fn tree<'a>(text: &'a str, before: &[String], found: &mut Vec<(String, Vec<String>)>) -> &'a str {
    let mut path = before.to_vec();
    let mut text = text.trim_start();
    loop {
        if let Some(mut rest) = text.strip_prefix('{') {
            loop {
                rest = tree(rest, &path, found).trim_start();
                rest = rest.strip_prefix(',').unwrap_or(rest).trim_start();
                if let Some(rest) = rest.strip_prefix('}') {
                    return rest;
                }
                if rest.is_empty() {
                    return rest;
                }
            }
        }
        let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '*')).unwrap_or(text.len());
        if end == 0 {
            return &text[text.chars().next().map_or(0, char::len_utf8)..];
        }
        let word = &text[..end];
        if word != "self" || path.is_empty() {
            path.push(word.to_owned());
        }
        text = &text[end..];
        match text.strip_prefix("::") {
            Some(rest) => text = rest.trim_start(),
            None => break,
        }
    }
    let mut name = path.last().cloned().unwrap_or_default();
    if let Some(rest) = text.trim_start().strip_prefix("as ") {
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        name = rest[..end].to_owned();
        text = &rest[end..];
    }
    found.push((name, path));
    text
}

fn read(code: &str) -> Source {
    let code = bare(code);
    let mut imports = Vec::new();
    for (at, _) in code.match_indices("use ") {
        let line = code[..at].rsplit('\n').next().unwrap_or_default().trim();
        if line.is_empty() || line.starts_with("pub") {
            tree(&code[at + 4..], &[], &mut imports);
        }
    }
    let mut paths: Vec<Vec<String>> = imports.iter().map(|(_, path)| path.clone()).collect();
    for root in ["crate::", "super::"] {
        for (at, _) in code.match_indices(root) {
            let before = code[..at].chars().next_back();
            if before.is_none_or(|c| !c.is_alphanumeric() && c != '_' && c != ':') {
                let mut found = Vec::new();
                tree(&code[at..], &[], &mut found);
                paths.extend(found.into_iter().map(|(_, path)| path));
            }
        }
    }
    let words: Vec<&str> = code.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
    let keywords = ["struct", "enum", "trait", "fn", "type", "const", "static", "union", "macro_rules"];
    let defined = words.windows(2).filter(|pair| keywords.contains(&pair[0])).map(|pair| pair[1].to_owned()).collect();
    Source { imports, paths, defined }
}

/// The modules of a crate by their sources, whose files are named from `src` on.
pub(crate) struct Modules {
    sources: BTreeMap<Module, Source>,
}

impl Modules {
    pub(crate) fn new<'a>(files: impl Iterator<Item = (&'a Path, &'a str)>) -> Self {
        Modules { sources: files.map(|(file, code)| (module_of(file), read(code))).collect() }
    }

    /// The module in which the thing at a path lies, as `from` writes it; none of other crates.
    fn lies_in(&self, from: &Module, path: &[String], depth: usize) -> Option<Module> {
        let mut at = from.clone();
        let mut words = path.iter().peekable();
        match words.peek()?.as_str() {
            "crate" => {
                words.next();
                at.clear();
            }
            "super" => {
                while words.next_if(|word| *word == "super").is_some() {
                    at.pop();
                }
            }
            "self" => {
                words.next();
            }
            _ => {}
        }
        let rooted = ["crate", "super", "self"].contains(&path[0].as_str());
        for (step, word) in words.enumerate() {
            let mut below = at.clone();
            below.push(word.clone());
            if self.sources.contains_key(&below) {
                at = below;
                continue;
            }
            let known = self.sources.get(&at).into_iter().flat_map(|source| &source.imports);
            let import =
                known.filter(|(name, path)| name == word && depth < 8 && (rooted || step > 0 || path[0] != *word));
            let through: Vec<Module> = import.filter_map(|(_, path)| self.lies_in(&at, path, depth + 1)).collect();
            if let Some(found) = through.into_iter().next() {
                return Some(found);
            }
            return (rooted || step > 0).then(|| self.behind_globs(&at, word, depth).unwrap_or(at));
        }
        Some(at)
    }

    /// The module that defines a name which another one has by a glob.
    fn behind_globs(&self, at: &Module, name: &str, depth: usize) -> Option<Module> {
        let source = self.sources.get(at)?;
        if source.defined.contains(name) || depth >= 8 {
            return source.defined.contains(name).then(|| at.clone());
        }
        if let Some((_, path)) = source.imports.iter().find(|(known, _)| known == name).filter(|_| depth > 0) {
            return self.lies_in(at, path, depth + 1);
        }
        let globs = source.imports.iter().filter(|(known, path)| known == "*" && path.len() > 1);
        let behind = globs.filter_map(|(_, path)| self.lies_in(at, &path[..path.len() - 1], depth + 1));
        behind.filter(|module| module != at).find_map(|module| self.behind_globs(&module, name, depth + 1))
    }

    /// Siblings below each module: who names whom.
    pub(crate) fn arrows(&self) -> BTreeMap<Module, BTreeMap<String, BTreeSet<String>>> {
        let mut arrows: BTreeMap<Module, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
        for (module, source) in &self.sources {
            for path in &source.paths {
                let Some(to) = self.lies_in(module, path, 0) else { continue };
                let shared = module.iter().zip(&to).take_while(|(a, b)| a == b).count();
                if let (Some(from), Some(to)) = (module.get(shared), to.get(shared)) {
                    let below = arrows.entry(module[..shared].to_vec()).or_default();
                    below.entry(from.clone()).or_default().insert(to.clone());
                }
            }
        }
        arrows
    }

    /// Circles of siblings, each written out: for every arrow the shortest way back.
    pub(crate) fn circles(&self) -> Vec<String> {
        let mut found = BTreeSet::new();
        for (parent, arrows) in self.arrows() {
            for (from, to) in arrows.iter().flat_map(|(from, named)| named.iter().map(move |to| (from, to))) {
                let Some(mut circle) = way(&arrows, to, from) else { continue };
                // Each circle once, from its first module on.
                let first = (0..circle.len()).min_by_key(|&k| &circle[k]).unwrap_or(0);
                circle.rotate_left(first);
                let place = if parent.is_empty() { String::new() } else { parent.join("::") + ": " };
                found.insert(format!("{place}{} → {}", circle.join(" → "), circle[0]));
            }
        }
        found.into_iter().collect()
    }
}

/// The shortest way from a module to another one.
fn way(arrows: &BTreeMap<String, BTreeSet<String>>, from: &str, to: &str) -> Option<Vec<String>> {
    let (mut ways, mut seen) = (vec![vec![from.to_owned()]], BTreeSet::from([from.to_owned()]));
    while !ways.is_empty() {
        if let Some(way) = ways.iter().find(|way| way.last().is_some_and(|last| last == to)) {
            return Some(way.clone());
        }
        let longer = |way: &Vec<String>| -> Vec<Vec<String>> {
            let next = way.last().and_then(|last| arrows.get(last)).into_iter().flatten();
            next.map(|next| [way.as_slice(), std::slice::from_ref(next)].concat()).collect()
        };
        ways = ways
            .iter()
            .flat_map(longer)
            .filter(|way| way.last().is_some_and(|last| seen.insert(last.clone())))
            .collect();
    }
    None
}

#[test]
fn circles_are_found_through_re_exports() {
    let files = [
        ("lib.rs", "mod a;\nmod b;\nmod c;\nmod d;\npub use b::{Two, inner::Deep as Far};\npub use d::*;\n"),
        ("a.rs", "use crate::Two;\nfn f() -> crate::c::Three {}\n"),
        ("b/mod.rs", "mod inner;\nuse super::c::{self, Three};\n"),
        ("b/inner.rs", "use super::Three; // crate::a::One\n"),
        ("c.rs", "use crate::a::One;\nuse crate::Four;\n"),
        ("d.rs", "pub struct Four;\nuse crate::c::Three;\n"),
    ];
    let modules = Modules::new(files.iter().map(|(file, code)| (Path::new(*file), *code)));
    assert_eq!(modules.circles(), ["a → b → c → a", "a → c → a", "c → d → c"]);
    assert_eq!(modules.arrows()[&Vec::new()]["b"], BTreeSet::from(["c".to_owned()]));
    let files =
        [("lib.rs", ""), ("x/mod.rs", ""), ("x/a.rs", "use super::b::B;"), ("x/b.rs", "use crate::{x::a::A, E};")];
    let modules = Modules::new(files.iter().map(|(file, code)| (Path::new(*file), *code)));
    assert_eq!(modules.circles(), ["x: a → b → a"]);
}
