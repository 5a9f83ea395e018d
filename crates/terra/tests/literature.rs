//! Published and pinned numbers, one file each.

mod ani_2012;
mod fifth_wheel;
mod reece_wheel;
mod wong_reece_1967;
