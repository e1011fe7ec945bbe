//! What the scene knows besides what Python sees: changes, and the world made from it.

use octray::scene::{self, SceneBuilder, SceneError, Settings};
use octray::world::Method;
use pyo3::prelude::*;

use super::Scene;
use crate::diagnostics::{Diagnostic, invalid_scene};
use crate::world::{Prepared, completed};

impl Scene {
    pub(crate) fn imported(scene: scene::Scene, diagnostics: Vec<Diagnostic>) -> Self {
        Self {
            builder: scene.into_builder(),
            diagnostics,
            imported: true,
            ..Self::default()
        }
    }

    /// The scene as it stands, validated, with what a picture needs and it lacks.
    pub(crate) fn complete(&self, py: Python<'_>) -> PyResult<scene::Scene> {
        let built = self.builder.clone().build();
        let plain = built.map_err(|errors: Vec<SceneError>| invalid_scene(py, &errors))?;
        Ok(completed(plain, !self.imported))
    }

    /// The scene as it stands, not validated.
    pub(crate) const fn so_far(&self) -> &scene::Scene {
        self.builder.so_far()
    }

    pub(crate) fn settings(&self) -> &Settings {
        self.builder.so_far().settings()
    }

    pub(crate) fn own_camera(&self) -> Option<scene::Camera> {
        self.builder.so_far().camera().copied()
    }

    /// Keeps what an importer said.
    pub(crate) fn said(&mut self, diagnostics: Vec<Diagnostic>) {
        self.diagnostics.extend(diagnostics);
    }

    pub(crate) const fn revision(&self) -> u64 {
        self.revision
    }

    pub(crate) fn prepared(&self, method: Method) -> Option<&Prepared> {
        self.prepared.as_ref().filter(|p| p.method == method)
    }

    pub(crate) fn keep(&mut self, prepared: Prepared) {
        self.prepared = Some(prepared);
    }

    /// The builder, for a change that a world made before does not know of.
    pub(crate) fn changed(&mut self) -> &mut SceneBuilder {
        self.revision += 1;
        self.prepared = None;
        &mut self.builder
    }
}
