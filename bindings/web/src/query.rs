//! Queries of a world.

use crate::border::{Failure, Outcome};
use crate::definitions::{KINDS, probe_shape};
use crate::types::{HitOut, Hits, QuatLike, QueryOptions, ShapeOptions, Vec3Like};
use crate::values::{Options, id, object, rotation, vec3, vector};
use crate::world::World;
use js_sys::Array;
use sinew::math::{Rotation, Transform};
use sinew::physics::ray::Ray;
use sinew::physics::{
    BodyHit, BodyId, BodyKinds, Filter, OverlapWith, Probe, QueryFilter, QueryKind, Sensors, ShapeCast,
};
use wasm_bindgen::prelude::*;

/// Filter of a query.
struct Asked {
    meets: Filter,
    kinds: BodyKinds,
    sensors: Sensors,
    except: Vec<BodyId>,
}

impl Asked {
    fn read(value: Option<QueryOptions>) -> Outcome<Self> {
        let value: JsValue = value.map(JsValue::from).unwrap_or_default();
        let options = Options::of(&value, "options", &["mask", "kinds", "sensors", "except"])?;
        let default = QueryFilter::default();
        let mut kinds = default.kinds;
        if let Some(listed) = options.get("kinds") {
            let mut chosen: Option<BodyKinds> = None;
            for word in Array::from(&listed) {
                let found = KINDS.iter().find(|(name, _)| word.as_string().as_deref() == Some(*name));
                let (_, kind) =
                    found.ok_or_else(|| Failure::new("options.kinds holds dynamic, static or kinematic"))?;
                let kind = BodyKinds::from(*kind);
                chosen = Some(chosen.map_or(kind, |chosen| chosen | kind));
            }
            kinds = chosen.ok_or_else(|| Failure::new("options.kinds must hold at least one kind"))?;
        }
        let mut except = Vec::new();
        if let Some(listed) = options.get("except") {
            for one in Array::from(&listed) {
                except.push(BodyId::from_bits(id(&one, "options.except")?));
            }
        }
        let mask = options.whole("mask")?.unwrap_or(default.meets.mask);
        let sensors = match options.flag("sensors")? {
            Some(true) => Sensors::Included,
            _ => Sensors::Ignored,
        };
        Ok(Self { meets: Filter { mask, ..default.meets }, kinds, sensors, except })
    }

    fn filter(&self) -> QueryFilter<'_> {
        QueryFilter { meets: self.meets, kinds: self.kinds, sensors: self.sensors, except: &self.except }
    }
}

fn hit(hit: &BodyHit) -> JsValue {
    object([
        ("body", hit.body.to_bits().into()),
        ("shape", hit.shape.into()),
        ("fraction", hit.fraction.into()),
        ("point", vector(hit.point)),
        ("normal", vector(hit.normal)),
    ])
}

fn ray(origin: &Vec3Like, way: &Vec3Like) -> Outcome<Ray> {
    Ok(Ray { origin: vec3(origin, "origin")?, direction: vec3(way, "way")? })
}

fn probe(shape: &ShapeOptions, position: &Vec3Like, turn: Option<QuatLike>) -> Outcome<Probe> {
    let rotation = turn.map(|turn| rotation(&turn, "rotation")).transpose()?.unwrap_or(Rotation::IDENTITY);
    Ok(Probe::new(probe_shape(shape)?, Transform::new(vec3(position, "position")?, rotation)))
}

impl World {
    fn first(
        &self,
        question: &impl QueryKind<Answer = BodyHit>,
        options: Option<QueryOptions>,
    ) -> Outcome<Option<HitOut>> {
        let asked = Asked::read(options)?;
        self.inner.read(|inner| {
            let first = inner.world.query().filter(asked.filter()).first(question);
            Ok(first.map(|first| hit(&first).unchecked_into()))
        })
    }
}

#[wasm_bindgen]
impl World {
    /// Returns the first hit of a ray from `origin` along `way`, whose length is that of the ray; `undefined`
    /// without a hit.
    #[wasm_bindgen(js_name = castRay)]
    pub fn cast_ray(
        &self,
        origin: Vec3Like,
        way: Vec3Like,
        options: Option<QueryOptions>,
    ) -> Outcome<Option<HitOut>> {
        self.first(&ray(&origin, &way)?, options)
    }

    /// Returns all hits of a ray in order, one per shape.
    #[wasm_bindgen(js_name = castRayAll)]
    pub fn cast_ray_all(
        &self,
        origin: Vec3Like,
        way: Vec3Like,
        options: Option<QueryOptions>,
    ) -> Outcome<Hits> {
        let (ray, asked) = (ray(&origin, &way)?, Asked::read(options)?);
        self.inner.read(|inner| {
            let mut hits = Vec::new();
            inner.world.query().filter(asked.filter()).all(&ray, &mut hits);
            Ok(JsValue::from(hits.iter().map(hit).collect::<Array>()).unchecked_into())
        })
    }

    /// Returns the first hit of a shape that moves along `way` from a pose.
    #[wasm_bindgen(js_name = castShape)]
    pub fn cast_shape(
        &self,
        shape: ShapeOptions,
        position: Vec3Like,
        way: Vec3Like,
        turn: Option<QuatLike>,
        options: Option<QueryOptions>,
    ) -> Outcome<Option<HitOut>> {
        let (probe, way) = (probe(&shape, &position, turn)?, vec3(&way, "way")?);
        self.first(&ShapeCast { probe, translation: way }, options)
    }

    /// Returns the ids of the bodies that a shape at a pose would overlap, ascending.
    pub fn overlap(
        &self,
        shape: ShapeOptions,
        position: Vec3Like,
        turn: Option<QuatLike>,
        options: Option<QueryOptions>,
    ) -> Outcome<Vec<u64>> {
        let (probe, asked) = (probe(&shape, &position, turn)?, Asked::read(options)?);
        self.inner.read(|inner| {
            let mut bodies = Vec::new();
            inner.world.query().filter(asked.filter()).bodies(&OverlapWith(probe), &mut bodies);
            bodies.sort_unstable();
            Ok(bodies.iter().map(|body| body.to_bits()).collect())
        })
    }
}
