//! What `--help` says below the options: examples and exit codes.

/// Of the program.
pub(super) const PROGRAM: &str = "\
Examples:
  fractum new plate                      write a case with its mesh into the folder plate
  fractum check plate/case.toml          find mistakes and show the plan
  fractum run plate/case.toml            run it; results in results/plate/case
  fractum explain solver.end             what a key of the case file means
  fractum completions bash > ~/.local/share/bash-completion/completions/fractum

Exit codes:
  0    done
  1    the case, the mesh or an option is wrong, or a reference is not met
  2    the run stopped itself; results and last state are in its folder
  3    the machine failed: disk or memory
  130  interrupted; the state is saved, and --resume goes on from it

Environment:
  FRACTUM_CACHE  folder for packings and calibrated bonds (empty: none)
  NO_COLOR       not empty: no colours";

/// Of `fractum run`.
pub(super) const RUN: &str = "\
Examples:
  fractum run case.toml
  fractum run case.toml -o results/second --set velocity=\"2 mm/s\" --threads 4
  fractum run case.toml --set solver.end=\"3 ms\"
  fractum run case.toml -o results/second --resume

Exit codes: 0 done, 1 wrong input, 2 stopped itself, 3 disk or memory, 130 interrupted with its state saved.";

/// Of `fractum check`.
pub(super) const CHECK: &str = "\
Examples:
  fractum check case.toml
  fractum check case.toml --set size=\"5 mm\" --format json";

/// Of `fractum new`.
pub(super) const NEW: &str = "\
Examples:
  fractum new                   list the templates
  fractum new beam tests/beam   write one into a folder";

/// Of `fractum material`.
pub(super) const MATERIAL: &str = "\
Examples:
  fractum material                                          list them
  fractum material concrete --compressive-strength \"40 MPa\"
  fractum material granite --compressive-strength \"180 MPa\" --toughness \"1.4 MPa*m^0.5\"
  fractum material own --young-modulus \"62 GPa\" --poisson-ratio 0.2 --fracture-energy \"8 J/m^2\" --length \"0.5 mm\"";

/// Of `fractum movie`.
pub(super) const MOVIE: &str = "\
Examples:
  fractum movie results/plate/case
  fractum movie results/plate/case -o plate.png --rate 20 --width 1200 --height 900
  fractum movie results/ring/case-modes --mode 3";

/// Of `fractum modes`.
pub(super) const MODES: &str = "\
Examples:
  fractum modes cases/vibrating-cantilever/depth-4.toml --count 4
  fractum movie results/vibrating-cantilever/depth-4-modes --mode 1";

/// Of `fractum mesh refine`.
pub(super) const REFINE: &str = "\
Examples:
  fractum mesh refine plate.msh --size 0.01 --where \"abs(y) < 0.05\" -o fine.msh
  fractum mesh refine part.msh --unit mm --size \"2 mm\" --where \"x > 3 cm\" --keep-rows -o fine.vtu";

/// Of `fractum completions`.
pub(super) const COMPLETIONS: &str = "\
Examples:
  fractum completions bash > ~/.local/share/bash-completion/completions/fractum
  fractum completions zsh > ~/.zfunc/_fractum
  fractum completions fish > ~/.config/fish/completions/fractum.fish";

/// Of `fractum man`.
pub(super) const MAN: &str = "\
Examples:
  fractum man | man -l -
  fractum man ~/.local/share/man/man1";
