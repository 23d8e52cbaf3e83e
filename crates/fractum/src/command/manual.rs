//! `fractum completions` and `fractum man`, from the commands themselves.

use std::path::Path;

use clap::CommandFactory;
use clap_complete::Shell;
use fractum::{ExitCode, Failure, say};
use fractum_output::{WriteError, atomic};

use super::Arguments;

/// Prints the completions of a shell.
pub(super) fn completions(shell: Shell) -> ExitCode {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "fractum", &mut text);
    say!("{}", String::from_utf8_lossy(&text).trim_end());
    ExitCode::Done
}

/// Prints the manual page of the program, or writes those of all commands into a folder.
///
/// # Errors
/// A folder that cannot be written to.
pub(super) fn manual(folder: Option<&Path>) -> Result<ExitCode, Failure> {
    let mut program = Arguments::command();
    program.build();
    let page = |command: &clap::Command, at: &Path| {
        let mut text = Vec::new();
        let rendered = clap_mangen::Man::new(command.clone()).render(&mut text);
        rendered.map(|()| text).map_err(|error| Failure::from(WriteError::new(at, error)))
    };
    let Some(folder) = folder else {
        say!("{}", String::from_utf8_lossy(&page(&program, Path::new("stdout"))?).trim_end());
        return Ok(ExitCode::Done);
    };
    atomic::create_folder(folder)?;
    let mut commands = vec![("fractum".to_owned(), program)];
    let mut written = 0;
    while let Some((name, command)) = commands.pop() {
        let path = folder.join(format!("{name}.1"));
        atomic::write(&path, &page(&command, &path)?)?;
        written += 1;
        let below = command.get_subcommands().filter(|below| below.get_name() != "help");
        commands.extend(below.map(|below| (format!("{name}-{}", below.get_name()), below.clone())));
    }
    say!("{written} pages in {}", folder.display());
    Ok(ExitCode::Done)
}
