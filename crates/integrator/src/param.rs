use crate::RenderError;

/// A parameter of a caller, and whether it is in its range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Param {
    is_valid: bool,
    pub(crate) name: &'static str,
    pub(crate) value: f64,
    /// The range in words.
    pub(crate) range: &'static str,
}

impl Param {
    pub(crate) fn new(
        is_valid: bool,
        name: &'static str,
        value: impl Into<f64>,
        range: &'static str,
    ) -> Self {
        Self { is_valid, name, value: value.into(), range }
    }

    /// One that must be above 0 and finite.
    pub(crate) fn positive(name: &'static str, value: f64) -> Self {
        Self::new(value > 0.0 && value.is_finite(), name, value, "(0, inf)")
    }

    /// Refuses the first parameter outside its range.
    pub(crate) fn check(params: impl IntoIterator<Item = Self>) -> Result<(), RenderError> {
        Self::first_outside(params)
            .map_or(Ok(()), |Self { name, value, range, .. }| Err(RenderError::Param { name, value, range }))
    }

    /// The first parameter outside its range.
    pub(crate) fn first_outside(params: impl IntoIterator<Item = Self>) -> Option<Self> {
        params.into_iter().find(|param| !param.is_valid)
    }
}
