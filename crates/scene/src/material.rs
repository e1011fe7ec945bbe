//! What surfaces look like: Whitted's model with the terms of POV-Ray's `finish` and of NFF.

use octray_math::{DAffine3, DVec3};

/// A colour that may let light through.
///
/// `filter` passes light tinted by `rgb`, `transmit` passes it unchanged; the surface's own
/// shading is weighted by `1 - filter - transmit`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Color {
    /// Red, green, blue; usually in `[0, 1]`, not clipped.
    pub rgb: DVec3,
    /// Share of light that passes tinted.
    pub filter: f64,
    /// Share of light that passes unchanged.
    pub transmit: f64,
}

impl Color {
    /// An opaque colour.
    #[must_use]
    pub const fn rgb(r: f64, g: f64, b: f64) -> Self {
        Self {
            rgb: DVec3::new(r, g, b),
            filter: 0.0,
            transmit: 0.0,
        }
    }

    /// What a ray that passes the surface is multiplied by.
    #[must_use]
    pub fn transmittance(&self) -> DVec3 {
        self.rgb * self.filter + self.transmit
    }

    /// The weight of the surface's own shading.
    #[must_use]
    pub const fn opacity(&self) -> f64 {
        (1.0 - self.filter - self.transmit).max(0.0)
    }

    /// Linear interpolation of all five numbers.
    #[must_use]
    pub fn lerp(&self, other: &Self, s: f64) -> Self {
        Self {
            rgb: self.rgb * (1.0 - s) + other.rgb * s,
            filter: self.filter * (1.0 - s) + other.filter * s,
            transmit: self.transmit * (1.0 - s) + other.transmit * s,
        }
    }
}

/// A colour at every point of space (solid texturing).
#[derive(Clone, Debug, PartialEq)]
pub enum Pigment {
    /// The same everywhere.
    Uniform(Color),
    /// A pattern in a frame of its own.
    Pattern {
        /// Which.
        pattern: Pattern,
        /// From world space to the pattern's frame.
        pattern_from_world: DAffine3,
    },
}

/// Patterns over space.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// Unit cubes of two pigments in turn; the cube at the origin's upper side has the first.
    Checker(Box<[Pigment; 2]>),
    /// `|fract|` of the distance along `axis` picks from the map: it rises from 0 to 1 over each unit.
    Gradient {
        /// Direction; its length scales the pattern.
        axis: DVec3,
        /// Colours by position in `[0, 1]`, sorted, at least one.
        map: Vec<ColorStop>,
    },
}

/// One entry of a colour map; between entries colours are interpolated, outside they are held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorStop {
    /// In `[0, 1]`, not below the entry before.
    pub position: f64,
    /// The colour there.
    pub color: Color,
}

impl Pigment {
    /// The colour at a point of world space.
    #[must_use]
    pub fn at(&self, point: DVec3) -> Color {
        match self {
            Self::Uniform(color) => *color,
            Self::Pattern {
                pattern,
                pattern_from_world,
            } => {
                let local = pattern_from_world.transform_point3(point);
                match pattern {
                    Pattern::Checker(pair) => pair[checker_parity(local)].at(point),
                    Pattern::Gradient { axis, map } => {
                        let s = axis.dot(local);
                        color_at(map, s - libm::floor(s))
                    }
                }
            }
        }
    }

    /// Whether any point lets light through.
    #[must_use]
    pub fn is_transparent(&self) -> bool {
        let clear = |c: &Color| c.filter > 0.0 || c.transmit > 0.0;
        match self {
            Self::Uniform(color) => clear(color),
            Self::Pattern { pattern, .. } => match pattern {
                Pattern::Checker(pair) => pair.iter().any(Self::is_transparent),
                Pattern::Gradient { map, .. } => map.iter().any(|stop| clear(&stop.color)),
            },
        }
    }

    /// The same pigment after its object was moved by `world_from_object`.
    #[must_use]
    pub fn transformed(&self, object_from_world: &DAffine3) -> Self {
        match self {
            Self::Uniform(color) => Self::Uniform(*color),
            Self::Pattern {
                pattern,
                pattern_from_world,
            } => Self::Pattern {
                pattern: match pattern {
                    Pattern::Checker(pair) => Pattern::Checker(Box::new([
                        pair[0].transformed(object_from_world),
                        pair[1].transformed(object_from_world),
                    ])),
                    gradient @ Pattern::Gradient { .. } => gradient.clone(),
                },
                pattern_from_world: *pattern_from_world * *object_from_world,
            },
        }
    }
}

/// 0 or 1: which of two colours a unit cube has. Points within 1e-7 below a cube's face count as
/// on it, so that a surface that lies in a face (a floor at height 0) has one colour.
fn checker_parity(p: DVec3) -> usize {
    let cell = |x: f64| libm::floor(x + 1e-7) as i64;
    let sum = cell(p.x).wrapping_add(cell(p.y)).wrapping_add(cell(p.z));
    sum.rem_euclid(2) as usize
}

fn color_at(map: &[ColorStop], s: f64) -> Color {
    let Some(first) = map.first() else {
        return Color::default();
    };
    let mut below = first;
    for stop in map {
        if stop.position > s {
            let width = stop.position - below.position;
            if width <= 0.0 {
                return below.color;
            }
            return below.color.lerp(&stop.color, (s - below.position) / width);
        }
        below = stop;
    }
    below.color
}

/// How light leaves the surface.
///
/// A surface is shaded on the side that is seen, its normal turned to the viewer. With the
/// pigment's colour `C`, its opacity `o = 1 - filter - transmit`, and for every lamp that is seen
/// from the surface its light `L`, the unit directions `N` (normal), `V` (viewer), `l` (lamp),
/// `R` (mirrored viewer) and `H` (half way between `V` and `l`), the light is
///
/// - `o C (ambient * ambient light of the scene + emission)`,
/// - per lamp with `N.l > 0`: `L o C diffuse (N.l)^brilliance`,
/// - per lamp with `N.l > 0`: `L M (phong (R.l)^phong_size + specular (N.H)^(1 / roughness))`,
///   where `M = 1 + metallic (1 - F) (C - 1)` and `F` is POV-Ray's empirical reflectivity of
///   metals at the angle between `N` and `l`,
/// - what the mirrored ray sees, times the reflection,
/// - what the transmitted ray sees, times [`Color::transmittance`]. At total internal reflection
///   nothing is transmitted, and the mirrored ray counts fully (1, instead of the reflection).
///
/// Light on its way to a lit surface passes transparent surfaces unbent, times the transmittance
/// of each, whether or not they conserve energy, and times what their insides leave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finish {
    /// Light that is there without a lamp, times the pigment, times the scene's ambient light.
    pub ambient: DVec3,
    /// Light of the surface's own, times the pigment.
    pub emission: DVec3,
    /// Lambert's term.
    pub diffuse: f64,
    /// Exponent of the cosine in Lambert's term; 1 is Lambert.
    pub brilliance: f64,
    /// Phong's highlight: amount.
    pub phong: f64,
    /// Phong's highlight: exponent of cos(reflected direction, light).
    pub phong_size: f64,
    /// Blinn and Phong's highlight: amount.
    pub specular: f64,
    /// Blinn and Phong's highlight: 1 / exponent of cos(normal, half vector).
    pub roughness: f64,
    /// How far highlights (and reflections, if they say so) take the pigment's colour: 0..1.
    pub metallic: f64,
    /// The mirror term.
    pub reflection: Reflection,
    /// Whether what is reflected is missing from what is transmitted: the transmittance is
    /// multiplied by 1 - reflection.
    pub conserve_energy: bool,
}

impl Default for Finish {
    fn default() -> Self {
        Self {
            ambient: DVec3::splat(0.1),
            emission: DVec3::ZERO,
            diffuse: 0.6,
            brilliance: 1.0,
            phong: 0.0,
            phong_size: 40.0,
            specular: 0.0,
            roughness: 0.05,
            metallic: 0.0,
            reflection: Reflection::default(),
            conserve_energy: false,
        }
    }
}

/// The mirror term: from `min` (seen head on) to `max` (seen grazing), times
/// `1 + metallic (1 - F) (C - 1)` as for highlights, `F` at the angle between normal and viewer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reflection {
    /// Share of light mirrored at normal incidence.
    pub min: DVec3,
    /// Share of light mirrored at grazing incidence.
    pub max: DVec3,
    /// `true`: between them by Fresnel's equations with the interior's index; `false`: by
    /// `(1 - cos)^falloff`.
    pub fresnel: bool,
    /// Exponent of the non-Fresnel blend.
    pub falloff: f64,
    /// How far reflections take the pigment's colour: 0..1.
    pub metallic: f64,
}

impl Reflection {
    /// The same mirror from every angle.
    #[must_use]
    pub const fn constant(share: DVec3) -> Self {
        Self {
            min: share,
            max: share,
            fresnel: false,
            falloff: 1.0,
            metallic: 0.0,
        }
    }

    /// Whether nothing is mirrored from any angle.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.min == DVec3::ZERO && self.max == DVec3::ZERO
    }
}

/// What fills a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// Index of refraction, relative to vacuum; 1 does not bend.
    pub ior: f64,
    /// Absorption: light is multiplied by `exp(-absorption * distance)`, per unit of length.
    pub absorption: DVec3,
    /// A weakening that is not exponential, besides the absorption.
    pub fade: Option<Fade>,
}

impl Default for Interior {
    fn default() -> Self {
        Self {
            ior: 1.0,
            absorption: DVec3::ZERO,
            fade: None,
        }
    }
}

/// How light weakens on its way through an inside in POV-Ray: it is multiplied by
/// `color + (1 - color) / (1 + (distance / half_distance)^power)` on each straight piece of way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fade {
    /// Where half of what can be lost is lost; positive.
    pub half_distance: f64,
    /// Positive; from 1000 on the law is `color + (1 - color) exp(-distance / half_distance)`.
    pub power: f64,
    /// What is left after any distance.
    pub color: DVec3,
}

impl Fade {
    /// What is left of light after `distance`, possibly infinite.
    #[must_use]
    pub fn transmission(&self, distance: f64) -> DVec3 {
        let s = distance / self.half_distance;
        let left = if self.power >= 1000.0 {
            libm::exp(-s)
        } else {
            1.0 / (1.0 + libm::pow(s, self.power))
        };
        self.color + (DVec3::ONE - self.color) * left
    }
}

/// Everything about the look of a surface and of what is behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// For messages and listings.
    pub name: String,
    /// Colour over space.
    pub pigment: Pigment,
    /// Surface.
    pub finish: Finish,
    /// Volume.
    pub interior: Interior,
}

impl Default for Material {
    fn default() -> Self {
        Self::matte("default", DVec3::splat(0.8))
    }
}

impl Material {
    /// Lambert's matte surface with a little ambient light.
    #[must_use]
    pub fn matte(name: &str, rgb: DVec3) -> Self {
        Self {
            name: name.to_owned(),
            pigment: Pigment::Uniform(Color {
                rgb,
                filter: 0.0,
                transmit: 0.0,
            }),
            finish: Finish {
                diffuse: 0.9,
                ..Finish::default()
            },
            interior: Interior::default(),
        }
    }

    /// A clear dielectric with Fresnel's reflection: what it reflects it does not transmit.
    #[must_use]
    pub fn glass(name: &str, ior: f64) -> Self {
        Self {
            name: name.to_owned(),
            pigment: Pigment::Uniform(Color {
                rgb: DVec3::ONE,
                filter: 0.0,
                transmit: 1.0,
            }),
            finish: Finish {
                ambient: DVec3::ZERO,
                diffuse: 0.0,
                specular: 0.5,
                roughness: 0.005,
                reflection: Reflection {
                    max: DVec3::ONE,
                    fresnel: true,
                    ..Reflection::constant(DVec3::ZERO)
                },
                conserve_energy: true,
                ..Finish::default()
            },
            interior: Interior {
                ior,
                ..Interior::default()
            },
        }
    }

    /// A mirror of the given tint.
    #[must_use]
    pub fn mirror(name: &str, rgb: DVec3) -> Self {
        Self {
            name: name.to_owned(),
            pigment: Pigment::Uniform(Color {
                rgb,
                filter: 0.0,
                transmit: 0.0,
            }),
            finish: Finish {
                ambient: DVec3::ZERO,
                diffuse: 0.0,
                specular: 0.5,
                roughness: 0.01,
                metallic: 1.0,
                reflection: Reflection::constant(rgb),
                ..Finish::default()
            },
            interior: Interior::default(),
        }
    }
}

/// What a ray sees that meets nothing.
#[derive(Clone, Debug, PartialEq)]
pub enum Background {
    /// One colour.
    Uniform(DVec3),
    /// By direction: `map` at `(1 + d . axis / |d|) / 2`, so 0 looks against the axis, 1 along it.
    Gradient {
        /// Unit length.
        axis: DVec3,
        /// Colours by position in `[0, 1]`, sorted, at least one.
        map: Vec<ColorStop>,
    },
    /// By direction: pigments at the point where it meets the unit sphere about the origin, each
    /// seen through those above it.
    Sky {
        /// What is seen through all of them.
        base: DVec3,
        /// The lowest first; in the frame of the world.
        layers: Vec<Pigment>,
    },
}

impl Default for Background {
    fn default() -> Self {
        Self::Uniform(DVec3::ZERO)
    }
}

impl Background {
    /// The colour seen in `direction` (any length).
    #[must_use]
    pub fn at(&self, direction: DVec3) -> DVec3 {
        match self {
            Self::Uniform(rgb) => *rgb,
            Self::Gradient { axis, map } => {
                let height = direction.normalize_or_zero().dot(*axis);
                color_at(map, 0.5 + 0.5 * height).rgb
            }
            Self::Sky { base, layers } => {
                let point = direction.normalize_or_zero();
                layers.iter().fold(*base, |below, layer| {
                    let color = layer.at(point);
                    color.rgb * color.opacity() + below * color.transmittance()
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checker_has_one_colour_on_a_floor_at_height_zero() {
        let white = Pigment::Uniform(Color::rgb(1.0, 1.0, 1.0));
        let black = Pigment::Uniform(Color::rgb(0.0, 0.0, 0.0));
        let checker = Pigment::Pattern {
            pattern: Pattern::Checker(Box::new([white, black])),
            pattern_from_world: DAffine3::IDENTITY,
        };
        for z in [-1e-15, 0.0, 1e-15] {
            assert_eq!(checker.at(DVec3::new(0.5, 0.5, z)).rgb, DVec3::ONE);
            assert_eq!(checker.at(DVec3::new(1.5, 0.5, z)).rgb, DVec3::ZERO);
        }
    }

    #[test]
    fn gradient_interpolates_and_holds_its_ends() {
        let map = [0.25, 0.75].map(|position| ColorStop {
            position,
            color: Color::rgb(position, 0.0, 0.0),
        });
        assert_eq!(color_at(&map, 0.0).rgb.x, 0.25);
        assert_eq!(color_at(&map, 0.5).rgb.x, 0.5);
        assert_eq!(color_at(&map, 1.0).rgb.x, 0.75);
    }

    #[test]
    fn a_fade_loses_half_at_its_distance_and_all_in_the_end() {
        let fade = Fade {
            half_distance: 2.0,
            power: 3.0,
            color: DVec3::new(0.0, 0.5, 1.0),
        };
        assert_eq!(fade.transmission(0.0), DVec3::ONE);
        assert_eq!(fade.transmission(2.0), DVec3::new(0.5, 0.75, 1.0));
        assert_eq!(fade.transmission(f64::INFINITY), fade.color);
    }

    #[test]
    fn a_sky_is_seen_through_its_upper_layers() {
        let veil = Color {
            rgb: DVec3::ONE,
            filter: 0.0,
            transmit: 0.75,
        };
        let background = Background::Sky {
            base: DVec3::X,
            layers: vec![
                Pigment::Pattern {
                    pattern: Pattern::Gradient {
                        axis: DVec3::Z,
                        map: vec![
                            ColorStop {
                                position: 0.0,
                                color: Color::default(),
                            },
                            ColorStop {
                                position: 1.0,
                                color: Color::rgb(0.0, 0.0, 1.0),
                            },
                        ],
                    },
                    pattern_from_world: DAffine3::IDENTITY,
                },
                Pigment::Uniform(veil),
            ],
        };
        // 30 degrees above the horizon the gradient is at one half, whatever the length.
        let seen = background.at(DVec3::new(3.0_f64.sqrt(), 0.0, 1.0) * 5.0);
        assert!((seen - DVec3::new(0.25, 0.25, 0.25 + 0.75 * 0.5)).length() < 1e-12);
    }

    #[test]
    fn a_pattern_moves_with_its_object() {
        let checker = Pigment::Pattern {
            pattern: Pattern::Checker(Box::new([
                Pigment::Uniform(Color::rgb(1.0, 1.0, 1.0)),
                Pigment::Uniform(Color::rgb(0.0, 0.0, 0.0)),
            ])),
            pattern_from_world: DAffine3::IDENTITY,
        };
        let shift = DAffine3::from_translation(DVec3::X);
        let moved = checker.transformed(&shift.inverse());
        let p = DVec3::new(0.3, 0.4, 0.5);
        assert_eq!(moved.at(p + DVec3::X), checker.at(p));
        assert_ne!(moved.at(p), checker.at(p));
    }
}
