//! Built-in scenes: the Cornell box, what can stand in it, and a hall of statues.
//!
//! ```
//! use globillum_scenes::cornell;
//!
//! let model = cornell::with_mesh(&cornell::knot(10_000), true)?; // a knot that is a mirror
//! let camera = cornell::camera()?;
//! assert!(model.triangles().len() > 9_000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod cornell;
