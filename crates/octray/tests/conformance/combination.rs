//! What is combined: methods, criteria, sizes; the full product of them, and a selection that has
//! every pair.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::LazyLock;

use octray::world::{Criteria, Encoding, LvsiTable, Method, TableSize, WorldConfig};

/// When cells are divided: names of presets that take structures to different ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Preset {
    /// As it is for users.
    Usual,
    /// Far more cells than pay.
    Fine,
    /// Four divisions at most.
    Shallow,
    /// Memory for a few cells only.
    Cramped,
    /// As few objects in a cell as its depth allows: the paper's.
    Counted,
    /// Until half of a cell is occupied.
    Share,
}

const PRESETS: [Preset; 6] = [
    Preset::Usual,
    Preset::Fine,
    Preset::Shallow,
    Preset::Cramped,
    Preset::Counted,
    Preset::Share,
];

/// Sizes of hash tables: a prime, a power of two, and one with long chains.
const TABLES: [(&str, LvsiTable); 3] = [
    (
        "prime",
        LvsiTable {
            size: TableSize::Prime,
            load: 0.75,
        },
    ),
    (
        "power",
        LvsiTable {
            size: TableSize::PowerOfTwo,
            load: 0.75,
        },
    ),
    (
        "crowded",
        LvsiTable {
            size: TableSize::Prime,
            load: 32.0,
        },
    ),
];

impl Preset {
    fn criteria(self) -> Criteria {
        let usual = Criteria::default();
        match self {
            Self::Usual => usual,
            Self::Fine => Criteria {
                visit_cost: 0.1,
                max_depth: 9,
                ..usual
            },
            Self::Shallow => Criteria {
                visit_cost: 0.1,
                max_depth: 4,
                ..usual
            },
            Self::Cramped => Criteria {
                visit_cost: 0.1,
                memory_limit: 256 << 10,
                ..usual
            },
            Self::Counted => Criteria {
                by_cost: false,
                max_parts: 4,
                max_depth: 6,
                memory_limit: 16 << 20,
                ..usual
            },
            Self::Share => Criteria {
                max_share: 0.5,
                visit_cost: 1.0,
                max_depth: 8,
                ..usual
            },
        }
    }
}

/// One way of making a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Combination {
    pub(crate) method: Method,
    preset: Preset,
    /// Its place in [`TABLES`].
    table: usize,
}

impl Combination {
    pub(crate) const BRUTE: Self = Self {
        method: Method::Brute,
        preset: Preset::Usual,
        table: 0,
    };

    pub(crate) fn config(&self) -> WorldConfig {
        WorldConfig {
            method: self.method,
            criteria: self.preset.criteria(),
            table: TABLES[self.table].1,
            ..WorldConfig::default()
        }
    }

    /// Its factors with their levels. The method's name has them, one after the other.
    fn levels(&self) -> Vec<(&'static str, String)> {
        let name = self.method.to_string();
        let words: Vec<&str> = name.split(':').collect();
        let factors: &[&str] = match words[0] {
            "octree" => &["structure", "encoding", "traversal", "membership"],
            "grid" => &["structure", "resolution"],
            _ => &["structure"],
        };
        let level = |(factor, word): (&&'static str, &&str)| (*factor, (*word).to_owned());
        let mut levels: Vec<_> = factors.iter().zip(&words).map(level).collect();
        if self.method == Method::Grid(None) {
            levels.push(("resolution", "automatic".to_owned()));
        }
        if self.method.division().is_some() {
            levels.push(("criteria", format!("{:?}", self.preset)));
        }
        if has_table(self.method) {
            levels.push(("table", TABLES[self.table].0.to_owned()));
        }
        levels
    }

    /// Every two of its levels, and each alone.
    fn pairs(&self) -> BTreeSet<[(&'static str, String); 2]> {
        let levels = self.levels();
        let with = |a: &(&'static str, String)| {
            let a = a.clone();
            levels.iter().map(move |b| {
                let mut pair = [a.clone(), b.clone()];
                pair.sort();
                pair
            })
        };
        levels.iter().flat_map(with).collect()
    }
}

impl fmt::Display for Combination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.method)?;
        if self.preset != Preset::Usual {
            write!(f, " ({:?})", self.preset)?;
        }
        if self.table != 0 {
            write!(f, " ({} table)", TABLES[self.table].0)?;
        }
        Ok(())
    }
}

const fn has_table(method: Method) -> bool {
    matches!(
        method,
        Method::Octree {
            encoding: Encoding::Lvsi(_),
            ..
        }
    )
}

/// Every method but brute force, and grids of given sizes.
fn methods() -> impl Iterator<Item = Method> {
    let grids = [1, 7, 32].map(|n| Method::Grid(Some(n)));
    let all = Method::all().into_iter().chain(grids);
    all.filter(|method| *method != Method::Brute)
}

/// Every method as users have it.
pub(crate) fn usual() -> Vec<Combination> {
    let combination = |method| Combination {
        method,
        preset: Preset::Usual,
        table: 0,
    };
    methods().map(combination).collect()
}

/// Everything that can be combined.
pub(crate) fn product() -> Vec<Combination> {
    let with_presets = |method: Method| {
        // The others have nothing to divide.
        let presets = if method.division().is_some() {
            &PRESETS[..]
        } else {
            &PRESETS[..1]
        };
        let tables = if has_table(method) { TABLES.len() } else { 1 };
        presets.iter().flat_map(move |&preset| {
            (0..tables).map(move |table| Combination {
                method,
                preset,
                table,
            })
        })
    };
    methods().flat_map(with_presets).collect()
}

/// Few combinations in which every pair of levels occurs that occurs in any: greedily the one with
/// most pairs that are new.
pub(crate) fn pairwise() -> &'static [Combination] {
    // Choosing takes a second, and every scene asks.
    static CHOSEN: LazyLock<Vec<Combination>> = LazyLock::new(choose_pairwise);
    &CHOSEN
}

fn choose_pairwise() -> Vec<Combination> {
    let all: Vec<_> = product().into_iter().map(|c| (c.pairs(), c)).collect();
    let mut covered = BTreeSet::new();
    let mut chosen = Vec::new();
    loop {
        let gain = |pairs: &BTreeSet<_>| pairs.difference(&covered).count();
        // The first of the best.
        let best = all.iter().rev().max_by_key(|(pairs, _)| gain(pairs));
        match best {
            Some((pairs, combination)) if gain(pairs) > 0 => {
                covered.extend(pairs.iter().cloned());
                chosen.push(*combination);
            }
            _ => return chosen,
        }
    }
}

#[test]
fn the_product_has_every_method_and_no_two_alike() {
    let product = product();
    for method in Method::all() {
        let is_there = product.iter().any(|c| c.method == method);
        assert_eq!(is_there, method != Method::Brute, "{method}");
    }
    let names: BTreeSet<String> = product.iter().map(ToString::to_string).collect();
    assert_eq!(names.len(), product.len());
    assert!(usual().iter().all(|c| product.contains(c)));
}

#[test]
fn every_pair_that_can_occur_is_in_the_selection() {
    let (product, chosen) = (product(), pairwise());
    let has = |a: &(&str, String), b: &(&str, String)| {
        chosen.iter().any(|c| {
            let levels = c.levels();
            levels.contains(a) && levels.contains(b)
        })
    };
    let mut pairs = 0;
    for combination in &product {
        let levels = combination.levels();
        for (i, a) in levels.iter().enumerate() {
            for b in &levels[i..] {
                assert!(has(a, b), "{a:?} with {b:?}");
                pairs += 1;
            }
        }
    }
    assert!(pairs > 4 * product.len());
    // Far fewer than all, not fewer than the two largest factors need.
    assert!(chosen.len() >= 5 * PRESETS.len());
    assert!(2 * chosen.len() < product.len(), "{}", chosen.len());
    assert!(chosen.iter().all(|c| product.contains(c)));
}
