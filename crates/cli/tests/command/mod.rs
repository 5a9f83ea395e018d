//! Drives the built program as a user does.

mod batch;
mod cautions;
mod contract;
mod design;
mod drive;
mod errors;
mod figures;
mod gravity;
mod help;
mod hostile;
mod interrupted;
mod limits;
mod map_outputs;
mod outputs;
mod program;
mod result_keys;
mod schemas;
mod slopes;
mod stance;
mod terrain;
mod viewers;
