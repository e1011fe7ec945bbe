//! OBJ meshes; the same bytes are also their material library `a.mtl`: any bytes give a scene or messages, never a panic.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use octray_import::{InMemory, Options, obj};

fuzz_target!(|data: &[u8]| {
    let mut files = InMemory::default();
    files.insert("a.mtl", data);
    let options = Options {
        memory_budget: 64 << 20,
        ..Options::default()
    };
    let imported = obj::import(Path::new("a.obj"), data.to_vec(), &files, &options);
    assert_eq!(imported.scene.is_none(), imported.diagnostics.has_errors());
    for diagnostic in imported.diagnostics.iter() {
        assert!(!imported.diagnostics.render(diagnostic).is_empty());
    }
});
