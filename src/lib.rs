//! facade
pub use glam;
pub use globillum_geom as geom;
pub use globillum_integrator as integrator;
pub use globillum_io as io;
pub use globillum_material as material;
