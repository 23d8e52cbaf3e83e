//! `fractum mesh refine`: smaller elements in a zone of a mesh.

use std::path::{Path, PathBuf};

use clap::Args;
use fractum::{Failure, mesh_of_case, say};
use fractum_case::build::{refine_remedy, refine_told};
use fractum_case::{Dimension, parse_condition, parse_quantity, read_case};
use fractum_mesh::{RefineOptions, Vec3, bytes_to_refine, longest_edge, refined};
use fractum_output::memory;
use fractum_output::number::quantity;

use super::mesh_file::{read_one, write};

/// What becomes smaller, and where.
#[derive(Args)]
pub(crate) struct RefineArguments {
    /// Gmsh (.msh, 2.2 or 4.1), Abaqus (.inp) or VTK (.vtu); or a case (.toml) with mesh.refine.
    file: PathBuf,
    /// File to write: .msh (4.1, binary) or .vtu, in the unit of the mesh; that of a case is in metres.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Longest edge in the zone, such as "5 mm".
    #[arg(long, value_name = "LENGTH")]
    size: Option<String>,
    /// Where elements become smaller, such as "abs(x) < 3 cm"; everywhere if absent.
    #[arg(long = "where", value_name = "CONDITION")]
    condition: Option<String>,
    /// Length of the unit of the mesh.
    #[arg(long, value_name = "LENGTH", default_value = "1 m")]
    unit: String,
    /// Seed of the moves of inner nodes, which break up rows of elements.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Move no node.
    #[arg(long)]
    keep_rows: bool,
    /// Replace a value of [parameters] of a case.
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = super::assignment)]
    set: Vec<(String, String)>,
}

pub(super) fn run(arguments: &RefineArguments) -> Result<(), Failure> {
    if arguments.file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        of_case(arguments)
    } else {
        of_mesh(arguments)
    }
}

fn wrong(file: &Path, text: &str) -> Failure {
    Failure::input(format!("{}: {text}", file.display()))
}

fn of_case(arguments: &RefineArguments) -> Result<(), Failure> {
    let file = &arguments.file;
    let case = read_case(file, &arguments.set)?;
    if case.mesh.as_ref().is_none_or(|mesh| mesh.refine.is_empty()) {
        return Err(wrong(file, "this case has no mesh.refine; fractum explain mesh.refine"));
    }
    if arguments.size.is_some() || arguments.condition.is_some() || arguments.keep_rows {
        return Err(wrong(file, "--size, --where and --keep-rows are for mesh files; a case says them in mesh.refine"));
    }
    let (mesh, warnings) = mesh_of_case(&case)?;
    mesh.notices.iter().for_each(|notice| say!("{notice}"));
    warnings.iter().for_each(|warning| say!("{warning}"));
    arguments.output.as_deref().map_or(Ok(()), |output| write(|| Ok(mesh), output, None))
}

fn of_mesh(arguments: &RefineArguments) -> Result<(), Failure> {
    let RefineArguments { file, output, size, condition, unit, seed, keep_rows, set } = arguments;
    if !set.is_empty() {
        return Err(wrong(file, "--set is for cases, which end in .toml"));
    }
    let Some(size) = size else {
        return Err(wrong(file, "--size is missing, the longest edge, such as --size \"5 mm\""));
    };
    let length = |name: &str, text: &str| match parse_quantity(text, Dimension::LENGTH) {
        Ok(length) if length > 0.0 => Ok(length),
        Ok(_) => Err(Failure::input(format!("--{name} \"{text}\"; expected a length above 0, such as \"5 mm\""))),
        Err(error) => Err(Failure::input(format!("--{name} {error}"))),
    };
    let (size, unit) = (length("size", size)?, length("unit", unit)?);
    let condition = condition.as_deref().map(parse_condition).transpose();
    let condition = condition.map_err(|error| Failure::input(format!("--where {error}")))?;
    let holds = |at: Vec3| condition.as_ref().is_none_or(|condition| condition.holds_at(unit * at));
    let mesh = read_one(file)?;
    let Some(longest) = longest_edge(&mesh, &holds) else {
        return Err(wrong(
            file,
            "no element of the mesh lies where --where holds; fractum mesh info tells its extent, --unit its unit",
        ));
    };
    if unit * longest <= size {
        let longest = quantity(unit * longest, "m");
        say!("warning: the longest edge there is {longest}: nothing to refine; a smaller --size does more");
    }
    let size = |at: Vec3| if holds(at) { size / unit } else { f64::INFINITY };
    memory::require(bytes_to_refine(&mesh, &size), "refining the mesh".to_owned())?;
    let seed = |_: Vec3| (!keep_rows).then_some(*seed);
    let made = refined(&mesh, &size, RefineOptions { seed: &seed, ..RefineOptions::default() });
    let made = made.map_err(|error| wrong(file, &format!("{error}; {}", refine_remedy(&error))))?;
    say!("{}", refine_told(&made, unit));
    output.as_deref().map_or(Ok(()), |output| write(|| Ok(made.mesh), output, None))
}
