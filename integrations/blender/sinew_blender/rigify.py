"""Transfers a fall from a proxy to keys on Rigify's FK controls."""

import re

import bpy

from . import actions, bridge, keys
from . import skeleton as sk
from .skeleton import SinewError

# Passes over all controls at a frame; each uses the current pose of its parents.
PASSES = 2
# Largest distance from the proxy without a warning, metres.
CLOSE = 0.05
# Roles of bodies whose control is called like the role, whatever the deform bone's name is.
NAMED = {"neck", "head"}


def control_of(arm, deform, role):
    """The FK control that moves a deform bone as a whole, or None."""
    stem, number, side = re.fullmatch(r"(.+?)(\.\d+)?(\.[LR])?", sk.plain(deform)).groups(default="")
    for candidate in (f"{stem}_fk{number}{side}", f"{stem}{number}{side}", role if role in NAMED else ""):
        bone = arm.data.bones.get(candidate)
        if bone is not None and not bone.use_deform:
            return candidate
    return None


def controls(arm, skeleton):
    """Pairs of a control and the deform bone that it moves, by levels from the root down. Bones without bodies have none, except those of
    FK chains: face and fingers follow the bodies with the user's animation."""
    roles = {body["bone"]: body["role"] for body in bridge.definition(arm)["bodies"]}
    levels, used = {}, {None}
    for deform in skeleton.names:
        control = control_of(arm, deform, roles.get(deform))
        if control in used or deform not in roles and "_fk" not in control:
            continue
        used.add(control)
        levels.setdefault(_depth(skeleton, deform), []).append((control, deform))
    torso = [[("torso", skeleton.names[0])]] if arm.data.bones.get("torso") is not None else []
    return torso + [levels[depth] for depth in sorted(levels)]


def _depth(skeleton, name):
    return 0 if name is None else 1 + _depth(skeleton, skeleton.parent[name])


def switches(arm):
    """Bones with a switch from IK to FK."""
    return [b.name for b in arm.pose.bones if keys.SWITCH in b]


def bake(context, arm):
    """Keys the FK controls so that the deform bones match the proxy; returns the largest distance, in Blender's unit."""
    proxy = bpy.data.objects.get(keys.proxy_name(arm))
    if proxy is None or arm.sinew.keyed != "PROXY":
        raise SinewError("Simulate with a proxy first")
    skeleton = sk.skeleton_of(arm)
    levels = controls(arm, skeleton)
    pairs = [pair for level in levels for pair in level]
    if len(pairs) < 3 or not switches(arm):
        raise SinewError(f"{arm.name} has no FK controls of Rigify")
    first, last = (int(x) for x in proxy.animation_data.action.frame_range)
    back = _back(arm, skeleton.names[0])
    last = last if back is None else min(last, back - 1)
    at = context.scene.frame_current
    goals = {}
    for frame in range(first, last + 1):
        context.scene.frame_set(frame)
        evaluated = proxy.evaluated_get(context.evaluated_depsgraph_get())
        goals[frame] = {n: evaluated.matrix_world @ evaluated.pose.bones[n].matrix for n in skeleton.names}
    # The Action with the influences is a copy of the user's: controls' keys are added to it, and influences removed.
    action = arm.animation_data.action
    made, own = arm.sinew.made_action, arm.sinew.own_action
    keys.keep_pose(arm, [c for c, _ in pairs] + switches(arm))
    keys.remove_proxy(arm)
    actions.remove(action, arm, lambda path: f'constraints["{keys.CONSTRAINT}"]' in path)
    frames = [float(frame) for frame in goals]
    for name in switches(arm):
        fcurve = actions.curve(action, arm, keys.bone_property(name, keys.SWITCH), 0, name)
        actions.insert(fcurve, frames, [1.0] * len(frames), float(arm.pose.bones[name][keys.SWITCH]), back is not None)
    worst = _key(context, arm, action, levels, goals, first, last, back is not None)
    arm.sinew.made_action, arm.sinew.own_action, arm.sinew.keyed = made, own, "FK"
    context.scene.frame_set(at)
    return worst


def _back(arm, name):
    """Frame at which the influence returns to 0, or None."""
    path = keys.bone_path(name, f'constraints["{keys.CONSTRAINT}"].influence')
    for fcurve in actions.curves(arm.animation_data.action, arm):
        if fcurve.data_path == path:
            points = fcurve.keyframe_points
            return int(points[-1].co[0]) if points[-1].co[1] == 0.0 and len(points) > 2 else None
    return None


def _key(context, arm, action, levels, goals, first, last, returns):
    pairs = [pair for level in levels for pair in level]
    rest = {c: arm.data.bones[d].matrix_local.inverted() @ arm.data.bones[c].matrix_local for c, d in pairs}
    rows = {c: [] for c, _ in pairs}
    own = {c: {what: tuple(getattr(arm.pose.bones[c], what)) for what in keys.CHANNELS} for c, _ in pairs}
    worst = 0.0
    for frame in range(first, last + 1):
        context.scene.frame_set(frame)
        inverse = arm.matrix_world.inverted()
        for _ in range(PASSES):
            for level in levels:
                for control, deform in level:
                    bone = arm.pose.bones[control]
                    bone.matrix = sk.unscaled(inverse @ goals[frame][deform]) @ rest[control]
                    if all(bone.lock_location):
                        bone.location = own[control]["location"]
                context.view_layer.update()
        evaluated = arm.evaluated_get(context.evaluated_depsgraph_get())
        for deform, goal in goals[frame].items():
            now = (evaluated.matrix_world @ evaluated.pose.bones[deform].matrix).translation
            worst = max(worst, (now - goal.translation).length)
        for control, _ in pairs:
            bone = arm.pose.bones[control]
            rows[control].append((tuple(bone.location), bone.matrix_basis.to_quaternion()))
    numbers = [float(f) for f in range(first, last + 1)]
    for control, kept in rows.items():
        bone = arm.pose.bones[control]
        turns = [kept[0][1]]
        for _, q in kept[1:]:
            turns.append(-q if q.dot(turns[-1]) < 0 else q)
        turned, path = keys.turns(turns, bone.rotation_mode)
        channels = [(path, i, [t[i] for t in turned]) for i in range(len(turned[0]))]
        if not all(bone.lock_location):
            channels += [("location", i, [place[i] for place, _ in kept]) for i in range(3)]
        for what, i, values in channels:
            fcurve = actions.curve(action, arm, keys.bone_path(control, what), i, control)
            actions.insert(fcurve, numbers, values, own[control][what][i], returns)
    return worst
