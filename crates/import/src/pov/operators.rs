//! Operators: how tightly they bind and what they give.

use super::value::Terms;

/// How tightly operators bind; an item of an object reads from `SUM` on, so that `<` after it
/// begins the next vector and compares nothing.
pub(super) const CONDITIONAL: u8 = 0;
pub(super) const SUM: u8 = 4;
pub(super) const PRODUCT: u8 = 5;

/// What counts as equal when numbers are compared, as in POV-Ray.
const TOLERANCE: f64 = 1e-10;

/// How tightly this operator binds.
pub(super) fn level(sign: &str) -> Option<u8> {
    Some(match sign {
        "?" => CONDITIONAL,
        "|" => 1,
        "&" => 2,
        "<" | ">" | "<=" | ">=" | "=" | "!=" => 3,
        "+" | "-" => SUM,
        "*" | "/" => PRODUCT,
        "^" => 6,
        _ => return None,
    })
}

pub(super) fn truth(value: bool) -> f64 {
    f64::from(u8::from(value))
}

/// The value of an operator.
pub(super) fn apply(sign: &str, a: Terms, b: Terms) -> Terms {
    match sign {
        "+" => a.zip(b, |x, y| x + y),
        "-" => a.zip(b, |x, y| x - y),
        "*" => a.zip(b, |x, y| x * y),
        "/" => a.zip(b, |x, y| x / y),
        "^" => a.zip(b, libm::pow),
        "=" => Terms::number(truth(
            a.zip(b, |x, y| truth((x - y).abs() > TOLERANCE)).v == [0.0; 5],
        )),
        "!=" => Terms::number(truth(
            a.zip(b, |x, y| truth((x - y).abs() > TOLERANCE)).v != [0.0; 5],
        )),
        _ => {
            let (x, y) = (a.v[0], b.v[0]);
            Terms::number(truth(match sign {
                "<" => x < y - TOLERANCE,
                ">" => x > y + TOLERANCE,
                "<=" => x <= y + TOLERANCE,
                ">=" => x >= y - TOLERANCE,
                "&" => x != 0.0 && y != 0.0,
                _ => x != 0.0 || y != 0.0,
            }))
        }
    }
}
