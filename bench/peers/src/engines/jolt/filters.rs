//! Collision filters: layers of Jolt from our filters, groups of Jolt from joints.

use super::refused;
use crate::engine::Unsupported;
use oxijolt::{
    BroadPhaseLayer, CollisionGroup, CollisionLayers, GroupFilterTable, GroupFilterTableBuilder, ObjectLayer,
};
use sinew::physics::{BodyDef, BodyKind, Filter};
use sinew_scenes::blueprint::Blueprint;
use std::collections::BTreeMap;

/// Filter of the bodies of one layer of Jolt.
#[derive(Clone, Copy, PartialEq)]
struct Kind {
    filter: Filter,
    is_static: bool,
}

/// Index of a body in a group of bodies, some pairs of which do not collide.
#[derive(Clone)]
struct Member {
    table: GroupFilterTable,
    group: u32,
    place: u32,
}

/// Layers and groups of all bodies of a scene.
pub struct Filters {
    kinds: Vec<Kind>,
    kind_of: Vec<usize>,
    members: Vec<Option<Member>>,
}

impl Filters {
    /// Creates the filters of a scene.
    ///
    /// # Errors
    /// If a body's shapes have different filters, or more jointed bodies are connected than Jolt's tables hold.
    pub fn new(scene: &Blueprint) -> Result<Self, Unsupported> {
        let mut kinds: Vec<Kind> = Vec::new();
        let mut kind_of = Vec::with_capacity(scene.bodies.len());
        for def in &scene.bodies {
            let kind = Kind { filter: filter(def)?, is_static: def.kind == BodyKind::Static };
            let found = kinds.iter().position(|&known| known == kind);
            kind_of.push(found.unwrap_or(kinds.len()));
            if found.is_none() {
                kinds.push(kind);
            }
        }
        let mut filters = Self { kinds, kind_of, members: vec![None; scene.bodies.len()] };
        filters.keep_jointed_apart(scene)?;
        Ok(filters)
    }

    /// Returns all layers: one for each kind.
    pub fn layers(&self) -> CollisionLayers {
        let mut layers = CollisionLayers::new(2);
        for kind in &self.kinds {
            layers.add_object_layer(if kind.is_static {
                BroadPhaseLayer::NON_MOVING
            } else {
                BroadPhaseLayer::MOVING
            });
        }
        for (i, j) in (0..self.kinds.len()).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            if self.kinds_meet(i, j) {
                layers.enable_collision(ObjectLayer::new(i as u32), ObjectLayer::new(j as u32));
            }
        }
        layers
    }

    /// Returns the layer of a body.
    pub fn layer(&self, body: usize) -> ObjectLayer {
        ObjectLayer::new(self.kind_of[body] as u32)
    }

    /// Returns the group of a body, if the body needs one.
    pub fn group(&self, body: usize) -> Option<Result<CollisionGroup, Unsupported>> {
        let member = self.members[body].as_ref()?;
        Some(CollisionGroup::new(&member.table, member.group, member.place).map_err(refused))
    }

    fn kinds_meet(&self, i: usize, j: usize) -> bool {
        let (a, b) = (self.kinds[i], self.kinds[j]);
        !(a.is_static && b.is_static) && a.filter.meets(b.filter)
    }

    /// Puts each set of bodies connected by joints into a group, in which jointed pairs and disabled ones do not
    /// collide. Equal groups, such as ragdolls, share a table. Bodies that would not collide in any case need
    /// none.
    fn keep_jointed_apart(&mut self, scene: &Blueprint) -> Result<(), Unsupported> {
        let meet = |pair: &[usize; 2]| self.kinds_meet(self.kind_of[pair[0]], self.kind_of[pair[1]]);
        let jointed = scene.joints.iter().map(|joint| [joint.a, joint.b]);
        let apart = scene.apart.iter().map(|&(a, b)| [a, b]);
        let pairs: Vec<_> = jointed.chain(apart).filter(meet).collect();
        let mut tables: BTreeMap<(u32, Vec<[u32; 2]>), GroupFilterTable> = BTreeMap::new();
        for (group, bodies) in connected(scene.bodies.len(), &pairs).into_iter().enumerate() {
            let place = |body: usize| bodies.binary_search(&body).ok().map(|place| place as u32);
            let apart: Vec<[u32; 2]> =
                pairs.iter().filter_map(|pair| Some([place(pair[0])?, place(pair[1])?])).collect();
            let size = bodies.len() as u32;
            let table = match tables.get(&(size, apart.clone())) {
                Some(table) => table.clone(),
                None => {
                    let table = table(size, &apart)?;
                    tables.insert((size, apart), table.clone());
                    table
                }
            };
            for (place, &body) in (0..).zip(&bodies) {
                self.members[body] = Some(Member { table: table.clone(), group: group as u32, place });
            }
        }
        Ok(())
    }
}

/// Returns the filter of all of a body's shapes; a body without shapes collides with nothing.
fn filter(def: &BodyDef) -> Result<Filter, Unsupported> {
    let Some(first) = def.shapes.first() else {
        return Ok(Filter { layers: 0, mask: 0, group: 0 });
    };
    if def.shapes.iter().all(|shape| shape.filter == first.filter) {
        Ok(first.filter)
    } else {
        Err(Unsupported::new("a body whose shapes meet different layers"))
    }
}

fn table(size: u32, apart: &[[u32; 2]]) -> Result<GroupFilterTable, Unsupported> {
    let mut builder = GroupFilterTableBuilder::new(size).map_err(refused)?;
    for &[a, b] in apart {
        builder.disable_collision(a, b).map_err(refused)?;
    }
    Ok(builder.build())
}

/// Returns the sets of two or more of `count` items that `pairs` connect, each ascending.
fn connected(count: usize, pairs: &[[usize; 2]]) -> Vec<Vec<usize>> {
    let mut parent: Vec<usize> = (0..count).collect();
    let root = |parent: &[usize], mut of: usize| {
        while parent[of] != of {
            of = parent[of];
        }
        of
    };
    for &[a, b] in pairs {
        let (a, b) = (root(&parent, a), root(&parent, b));
        // The smaller index becomes the root: sets are in the order of their first members.
        parent[a.max(b)] = a.min(b);
    }
    let mut sets: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for thing in 0..count {
        sets.entry(root(&parent, thing)).or_default().push(thing);
    }
    sets.into_values().filter(|set| set.len() > 1).collect()
}
