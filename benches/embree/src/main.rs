//! octray's triangles against Embree's, chunk by chunk in one process: see `--help`.

mod contender;
mod devices;
mod entry;
mod library;
mod measure;
mod meshes;
mod options;
mod ply;
mod rays;
mod report;

use std::process::ExitCode;

use entry::Structures;
use meshes::Subject;
use options::Options;
use rays::{Kind, Rays};
use report::{Results, Traced};
use serde_json::json;

fn main() -> ExitCode {
    let options = match options::read(std::env::args().skip(1)) {
        Ok(options) => options,
        Err((message, false)) => {
            print!("{message}");
            return ExitCode::SUCCESS;
        }
        Err((message, true)) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    // This thread is one of those that build.
    let builder = rayon::ThreadPoolBuilder::new().num_threads(options.threads);
    let pool = builder.use_current_thread().build();
    let _pool = pool.map_err(|error| error.to_string())?;
    let (devices, words) = devices::find(options);
    for (name, device) in &devices {
        println!("{name}: Embree {}", device.version());
    }
    for absent in words {
        println!("{absent}");
    }
    let mut all = Vec::new();
    for name in &options.meshes {
        let subject = match meshes::make(name) {
            Ok(subject) => subject,
            Err(why) => {
                println!("\n## {name}: {why}");
                continue;
            }
        };
        if let Some(folder) = &options.ply {
            ply::write(folder, &subject).map_err(|e| format!("{}: {e}", folder.display()))?;
            continue;
        }
        let results = measured(&subject, &devices, options)?;
        results.print();
        all.push(results);
    }
    if !(all.is_empty() || devices.is_empty()) {
        report::print_ratios(&all, &options.kinds);
    }
    if let Some(path) = &options.json {
        let versions = devices
            .iter()
            .map(|(name, device)| json!([name, device.version()]));
        let figures = json!({
            "embree": versions.collect::<Vec<_>>(),
            "repetitions": options.repetitions, "threads": options.threads,
            "meshes": all.iter().map(Results::json).collect::<Vec<_>>(),
        });
        std::fs::write(path, format!("{figures:#}\n"))
            .map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}

fn measured(
    subject: &Subject,
    devices: &[(String, library::Embree)],
    options: &Options,
) -> Result<Results, String> {
    let structures = Structures::build(subject, devices, options)?;
    let (names, mut contenders): (Vec<_>, Vec<_>) =
        structures.contenders(options).into_iter().unzip();
    let primary = Rays::primary(subject, &structures.world, options.size);
    let mut traced = Vec::new();
    for &kind in &options.kinds {
        let spawned;
        let rays = if kind == Kind::Primary {
            &primary
        } else {
            spawned = primary.spawn(kind, subject, &structures.world);
            &spawned
        };
        traced.push(Traced {
            kind,
            rays: rays.len(),
            scores: measure::measure(rays, &mut contenders, options.repetitions),
        });
    }
    Ok(Results {
        mesh: subject.name,
        triangles: subject.triangles.len(),
        builds: structures.builds.clone(),
        names,
        traced,
    })
}
