"""Converts matrices to keys: of an Action, an NLA strip, a proxy that a controlled rig follows, or FK controls."""

import json

import bpy
from mathutils import Matrix

from . import actions, bridge

CONSTRAINT = "Sinew"
PROXY = "Sinew "
CHANNELS = ("location", "rotation_quaternion", "rotation_euler", "rotation_axis_angle", "scale")
TRACK = "Sinew"
# Rigify's switch from IK (0) to FK (1).
SWITCH = "IK_FK"
# Largest distance from the rest pose for which a location gets no keys, in units of Blender, bone space.
STILL = 1e-6


def bone_path(name, what):
    return f'pose.bones["{bpy.utils.escape_identifier(name)}"].{what}'


def bone_property(name, what):
    return f'pose.bones["{bpy.utils.escape_identifier(name)}"]["{what}"]'


def bone_values(arm, names, frames, worlds, carriers, stretches=None):
    """Location and rotation (quaternion) of each bone at each frame, as Blender's channels hold them. `frames` are in Sinew's axes;
    `stretches` say by bone how much longer than at rest it is at each frame."""
    bones = arm.data.bones
    out = {n: [] for n in names}
    for index, (frame, world, carried) in enumerate(zip(frames, worlds, carriers)):
        inverse = world.inverted()
        posed = {n: bridge.to_armature(frame[n], inverse) for n in names}
        for n, rows in (stretches or {}).items():
            posed[n] = posed[n] @ Matrix.Diagonal((1.0, rows[index], 1.0, 1.0))
        for n in names:
            bone, parent = bones[n], bones[n].parent
            named = {}
            if parent is not None:
                above = posed.get(parent.name) or carried.get(parent.name) or parent.matrix_local
                named = {"parent_matrix": above, "parent_matrix_local": parent.matrix_local}
            basis = bone.convert_local_to_pose(posed[n], bone.matrix_local, invert=True, **named)
            q = basis.to_quaternion()
            if out[n] and q.dot(out[n][-1][1]) < 0:
                q.negate()
            out[n].append((tuple(basis.translation), q))
    return out


def write_pose(arm, action, names, frames, worlds, carriers, first, alone=False, stretches=None, returns=False):
    """Keys of bones for consecutive frames from the first on; before and after, the curves stay as they are. `alone`: the Action has
    nothing before and after. `returns`: channels without curves get their own values back afterwards."""
    values = bone_values(arm, names, frames, worlds, carriers, stretches)
    numbers = [float(first + i) for i in range(len(frames))]
    for n in names:
        bone, rows = arm.pose.bones[n], values[n]
        turned, path = turns([q for _, q in rows], bone.rotation_mode)
        channels = [(path, i, [turn[i] for turn in turned]) for i in range(len(turned[0]))]
        moves = max(abs(x) for place, _ in rows for x in place) > STILL
        if not arm.data.bones[n].use_connect and (moves or _has(arm, action, bone_path(n, "location"))):
            channels += [("location", i, [place[i] for place, _ in rows]) for i in range(3)]
        if stretches and n in stretches:
            channels.append(("scale", 1, stretches[n]))
        for what, i, numbers_of in channels:
            fcurve = actions.curve(action, arm, bone_path(n, what), i, n)
            if alone:
                actions.write(fcurve, numbers, numbers_of)
            else:
                actions.insert(fcurve, numbers, numbers_of, getattr(bone, what)[i], returns)


def _has(arm, action, path):
    return any(fcurve.data_path == path for fcurve in actions.curves(action, arm))


def turns(quaternions, mode):
    """Rotations in a bone's rotation mode."""
    if mode == "QUATERNION":
        return quaternions, "rotation_quaternion"
    if mode == "AXIS_ANGLE":
        both = [q.to_axis_angle() for q in quaternions]
        return [(angle, *axis) for axis, angle in both], "rotation_axis_angle"
    out, last = [], None
    for q in quaternions:
        last = q.to_euler(mode, last) if last is not None else q.to_euler(mode)
        out.append(tuple(last))
    return out, "rotation_euler"


def new_action(arm):
    """A copy of the user's Action under a new name; the original stays unchanged."""
    old = arm.animation_data.action if arm.animation_data else None
    name = f"{PROXY}{arm.name}"
    if old is None:
        action = bpy.data.actions.new(name)
    else:
        action = old.copy()
        action.name = name
    if old is not None:
        # No other object may use it while the copy is assigned.
        old.use_fake_user = True
    arm.sinew.own_action, arm.sinew.made_action = old, action
    return action


def keep_pose(arm, names):
    """Stores the values of the bones' channels, so that channels without a user's curve can be restored."""
    kept = {}
    for n in names:
        bone = arm.pose.bones[n]
        kept[n] = [list(getattr(bone, what)) for what in CHANNELS] + [bone.get(SWITCH)]
    arm.sinew.own_pose = json.dumps(kept)


def restore_pose(arm):
    for n, values in json.loads(arm.sinew.own_pose or "{}").items():
        bone = arm.pose.bones.get(n)
        for what, value in zip(CHANNELS, values) if bone is not None else ():
            setattr(bone, what, value)
        if bone is not None and SWITCH in bone and values[len(CHANNELS) :] not in ([], [None]):
            bone[SWITCH] = values[-1]


def is_in_place(arm):
    """True if the Action of a simulation is the armature's, or was unlinked without another in its place."""
    data, made = arm.animation_data, arm.sinew.made_action
    if arm.sinew.keyed not in {"ACTION", "PROXY", "FK"}:
        return False
    if data is None or data.action == made:
        return True
    # A take that the user pushed down stays.
    return data.action is None and all(strip.action != made for track in data.nla_tracks for strip in track.strips)


def put_back(arm):
    """Restores the user's own Action, or none if there was none; channels without curves get their stored values."""
    restore_pose(arm)
    data = arm.animation_data
    if arm.sinew.own_action is None and data is not None:
        data.action = None
    elif arm.sinew.own_action is not None:
        actions.assign(arm, arm.sinew.own_action)


def clear(arm):
    """Removes the keys of an earlier simulation and restores the user's animation."""
    made = arm.sinew.made_action
    remove_proxy(arm)
    if is_in_place(arm):
        put_back(arm)
    data = arm.animation_data
    if data is not None:
        tracks = [t for t in data.nla_tracks if t.name == TRACK]
        for track in tracks:
            data.nla_tracks.remove(track)
        if tracks:
            restore_pose(arm)
        take_from_track(arm, data)
    arm.sinew.own_action = arm.sinew.made_action = None
    arm.sinew.own_pose = arm.sinew.own_track = ""
    if made is not None and made.users == 0:
        bpy.data.actions.remove(made)
    arm.sinew.keyed = ""


def take_from_track(arm, data):
    """Makes the user's Action active again that a strip put on a track; a track that the user changed since stays."""
    action, track = arm.sinew.own_action, data.nla_tracks.get(arm.sinew.own_track) if arm.sinew.own_track else None
    if track is None or data.action is not None or len(track.strips) != 1 or track.strips[0].action != action:
        return
    slot = getattr(track.strips[0], "action_slot", None)
    data.nla_tracks.remove(track)
    actions.assign(arm, action)
    if slot is not None:
        data.action_slot = slot


def as_action(arm, names, fall):
    """A copy of the user's Action with one key per frame while bodies determine the pose."""
    keep_pose(arm, names)
    action = new_action(arm)
    actions.assign(arm, action)
    write_pose(arm, action, names, fall.frames, fall.worlds, fall.carriers, fall.first, returns=fall.back is not None)
    return action


def as_strip(arm, names, fall):
    """A strip on a new track over the user's animation, which continues before and after it."""
    keep_pose(arm, names)
    data = arm.animation_data_create() if arm.animation_data is None else arm.animation_data
    old, slot = data.action, getattr(data, "action_slot", None)
    if old is not None:
        track = data.nla_tracks.new()
        track.name = old.name
        strip = track.strips.new(old.name, int(old.frame_range[0]), old)
        if slot is not None:
            strip.action_slot = slot
        strip.extrapolation = "HOLD"
        data.action = None
        arm.sinew.own_action, arm.sinew.own_track = old, track.name
    action = bpy.data.actions.new(f"{PROXY}{arm.name}")
    arm.sinew.made_action = action
    actions.assign(arm, action)
    write_pose(arm, action, names, fall.frames, fall.worlds, fall.carriers, fall.first, alone=True)
    slot = getattr(data, "action_slot", None)
    data.action = None
    track = data.nla_tracks.new()
    track.name = TRACK
    strip = track.strips.new(action.name, int(fall.first), action)
    if slot is not None:
        strip.action_slot = slot
    strip.extrapolation, strip.blend_type = "NOTHING", "REPLACE"
    return action


def proxy_name(arm):
    return f"{PROXY}{arm.name}"


def as_proxy(arm, skeleton, fall):
    """An armature of the deform bones only; the rig follows it by constraints from the hand-over until the return."""
    remove_proxy(arm)
    names, parent = skeleton.names, skeleton.parent
    data = bpy.data.armatures.new(proxy_name(arm))
    proxy = bpy.data.objects.new(proxy_name(arm), data)
    for collection in arm.users_collection or (bpy.context.scene.collection,):
        collection.objects.link(proxy)
    proxy.matrix_world = arm.matrix_world
    _edit(proxy, lambda: _copy_bones(arm, data, names, parent))
    action = bpy.data.actions.new(f"{PROXY}{arm.name}")
    actions.assign(proxy, action)
    for n in names:
        proxy.pose.bones[n].rotation_mode = "QUATERNION"
    fixed = [proxy.matrix_world.copy()] * len(fall.frames)
    stretches = stretches_of(arm, names, fall)
    write_pose(proxy, action, names, fall.frames, fixed, fall.carriers, fall.first, alone=True, stretches=stretches)
    proxy.hide_render = True
    _follow(arm, proxy, names, fall.first, fall.back)
    proxy.hide_set(True)
    return proxy


# Relative stretch up to which a bone counts as not stretched.
STRETCHED = 1e-4


def stretches_of(arm, names, fall):
    """Lengths of bones over those at rest, frame by frame, where a bone that is connected to them has to be: Blender keeps it at the tail,
    whatever constraints say. Rigs that stretch hand such lengths over."""
    kept, found = set(names), {}
    for n in names:
        bone = arm.data.bones[n]
        if not bone.use_connect or bone.parent is None or bone.parent.name not in kept or bone.parent.length == 0:
            continue
        above = bone.parent
        rows = []
        for frame, world in zip(fall.frames, fall.worlds):
            at_rest = (world.to_3x3() @ (above.tail_local - above.head_local)).length
            rows.append((frame[n].translation - frame[above.name].translation).length / at_rest)
        if max(abs(row - 1.0) for row in rows) > STRETCHED:
            found[above.name] = rows
    return found


def _copy_bones(arm, data, names, parent):
    for n in names:
        bone, source = data.edit_bones.new(n), arm.data.bones[n]
        bone.head, bone.tail = (0, 0, 0), (0, source.length, 0)
        bone.matrix = source.matrix_local
        bone.use_deform = False
        bone.inherit_scale = "NONE"
        if parent[n]:
            bone.parent = data.edit_bones[parent[n]]


def _edit(ob, change):
    """Runs a change in edit mode of an object, and restores mode and selection."""
    layer = bpy.context.view_layer
    active, selected = layer.objects.active, [o for o in layer.objects if o.select_get()]
    mode = active.mode if active is not None else "OBJECT"
    if active is not None and mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    for o in selected:
        o.select_set(False)
    layer.objects.active = ob
    ob.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        change()
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
        ob.select_set(False)
        for o in selected:
            o.select_set(True)
        layer.objects.active = active
        if active is not None and mode != "OBJECT":
            bpy.ops.object.mode_set(mode=mode)


def _follow(arm, proxy, names, handover, back):
    """Constraints whose influence is 0 before the hand-over and from the return on, in a copy of the user's Action."""
    action = new_action(arm)
    actions.assign(arm, action)
    keys = [(float(handover - 1), 0.0), (float(handover), 1.0)] + ([(float(back), 0.0)] if back is not None else [])
    for n in names:
        c = arm.pose.bones[n].constraints.new("COPY_TRANSFORMS")
        c.name, c.target, c.subtarget = CONSTRAINT, proxy, n
        path = bone_path(n, f'constraints["{CONSTRAINT}"].influence')
        fcurve = actions.curve(action, arm, path, 0, n)
        actions.write(fcurve, [f for f, _ in keys], [v for _, v in keys], "CONSTANT")


def remove_proxy(arm):
    """Removes what an earlier run added to a controlled rig: proxy, constraints, their keys."""
    for bone in arm.pose.bones:
        for c in [c for c in bone.constraints if c.name == CONSTRAINT and c.type == "COPY_TRANSFORMS"]:
            bone.constraints.remove(c)
    proxy = bpy.data.objects.get(proxy_name(arm))
    if proxy is not None and proxy.type == "ARMATURE":
        action = proxy.animation_data.action if proxy.animation_data else None
        data = proxy.data
        bpy.data.objects.remove(proxy)
        bpy.data.armatures.remove(data)
        if action is not None and action.users == 0:
            bpy.data.actions.remove(action)
