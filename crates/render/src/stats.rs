//! What a rendering cost. Every number is a sum or a maximum over samples, so it does not depend
//! on the number of threads.

use std::ops::AddAssign;

use octray_world::Counters;

use crate::path::RayKind;

/// One value for each kind of ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ByKind<T> {
    /// Of rays from the camera.
    pub primary: T,
    /// Of rays from mirrors, total internal reflection included.
    pub reflected: T,
    /// Of rays through surfaces, bent or not.
    pub refracted: T,
    /// Of rays to lamps.
    pub shadow: T,
}

/// Rays by kind.
pub type RayCounts = ByKind<u64>;

impl<T> ByKind<T> {
    /// Every kind's name with its value.
    pub const fn named(&self) -> [(&'static str, &T); 4] {
        [
            ("primary", &self.primary),
            ("reflected", &self.reflected),
            ("refracted", &self.refracted),
            ("shadow", &self.shadow),
        ]
    }

    /// The value of rays that bring light along a path.
    pub(crate) const fn of_path(&mut self, kind: RayKind) -> &mut T {
        match kind {
            RayKind::Primary => &mut self.primary,
            RayKind::Reflected => &mut self.reflected,
            RayKind::Refracted => &mut self.refracted,
        }
    }
}

impl<T: Copy + Default + AddAssign> ByKind<T> {
    /// All kinds together.
    #[must_use]
    pub fn total(&self) -> T {
        let mut total = T::default();
        for (_, value) in self.named() {
            total += *value;
        }
        total
    }
}

impl<T: AddAssign> AddAssign for ByKind<T> {
    fn add_assign(&mut self, other: Self) {
        self.primary += other.primary;
        self.reflected += other.reflected;
        self.refracted += other.refracted;
        self.shadow += other.shadow;
    }
}

/// What a rendering cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// Rays traced. A shadow ray counts once, however many surfaces it passes.
    pub rays: RayCounts,
    /// Rays that met a surface; for shadow rays, those that brought no light.
    pub hits: RayCounts,
    /// Surfaces that shadow rays passed.
    pub shadow_interfaces: u64,
    /// Branches ended by the generation limit.
    pub ended_by_generation: u64,
    /// Branches ended by the contribution threshold.
    pub ended_by_contribution: u64,
    /// Contributions that were NaN or absurdly large and were replaced.
    pub replaced_contributions: u64,
    /// The most rays that waited in one tile.
    pub longest_queue: u64,
    /// What the queries cost. Their `rays` count a shadow ray anew behind every surface it passes.
    pub queries: ByKind<Counters>,
}

impl AddAssign for RenderStats {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.shadow_interfaces += other.shadow_interfaces;
        self.ended_by_generation += other.ended_by_generation;
        self.ended_by_contribution += other.ended_by_contribution;
        self.replaced_contributions += other.replaced_contributions;
        self.longest_queue = self.longest_queue.max(other.longest_queue);
        self.queries += other.queries;
    }
}
