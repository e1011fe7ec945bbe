//! Colours of vertices and faces.

use octray_math::DVec3;
use octray_scene::srgb_to_linear;

use super::header::{Element, Kind};
use super::rows::Row;
use super::table::columns;

/// Where a row has its colour.
#[derive(Clone, Copy)]
pub(super) struct ColorColumns {
    columns: [usize; 3],
    /// Integers up to this are sRGB-encoded; floats (`None`) are linear.
    most: Option<f64>,
}

/// The columns of an element's colour, if it has one.
pub(super) fn color_columns(element: &Element) -> Option<ColorColumns> {
    let columns = columns(
        element,
        [
            &["red", "diffuse_red", "r"],
            &["green", "diffuse_green", "g"],
            &["blue", "diffuse_blue", "b"],
        ],
    )?;
    let most = match element.properties[columns[0]].kind {
        Kind::One(scalar) if scalar.is_integer() => {
            Some(if scalar.size() == 1 { 255.0 } else { 65535.0 })
        }
        _ => None,
    };
    Some(ColorColumns { columns, most })
}

impl ColorColumns {
    /// The linear colour of a row.
    pub(super) fn color(&self, row: &Row) -> DVec3 {
        let part = |column: usize| {
            let value = row.number(column);
            let value = match self.most {
                Some(most) => srgb_to_linear((value / most).clamp(0.0, 1.0)),
                None => value.clamp(0.0, 1.0),
            };
            if value.is_finite() { value } else { 0.0 }
        };
        DVec3::from_array(self.columns.map(part))
    }
}
