"""A simulated fall drawn over the user's animation, before anything is keyed. It is kept in memory only and never changes the file's data."""

import json

import bpy
import numpy as np

from . import simulation, stage
from . import skeleton as sk
from .skeleton import TO_Y

# Colours of the skin before the hand-over and after it.
OWN, SIMULATED = (0.55, 0.65, 0.75, 0.35), (1.0, 0.55, 0.15, 0.65)
# Direction of the light in Blender's world, and the share of light on the dark side.
LIGHT, DARK = np.array((0.4, -0.6, 0.7)) / np.linalg.norm((0.4, -0.6, 0.7)), 0.35

_handles = []
# By the armature's name.
_ghosts = {}


class Ghost:
    """The skin of an armature at every frame of a simulation."""

    def __init__(self, arm, loaded, take, fall, stamp):
        names, parents, rest = sk.joint_list(arm, loaded.skeleton)
        self.first, self.handover, self.stamp = take.first, fall.first, stamp
        frames = [dict(frame) for frame in take.frames]
        frames[take.at(fall.first) : take.at(fall.first) + len(fall.frames)] = fall.frames
        inverse = {n: rest[n].inverted() for n in names}
        ends = {n: parents[n] for n in names[len(loaded.skeleton.names) :]}
        back = TO_Y.inverted()
        self.bones = np.array([[back @ (frame[ends.get(n, n)] @ inverse[ends.get(n, n)]) for n in names] for frame in frames])
        meshes = sk.mesh_arrays(arm, loaded.skeleton, names)
        self.triangles = _joined([m["triangles"] for m in meshes], [len(m["positions"]) for m in meshes])
        self.positions, self.joints, self.weights = _skin(meshes, rest, names)
        self.kept = (None, None)

    def vertices(self, frame):
        """Positions of the skin's vertices in Blender's world."""
        frame = min(max(frame - self.first, 0), len(self.bones) - 1)
        if self.kept[0] != frame:
            bones, out = self.bones[frame], np.zeros((len(self.positions), 3))
            for k in range(self.joints.shape[1]):
                m = bones[self.joints[:, k]]
                out += self.weights[:, k, None] * (np.einsum("nij,nj->ni", m[:, :3, :3], self.positions) + m[:, :3, 3])
            self.kept = (frame, out)
        return self.kept[1]

    def colors(self, frame):
        """Colours of the vertices: shaded by their normals."""
        points = self.vertices(frame)
        a, b, c = (points[self.triangles[:, i]] for i in range(3))
        faces, normals = np.cross(b - a, c - a), np.zeros_like(points)
        for i in range(3):
            np.add.at(normals, self.triangles[:, i], faces)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        light = DARK + (1.0 - DARK) * np.clip(normals @ LIGHT, 0.0, 1.0)
        color = SIMULATED if frame >= self.handover else OWN
        return np.column_stack([light[:, None] * np.array(color[:3]), np.full(len(points), color[3])]).astype(np.float32)


def _joined(triangles, counts):
    starts = np.cumsum([0, *counts[:-1]])
    return np.concatenate([t.astype(np.int64) + s for t, s in zip(triangles, starts)]).astype(np.int32)


def _skin(meshes, rest, names):
    """Positions at rest, joints and weights of all vertices; a mesh on a single joint moves with that."""
    positions, joints, weights = [], [], []
    for m in meshes:
        count, at = len(m["positions"]), m["positions"]
        if "joint" in m:
            own = np.array(rest[names[m["joint"]]])
            at = at @ own[:3, :3].T + own[:3, 3]
            joints.append(np.full((count, sk.INFLUENCES), m["joint"]))
            weights.append(np.tile([1.0, *[0.0] * (sk.INFLUENCES - 1)], (count, 1)))
        else:
            total = m["weights"].sum(1, keepdims=True)
            joints.append(m["joints"].astype(np.int64))
            weights.append(m["weights"] / np.where(total > 0, total, 1.0))
        positions.append(at)
    return np.concatenate(positions), np.concatenate(joints), np.concatenate(weights)


def stamp(scene, arm):
    """A text that changes with the settings of the simulation, the ragdoll, the hits and the colliders."""
    settings = scene.sinew
    found = [arm.sinew.definition, scene.frame_start, scene.frame_end, tuple(scene.gravity)]
    for name in settings.bl_rna.properties.keys():
        value = getattr(settings, name)
        if name != "overrides":
            found.append(tuple(value) if name == "wind" else str(value))
    for ob in scene.objects:
        hit = ob.sinew_hit
        if ob.type == "EMPTY" and hit.enabled:
            found.append((ob.name, hit.bone, hit.frame, hit.impulse, [tuple(row) for row in ob.matrix_world]))
    found += [(ob.name, ob.sinew_body.friction) for ob in stage.colliders(scene, [arm])]
    return json.dumps(found, default=str)


def show(job):
    """Keeps the result of a simulation for drawing."""
    scene = bpy.context.scene
    for arm, loaded, take, fall in zip(job.arms, job.loaded, job.takes, simulation.falls_of(job)):
        _ghosts[arm.name] = Ghost(arm, loaded, take, fall, stamp(scene, arm))


def of(arm):
    """The preview of an armature, or None."""
    return _ghosts.get(arm.name)


def clear(arm):
    _ghosts.pop(arm.name, None)


def draw():
    import gpu
    from gpu_extras.batch import batch_for_shader

    context = bpy.context
    if not _ghosts or context.space_data is None or not context.space_data.overlay.show_overlays:
        return
    shader = gpu.shader.from_builtin("SMOOTH_COLOR" if bpy.app.version >= (4, 0) else "3D_SMOOTH_COLOR")
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(True)
    frame = context.scene.frame_current
    for name, ghost in list(_ghosts.items()):
        arm = bpy.data.objects.get(name)
        if arm is None or not arm.sinew.definition:
            del _ghosts[name]
        elif arm.visible_get():
            content = {"pos": ghost.vertices(frame).astype(np.float32), "color": ghost.colors(frame)}
            batch_for_shader(shader, "TRIS", content, indices=ghost.triangles).draw(shader)
    gpu.state.depth_mask_set(False)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


@bpy.app.handlers.persistent
def forget(*_):
    _ghosts.clear()


def register():
    bpy.app.handlers.load_pre.append(forget)
    if not bpy.app.background:
        _handles.append(bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_VIEW"))


def unregister():
    bpy.app.handlers.load_pre.remove(forget)
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    _ghosts.clear()
