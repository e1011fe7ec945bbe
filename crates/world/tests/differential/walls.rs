//! Walls of no thickness between boundaries that coincide: there must be none, whether a ray runs
//! along the boundaries or through them.

use octray_geometry::surface::SURFACE_TOLERANCE;
use octray_math::{DVec3, Ray};
use octray_world::Hit;

use crate::check::{Disagreement, Engine, Wrong, disagree};
use crate::model::Subject;
use crate::oracle::Sight;

/// Where a line runs in faces that coincide, and the same objects hold both sides of them, they
/// hold the line too: there is no wall. Whether that could be compared.
pub(crate) fn check_in_face(
    sight: &Sight<'_>,
    engine: &Engine<'_>,
    t: f64,
) -> Result<bool, Disagreement> {
    let distance = 1024.0 * sight.uncertainty(t);
    // Far away from the scene, planes that are apart in it are as good as one.
    if sight.ray().at(t).distance(sight.center()) > 4.0 * sight.radius() {
        return Ok(false);
    }
    let Some(normal) = sight.shared_normal(t, 4.0 * distance) else {
        return Ok(false);
    };
    let aside = normal * distance;
    let ray = sight.ray();
    let [above, below] = [aside, -aside].map(|aside| {
        let mut answers = Vec::new();
        let beside = Ray::new(ray.origin + aside, ray.direction);
        Sight::new(sight.oracle, beside).answers(t, &mut answers);
        answers
    });
    let mut compared = false;
    for (object, sides) in sight.oracle.objects().zip(above.iter().zip(&below)) {
        let (Some(above), Some(below)) = sides else {
            continue;
        };
        if above != below {
            continue;
        }
        compared = true;
        if engine.holds(object, t) != *above {
            let what = format!("object {object} on both sides of a face");
            disagree(
                Wrong::Skin,
                format!("{what} at t = {t:?}: held {above}, {:?}", engine.objects),
            )?;
        }
    }
    Ok(compared)
}

/// Boundaries that coincide leave no sliver between them: where two crossings are far closer than
/// the tolerance, neighbouring rays must not all find the same.
pub(crate) fn check_skins(
    subject: &Subject,
    sight: &Sight<'_>,
    hits: &[Hit],
) -> Result<(), Disagreement> {
    let ray = sight.ray();
    let thin = sight.parameter(subject.oracle.scene_size() * SURFACE_TOLERANCE / 16.0);
    let far = ray.origin.length().max(sight.center().length());
    // Nor where they only touch, which looks the same in space that is squashed.
    let squashed = subject.oracle.worst_condition() > 100.0;
    if subject.is_delicate
        || squashed
        || subject.oracle.may_osculate()
        || far > 64.0 * subject.oracle.scene_size()
    {
        return Ok(());
    }
    for pair in hits.windows(2) {
        if pair[1].t - pair[0].t > thin {
            continue;
        }
        let along = ray.direction.normalize();
        let aside = along.any_orthonormal_vector();
        let across = along.cross(aside);
        let step = subject.oracle.scene_size() * 2.0_f64.powi(-14);
        let neighbours = (0..8).filter(|i| {
            let (sin, cos) = libm::sincos(f64::from(*i) * 0.8 + 0.1);
            let offset: DVec3 = (aside * cos + across * sin) * (step * (1.0 + f64::from(*i)));
            let [hits, _] = subject.crossings(Ray::new(ray.origin + offset, ray.direction), true);
            let near = sight.parameter(step * 1000.0);
            hits.windows(2)
                .any(|p| p[1].t - p[0].t <= thin && (p[0].t - pair[0].t).abs() < near)
        });
        let count = neighbours.count();
        if count >= 6 {
            return disagree(Wrong::Skin, format!("on {count} of 8 neighbours: {pair:?}"));
        }
    }
    Ok(())
}
