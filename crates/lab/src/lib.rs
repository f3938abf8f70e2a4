//! Studies of the library, one module for each program of this package:
//!
//! - [`compare`]: every accelerator and every split rule on a few meshes;
//! - [`convergence`]: speed against error of every accelerator, estimator and sampler;
//! - [`accuracy`]: speed and error of ray-triangle tests.

pub mod accuracy;
pub mod compare;
pub mod convergence;
mod machine;
mod plot;
mod table;
mod timing;
