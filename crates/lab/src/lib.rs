//! What the studies share: where figures come from, plots and tables.

pub mod machine;
pub mod plot;
pub mod table;
