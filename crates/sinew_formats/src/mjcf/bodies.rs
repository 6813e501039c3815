//! Reads the tree of bodies.

use super::compiler::{Compiler, InertiaFrom, ORIENTATIONS, y_up};
use super::defaults::{Classes, Kind, MAIN};
use super::geom::Geom;
use super::joint::Freedom;
use super::notes::Notes;
use super::xml::{Element, Value, children, malformed, unsupported};
use crate::error::{Result, quoted};
use sinew_math::{Rotation, Sym3, Transform, Vec3};
use sinew_physics::{BodyDef, BodyKind, MassProperties, Shape};
use std::collections::BTreeMap;

/// Largest number of bodies of a model, that of the largest joint tree. The number of pairs grows with its square.
pub(crate) const MOST_BODIES: usize = 1024;

/// A body of the file with its position in the tree.
pub(super) struct Link<'a> {
    pub name: String,
    pub element: Element<'a>,
    /// Index of the parent body; the world is its own parent.
    pub parent: usize,
    /// Nearest body, this one or an ancestor, that is not fixed to its parent: 0 for the world.
    pub weld: usize,
    pub freedom: Freedom,
    pub def: BodyDef,
}

/// All bodies, parents before children; the first is the world.
pub(super) struct Tree<'a> {
    pub links: Vec<Link<'a>>,
    by_name: BTreeMap<&'a str, usize>,
}

/// Settings and default classes for reading a document, and its notes.
pub(super) struct Reading<'a, 'n> {
    pub compiler: Compiler,
    pub classes: Classes<'a>,
    pub notes: &'n mut Notes,
}

/// Contents of a `<body>`.
struct Contents<'a> {
    geoms: Vec<Geom>,
    freedom: Freedom,
    inertial: Option<MassProperties>,
    bodies: Vec<Element<'a>>,
}

impl<'a> Tree<'a> {
    /// Reads the tree of a document: the content of its `<worldbody>` elements.
    pub fn read(root: Element<'a>, reading: &mut Reading<'a, '_>) -> Result<Self> {
        let mut tree = Self { links: vec![world(root)], by_name: BTreeMap::from([("world", 0)]) };
        // Uses an explicit stack instead of recursion, so that a deep file cannot overflow the call stack.
        let mut open = Vec::new();
        for (_, element) in children(root).filter(|(tag, _)| *tag == "worldbody") {
            let contents = reading.contents(element, MAIN)?;
            if !matches!(contents.freedom, Freedom::Welded) || contents.inertial.is_some() {
                return Err(malformed(element, "the world has no joints and no mass"));
            }
            tree.links[0].def.shapes.extend(contents.geoms.into_iter().filter_map(|geom| geom.shape));
            open.extend(contents.bodies.into_iter().map(|body| (body, 0, MAIN)));
        }
        open.reverse();
        while let Some((element, parent, inherited)) = open.pop() {
            let class = reading.classes.named_by(element, "childclass", inherited)?;
            let contents = reading.contents(element, class)?;
            let index = tree.links.len();
            if index == MOST_BODIES {
                return Err(unsupported(element, format!("more than {MOST_BODIES} bodies")));
            }
            if let Some(name) = Value::of(element, "name")
                && tree.by_name.insert(name.text(), index).is_some()
            {
                return Err(name.malformed(format!("two bodies are named {}", quoted(name.text()))));
            }
            open.extend(contents.bodies.iter().rev().map(|&body| (body, index, class)));
            let link = tree.link(element, parent, contents, reading)?;
            tree.links.push(link);
        }
        Ok(tree)
    }

    /// Returns the body that an attribute names.
    pub fn named_by(&self, element: Element<'a>, key: &str) -> Result<usize> {
        let name =
            Value::of(element, key).ok_or_else(|| malformed(element, format!("`{key}` is missing")))?;
        let found = self.by_name.get(name.text()).copied();
        found.ok_or_else(|| name.malformed(format!("no body {}", quoted(name.text()))))
    }

    fn link(
        &self,
        element: Element<'a>,
        parent: usize,
        contents: Contents<'a>,
        reading: &Reading<'a, '_>,
    ) -> Result<Link<'a>> {
        let above = &self.links[parent];
        let index = self.links.len();
        let is_mocap = Value::of(element, "mocap").is_some_and(|value| value.text() == "true");
        let moves = !matches!(contents.freedom, Freedom::Welded);
        if matches!(contents.freedom, Freedom::Free) && parent != 0 {
            return Err(malformed(element, "only a body of the world can be free"));
        }
        if is_mocap && (moves || parent != 0) {
            return Err(malformed(element, "`mocap` is for bodies of the world without joints"));
        }
        let kind = match above.def.kind {
            _ if is_mocap => BodyKind::Kinematic,
            _ if moves => BodyKind::Dynamic,
            kind => kind,
        };
        let weld = if moves { index } else { above.weld };
        let placed = reading.pose(element)?;
        let world_from_body = Transform::new(above.def.position, above.def.rotation) * placed;
        let mut def = BodyDef {
            kind,
            position: world_from_body.translation,
            rotation: world_from_body.rotation.normalize(),
            user_data: index as u64,
            ..BodyDef::default()
        };
        if let Some(value) = Value::of(element, "gravcomp") {
            def.gravity_scale = 1.0 - value.number()?;
        }
        if kind == BodyKind::Dynamic {
            def.mass = Some(reading.mass(element, &contents)?);
        }
        def.shapes = contents.geoms.into_iter().filter_map(|geom| geom.shape).collect();
        if kind != BodyKind::Static && def.shapes.iter().any(|shape| shape.shape == Shape::HalfSpace) {
            return Err(unsupported(element, "only static bodies can be planes"));
        }
        let name = element.attribute("name").unwrap_or_default().to_owned();
        Ok(Link { name, element, parent, weld, freedom: contents.freedom, def })
    }
}

/// Returns body 0, the static world.
fn world(root: Element<'_>) -> Link<'_> {
    let def = BodyDef { kind: BodyKind::Static, ..BodyDef::default() };
    Link { name: "world".to_owned(), element: root, parent: 0, weld: 0, freedom: Freedom::Welded, def }
}

impl<'a> Reading<'a, '_> {
    fn contents(&mut self, body: Element<'a>, class: usize) -> Result<Contents<'a>> {
        let mut contents =
            Contents { geoms: Vec::new(), freedom: Freedom::Welded, inertial: None, bodies: Vec::new() };
        for (tag, element) in children(body) {
            match tag {
                "body" => contents.bodies.push(element),
                "geom" => {
                    let geom = self.classes.merge(element, Kind::Geom, class)?;
                    contents.geoms.push(Geom::read(&geom, &self.compiler, self.notes)?);
                }
                "joint" => {
                    let joint = self.classes.merge(element, Kind::Joint, class)?;
                    contents.freedom = contents.freedom.and_joint(&joint, &self.compiler, self.notes)?;
                }
                "freejoint" => {
                    if !matches!(contents.freedom, Freedom::Welded) {
                        return Err(malformed(element, "a free body has no other joints"));
                    }
                    contents.freedom = Freedom::Free;
                }
                "inertial" => contents.inertial = Some(self.inertial(element)?),
                // These elements are only for views.
                "site" | "camera" | "light" => {}
                _ => return Err(unsupported(element, format!("{} in a body is not read", quoted(tag)))),
            }
        }
        Ok(contents)
    }

    /// Returns the frame of a body or of an inertia relative to the enclosing frame.
    fn pose(&self, element: Element<'a>) -> Result<Transform> {
        let position = Value::of(element, "pos").map_or(Ok([0.0; 3]), Value::numbers)?;
        let turned: Vec<_> = ORIENTATIONS.iter().filter_map(|key| Value::of(element, key)).collect();
        let rotation = match turned[..] {
            [] => Rotation::IDENTITY,
            [value] => self.compiler.rotation(value)?,
            [one, two, ..] => return Err(two.malformed(format!("`{}` sets the same", one.key()))),
        };
        Ok(Transform::new(y_up(Vec3::from_array(position)), rotation))
    }

    fn inertial(&self, element: Element<'a>) -> Result<MassProperties> {
        let need = |key: &str| {
            Value::of(element, key).ok_or_else(|| malformed(element, format!("`{key}` is missing")))
        };
        let mass = need("mass")?.not_negative()?;
        let [xx, yy, zz, xy, xz, yz] = match Value::of(element, "fullinertia") {
            Some(value) => value.numbers()?,
            None => {
                let [xx, yy, zz] = need("diaginertia")?.numbers()?;
                [xx, yy, zz, 0.0, 0.0, 0.0]
            }
        };
        // Converts to our axes: our y is the file's z, our z the file's −y.
        let inertia = Sym3 { diagonal: Vec3::new(xx, zz, yy), off: Vec3::new(-yz, -xy, xz) };
        Ok(MassProperties { mass, center: Vec3::ZERO, inertia }.transformed(&self.pose(element)?))
    }

    /// Returns the mass of a dynamic body.
    fn mass(&self, element: Element<'a>, contents: &Contents<'a>) -> Result<MassProperties> {
        let given = contents.inertial.filter(|_| self.compiler.inertia != InertiaFrom::Geoms);
        let mass = match given {
            Some(mass) => mass,
            None if self.compiler.inertia == InertiaFrom::Inertial => {
                return Err(malformed(element, "`inertial` is missing"));
            }
            None => {
                let mut sum = MassProperties::default();
                for geom in &contents.geoms {
                    let unknown =
                        || unsupported(element, "the mass of a shape that is not read is not known");
                    sum = sum.combine(&geom.mass.ok_or_else(unknown)?);
                }
                sum
            }
        };
        check_mass(&mass).map_err(|what| malformed(element, what))?;
        Ok(mass)
    }
}

/// Checks that a solid body can have this mass and inertia.
pub(crate) fn check_mass(mass: &MassProperties) -> core::result::Result<(), &'static str> {
    let moments = mass.inertia.eigen().0;
    // The comparison is false for NaN, so NaN is rejected.
    if !(mass.mass > 0.0 && moments.z > 0.0 && mass.mass.is_finite() && moments.is_finite()) {
        return Err("mass and inertia of a moving body must be positive and finite");
    }
    if moments.x > 1.001 * (moments.y + moments.z) {
        return Err("no solid has this inertia: one moment is larger than the sum of the others");
    }
    if !mass.center.is_finite() {
        return Err("the centre of mass is not finite");
    }
    Ok(())
}
