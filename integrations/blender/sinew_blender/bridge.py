"""Converts armatures to characters of Sinew, and simulated poses back."""

import json
from dataclasses import dataclass

import numpy as np
from mathutils import Matrix, Quaternion, Vector

from . import skeleton as sk
from .skeleton import TO_Y, SinewError

CLIP = "user"
# Largest relative difference of two equal scales.
SAME_SCALE = 1e-3
# Sizes of characters for which the unit is not guessed, metres.
SIZES = (0.3, 10.0)


def engine():
    """Sinew's package; it comes with the extension."""
    try:
        import sinew
    except ImportError as error:
        raise SinewError(f"Sinew's own package is missing: install the extension's zip again ({error})") from error
    return sinew


def asked(call, *arguments, **named):
    """Calls Sinew, and reports its errors to the user."""
    sinew = engine()
    try:
        return call(*arguments, **named)
    except sinew.Cancelled:
        raise
    except (sinew.SinewError, ValueError) as error:
        raise SinewError(str(error)) from error


@dataclass
class Loaded:
    """An armature in Sinew's representation."""

    file: object
    skeleton: sk.Skeleton
    # Names of joints in the order of Sinew's arrays.
    joints: list
    parents: dict
    rest: dict
    # Metres per Blender unit, as in the ragdoll.
    unit: float = 1.0


def build(arm):
    """The ragdoll of an armature. A mesh parented to a bone gets no body of its own, because it has no bone to key."""
    loaded = load(arm)
    ragdoll = asked(loaded.file.build)
    others = [name for name in ragdoll.bones if name not in arm.data.bones]
    return asked(load(arm, ignore=others).file.build) if others else ragdoll


def load(arm, frames=None, fps=30.0, ignore=()):
    """The armature as a character, with the sampled frames as its clip."""
    was, now = sk.place_of(arm).to_scale(), arm.matrix_world.to_scale()
    if (was - now).length > SAME_SCALE * now.length:
        raise SinewError(f"{arm.name} has another scale than when its ragdoll was built: build it again")
    skeleton = sk.skeleton_of(arm)
    names, parents, rest = sk.joint_list(arm, skeleton)
    index = {n: i for i, n in enumerate(names)}
    translations, rotations = sk.local_arrays(names, parents, rest)
    clips = {}
    if frames:
        both = []
        for frame in frames:
            full = dict(frame)
            for n in names[len(skeleton.names) :]:
                full[n] = frame[parents[n]] @ (rest[parents[n]].inverted() @ rest[n])
            both.append(sk.local_arrays(names, parents, full))
        clips[CLIP] = {
            "times": np.arange(len(frames)) / fps,
            "translations": np.array([t for t, _ in both]),
            "rotations": np.array([q for _, q in both]),
        }
    settings = arm.sinew
    wanted = {"ignore": list(ignore)}
    for bone in arm.pose.bones:
        if bone.sinew.role and bone.name in index:
            wanted.setdefault("roles", {})[bone.name] = bone.sinew.role
        if bone.sinew.ignored and bone.name in index:
            wanted["ignore"].append(bone.name)
    if settings.height > 0:
        wanted["height"] = settings.height
    elif SIZES[0] <= _extent(arm, skeleton) * sk.unit_of_scene() <= SIZES[1]:
        # A plausible size is used unchanged; for any other Sinew guesses the unit.
        wanted["unit"] = sk.unit_of_scene()
    if settings.mass > 0:
        wanted["mass"] = settings.mass
    if settings.springs:
        wanted["settings"] = {"springs": "names"}
    file = _asked_with_roles(
        arm,
        engine().load_arrays,
        names,
        [-1 if parents[n] is None else index[parents[n]] for n in names],
        translations,
        rotations,
        meshes=sk.mesh_arrays(arm, skeleton, names),
        clips=clips,
        name=arm.name,
        **wanted,
    )
    return Loaded(file, skeleton, file.joints, parents, rest)


def _asked_with_roles(arm, call, *arguments, **named):
    """`asked`; an error about a role names the bone that has it."""
    try:
        return asked(call, *arguments, **named)
    except SinewError as error:
        for bone in arm.pose.bones:
            if bone.sinew.role and f"role `{bone.sinew.role}`" in str(error):
                raise SinewError(f"{bone.name}: {error}") from error
        raise


def _extent(arm, skeleton):
    """Largest extent of the rest pose, Blender's length."""
    place = sk.place_of(arm)
    heads = [place @ arm.data.bones[n].head_local for n in skeleton.names]
    tails = [place @ arm.data.bones[n].tail_local for n in skeleton.names]
    points = np.array([tuple(p) for p in heads + tails])
    return float((points.max(0) - points.min(0)).max())


def definition(arm):
    """The definition stored on the armature."""
    if not arm.sinew.definition:
        raise SinewError("Build the ragdoll first")
    return json.loads(arm.sinew.definition)


def ragdoll(arm):
    """The ragdoll stored on the armature, with the user's changes."""
    if not arm.sinew.definition:
        raise SinewError("Build the ragdoll first")
    return asked(engine().Ragdoll.from_json, arm.sinew.definition)


def valid(arm):
    """The ragdoll stored on the armature, if the armature still has its bones."""
    for body in definition(arm)["bodies"]:
        if body["bone"] not in arm.data.bones:
            raise SinewError(f"{arm.name} has no bone {body['bone']} any more: build its ragdoll again")
    return ragdoll(arm)


def pose7(matrix):
    q = matrix.to_quaternion()
    return (*matrix.translation, q.x, q.y, q.z, q.w)


def matrix_of(pose):
    x, y, z, w = pose[3:]
    return Matrix.Translation(Vector(pose[:3])) @ Quaternion((w, x, y, z)).to_matrix().to_4x4()


def scaled(matrix, factor):
    """The matrix with its translation scaled."""
    out = matrix.copy()
    out.translation *= factor
    return out


def model_matrices(baked, loaded):
    """Matrix of each bone at each frame, Blender's length and Sinew's axes. Joints that Sinew added are left out."""
    translations, rotations, up = baked.translations, baked.rotations, baked.parents
    wanted = set(loaded.skeleton.names)
    frames = []
    for t, q in zip(translations, rotations):
        model, frame = [], {}
        for j, name in enumerate(loaded.joints):
            m = Matrix.Translation(Vector(t[j])) @ Quaternion((q[j][3], q[j][0], q[j][1], q[j][2])).to_matrix().to_4x4()
            m = m if up[j] < 0 else model[up[j]] @ m
            model.append(m)
            if name in wanted:
                frame[name] = m
        frames.append(frame)
    return frames


def to_armature(matrix, world_inverse):
    """A matrix in Sinew's axes, in the armature's space, without scale."""
    return sk.unscaled(world_inverse @ TO_Y.inverted() @ matrix)
