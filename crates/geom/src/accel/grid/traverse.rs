use super::mailbox::Mailbox;
use super::uniform::UniformGrid;
use super::walk::Walk;
use crate::accel::by_query::traverse_by_query;
use crate::accel::query::{Query, offer_all};
use crate::decide::Shear;
use crate::{QueryCounter, Ray, Traverse};

impl Traverse for UniformGrid {
    traverse_by_query!();
}

impl UniformGrid {
    /// Runs `query` along `ray`, over the cells that [`Walk`] yields.
    fn query<Q: Query, C: QueryCounter>(&self, ray: &Ray, mut query: Q, counter: &mut C) -> Q {
        let Some(shear) = Shear::new(ray) else { return query };
        let Some(walk) = Walk::new(&self.lattice, &self.triangles.bounds(), ray) else { return query };
        let mut mailbox = Mailbox::new();
        walk.for_each_cell(|cell| {
            counter.visit();
            let listed = self.listed(self.lattice.flat(cell));
            if !listed.is_empty() {
                counter.open();
                let new = listed.iter().copied().filter(|&triangle| mailbox.is_new(triangle));
                offer_all(ray, &shear, &self.triangles, new, &mut query, counter);
            }
            query.t_end()
        });
        query
    }
}
