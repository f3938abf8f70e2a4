//! A picture that is rendered by the tasks of a farm: what each of them does, and what has been done.

mod arrays;
mod division;
mod parts;
mod plan;

pub(crate) use arrays::arrays;
pub(crate) use division::Division;
pub(crate) use parts::{Part, Parts};
pub(crate) use plan::{Plan, Task, part_file, parts_folder};
