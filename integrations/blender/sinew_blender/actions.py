"""Accesses F-curves of Actions in Blender 3.4 to 5."""

import bpy


def curve(action, owner, path, index, group):
    """The F-curve of a property, created if it is missing."""
    if hasattr(action, "fcurve_ensure_for_datablock"):  # Blender 5: the only way.
        return action.fcurve_ensure_for_datablock(owner, path, index=index, group_name=group)
    found = action.fcurves.find(path, index=index)
    return found or action.fcurves.new(path, index=index, action_group=group)


def curves(action, owner):
    """All F-curves of an Action that move this data."""
    if action is None:
        return []
    if not hasattr(action, "layers"):
        return list(action.fcurves)
    slot = owner.animation_data.action_slot if owner.animation_data and owner.animation_data.action == action else None
    found = []
    for layer in action.layers:
        for strip in layer.strips:
            for bag in strip.channelbags:
                if slot is None or bag.slot == slot:
                    found.extend(bag.fcurves)
    return found


def remove(action, owner, gone):
    """Removes F-curves for which `gone(data_path)` holds."""
    if not hasattr(action, "layers"):
        for fcurve in [c for c in action.fcurves if gone(c.data_path)]:
            action.fcurves.remove(fcurve)
        return
    for layer in action.layers:
        for strip in layer.strips:
            for bag in strip.channelbags:
                for fcurve in [c for c in bag.fcurves if gone(c.data_path)]:
                    bag.fcurves.remove(fcurve)


def assign(owner, action):
    """Assigns the Action to the data."""
    data = owner.animation_data or owner.animation_data_create()
    data.action = action
    if hasattr(data, "action_slot") and data.action_slot is None and action is not None and action.slots:
        slot = next((s for s in action.slots if s.target_id_type in {owner.id_type, "UNSPECIFIED"}), None)
        if slot is not None:
            data.action_slot = slot


def interpolation(name):
    """The number of an interpolation mode."""
    return bpy.types.Keyframe.bl_rna.properties["interpolation"].enum_items[name].value


def write(fcurve, frames, values, way="LINEAR"):
    """Replaces the keys of a curve by one for each frame."""
    points = fcurve.keyframe_points
    if hasattr(points, "clear"):
        points.clear()
    else:
        while len(points):
            points.remove(points[-1], fast=True)
    points.add(len(frames))
    points.foreach_set("co", [x for pair in zip(frames, values) for x in pair])
    points.foreach_set("interpolation", [interpolation(way)] * len(frames))
    fcurve.update()


def insert(fcurve, frames, values, own, returns):
    """Keys, one per frame from first to last; the curve before and after is unchanged.

    A curve's shape between two keys depends on both: the span that the new keys cut is filled with a key a frame. A curve that had no keys
    has the value `own` before, and, if it `returns`, after.
    """
    first, last = frames[0], frames[-1]
    old = [(p.co[0], p.co[1], p.interpolation, p.handle_left[:], p.handle_right[:]) for p in fcurve.keyframe_points]
    if not old:
        after = [(last + 1.0, own)] if returns else []
        write(fcurve, [first - 1.0, *frames, *(f for f, _ in after)], [own, *values, *(v for _, v in after)])
        fcurve.keyframe_points[0].interpolation = "CONSTANT"
        return
    before = [k for k in old if k[0] < first - 0.5]
    after = [k for k in old if k[0] > last + 0.5]
    filled = []
    if before:
        start = int(before[-1][0]) + 1
        filled += [(float(f), fcurve.evaluate(f)) for f in range(start, int(first))]
    else:
        filled.append((first - 1.0, fcurve.evaluate(first - 1.0)))
    filled += list(zip(frames, values))
    end = int(after[0][0]) if after else int(last) + 2
    filled += [(float(f), fcurve.evaluate(f)) for f in range(int(last) + 1, end) if f > last]
    kept = before + after
    write(fcurve, [k[0] for k in before] + [f for f, _ in filled] + [k[0] for k in after], [k[1] for k in before] + [v for _, v in filled] + [k[1] for k in after])
    by_frame = {k[0]: k for k in kept}
    points = fcurve.keyframe_points
    for index, point in enumerate(points):
        k = by_frame.get(point.co[0])
        if k is None:
            continue
        is_cut = before and point.co[0] == before[-1][0]
        point.interpolation = "LINEAR" if is_cut else k[2]
        point.handle_left_type = point.handle_right_type = "FREE"
        point.handle_left, point.handle_right = k[3], k[4]
    fcurve.update()
