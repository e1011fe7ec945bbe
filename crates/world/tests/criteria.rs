//! Criteria of division, sizes of hash tables, and the figures about what they make.

use std::sync::Arc;

use octray_geometry::{Sheet, Solid, TriangleMesh};
use octray_math::{DVec3, Ray};
use octray_scene::{Material, Object, Scene, SceneBuilder};
use octray_world::{
    CellsOf, Counters, Criteria, Hit, LvsiTable, RayQuery, TableSize, World, WorldCell, WorldConfig,
};

/// A drilled plate with pins, far from the origin, and balls above it.
fn scene() -> Arc<Scene> {
    let at = DVec3::new(1000.0, -500.0, 30.0);
    let mut parts = vec![Solid::cuboid(DVec3::ZERO, DVec3::new(12.0, 12.0, 1.0)).expect("valid")];
    for i in 0..36 {
        let place = DVec3::new(
            f64::from(i % 6) * 2.0 + 1.0,
            f64::from(i / 6) * 2.0 + 1.0,
            -1.0,
        );
        let hole = Solid::cylinder(0.1 + 0.01 * f64::from(i), -1.5, 1.5).expect("valid");
        parts.push(hole.translate(place + DVec3::Z * 1.5).expect("finite"));
    }
    let plate = Solid::difference(parts).translate(at).expect("finite");
    let mut builder = SceneBuilder::new();
    let grey = builder.add_material(Material::matte("grey", DVec3::splat(0.5)));
    builder.add_object(Object::solid("plate", plate, grey));
    for i in 0..20 {
        let place = DVec3::new(
            f64::from(i % 5) * 2.5,
            f64::from(i / 5) * 2.5,
            2.0 + f64::from(i % 3),
        );
        let ball = Solid::sphere(0.7)
            .expect("valid")
            .translate(at + place)
            .expect("finite");
        builder.add_object(Object::solid("ball", ball, grey));
    }
    Arc::new(builder.build().expect("valid"))
}

fn prepare(method: &str, criteria: Criteria, table: LvsiTable) -> World {
    let config = WorldConfig {
        method: method.parse().expect("a method"),
        criteria,
        table,
        ..WorldConfig::default()
    };
    World::prepare(scene(), &config).expect("a world")
}

fn rays() -> Vec<RayQuery> {
    let mut seed = 11;
    let mut real = || {
        seed = octray_math::hash_combine(seed, 3);
        octray_math::unit_f64(seed)
    };
    let corner = DVec3::new(1000.0, -500.0, 30.0);
    let mut ray = |_| {
        let target = corner + DVec3::new(real() * 12.0, real() * 12.0, real() * 4.0);
        let away = DVec3::new(real() - 0.5, real() - 0.5, real() - 0.3);
        RayQuery::new(Ray::new(target + away * 40.0, -away))
    };
    (0..600).map(&mut ray).collect()
}

fn closest(world: &World) -> Vec<Hit> {
    let mut hits = Vec::new();
    world.closest(&rays(), &mut hits, &mut Counters::default());
    hits
}

fn cells(world: &World) -> Vec<WorldCell> {
    let mut cells = Vec::new();
    world.visit_cells(CellsOf::Solids, |cell| cells.push(cell));
    cells
}

const OFF: Criteria = Criteria {
    max_depth: 6,
    max_parts: 0,
    max_share: 1.0,
    by_cost: false,
    visit_cost: 4.0,
    bytes_per_part: 512,
    memory_limit: 64 << 20,
};

#[test]
fn no_criterion_and_no_table_changes_an_answer() {
    let expected = closest(&prepare("brute", Criteria::default(), LvsiTable::default()));
    assert!(expected.iter().filter(|hit| !hit.is_miss()).count() > 200);
    let usual = Criteria::default();
    let criteria = [
        Criteria {
            max_depth: 0,
            ..usual
        },
        Criteria {
            max_depth: 2,
            ..usual
        },
        Criteria {
            max_parts: 3,
            ..OFF
        },
        Criteria {
            max_share: 0.3,
            ..OFF
        },
        Criteria {
            max_share: 0.5,
            max_parts: 2,
            by_cost: true,
            ..OFF
        },
        Criteria {
            visit_cost: 0.0,
            ..usual
        },
        Criteria {
            visit_cost: 100.0,
            ..usual
        },
        Criteria {
            max_depth: 21,
            memory_limit: 1 << 18,
            ..OFF
        },
        Criteria {
            memory_limit: 0,
            ..usual
        },
    ];
    for method in [
        "octree",
        "octree:tree:fujimoto-iwata",
        "octree:lvsi",
        "octree:lvsi-empty",
        "grid",
    ] {
        for criteria in criteria {
            let world = prepare(method, criteria, LvsiTable::default());
            assert_eq!(closest(&world), expected, "{method} {criteria:?}");
        }
    }
    for load in [1.0 / 64.0, 1.0, 64.0, f64::NAN, -1.0] {
        for size in [TableSize::Prime, TableSize::PowerOfTwo] {
            let world = prepare("octree:lvsi", usual, LvsiTable { size, load });
            assert_eq!(closest(&world), expected, "{load} {size:?}");
        }
    }
}

#[test]
fn every_criterion_bites() {
    let with = |criteria| prepare("octree", criteria, LvsiTable::default());
    for max_parts in [1, 2, 5] {
        let world = with(Criteria {
            max_parts,
            max_depth: 9,
            ..OFF
        });
        for cell in cells(&world) {
            assert!(cell.key.depth == 9 || cell.parts <= max_parts, "{cell:?}");
        }
    }
    let depth = |criteria| with(criteria).stats().cells.expect("cells").cells.depth;
    assert_eq!(depth(OFF), 6);
    assert_eq!(
        depth(Criteria {
            max_depth: 3,
            ..OFF
        }),
        3
    );
    let leaves = |criteria| cells(&with(criteria)).len();
    let usual = leaves(Criteria::default());
    assert!(
        leaves(Criteria {
            visit_cost: 20.0,
            ..Criteria::default()
        }) < usual
    );
    assert!(
        leaves(Criteria {
            visit_cost: 1.0,
            ..Criteria::default()
        }) > usual
    );
    let shares = [0.0, 0.2, 0.6, 1.0].map(|max_share| leaves(Criteria { max_share, ..OFF }));
    assert!(
        shares.is_sorted() && shares[0] < shares[1] && shares[2] < shares[3],
        "{shares:?}"
    );
    let memory = Criteria {
        max_depth: 12,
        memory_limit: 1 << 20,
        ..OFF
    };
    let stats = with(memory).stats().cells.expect("cells").cells;
    assert!(stats.stopped_by_memory && stats.bytes <= 1 << 20);
}

#[test]
fn cells_fill_the_root_and_surfaces_lie_in_occupied_ones() {
    for method in ["octree", "octree:lvsi-empty", "octree:lvsi", "grid:12"] {
        let world = prepare(method, Criteria::default(), LvsiTable::default());
        let (cells, root) = (cells(&world), world.root(CellsOf::Solids).expect("a root"));
        let stats = world.stats();
        let figures = &stats.cells.as_ref().expect("cells").cells;
        let occupied: Vec<_> = cells.iter().filter(|cell| cell.objects.is_some()).collect();
        assert_eq!(occupied.len() as u64, figures.occupied);
        assert_eq!(stats.objects_per_leaf.total(), figures.occupied);
        let held: u64 = occupied
            .iter()
            .filter_map(|cell| cell.objects)
            .map(u64::from)
            .sum();
        let mean = held as f64 / occupied.len() as f64;
        assert!((stats.objects_per_leaf.mean() - mean).abs() < 1e-9);
        assert!(
            occupied
                .iter()
                .all(|cell| cell.parts > 0 && cell.objects > Some(0))
        );
        let volume: f64 = cells
            .iter()
            .map(|c| c.bounds.size().to_array().iter().product::<f64>())
            .sum();
        let share = volume / root.size().to_array().iter().product::<f64>();
        if method == "octree:lvsi" {
            assert!(share < 0.9);
        } else {
            assert_eq!(cells.len() as u64, figures.occupied + figures.empty);
            assert!((share - 1.0).abs() < 1e-9, "{method} {share}");
        }
        let mut points = 0;
        for (query, hit) in rays().iter().zip(closest(&world)) {
            if !hit.is_miss() {
                points += 1;
                let point = query.ray.at(hit.t);
                let holds = |cell: &WorldCell| cell.bounds.inflated(1e-9).contains(point);
                assert!(occupied.iter().any(|cell| holds(cell)), "{method} {point}");
            }
        }
        assert!(points > 200);
        let memory = stats.memory;
        assert_eq!(memory.cells, figures.node_bytes);
        assert!(memory.total() > memory.cells && memory.building >= figures.bytes);
    }
    for method in ["brute", "boxes", "spheres"] {
        let world = prepare(method, Criteria::default(), LvsiTable::default());
        assert_eq!(world.root(CellsOf::Solids), None);
        assert!(cells(&world).is_empty() && world.stats().cells.is_none());
    }
}

/// A hilly sheet of triangles.
fn sheet(method: &str, criteria: Criteria) -> World {
    let n = 24;
    let at = |i: u32| {
        let (x, y) = (f64::from(i % (n + 1)) / 4.0, f64::from(i / (n + 1)) / 4.0);
        DVec3::new(1000.0 + x, y - 500.0, 30.0 + libm::sin(x) * libm::cos(y))
    };
    let corners = |i: u32| {
        let low = i / n * (n + 1) + i % n;
        [
            [low, low + 1, low + n + 1],
            [low + 1, low + n + 2, low + n + 1],
        ]
    };
    let positions = (0..(n + 1) * (n + 1)).map(at).collect();
    let mesh = TriangleMesh::new(positions, (0..n * n).flat_map(corners).collect());
    let mut builder = SceneBuilder::new();
    let grey = builder.add_material(Material::default());
    let mesh = Sheet::mesh(Arc::new(mesh.expect("valid")));
    builder.add_object(Object::sheet("hills", mesh, grey));
    let config = WorldConfig {
        method: method.parse().expect("a method"),
        criteria,
        ..WorldConfig::default()
    };
    World::prepare(Arc::new(builder.build().expect("valid")), &config).expect("a world")
}

#[test]
fn the_share_bites_for_triangles_too() {
    let expected = closest(&sheet("brute", OFF));
    assert!(expected.iter().filter(|hit| !hit.is_miss()).count() > 50);
    let leaves = [0.0, 0.1, 0.5, 1.0].map(|max_share| {
        let world = sheet("octree", Criteria { max_share, ..OFF });
        assert_eq!(closest(&world), expected, "{max_share}");
        let mut leaves = 0;
        world.visit_cells(CellsOf::Triangles, |_| leaves += 1);
        leaves
    });
    // At 0 whatever has a triangle that is not parallel to a face stays whole: the root.
    assert!(leaves[0] == 1 && leaves.is_sorted(), "{leaves:?}");
    assert!(
        leaves[0] < leaves[1] && leaves[1] < leaves[2] && leaves[2] < leaves[3],
        "{leaves:?}"
    );
}
