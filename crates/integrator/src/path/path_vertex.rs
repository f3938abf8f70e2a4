use crate::Interaction;
use crate::guide::GuideCell;
use crate::light::{ChosenLight, ChosenMirror};
use crate::sampler::BounceNumbers;
use glam::DVec3;
use globillum_geom::{Frame, PdfSolidAngle};
use globillum_material::{BsdfSample, Density};

/// What was chosen for a vertex before it is shaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PriorChoice<T> {
    /// Nothing yet: shading chooses.
    Open,
    /// This; `None` if none was chosen.
    Made(Option<T>),
}

/// A path vertex that is shaded, with its local frame, whose z axis is on the side from which the path came.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathVertex<'a> {
    pub(super) at: Interaction<'a>,
    pub(super) frame: Frame,
    /// Unit direction back along the path, in the local frame.
    pub(super) wo: DVec3,
    /// By which a diffuse surface scatters; `None` if there is no guide.
    pub(super) guide_cell: Option<GuideCell<'a>>,
    pub(super) bounce: u32,
    /// Whether no vertex before this one was diffuse.
    pub(super) is_first: bool,
    /// The random numbers of this bounce.
    pub(super) numbers: BounceNumbers,
    /// The light that `numbers` choose.
    pub(super) light: PriorChoice<ChosenLight>,
    /// The small mirror for a light sample.
    pub(super) small_mirror: PriorChoice<ChosenMirror>,
    /// The random numbers for a light in a large mirror, if they were drawn before.
    pub(super) large_mirror_numbers: Option<(f64, [f64; 2])>,
}

impl<'a> PathVertex<'a> {
    #[inline(always)]
    pub(super) fn new(
        at: Interaction<'a>,
        guide_cell: Option<GuideCell<'a>>,
        bounce: u32,
        is_first: bool,
        numbers: BounceNumbers,
    ) -> Self {
        let frame = Frame::around(at.facing_normal());
        let guide_cell = guide_cell.filter(|_| at.material.bsdf.is_diffuse());
        Self {
            at,
            frame,
            wo: frame.to_local(at.wo),
            guide_cell,
            bounce,
            is_first,
            numbers,
            light: PriorChoice::Open,
            small_mirror: PriorChoice::Open,
            large_mirror_numbers: None,
        }
    }

    /// Samples a direction, and returns it with the ratio of its density to that of the BSDF alone; `None` if nothing is
    /// reflected.
    #[inline(always)]
    pub(super) fn sample(&self) -> Option<(BsdfSample, f64)> {
        let Some(cell) = self.guide_cell else {
            return Some((self.at.material.bsdf.sample(self.wo, self.numbers.scatter)?, 1.0));
        };
        let (u, ratio) = cell.directions.warp(self.numbers.scatter);
        let mut sample = self.at.material.bsdf.sample(self.wo, u)?;
        sample.weight /= ratio;
        if let Density::SolidAngle(pdf) = &mut sample.density {
            pdf.0 *= ratio;
        }
        Some((sample, ratio))
    }

    /// The density with which [`sample`](PathVertex::sample) samples the local direction `wi`.
    #[inline(always)]
    pub(super) fn pdf(&self, wi: DVec3) -> PdfSolidAngle {
        let pdf = self.at.material.bsdf.pdf(self.wo, wi);
        match self.guide_cell {
            Some(cell) if wi.z > 0.0 => PdfSolidAngle(pdf.0 * cell.directions.ratio(wi)),
            _ => pdf,
        }
    }
}
