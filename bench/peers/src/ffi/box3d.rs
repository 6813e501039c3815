//! Safe interface to Box3D.
//!
//! Safety: ids never leave their [`World`], so none is used after or outside it; definitions come from Box3D's own defaults
//! and are borrowed for a call, which copies them.

#![allow(unsafe_code)]

use crate::engine::Unsupported;
use box3d_sys::*;
use core::marker::PhantomData;
use core::ptr;
use sinew::math::{Rotation, Transform, Vec3};
use sinew::physics::MassProperties;
use sinew::physics::ray::Ray;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locked while worlds are created and destroyed: Box3D's table of worlds has no lock of its own.
static WORLDS: Mutex<()> = Mutex::new(());

/// Largest number of corners of a hull (`B3_MAX_HULL_VERTICES`).
const MOST_HULL_CORNERS: i32 = 128;

fn lock_worlds() -> MutexGuard<'static, ()> {
    WORLDS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the version that the library reports.
pub fn version() -> String {
    // SAFETY: takes nothing, returns a value.
    let b3Version { major, minor, revision } = unsafe { b3GetVersion() };
    format!("{major}.{minor}.{revision}")
}

/// A world and all its objects. The index of a body is its index in the order of additions.
pub struct World {
    id: b3WorldId,
    bodies: Vec<b3BodyId>,
    /// Meshes referenced by shapes of the world.
    meshes: Vec<*mut b3MeshData>,
    /// Marks the world as not thread-safe: Box3D does not guarantee concurrent queries.
    not_shared: PhantomData<*const ()>,
}

/// Kind of motion, with the library's own numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Motion {
    Static = b3BodyType_b3_staticBody,
    Kinematic = b3BodyType_b3_kinematicBody,
    Dynamic = b3BodyType_b3_dynamicBody,
}

/// Definition of a body.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    pub motion: Motion,
    pub world_from_body: Transform,
    pub linear_damping: f32,
    pub angular_damping: f32,
    pub gravity_scale: f32,
    pub may_sleep: bool,
}

/// A shape in its body's frame.
#[derive(Clone, Debug)]
pub enum Shape {
    Box { half_extents: Vec3, body_from_box: Transform },
    Sphere { center: Vec3, radius: f32 },
    Capsule { ends: [Vec3; 2], radius: f32 },
    Hull { points: Vec<Vec3> },
    Mesh { vertices: Vec<Vec3>, triangles: Vec<[u32; 3]> },
}

/// Material and filter of a shape.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    pub density: f32,
    pub friction: f32,
    pub restitution: f32,
    /// Rolling resistance as a share of the shape's radius; for a box the radius is a quarter of that of the largest ball
    /// inside.
    pub rolling: f32,
    pub layers: u32,
    pub mask: u32,
    pub group: i32,
}

/// Free directions of a joint, and the torque that resists them. Hinges, cones and twists are about **z** of the joint's
/// frames.
#[derive(Clone, Copy, Debug)]
pub enum Joint {
    Revolute { limit: Option<[f32; 2]>, friction: f32 },
    Spherical { cone: Option<f32>, twist: Option<[f32; 2]>, friction: f32 },
    Weld,
}

impl World {
    /// Creates an empty world with default settings: continuous collision on, 30 Hz contacts, one worker.
    ///
    /// # Panics
    /// If Box3D has no room for another world (it has 128).
    pub fn new(gravity: Vec3) -> Self {
        let _held = lock_worlds();
        // SAFETY: takes nothing, returns a value.
        let mut def = unsafe { b3DefaultWorldDef() };
        def.gravity = vector(gravity);
        // SAFETY: `def` comes from the default and lives through the call; no other world comes or goes meanwhile.
        let id = unsafe { b3CreateWorld(&raw const def) };
        assert!(id.index1 != 0, "Box3D has room for another world");
        Self { id, bodies: Vec::new(), meshes: Vec::new(), not_shared: PhantomData }
    }

    /// Adds a body without shapes; returns its index.
    pub fn add_body(&mut self, body: &Body) -> usize {
        // SAFETY: takes nothing, returns a value.
        let mut def = unsafe { b3DefaultBodyDef() };
        def.type_ = body.motion as b3BodyType;
        def.position = vector(body.world_from_body.translation);
        def.rotation = quaternion(body.world_from_body.rotation);
        def.linearDamping = body.linear_damping;
        def.angularDamping = body.angular_damping;
        def.gravityScale = body.gravity_scale;
        def.enableSleep = body.may_sleep;
        // SAFETY: the world lives as long as `self`; `def` comes from the default and is copied.
        self.bodies.push(unsafe { b3CreateBody(self.id, &raw const def) });
        self.bodies.len() - 1
    }

    /// Adds a shape to a body, whose mass and inertia grow by those of the shape.
    ///
    /// # Errors
    /// If Box3D refuses the hull, which may have at most 128 corners.
    ///
    /// # Panics
    /// If there is no such body, or Box3D refuses the mesh.
    pub fn add_shape(&mut self, body: usize, shape: &Shape, surface: &Surface) -> Result<(), Unsupported> {
        let body = self.bodies[body];
        // SAFETY: takes nothing, returns a value.
        let mut def = unsafe { b3DefaultShapeDef() };
        def.density = surface.density;
        def.baseMaterial.friction = surface.friction;
        def.baseMaterial.restitution = surface.restitution;
        def.baseMaterial.rollingResistance = surface.rolling;
        def.filter = b3Filter {
            categoryBits: surface.layers.into(),
            maskBits: surface.mask.into(),
            groupIndex: surface.group,
        };
        let def = &raw const def;
        match shape {
            &Shape::Box { half_extents: h, body_from_box } => {
                // SAFETY: takes and returns values. Its pointer covers the whole box, into whose arrays the hull at
                // its start reaches by offsets; the library copies it.
                unsafe {
                    let hull = b3MakeTransformedBoxHull(h.x, h.y, h.z, transform(body_from_box));
                    b3CreateHullShape(body, def, (&raw const hull).cast::<b3HullData>());
                }
            }
            &Shape::Sphere { center, radius } => {
                let sphere = b3Sphere { center: vector(center), radius };
                // SAFETY: the body lives as long as the world; `def` and `sphere` are copied.
                unsafe { b3CreateSphereShape(body, def, &raw const sphere) };
            }
            &Shape::Capsule { ends: [a, b], radius } => {
                let capsule = b3Capsule { center1: vector(a), center2: vector(b), radius };
                // SAFETY: as for spheres.
                unsafe { b3CreateCapsuleShape(body, def, &raw const capsule) };
            }
            Shape::Hull { points } => {
                let hull = hull(points)?;
                // SAFETY: the body lives as long as the world; `def` and the hull are copied, so that the hull is
                // destroyed here, once.
                unsafe {
                    b3CreateHullShape(body, def, hull);
                    b3DestroyHull(hull);
                }
            }
            Shape::Mesh { vertices, triangles } => {
                let mesh = mesh(vertices, triangles);
                self.meshes.push(mesh);
                let scale = b3Vec3 { x: 1.0, y: 1.0, z: 1.0 };
                // SAFETY: the body lives as long as the world, the mesh longer: see `drop`.
                unsafe { b3CreateMeshShape(body, def, mesh, scale) };
            }
        }
        Ok(())
    }

    /// Replaces mass, centre and inertia of a body.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn set_mass(&mut self, body: usize, mass: &MassProperties) {
        let [cx, cy, cz] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| vector(mass.inertia * axis));
        let data =
            b3MassData { mass: mass.mass, center: vector(mass.center), inertia: b3Matrix3 { cx, cy, cz } };
        // SAFETY: the body lives as long as the world; the rest is values.
        unsafe { b3Body_SetMassData(self.bodies[body], data) };
    }

    /// Sets velocities of a body: of its centre of mass, and angular in world axes.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn set_velocity(&mut self, body: usize, linear: Vec3, angular: Vec3) {
        let id = self.bodies[body];
        // SAFETY: the body lives as long as the world; the rest is values.
        unsafe {
            b3Body_SetLinearVelocity(id, vector(linear));
            b3Body_SetAngularVelocity(id, vector(angular));
        }
    }

    /// Disables collisions of two bodies.
    ///
    /// # Panics
    /// If there are no such bodies.
    pub fn part(&mut self, bodies: [usize; 2]) {
        let [a, b] = bodies.map(|place| self.bodies[place]);
        // SAFETY: defaults take nothing and return values; both bodies live as long as this world; the definition comes from
        // the defaults and is copied.
        unsafe {
            let mut def = b3DefaultFilterJointDef();
            (def.base.bodyIdA, def.base.bodyIdB) = (a, b);
            b3CreateFilterJoint(self.id, &raw const def);
        }
    }

    /// Joins two bodies, which then do not collide.
    ///
    /// # Panics
    /// If there are no such bodies.
    pub fn add_joint(&mut self, bodies: [usize; 2], frames: [Transform; 2], joint: Joint) {
        let [a, b] = bodies.map(|place| self.bodies[place]);
        let [frame_a, frame_b] = frames.map(transform);
        let attach = |base: &mut b3JointDef| {
            (base.bodyIdA, base.bodyIdB) = (a, b);
            (base.localFrameA, base.localFrameB) = (frame_a, frame_b);
        };
        // SAFETY: defaults take nothing and return values; both bodies live as long as this world; definitions come from
        // the defaults and are copied.
        unsafe {
            match joint {
                Joint::Revolute { limit, friction } => {
                    let mut def = b3DefaultRevoluteJointDef();
                    attach(&mut def.base);
                    // A motor with target velocity 0 is friction.
                    (def.enableMotor, def.maxMotorTorque) = (friction > 0.0, friction);
                    if let Some([lower, upper]) = limit {
                        def.enableLimit = true;
                        (def.lowerAngle, def.upperAngle) = (lower, upper);
                    }
                    b3CreateRevoluteJoint(self.id, &raw const def);
                }
                Joint::Spherical { cone, twist, friction } => {
                    let mut def = b3DefaultSphericalJointDef();
                    attach(&mut def.base);
                    (def.enableMotor, def.maxMotorTorque) = (friction > 0.0, friction);
                    if let Some(half_angle) = cone {
                        def.enableConeLimit = true;
                        def.coneAngle = half_angle;
                    }
                    if let Some([lower, upper]) = twist {
                        def.enableTwistLimit = true;
                        (def.lowerTwistAngle, def.upperTwistAngle) = (lower, upper);
                    }
                    b3CreateSphericalJoint(self.id, &raw const def);
                }
                Joint::Weld => {
                    let mut def = b3DefaultWeldJointDef();
                    attach(&mut def.base);
                    b3CreateWeldJoint(self.id, &raw const def);
                }
            }
        }
    }

    /// Takes one step of `dt` seconds.
    pub fn step(&mut self, dt: f32, substeps: i32) {
        // SAFETY: the world lives as long as `self`, to which there is no other reference now.
        unsafe { b3World_Step(self.id, dt, substeps) }
    }

    /// Returns the pose of a body's origin.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn pose(&self, body: usize) -> Transform {
        // SAFETY: the body lives as long as the world; returns a value.
        let b3Transform { p, q } = unsafe { b3Body_GetTransform(self.bodies[body]) };
        Transform::new(from_vector(p), Rotation::from_xyzw(q.v.x, q.v.y, q.v.z, q.s))
    }

    /// Returns the velocity of a body's centre of mass, and its angular velocity in world axes.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn velocity(&self, body: usize) -> [Vec3; 2] {
        let id = self.bodies[body];
        // SAFETY: the body lives as long as the world; both return values.
        unsafe { [b3Body_GetLinearVelocity(id), b3Body_GetAngularVelocity(id)].map(from_vector) }
    }

    /// Returns the number of awake bodies.
    pub fn awake_bodies(&self) -> usize {
        // SAFETY: the world lives as long as `self`; returns a value.
        let count = unsafe { b3World_GetAwakeBodyCount(self.id) };
        usize::try_from(count).expect("a count is not negative")
    }

    /// Returns true if a ray hits a shape; finds the closest hit. A ray that starts inside a shape does not hit it.
    pub fn meets_ray(&self, ray: &Ray) -> bool {
        // SAFETY: the world lives as long as `self`, which is on one thread; no callback runs; returns values.
        unsafe {
            let filter = b3DefaultQueryFilter();
            b3World_CastRayClosest(self.id, vector(ray.origin), vector(ray.direction), filter).hit
        }
    }
}

impl Drop for World {
    fn drop(&mut self) {
        let _held = lock_worlds();
        // SAFETY: the world is destroyed here, once; no other world comes or goes meanwhile.
        unsafe { b3DestroyWorld(self.id) }
        for &mesh in &self.meshes {
            // SAFETY: made by `mesh`, destroyed here, once, and nothing refers to it any more.
            unsafe { b3DestroyMesh(mesh) }
        }
    }
}

/// Returns the hull of points; the caller destroys it.
fn hull(points: &[Vec3]) -> Result<*mut b3HullData, Unsupported> {
    let points: Vec<_> = points.iter().map(|&point| vector(point)).collect();
    // Box3D would simplify a larger hull, which would be another scene.
    let count = i32::try_from(points.len()).ok().filter(|&count| count <= MOST_HULL_CORNERS);
    let count = count.ok_or_else(|| Unsupported::new("no hulls of more than 128 corners"))?;
    // SAFETY: the count is that of the points, and they live through the call.
    let hull = unsafe { b3CreateHull(points.as_ptr(), count, count) };
    if hull.is_null() { Err(Unsupported::new("a hull that Box3D refuses")) } else { Ok(hull) }
}

/// Returns a mesh of one-sided triangles, counter-clockwise from outside; the caller destroys it.
///
/// # Panics
/// If Box3D refuses the mesh.
fn mesh(vertices: &[Vec3], triangles: &[[u32; 3]]) -> *mut b3MeshData {
    let count = |len: usize| i32::try_from(len).expect("a mesh of a test scene is small");
    let mut points: Vec<_> = vertices.iter().map(|&vertex| vector(vertex)).collect();
    let mut indices: Vec<i32> = triangles.iter().flatten().map(|&index| index.cast_signed()).collect();
    let def = b3MeshDef {
        vertices: points.as_mut_ptr(),
        indices: indices.as_mut_ptr(),
        materialIndices: ptr::null_mut(),
        weldTolerance: 0.0,
        vertexCount: count(points.len()),
        triangleCount: count(triangles.len()),
        weldVertices: false,
        useMedianSplit: false,
        identifyEdges: true,
    };
    // SAFETY: the counts are those of the vertices and indices, and they live through the call, which copies them;
    // null and 0 ask for no list of triangles without area.
    let mesh = unsafe { b3CreateMesh(&raw const def, ptr::null_mut(), 0) };
    assert!(!mesh.is_null(), "Box3D takes the mesh");
    mesh
}

/// Two boxes as point clouds, the second in the frame of the first.
pub struct BoxPair {
    corners: [[b3Vec3; 8]; 2],
    a_from_b: b3Transform,
}

impl BoxPair {
    /// Creates a pair with these half extents and poses.
    pub fn new(half_extents: [Vec3; 2], world_from_box: [Transform; 2]) -> Self {
        let corners = half_extents.map(|half| {
            core::array::from_fn(|i| {
                let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
                vector(half * Vec3::new(sign(1), sign(2), sign(4)))
            })
        });
        let [world_from_a, world_from_b] = world_from_box;
        Self { corners, a_from_b: transform(world_from_a.inverse() * world_from_b) }
    }

    /// Returns the distance, metres; 0 for an overlap. Does not use the library's cache for a pair.
    pub fn distance(&self) -> f32 {
        let proxy = |points: &[b3Vec3; 8]| b3ShapeProxy { points: points.as_ptr(), count: 8, radius: 0.0 };
        let input = b3DistanceInput {
            proxyA: proxy(&self.corners[0]),
            proxyB: proxy(&self.corners[1]),
            transform: self.a_from_b,
            useRadii: false,
        };
        let mut cache = b3SimplexCache::default();
        // SAFETY: both clouds have their stated 8 points and live through the call, as do `input` and
        // `cache`; null and 0 ask for no record of simplexes.
        unsafe { b3ShapeDistance(&raw const input, &raw mut cache, ptr::null_mut(), 0).distance }
    }
}

fn vector(v: Vec3) -> b3Vec3 {
    b3Vec3 { x: v.x, y: v.y, z: v.z }
}

fn from_vector(v: b3Vec3) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}

fn quaternion(r: Rotation) -> b3Quat {
    b3Quat { v: b3Vec3 { x: r.x, y: r.y, z: r.z }, s: r.w }
}

fn transform(t: Transform) -> b3Transform {
    b3Transform { p: vector(t.translation), q: quaternion(t.rotation) }
}
