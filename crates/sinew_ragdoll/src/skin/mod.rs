//! Quality of the drawn skin on the bodies: the visible result, whereas [`crate::quality`] measures the simulation.
//!
//! A ragdoll may rest quietly and still look broken: a limb without a body stays behind and tears the mesh, a hat sinks
//! into the floor, a character scaled twice floats. The skin is therefore posed as a viewer would draw it, in the poses
//! of the eight drops, and compared with the bodies, the floor, and the stretch in the file's own clips.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! # let (def, _) = sinew_ragdoll::build(&rig, &analysis, &sinew_ragdoll::BuildOptions::default())?;
//! use sinew_ragdoll::SkinMeter;
//!
//! let skin = SkinMeter::new(&rig, &def, &analysis.bind_model, &[]).figures();
//! println!("{:.0} % of the skin is near a body", 100.0 * skin.covered_share);
//! assert!(skin.covered_share > 0.95 && skin.contiguous);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod judge;
mod sides;
mod stretch;
pub(crate) mod surface;

use crate::def::RagdollDef;
use crate::doctor::bones_of;
use crate::mapping::{Mapping, Physical};
use crate::quality::Fallen;
use crate::tuning::OWN_WEIGHT;
pub use judge::{Flaw, FlawKind};
use sinew_anim::{JointIdx, LocalTransform, Rig, Take, local_to_model, rest_pose};
use sinew_math::{Affine, Transform, Vec3, max, max3, min3};
use stretch::{Stretch, Stretched};
use surface::{Side, Surface, may_stand};

/// Largest number of clip poses measured, evenly spread over all clips.
const MOST_CLIP_POSES: usize = 64;

/// Metrics of the drawn skin, metres unless a field says otherwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinQuality {
    /// Share of the skin's vertices that are, in the bind pose, no farther than [`tolerance`](Self::tolerance) outside the shape of
    /// a body that moves them: 0..=1.
    pub covered_share: f32,
    /// Growth of triangle sides over the drops beyond their bind length: 99.9th percentile over sides and poses, as a
    /// share of [`size`](Self::size).
    pub edge_stretch_p999: f32,
    /// Largest growth over the drops, as a share of the size.
    pub edge_stretch_max: f32,
    /// 99.9th percentile of the growth over the file's clips, as a share of the size; `None` without clips.
    pub clips_stretch_p999: Option<f32>,
    /// Largest growth over the file's clips, as a share of the size.
    pub clips_stretch_max: Option<f32>,
    /// Largest difference between a body and its mirror image, as a length.
    pub symmetry_error_m: f32,
    /// Height of the drawn skin in the bind pose.
    pub bind_height_m: f32,
    /// Height of the skin drawn with the bodies in the bind pose, by the nodes' own transforms.
    pub drawn_height_m: f32,
    /// Height of the drawn skin's lowest point above the floor, at the end of the drop for which this distance is
    /// largest. Negative inside the floor; `None` if the character never lay on a floor.
    pub rest_height_m: Option<f32>,
    /// True if every body is near its parent, and every part of a limb descends from that limb.
    pub contiguous: bool,
    /// Lowest height of the drawn skin above the floor while the character stands before its fall. Negative inside the
    /// floor; `None` if not measured.
    pub standing_height_m: Option<f32>,
    /// Lowest height of the drawn skin above the floor during a get-up.
    pub rising_height_m: Option<f32>,
    /// Lowest height of the drawn skin above the floor once the character is up again.
    pub up_height_m: Option<f32>,
    /// Largest height of the lowest drawn point above the floor during a get-up; `None` if not measured.
    pub rising_above_m: Option<f32>,
    /// Largest height of the lowest drawn point above the floor while the character's clips move it, before its fall
    /// and once it is up again; `None` if not measured.
    pub clips_above_m: Option<f32>,
    /// Longest time in a drop without a body near the floor after the ragdoll had become calm, seconds; `None` if not
    /// measured.
    pub airborne_s: Option<f32>,
    /// Reference length of heights and stretches: a human's height; for a creature the longest side of its skin's box.
    pub size: f32,
    /// Bodies with the worst metrics.
    pub worst: Worst,
}

/// Body with the worst value of each metric, by index in the definition; `None` if the metric is good or no body is
/// responsible.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Worst {
    /// Body with the most vertices that are not covered.
    pub uncovered: Option<usize>,
    /// Name of the joint that moves most of these vertices, if it has no body of its own.
    pub uncovered_joint: Option<String>,
    /// Number of vertices that no body moves, per thousand.
    pub adrift: u32,
    /// Bodies that move the two ends of the most stretched side.
    pub torn: Option<(usize, usize)>,
    /// Phase in which this side is stretched most.
    pub torn_in: Phase,
    /// Bodies that move the lowest point while standing, while getting up and once up.
    pub lowest_in: [Option<usize>; 3],
    /// Body that differs most from its mirror image.
    pub unlike: Option<usize>,
    /// Body that is separate from its parent.
    pub apart: Option<usize>,
    /// Body that moves the lowest point at rest.
    pub lowest: Option<usize>,
    /// Name of the joint that moves this point, if the joint has no body of its own.
    pub lowest_joint: Option<String>,
}

/// Phase of a character's motion in which the skin is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// The character falls in one of the drops of a [`drop_test`](crate::drop_test).
    #[default]
    Drop,
    /// The character falls, lies, or is rolled to the start of a clip.
    Fall,
    /// The character gets up, or follows its clips.
    Clip,
}

/// Stage in which the lowest point of a character's skin is compared to the floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The character stands before its fall.
    Standing,
    /// The character gets up.
    Rising,
    /// The character is up again.
    Up,
}

impl SkinQuality {
    /// Returns the distance from its body up to which a vertex counts as covered, metres: 3 cm, or 5 % of the size if
    /// that is more.
    pub fn tolerance(&self) -> f32 {
        tolerance(self.size)
    }
}

fn tolerance(size: f32) -> f32 {
    max(0.03, 0.05 * size)
}

/// Measures the skin of a rig on its ragdoll over the drops of a [`drop_test`](crate::drop_test); see
/// [`SkinMeter::new`].
///
/// # Panics
/// As [`SkinMeter::new`], and if the falls belong to another ragdoll.
pub fn measure_skin(
    rig: &Rig,
    def: &RagdollDef,
    bind_model: &[Affine],
    takes: &[Take],
    falls: &[Fallen],
) -> SkinQuality {
    let mut meter = SkinMeter::new(rig, def, bind_model, takes);
    meter.follow_drops(falls);
    meter.figures()
}

/// Measures a character's drawn skin pose by pose. Samples large meshes and long clips deterministically.
pub struct SkinMeter<'a> {
    rig: &'a Rig,
    surface: Surface,
    mapping: Mapping,
    to_character: Affine,
    /// Stretch by [`Phase`]: long clips must not dilute the percentile of a short fall.
    stretch: [Stretch; 3],
    skin: SkinQuality,
    /// Joints that have a body of their own.
    own: Vec<JointIdx>,
    /// For each body, true if a character may stand on its skin.
    may_stand: Vec<bool>,
    model: Vec<Affine>,
    palette: Vec<Affine>,
}

impl<'a> SkinMeter<'a> {
    /// Measures everything that does not depend on a fall: cover, sides, heights, and stretch in the file's clips.
    /// `bind_model` is the bind pose (`RigAnalysis::bind_model`), `takes` are the clips.
    ///
    /// # Panics
    /// If the definition does not belong to the rig: it has no body, or names joints that the rig does not have; or if
    /// `bind_model` or a take does not have one entry per joint.
    pub fn new(rig: &'a Rig, def: &RagdollDef, bind_model: &[Affine], takes: &[Take]) -> Self {
        let surface = Surface::of(rig, def);
        let mapping = Mapping::new(rig, def, bind_model);
        let to_character = mapping.character_from_model();
        let mut palette = Vec::new();
        surface.palette(bind_model, &mut palette);
        let stretch = [(); 3].map(|()| Stretch::new(&surface, &palette, def.unit_scale));
        let bound = stretch::total(&surface, &palette);
        let (low, high) = bounds(&surface, &palette, &to_character);
        let size = size(def, low, high);
        let mut skin = SkinQuality { size, bind_height_m: high.y - low.y, ..SkinQuality::default() };
        let bare = cover(&mut skin, &surface, def, &palette, &to_character);
        skin.worst.uncovered_joint = without_body(rig, def, skin.worst.uncovered, bare);
        let bones = bones_of(def);
        (skin.symmetry_error_m, skin.worst.unlike) = sides::symmetry_error(def, &bones, size);
        skin.worst.apart = sides::apart(def, &bones, &surface.links(), size);
        skin.contiguous = skin.worst.apart.is_none();
        let model = Vec::new();
        let own = def.bodies.iter().map(|body| body.joint).collect();
        let mut meter = Self {
            rig,
            surface,
            mapping,
            to_character,
            stretch,
            skin,
            own,
            may_stand: may_stand(def),
            model,
            palette,
        };
        meter.draw_bound(def, bound);
        meter.look_at_clips(takes);
        meter
    }

    /// Measures the height of the skin where the bodies are in the bind pose, by the sizes of its triangles. Ears that
    /// are bound in another pose than the drawn one do not change this height.
    fn draw_bound(&mut self, def: &RagdollDef, bound: f32) {
        let own: Vec<Transform> = def.bodies.iter().map(|body| body.character_from_body).collect();
        let mut drawn = Drawn::new(self.rig, &self.mapping);
        drawn.pose_by(self.rig, &self.mapping, &own);
        self.draw(&drawn.pose);
        let ratio = if bound > 0.0 { stretch::total(&self.surface, &self.palette) / bound } else { 1.0 };
        self.skin.drawn_height_m = self.skin.bind_height_m * ratio;
    }

    fn look_at_clips(&mut self, takes: &[Take]) {
        let frames: usize = takes.iter().map(Take::frames).sum();
        if frames == 0 {
            return;
        }
        let all = takes.iter().flat_map(|take| (0..take.frames()).map(move |frame| take.pose(frame)));
        for pose in all.step_by(frames.div_ceil(MOST_CLIP_POSES)) {
            self.show(Phase::Clip, pose);
        }
        let Stretched { p999, max, .. } = self.stretch[Phase::Clip as usize].take(&self.surface);
        let size = self.skin.size;
        (self.skin.clips_stretch_p999, self.skin.clips_stretch_max) = (Some(p999 / size), Some(max / size));
    }

    /// Measures the poses of drops onto a floor at y = 0.
    ///
    /// # Panics
    /// If the falls belong to another ragdoll.
    pub fn follow_drops(&mut self, falls: &[Fallen]) {
        let to_world = self.to_character;
        let mut drawn = Drawn::new(self.rig, &self.mapping);
        for fall in falls {
            self.skin.airborne_s = Some(max(self.skin.airborne_s.unwrap_or(0.0), fall.airborne_s));
            for poses in &fall.poses {
                drawn.pose_by(self.rig, &self.mapping, poses);
                self.show(Phase::Drop, &drawn.pose);
            }
            if !fall.poses.is_empty() {
                self.lay(&drawn.pose, &to_world);
            }
        }
    }

    /// Measures the stretch of a shown pose, in local transforms. Keeps up to 16 KiB per pose, for the percentile.
    ///
    /// # Panics
    /// If the pose does not have one transform per joint.
    pub fn show(&mut self, phase: Phase, pose: &[LocalTransform]) {
        self.draw(pose);
        self.stretch[phase as usize].add(&self.surface, &self.palette);
    }

    /// Measures a pose above a floor at height `floor` (metres) of the world, at a stage of a get-up, and keeps the
    /// lowest point, and the largest height of the whole skin.
    ///
    /// # Panics
    /// As [`show`](Self::show).
    pub fn stand(&mut self, stage: Stage, pose: &[LocalTransform], to_world: &Affine, floor: f32) {
        self.draw(pose);
        let counts =
            |owner: Option<usize>| stage == Stage::Rising || owner.is_some_and(|body| self.may_stand[body]);
        let (height, vertex) = self.lowest(to_world, counts);
        let skin = &mut self.skin;
        let known = match stage {
            Stage::Standing => &mut skin.standing_height_m,
            Stage::Rising => &mut skin.rising_height_m,
            Stage::Up => &mut skin.up_height_m,
        };
        if height.is_finite() && known.is_none_or(|known| height - floor < known) {
            *known = Some(height - floor);
            skin.worst.lowest_in[stage as usize] = self.surface.owner(vertex);
        }
        let (above, _) = self.lowest(to_world, |_| true);
        let highest = match stage {
            Stage::Rising => &mut self.skin.rising_above_m,
            Stage::Standing | Stage::Up => &mut self.skin.clips_above_m,
        };
        if above.is_finite() {
            *highest = Some(highest.map_or(above - floor, |known| max(known, above - floor)));
        }
    }

    /// Returns the height and index of the lowest drawn vertex whose body counts.
    fn lowest(&self, to_world: &Affine, counts: impl Fn(Option<usize>) -> bool) -> (f32, usize) {
        let mut lowest = (f32::INFINITY, 0);
        for &vertex in self.surface.sample.iter().filter(|&&vertex| counts(self.surface.owner(vertex))) {
            let height = to_world.point(self.surface.place(&self.palette, vertex)).y;
            if height < lowest.0 {
                lowest = (height, vertex);
            }
        }
        lowest
    }

    /// Measures the pose at rest over a floor at y = 0; `to_world` is the transform from the model space of the file.
    ///
    /// # Panics
    /// As [`show`](Self::show).
    pub fn lay(&mut self, pose: &[LocalTransform], to_world: &Affine) {
        self.draw(pose);
        let lowest = self.lowest(to_world, |_| true);
        let skin = &mut self.skin;
        if lowest.0.is_finite() && skin.rest_height_m.is_none_or(|known| lowest.0.abs() > known.abs()) {
            (skin.rest_height_m, skin.worst.lowest) = (Some(lowest.0), self.surface.owner(lowest.1));
            let joint = self.surface.mover(lowest.1).filter(|joint| !self.own.contains(joint));
            skin.worst.lowest_joint = joint.map(|joint| self.rig.joints[joint].name.clone());
        }
    }

    fn draw(&mut self, pose: &[LocalTransform]) {
        local_to_model(self.rig, pose, &Affine::IDENTITY, &mut self.model);
        self.surface.palette(&self.model, &mut self.palette);
    }

    /// Returns the metrics so far; stretches are the worst of all phases.
    pub fn figures(mut self) -> SkinQuality {
        let mut skin = self.skin;
        for (phase, stretch) in [Phase::Drop, Phase::Fall, Phase::Clip].into_iter().zip(&mut self.stretch) {
            let Stretched { p999, max, side } = stretch.take(&self.surface);
            skin.edge_stretch_p999 = sinew_math::max(skin.edge_stretch_p999, p999 / skin.size);
            if max / skin.size <= skin.edge_stretch_max {
                continue;
            }
            skin.edge_stretch_max = max / skin.size;
            skin.worst.torn_in = phase;
            skin.worst.torn = side.and_then(|side| {
                let Side(a, b) = self.surface.sides[side];
                let (a, b) = (self.surface.owner(a), self.surface.owner(b));
                Some((a.or(b)?, b.or(a)?))
            });
        }
        skin
    }
}

/// Poses of a rig from poses of its bodies, over its rest pose.
struct Drawn {
    physical: Physical,
    pose: Vec<LocalTransform>,
}

impl Drawn {
    fn new(rig: &Rig, mapping: &Mapping) -> Self {
        let pose = rest_pose(rig);
        let mut physical = Physical::default();
        physical.rebase(mapping, rig, &pose);
        Self { physical, pose }
    }

    /// Poses the rig for bodies at these world poses, for a character at the world's origin.
    fn pose_by(&mut self, rig: &Rig, mapping: &Mapping, world_from_body: &[Transform]) {
        self.physical.pose(mapping, rig, Transform::IDENTITY, world_from_body, &mut self.pose);
    }
}

/// Returns the minimum and maximum corner of the skin in a pose, character space; the origin without skin.
fn bounds(surface: &Surface, palette: &[Affine], to_character: &Affine) -> (Vec3, Vec3) {
    let places = surface.sample.iter().map(|&vertex| to_character.point(surface.place(palette, vertex)));
    let corners = places.filter(|place| place.is_finite()).fold(None, |corners, place| {
        let (low, high) = corners.unwrap_or((place, place));
        Some((min3(low, place), max3(high, place)))
    });
    corners.unwrap_or((Vec3::ZERO, Vec3::ZERO))
}

fn size(def: &RagdollDef, low: Vec3, high: Vec3) -> f32 {
    let is_human = def.bodies[0].role == "hips";
    let sides = high - low;
    let size = if is_human { def.height } else { max(sides.x, max(sides.y, sides.z)) };
    // Avoid a division by zero.
    max(size, 1e-6)
}

/// Returns the name of the joint that moves most of a body's bare vertices, unless it is the body's own joint.
fn without_body(
    rig: &Rig,
    def: &RagdollDef,
    body: Option<usize>,
    mut bare: Vec<(usize, JointIdx)>,
) -> Option<String> {
    let body = body?;
    bare.retain(|(owner, _)| *owner == body);
    bare.sort_unstable();
    let runs = bare.chunk_by(|a, b| a == b);
    let most = runs.reduce(|a, b| if b.len() > a.len() { b } else { a })?;
    let joint = most[0].1;
    (joint != def.bodies[body].joint).then(|| rig.joints[joint].name.clone())
}

/// Stores the share of the skin near its body, and the body that moves most of the other vertices. Returns the body and
/// the joint that move each of these other vertices.
fn cover(
    skin: &mut SkinQuality,
    surface: &Surface,
    def: &RagdollDef,
    bound: &[Affine],
    to_character: &Affine,
) -> Vec<(usize, JointIdx)> {
    let mut rest = Vec::new();
    let tolerance = skin.tolerance();
    let mut bare = vec![0_u32; def.bodies.len()];
    let (mut covered, mut adrift) = (0_u32, 0_u32);
    for &vertex in &surface.sample {
        let place = to_character.point(surface.place(bound, vertex));
        let Some(owner) = surface.owner(vertex) else {
            adrift += 1;
            continue;
        };
        let is_within = |body: usize| {
            let body = &def.bodies[body];
            body.shape.signed_distance(&body.character_from_body, place).0 <= tolerance
        };
        let pulls = surface.pulls(vertex).filter(|&(_, pull)| pull >= OWN_WEIGHT);
        if is_within(owner) || pulls.into_iter().any(|(body, _)| is_within(body)) {
            covered += 1;
        } else {
            bare[owner] += 1;
            rest.extend(surface.mover(vertex).map(|joint| (owner, joint)));
        }
    }
    let all = max(surface.sample.len() as f32, 1.0);
    skin.covered_share = if surface.sample.is_empty() { 1.0 } else { covered as f32 / all };
    skin.worst.adrift = (1000.0 * adrift as f32 / all) as u32;
    let most = (0..bare.len()).reduce(|a, b| if bare[b] > bare[a] { b } else { a });
    skin.worst.uncovered = most.filter(|&body| bare[body] > 0);
    rest
}
