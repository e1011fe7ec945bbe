//! Haines' published numbers of rays for 513 x 513 pixels; he gives them as right to about 10 %.
//!
//! His table does not say where the ray trees end. Without a contribution threshold, five
//! generations (primary rays and four bounces) give all his numbers to 1 %; four or six give up
//! to 10 % fewer or more reflected rays.

mod corpus;
mod spd;

use corpus::corpus;
use octray_render::{RenderConfig, RenderStats};
use spd::rendered;

const GENERATIONS: u32 = 5;

/// Published eye rays that hit something, reflected, refracted and shadow rays.
fn check(name: &str, published: [u64; 4]) {
    let Some(folder) = corpus("spd") else { return };
    let config = RenderConfig {
        size: Some((513, 513)),
        max_generations: Some(GENERATIONS),
        contribution_threshold: Some(0.0),
        ..RenderConfig::default()
    };
    let (rendering, _) = rendered(&folder.join(name).with_extension("nff"), &config);
    let RenderStats { rays, hits, .. } = rendering.stats;
    assert_eq!(rays.primary, 513 * 513);
    let counted = [hits.primary, rays.reflected, rays.refracted, rays.shadow];
    for (counted, published) in counted.into_iter().zip(published) {
        let off = counted.abs_diff(published) as f64;
        assert!(
            off <= 0.15 * published as f64,
            "{name}: {counted}, published {published}"
        );
    }
}

#[test]
fn balls() {
    check("balls", [263_169, 175_095, 0, 954_368]);
}

#[test]
fn mount() {
    check("mount", [173_125, 354_769, 354_769, 412_922]);
}

#[test]
fn rings() {
    check("rings", [263_169, 315_236, 0, 1_085_002]);
}

#[test]
fn tetra() {
    check("tetra", [49_788, 0, 0, 46_112]);
}

#[test]
fn tree() {
    check("tree", [169_836, 0, 0, 1_097_419]);
}
