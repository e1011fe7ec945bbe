#![allow(clippy::unwrap_used, reason = "a failed build fails the test")]

use octray_kernels::Lanes;
use octray_math::{Aabb, DVec3, Interval, Ray, hash_combine, unit_f64};

use super::*;

struct Random(u64, u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.1 += 1;
        unit_f64(hash_combine(self.0, self.1))
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    fn point(&mut self, size: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| size * (2.0 * self.unit() - 1.0)))
    }
}

fn around(center: DVec3, half: DVec3) -> Aabb {
    Aabb::new(center - half.abs(), center + half.abs())
}

/// Boxes of all kinds, each with what is special about them.
fn zoo() -> Vec<(&'static str, Vec<Aabb>)> {
    let mut r = Random(1, 0);
    let n = 700;
    let mut scattered = |size: f64, half: f64| -> Vec<Aabb> {
        (0..n)
            .map(|_| around(r.point(size), r.point(half)))
            .collect()
    };
    let even = scattered(1.0, 0.05);
    let tiny = scattered(1e-160, 1e-162);
    let huge = scattered(1e150, 1e148);
    let points = scattered(3.0, 0.0);
    let head = scattered(1e-3, 1e-4);
    let far = scattered(1.0, 0.1)
        .into_iter()
        .map(|b| Aabb::new(b.min + 1e9, b.max + 1e9))
        .collect();
    let flat = even
        .iter()
        .enumerate()
        .map(|(i, b)| {
            let mut b = *b;
            b.max[i % 3] = b.min[i % 3];
            b
        })
        .collect();
    let stadium = head
        .into_iter()
        .chain(even.iter().map(|b| Aabb::new(b.min * 1e6, b.max * 1e6)))
        .collect();
    let grid = (0..512)
        .map(|i| {
            let corner = DVec3::new((i & 7).into(), (i >> 3 & 7).into(), (i >> 6).into());
            Aabb::new(corner, corner + 1.0)
        })
        .collect();
    let nested = (0..n)
        .map(|i| around(DVec3::ZERO, DVec3::splat(f64::from(i))))
        .collect();
    // Each half as large and half as far from the origin as the one before, beyond any grid.
    let shrinking = (0..n)
        .map(|i| {
            let x = libm::ldexp(1.0, -i);
            around(DVec3::splat(x), DVec3::splat(x * 0.4))
        })
        .collect();
    let same = vec![around(DVec3::X, DVec3::ONE); n as usize];
    let mut with_empty = even.clone();
    for i in (0..with_empty.len()).step_by(3) {
        with_empty[i] = Aabb::EMPTY;
        with_empty[i / 3].min.y = f64::NAN;
    }
    vec![
        ("even", even),
        ("tiny", tiny),
        ("huge", huge),
        ("points", points),
        ("far from the origin", far),
        ("flat", flat),
        ("small in large", stadium),
        ("touching", grid),
        ("nested", nested),
        ("shrinking", shrinking),
        ("coincident", same),
        ("some empty", with_empty),
        ("one", vec![around(DVec3::Y, DVec3::ONE)]),
        ("none", Vec::new()),
        ("nothing but empty", vec![Aabb::EMPTY; 9]),
    ]
}

/// Lines through boxes, along their faces, through their corners; from near and far.
fn aimed(boxes: &[Aabb], whole: &Aabb, r: &mut Random) -> Ray {
    let size = whole.half_size().max_element().max(1e-170);
    let target = match boxes.get(r.below(boxes.len().max(1))) {
        Some(b) if !b.is_empty() => match r.below(3) {
            0 => b.corners()[r.below(8)],
            1 => b.center(),
            _ => b.min + b.size() * r.unit(),
        },
        _ => r.point(size),
    };
    let axis = DVec3::AXES[r.below(3)] * [1.0, -1.0][r.below(2)];
    let direction = match r.below(4) {
        0 => axis,
        1 => axis + DVec3::AXES[r.below(3)],
        _ => r.point(1.0),
    };
    let direction = if direction == DVec3::ZERO {
        axis
    } else {
        direction
    };
    let back = [0.0, 1.0, 3.0, 1e4][r.below(4)] * size;
    Ray::new(
        target - direction * back,
        direction * [1.0, size, 1e-3][r.below(3)],
    )
}

const QUALITIES: [Quality; 2] = [Quality::Fast, Quality::Full];

/// Every kind of boxes with every quality.
fn cases() -> impl Iterator<Item = (&'static str, Vec<Aabb>, Quality)> {
    let all = zoo().into_iter();
    all.flat_map(|(name, boxes)| QUALITIES.map(|quality| (name, boxes.clone(), quality)))
}

fn tree(boxes: &[Aabb], quality: Quality) -> WideTree {
    let config = WideTreeConfig {
        quality,
        ..WideTreeConfig::default()
    };
    WideTree::build(boxes, &config).unwrap()
}

/// Where the line enters the box, as `f64` has it.
fn entry(b: &Aabb, ray: &Ray, span: &Interval) -> Option<f64> {
    let met = b.clip(ray).intersection(span);
    (!b.is_empty() && !met.is_empty()).then_some(met.start)
}

fn span(r: &mut Random, ray: &Ray, whole: &Aabb) -> Interval {
    let reach = whole.clip(ray);
    match r.below(3) {
        0 => Interval::ALL,
        1 => Interval::new(0.0, f64::INFINITY),
        _ if reach.is_empty() => Interval::new(-1.0, 1.0),
        _ => {
            let mid = reach.start + (reach.end - reach.start) * r.unit();
            Interval::new(mid, mid + (reach.end - reach.start) * r.unit())
        }
    }
}

#[test]
fn every_item_stands_in_one_leaf_and_the_depth_is_bounded() {
    for (name, boxes) in zoo() {
        for (leaf_size, quality) in [1, 4, 8]
            .into_iter()
            .flat_map(|n| QUALITIES.map(|q| (n, q)))
        {
            let config = WideTreeConfig {
                quality,
                leaf_size,
                ..WideTreeConfig::default()
            };
            let tree = WideTree::build(&boxes, &config).unwrap();
            let mut items = tree.items.clone();
            items.sort_unstable();
            let wanted: Vec<u32> = (0..boxes.len() as u32)
                .filter(|&i| !boxes[i as usize].is_empty())
                .collect();
            assert_eq!(items, wanted, "{name}");
            assert!(tree.stats.depth <= MAX_DEPTH, "{name}");
            let mut seen = vec![0; tree.items.len()];
            for node in &tree.nodes {
                for lane in 0..8 {
                    let used = node.boxes.planes[0][lane] < f32::INFINITY;
                    let Some(places) = link::items(node.links[lane]).filter(|_| used) else {
                        continue;
                    };
                    assert!(places.len() <= leaf_size as usize);
                    for place in places {
                        seen[place] += 1;
                        let inner = tree.frame.outward(&boxes[tree.items[place] as usize]);
                        for axis in 0..3 {
                            assert!(node.boxes.planes[axis][lane] <= inner.min[axis]);
                            assert!(node.boxes.planes[axis + 3][lane] >= inner.max[axis]);
                        }
                    }
                }
            }
            assert!(seen.iter().all(|&count| count == 1), "{name}");
        }
    }
}

#[test]
fn no_box_on_the_line_is_left_out_and_few_others_are_shown() {
    let (mut met, mut shown) = (0, 0);
    for (seed, (name, boxes, quality)) in cases().enumerate() {
        let tree = tree(&boxes, quality);
        let mut r = Random(100 + seed as u64, 0);
        for _ in 0..400 {
            let ray = aimed(&boxes, tree.bounds(), &mut r);
            let span = span(&mut r, &ray, tree.bounds());
            let mut cost = WalkCost::default();
            let mut visits = vec![0; boxes.len()];
            tree.all(&ray, span, &mut cost, |item| visits[item as usize] += 1);
            assert_eq!(cost.items, visits.iter().sum::<u64>());
            for (b, &visits) in boxes.iter().zip(&visits) {
                let hit = entry(b, &ray, &span).is_some();
                assert!(
                    visits == 1 || (visits == 0 && !hit),
                    "{name}: {ray:?} {span:?} {b:?}"
                );
                met += u64::from(hit);
                shown += visits;
            }
        }
    }
    assert!(met > 100_000 && shown < 4 * met, "{met} {shown}");
}

#[test]
fn the_first_box_is_the_one_that_trying_all_of_them_finds() {
    let mut found = 0;
    for (seed, (name, boxes, quality)) in cases().enumerate() {
        let vector = tree(&boxes, quality);
        let scalar = vector.clone().with_lanes(Lanes::Scalar);
        let mut r = Random(200 + seed as u64, 0);
        for _ in 0..1500 {
            let ray = aimed(&boxes, vector.bounds(), &mut r);
            let span = span(&mut r, &ray, vector.bounds());
            // Ties go to the lowest item.
            let better = |best: &mut Option<(f64, u32)>, item: u32| {
                if let Some(t) = entry(&boxes[item as usize], &ray, &span)
                    && best.is_none_or(|b| (t, item) < b)
                {
                    *best = Some((t, item));
                }
            };
            let mut wanted = None;
            for item in 0..boxes.len() as u32 {
                better(&mut wanted, item);
            }
            let walk = |tree: &WideTree| {
                let (mut best, mut order) = (None, Vec::new());
                let mut cost = WalkCost::default();
                tree.closest(&ray, span, &mut cost, |item, end| {
                    order.push(item);
                    better(&mut best, item);
                    best.map_or(end, |(t, _)| t)
                });
                (best, order, cost)
            };
            let (best, order, cost) = walk(&vector);
            assert_eq!(best, wanted, "{name}: {ray:?} {span:?}");
            assert_eq!((best, order, cost), walk(&scalar), "{name}: {ray:?}");
            let mut cost = WalkCost::default();
            let any = vector.any(&ray, span, &mut cost, |item| {
                entry(&boxes[item as usize], &ray, &span).is_some()
            });
            assert_eq!(any, wanted.is_some(), "{name}");
            found += u32::from(any);
        }
    }
    assert!(found > 8_000, "{found}");
}

#[test]
fn no_box_in_a_region_is_left_out() {
    let mut overlapping = 0;
    for (seed, (name, boxes, quality)) in cases().enumerate() {
        let tree = tree(&boxes, quality);
        let mut r = Random(300 + seed as u64, 0);
        let size = tree.bounds().half_size().max_element();
        for _ in 0..100 {
            let ray = aimed(&boxes, tree.bounds(), &mut r);
            let reach = [0.0, 0.1, f64::INFINITY][r.below(3)];
            let half = r.point(size * reach);
            let region = around(
                ray.origin,
                if half.is_nan() { DVec3::INFINITY } else { half },
            );
            let mut shown = vec![false; boxes.len()];
            assert!(!tree.any_overlapping(&region, |item| {
                assert!(!std::mem::replace(&mut shown[item as usize], true));
                false
            }));
            let wanted = |b: &Aabb| !b.is_empty() && b.overlaps(&region);
            for (b, &shown) in boxes.iter().zip(&shown) {
                assert!(shown || !wanted(b), "{name}: {region:?} {b:?}");
                overlapping += u32::from(wanted(b));
            }
            let any = tree.any_overlapping(&region, |item| wanted(&boxes[item as usize]));
            assert_eq!(any, boxes.iter().any(wanted), "{name}");
        }
    }
    assert!(overlapping > 10_000, "{overlapping}");
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let mut r = Random(3, 0);
    let mut boxes: Vec<_> = (0..40_000)
        .map(|i| {
            // Many centres coincide, so that ties and refinements matter.
            let center = (r.point(4.0) * [1.0, 2.0, 1e-7][i % 3]).round() * 0.5;
            around(center, r.point(0.1))
        })
        .collect();
    boxes.extend((0..9_000).map(|_| around(r.point(1e-9), r.point(1e-12))));
    let build = |threads: usize, quality| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| tree(&boxes, quality))
    };
    for quality in QUALITIES {
        let one = build(1, quality);
        for threads in [2, 4] {
            let other = build(threads, quality);
            assert!(one.bytes() == other.bytes());
            assert_eq!(one.stats, other.stats);
        }
    }
}

#[test]
fn a_cluster_far_smaller_than_a_cell_is_still_divided() {
    let mut r = Random(4, 0);
    let mut boxes = vec![around(DVec3::splat(1e9), DVec3::ONE)];
    boxes.extend((0..5000).map(|_| around(r.point(1e-3), DVec3::splat(1e-6))));
    for quality in QUALITIES {
        let tree = tree(&boxes, quality);
        let mut cost = WalkCost::default();
        // In f32 all of it is one point, but order and depth must not degenerate.
        tree.all(
            &Ray::new(-DVec3::X, DVec3::X),
            Interval::ALL,
            &mut cost,
            |_| (),
        );
        assert!(
            tree.stats.depth < 12 && tree.stats.nodes < 2500,
            "{:?}",
            tree.stats
        );
    }
}

#[test]
fn broken_rays_and_empty_spans_meet_nothing() {
    let boxes = [around(DVec3::ZERO, DVec3::ONE)];
    let tree = tree(&boxes, Quality::Full);
    let mut cost = WalkCost::default();
    let bad = [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY];
    for direction in bad {
        let ray = Ray::new(DVec3::ZERO, direction);
        assert!(!tree.any(&ray, Interval::ALL, &mut cost, |_| true));
    }
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    for span in [
        Interval::EMPTY,
        Interval::new(f64::NAN, 1.0),
        Interval::new(2.0, 3.0),
    ] {
        assert!(!tree.any(&ray, span, &mut cost, |_| true), "{span:?}");
    }
    // Lengths of directions and places of origins that overflow when squared.
    for scale in [1e-320, 1e-200, 1.0, 1e200, 1e308] {
        let ray = Ray::new(DVec3::ZERO, DVec3::X * scale);
        assert!(tree.any(&ray, Interval::ALL, &mut cost, |_| true));
        let ray = Ray::new(DVec3::X * -scale, DVec3::X);
        assert!(tree.any(&ray, Interval::ALL, &mut cost, |_| true));
    }
}

#[test]
fn what_cannot_be_built_is_said() {
    let half = Aabb::new(DVec3::ZERO, DVec3::INFINITY);
    let boxes = [around(DVec3::ZERO, DVec3::ONE), half];
    let config = WideTreeConfig::default();
    assert_eq!(
        WideTree::build(&boxes, &config).unwrap_err(),
        WideTreeError::Unbounded(1)
    );
    let config = WideTreeConfig {
        memory_limit: 1000,
        ..config
    };
    let error = WideTree::build(&[boxes[0]; 100], &config).unwrap_err();
    assert!(matches!(
        error,
        WideTreeError::Memory { items: 100, limit: 1000, needed } if needed > 1000
    ));
    // The limit decides at the byte, and in the same way however much is lacking.
    for (name, boxes, quality) in cases() {
        let build = |memory_limit: u64| {
            let config = WideTreeConfig {
                quality,
                memory_limit,
                ..WideTreeConfig::default()
            };
            WideTree::build(&boxes, &config)
        };
        let (mut limit, mut refusals) = (0, 0);
        let tree = loop {
            match build(limit) {
                Ok(tree) => break tree,
                Err(WideTreeError::Memory { needed, .. }) if needed > limit => limit = needed,
                Err(other) => panic!("{name}: {other}"),
            }
            refusals += 1;
            assert!(refusals <= 2, "{name}");
        };
        assert!(tree.stats.bytes <= limit, "{name}");
        assert!(limit == 0 || build(limit - 1).is_err(), "{name}");
    }
}

/// Segments: the thinnest things that a box can be large for.
struct Segments(Vec<[DVec3; 2]>);

impl Items for Segments {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, item: u32) -> Aabb {
        Aabb::from_points(self.0[item as usize])
    }

    const DIVISIBLE: bool = true;

    fn halves(
        &self,
        item: u32,
        coordinates: &Coordinates,
        within: &Aabb,
        planes: DVec3,
    ) -> [[Aabb; 2]; 3] {
        let [a, b] = self.0[item as usize].map(|p| coordinates.point(p));
        let line = Ray::new(a, b - a);
        let part = |region: Aabb| {
            let span = region.inflated(1e-14).clip(&line);
            let span = span.intersection(&Interval::new(0.0, 1.0));
            let ends = [span.start, span.end].map(|t| line.at(t));
            let part = Aabb::from_points(ends).inflated(1e-14);
            if span.is_empty() { Aabb::EMPTY } else { part }
        };
        [0, 1, 2].map(|axis| {
            let (mut low, mut high) = (*within, *within);
            low.max[axis] = planes[axis];
            high.min[axis] = planes[axis];
            [low, high].map(part)
        })
    }
}

fn segments() -> Segments {
    let mut r = Random(7, 0);
    let long = |r: &mut Random| {
        let a = r.point(1.0);
        [a, a + (DVec3::new(1.0, 0.7, 0.4) + r.point(0.1)) * 0.8]
    };
    let mut all: Vec<_> = (0..2500).map(|_| long(&mut r)).collect();
    // Along an axis and along planes; one many times; among small ones.
    all.extend((0..200).map(|_| {
        let a = r.point(1.0);
        [a, a + DVec3::X]
    }));
    all.extend((0..200).map(|_| {
        let a = r.point(1.0);
        [a, a + DVec3::new(0.5, 0.5, 0.0)]
    }));
    all.extend([all[0]; 100]);
    all.extend((0..2000).map(|_| {
        let a = r.point(1.0);
        [a, a + r.point(0.01)]
    }));
    Segments(all)
}

#[test]
fn parts_in_leaves_cover_what_is_divided() {
    let items = segments();
    let build = |threads: usize, quality| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let config = WideTreeConfig {
            quality,
            ..WideTreeConfig::default()
        };
        let pool = pool.build().unwrap();
        pool.install(|| WideTree::over(&items, &config).unwrap())
    };
    let tree = build(1, Quality::Full);
    assert!(build(3, Quality::Full).bytes() == tree.bytes());
    let count = items.count() as u64;
    assert_eq!(tree.stats.items, count);
    assert!(tree.stats.references > count + count / 10 && tree.stats.references <= count * 13 / 10);
    let once = build(1, Quality::Fast);
    assert_eq!((once.stats.references, once.stats.items), (count, count));
    let mut boxes = vec![Vec::new(); items.count()];
    for node in &tree.nodes {
        for (lane, &child) in node.links.iter().enumerate() {
            let plane = |side: usize| node.boxes.planes[side][lane];
            let Some(places) = link::items(child).filter(|_| plane(0) < f32::INFINITY) else {
                continue;
            };
            let listed = &tree.items[places];
            for (i, &item) in listed.iter().enumerate() {
                assert!(!listed[..i].contains(&item), "twice in a leaf");
                boxes[item as usize].push([0, 1, 2, 3, 4, 5].map(plane));
            }
        }
    }
    for (ends, boxes) in items.0.iter().zip(&boxes) {
        for i in 0..=200 {
            let point = ends[0] + (ends[1] - ends[0]) * (f64::from(i) / 200.0);
            let p = tree.frame.point(point).to_array();
            let holds = |b: &[f32; 6]| {
                (0..3).all(|axis| {
                    f64::from(b[axis]) <= p[axis] + 1e-15 && p[axis] - 1e-15 <= b[axis + 3].into()
                })
            };
            assert!(boxes.iter().any(holds), "{ends:?} {i}");
        }
    }
    // One by one, a line is shown fewer of them than if they were whole.
    let config = WideTreeConfig {
        leaf_size: 1,
        ..WideTreeConfig::default()
    };
    let boxes: Vec<Aabb> = (0..count as u32).map(|item| items.bounds(item)).collect();
    let shown = |tree: &WideTree| {
        let (mut r, mut cost) = (Random(8, 0), WalkCost::default());
        for _ in 0..300 {
            let ray = Ray::new(r.point(1.0), r.point(1.0));
            tree.all(&ray, Interval::ALL, &mut cost, |_| ());
        }
        cost.items
    };
    let parts = shown(&WideTree::over(&items, &config).unwrap());
    let whole = shown(&WideTree::build(&boxes, &config).unwrap());
    assert!(parts < whole, "{parts} {whole}");
}
