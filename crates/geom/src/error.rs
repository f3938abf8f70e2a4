use thiserror::Error;

/// An error of validating triangles or of building an accelerator.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GeomError {
    /// A vertex coordinate is NaN or infinite.
    #[error("triangle {triangle}, vertex {vertex}: coordinate is not finite")]
    NonFinite {
        /// The index of the triangle.
        triangle: usize,
        /// The vertex, 0 to 2.
        vertex: usize,
    },
    /// A vertex coordinate is larger in magnitude than [`Triangle::MAX_COORDINATE`](crate::Triangle::MAX_COORDINATE).
    #[error("triangle {triangle}, vertex {vertex}: coordinate {value:e} is beyond the domain of +-2^60")]
    Domain {
        /// The index of the triangle.
        triangle: usize,
        /// The vertex, 0 to 2.
        vertex: usize,
        /// The coordinate.
        value: f32,
    },
    /// There are more triangles than an index can represent.
    #[error("{count} triangles are more than the limit of {limit}")]
    TooMany {
        /// The number of triangles.
        count: usize,
        /// The largest allowed number.
        limit: usize,
    },
    /// A build parameter is out of its range.
    #[error("parameter {name} = {value} is outside {range}")]
    Param {
        /// The parameter's name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The valid range.
        range: &'static str,
    },
    /// An accelerator with the requested options would exceed its memory budget. A grid is refused before anything is
    /// allocated, a wide BVH while it is built: each of its trees has the budget.
    #[error("{what}: {requested} asked for, the budget is {budget}")]
    Budget {
        /// The quantity that exceeds the budget.
        what: &'static str,
        /// The requested amount.
        requested: u64,
        /// The largest allowed amount.
        budget: u64,
    },
}
