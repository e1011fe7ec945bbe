//! Where a primitive is: the product of the transforms above it, to about 100 bits.

use octray_math::{DAffine3, DMat3, DVec3};

use super::number::{Number, Twofold};

type Row<N> = [N; 3];

/// A chain of transforms, inverted, with what rounding in `f64` may do to it.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    local_from_world: [Row<Twofold>; 3],
    origin: Row<Twofold>,
    /// The product in `f64`, for hints.
    pub(crate) world_from_local: DAffine3,
    /// An upper bound of how much the inverse stretches.
    pub(crate) shrink: f64,
    /// An upper bound of the product of stretching and shrinking.
    pub(crate) condition: f64,
    /// The product of the sizes of the factors: their rounding errors are in units of this.
    pub(crate) stretch: f64,
    /// Likewise for the origin.
    pub(crate) reach: f64,
}

fn frobenius(m: &DMat3) -> f64 {
    let columns = [m.x_axis, m.y_axis, m.z_axis];
    columns
        .iter()
        .map(|c| c.length_squared())
        .sum::<f64>()
        .sqrt()
}

impl Frame {
    /// Of a chain of transforms, outermost first.
    pub(crate) fn new(chain: &[DAffine3]) -> Self {
        let of = |m: &DAffine3| -> [Row<Twofold>; 4] {
            let m3 = m.matrix3;
            [m3.x_axis, m3.y_axis, m3.z_axis, m.translation]
                .map(|column| column.to_array().map(Twofold::of))
        };
        let mut product = of(&DAffine3::IDENTITY);
        let (mut stretch, mut reach) = (1.0, 0.0);
        for transform in chain {
            let inner = of(transform);
            let mut columns = inner.map(|v| apply(&product, v));
            for (axis, entry) in columns[3].iter_mut().enumerate() {
                *entry = *entry + product[3][axis];
            }
            product = columns;
            reach += stretch * transform.translation.length();
            stretch *= frobenius(&transform.matrix3);
        }
        let [x, y, z, origin] = product;
        let rows = [cross(y, z), cross(z, x), cross(x, y)];
        let determinant = dot(x, rows[0]);
        let local_from_world = rows.map(|row| row.map(|entry| entry / determinant));
        let plain = |v: Row<Twofold>| DVec3::from_array(v.map(Number::rounded));
        let matrix = DMat3::from_cols(plain(x), plain(y), plain(z));
        let inverse = local_from_world.map(plain);
        let shrink = inverse
            .iter()
            .map(|r| r.length_squared())
            .sum::<f64>()
            .sqrt();
        Self {
            local_from_world,
            origin,
            world_from_local: DAffine3::from_mat3_translation(matrix, plain(origin)),
            shrink,
            condition: shrink * frobenius(&matrix),
            stretch,
            reach,
        }
    }

    /// A point of the world in this frame.
    pub(crate) fn local(&self, point: Row<Twofold>) -> Row<Twofold> {
        let away: Row<Twofold> = std::array::from_fn(|i| point[i] - self.origin[i]);
        self.local_vector(away)
    }

    /// The normal in the world of a plane in this frame; its length is heights in this frame per
    /// length in the world.
    pub(crate) fn world_normal(&self, normal: DVec3) -> DVec3 {
        let rows = self.local_from_world.map(|row| row.map(Number::rounded));
        let [x, y, z] = rows.map(DVec3::from_array);
        x * normal.x + y * normal.y + z * normal.z
    }

    /// A direction of the world in this frame.
    pub(crate) fn local_vector(&self, v: Row<Twofold>) -> Row<Twofold> {
        self.local_from_world.map(|row| dot(row, v))
    }
}

fn apply(columns: &[Row<Twofold>; 4], v: Row<Twofold>) -> Row<Twofold> {
    std::array::from_fn(|i| columns[0][i] * v[0] + columns[1][i] * v[1] + columns[2][i] * v[2])
}

fn dot(a: Row<Twofold>, b: Row<Twofold>) -> Twofold {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Row<Twofold>, b: Row<Twofold>) -> Row<Twofold> {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}
