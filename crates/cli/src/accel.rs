use globillum::geom::{Accel, BruteForce, GeomError, KdTree, Triangles, UniformGrid, WideBvh};

/// An accelerator by the name it has on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AccelKind {
    /// K-d planes above, an 8-wide bounding volume hierarchy below; for many rays at a time
    Wide,
    /// A binary k-d tree by the surface area heuristic
    Kd,
    /// A uniform grid
    Grid,
    /// Every triangle for every ray
    Brute,
}

impl AccelKind {
    /// Builds the accelerator over `triangles` with its default options.
    ///
    /// # Errors
    /// Those of the accelerator's own `build`.
    pub fn build(self, triangles: &Triangles) -> Result<Box<dyn Accel>, GeomError> {
        Ok(match self {
            Self::Wide => Box::new(WideBvh::build(triangles)?),
            Self::Kd => Box::new(KdTree::build(triangles)?),
            Self::Grid => Box::new(UniformGrid::build(triangles)?),
            Self::Brute => Box::new(BruteForce::build(triangles)),
        })
    }
}
