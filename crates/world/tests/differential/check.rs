//! The comparison of the engine with the oracle on one ray.

use octray_math::{DVec3, Ray, hash_u64, unit_f64};
use octray_world::{Chord, Hit, Overlaps, Region};

use crate::model::Subject;
use crate::oracle::{Answer, Place, Sight};
use crate::walls::{check_in_face, check_skins};

/// What was looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) rays: u64,
    pub(crate) crossings: u64,
    /// Points looked at.
    pub(crate) samples: u64,
    /// Of these, the ones so near to a boundary that rounding may decide.
    pub(crate) undecidable: u64,
    /// Pieces of lines between crossings.
    pub(crate) pieces: u64,
    /// Of these, the ones in a face, compared by what lies on its two sides.
    pub(crate) in_faces: u64,
    /// The ones no longer than what rounding may do to their ends.
    pub(crate) short: u64,
    /// The others in which no point could be compared: they run along boundaries.
    pub(crate) blind: u64,
}

impl Tally {
    pub(crate) fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.crossings += other.crossings;
        self.samples += other.samples;
        self.undecidable += other.undecidable;
        self.blind += other.blind;
        self.in_faces += other.in_faces;
        self.short += other.short;
        self.pieces += other.pieces;
    }
}

/// In which way the engine is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wrong {
    /// The method and brute force differ.
    Accelerator,
    /// Crossings are not in order, or one does not begin where the last ended.
    Chain,
    /// A bounded scene is not left, or a half-line is not part of its line.
    Line,
    /// A point is in another region than the crossings say.
    Region,
    /// A wall of no thickness.
    Skin,
    /// The oracle's quick answer is not its exact one.
    Oracle,
}

/// A disagreement, with what is known of it.
#[derive(Clone, Debug)]
pub(crate) struct Disagreement {
    pub(crate) wrong: Wrong,
    pub(crate) details: String,
}

/// A disagreement.
pub(crate) fn disagree(wrong: Wrong, details: String) -> Result<(), Disagreement> {
    Err(Disagreement { wrong, details })
}

/// Compares everything on one ray.
///
/// # Errors
/// The first disagreement.
pub(crate) fn check(subject: &Subject, ray: Ray, tally: &mut Tally) -> Result<(), Disagreement> {
    tally.rays += 1;
    let hits = same(subject.crossings(ray, true))?;
    tally.crossings += hits.len() as u64;
    check_chain(&hits)?;
    let sight = Sight::new(&subject.oracle, ray);
    check_half_line(subject, &sight, &hits)?;
    let objects = same(subject.chords(ray, Overlaps::Objects))?;
    let regions = same(subject.chords(ray, Overlaps::Regions))?;
    check_chords(subject, &objects)?;
    let engine = Engine {
        hits: &hits,
        objects: &objects,
        regions: &regions,
    };
    check_points(subject, &sight, &engine, tally)?;
    check_skins(subject, &sight, &hits)
}

/// What the engine says of a line.
pub(crate) struct Engine<'a> {
    hits: &'a [Hit],
    pub(crate) objects: &'a [Chord],
    regions: &'a [Chord],
}

impl Engine<'_> {
    /// Where anything happens, in order.
    fn ends(&self) -> Vec<f64> {
        let chords = self.objects.iter().chain(self.regions);
        let mut ends: Vec<f64> = chords.flat_map(|c| [c.enter.t, c.exit.t]).collect();
        ends.extend(self.hits.iter().map(|hit| hit.t));
        ends.retain(|t| t.is_finite());
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        ends
    }

    /// Whether an object holds the point at `t`, which is not where anything happens.
    pub(crate) fn holds(&self, object: u32, t: f64) -> bool {
        let own = |c: &&Chord| c.object.0 == object && c.enter.t < t && t < c.exit.t;
        self.objects.iter().any(|c| own(&c))
    }

    /// The region of the point at `t`, once from the chords and, where there are any, once from
    /// the crossings.
    fn region(&self, t: f64) -> (Option<u32>, Option<Option<u32>>) {
        let there = |c: &&Chord| c.enter.t < t && t < c.exit.t;
        let chord = self.regions.iter().find(there).map(|c| c.object.0);
        let passed = self.hits.partition_point(|hit| hit.t < t);
        let crossing = match passed.checked_sub(1) {
            Some(last) => Some(id(self.hits[last].to)),
            None => self.hits.first().map(|first| id(first.from)),
        };
        (chord, crossing)
    }
}

fn id(region: Region) -> Option<u32> {
    region.object().map(|object| object.0)
}

fn same<T: std::fmt::Debug + PartialEq>([engine, brute]: [T; 2]) -> Result<T, Disagreement> {
    if engine == brute {
        return Ok(engine);
    }
    Err(Disagreement {
        wrong: Wrong::Accelerator,
        details: format!("method {engine:#?}\nbrute {brute:#?}"),
    })
}

/// Each crossing begins in the region where the last one ended.
fn check_chain(hits: &[Hit]) -> Result<(), Disagreement> {
    let broken = |pair: &&[Hit]| !(pair[0].t <= pair[1].t && pair[0].to == pair[1].from);
    match hits.windows(2).find(broken) {
        Some(pair) => disagree(Wrong::Chain, format!("{pair:#?}")),
        None => Ok(()),
    }
}

/// The half-line is the part of the line ahead, without the crossing that the start lies on as far
/// as anyone can tell.
fn check_half_line(
    subject: &Subject,
    sight: &Sight<'_>,
    whole: &[Hit],
) -> Result<(), Disagreement> {
    let ray = *sight.ray();
    let half = same(subject.crossings(ray, false))?;
    let at_start = sight.parameter(sight.start_rounding());
    // A parameter may round to zero that is not.
    let tail = whole.len().checked_sub(half.len());
    let is_tail = tail.is_some_and(|at| {
        let (behind, ahead) = whole.split_at(at);
        let ends = behind.last().is_none_or(|hit| hit.t <= at_start);
        ends && ahead == half && half.first().is_none_or(|hit| hit.t >= 0.0)
    });
    if !is_tail {
        return disagree(Wrong::Line, format!("ahead {half:#?}\nof {whole:#?}"));
    }
    if same(subject.occluded(ray))? == half.is_empty() {
        return disagree(Wrong::Line, format!("occluded differs from {half:#?}"));
    }
    let closest = same(subject.closest(ray))?;
    if closest != half.first().copied().unwrap_or(Hit::MISS) {
        return disagree(Wrong::Line, format!("closest {closest:?}\nof {half:#?}"));
    }
    Ok(())
}

/// The chords of an object have length and do not overlap; those of a bounded one end.
fn check_chords(subject: &Subject, chords: &[Chord]) -> Result<(), Disagreement> {
    for (index, chord) in chords.iter().enumerate() {
        let (start, end) = (chord.enter.t, chord.exit.t);
        let next = chords[index + 1..]
            .iter()
            .find(|c| c.object == chord.object);
        let apart = next.is_none_or(|next| next.enter.t >= end);
        let ends = start.is_finite() && end.is_finite();
        let bounded = subject.is_bounded[chord.object.0 as usize];
        if !(start < end && apart && (ends || !bounded)) {
            return disagree(Wrong::Chain, format!("{chord:#?}\nthen {next:#?}"));
        }
    }
    Ok(())
}

/// Points to look at: between all places where anything may happen, and close to where the engine
/// says that something does.
fn points(sight: &Sight<'_>, ends: &[f64]) -> Vec<f64> {
    let reach = sight.parameter(sight.radius());
    let (start, end) = (sight.shift() - reach, sight.shift() + reach);
    let mut knots = sight.proposals();
    knots.extend(ends);
    knots.extend([start, end]);
    knots.sort_by(f64::total_cmp);
    let mut points = vec![start - reach, end + reach];
    for pair in knots.windows(2) {
        let gap = pair[1] - pair[0];
        // Two names of one place are no interval.
        if gap > 4.0 * sight.parameter(sight.uncertainty(pair[0])) {
            points.extend([0.5, 0.25, 0.9].map(|part| pair[0] + gap * part));
        }
    }
    for &t in ends {
        let near = sight.parameter(sight.uncertainty(t));
        for multiple in [16.0, 256.0, 4096.0] {
            points.extend([t - multiple * near, t + multiple * near]);
        }
    }
    // Products of subnormal numbers have no error terms.
    let normal = |t: f64| t == 0.0 || (t.is_finite() && t.abs() > 1e-200);
    points.retain(|t| normal(*t) && !ends.contains(t));
    points.sort_by(f64::total_cmp);
    points
}

fn check_points(
    subject: &Subject,
    sight: &Sight<'_>,
    engine: &Engine<'_>,
    tally: &mut Tally,
) -> Result<(), Disagreement> {
    let ends = engine.ends();
    let mut seen = vec![false; ends.len() + 1];
    let mut answers = Vec::new();
    for t in points(sight, &ends) {
        sight.answers(t, &mut answers);
        let place = sight.oracle.place(&answers);
        tally.samples += 1;
        tally.undecidable += u64::from(place == Place::Near);
        seen[ends.partition_point(|end| *end < t)] |= place != Place::Near;
        for (object, answer) in sight.oracle.objects().zip(&answers) {
            let found = engine.holds(object, t);
            if answer.is_some_and(|expected| expected != found) {
                return contradiction(sight, engine, t, &answers, &format!("object {object}"));
            }
        }
        let (chord, crossing) = engine.region(t);
        let differs = |found: Option<u32>| place != Place::Near && place != Place::In(found);
        if differs(chord) || crossing.is_some_and(differs) {
            return contradiction(sight, engine, t, &answers, &format!("region {place:?}"));
        }
    }
    check_region(subject, sight, &mut answers)?;
    tally.pieces += seen.len() as u64;
    for (index, _) in seen.iter().enumerate().filter(|(_, seen)| !**seen) {
        let low = index.checked_sub(1).map(|i| ends[i]);
        let (Some(low), Some(&high)) = (low, ends.get(index)) else {
            tally.blind += 1;
            continue;
        };
        let middle = 0.5 * (low + high);
        if !subject.is_delicate && check_in_face(sight, engine, middle)? {
            tally.in_faces += 1;
        } else if high - low <= 32.0 * sight.parameter(sight.uncertainty(middle)) {
            tally.short += 1;
        } else {
            tally.blind += 1;
        }
    }
    Ok(())
}

/// The region of a point by itself, somewhere on the line.
fn check_region(
    subject: &Subject,
    sight: &Sight<'_>,
    answers: &mut Vec<Answer>,
) -> Result<(), Disagreement> {
    let turn = hash_u64(sight.shift().to_bits());
    let away = 0.5 * sight.parameter(sight.radius()) * (2.0 * unit_f64(turn) - 1.0);
    let point = sight.ray().at(sight.shift() + away);
    let region = id(same(subject.region(point))?);
    Sight::new(sight.oracle, Ray::new(point, DVec3::X)).answers(0.0, answers);
    let place = sight.oracle.place(answers);
    if place != Place::Near && place != Place::In(region) {
        return disagree(
            Wrong::Region,
            format!("point {point:?} by itself: {region:?}, but {place:?}"),
        );
    }
    Ok(())
}

/// A disagreement at a point, after the exact definitions have confirmed the oracle.
fn contradiction(
    sight: &Sight<'_>,
    engine: &Engine<'_>,
    t: f64,
    answers: &[Answer],
    what: &str,
) -> Result<(), Disagreement> {
    let exact = sight.oracle.exact_answers(sight.ray(), t);
    let confirmed = |(answer, exact): (&Answer, &Answer)| {
        answer.is_none() || exact.is_none() || answer == exact
    };
    if !answers.iter().zip(&exact).all(confirmed) {
        return disagree(
            Wrong::Oracle,
            format!("at t = {t:?}: {answers:?}, exactly {exact:?}"),
        );
    }
    let (point, off) = (sight.ray().at(t), sight.uncertainty(t));
    let chords = engine
        .objects
        .iter()
        .map(|c| (c.object.0, c.enter.t, c.exit.t));
    let chords: Vec<_> = chords.collect();
    disagree(
        Wrong::Region,
        format!(
            "{what} at t = {t:?}, point {point}, uncertainty {off:e}: held by {answers:?}, \
             region {:?}, chords {chords:?}",
            engine.region(t),
        ),
    )
}
