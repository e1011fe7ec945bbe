use octray_math::DVec3;
use octray_scene::{Color, Finish, Reflection};

use super::direction::{reflect_above, refract};
use super::fresnel::dielectric_reflectance;
use super::highlight::{highlight, metallic_tint};

/// A surface point with everything its shading needs, turned to the viewer.
#[derive(Clone, Copy, Debug)]
pub struct WhittedSurface<'a> {
    /// How light leaves the surface.
    pub finish: &'a Finish,
    /// The pigment's colour here.
    pub color: Color,
    /// Unit normal of the true surface on the viewer's side.
    pub normal: DVec3,
    /// Unit normal for shading on the viewer's side.
    pub shading_normal: DVec3,
    /// Unit direction in which the ray travelled that sees the surface.
    pub direction: DVec3,
    /// Index of refraction on the viewer's side.
    pub ior_from: f64,
    /// Index of refraction behind the surface.
    pub ior_to: f64,
}

/// A ray that goes on, and the share of the seen light that it brings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering {
    /// What its light is multiplied by.
    pub weight: DVec3,
    /// Where it goes; unit length for unit directions, but for rounding.
    pub direction: DVec3,
}

impl WhittedSurface<'_> {
    /// Light that needs no lamp: `opacity * pigment * (ambient * ambient_light + emission)`.
    #[must_use]
    pub fn own_light(&self, ambient_light: DVec3) -> DVec3 {
        let light = self.finish.ambient * ambient_light + self.finish.emission;
        self.color.rgb * light * self.color.opacity()
    }

    /// The share of a lamp's light that is seen from the surface; `light` is the unit direction
    /// to the lamp. 0 where the lamp is behind the surface as the viewer sees it.
    ///
    /// Lambert's term with brilliance, `opacity * diffuse * cos^brilliance * pigment`, and the
    /// highlights, which the opacity does not weaken.
    #[must_use]
    pub fn response(&self, light: DVec3, with_highlights: bool) -> DVec3 {
        let cos = self.shading_normal.dot(light);
        // Written so that NaN counts as behind.
        if !matches!(cos.partial_cmp(&0.0), Some(std::cmp::Ordering::Greater)) {
            return DVec3::ZERO;
        }
        let finish = self.finish;
        let lambert = if finish.brilliance == 1.0 {
            cos
        } else {
            libm::pow(cos, finish.brilliance)
        };
        let mut response = self.color.rgb * (self.color.opacity() * finish.diffuse * lambert);
        if with_highlights {
            let shine = highlight(finish, self.shading_normal, -self.direction, light);
            if shine != 0.0 {
                response += metallic_tint(finish.metallic, self.color.rgb, cos) * shine;
            }
        }
        response
    }

    /// The share of light that the mirror term reflects at this angle.
    #[must_use]
    pub fn reflectance(&self) -> DVec3 {
        let reflection = &self.finish.reflection;
        if reflection.is_none() {
            return DVec3::ZERO;
        }
        let cos = self.cos_view();
        let grazing = self.grazing(reflection, cos);
        let share = reflection.min + (reflection.max - reflection.min) * grazing;
        share * metallic_tint(reflection.metallic, self.color.rgb, cos)
    }

    /// The reflected and the transmitted ray, where there are such.
    ///
    /// Where light cannot pass for total internal reflection, all of it is reflected: the
    /// reflected ray has weight 1 and replaces the mirror term, and there is no transmitted ray
    /// (as in POV-Ray).
    #[must_use]
    pub fn scatter(&self) -> (Option<Scattering>, Option<Scattering>) {
        let mut reflected = self.reflectance();
        let mut transmitted = None;
        let transmittance = self.color.transmittance();
        if transmittance != DVec3::ZERO {
            if let Some(direction) = self.refracted() {
                let weight = if self.finish.conserve_energy {
                    transmittance * (DVec3::ONE - reflected).max(DVec3::ZERO)
                } else {
                    transmittance
                };
                transmitted = (weight != DVec3::ZERO).then_some(Scattering { weight, direction });
            } else {
                reflected = DVec3::ONE;
            }
        }
        let reflected = (reflected != DVec3::ZERO).then(|| Scattering {
            weight: reflected,
            direction: reflect_above(self.direction, self.shading_normal, self.normal),
        });
        (reflected, transmitted)
    }

    /// Cosine between the shading normal and the viewer, in `[0, 1]`.
    fn cos_view(&self) -> f64 {
        (-self.direction.dot(self.shading_normal)).clamp(0.0, 1.0)
    }

    /// How far the mirror term has gone from `min` to `max`.
    fn grazing(&self, reflection: &Reflection, cos: f64) -> f64 {
        if reflection.fresnel {
            dielectric_reflectance(cos, self.ior_from, self.ior_to)
        } else if reflection.min == reflection.max {
            0.0
        } else {
            libm::pow(1.0 - cos, reflection.falloff)
        }
    }

    /// The refracted direction on the far side of the true surface; `None` at total internal
    /// reflection.
    fn refracted(&self) -> Option<DVec3> {
        let eta = self.ior_from / self.ior_to;
        let bent = refract(self.direction, self.shading_normal, eta)?;
        if bent.dot(self.normal) <= 0.0 {
            Some(bent)
        } else {
            // The interpolated normal bent the ray out of the solid: the true one does not.
            refract(self.direction, self.normal, eta)
        }
    }
}
