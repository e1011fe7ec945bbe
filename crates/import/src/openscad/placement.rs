//! The argument of `multmatrix`.

use octray_math::{DAffine3, DMat3, DVec3};

use crate::Diagnostics;

use super::arguments::Arguments;
use super::syntax::{Statement, Value};

/// The affine map of a `multmatrix`; entries that are not given are those of the identity, and
/// the lowest right one divides all, as in OpenSCAD.
pub(super) fn matrix(statement: &Statement<'_>, diagnostics: &mut Diagnostics) -> DAffine3 {
    let arguments = Arguments::bind(statement, &["m"], &[], diagnostics);
    let mut m = [[0.0; 4]; 4];
    for (i, row) in m.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    let Some(argument) = arguments.get("m") else {
        diagnostics.warning(arguments.span(), "there is no matrix; nothing is moved");
        return DAffine3::IDENTITY;
    };
    let rows = match &argument.value {
        Value::Vector(rows) => rows.iter().map(Value::numbers).collect::<Option<Vec<_>>>(),
        _ => None,
    };
    let Some(rows) = rows.filter(|rows| rows.len() <= 4 && rows.iter().all(|r| r.len() <= 4))
    else {
        let message = "a matrix has up to 4 rows of up to 4 numbers; nothing is moved";
        diagnostics.warning(argument.span, message);
        return DAffine3::IDENTITY;
    };
    for (to, from) in m.iter_mut().zip(rows) {
        for (to, from) in to.iter_mut().zip(from) {
            *to = from;
        }
    }
    if m[3][..3] != [0.0; 3] {
        let message =
            "the last row of a matrix should be [0, 0, 0, 1]; its first three are ignored";
        diagnostics.warning(argument.span, message);
    }
    let column = |k: usize| DVec3::new(m[0][k], m[1][k], m[2][k]) / m[3][3];
    DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(1), column(2)), column(3))
}
