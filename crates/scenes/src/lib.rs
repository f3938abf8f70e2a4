//! Built-in scenes: the Cornell box, sculptures of any fineness, and a hall of statues.

pub mod cornell;
