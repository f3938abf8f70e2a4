use crate::Model;
use crate::alias::AliasTable;
use globillum_geom::{PdfArea, SurfacePoint, Triangle, Triangles};
use globillum_material::{Emission, Material};

/// The triangles that emit light, chosen with probability proportional to their power.
#[derive(Clone, Debug)]
pub struct Emitters {
    /// Triangle and its emission, in the order of the table.
    emitting: Vec<(u32, Emission)>,
    table: AliasTable,
    total_power: f64,
}

/// A point on an emitter, chosen by [`Emitters::sample`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmitterSample {
    /// The point.
    pub(crate) point: SurfacePoint,
    /// What is emitted there.
    pub(crate) emission: Emission,
    /// Density of the point over all emitters together, the choice of the triangle included.
    pub(crate) pdf: PdfArea,
}

impl Emitters {
    pub(crate) fn of(model: &Model, triangles: &Triangles) -> Self {
        let emission = |index: u32| model.material(index as usize).emission;
        let (emitting, powers): (Vec<_>, Vec<_>) = triangles
            .live()
            .iter()
            .map(|&index| ((index, emission(index)), power(triangles.get(index), &emission(index))))
            .filter(|(_, power)| *power > 0.0)
            .unzip();
        Self { emitting, table: AliasTable::new(&powers), total_power: powers.iter().sum() }
    }

    /// How many triangles emit.
    pub fn len(&self) -> usize {
        self.emitting.len()
    }

    /// Whether nothing emits.
    pub fn is_empty(&self) -> bool {
        self.emitting.is_empty()
    }

    /// Chooses a triangle by `choice` in `[0, 1)` and a point of it, uniform by area, by `u` in
    /// `[0, 1)^2`. `None` if nothing emits.
    pub(crate) fn sample(&self, triangles: &Triangles, choice: f64, u: [f64; 2]) -> Option<EmitterSample> {
        let (index, emission) = self.emitting[self.table.sample(choice)?];
        let (u, v) = Triangle::sample_uniform(u);
        let point = triangles.surface_point(index, u, v);
        Some(EmitterSample { point, emission, pdf: self.density(&emission) })
    }

    /// The density with which a point of `material` is chosen.
    pub(crate) fn pdf(&self, material: &Material) -> PdfArea {
        if material.emission.is_none() { PdfArea(0.0) } else { self.density(&material.emission) }
    }

    /// A triangle is chosen with probability (area x exitance) / total power, a point of it with
    /// density 1 / area: the area cancels.
    fn density(&self, emission: &Emission) -> PdfArea {
        PdfArea(emission.exitance().luminance() / self.total_power)
    }
}

/// Emitted power by which triangles are chosen, weighted as the eye does.
fn power(triangle: &Triangle, emission: &Emission) -> f64 {
    triangle.area() * emission.exitance().luminance()
}
