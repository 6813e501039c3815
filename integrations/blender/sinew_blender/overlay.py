"""Draws bodies, limits and masses in the viewport."""

import json
import math

import bpy
from mathutils import Matrix, Quaternion, Vector

from .skeleton import TO_Y, place_of

BODY = (0.25, 0.75, 1.0, 0.9)
CHOSEN = (1.0, 0.65, 0.15, 1.0)
LIMIT = (1.0, 0.35, 0.3, 0.9)
TWIST = (0.45, 0.9, 0.4, 0.9)
HIT = (1.0, 0.1, 0.5, 1.0)
# Width of a hit's arrow in pixels; length and radius of its head as shares of its length.
HIT_WIDTH, HEAD_LENGTH, HEAD_RADIUS = 4.0, 0.25, 0.08
# Number of corners of a circle.
STEPS = 24
# Length of a limit's cone as a share of its bone.
REACH = 0.5

_handles = []
# Definition, and lines by bone, for each armature's name.
_made = {}


def _circle(radius, place, a, b, arc=(0.0, 2 * math.pi)):
    turn = [arc[0] + (arc[1] - arc[0]) * i / STEPS for i in range(STEPS + 1)]
    points = [place + radius * (math.cos(t) * a + math.sin(t) * b) for t in turn]
    return [p for pair in zip(points, points[1:]) for p in pair]


X, Y, Z = Vector((1, 0, 0)), Vector((0, 1, 0)), Vector((0, 0, 1))


def shape_lines(shape):
    """Line segments of a shape in its own frame, metres."""
    if shape["type"] == "box":
        h = Vector(shape["half_extents"])
        corners = [Vector((x * h.x, y * h.y, z * h.z)) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        return [corners[k] for i in range(8) for j in range(i) if bin(i ^ j).count("1") == 1 for k in (i, j)]
    if shape["type"] == "hull":
        return []
    low, high = shape.get("radius_bottom", shape.get("radius", 0.05)), shape.get("radius_top", shape.get("radius", 0.05))
    half = shape.get("half_height", 0.0)
    lines = _circle(low, -half * Y, X, Z) + _circle(high, half * Y, X, Z)
    for side in (X, -X, Z, -Z):
        lines += [-half * Y + low * side, half * Y + high * side]
    for side in (X, Z):
        lines += _circle(low, -half * Y, side, -Y, (0.0, math.pi)) + _circle(high, half * Y, side, Y, (0.0, math.pi))
    return lines


def limit_lines(joint, reach):
    """Cone of swing and arc of twist in the joint's frame, whose x axis is the twist's."""
    limits = joint.get("limits_deg") or {}
    swing, twist = [], []
    if "swing_y" in limits:
        (y0, y1), (z0, z1) = ([math.radians(a) for a in limits[key]] for key in ("swing_y", "swing_z"))
        rim = []
        for i in range(STEPS + 1):
            t = 2 * math.pi * i / STEPS
            y, z = math.cos(t), math.sin(t)
            turn = Vector((0, y * (y1 if y > 0 else -y0), z * (z1 if z > 0 else -z0)))
            rim.append(Quaternion(turn.normalized(), turn.length) @ (reach * X) if turn.length else reach * X)
        swing = [p for pair in zip(rim, rim[1:]) for p in pair]
        swing += [p for corner in rim[:: STEPS // 8] for p in (Vector(), corner)]
    if "twist" in limits and joint["type"] != "universal":
        t0, t1 = (math.radians(a) for a in limits["twist"])
        arc = _circle(0.4 * reach, Vector(), Y, Z, (t0, t1))
        twist = [*arc, Vector(), arc[0], Vector(), arc[-1]]
    return swing, twist


def placed(pose):
    place, q = pose.get("position", (0, 0, 0)), pose.get("rotation", (0, 0, 0, 1))
    return Matrix.Translation(place) @ Quaternion((q[3], *q[:3])).to_matrix().to_4x4()


def to_world_of(definition):
    """Transform from the definition's character space (metres) to Blender's world."""
    unit = definition["unit_scale"]
    model = placed(definition["character_from_model"]).inverted()
    model.translation /= unit
    return TO_Y.inverted() @ model @ Matrix.Scale(1.0 / unit, 4)


def joint_frame(arm, definition, joint):
    """The frame of a joint in the rest space of the bone that carries it."""
    body = next(b for b in definition["bodies"] if b["bone"] == joint["parent"])
    to_bone = (place_of(arm) @ arm.data.bones[body["bone"]].matrix_local).inverted() @ to_world_of(definition)
    return to_bone @ placed(body) @ placed(joint["frame_in_parent"])


def pieces(arm):
    """Lines of body, swing and twist in the bone's rest space, and position (rest space) and size (kg) of its mass, by bone."""
    text = arm.sinew.definition
    kept = _made.get(arm.name)
    key = (text, arm.sinew.place)
    if kept is not None and kept[0] == key:
        return kept[1]
    definition, made = json.loads(text), {}
    unit, to_world = definition["unit_scale"], to_world_of(definition)
    reach_of = {b["bone"] for b in definition["bodies"]}
    rest = place_of(arm)
    for body in definition["bodies"]:
        name = body["bone"]
        bone = arm.data.bones.get(name)
        if bone is None:
            continue
        to_bone = (rest @ bone.matrix_local).inverted() @ to_world
        own = to_bone @ placed(body)
        lines = [own @ p for p in shape_lines(body["shape"])]
        swing, twist = [], []
        joint = body.get("joint")
        carrier = None
        if joint and joint["parent"] in reach_of:
            carrier = joint["parent"]
            parent = arm.data.bones.get(carrier)
            if parent is not None:
                frame = joint_frame(arm, definition, joint)
                reach = REACH * bone.length * rest.median_scale * unit
                swing, twist = ([frame @ p for p in part] for part in limit_lines(joint, reach))
        center = own @ Vector(body["mass"].get("center", (0, 0, 0)))
        made[name] = (lines, carrier, swing, twist, center, body["mass"]["kg"])
    _made[arm.name] = (key, made)
    return made


def lines_of(arm, chosen):
    """Colours and line segments in the world, for the current pose of the armature."""
    settings, out = arm.sinew, {BODY: [], CHOSEN: [], LIMIT: [], TWIST: []}
    for name, (body, carrier, swing, twist, _, _) in pieces(arm).items():
        bone = arm.pose.bones.get(name)
        if bone is None or carrier not in {None, *arm.pose.bones.keys()}:
            continue
        if settings.show_bodies:
            at = arm.matrix_world @ bone.matrix
            out[CHOSEN if name in chosen else BODY].extend(at @ p for p in body)
        if settings.show_limits and name in chosen and carrier is not None:
            at = arm.matrix_world @ arm.pose.bones[carrier].matrix
            # The limits rotate with the parent, and are drawn at the bone.
            shift = (arm.matrix_world @ bone.matrix).translation - at @ swing[-2] if swing else Vector()
            out[LIMIT].extend((at @ p) + shift for p in swing)
            out[TWIST].extend((at @ p) + shift for p in twist)
    return out


def hit_lines(ob):
    """Line segments of a hit's arrow in the world."""
    if not ob.sinew_hit.enabled:
        return []
    size = ob.empty_display_size
    tip = Vector((0, 0, size))
    lines = [Vector(), tip]
    for side in (X, -X, Y, -Y):
        lines += [tip, size * ((1.0 - HEAD_LENGTH) * Z + HEAD_RADIUS * side)]
    return [ob.matrix_world @ p for p in lines]


def _draw_hits(context):
    import gpu
    from gpu_extras.batch import batch_for_shader

    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR" if bpy.app.version >= (4, 0) else "3D_POLYLINE_UNIFORM_COLOR")
    for ob in context.visible_objects:
        points = hit_lines(ob) if ob.type == "EMPTY" else []
        if points:
            batch = batch_for_shader(shader, "LINES", {"pos": [tuple(p) for p in points]})
            shader.bind()
            shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
            shader.uniform_float("lineWidth", HIT_WIDTH)
            shader.uniform_float("color", HIT)
            batch.draw(shader)


def _shown(context):
    return [ob for ob in context.visible_objects if ob.type == "ARMATURE" and ob.sinew.definition]


def _chosen(arm):
    picked = {b.name for b in arm.data.bones if getattr(b, "select", False)}
    picked |= {b.name for b in arm.pose.bones if getattr(b, "select", False)}
    active = arm.data.bones.active
    return picked | ({active.name} if active is not None else set())


def draw_lines():
    import gpu
    from gpu_extras.batch import batch_for_shader

    context = bpy.context
    if context.space_data is None or not context.space_data.overlay.show_overlays:
        return
    shader = gpu.shader.from_builtin("UNIFORM_COLOR" if bpy.app.version >= (4, 0) else "3D_UNIFORM_COLOR")
    gpu.state.blend_set("ALPHA")
    gpu.state.line_width_set(1.5)
    for arm in _shown(context):
        for color, points in lines_of(arm, _chosen(arm)).items():
            if points:
                batch = batch_for_shader(shader, "LINES", {"pos": [tuple(p) for p in points]})
                shader.bind()
                shader.uniform_float("color", color)
                batch.draw(shader)
    _draw_hits(context)
    gpu.state.line_width_set(1.0)
    gpu.state.blend_set("NONE")


def draw_masses():
    import blf
    from bpy_extras.view3d_utils import location_3d_to_region_2d

    context = bpy.context
    if context.space_data is None or not context.space_data.overlay.show_overlays:
        return
    for arm in _shown(context):
        if not arm.sinew.show_masses:
            continue
        for name, (_, _, _, _, center, mass) in pieces(arm).items():
            bone = arm.pose.bones.get(name)
            at = arm.matrix_world @ bone.matrix @ center if bone is not None else None
            where = location_3d_to_region_2d(context.region, context.region_data, at) if at is not None else None
            if where is not None:
                blf.position(0, where.x, where.y, 0)
                blf.color(0, 1, 1, 1, 1)
                blf.draw(0, f"{mass:.1f} kg")


def register():
    if bpy.app.background:
        return
    add = bpy.types.SpaceView3D.draw_handler_add
    _handles.append(add(draw_lines, (), "WINDOW", "POST_VIEW"))
    _handles.append(add(draw_masses, (), "WINDOW", "POST_PIXEL"))


def unregister():
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    _made.clear()
