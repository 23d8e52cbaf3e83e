//! Case files read through the public interface: the good ones, and the wrong ones.

mod bedding;
mod hash_and_overrides;
mod keys;
mod line;
mod mistakes;
mod reading;
mod robustness;
mod servo;
mod sizes;

use std::path::{Path, PathBuf};

use fractum_case::{Case, Diagnostics, parse_case};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/case")
}

fn every_key() -> String {
    std::fs::read_to_string(folder().join("every_key.toml")).unwrap()
}

fn parse(text: &str, overrides: &[(&str, &str)]) -> Result<Case, Diagnostics> {
    let overrides: Vec<_> = overrides.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    parse_case(text, &folder().join("case.toml"), &overrides)
}

fn good(text: &str, overrides: &[(&str, &str)]) -> Case {
    parse(text, overrides).unwrap_or_else(|errors| panic!("{errors}"))
}

const SMALL: &str = r#"fractum = 1
[mesh]
file = "bar.msh"
[materials.steel]
density = 7800
young_modulus = 210e9
poisson_ratio = 0.3
[[bodies]]
name = "bar"
kind = "solid"
group = "bar"
material = "steel"
[solver]
end = 1e-3
"#;

/// Dotted paths of all values of a case, for `--set`.
fn leaves(value: &toml::Value, path: &str, found: &mut Vec<String>) {
    match value {
        toml::Value::Table(table) => {
            for (name, value) in table {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                leaves(value, &path, found);
            }
        }
        toml::Value::Array(items) if items.iter().all(toml::Value::is_table) => {
            items.iter().enumerate().for_each(|(i, item)| leaves(item, &format!("{path}[{i}]"), found));
        }
        _ if path.contains('.') => found.push(path.to_string()),
        _ => {}
    }
}
