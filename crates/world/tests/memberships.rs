//! Octrees by every membership test over every kind of primitive, and their lists of cells.

use std::sync::Arc;

use octray_geometry::profile::Region;
use octray_geometry::{MeshRule, Polynomial, Sheet, Solid, TriangleMesh};
use octray_math::{DAffine3, DVec2, DVec3, Ray, hash_u64, unit_f64};
use octray_scene::{Material, Object, Scene, SceneBuilder};
use octray_world::{
    CellList, CellListError, Counters, Criteria, Hit, Membership, Method, RayQuery, World,
    WorldConfig, WorldError,
};

/// An octahedron.
fn mesh() -> Solid {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let positions = axes.into_iter().flat_map(|a| [a, -a]).collect();
    let mut triangles = Vec::new();
    for octant in 0..8_u32 {
        let [x, y, z] = [octant & 1, 2 + (octant >> 1 & 1), 4 + (octant >> 2 & 1)];
        let mirrored = octant.count_ones() % 2 == 1;
        triangles.push(if mirrored { [x, z, y] } else { [x, y, z] });
    }
    let mesh = TriangleMesh::new(positions, triangles).expect("valid");
    Solid::mesh(Arc::new(mesh), MeshRule::Strict).expect("closed")
}

/// One solid of every kind.
fn kinds() -> Vec<Solid> {
    let corners = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [-1.0, 1.0],
    ];
    let region = |aside: f64| {
        let corners = corners.map(|[x, y]| DVec2::new(x + aside, y));
        Region::polygon(&corners).expect("simple")
    };
    // x^4 + y^4 + z^4 - 1.
    let mut quartic = [0.0; 35];
    for (place, value) in [(0, 1.0), (20, 1.0), (30, 1.0), (34, -1.0)] {
        quartic[place] = value;
    }
    let cube: Vec<DVec3> = (0..8)
        .map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)))
        .collect();
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let faces = faces.map(|face| face.to_vec());
    let tilted = DVec3::new(0.2, -0.1, 1.0);
    [
        Solid::sphere(1.0),
        Solid::cuboid(-DVec3::ONE, DVec3::new(1.0, 0.5, 0.7)),
        Solid::cylinder(0.7, -1.0, 1.0),
        Solid::infinite_cylinder(0.2),
        Solid::cone(1.0, 0.3, -1.0, 1.0),
        Solid::torus(1.0, 0.3),
        Solid::quadric([1.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.1]),
        Polynomial::new(4, &quartic).and_then(Solid::polynomial),
        Solid::superellipsoid(0.4, 1.5),
        Solid::half_space(tilted, -1.5),
        Solid::polyhedron(&cube, &faces),
        Solid::prism(&region(0.0), -0.5, 0.5),
        Solid::lathe(&region(2.0)),
        Ok(mesh()),
    ]
    .map(|solid| solid.expect("valid"))
    .to_vec()
}

fn placed(solid: &Solid, index: u32) -> Solid {
    let at = DVec3::new(
        f64::from(index % 4),
        f64::from(index / 4),
        0.3 * f64::from(index % 3),
    );
    let turn = DAffine3::from_axis_angle(DVec3::new(0.3, 1.0, 0.2).normalize(), f64::from(index));
    let size = DVec3::new(1.0, 0.6, if index.is_multiple_of(2) { 0.8 } else { -0.8 });
    let place = DAffine3::from_translation(at * 1.7) * turn * DAffine3::from_scale(size);
    solid.transform(place).expect("invertible")
}

/// Every kind once by itself, once cut out of a block, once as a block around it; and a disc.
fn scene() -> Arc<Scene> {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    let around = Solid::cuboid(DVec3::splat(-0.8), DVec3::splat(0.8)).expect("valid");
    for (index, kind) in kinds().iter().enumerate() {
        let index = index as u32;
        let cut = Solid::difference([around.clone(), kind.clone()]);
        let nested = Solid::difference([kind.clone(), Solid::difference([cut.clone(), mesh()])]);
        let bounded = Solid::intersection([nested, around.clone()]);
        for (row, solid) in [kind, &cut, &bounded].into_iter().enumerate() {
            let place = DAffine3::from_translation(DVec3::Z * 3.0 * row as f64);
            let solid = placed(solid, index).transform(place).expect("invertible");
            builder.add_object(Object::solid("part", solid, material));
        }
    }
    let disc = Sheet::disc(DVec3::ONE, DVec3::new(0.1, 0.2, 1.0), 2.0, 0.5).expect("valid");
    builder.add_object(Object::sheet("disc", disc, material));
    Arc::new(builder.build().expect("valid"))
}

fn config(method: &str) -> WorldConfig {
    WorldConfig {
        method: method.parse().expect("a method"),
        criteria: Criteria {
            max_depth: 6,
            visit_cost: 0.5,
            ..Criteria::default()
        },
        ..WorldConfig::default()
    }
}

fn world(scene: &Arc<Scene>, method: &str) -> World {
    World::prepare(Arc::clone(scene), &config(method)).expect("valid")
}

/// What rays through the scene hit, and everything on the way of some.
fn hits(world: &World) -> (Vec<Hit>, Vec<Vec<Hit>>) {
    let number = |i: u64| unit_f64(hash_u64(i)) * 10.0 - 1.5;
    let point = |i: u64| DVec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2));
    let queries: Vec<RayQuery> = (0..1500)
        .map(|i| RayQuery::new(Ray::new(point(2 * i), point(2 * i + 1) - point(2 * i))))
        .collect();
    let (mut nearest, mut counters) = (Vec::new(), Counters::default());
    world.closest(&queries, &mut nearest, &mut counters);
    let all = |query: &RayQuery| {
        let mut hits = Vec::new();
        world.crossings(query, true, &mut hits, &mut Counters::default());
        hits
    };
    (nearest, queries.iter().step_by(5).map(all).collect())
}

#[test]
fn every_membership_test_gives_the_same_hits_on_every_kind_of_primitive() {
    let scene = scene();
    let expected = hits(&world(&scene, "brute"));
    assert!(expected.0.iter().filter(|hit| !hit.is_miss()).count() > 500);
    for method in Method::all() {
        // The traversals have their own suite.
        let name = method.to_string();
        if name.contains("beam") || name.contains("fujimoto") {
            continue;
        }
        assert!(hits(&world(&scene, &name)) == expected, "{name}");
    }
}

/// The same cells for all: everything is divided to one depth.
fn divided(scene: &Arc<Scene>, membership: &str) -> World {
    let mut config = config(&format!("octree:tree:ordered:{membership}"));
    config.criteria.max_depth = 4;
    config.criteria.by_cost = false;
    World::prepare(Arc::clone(scene), &config).expect("valid")
}

#[test]
fn closer_looks_mark_fewer_cells() {
    let scene = scene();
    let marks = |name: &str| {
        divided(&scene, name)
            .cell_list()
            .expect("an octree")
            .marks()
    };
    let (sphere, cuboid) = (marks("bounding-sphere"), marks("bounding-box"));
    let (cover, shells, analytic) = (marks("bounding-cover"), marks("shells"), marks("analytic"));
    assert!(
        shells < cover && cover < cuboid && cuboid < sphere,
        "{shells} {cover} {cuboid} {sphere}"
    );
    // Triangles are exact for polygons and know where boundaries end; surfaces are asked one by one, but each
    // as exactly as its bounds tell. Neither is always closer.
    assert!(
        10 * shells < 11 * analytic && 10 * analytic < 13 * shells,
        "{shells} {analytic}"
    );
}

#[test]
fn the_triangles_are_gone_after_the_build() {
    let scene = scene();
    for (name, is_shells) in [("shells", true), ("bounding-cover", false)] {
        let world = divided(&scene, name);
        let marking = world.stats().marking.expect("operands were marked");
        assert!(marking.marker.operands >= 10, "{marking:?}");
        assert!(
            marking.marker.pieces > 20 * marking.marker.operands,
            "{marking:?}"
        );
        assert!(
            marking.marker.piece_bytes > 48 * marking.marker.pieces,
            "{marking:?}"
        );
        assert_eq!(marking.pieces_left, 0);
        assert_eq!(
            marking.marks,
            world.cell_list().expect("an octree").marks() as u64
        );
        assert_eq!(marking.marker.chord_error > 0.0, is_shells);
        let steps = marking.marker.steps;
        for count in [
            steps.vertex,
            steps.face,
            steps.edge,
            steps.diagonal,
            steps.between,
        ] {
            assert_eq!(count > 0, is_shells, "{steps:?}");
        }
    }
    let flat = divided(&scene, "bounding-box")
        .stats()
        .marking
        .expect("marked");
    assert_eq!((flat.marker.pieces, flat.marker.piece_bytes), (0, 0));
    assert_eq!(divided(&scene, "analytic").stats().marking, None);
}

#[test]
fn pieces_become_larger_where_memory_is_short() {
    let scene = scene();
    let mut config = config("octree:tree:ordered:shells");
    let fine = World::prepare(Arc::clone(&scene), &config).expect("valid");
    config.criteria.memory_limit = 1 << 20;
    let coarse = World::prepare(Arc::clone(&scene), &config).expect("valid");
    let [fine, coarse] = [fine, coarse].map(|w| w.stats().marking.expect("marked").marker);
    assert!(
        coarse.pieces < fine.pieces && coarse.chord_error > fine.chord_error,
        "{fine:?} {coarse:?}"
    );
}

#[test]
fn a_list_of_cells_builds_the_same_octree_again() {
    let scene = scene();
    for encoding in ["tree:ordered", "tree:sung", "lvsi:sung", "lvsi-empty:sung"] {
        for membership in [
            "bounding-box",
            "bounding-sphere",
            "bounding-cover",
            "shells",
            "analytic",
        ] {
            let name = format!("octree:{encoding}:{membership}");
            let first = world(&scene, &name);
            let list = first.cell_list().expect("an octree");
            let text = list.to_string();
            let read = CellList::parse(&text).expect("as it was written");
            assert_eq!(read, list, "{name}");
            assert!(list.len() > 50 && list.marks() > list.len() && list.depth() > 3);
            let again = World::prepare_from_cells(Arc::clone(&scene), &config(&name), &read)
                .expect("the same scene");
            if membership != "analytic" {
                assert!(again.words().eq(first.words()), "{name}");
            }
            let second = again.cell_list().expect("an octree");
            let keys = |list: &CellList| list.cells().map(|(key, _)| key).collect::<Vec<_>>();
            assert_eq!(keys(&second), keys(&list), "{name}");
            assert!(hits(&again) == hits(&first), "{name}");
        }
    }
}

#[test]
fn a_list_that_is_wrong_is_refused_with_its_line() {
    let scene = scene();
    let text = world(&scene, "octree")
        .cell_list()
        .expect("an octree")
        .to_string();
    let operands = text.split(' ').nth(8).expect("a header").to_owned();
    let header = text.lines().next().expect("a header");
    let line_of = |cells: &str| match CellList::parse(&format!("{header}\n{cells}")) {
        Err(CellListError::Line { line, reason }) => (line, reason),
        other => panic!("{cells}: {other:?}"),
    };
    for (cells, line) in [
        ("1:(0,0,0) 0\n1:(0,0,0) 1", 3),
        ("1:(1,0,0) 0\n1:(0,0,0) 1", 3),
        ("2:(0,0,0) 0\n1:(0,0,0) 1", 3),
        ("1:(0,0,0) 0\n2:(1,1,1) 1", 3),
        ("0:(0,0,0) 0\n\n\n3:(0,0,0) 0", 5),
        ("1:(2,0,0) 0", 2),
        ("22:(0,0,0) 0", 2),
        ("99999999999:(0,0,0) 0", 2),
        ("1:(0,0) 0", 2),
        ("1:(0,0,0,0) 0", 2),
        ("1:(-1,0,0) 0", 2),
        ("1:(0,0,0 0", 2),
        ("one", 2),
        ("1:(0,0,0) x", 2),
        ("1:(0,0,0) 1 1", 2),
        ("1:(0,0,0) 2 1", 2),
        ("1:(0,0,0) -1", 2),
        (&format!("1:(0,0,0) {operands}"), 2),
    ] {
        let (at, reason) = line_of(cells);
        assert_eq!(at, line, "{cells}: {reason}");
    }
    for header in [
        "",
        "octray-cells",
        "octray-cells 2 root 0 0 0 1 operands 1 scene 0",
        "octray-cells 1 root 0 0 0 0 operands 1 scene 0",
        "octray-cells 1 root 0 0 nan 1 operands 1 scene 0",
        "octray-cells 1 root 1e300 0 0 1 operands 1 scene 0",
        "octray-cells 1 root 0 0 0 1 operands -1 scene 0",
        "octray-cells 1 root 0 0 0 1 operands 1 scene xyz",
        "octray-cells 1 root 0 0 0 1 operands 1 scene 0 more",
    ] {
        let error = CellList::parse(header).expect_err(header);
        assert!(
            matches!(error, CellListError::Line { line: 1, .. }),
            "{header}"
        );
    }

    let list = CellList::parse(&text).expect("as it was written");
    let refused = |scene: &Arc<Scene>, config: &WorldConfig| match World::prepare_from_cells(
        Arc::clone(scene),
        config,
        &list,
    ) {
        Err(WorldError::Cells(error)) => error,
        other => panic!("{other:?}"),
    };
    let other = SceneBuilder::new().build().expect("valid");
    assert_eq!(
        refused(&Arc::new(other), &config("octree")),
        CellListError::OtherScene
    );
    for method in ["brute", "grid", "boxes"] {
        let error = refused(&scene, &config(method));
        assert!(matches!(error, CellListError::Method(_)), "{method}");
    }
    let mut small = config("octree");
    small.criteria.memory_limit = 1000;
    assert_eq!(refused(&scene, &small), CellListError::Memory);
}

#[test]
fn methods_that_name_no_membership_test_are_analytic() {
    assert_eq!(Method::Auto.membership(), Membership::Analytic);
}
