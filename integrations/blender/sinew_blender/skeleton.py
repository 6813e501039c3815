"""The deform skeleton: its bones, their hierarchy and their skin, independent of the rig around them."""

import json
import math
import re
from dataclasses import dataclass, field

import bpy
import numpy as np
from mathutils import Matrix

# Rotation from Blender's Z up to Sinew's Y up.
TO_Y = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
# Largest number of influences of a vertex.
INFLUENCES = 4
# Half width of the tube that replaces the skin of a bone without any, as a share of the bone's length.
TUBE = 0.18
# Name of joints that mark the ends of chains, for the direction of the last bone.
END = "_end"
# Constraints that make a deform bone follow a bone of the rig's mechanism.
FOLLOWS = {"COPY_TRANSFORMS", "COPY_ROTATION", "ARMATURE", "DAMPED_TRACK", "COPY_LOCATION"}


class SinewError(Exception):
    """An error message for the user, in one sentence."""


@dataclass
class Skeleton:
    """Deform bones of an armature, parents first."""

    names: list
    parent: dict
    meshes: list = field(default_factory=list)


def plain(name):
    """The name without the prefix of Rigify's layers."""
    return re.sub(r"^(DEF|ORG|MCH)-", "", name)


def check(arm):
    """Raises if an armature cannot be used."""
    if arm is None or arm.type != "ARMATURE":
        raise SinewError("Select an armature first")
    if not arm.data.bones:
        raise SinewError(f"{arm.name} has no bones")
    if arm.library is not None or arm.data.library is not None and arm.override_library is None:
        raise SinewError(
            f"{arm.name} is linked from {(arm.library or arm.data.library).filepath}: make a library override "
            "(Object > Library Override > Make) and work on that"
        )
    scale = arm.matrix_world.to_scale()
    if min(abs(s) for s in scale) < 1e-9:
        raise SinewError(f"{arm.name} is scaled to nothing")
    if arm.matrix_world.determinant() < 0:
        raise SinewError(f"{arm.name} is mirrored by a negative scale: apply its scale (Ctrl+A) first")


def skins(arm):
    """Meshes moved by the armature, by a modifier or by a parent bone."""
    found = []
    for ob in bpy.context.scene.objects:
        if ob.type != "MESH" or len(ob.data.vertices) == 0:
            continue
        by_modifier = any(m.type == "ARMATURE" and m.object == arm for m in ob.modifiers)
        by_parent = ob.parent == arm and ob.parent_type in {"ARMATURE", "BONE"}
        if by_modifier or by_parent:
            found.append(ob)
    # Hidden meshes are not part of the character, unless all of it is hidden.
    return [ob for ob in found if ob.visible_get()] or found


def skeleton_of(arm):
    """The deform bones that have skin, each below the deform bone that carries it, also where the rig's own hierarchy goes
    through bones of a mechanism."""
    check(arm)
    bones = arm.data.bones
    meshes = skins(arm)
    used = {g.name for ob in meshes if ob.parent_type != "BONE" for g in ob.vertex_groups}
    used |= {ob.parent_bone for ob in meshes if ob.parent_type == "BONE"}
    carry = {ob.parent_bone for ob in meshes if ob.parent_type == "BONE"}
    deform = [b.name for b in bones if b.name in used and (b.use_deform or b.name in carry)]
    if not deform:
        deform = [b.name for b in bones if b.use_deform] or [b.name for b in bones]
    deform += _carriers(bones, deform)
    parent = _parents(arm, deform)
    return Skeleton(_ordered(deform, parent), parent, meshes)


def _carriers(bones, deform):
    """Deform bones without skin between two with skin: their motion is part of the chain."""
    kept, more = set(deform), []
    for name in deform:
        chain, at = [], bones[name].parent
        while at is not None and at.name not in kept:
            chain.append(at)
            at = at.parent
        if at is None:
            continue
        for between in chain:
            if between.use_deform and between.name not in kept:
                kept.add(between.name)
                more.append(between.name)
    return more


def _parents(arm, deform):
    bones, kept = arm.data.bones, set(deform)
    twin, by_plain = {}, {}
    for name in deform:
        by_plain.setdefault(plain(name), name)
        for c in arm.pose.bones[name].constraints:
            sub = getattr(c, "subtarget", "")
            if sub and c.type in FOLLOWS and sub not in kept:
                twin.setdefault(sub, name)
    parent = {n: bones[n].parent.name for n in deform if bones[n].parent is not None and bones[n].parent.name in kept}

    def is_below(name, top):
        while name is not None and name != top:
            name = parent.get(name)
        return name == top

    def above(name):
        # Searches upward from the ORG bone of the same name, as in Rigify, else from the bone's own parent.
        org = bones.get("ORG-" + plain(name))
        starts = [org.parent] if org is not None and org.parent is not None else []
        for at in (*starts, bones[name].parent):
            while at is not None:
                by_name = by_plain.get(plain(at.name)) if at.name.startswith("ORG-") else None
                for found in (at.name if at.name in kept else None, by_name, twin.get(at.name)):
                    if found and not is_below(found, name):
                        return found
                at = at.parent
        return None

    for name in deform:
        if name not in parent:
            parent[name] = above(name)
    return parent


def _ordered(deform, parent):
    order, seen = [], set()
    for name in deform:
        chain = []
        while name is not None and name not in seen:
            seen.add(name)
            chain.append(name)
            name = parent[name]
        order.extend(reversed(chain))
    return order


def unscaled(matrix):
    """Position and rotation of a matrix, without scale and shear."""
    return Matrix.Translation(matrix.translation) @ matrix.to_quaternion().to_matrix().to_4x4()


def unit_of_scene():
    """Metres per unit of Blender."""
    return bpy.context.scene.unit_settings.scale_length


def to_sinew(matrix):
    """A matrix of Blender's world, in Blender's length and Sinew's axes, without scale."""
    return unscaled(TO_Y @ matrix)


def is_driven(arm, names):
    """True if constraints or drivers on these bones would override keys."""
    for name in names:
        if any(not c.mute and c.name != "Sinew" for c in arm.pose.bones[name].constraints):
            return True
    return bool(_driver_paths(arm, names))


def carriers(arm, names):
    """Ancestors of these bones that are not among them: they keep the user's animation."""
    kept = set(names)
    parents = {arm.data.bones[n].parent.name for n in names if arm.data.bones[n].parent is not None}
    return sorted(parents - kept)


def _driver_paths(arm, names):
    drivers = arm.animation_data.drivers if arm.animation_data else ()
    return [d for d in drivers if any(f'pose.bones["{n}"]' in d.data_path and "sinew" not in d.data_path for n in names)]


# ---- arrays for Sinew


def place_of(arm):
    """Rest placement of the armature in Sinew: that of the build, wherever the armature moved since."""
    return matrix_from(arm.sinew.place) if arm.sinew.place else straight(arm.matrix_world)


def straight(matrix):
    """The matrix at the origin, turned about the vertical so that it is as near to the axes as it can be: there a character faces along
    an axis, as rigs do."""
    turn = matrix.to_quaternion().to_matrix()
    column = max(turn.col, key=lambda c: c.xy.length)
    angle = math.atan2(column.y, column.x)
    off = angle - round(angle / (math.pi / 2)) * (math.pi / 2)
    out = Matrix.Rotation(-off, 4, "Z") @ matrix
    out.translation = (0, 0, 0)
    return out


def matrix_from(text):
    numbers = json.loads(text)
    return Matrix([numbers[4 * i : 4 * i + 4] for i in range(4)])


def text_of(matrix):
    return json.dumps([x for row in matrix for x in row])


def rest_matrices(arm, skeleton):
    world = place_of(arm)
    return {n: to_sinew(world @ arm.data.bones[n].matrix_local) for n in skeleton.names}


def joint_list(arm, skeleton):
    """Names of joints, followed by those of chain ends; their parents; and the rest pose in Sinew's axes."""
    names, rest = list(skeleton.names), rest_matrices(arm, skeleton)
    parents = dict(skeleton.parent)
    carries = {p for p in parents.values() if p}
    for n in skeleton.names:
        if n not in carries:
            end = n + END
            tail = place_of(arm) @ arm.data.bones[n].tail_local
            rest[end] = rest[n].copy()
            rest[end].translation = TO_Y @ tail
            parents[end] = n
            names.append(end)
    return names, parents, rest


def local_arrays(names, parents, of):
    """Translations and rotations of joints relative to their parents."""
    translations, rotations = np.empty((len(names), 3)), np.empty((len(names), 4))
    for i, n in enumerate(names):
        local = of[n] if parents[n] is None else of[parents[n]].inverted() @ of[n]
        translations[i] = local.translation
        q = local.to_quaternion()
        rotations[i] = (q.x, q.y, q.z, q.w)
    return translations, rotations


def mesh_arrays(arm, skeleton, names):
    """Skin of all meshes, in Blender's unit and Sinew's axes; without meshes a tube per bone."""
    index = {n: i for i, n in enumerate(names)}
    to_sinew_space = TO_Y @ place_of(arm) @ arm.matrix_world.inverted()
    made = [m for m in (_mesh(ob, index, to_sinew_space) for ob in skeleton.meshes) if m is not None]
    if not any("weights" in m for m in made):
        made.append(_tubes(arm, skeleton, index))
    return made


def unlike(name, names):
    """A name that is not among these, because a mesh may have the name of a bone."""
    while name in names:
        name += " mesh"
    return name


def _mesh(ob, index, to_sinew_space):
    me = ob.data
    co = np.empty(len(me.vertices) * 3, np.float32)
    me.vertices.foreach_get("co", co)
    me.calc_loop_triangles()
    triangles = np.empty(len(me.loop_triangles) * 3, np.uint32)
    me.loop_triangles.foreach_get("vertices", triangles)
    made = {"name": unlike(ob.name, index), "triangles": triangles.reshape(-1, 3)}
    m = to_sinew_space @ ob.matrix_world
    if ob.parent_type == "BONE":
        # Relative to the bone, the vertex is where it is at rest.
        bone = ob.parent.pose.bones.get(ob.parent_bone)
        if ob.parent_bone not in index or bone is None:
            return None
        posed = to_sinew(place_of(ob.parent) @ bone.matrix)
        m = posed.inverted() @ m
        made["joint"] = index[ob.parent_bone]
    else:
        made["joints"], made["weights"] = _weights(ob, index)
        # Vertices without a bone (props in the same object) are not skin.
        moved = made["weights"].sum(1) > 0
        made["triangles"] = made["triangles"][moved[made["triangles"]].all(1)]
    m = np.array(m, np.float64)
    made["positions"] = co.reshape(-1, 3).astype(np.float64) @ m[:3, :3].T + m[:3, 3]
    return made if len(made["triangles"]) else None


def _weights(ob, index):
    vertices = ob.data.vertices
    joints = np.zeros((len(vertices), INFLUENCES), np.uint16)
    weights = np.zeros((len(vertices), INFLUENCES), np.float32)
    of_group = {g.index: index[g.name] for g in ob.vertex_groups if g.name in index}
    for v in vertices:
        own = [(g.weight, of_group[g.group]) for g in v.groups if g.group in of_group and g.weight > 0]
        own.sort(reverse=True)
        for k, (weight, joint) in enumerate(own[:INFLUENCES]):
            joints[v.index, k], weights[v.index, k] = joint, weight
    return joints, weights


def skinned(arm, skeleton):
    """Names of the bones that move a vertex."""
    found, index = set(), {n: i for i, n in enumerate(skeleton.names)}
    for ob in skeleton.meshes:
        if ob.parent_type == "BONE":
            found.add(ob.parent_bone)
            continue
        joints, weights = _weights(ob, index)
        found |= {skeleton.names[j] for j in np.unique(joints[weights > 0])}
    return found


def _tubes(arm, skeleton, index):
    positions, triangles, joints, place = [], [], [], place_of(arm)
    sides = ((0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 7, 6), (0, 4, 5), (0, 5, 1), (1, 5, 6), (1, 6, 2), (2, 6, 7), (2, 7, 3), (3, 7, 4), (3, 4, 0))
    for n in skeleton.names:
        bone = arm.data.bones[n]
        r, first = TUBE * bone.length, len(positions)
        for y in (0.0, bone.length):
            for x, z in ((-r, -r), (r, -r), (r, r), (-r, r)):
                at = TO_Y @ place @ bone.matrix_local @ Matrix.Translation((x, y, z))
                positions.append(tuple(at.translation))
                joints.append((index[n], 0, 0, 0))
        triangles.extend([first + c for c in side] for side in sides)
    weights = np.zeros((len(positions), INFLUENCES), np.float32)
    weights[:, 0] = 1.0
    return {
        "name": "tubes",
        "positions": np.array(positions),
        "triangles": np.array(triangles, np.uint32),
        "joints": np.array(joints, np.uint16),
        "weights": weights,
    }


# ---- the user's animation


class Take:
    """The user's animation at every frame from the first on."""

    def __init__(self, first):
        self.first = first
        # Per frame: matrix of each bone in Sinew's axes; of the armature in the world; of carriers in the armature; modes.
        self.frames, self.worlds, self.carriers, self.modes = [], [], [], []

    def at(self, frame):
        return frame - self.first


def sampling(arm, skeleton, first, last):
    """The user's animation from the first frame to the last, a step of the generator for each; Blender's own frame is put back, also where it is closed before its
    end."""
    scene = bpy.context.scene
    at, sub = scene.frame_current, scene.frame_subframe
    take, carried = Take(first), carriers(arm, skeleton.names)
    # Blender copies a mode that Python has set, and that has no keys, only on request.
    arm.update_tag()
    try:
        for frame in range(first, last + 1):
            scene.frame_set(frame)
            evaluated = arm.evaluated_get(bpy.context.evaluated_depsgraph_get())
            world, bones = evaluated.matrix_world.copy(), evaluated.pose.bones
            take.frames.append({n: to_sinew(world @ bones[n].matrix) for n in skeleton.names})
            take.worlds.append(world)
            take.carriers.append({n: bones[n].matrix.copy() for n in carried})
            take.modes.append({n: bones[n].sinew_mode for n in skeleton.names})
            yield (frame - first + 1) / (last - first + 1)
    finally:
        scene.frame_set(at, subframe=sub)
    return take


def whole(steps):
    """Runs a generator to its end and returns its result."""
    while True:
        try:
            next(steps)
        except StopIteration as done:
            return done.value


def sample(arm, skeleton, first, last):
    return whole(sampling(arm, skeleton, first, last))
