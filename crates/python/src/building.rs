//! How to build, from the keywords of `Scene.prepare`.

use octray::math::MAX_DEPTH;
use octray::world::{LvsiTable, Quality, TableSize, WorldConfig};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::system::available_memory;
use crate::world::method_called;

/// What may be said about building; `None` leaves a default.
#[derive(Debug, Default)]
pub(crate) struct Building<'a, 'py> {
    pub(crate) quality: Option<&'a str>,
    pub(crate) objects: Option<u32>,
    pub(crate) depth: Option<u32>,
    /// A number or `"off"`.
    pub(crate) cost: Option<&'a Bound<'py, PyAny>>,
    pub(crate) share: Option<f64>,
    pub(crate) memory: Option<u64>,
    pub(crate) table: Option<&'a str>,
    pub(crate) load: Option<f64>,
}

/// The configuration for a method where nothing else is said: no structure takes more memory than
/// there is.
pub(crate) fn usual(accel: &str) -> PyResult<WorldConfig> {
    let mut config = WorldConfig {
        method: method_called(accel)?,
        ..WorldConfig::default()
    };
    if let Some(bytes) = available_memory() {
        let (cells, triangles) = (&mut config.criteria, &mut config.triangles);
        cells.memory_limit = cells.memory_limit.min(bytes);
        triangles.memory_limit = triangles.memory_limit.min(bytes);
    }
    Ok(config)
}

fn refused<T>(text: String) -> PyResult<T> {
    Err(PyValueError::new_err(text))
}

impl Building<'_, '_> {
    /// The configuration for a method.
    pub(crate) fn config(&self, accel: &str) -> PyResult<WorldConfig> {
        let mut config = usual(accel)?;
        if let Some(quality) = self.quality {
            config.triangles.quality = match quality {
                "fast" => Quality::Fast,
                "full" => Quality::Full,
                other => {
                    return refused(format!(
                        "quality must be \"fast\" or \"full\", not {other:?}"
                    ));
                }
            };
        }
        let criteria = &mut config.criteria;
        if let Some(objects) = self.objects {
            criteria.max_parts = objects;
        }
        if let Some(depth) = self.depth {
            if depth > MAX_DEPTH {
                return refused(format!(
                    "tree_depth must be at most {MAX_DEPTH}, not {depth}"
                ));
            }
            criteria.max_depth = depth;
        }
        if let Some(cost) = self.cost.filter(|cost| !cost.is_none()) {
            match cost.extract::<f64>() {
                Ok(x) if x.is_finite() && x >= 0.0 => criteria.visit_cost = x,
                _ if cost.extract::<String>().is_ok_and(|text| text == "off") => {
                    criteria.by_cost = false;
                }
                _ => {
                    let text = cost.repr()?;
                    return refused(format!(
                        "tree_cost must be a number, 0 or more, or \"off\", not {text}"
                    ));
                }
            }
        }
        if let Some(share) = self.share {
            if !(0.0..=1.0).contains(&share) {
                return refused(format!("tree_share must be from 0 to 1, not {share}"));
            }
            criteria.max_share = share;
        }
        if let Some(bytes) = self.memory {
            criteria.memory_limit = bytes;
            config.triangles.memory_limit = bytes;
        }
        if let Some(table) = self.table {
            config.table.size = match table {
                "prime" => TableSize::Prime,
                "power-of-two" => TableSize::PowerOfTwo,
                other => {
                    return refused(format!(
                        "lvsi_table must be \"prime\" or \"power-of-two\", not {other:?}"
                    ));
                }
            };
        }
        if let Some(load) = self.load {
            let [low, high] = LvsiTable::LOADS;
            if !(low..=high).contains(&load) {
                return refused(format!(
                    "lvsi_load must be from {low} to {high}, not {load}"
                ));
            }
            config.table.load = load;
        }
        Ok(config)
    }
}
