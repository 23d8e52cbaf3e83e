//! The program as its user starts it. One test program, since each costs seconds to compile and link: a new file is a line here.

mod common;

mod bonded;
mod book;
mod breaking;
mod corpus;
mod drive;
mod equilibrium;
mod fragments;
mod gallery;
mod gauges;
mod heat;
mod interfaces;
mod interrupt;
mod loose;
mod meant;
mod mesh;
mod modes;
mod new;
mod parts;
mod peeling;
mod processor;
mod ranks;
mod ranks_mesh;
mod report;
mod results_folder;
mod resume;
mod stages;
mod static_frames;
mod study;
mod terminal;
mod tied;
mod told;
mod vtk_frames;
mod warnings;
mod wrong_input;
