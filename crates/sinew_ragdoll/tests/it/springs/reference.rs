//! The reference algorithm of VRMC_springBone 1.0 with its extended colliders, implemented from the specification in
//! double precision, for rigs without scale. Limits follow their draft: after inertia and after every collider.

use glam::{DMat3, DQuat, DVec3};
use sinew_anim::springs::{ColliderShape, LimitKind, Side};
use sinew_anim::{Rig, SpringBone, Springs};
use sinew_math::{Rotation, Transform, Vec3};

pub struct Reference {
    joints: Vec<(Option<usize>, DVec3, DQuat)>,
    springs: Springs,
    /// Current and previous tail of each bone, in the order of the chains, in the centre's space.
    tails: Vec<(DVec3, DVec3)>,
    /// World position and rotation of every joint.
    world: Vec<(DVec3, DQuat)>,
    shown: Vec<DVec3>,
}

fn d(v: Vec3) -> DVec3 {
    v.as_dvec3()
}

fn q(r: Rotation) -> DQuat {
    DQuat::from_xyzw(r.x.into(), r.y.into(), r.z.into(), r.w.into()).normalize()
}

impl Reference {
    pub fn new(rig: &Rig, springs: &Springs, place: Transform) -> Self {
        let joints = rig.joints.iter();
        let joints = joints.map(|j| (j.parent, d(j.rest.translation), q(j.rest.rotation))).collect();
        let mut it = Self {
            joints,
            springs: springs.clone(),
            tails: Vec::new(),
            world: Vec::new(),
            shown: Vec::new(),
        };
        it.pose(place);
        for chain in &springs.chains {
            for bone in &chain.bones {
                let (at, turn) = it.world[bone.joint];
                let tail = it.seen_from_center(chain.center, at + turn * d(bone.tail));
                it.tails.push((tail, tail));
            }
        }
        it
    }

    pub fn tips(&self) -> &[DVec3] {
        &self.shown
    }

    fn pose(&mut self, place: Transform) {
        self.world.clear();
        for &(parent, at, turn) in &self.joints {
            let (from, by) = parent.map_or((d(place.translation), q(place.rotation)), |p| self.world[p]);
            self.world.push((from + by * at, by * turn));
        }
    }

    fn seen_from_center(&self, center: Option<usize>, point: DVec3) -> DVec3 {
        center.map_or(point, |c| self.world[c].1.inverse() * (point - self.world[c].0))
    }

    fn in_world(&self, center: Option<usize>, point: DVec3) -> DVec3 {
        center.map_or(point, |c| self.world[c].0 + self.world[c].1 * point)
    }

    /// Updates all springs once.
    pub fn frame(&mut self, place: Transform, delta_time: f64) {
        self.pose(place);
        self.shown.clear();
        let springs = self.springs.clone();
        let mut index = 0;
        for chain in &springs.chains {
            for bone in &chain.bones {
                let (parent, at, rest) = self.joints[bone.joint];
                let (from, by) = self.world[parent.expect("hair has a parent")];
                let world_position = from + by * at;
                let local = by * rest;
                let axis = d(bone.tail).normalize();
                let length = d(bone.tail).length();
                let (current, previous) = self.tails[index];
                let current = self.in_world(chain.center, current);
                let previous = self.in_world(chain.center, previous);
                let inertia = (current - previous) * (1.0 - f64::from(bone.drag));
                let stiffness = delta_time * (local * axis) * f64::from(bone.stiffness);
                let external = delta_time * d(bone.gravity);
                let hold = |tail: DVec3| {
                    let direction = local.inverse() * (tail - world_position).normalize();
                    world_position + local * limited(bone, axis, direction) * length
                };
                let mut next = hold(current + inertia + stiffness + external);
                for &collider in &chain.colliders {
                    let collider = &springs.colliders[collider];
                    let (direction, distance) =
                        self.collide(collider.joint, &collider.shape, next, bone.radius);
                    if distance < 0.0 {
                        next = hold(next - direction * distance);
                    }
                }
                self.tails[index] =
                    (self.seen_from_center(chain.center, next), self.seen_from_center(chain.center, current));
                let to = local.inverse() * (next - world_position).normalize();
                self.world[bone.joint] = (world_position, local * DQuat::from_rotation_arc(axis, to));
                // Update the descendants.
                for joint in bone.joint + 1..self.joints.len() {
                    let (parent, at, turn) = self.joints[joint];
                    if let Some(parent) = parent.filter(|&p| p >= bone.joint) {
                        let (from, by) = self.world[parent];
                        self.world[joint] = (from + by * at, by * turn);
                    }
                }
                self.shown.push(next);
                index += 1;
            }
        }
    }

    fn collide(&self, joint: usize, shape: &ColliderShape, next: DVec3, radius: f32) -> (DVec3, f64) {
        let (at, turn) = self.world[joint];
        let point = |p: Vec3| at + turn * d(p);
        let radius = f64::from(radius);
        let round = |delta: DVec3, own: f32, keeps: Side| match keeps {
            Side::Outside => (delta.normalize(), delta.length() - f64::from(own) - radius),
            Side::Inside => (-delta.normalize(), f64::from(own) - radius - delta.length()),
        };
        match *shape {
            ColliderShape::Sphere { offset, radius: own, keeps } => round(next - point(offset), own, keeps),
            ColliderShape::Capsule { offset, tail, radius: own, keeps } => {
                let offset_to_tail = point(tail) - point(offset);
                let mut delta = next - point(offset);
                let dot = offset_to_tail.dot(delta);
                if dot > offset_to_tail.length_squared() {
                    delta -= offset_to_tail;
                } else if dot >= 0.0 {
                    delta -= offset_to_tail * (dot / offset_to_tail.length_squared());
                }
                round(delta, own, keeps)
            }
            ColliderShape::Plane { offset, normal } => {
                let normal = turn * d(normal);
                (normal, (next - point(offset)).dot(normal) - radius)
            }
        }
    }
}

fn limited(bone: &SpringBone, axis: DVec3, direction: DVec3) -> DVec3 {
    let Some(limit) = bone.limit else { return direction };
    let frame = DMat3::from_quat(DQuat::from_rotation_arc(DVec3::Y, axis) * q(limit.rotation));
    let v = frame.transpose() * direction;
    let held = match limit.kind {
        LimitKind::Cone { angle } => {
            let angle = f64::from(angle);
            let off = v.angle_between(DVec3::Y);
            if off <= angle {
                v
            } else {
                DQuat::from_axis_angle(DVec3::Y.cross(v).normalize(), angle) * DVec3::Y
            }
        }
        LimitKind::Hinge { angle } => {
            let turn = v.z.atan2(v.y).clamp(-f64::from(angle), f64::from(angle));
            DVec3::new(0.0, turn.cos(), turn.sin())
        }
        LimitKind::Spherical { phi, theta } => {
            let (phi, theta) = (f64::from(phi), f64::from(theta));
            let turn = v.z.atan2(v.y).clamp(-phi, phi);
            let rise = v.x.clamp(-1.0, 1.0).asin().clamp(-theta, theta);
            DQuat::from_rotation_x(turn) * DVec3::new(rise.sin(), rise.cos(), 0.0)
        }
    };
    (frame * held).normalize()
}
