//! Where the test files of others are.

use std::path::{Path, PathBuf};

/// The folder of test files, or `None` (said on the console) where there is none.
#[expect(clippy::print_stdout, reason = "a skipped test says so")]
pub(crate) fn corpus(folder: &str) -> Option<PathBuf> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("OCTRAY_CORPUS").map_or(default, PathBuf::from);
    let folder = root.join(folder);
    if !folder.is_dir() {
        println!("skipped: there is no {}", folder.display());
        return None;
    }
    Some(folder)
}
