//! The definitions of the primitives once more, without any rounding.
//!
//! Every `f64` is a whole number times a power of two, and the definitions need only sums and
//! products once roots and divisions are multiplied out; frames are inverted by their adjugate.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

use num_bigint::{BigInt, Sign};
use octray_geometry::Primitive;
use octray_math::{DAffine3, DVec3, Ray};

use super::implicit;

/// `mantissa * 2^exponent`.
#[derive(Clone, Debug)]
pub(crate) struct Dyadic {
    mantissa: BigInt,
    exponent: i64,
}

impl Dyadic {
    /// Exactly `value`, which must be finite.
    pub(crate) fn of(value: f64) -> Self {
        assert!(value.is_finite());
        let bits = value.to_bits();
        let biased = ((bits >> 52) & 0x7ff) as i64;
        let fraction = (bits & ((1 << 52) - 1)) as i64;
        let (size, exponent) = match biased {
            0 => (fraction, -1074),
            _ => (fraction | 1 << 52, biased - 1075),
        };
        let mantissa = BigInt::from(if value < 0.0 { -size } else { size });
        Self { mantissa, exponent }
    }

    fn aligned(&self, exponent: i64) -> BigInt {
        &self.mantissa << (self.exponent - exponent)
    }

    fn sign(&self) -> Ordering {
        match self.mantissa.sign() {
            Sign::Minus => Ordering::Less,
            Sign::NoSign => Ordering::Equal,
            Sign::Plus => Ordering::Greater,
        }
    }

    fn compare(&self, other: &Self) -> Ordering {
        (self - other).sign()
    }

    fn squared(&self) -> Self {
        self * self
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;

    fn add(self, other: Self) -> Dyadic {
        let exponent = self.exponent.min(other.exponent);
        let mantissa = self.aligned(exponent) + other.aligned(exponent);
        Dyadic { mantissa, exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;

    fn sub(self, other: Self) -> Dyadic {
        let exponent = self.exponent.min(other.exponent);
        let mantissa = self.aligned(exponent) - other.aligned(exponent);
        Dyadic { mantissa, exponent }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;

    fn mul(self, other: Self) -> Dyadic {
        Dyadic {
            mantissa: &self.mantissa * &other.mantissa,
            exponent: self.exponent + other.exponent,
        }
    }
}

type Vector = [Dyadic; 3];

fn vector(v: DVec3) -> Vector {
    v.to_array().map(Dyadic::of)
}

fn dot(a: &Vector, b: &Vector) -> Dyadic {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

fn plus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] + &b[i])
}

fn times(a: &Vector, factor: &Dyadic) -> Vector {
    std::array::from_fn(|i| &a[i] * factor)
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &(&a[j] * &b[k]) - &(&a[k] * &b[j])
    })
}

/// The point of a ray at a parameter.
pub(crate) fn point_at(ray: &Ray, t: f64) -> [Dyadic; 3] {
    let way = times(&vector(ray.direction), &Dyadic::of(t));
    plus(&vector(ray.origin), &way)
}

/// A frame: columns and origin.
#[derive(Clone, Debug)]
pub(crate) struct ExactFrame {
    columns: [Vector; 3],
    origin: Vector,
}

impl ExactFrame {
    /// The product of the transforms, outermost first.
    pub(crate) fn product(chain: &[DAffine3]) -> Self {
        let mut frame = Self::of(&DAffine3::IDENTITY);
        for transform in chain {
            let inner = Self::of(transform);
            frame = Self {
                columns: std::array::from_fn(|i| frame.turned(&inner.columns[i])),
                origin: plus(&frame.turned(&inner.origin), &frame.origin),
            };
        }
        frame
    }

    fn of(transform: &DAffine3) -> Self {
        let m = transform.matrix3;
        Self {
            columns: [m.x_axis, m.y_axis, m.z_axis].map(vector),
            origin: vector(transform.translation),
        }
    }

    fn turned(&self, v: &Vector) -> Vector {
        let [x, y, z] = &self.columns;
        plus(&plus(&times(x, &v[0]), &times(y, &v[1])), &times(z, &v[2]))
    }

    /// Where a point is inside the frame, times the positive number that is returned with it.
    fn local(&self, point: &Vector) -> (Vector, Dyadic) {
        let [x, y, z] = &self.columns;
        let rows = [cross(y, z), cross(z, x), cross(x, y)];
        let determinant = dot(x, &rows[0]);
        let away: Vector = std::array::from_fn(|i| &point[i] - &self.origin[i]);
        let flip = Dyadic::of(if determinant.sign() == Ordering::Less {
            -1.0
        } else {
            1.0
        });
        let local = times(&rows.map(|row| dot(&row, &away)), &flip);
        (local, &determinant * &flip)
    }
}

/// On which side of a primitive's boundary a point is: less is inside.
///
/// # Panics
/// For a primitive whose definition is not written down here (meshes).
pub(crate) fn side(primitive: &Primitive, frame: &ExactFrame, point: &[Dyadic; 3]) -> Ordering {
    let (q, w) = frame.local(point);
    let [x, y, z] = &q;
    let scaled = |value: f64| &w * &Dyadic::of(value);
    let rho_squared = || &x.squared() + &y.squared();
    let slab = |value: &Dyadic, low: f64, high: f64| {
        let above = |end: f64| end.is_finite().then(|| value.compare(&scaled(end)));
        let low = above(low).map_or(Ordering::Less, Ordering::reverse);
        low.max(above(high).unwrap_or(Ordering::Less))
    };
    let plane = |normal: DVec3, offset: f64| dot(&vector(normal), &q).compare(&scaled(offset));
    match primitive {
        Primitive::Sphere { radius } => {
            let distance = &rho_squared() + &z.squared();
            distance.compare(&scaled(*radius).squared())
        }
        Primitive::Box { min, max } => (0..3)
            .map(|axis| slab(&q[axis], min[axis], max[axis]))
            .max()
            .expect("three axes"),
        Primitive::Cylinder { radius, z: ends } => {
            let mantle = rho_squared().compare(&scaled(*radius).squared());
            mantle.max(slab(z, ends[0], ends[1]))
        }
        Primitive::Cone {
            radius: [r0, r1],
            z: [z0, z1],
        } => {
            let height = &Dyadic::of(*z1) - &Dyadic::of(*z0);
            let growth = &Dyadic::of(*r1) - &Dyadic::of(*r0);
            // The radius at z, times w and the height; not negative between the caps.
            let radius = &(&scaled(*r0) * &height) + &(&growth * &(z - &scaled(*z0)));
            let mantle = (&rho_squared() * &height.squared()).compare(&radius.squared());
            mantle.max(slab(z, *z0, *z1))
        }
        Primitive::Torus { major, minor } => {
            // (rho - R)^2 + z^2 < r^2, that is, a < 2 R rho.
            let (major, minor) = (scaled(*major), scaled(*minor));
            let rho_squared = rho_squared();
            let a = &(&rho_squared + &z.squared()) + &(&major.squared() - &minor.squared());
            let right = &(&major.squared() * &rho_squared) * &Dyadic::of(4.0);
            match a.sign() {
                Ordering::Less => Ordering::Less,
                _ => a.squared().compare(&right),
            }
        }
        Primitive::HalfSpace { normal, offset } => plane(*normal, *offset),
        Primitive::Convex(polyhedron) => polyhedron
            .planes
            .iter()
            .map(|(normal, offset)| plane(*normal, *offset))
            .max()
            .expect("a polyhedron has faces"),
        // Its powers are no numbers of this kind.
        Primitive::Superellipsoid { .. } => Ordering::Equal,
        other => match implicit::terms(other) {
            Some(terms) => polynomial(&terms, &q, &w),
            None => panic!("no definition of {other:?}"),
        },
    }
}

/// The sign of a polynomial at `q / w`.
fn polynomial(terms: &[implicit::Term], q: &Vector, w: &Dyadic) -> Ordering {
    let degree = |powers: &[usize; 3]| powers.iter().sum::<usize>();
    let most = terms.iter().map(|(_, p)| degree(p)).max().unwrap_or(0);
    let power = |x: &Dyadic, n: usize| (0..n).fold(Dyadic::of(1.0), |product, _| &product * x);
    let mut sum = Dyadic::of(0.0);
    for (c, powers) in terms {
        let factors = (0..3).map(|axis| power(&q[axis], powers[axis]));
        let product = factors.fold(Dyadic::of(*c), |product, factor| &product * &factor);
        sum = &sum + &(&product * &power(w, most - degree(powers)));
    }
    sum.sign()
}
