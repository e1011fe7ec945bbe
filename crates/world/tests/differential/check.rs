//! The comparison of the engine with the oracle on one ray.

use octray_geometry::surface::SURFACE_TOLERANCE;
use octray_math::{DVec3, Ray};
use octray_world::Hit;

use crate::model::Subject;
use crate::oracle::{Place, Sight};

/// What was looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) rays: u64,
    pub(crate) crossings: u64,
    /// Points compared, the undecidable ones not counted.
    pub(crate) samples: u64,
    /// Points so near to a boundary that rounding may decide.
    pub(crate) undecidable: u64,
    /// Pieces between crossings in which no point could be compared.
    pub(crate) blind: u64,
    /// Pieces between crossings.
    pub(crate) pieces: u64,
}

impl Tally {
    pub(crate) fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.crossings += other.crossings;
        self.samples += other.samples;
        self.undecidable += other.undecidable;
        self.blind += other.blind;
        self.pieces += other.pieces;
    }
}

/// In which way the engine is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wrong {
    /// The octree and brute force differ.
    Accelerator,
    /// Crossings are not in order, or one does not begin where the last ended.
    Chain,
    /// A bounded scene is not left, or a half-line is not part of its line.
    Line,
    /// A point is in another region than the crossings say.
    Region,
    /// A wall of no thickness.
    Skin,
}

/// A disagreement, with what is known of it.
#[derive(Clone, Debug)]
pub(crate) struct Disagreement {
    pub(crate) wrong: Wrong,
    pub(crate) details: String,
}

fn disagree(wrong: Wrong, details: String) -> Result<(), Disagreement> {
    Err(Disagreement { wrong, details })
}

/// Compares everything on one ray.
///
/// # Errors
/// The first disagreement.
pub(crate) fn check(subject: &Subject, ray: Ray, tally: &mut Tally) -> Result<(), Disagreement> {
    tally.rays += 1;
    let [hits, brute] = subject.crossings(ray, true);
    if hits != brute {
        return disagree(Wrong::Accelerator, format!("octree {hits:?}\nbrute {brute:?}"));
    }
    tally.crossings += hits.len() as u64;
    check_chain(subject, &hits)?;
    check_half_line(subject, ray, &hits)?;
    let sight = Sight::new(&subject.oracle, ray);
    check_regions(subject, &sight, &hits, tally)?;
    check_skins(subject, &sight, &hits)
}

fn object(region: octray_world::Region) -> Option<u32> {
    region.object().map(|id| id.0)
}

fn check_chain(subject: &Subject, hits: &[Hit]) -> Result<(), Disagreement> {
    for pair in hits.windows(2) {
        let alternates = !subject.is_single || pair[0].entering != pair[1].entering;
        if !(pair[0].t <= pair[1].t && pair[0].to == pair[1].from && alternates) {
            return disagree(Wrong::Chain, format!("{pair:?}"));
        }
    }
    if subject.is_single {
        let of_object = |hit: &&Hit| hit.entering != (hit.to.object().is_some());
        if let Some(hit) = hits.iter().find(of_object) {
            return disagree(Wrong::Chain, format!("{hit:?}"));
        }
    }
    if let (true, Some(first), Some(last)) = (subject.is_bounded, hits.first(), hits.last())
        && (first.from.object().is_some() || last.to.object().is_some())
    {
        return disagree(Wrong::Line, format!("{first:?}\n{last:?}"));
    }
    Ok(())
}

fn check_half_line(subject: &Subject, ray: Ray, whole: &[Hit]) -> Result<(), Disagreement> {
    let [half, brute] = subject.crossings(ray, false);
    if half != brute {
        return disagree(Wrong::Accelerator, format!("octree {half:?}\nbrute {brute:?}"));
    }
    let ahead = whole.partition_point(|hit| hit.t <= 0.0);
    if half != whole[ahead..] {
        return disagree(Wrong::Line, format!("ahead {half:?}\nof {whole:?}"));
    }
    let closest = subject.closest(ray);
    if closest != half.first().copied().unwrap_or(Hit::MISS) {
        return disagree(Wrong::Line, format!("closest {closest:?}\nof {half:?}"));
    }
    Ok(())
}

/// Points to look at: in the middle between all places where anything may happen, and close to
/// every crossing.
fn samples(sight: &Sight<'_>, hits: &[Hit]) -> Vec<f64> {
    let reach = sight.parameter(sight.radius());
    let (start, end) = (sight.shift() - reach, sight.shift() + reach);
    let mut knots = sight.proposals();
    knots.extend(hits.iter().map(|hit| hit.t));
    knots.extend([start, end]);
    knots.sort_by(f64::total_cmp);
    let mut points = vec![start - reach, end + reach];
    for pair in knots.windows(2) {
        let gap = pair[1] - pair[0];
        points.extend([0.5, 0.25, 0.9].map(|part| pair[0] + gap * part));
    }
    for hit in hits {
        let near = sight.parameter(sight.uncertainty(hit.t));
        for multiple in [2.0, 16.0, 1024.0] {
            points.extend([hit.t - multiple * near, hit.t + multiple * near]);
        }
    }
    points.retain(|t| t.is_finite());
    points.sort_by(f64::total_cmp);
    points
}

fn check_regions(
    subject: &Subject,
    sight: &Sight<'_>,
    hits: &[Hit],
    tally: &mut Tally,
) -> Result<(), Disagreement> {
    // Without crossings, a line that is all inside is not told from one that is all outside.
    let mut everywhere = subject.is_bounded.then_some(None);
    let mut seen = vec![false; hits.len() + 1];
    for t in samples(sight, hits) {
        let piece = hits.partition_point(|hit| hit.t < t);
        // At the parameter of a crossing one is on both sides of it.
        if hits.get(piece).is_some_and(|hit| hit.t == t) {
            continue;
        }
        let Place::In(found) = sight.place(t) else {
            tally.undecidable += 1;
            continue;
        };
        tally.samples += 1;
        seen[piece] = true;
        let expected = match (piece.checked_sub(1), hits.first()) {
            (Some(before), _) => object(hits[before].to),
            (None, Some(first)) => object(first.from),
            (None, None) => *everywhere.get_or_insert(found),
        };
        if found != expected {
            let exact = subject.oracle.exact_place(sight.ray(), t);
            assert!(
                exact == Place::In(found),
                "the oracle contradicts itself at {t:?}: {found:?}, exactly {exact:?}"
            );
            let p = sight.ray().at(t);
            let off = sight.uncertainty(t);
            return disagree(
                Wrong::Region,
                format!("t = {t:?}, point {p}, uncertainty {off:e}: the engine is in {expected:?}, the oracle in {found:?}\n{hits:#?}"),
            );
        }
    }
    tally.pieces += seen.len() as u64;
    tally.blind += seen.iter().filter(|seen| !**seen).count() as u64;
    Ok(())
}

/// Boundaries that coincide leave no sliver between them: where two crossings are far closer than
/// the tolerance, neighbouring rays must not all find the same.
fn check_skins(subject: &Subject, sight: &Sight<'_>, hits: &[Hit]) -> Result<(), Disagreement> {
    let ray = sight.ray();
    let thin = sight.parameter(subject.oracle.scene_size() * SURFACE_TOLERANCE / 16.0);
    let far = ray.origin.length().max(sight.center().length());
    if subject.is_delicate || far > 64.0 * subject.oracle.scene_size() {
        return Ok(());
    }
    for pair in hits.windows(2) {
        if pair[1].t - pair[0].t > thin {
            continue;
        }
        let along = ray.direction.normalize();
        let aside = along.any_orthonormal_vector();
        let across = along.cross(aside);
        let step = subject.oracle.scene_size() * 2.0_f64.powi(-16);
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
