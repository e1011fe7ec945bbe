//! `translate`, `rotate`, `scale`, `matrix` and `transform`.

use octray_math::{DAffine3, DMat3, DVec3, transform};

use super::reader::{Parsed, Reader};
use super::value::Value;

impl Reader<'_> {
    /// A transform, if the next word is one; it is taken.
    pub(super) fn transform_item(&mut self) -> Parsed<Option<DAffine3>> {
        let Some(word) = self.peek_word() else {
            return Ok(None);
        };
        let token = self.peek();
        let map = match &*word {
            "translate" => {
                self.next();
                DAffine3::from_translation(self.vector()?)
            }
            "rotate" => {
                self.next();
                transform::rotation_xyz_degrees(self.vector()?)
            }
            "scale" => {
                self.next();
                let mut factors = self.vector()?;
                for axis in 0..3 {
                    if factors[axis] == 0.0 {
                        self.warn(token.span.to(self.last), "a scale of 0 is taken as 1");
                        factors[axis] = 1.0;
                    }
                }
                DAffine3::from_scale(factors)
            }
            "matrix" => {
                self.next();
                self.matrix()?
            }
            "transform" => {
                self.next();
                if self.at("{") {
                    self.transform_block()?
                } else {
                    self.named_transform()?
                }
            }
            _ => return Ok(None),
        };
        if !transform::is_invertible(&map) {
            let message = "this transform flattens space or is not finite";
            return self.fail(token.span.to(self.last), message);
        }
        Ok(Some(map))
    }

    fn named_transform(&mut self) -> Parsed<DAffine3> {
        let token = self.peek();
        match self.reference()? {
            Value::Transform(map) => Ok(map),
            Value::Unknown => Ok(DAffine3::IDENTITY),
            other => {
                let what = other.describe();
                let found = token.describe();
                self.fail(
                    token.span,
                    format!("expected a transform, but {found} is {what}"),
                )
            }
        }
    }

    /// Twelve numbers, the images of the axes one after the other, then of the origin.
    fn matrix(&mut self) -> Parsed<DAffine3> {
        self.expect("<")?;
        let mut m = [0.0; 12];
        for value in &mut m {
            *value = self.float()?;
            self.comma();
        }
        self.expect(">")?;
        Ok(DAffine3 {
            matrix3: DMat3::from_cols(
                DVec3::new(m[0], m[1], m[2]),
                DVec3::new(m[3], m[4], m[5]),
                DVec3::new(m[6], m[7], m[8]),
            ),
            translation: DVec3::new(m[9], m[10], m[11]),
        })
    }

    /// `{ ... }` behind `transform`.
    pub(super) fn transform_block(&mut self) -> Parsed<DAffine3> {
        let mut all = DAffine3::IDENTITY;
        let mut inverse = false;
        self.block("transform", |r| {
            if r.eat_word("inverse") {
                inverse = true;
            } else if let Some(map) = r.transform_item()? {
                all = map * all;
            } else {
                let known = r
                    .peek_word()
                    .is_some_and(|word| matches!(r.scopes.get(&word), Some(Value::Transform(_))));
                if !known && !r.partial_includes {
                    return r.unexpected("a transform");
                }
                all = r.named_transform()? * all;
            }
            Ok(())
        })?;
        if !transform::is_invertible(&all) {
            return self.fail(self.last, "this transform flattens space or is not finite");
        }
        Ok(if inverse { all.inverse() } else { all })
    }
}
