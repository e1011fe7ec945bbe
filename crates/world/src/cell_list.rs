//! Cells with the objects that they touch, as text: the output of the paper's preprocessing
//! (Martinka 1993, section 6), from which octree and hash table are built.
//!
//! ```text
//! octray-cells 1 root -1.5e0 -1.5e0 -1.5e0 3e0 operands 2 scene 9a3c51e07b2d4f68
//! 1:(0,0,0) 0
//! 1:(1,0,0) 0 1
//! ```
//!
//! The first line names the version, the root cube (lowest corner and edge, in the coordinates in
//! which the scene is worked on), how many operands (primitives of solids) the scene has, and a
//! fingerprint of them. Every other line is an occupied cell `L:(i,j,k)`, the Leveled Voxel Space
//! Index, with the numbers of the operands that it may touch, increasing; an operand that is not
//! named is constant in the cell. Cells stand in Morton order, the leaves of one octree. A cell
//! without operands is empty; it is there only where nothing else tells that its parent was divided.
//!
//! The operands of a cell are those of which a face is left in its expressions, whatever the
//! membership test: by the analytic one, too. It cannot be told from a list whether it names enough
//! operands; a list that names too few shows a picture with holes.

use std::fmt;

use octray_math::{Aabb, CellKey, DVec3, MAX_DEPTH};
use thiserror::Error;

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct CellList {
    pub(crate) scene: ListedScene,
    pub(crate) cells: Vec<ListedCell>,
    /// The operands of all cells one after another.
    pub(crate) operands: Vec<u32>,
}

/// What the cells are of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ListedScene {
    /// A cube.
    pub(crate) root: Aabb,
    pub(crate) operands: u32,
    pub(crate) fingerprint: u64,
}

/// A line of the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ListedCell {
    pub(crate) key: CellKey,
    /// Where its operands are.
    pub(crate) operands: [usize; 2],
}

/// Why a list of cells cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum CellListError {
    /// A line that does not say what it should.
    #[error("line {line} of the list of cells: {reason}")]
    Line {
        /// From 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// It was made from other solids.
    #[error("the list of cells is of another scene")]
    OtherScene,
    /// The method has no octree, or none that can hold these cells.
    #[error("the list of cells cannot be used: {0}")]
    Method(&'static str),
    /// What it says takes more memory than the criteria give.
    #[error("the cells of the list take more memory than the limit")]
    Memory,
}

/// The place of a cell's first smallest cell in Morton order, and of the one after its last.
pub(crate) fn morton(key: CellKey) -> [u64; 2] {
    let below = MAX_DEPTH - key.depth;
    let [i, j, k] = key.index.map(|x| spread(u64::from(x) << below));
    let first = i | j << 1 | k << 2;
    [first, first + (1 << (3 * below))]
}

/// The bits of a number of 21 bits, each third bit.
const fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

impl CellList {
    pub(crate) const fn new(scene: ListedScene) -> Self {
        Self {
            scene,
            cells: Vec::new(),
            operands: Vec::new(),
        }
    }

    pub(crate) fn push(&mut self, key: CellKey, operands: &[u32]) {
        let start = self.operands.len();
        self.operands.extend_from_slice(operands);
        let operands = [start, self.operands.len()];
        self.cells.push(ListedCell { key, operands });
    }

    pub(crate) fn operands_of(&self, cell: &ListedCell) -> &[u32] {
        &self.operands[cell.operands[0]..cell.operands[1]]
    }

    /// How many cells it names.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether it names none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// How many pairs of a cell and an operand that it touches there are.
    #[must_use]
    pub const fn marks(&self) -> usize {
        self.operands.len()
    }

    /// The deepest level.
    #[must_use]
    pub fn depth(&self) -> u32 {
        self.cells.iter().map(|c| c.key.depth).max().unwrap_or(0)
    }

    /// The cells with their operands, in Morton order.
    pub fn cells(&self) -> impl Iterator<Item = (CellKey, &[u32])> + '_ {
        (self.cells.iter()).map(|cell| (cell.key, self.operands_of(cell)))
    }

    /// Reads a list.
    ///
    /// # Errors
    /// A line that cannot be read, that names what is not there, or whose cell is out of order or
    /// overlaps the one before.
    pub fn parse(text: &str) -> Result<Self, CellListError> {
        let at = |index: usize| {
            move |reason: String| CellListError::Line {
                line: index + 1,
                reason,
            }
        };
        let mut lines = text.lines().enumerate();
        let (_, header) = lines.next().unwrap_or((0, ""));
        let mut list = Self::new(header_of(header).map_err(at(0))?);
        let mut end = 0;
        let mut operands = Vec::new();
        for (index, line) in lines {
            if line.trim().is_empty() {
                continue;
            }
            let key = list.read_cell(line, &mut operands).map_err(at(index))?;
            let [first, after] = morton(key);
            if first < end {
                let reason = "the cell overlaps the one before or comes out of Morton order";
                return Err(at(index)(reason.to_owned()));
            }
            end = after;
            list.push(key, &operands);
        }
        Ok(list)
    }

    /// The cell of a line; its operands to `operands`.
    fn read_cell(&self, line: &str, operands: &mut Vec<u32>) -> Result<CellKey, String> {
        let mut words = line.split_ascii_whitespace();
        let name = words.next().unwrap_or_default();
        let key =
            key_of(name).ok_or_else(|| format!("`{}` is no cell L:(i,j,k)", start_of(name)))?;
        operands.clear();
        for word in words {
            let operand: u32 = (word.parse())
                .map_err(|_| format!("`{}` is no number of an operand", start_of(word)))?;
            if operand >= self.scene.operands {
                return Err(format!("there is no operand {operand}"));
            }
            if operands.last().is_some_and(|last| *last >= operand) {
                return Err(format!(
                    "operand {operand} comes after a larger one or twice"
                ));
            }
            operands.push(operand);
        }
        Ok(key)
    }
}

/// As much of a word as fits into a message.
fn start_of(word: &str) -> String {
    word.chars().take(40).collect()
}

fn key_of(name: &str) -> Option<CellKey> {
    let (depth, rest) = name.split_once(":(")?;
    let mut numbers = rest.strip_suffix(')')?.split(',');
    let mut next = || number(numbers.next()?);
    let index = [next()?, next()?, next()?];
    let depth = number(depth)?;
    let fits = depth <= MAX_DEPTH && index.iter().all(|i| *i < 1 << depth);
    (fits && numbers.next().is_none()).then_some(CellKey { depth, index })
}

/// Digits alone.
fn number(word: &str) -> Option<u32> {
    let digits = word.bytes().all(|b| b.is_ascii_digit());
    if digits { word.parse().ok() } else { None }
}

fn header_of(line: &str) -> Result<ListedScene, String> {
    let words: Vec<&str> = line.split_ascii_whitespace().take(12).collect();
    let [
        "octray-cells",
        version,
        "root",
        x,
        y,
        z,
        size,
        "operands",
        operands,
        "scene",
        scene,
    ] = words[..]
    else {
        return Err("a list of cells begins with `octray-cells 1 root X Y Z SIZE operands N scene FINGERPRINT`".to_owned());
    };
    if version != "1" {
        return Err(format!(
            "version {} is not known, only 1 is",
            start_of(version)
        ));
    }
    let real = |word: &str| match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{}` is no finite number", start_of(word))),
    };
    let min = DVec3::new(real(x)?, real(y)?, real(z)?);
    let size = real(size)?;
    let max = min + size;
    if size <= 0.0 || !max.is_finite() || !min.cmplt(max).all() {
        return Err("the root cube has no size".to_owned());
    }
    let operands = number(operands).ok_or("the number of operands is none")?;
    let fingerprint =
        u64::from_str_radix(scene, 16).map_err(|_| "the fingerprint is no hexadecimal number")?;
    Ok(ListedScene {
        root: Aabb::new(min, max),
        operands,
        fingerprint,
    })
}

impl fmt::Display for CellList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ListedScene {
            root,
            operands,
            fingerprint,
        } = self.scene;
        let DVec3 { x, y, z } = root.min;
        let size = root.size().x;
        writeln!(
            f,
            "octray-cells 1 root {x:e} {y:e} {z:e} {size:e} operands {operands} scene {fingerprint:016x}"
        )?;
        for (key, operands) in self.cells() {
            let [i, j, k] = key.index;
            write!(f, "{}:({i},{j},{k})", key.depth)?;
            for operand in operands {
                write!(f, " {operand}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}
