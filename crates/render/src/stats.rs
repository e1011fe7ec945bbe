//! What a rendering cost. Every number is a sum or a maximum over samples, so it does not depend
//! on the number of threads.

use std::ops::AddAssign;

use octray_world::Counters;

use crate::path::RayKind;

/// Rays by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the camera.
    pub primary: u64,
    /// From mirrors, total internal reflection included.
    pub reflected: u64,
    /// Through surfaces, bent or not.
    pub refracted: u64,
    /// To lamps.
    pub shadow: u64,
}

impl RayCounts {
    /// All kinds together.
    #[must_use]
    pub const fn total(&self) -> u64 {
        self.primary + self.reflected + self.refracted + self.shadow
    }

    pub(crate) const fn count(&mut self, kind: RayKind) {
        match kind {
            RayKind::Primary => self.primary += 1,
            RayKind::Reflected => self.reflected += 1,
            RayKind::Refracted => self.refracted += 1,
        }
    }
}

impl AddAssign for RayCounts {
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
    /// What the queries cost.
    pub queries: Counters,
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
