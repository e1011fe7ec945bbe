//! What fills the space between surfaces.

use octray_geometry::MaterialId;
use octray_math::DVec3;
use octray_scene::Scene;
use octray_world::Region;

/// The material that fills a region, `None` for empty space.
#[must_use]
pub fn medium_of(scene: &Scene, region: Region) -> Option<MaterialId> {
    let object = region.object()?;
    Some(scene.objects()[object.0 as usize].material)
}

/// What is left of light after `distance` in a medium (Beer and Lambert):
/// `exp(-absorption * distance)`, times what the medium's fade leaves. An infinite distance leaves
/// nothing where anything is absorbed.
#[must_use]
pub fn transmission(scene: &Scene, medium: Option<MaterialId>, distance: f64) -> DVec3 {
    let Some(interior) = medium.map(|id| &scene.material(id).interior) else {
        return DVec3::ONE;
    };
    let faded = interior
        .fade
        .map_or(DVec3::ONE, |fade| fade.transmission(distance));
    let absorption = interior.absorption;
    if absorption == DVec3::ZERO {
        return faded;
    }
    let left = absorption.to_array().map(|a| {
        // 0 * infinity is not a number, but no absorption leaves everything.
        if a == 0.0 {
            1.0
        } else {
            libm::exp(-a * distance)
        }
    });
    DVec3::from_array(left) * faded
}
