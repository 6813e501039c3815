"""Handles in the viewport for the joint limits of the active bone."""

import json
import math

import bpy
from mathutils import Matrix, Quaternion, Vector

from . import overlay

# Limits with a handle at each end: the axis about which they turn, and the vector that they turn, in the joint's frame.
AXES = {
    "swing_y": (Vector((0, 1, 0)), Vector((1, 0, 0))),
    "swing_z": (Vector((0, 0, 1)), Vector((1, 0, 0))),
    "twist": (Vector((1, 0, 0)), Vector((0, 1, 0))),
}
# Length of the twist's arc as a share of the swing's cone, as drawn.
TWIST = 0.4
COLORS = {"swing_y": (1.0, 0.35, 0.3), "swing_z": (1.0, 0.6, 0.2), "twist": (0.45, 0.9, 0.4)}


def frame_of(arm, name):
    """The joint's frame in the world, drawn at the bone, with the length of the limit's cone; None for a bone without limits."""
    definition = json.loads(arm.sinew.definition)
    joint = next((b.get("joint") for b in definition["bodies"] if b["bone"] == name), None)
    if not joint or joint["parent"] not in arm.data.bones:
        return None
    world = arm.matrix_world @ arm.pose.bones[joint["parent"]].matrix @ overlay.joint_frame(arm, definition, joint)
    reach = overlay.REACH * arm.data.bones[name].length * arm.matrix_world.median_scale
    q = world.to_quaternion()
    return Matrix.Translation((arm.matrix_world @ arm.pose.bones[name].matrix).translation) @ q.to_matrix().to_4x4(), reach


def offset_of(key, angle, reach):
    """Position of a handle in the joint's frame."""
    axis, vector = AXES[key]
    return Quaternion(axis, angle) @ (reach * (TWIST if key == "twist" else 1.0) * vector)


def limits_of(bone):
    """Names of the limits of a pose bone that have handles."""
    settings = bone.sinew
    return [k for k in AXES if (settings.has_twist if k == "twist" else settings.has_swing)]


# Largest change of an angle within one movement of the mouse, and the steps in which it is sought, radians.
SWEEP, STEP = 1.0, 0.01


def angle_on_screen(key, frame, reach, place, near, project):
    """Angle, near another, at which the handle is drawn closest to a place of the world; `project` gives the pixel of a place."""
    goal = project(place)
    if goal is None:
        return near

    def off(angle):
        pixel = project(frame @ offset_of(key, angle, reach))
        return (pixel - goal).length if pixel is not None else math.inf

    count = round(SWEEP / STEP)
    return min((near + STEP * i for i in range(-count, count + 1)), key=off)


def drag(bone, key, end, angle):
    """Sets an end of a limit. A swing's range includes zero."""
    value = list(getattr(bone.sinew, key))
    if key != "twist":
        angle = min(angle, 0.0) if end == 0 else max(angle, 0.0)
    value[end] = min(angle, value[1]) if end == 0 else max(angle, value[0])
    setattr(bone.sinew, key, value)


def _pixel(place):
    from bpy_extras.view3d_utils import location_3d_to_region_2d

    return location_3d_to_region_2d(bpy.context.region, bpy.context.region_data, place)


class SINEW_GGT_limits(bpy.types.GizmoGroup):
    bl_idname, bl_label = "SINEW_GGT_limits", "Joint limits"
    bl_space_type, bl_region_type, bl_options = "VIEW_3D", "WINDOW", {"3D", "PERSISTENT"}

    @classmethod
    def poll(cls, context):
        bone = context.active_pose_bone
        arm = context.object
        if bone is None or arm is None or arm.type != "ARMATURE" or not arm.sinew.definition or not arm.sinew.show_limits:
            return False
        return bool(limits_of(bone)) and frame_of(arm, bone.name) is not None

    def setup(self, context):
        self.all = []
        for key in AXES:
            for end in (0, 1):
                handle = self.gizmos.new("GIZMO_GT_move_3d")
                handle.draw_options, handle.use_draw_value = {"FILL_SELECT", "ALIGN_VIEW"}, True
                handle.color, handle.alpha = COLORS[key], 0.8
                handle.color_highlight, handle.alpha_highlight = (1, 1, 1), 1.0
                handle.scale_basis = 0.1
                handle.target_set_handler("offset", get=self._getter(key, end), set=self._setter(key, end))
                self.all.append((key, handle))

    # Blender's handle has its offset along the axes of the world.

    def _getter(self, key, end):
        def get():
            bone = bpy.context.active_pose_bone
            found = frame_of(bpy.context.object, bone.name) if bone is not None else None
            if found is None:
                return (0.0, 0.0, 0.0)
            return found[0].to_3x3() @ offset_of(key, getattr(bone.sinew, key)[end], found[1])

        return get

    def _setter(self, key, end):
        def put(value):
            bone = bpy.context.active_pose_bone
            found = frame_of(bpy.context.object, bone.name) if bone is not None else None
            if found is None:
                return
            frame, reach = found
            place, near = frame.translation + Vector(value), getattr(bone.sinew, key)[end]
            drag(bone, key, end, angle_on_screen(key, frame, reach, place, near, _pixel))

        return put

    def draw_prepare(self, context):
        bone = context.active_pose_bone
        found = frame_of(context.object, bone.name) if bone is not None else None
        shown = limits_of(bone) if found is not None else []
        for key, handle in self.all:
            handle.hide = key not in shown
            if found is not None:
                handle.matrix_basis = Matrix.Translation(found[0].translation)


def register():
    bpy.utils.register_class(SINEW_GGT_limits)


def unregister():
    bpy.utils.unregister_class(SINEW_GGT_limits)
