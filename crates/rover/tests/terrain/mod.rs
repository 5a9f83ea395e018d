//! Terrain files: made in the test, broken in every way, read or refused with a type.

mod damage;
mod geotiff;
mod grids;
mod made;
mod paths;
