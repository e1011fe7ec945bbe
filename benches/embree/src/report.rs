//! Tables and JSON.

use serde_json::{Value, json};

use crate::entry::Build;
use crate::measure::Score;
use crate::rays::Kind;

/// What was measured with one kind of rays.
#[derive(Clone, Debug)]
pub struct Traced {
    pub kind: Kind,
    pub rays: usize,
    /// In the order of the contenders' names.
    pub scores: Vec<Score>,
}

/// What was measured on one mesh.
#[derive(Clone, Debug)]
pub struct Results {
    pub mesh: &'static str,
    pub triangles: usize,
    pub builds: Vec<Build>,
    pub names: Vec<String>,
    pub traced: Vec<Traced>,
}

/// Who is compared with whom: what it says, octray's contender, and which of Embree's count.
type Comparison = (&'static str, &'static str, fn(&str) -> bool);

fn is_single(name: &str) -> bool {
    name.starts_with("embree") && name.ends_with("/1")
}

fn is_packet(name: &str) -> bool {
    name.starts_with("embree") && !is_single(name)
}

const COMPARISONS: [Comparison; 4] = [
    ("slice / packets", "octray/slice", is_packet),
    ("slice / single", "octray/slice", is_single),
    ("one / single", "octray/one", is_single),
    ("tree / single", "octray/tree", is_single),
];

impl Results {
    /// How many times faster octray's contender was than the fastest of Embree's that count.
    fn ratio(&self, traced: &Traced, (_, ours, counts): &Comparison) -> Option<f64> {
        let seconds = |wanted: &dyn Fn(&str) -> bool| {
            let named = self.names.iter().zip(&traced.scores);
            let seconds = named
                .filter(|(name, _)| wanted(name))
                .map(|(_, s)| s.seconds);
            seconds.min_by(f64::total_cmp)
        };
        Some(seconds(counts)? / seconds(&|name| name == *ours)?)
    }

    /// The mesh's tables.
    pub fn print(&self) {
        println!("\n## {}: {} triangles\n", self.mesh, self.triangles);
        println!("| structure | build | memory | most while building |\n|---|--:|--:|--:|");
        for build in &self.builds {
            let megabytes = |bytes: u64| format!("{:.1} MB", bytes as f64 / 1e6);
            let per_triangle = build.bytes as f64 / self.triangles as f64;
            println!(
                "| {} | {:.1} ms | {} ({per_triangle:.0} B/triangle) | {} |",
                build.name,
                build.seconds * 1e3,
                megabytes(build.bytes),
                build.most.map_or_else(|| "-".to_owned(), megabytes),
            );
        }
        if self.traced.is_empty() {
            return;
        }
        print!("\n| contender |");
        for traced in &self.traced {
            print!(" {}, Mrays/s | other | moved |", traced.kind.name());
        }
        println!("\n|---|{}", "--:|--:|--:|".repeat(self.traced.len()));
        for (index, name) in self.names.iter().enumerate() {
            print!("| {name} |");
            for traced in &self.traced {
                let score = &traced.scores[index];
                let rate = traced.rays as f64 / score.seconds / 1e6;
                print!(" {rate:.2} | {} | {} |", score.other, score.moved);
            }
            println!();
        }
    }

    /// The same as JSON.
    pub fn json(&self) -> Value {
        let builds = self.builds.iter().map(|build| {
            json!({
                "structure": build.name, "seconds": build.seconds, "bytes": build.bytes,
                "most_bytes": build.most,
            })
        });
        let traced = self.traced.iter().flat_map(|traced| {
            self.names.iter().zip(&traced.scores).map(|(name, score)| {
                json!({
                    "kind": traced.kind.name(), "rays": traced.rays, "contender": name,
                    "seconds": score.seconds, "other": score.other, "moved": score.moved,
                })
            })
        });
        json!({
            "mesh": self.mesh, "triangles": self.triangles,
            "builds": builds.collect::<Vec<_>>(), "traced": traced.collect::<Vec<_>>(),
        })
    }
}

/// How many times faster octray is, mesh by mesh and as geometric means.
pub fn print_ratios(all: &[Results], kinds: &[Kind]) {
    println!("\n## How many times faster octray is than the best of Embree\n");
    print!("| rays | compared |");
    for results in all {
        print!(" {} |", results.mesh);
    }
    println!(
        " geometric mean |\n|---|---|{}--:|",
        "--:|".repeat(all.len())
    );
    for (place, kind) in kinds.iter().enumerate() {
        for comparison in &COMPARISONS {
            let ratios: Vec<Option<f64>> = all
                .iter()
                .map(|results| results.ratio(results.traced.get(place)?, comparison))
                .collect();
            print_row(kind.name(), comparison.0, &ratios);
        }
    }
    let build = |pick: fn(&Build) -> f64, quality: &'static str| {
        move |results: &Results| {
            let of = |wanted: &dyn Fn(&str) -> bool| {
                let builds = results.builds.iter().filter(|build| wanted(&build.name));
                builds.map(pick).min_by(f64::total_cmp)
            };
            let theirs = of(&|name| name.starts_with("embree") && name.ends_with(quality))?;
            Some(of(&|name| name == "octray/world")? / theirs)
        }
    };
    for (quality, compared) in [
        ("default", "octray's world / Embree's default"),
        ("high", "octray's world / Embree's high quality"),
    ] {
        for (what, pick) in [
            ("build time", (|b: &Build| b.seconds) as fn(&Build) -> f64),
            ("memory", |b: &Build| b.bytes as f64),
        ] {
            let ratios: Vec<_> = all.iter().map(build(pick, quality)).collect();
            print_row(what, compared, &ratios);
        }
    }
}

fn print_row(what: &str, compared: &str, ratios: &[Option<f64>]) {
    let known: Vec<f64> = ratios.iter().copied().flatten().collect();
    if known.is_empty() {
        return;
    }
    print!("| {what} | {compared} |");
    for ratio in ratios {
        print!(
            " {} |",
            ratio.map_or_else(|| "-".to_owned(), |r| format!("{r:.2}"))
        );
    }
    let mean = (known.iter().map(|r| r.ln()).sum::<f64>() / known.len() as f64).exp();
    println!(" {mean:.2} |");
}
