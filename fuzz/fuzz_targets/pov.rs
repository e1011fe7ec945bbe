//! POV-Ray scenes: any bytes give a scene or messages, never a panic.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use octray_import::{InMemory, Options, pov};

fuzz_target!(|data: &[u8]| {
    let files = InMemory::default();
    let options = Options {
        // Loops are bounded by it too.
        memory_budget: 1 << 20,
        ..Options::default()
    };
    let imported = pov::import(Path::new("a.pov"), data.to_vec(), &files, &options);
    assert_eq!(imported.scene.is_none(), imported.diagnostics.has_errors());
    for diagnostic in imported.diagnostics.iter() {
        assert!(!imported.diagnostics.render(diagnostic).is_empty());
    }
});
