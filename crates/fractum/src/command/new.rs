//! `fractum new`: a case file to start from.

use std::path::{Path, PathBuf};

use fractum::{ExitCode, Failure, say};

/// Templates: name, what it is, text. They are cases of the gallery, so that they always run.
const TEMPLATES: [(&str, &str, &str); 2] = [
    (
        "brazilian",
        "splitting of a disc between platens, with damage and discrete elements",
        include_str!("../../../../cases/brazilian-concrete/coarse.toml"),
    ),
    (
        "tension-bar",
        "a bar pulled apart: fracture energy",
        include_str!("../../../../cases/tension-bar/aligned-coarse.toml"),
    ),
];

pub(crate) fn new(template: Option<&str>, output: Option<PathBuf>) -> Result<ExitCode, Failure> {
    let Some(name) = template else {
        for (name, what, _) in TEMPLATES {
            say!("{name:<16} {what}");
        }
        return Ok(ExitCode::Done);
    };
    let Some((_, _, text)) = TEMPLATES.iter().find(|t| t.0 == name) else {
        let names: Vec<&str> = TEMPLATES.iter().map(|t| t.0).collect();
        return Err(Failure::input(format!("no template \"{name}\"; templates: {}", names.join(", "))));
    };
    let path = output.unwrap_or_else(|| Path::new(name).with_extension("toml"));
    if path.exists() {
        return Err(Failure::input(format!("{}: exists already; name another file with -o", path.display())));
    }
    fractum_io::atomic::write(&path, text.as_bytes())?;
    say!("{}: put your mesh beside it and name it under [mesh]", path.display());
    Ok(ExitCode::Done)
}
