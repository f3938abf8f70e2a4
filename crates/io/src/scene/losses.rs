use crate::WarningKind;

/// What an ignored texture of colours counts as. Exporters write the factor 1 beside it, which says nothing.
pub(crate) const MEAN_OF_TEXTURE: f64 = 0.5;

/// Properties of a material that its [`Material`](globillum_material::Material) does not have.
#[derive(Default)]
pub(crate) struct Losses {
    pub(crate) textured: bool,
    /// Whether a texture defines its emission.
    pub(crate) emission: bool,
    pub(crate) transparent: bool,
    pub(crate) spectral: bool,
    /// Whether the file says nothing of how it reflects light.
    pub(crate) unspecified: bool,
    /// Whether it is approximated by an ideal mirror or an ideal diffuse surface.
    pub(crate) approximated: bool,
    /// Whether the approximation is an ideal mirror.
    pub(crate) is_mirror: bool,
}

impl Losses {
    /// The warnings about the material `name`, made one by one since the name may be long.
    pub(crate) fn warnings(self, name: &str) -> impl Iterator<Item = WarningKind> {
        let by = if self.is_mirror { "an ideal mirror" } else { "an ideal diffuse surface" };
        type Kind = fn(String, &'static str) -> WarningKind;
        let kinds: [(bool, Kind); 6] = [
            (self.textured, |name, _| WarningKind::TexturesIgnored { name }),
            (self.emission, |name, _| WarningKind::EmissionIgnored { name }),
            (self.transparent, |name, _| WarningKind::TransparencyIgnored { name }),
            (self.spectral, |name, _| WarningKind::SpectrumIgnored { name }),
            (self.unspecified, |name, _| WarningKind::Unspecified { name }),
            (self.approximated, |name, by| WarningKind::Approximated { name, by }),
        ];
        kinds.into_iter().filter(|(is_lost, _)| *is_lost).map(move |(_, kind)| kind(name.to_owned(), by))
    }
}
