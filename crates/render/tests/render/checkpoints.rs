//! Renderings that were interrupted, or divided among many, give the same bits.

use std::sync::Mutex;

use octray_math::bytes::ContentHash;
use octray_math::{DVec3, hash_combine};
use octray_render::{
    Checkpoint, CheckpointError, Film, JobId, Observer, RenderConfig, RenderJob, Tile, TileFilm,
    checkpoint_records, place_records, render_tiles, tile_record,
};
use octray_scene::Light;
use octray_world::World;

use crate::stage::*;

fn world() -> World {
    Stage::new()
        .solid(ground(-1.0), diffuse(0.8))
        .solid(ball(DVec3::ZERO, 1.0), glowing_mirror(0.1, 0.5))
        .light(Light::point(DVec3::new(3.0, -4.0, 5.0), DVec3::ONE))
        .background(0.3)
        .pinhole(DVec3::new(0.5, -6.0, 0.8), DVec3::new(-0.1, 1.0, -0.1))
        .world()
}

fn config() -> RenderConfig {
    RenderConfig {
        size: Some((90, 70)),
        spp: 2,
        ..RenderConfig::default()
    }
}

fn id() -> JobId {
    JobId {
        scene: ContentHash::of(b"scene"),
        settings: ContentHash::of(b"settings"),
    }
}

/// Stops after some tiles, and keeps them.
struct Interrupting {
    kept: Mutex<Checkpoint>,
    limit: usize,
}

impl Observer for Interrupting {
    fn finished(&self, tile: &Tile, light: &TileFilm) {
        self.kept
            .lock()
            .expect("whole")
            .add(&tile_record(tile, light));
    }

    fn cancelled(&self) -> bool {
        self.kept.lock().expect("whole").tiles() >= self.limit
    }
}

#[test]
fn a_resumed_picture_has_the_same_bits() {
    let world = world();
    let whole = shoot(&world, &config());
    for progressive in [false, true] {
        let config = RenderConfig {
            progressive,
            ..config()
        };
        for limit in [0, 1, 4, 1000] {
            let observer = Interrupting {
                kept: Mutex::new(Checkpoint::new(&id())),
                limit,
            };
            let mut job = RenderJob::new(&world, None, &config).expect("a job");
            while job.run_pass(&observer) {}
            let kept = observer.kept.into_inner().expect("whole");
            let records = checkpoint_records(kept.as_bytes(), &id()).expect("of this job");
            let mut job = RenderJob::new(&world, None, &config).expect("a job");
            let placed = job.resume(records).expect("whole records");
            assert_eq!(placed.len(), kept.tiles());
            let again: usize = placed.iter().map(|(_, record)| record.len()).sum();
            assert_eq!(again, records.len());
            let before = job.film().complete_pixels();
            assert_eq!(before > 0, limit > 0);
            while job.run_pass(&()) {}
            let rendering = job.finish();
            assert_eq!(rendering.film, whole.film);
            // What was there was not rendered again.
            let pixels = 90 * 70 - before;
            assert_eq!(rendering.stats.rays.primary, 2 * pixels);
        }
    }
}

#[test]
fn tiles_put_together_in_any_order_are_the_picture() {
    let world = world();
    let whole = shoot(&world, &config());
    let plan = config().plan(world.scene().settings()).expect("a plan");
    let mut tiles = plan.tiles();
    tiles.reverse();
    let mut film = Film::new(plan.crop, plan.spp);
    let mut rays = 0;
    for part in tiles.chunks(4) {
        let (records, stats) = render_tiles(&world, &plan, part, &()).expect("a camera");
        rays += stats.rays.total();
        // The second time nothing changes.
        for _ in 0..2 {
            let placed = place_records(&records, &mut film).expect("whole records");
            assert!(placed.iter().map(|(tile, _)| tile).eq(part));
        }
    }
    assert_eq!(film, whole.film);
    assert_eq!(rays, whole.stats.rays.total());
}

#[test]
fn other_jobs_and_damage_are_told_apart() {
    let world = world();
    let plan = config().plan(world.scene().settings()).expect("a plan");
    let (records, _) = render_tiles(&world, &plan, &plan.tiles()[..2], &()).expect("a camera");
    let mut kept = Checkpoint::new(&id());
    kept.add(&records);
    let bytes = kept.as_bytes();
    assert_eq!(checkpoint_records(bytes, &id()), Ok(&records[..]));
    let other = ContentHash::of(b"other");
    let scene = JobId {
        scene: other,
        ..id()
    };
    let settings = JobId {
        settings: other,
        ..id()
    };
    assert_eq!(
        checkpoint_records(bytes, &scene),
        Err(CheckpointError::OtherScene)
    );
    assert_eq!(
        checkpoint_records(bytes, &settings),
        Err(CheckpointError::OtherSettings)
    );
    assert_eq!(
        checkpoint_records(b"P6", &id()),
        Err(CheckpointError::NotACheckpoint)
    );
    let place = |records: &[u8]| {
        let mut film = Film::new(plan.crop, plan.spp);
        place_records(records, &mut film).map(|placed| placed.len())
    };
    assert_eq!(place(&records), Ok(2));
    // Cut anywhere but between records, or changed anywhere, something is missing or damaged.
    for length in 1..records.len() {
        assert_ne!(place(&records[..length]), Ok(2));
    }
    for case in 0..2000 {
        let at = hash_combine(case, 1) as usize % records.len();
        let mut changed = records.clone();
        changed[at] ^= 1 << (hash_combine(case, 2) % 8);
        let error = place(&changed).expect_err("damaged");
        assert!(error.to_string().starts_with("the checkpoint is damaged"));
    }
}

#[test]
fn whatever_changes_the_picture_changes_the_hash() {
    let settings = octray_scene::Settings::default();
    let plan = config().plan(&settings).expect("a plan");
    let mut hashes = std::collections::BTreeSet::from([plan.hash()]);
    let changes: [fn(&mut RenderConfig); 6] = [
        |c| c.spp = 3,
        |c| c.seed = 1,
        |c| c.size = Some((70, 90)),
        |c| c.max_generations = Some(3),
        |c| c.contribution_threshold = Some(0.5),
        |c| c.shows = octray_render::Shows::Cost,
    ];
    for (number, change) in changes.into_iter().enumerate() {
        let mut config = config();
        change(&mut config);
        hashes.insert(config.plan(&settings).expect("a plan").hash());
        assert_eq!(hashes.len(), number + 2);
    }
    let mut progressive = config();
    progressive.progressive = true;
    assert_eq!(
        progressive.plan(&settings).expect("a plan").hash(),
        plan.hash()
    );
}
