//! fractum: fracture of solids from a gmsh mesh and one case file.

mod command;

use clap::Parser;

fn main() {
    let arguments = command::Arguments::parse();
    let code = match ctrlc::set_handler(fractum::run::interrupt) {
        Ok(()) => command::execute(arguments),
        Err(error) => {
            eprintln!("the handler for Ctrl-C could not be set: {error}");
            fractum::ExitCode::Machine
        }
    };
    std::process::exit(code as i32);
}
