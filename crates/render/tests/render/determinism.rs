//! The same bits, however the work is divided.

use std::sync::atomic::{AtomicU64, Ordering};

use octray_math::DVec3;
use octray_render::{Crop, Observer, RenderConfig, RenderJob, Rendering, encode_exr, render};
use octray_scene::Light;
use octray_world::World;

use crate::stage::*;

/// Mirrors, glass, a veil, shadows.
fn busy() -> World {
    let mut gold = glowing_mirror(0.0, 0.4);
    gold.finish.diffuse = 0.5;
    gold.finish.phong = 0.7;
    Stage::new()
        .solid(ground(-1.0), diffuse(0.8))
        .solid(ball(DVec3::new(0.0, 0.0, 0.0), 1.0), clear(1.5))
        .solid(ball(DVec3::new(-2.0, 1.0, 0.0), 1.0), gold)
        .solid(slab(2.0, 2.1), veil(DVec3::new(0.9, 0.5, 0.8)))
        .light(Light::point(DVec3::new(3.0, -4.0, 5.0), DVec3::ONE))
        .light(Light::point(
            DVec3::new(-3.0, -2.0, 1.0),
            DVec3::new(0.2, 0.3, 0.9),
        ))
        .background(0.3)
        .pinhole(DVec3::new(0.5, -6.0, 0.8), DVec3::new(-0.1, 1.0, -0.1))
        .world()
}

fn config() -> RenderConfig {
    RenderConfig {
        size: Some((90, 70)),
        spp: 3,
        ..RenderConfig::default()
    }
}

fn with_threads(threads: usize, world: &World, config: &RenderConfig) -> Rendering {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build()
        .expect("a pool")
        .install(|| shoot(world, config))
}

#[test]
fn threads_and_passes_do_not_show() {
    let world = busy();
    let one = with_threads(1, &world, &config());
    let four = with_threads(4, &world, &config());
    assert_eq!(one.film, four.film);
    assert_eq!(one.stats, four.stats);
    assert_eq!(encode_exr(&one.image()), encode_exr(&four.image()));
    let mut progressive = config();
    progressive.progressive = true;
    let passes = with_threads(4, &world, &progressive);
    assert_eq!(one.film, passes.film);
    assert_eq!(one.stats.rays, passes.stats.rays);
}

#[test]
fn a_crop_is_a_part_of_the_whole() {
    let world = busy();
    let whole = shoot(&world, &config());
    let mut cropped = config();
    let crop = Crop {
        x: 31,
        y: 7,
        width: 40,
        height: 50,
    };
    cropped.crop = Some(crop);
    let part = shoot(&world, &cropped);
    for y in 0..crop.height {
        for x in 0..crop.width {
            assert_eq!(
                part.film.mean(x, y),
                whole.film.mean(x + crop.x, y + crop.y)
            );
        }
    }
}

#[test]
fn the_seed_changes_the_samples_but_hardly_the_picture() {
    let world = busy();
    let mut other = config();
    other.seed = 1;
    let (a, b) = (
        reds(&shoot(&world, &config())),
        reds(&shoot(&world, &other)),
    );
    assert_ne!(a, b);
    let mean = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum::<f64>() / a.len() as f64;
    assert!(mean < 0.05, "{mean}");
}

/// Cancels after so many finished pixels.
struct Impatient {
    after: u64,
    done: AtomicU64,
}

impl Observer for Impatient {
    fn progress(&self, done: u64, total: u64) {
        assert!(done >= self.done.load(Ordering::SeqCst) && done <= total);
        self.done.store(done, Ordering::SeqCst);
    }

    fn cancelled(&self) -> bool {
        self.done.load(Ordering::SeqCst) >= self.after
    }
}

#[test]
fn a_cancelled_picture_has_its_finished_pixels() {
    let world = busy();
    let whole = shoot(&world, &config());
    let impatient = Impatient {
        after: 1000,
        done: AtomicU64::new(0),
    };
    let partial = render(&world, None, &config(), &impatient).expect("a picture");
    assert!(!partial.is_complete());
    let done = partial.film.complete_pixels();
    assert_eq!(done, impatient.done.load(Ordering::SeqCst));
    assert!((1000..90 * 70).contains(&done));
    for y in 0..70 {
        for x in 0..90 {
            let expected = if partial.film.is_complete(x, y) {
                whole.film.mean(x, y)
            } else {
                DVec3::ZERO
            };
            assert_eq!(partial.film.mean(x, y), expected);
        }
    }
}

#[test]
fn the_first_pass_shows_blocks_of_its_pixels() {
    let world = busy();
    let mut config = config();
    config.progressive = true;
    let mut job = RenderJob::new(&world, None, &config).expect("a job");
    assert!(job.run_pass(&()));
    assert_eq!(job.film().complete_pixels(), 12 * 9);
    let preview = job.preview();
    let at = |x: usize, y: usize| preview.pixels()[y * 90 + x];
    let mut lit = 0;
    for y in 0..70 {
        for x in 0..90 {
            assert_eq!(at(x, y), at(x - x % 8, y - y % 8));
            lit += u32::from(at(x, y) != [0.0; 3]);
        }
    }
    assert!(lit > 3000);
    let mut passes = 1;
    while job.run_pass(&()) {
        passes += 1;
    }
    assert_eq!(passes, 3);
    assert!(job.finish().is_complete());
}
