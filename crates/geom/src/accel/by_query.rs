//! Methods that accelerators with one traversal share.

/// The methods of [`Traverse`](crate::Traverse) for a type with a method `query`, its one traversal.
macro_rules! traverse_by_query {
    () => {
        fn closest<C: $crate::QueryCounter>(
            &self,
            ray: &$crate::Ray,
            counter: &mut C,
        ) -> Option<$crate::Hit> {
            use $crate::accel::query::{ClosestHit, Query as _};
            self.query(ray, ClosestHit::new(ray), counter).answer()
        }
        fn any<C: $crate::QueryCounter>(&self, ray: &$crate::Ray, counter: &mut C) -> bool {
            use $crate::accel::query::{AnyHit, Query as _};
            self.query(ray, AnyHit::new(ray), counter).answer()
        }
    };
}

/// The methods of [`Accel`] but `bytes`, for a type that implements [`Traverse`](crate::Traverse) and has a
/// field `triangles`.
macro_rules! accel_by_query {
    () => {
        fn intersect(&self, ray: &$crate::Ray) -> Option<$crate::Hit> {
            self.closest(ray, &mut ())
        }
        fn occluded(&self, ray: &$crate::Ray) -> bool {
            self.any(ray, &mut ())
        }
        fn bounds(&self) -> $crate::Aabb {
            self.triangles.bounds()
        }
    };
}

pub(crate) use {accel_by_query, traverse_by_query};
