use thiserror::Error;

/// Why triangles could not be taken, or an accelerator not be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GeomError {
    /// A vertex coordinate is NaN or infinite.
    #[error("triangle {triangle}, vertex {vertex}: coordinate is not finite")]
    NonFinite {
        /// Index of the triangle.
        triangle: usize,
        /// Which of its vertices, 0 to 2.
        vertex: usize,
    },
    /// A vertex coordinate lies beyond [`Triangles::MAX_COORDINATE`](crate::Triangles::MAX_COORDINATE).
    #[error("triangle {triangle}, vertex {vertex}: coordinate {value:e} is beyond the domain of +-2^60")]
    Domain {
        /// Index of the triangle.
        triangle: usize,
        /// Which of its vertices, 0 to 2.
        vertex: usize,
        /// The offending coordinate.
        value: f32,
    },
    /// More triangles than an index can count.
    #[error("{count} triangles are more than the limit of {limit}")]
    TooMany {
        /// How many there were.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A build parameter is out of its range.
    #[error("parameter {name} = {value} is outside {range}")]
    Param {
        /// The parameter's name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range it must lie in.
        range: &'static str,
    },
    /// A structure as asked for would exceed its memory budget; nothing was allocated.
    #[error("{what}: {requested} asked for, the budget is {budget}")]
    Budget {
        /// What was too much.
        what: &'static str,
        /// How much was asked for.
        requested: u64,
        /// How much is allowed.
        budget: u64,
    },
}
