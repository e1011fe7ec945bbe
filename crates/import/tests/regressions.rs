//! Every file that once broke a parser, in `regressions/`; none may do it again.

use std::path::Path;

use octray_import::{Disk, Options, load};

#[test]
fn none_of_them_panics_or_is_accepted_with_errors() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/regressions");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the folder") {
        let path = entry.expect("an entry").path();
        let options = Options {
            memory_budget: 4 << 20,
            ..Options::default()
        };
        let imported = load(&path, &Disk, &options);
        let name = path.display();
        assert_eq!(
            imported.scene.is_none(),
            imported.diagnostics.has_errors(),
            "{name}"
        );
        for diagnostic in imported.diagnostics.iter() {
            assert!(
                !imported.diagnostics.render(diagnostic).is_empty(),
                "{name}"
            );
        }
        count += 1;
    }
    assert!(count > 0, "the folder is empty");
}
