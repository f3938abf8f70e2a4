use crate::accel::by_query::{accel_by_query, traverse_by_query};
use crate::accel::query::{Query, offer_all};
use crate::decide::Shear;
use crate::{Accel, QueryCounter, Ray, Traverse, Triangles};

/// An accelerator without a structure: every query tests every live triangle.
///
/// The slow reference for all other accelerators, which give the same answers to the bit.
#[derive(Clone, Debug)]
pub struct BruteForce {
    triangles: Triangles,
}

impl BruteForce {
    /// Shares the triangles; nothing is built, so there is no error. Where a function that may fail is asked for, as by
    /// `Scene::build` of the crate `globillum-integrator`, give `|triangles| Ok(BruteForce::build(triangles))`.
    pub fn build(triangles: &Triangles) -> Self {
        Self { triangles: triangles.clone() }
    }

    fn query<Q: Query, C: QueryCounter>(&self, ray: &Ray, mut query: Q, counter: &mut C) -> Q {
        if let Some(shear) = Shear::new(ray) {
            offer_all(
                ray,
                &shear,
                &self.triangles,
                self.triangles.live().iter().copied(),
                &mut query,
                counter,
            );
        }
        query
    }
}

impl Traverse for BruteForce {
    traverse_by_query!();
}

impl Accel for BruteForce {
    accel_by_query!();

    fn bytes(&self) -> usize {
        self.triangles.bytes()
    }
}
