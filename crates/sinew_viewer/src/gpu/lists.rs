//! Draw lists of one picture, as numbers for the GPU.

use super::device::Gpu;
use super::meshes::{RigMeshes, Solids, push_vertices};
use super::pipelines::{INSTANCE, LINE, VERTEX};
use crate::stage::{Solid, Stage};
use sinew::anim::Rig;
use sinew::math::{Affine, Mat3};
use sinew_picture::{Faces, Line, LineDepth, Model, Pattern, ShadowCasting};
use sinew_scenes::scenes::Figure;
use std::ops::Range;

/// Draw lists of one picture. The buffers are reused from picture to picture.
#[derive(Debug, Default)]
pub(crate) struct Lists {
    pub instances: Vec<f32>,
    pub palette: Vec<f32>,
    pub vertices: Vec<f32>,
    pub indices: Vec<u32>,
    /// Lines hidden by surfaces, then lines on top.
    pub lines: Vec<f32>,
    /// Number of lines hidden by surfaces.
    pub hidden_lines: u32,
    /// Instances of each mesh of the solids.
    pub solids: Vec<Range<u32>>,
    pub models: Vec<ModelDraw>,
    pub figures: Vec<FigureDraw>,
    sorted: Vec<Vec<usize>>,
}

/// A model used in one picture.
#[derive(Debug)]
pub(crate) struct ModelDraw {
    /// Index of the model in the scene.
    pub model: usize,
    pub indices: Range<u32>,
    pub instance: u32,
    pub is_translucent: bool,
    pub casts: bool,
}

/// All characters of a rig, for one of its parts.
#[derive(Debug)]
pub(crate) struct FigureDraw {
    /// Address of the rig.
    pub rig: usize,
    pub part: usize,
    pub instances: Range<u32>,
}

/// Returns the address of a rig, the key of its meshes.
pub(crate) fn address(rig: &Rig) -> usize {
    std::ptr::from_ref(rig).addr()
}

impl Lists {
    /// Fills the lists from a stage; `meshes_of` returns the meshes of a rig.
    pub fn fill<'m>(
        &mut self,
        gpu: &Gpu,
        stage: &Stage<'_>,
        solids: &mut Solids,
        meshes_of: impl Fn(usize) -> &'m RigMeshes,
    ) {
        self.instances.clear();
        self.palette.clear();
        self.add_solids(gpu, &stage.solids, solids);
        self.add_models(&stage.scene.models);
        self.add_figures(&stage.figures, meshes_of);
        self.add_lines(&stage.scene.lines);
    }

    fn next_instance(&self) -> u32 {
        (self.instances.len() / INSTANCE) as u32
    }

    fn add_solids(&mut self, gpu: &Gpu, list: &[Solid], solids: &mut Solids) {
        self.sorted.iter_mut().for_each(Vec::clear);
        for (index, solid) in list.iter().enumerate() {
            let number = solids.number(gpu, &solid.form);
            if self.sorted.len() <= number {
                self.sorted.resize_with(number + 1, Vec::new);
            }
            self.sorted[number].push(index);
        }
        self.solids.clear();
        let sorted = std::mem::take(&mut self.sorted);
        for of_mesh in &sorted {
            let first = self.next_instance();
            for &index in of_mesh {
                let Solid { place, scale, color, .. } = &list[index];
                let turn = Affine::from(*place).linear;
                let linear =
                    Mat3::from_cols(turn.x_axis * scale.x, turn.y_axis * scale.y, turn.z_axis * scale.z);
                push_rows(&mut self.instances, &Affine { linear, translation: place.translation });
                self.push_look(*color, 1.0, None, 0.0, 0.0);
            }
            self.solids.push(first..self.next_instance());
        }
        self.sorted = sorted;
    }

    fn push_look(
        &mut self,
        color: [f32; 3],
        opacity: f32,
        pattern: Option<(f32, [f32; 3])>,
        palette: f32,
        outside: f32,
    ) {
        let (size, [r, g, b]) = pattern.unwrap_or((0.0, [0.0; 3]));
        self.instances.extend(color);
        self.instances.extend([opacity, r, g, b, size, palette, outside, 0.0, 0.0]);
    }

    fn add_models(&mut self, models: &[Model]) {
        self.vertices.clear();
        self.indices.clear();
        self.models.clear();
        for (number, model) in models.iter().enumerate().filter(|(_, model)| model.material.opacity > 0.0) {
            let base = (self.vertices.len() / VERTEX) as u32;
            let first = self.indices.len() as u32;
            let count = model.positions.len();
            push_vertices(model, &mut self.vertices);
            let whole = |corners: &&[u32]| corners.iter().all(|&corner| (corner as usize) < count);
            let triangles = model.indices.chunks_exact(3).filter(whole);
            self.indices.extend(triangles.flatten().map(|corner| corner + base));
            let material = &model.material;
            let pattern = match material.pattern {
                Pattern::Plain => None,
                Pattern::Checker { size, other } => Some((size.max(1e-3), other)),
            };
            self.models.push(ModelDraw {
                model: number,
                indices: first..self.indices.len() as u32,
                instance: self.next_instance(),
                is_translucent: material.opacity < 1.0,
                casts: material.shadow == ShadowCasting::Yes,
            });
            push_rows(&mut self.instances, &Affine::IDENTITY);
            let outside = f32::from(u8::from(material.faces == Faces::Outside));
            self.push_look(material.color, material.opacity, pattern, 0.0, outside);
        }
    }

    fn add_figures<'m>(&mut self, figures: &[Figure<'_>], meshes_of: impl Fn(usize) -> &'m RigMeshes) {
        self.figures.clear();
        let mut done = Vec::new();
        for (index, figure) in figures.iter().enumerate() {
            let rig = address(figure.rig);
            if done.contains(&rig) {
                continue;
            }
            done.push(rig);
            let alike: Vec<&Figure<'_>> =
                figures[index..].iter().filter(|it| address(it.rig) == rig).collect();
            let bases: Vec<Vec<f32>> = alike.iter().map(|figure| self.push_palette(figure)).collect();
            for (part, of) in meshes_of(rig).parts.iter().enumerate() {
                let first = self.next_instance();
                for bases in &bases {
                    push_rows(&mut self.instances, &Affine::IDENTITY);
                    self.push_look(of.color, 1.0, None, bases[of.mesh], 0.0);
                }
                self.figures.push(FigureDraw { rig, part, instances: first..self.next_instance() });
            }
        }
    }

    /// Appends the matrices of a character's meshes; returns the index of the first matrix of each mesh.
    fn push_palette(&mut self, figure: &Figure<'_>) -> Vec<f32> {
        let Figure { rig, world_from_joint } = figure;
        let palette = &mut self.palette;
        let bases = rig.meshes.iter().map(|mesh| {
            let base = (palette.len() / 12) as f32;
            match mesh.skin.map(|skin| &rig.skins[skin]) {
                Some(skin) => {
                    for (&joint, inverse) in skin.joints.iter().zip(&skin.inverse_bind) {
                        push_rows(palette, &(world_from_joint[joint] * *inverse));
                    }
                }
                None => push_rows(palette, &world_from_joint[mesh.joint]),
            }
            base
        });
        bases.collect()
    }

    fn add_lines(&mut self, lines: &[Line]) {
        self.lines.clear();
        for depth in [LineDepth::Tested, LineDepth::OnTop] {
            for line in lines.iter().filter(|line| line.depth == depth) {
                self.lines.extend(line.from.to_array());
                self.lines.extend(line.to.to_array());
                self.lines.extend(line.color);
            }
            if depth == LineDepth::Tested {
                self.hidden_lines = self.line_count();
            }
        }
    }

    pub fn line_count(&self) -> u32 {
        (self.lines.len() / LINE) as u32
    }
}

/// Appends the three rows of a matrix.
fn push_rows(numbers: &mut Vec<f32>, affine: &Affine) {
    let (m, t) = (&affine.linear, affine.translation);
    for row in 0..3 {
        numbers.extend([m.x_axis[row], m.y_axis[row], m.z_axis[row], t[row]]);
    }
}
