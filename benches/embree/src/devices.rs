//! Where Embree may be: the system's libraries, and the wheel `embreex` of the peers' environment.

use std::path::{Path, PathBuf};

use crate::library::Embree;
use crate::options::Options;

/// Every Embree that can be loaded, named by its major version, and words about what cannot.
pub fn find(options: &Options) -> (Vec<(String, Embree)>, Vec<String>) {
    let mut found: Vec<(String, Embree)> = Vec::new();
    let mut words = Vec::new();
    for path in &options.libraries {
        match Embree::open(path, options.threads) {
            Ok(device) => add(&mut found, device),
            Err(error) => words.push(format!("{}: {error}", path.display())),
        }
    }
    for major in [3, 4] {
        if found.iter().any(|(_, device)| device.major() == major) {
            continue;
        }
        let candidates = candidates(major);
        let device = candidates
            .iter()
            .find_map(|path| Embree::open(path, options.threads).ok());
        match device {
            Some(device) => add(&mut found, device),
            None => words.push(format!(
                "Embree {major} is not installed here ({}), or name it by --library",
                if major == 3 {
                    "libembree-dev"
                } else {
                    "pip: embreex"
                }
            )),
        }
    }
    (found, words)
}

fn add(found: &mut Vec<(String, Embree)>, device: Embree) {
    let name = format!("embree{}", device.major());
    let same = found
        .iter()
        .filter(|(other, _)| other.starts_with(&name))
        .count();
    let name = if same == 0 {
        name
    } else {
        format!("{name}-{}", same + 1)
    };
    found.push((name, device));
}

/// Names to try, the system's first.
fn candidates(major: isize) -> Vec<PathBuf> {
    let name = libloading::library_filename(format!("embree{major}"));
    let numbered = format!("{}.{major}", name.to_string_lossy());
    let mut all = vec![PathBuf::from(numbered), PathBuf::from(&name)];
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.venv-peers/lib");
    let folders = |path: &Path| {
        let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        paths.sort();
        paths
    };
    let begin = format!("libembree{major}");
    for python in folders(&root) {
        let files = folders(&python.join("site-packages/embreex.libs"));
        all.extend(files.into_iter().filter(|path| {
            let name = path.file_name().unwrap_or_default();
            name.to_string_lossy().starts_with(&begin)
        }));
    }
    all
}
