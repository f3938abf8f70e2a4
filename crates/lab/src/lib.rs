//! Studies of the library: what each program of this package prints, draws and writes.
//!
//! - [`compare`]: every accelerator and every splitting rule on a few meshes;
//! - [`convergence`]: speed against error of every accelerator, estimator and sampler;
//! - [`accuracy`]: speed and error of ray-triangle tests.

pub mod accuracy;
pub mod compare;
pub mod convergence;
mod machine;
mod plot;
mod table;
mod timing;
