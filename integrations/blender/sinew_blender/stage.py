"""The world around the character: colliders, moving ones, ground, wind, hits."""

import bpy
import numpy as np

from . import bridge
from . import skeleton as sk
from .skeleton import TO_Y, SinewError

# Largest number of triangles of one collider.
MOST_TRIANGLES = 500_000
# Largest speeds that a hit gives to a whole character and to the struck body, m/s. No body of a simulation is faster than the second.
MOST_SPEED, MOST_BODY_SPEED = 30.0, 4000.0
# Smallest change of a matrix of a moving object, in Blender's unit.
MOVES = 1e-6


def colliders(scene, arms):
    """Objects that the characters collide with: those marked by the user, except the characters' own skins."""
    own = {ob for arm in arms for ob in sk.skins(arm)}
    return [ob for ob in scene.objects if ob.type == "MESH" and ob.sinew_body.collides and ob not in own]


def triangles(ob, to_local):
    """Triangles of the evaluated mesh, Blender's length and Sinew's axes."""
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    me = evaluated.to_mesh()
    try:
        me.calc_loop_triangles()
        if len(me.loop_triangles) == 0:
            raise SinewError(f"{ob.name} has no faces to collide with")
        if len(me.loop_triangles) > MOST_TRIANGLES:
            raise SinewError(f"{ob.name} has {len(me.loop_triangles)} triangles, more than {MOST_TRIANGLES}: use a simpler mesh")
        co = np.empty(len(me.vertices) * 3, np.float32)
        me.vertices.foreach_get("co", co)
        corners = np.empty(len(me.loop_triangles) * 3, np.uint32)
        me.loop_triangles.foreach_get("vertices", corners)
        m = np.array(to_local, np.float64)
        vertices = co.reshape(-1, 3).astype(np.float64) @ m[:3, :3].T + m[:3, 3]
        corners = corners.reshape(-1, 3)
        if to_local.determinant() < 0:
            corners = corners[:, ::-1]
        return vertices, corners
    finally:
        evaluated.to_mesh_clear()


def _is_moving(scene, obs, first, last):
    """Matrices of the objects at every frame, and the moving objects."""
    at, sub = scene.frame_current, scene.frame_subframe
    tracks = {ob: [] for ob in obs}
    animated = [ob for ob in obs if _may_move(ob)]
    try:
        for frame in range(first, last + 1) if animated else ():
            scene.frame_set(frame)
            for ob in animated:
                tracks[ob].append(ob.matrix_world.copy())
    finally:
        if animated:
            scene.frame_set(at, subframe=sub)
    moving = {}
    for ob in animated:
        track = np.array([np.array(m) for m in tracks[ob]])
        if np.abs(track - track[0]).max() > MOVES:
            moving[ob] = tracks[ob]
    return moving


def _may_move(ob):
    while ob is not None:
        if ob.animation_data is not None or ob.constraints or ob.rigid_body is not None:
            return True
        ob = ob.parent
    return False


def world(scene, arms, first, last, fps, unit):
    """Returns the scene's colliders, in metres; `unit`: metres per Blender unit."""
    sinew = bridge.engine()
    made = []
    settings = scene.sinew
    if settings.ground:
        made.append(sinew.Collider.floor(settings.ground_height * unit, friction=settings.ground_friction))
    found = colliders(scene, arms)
    moving = _is_moving(scene, found, first, last)
    for ob in found:
        friction = ob.sinew_body.friction
        if ob not in moving:
            vertices, corners = triangles(ob, TO_Y @ ob.matrix_world)
            made.append(bridge.asked(sinew.Collider.mesh, vertices * unit, corners, friction=friction))
            continue
        # The mesh contains the scale of the first frame; the keys contain position and rotation of each frame.
        track = [sk.to_sinew(m) for m in moving[ob]]
        vertices, corners = triangles(ob, sk.to_sinew(moving[ob][0]).inverted() @ TO_Y @ moving[ob][0])
        shape = bridge.asked(sinew.Collider.mesh, vertices * unit, corners, friction=friction)
        poses = np.array([bridge.pose7(bridge.scaled(m, unit)) for m in track])
        made.append(shape.keyed(np.arange(len(track)) / fps, poses))
    return made


def hardest(arm, definition, bone):
    """The largest impulse on a bone, N·s. A bone without a body belongs to the next one above that has one."""
    masses = {body["bone"]: body["mass"]["kg"] for body in definition["bodies"]}
    at, most = arm.data.bones[bone], MOST_SPEED * sum(masses.values())
    while at is not None and at.name not in masses:
        at = at.parent
    return most if at is None else min(most, MOST_BODY_SPEED * masses[at.name])


def hits(scene, arm, definition, first, fps, notes):
    """Hits of empties on this armature: time in seconds, body, impulse in N·s along the empty's arrow (+Z). Says in `notes` which are
    limited."""
    found = []
    for ob in scene.objects:
        hit = ob.sinew_hit
        if ob.type != "EMPTY" or not hit.enabled or hit.armature not in {arm, None}:
            continue
        if not hit.bone:
            raise SinewError(f"{ob.name} has no bone: choose one in its Sinew panel")
        if hit.bone not in arm.data.bones:
            if hit.armature is None:
                continue
            raise SinewError(f"{ob.name}: {arm.name} has no bone {hit.bone}")
        way = (TO_Y @ ob.matrix_world).to_3x3().col[2].normalized()
        if way.length == 0:
            raise SinewError(f"{ob.name} has no direction: it is scaled to 0")
        if hit.impulse == 0:
            raise SinewError(f"{ob.name} has an impulse of 0 N·s: set Impulse, or disable the hit")
        most = hardest(arm, definition, hit.bone)
        if hit.impulse > most:
            notes.append(f"{ob.name}: {hit.impulse:,.0f} N·s is more than {hit.bone} takes, and was limited to {most:,.0f} N·s")
        found.append(((hit.frame - first) / fps, hit.bone, tuple(way * min(hit.impulse, most))))
    return sorted(found, key=lambda one: one[0])


def wind(scene):
    """Velocity of the wind in m/s and Sinew's axes: of the scene's setting, or none."""
    speed = scene.sinew.wind
    v = TO_Y.to_3x3() @ speed
    return None if v.length == 0 else tuple(v)
