//! Bodies that forces move become bodies that move by themselves, and back.

use crate::body::def::BodyKind;
use crate::id::BodyId;
use crate::world::World;
use sinew_math::Vec3;

impl World {
    /// Makes a dynamic body kinematic, or dynamic again; it wakes, and so does what touches it or hangs on it. Pose and
    /// velocity stay: what comes back to forces goes on as fast as it was led. While it is kinematic it has no mass; what it
    /// has then is that of before. Joints between two bodies that no force moves do nothing.
    ///
    /// # Panics
    /// If the body is or is to be static, or was made kinematic.
    #[track_caller]
    pub fn set_kind(&mut self, id: BodyId, kind: BodyKind) {
        let body = self.expect_mut(id);
        if body.kind == kind {
            return;
        }
        assert!(
            kind != BodyKind::Static && body.kind != BodyKind::Static,
            "what never moves stays what it is"
        );
        let weight = match body.laid_by {
            Some(weight) => weight,
            None => {
                assert!(body.kind == BodyKind::Dynamic, "only what was made dynamic can be so again");
                (body.mass, body.inertia)
            }
        };
        self.stir(id);
        let body = self.bodies.at_mut(id.index);
        body.kind = kind;
        (body.force, body.torque) = (Vec3::ZERO, Vec3::ZERO);
        (body.mass, body.inertia, body.laid_by) = match kind {
            BodyKind::Dynamic => (weight.0, weight.1, None),
            BodyKind::Kinematic | BodyKind::Static => (0.0, Vec3::ZERO, Some(weight)),
        };
        self.activity.change_kind(id.index, self.bodies.at(id.index));
        self.broad.proxies.refresh(id.index, self.bodies.at(id.index));
    }
}
