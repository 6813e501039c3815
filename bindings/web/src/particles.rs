//! Ropes, cloth and soft balls.

use crate::border::{Failure, Outcome, Shared};
use crate::definitions::body;
use crate::inner::{Drawn, Inner};
use crate::types::{ClothOptions, RopeOptions, SoftBallOptions, Vec3Like};
use crate::values::{Options, id, indices, vec3};
use crate::view::View;
use crate::world::World;
use js_sys::Float32Array;
use sinew::math::Vec3;
use sinew::physics::GroupId;
use sinew::physics::particles::{AttachmentTarget, BlobDef, ClothDef, GroupDef, ParticleGroup, RopeDef};
use wasm_bindgen::prelude::*;

/// A rope, a piece of cloth or a soft ball in a world. Attach its particles to attach it to a body or the world.
#[wasm_bindgen]
pub struct Particles {
    inner: Shared<Inner>,
    group: GroupId,
    triangles: Vec<u32>,
}

/// Runs a constructor that may panic about its arguments.
fn built<T>(make: impl FnOnce() -> T) -> Outcome<T> {
    crate::border::refused(make)
}

#[wasm_bindgen]
impl World {
    /// Adds a rope: a row of particles from one end to the other.
    #[wasm_bindgen(js_name = addRope)]
    pub fn add_rope(&self, options: RopeOptions) -> Outcome<Particles> {
        let options =
            Options::of(&options, "rope", &["from", "to", "links", "mass", "radius", "holdFrom", "holdTo"])?;
        let [from, to] = [options.needed_vec3("from")?, options.needed_vec3("to")?];
        let usual = built(|| RopeDef::between(from, to))?;
        let def = RopeDef {
            links: options.whole("links")?.unwrap_or(usual.links),
            mass: options.number("mass")?.unwrap_or(usual.mass),
            radius: options.number("radius")?.unwrap_or(usual.radius),
            ..usual
        };
        let mut rope = built(|| def.build())?;
        for (key, particle, place) in [("holdFrom", rope.first, from), ("holdTo", rope.last, to)] {
            if let Some(holder) = options.get(key) {
                let target = self.holder(&holder, place, &format!("rope.{key}"))?;
                rope.group.hold(particle, target);
            }
        }
        self.add_group(&rope.group, Vec::new())
    }

    /// Adds a rectangle of cloth: rows of particles, the first from `corner` along `across`.
    #[wasm_bindgen(js_name = addCloth)]
    pub fn add_cloth(&self, options: ClothOptions) -> Outcome<Particles> {
        let known = ["corner", "across", "down", "columns", "rows", "mass", "hang"];
        let options = Options::of(&options, "cloth", &known)?;
        let corner = options.needed_vec3("corner")?;
        let [across, down] = [options.needed_vec3("across")?, options.needed_vec3("down")?];
        let usual = built(|| ClothDef::sheet(corner, across, down))?;
        let def = ClothDef {
            columns: options.whole("columns")?.unwrap_or(usual.columns),
            rows: options.whole("rows")?.unwrap_or(usual.rows),
            mass: options.number("mass")?.unwrap_or(usual.mass),
            ..usual
        };
        let mut cloth = built(|| def.build())?;
        if let Some(hang) = options.get("hang") {
            let held: Vec<u32> = match hang.as_string().as_deref() {
                Some("firstRow") => cloth.row(0),
                Some(other) => {
                    return Err(Failure(format!(
                        "cloth.hang must be 'firstRow' or numbers of corners, not '{other}'"
                    )));
                }
                None => {
                    let corners = cloth.corners();
                    let corner = |number: u32| corners.get(number as usize).copied();
                    let held: Option<Vec<u32>> =
                        indices(&hang, "cloth.hang")?.into_iter().map(corner).collect();
                    held.ok_or_else(|| Failure::new("cloth.hang names corners by 0, 1, 2 and 3"))?
                }
            };
            built(|| cloth.hang(&held))?;
        }
        let triangles = cloth.group.faces.as_flattened().to_vec();
        self.add_group(&cloth.group, triangles)
    }

    /// Adds a soft ball: an elastic skin filled with air.
    #[wasm_bindgen(js_name = addSoftBall)]
    pub fn add_soft_ball(&self, options: SoftBallOptions) -> Outcome<Particles> {
        let options = Options::of(&options, "ball", &["center", "radius", "mass"])?;
        let (center, radius) = (options.needed_vec3("center")?, options.needed_number("radius")?);
        let usual = built(|| BlobDef::ball(center, radius))?;
        let def = BlobDef { mass: options.number("mass")?.unwrap_or(usual.mass), ..usual };
        let blob = built(|| def.build())?;
        let triangles =
            blob.group.volumes.first().map(|skin| skin.triangles.as_flattened().to_vec()).unwrap_or_default();
        self.add_group(&blob.group, triangles)
    }

    /// Reads the target of an attachment at a position: the world, or the body of an id.
    fn holder(&self, holder: &JsValue, place: Vec3, name: &str) -> Outcome<AttachmentTarget> {
        if holder.as_string().as_deref() == Some("world") {
            return Ok(AttachmentTarget::World(place));
        }
        let bits = id(holder, name)?;
        self.inner.read(|inner| {
            let body = body(&inner.world, bits)?;
            Ok(AttachmentTarget::Body { body, point: inner.world.transform(body).inverse_point(place) })
        })
    }

    fn add_group(&self, def: &GroupDef, triangles: Vec<u32>) -> Outcome<Particles> {
        let group = self.inner.change(|inner| {
            let group = inner.world.add_particles(def);
            let positions =
                inner.world.particles(group).positions().iter().flat_map(|place| place.to_array()).collect();
            inner.groups.push(Drawn { group, positions, view: View::default() });
            Ok(group)
        })?;
        Ok(Particles { inner: self.inner.clone(), group, triangles })
    }
}

fn gone() -> Failure {
    Failure::new("these particles were removed")
}

impl Particles {
    fn ask<R>(&self, call: impl FnOnce(&ParticleGroup) -> R) -> Outcome<R> {
        self.inner.read(|inner| {
            inner.groups.iter().find(|drawn| drawn.group == self.group).ok_or_else(gone)?;
            Ok(call(inner.world.particles(self.group)))
        })
    }

    fn change(&self, particle: u32, call: impl FnOnce(&mut ParticleGroup)) -> Outcome {
        self.inner.change(|inner| {
            inner.groups.iter().find(|drawn| drawn.group == self.group).ok_or_else(gone)?;
            let group = inner.world.particles_mut(self.group);
            let count = group.positions().len();
            if particle as usize >= count {
                return Err(Failure(format!("there is no particle {particle} of {count}")));
            }
            call(group);
            Ok(())
        })
    }
}

#[wasm_bindgen]
impl Particles {
    /// Number of particles.
    #[wasm_bindgen(getter)]
    pub fn count(&self) -> Outcome<usize> {
        self.ask(|group| group.positions().len())
    }

    /// Positions, three numbers for each particle, interpolated between steps. The array is a view of memory: request it again in each
    /// frame.
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Outcome<Float32Array> {
        self.inner.read(|inner| {
            let drawn = inner.groups.iter().find(|drawn| drawn.group == self.group).ok_or_else(gone)?;
            Ok(drawn.view.of(&drawn.positions))
        })
    }

    /// Triangles of the surface, three particle indices each; empty for a rope.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> Vec<u32> {
        self.triangles.clone()
    }

    /// Pushes a particle with an impulse, N·s.
    #[wasm_bindgen(js_name = applyImpulse)]
    pub fn apply_impulse(&self, particle: u32, impulse: Vec3Like) -> Outcome {
        let impulse = vec3(&impulse, "impulse")?;
        self.change(particle, |group| group.apply_impulse(particle, impulse))
    }

    /// Moves a particle.
    #[wasm_bindgen(js_name = setPosition)]
    pub fn set_position(&self, particle: u32, position: Vec3Like) -> Outcome {
        let position = vec3(&position, "position")?;
        self.change(particle, |group| group.set_position(particle, position))
    }

    /// Removes the particles from the world.
    pub fn remove(&self) -> Outcome {
        self.inner.change(|inner| {
            let place = inner.groups.iter().position(|drawn| drawn.group == self.group);
            inner.groups.remove(place.ok_or_else(gone)?);
            inner.world.remove_particles(self.group);
            Ok(())
        })
    }
}
