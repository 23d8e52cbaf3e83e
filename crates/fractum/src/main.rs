//! fractum: fracture of solids from a gmsh mesh and one case file.

#![forbid(unsafe_code)]

mod command;

use clap::Parser;

/// Ctrl-C and SIGTERM: a simulation saves its state and ends; anything else, and a second signal, ends the program at once.
fn end_on_signal() {
    if !fractum::interrupt() {
        std::process::exit(fractum::ExitCode::Interrupted as i32);
    }
}

/// A file that would grow beyond the limit of its user is an error of writing, which has its message, and no end by a signal. Where memory
/// is refused the library of the language says so and aborts: that is the end of a run for lack of memory.
fn take_limits_as_errors() {
    #[cfg(unix)]
    {
        use std::sync::Arc;
        use std::sync::atomic::AtomicBool;

        use nix::sys::signal::{SigSet, Signal};
        use signal_hook::flag::register_conditional_shutdown;

        let mut limits = SigSet::empty();
        limits.add(Signal::SIGXFSZ);
        // Threads take over what is blocked. Where it cannot be, the signal ends the program as before.
        let _ = limits.thread_block();
        let always = Arc::new(AtomicBool::new(true));
        let _ = register_conditional_shutdown(Signal::SIGABRT as i32, fractum::ExitCode::Machine as i32, always);
    }
}

fn main() {
    take_limits_as_errors();
    let arguments = match command::Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(usage) => {
            // Help and version come this way too. A wrong option is wrong input; 2 means that a run stopped itself.
            let code = if usage.use_stderr() { fractum::ExitCode::Input } else { fractum::ExitCode::Done };
            let _ = usage.print();
            std::process::exit(code as i32);
        }
    };
    let code = match ctrlc::set_handler(end_on_signal) {
        Ok(()) => command::execute(arguments),
        Err(error) => {
            fractum::tell!("the handler for Ctrl-C could not be set: {error}");
            fractum::ExitCode::Machine
        }
    };
    let lost = code == fractum::ExitCode::Done && fractum::terminal::has_failed();
    std::process::exit(if lost { fractum::ExitCode::Machine } else { code } as i32);
}
