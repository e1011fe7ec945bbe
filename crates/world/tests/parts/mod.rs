//! Worlds of solids with priorities, divided as far as large ones are.

use std::sync::Arc;

use octray_geometry::Solid;
use octray_scene::{Material, Object, SceneBuilder};
use octray_world::{Criteria, Method, World, WorldConfig};

/// One object for every solid, with its priority.
pub(crate) fn world(solids: &[(Solid, i32)], method: Method) -> World {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    for (solid, priority) in solids {
        builder.add_object(Object {
            priority: *priority,
            ..Object::solid("part", solid.clone(), material)
        });
    }
    let criteria = match method {
        // Criteria ask for cells, which it need not choose.
        Method::Auto => Criteria::default(),
        _ => Criteria {
            max_depth: 7,
            visit_cost: 0.1,
            ..Criteria::default()
        },
    };
    let config = WorldConfig {
        method,
        criteria,
        ..WorldConfig::default()
    };
    World::prepare(Arc::new(builder.build().expect("valid")), &config).expect("no meshes")
}
