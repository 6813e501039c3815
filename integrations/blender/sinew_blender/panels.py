"""The sidebar, the bone's panel and the pie."""

import json

import bpy

from . import preview
from .operators import active_armature

ICONS = {"error": "CANCEL", "warning": "ERROR", "note": "INFO"}


class Side:
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Sinew"


class SINEW_PT_ragdoll(Side, bpy.types.Panel):
    bl_idname, bl_label = "SINEW_PT_ragdoll", "Ragdoll"

    def draw(self, context):
        layout, arm = self.layout, active_armature(context)
        layout.use_property_split = True
        if arm is None:
            layout.label(text="Select an armature", icon="ARMATURE_DATA")
            return
        settings = arm.sinew
        column = layout.column()
        column.prop(settings, "height")
        column.prop(settings, "mass")
        column.prop(settings, "springs")
        layout.operator("sinew.build", icon="ARMATURE_DATA", text="Build again" if settings.definition else "Build ragdoll")
        if settings.definition:
            row = layout.row(align=True)
            row.use_property_split = False
            row.prop(settings, "show_bodies", toggle=True)
            row.prop(settings, "show_limits", toggle=True)
            row.prop(settings, "show_masses", toggle=True)
            layout.operator("sinew.forget", icon="X")


def findings_of(context):
    """The number of findings of the active armature, or nothing."""
    count = len(active_armature(context).sinew.findings)
    return str(count) if count else ""


class SINEW_PT_doctor(Side, bpy.types.Panel):
    bl_idname, bl_label, bl_parent_id, bl_options = "SINEW_PT_doctor", "Doctor", "SINEW_PT_ragdoll", {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        arm = active_armature(context)
        return arm is not None and bool(arm.sinew.definition)

    def draw_header_preset(self, context):
        self.layout.label(text=findings_of(context))

    def draw(self, context):
        layout, settings = self.layout, active_armature(context).sinew
        row = layout.row(align=True)
        row.operator("sinew.doctor", icon="VIEWZOOM")
        row.operator("sinew.cure", icon="MODIFIER")
        if not settings.findings:
            layout.label(text="Nothing is wrong", icon="CHECKMARK")
        for index, finding in enumerate(settings.findings):
            box = layout.box()
            head = box.row()
            head.label(text=finding.code.replace("-", " "), icon=ICONS.get(finding.severity, "INFO"))
            head.operator("sinew.select_finding", text="", icon="RESTRICT_SELECT_OFF").index = index
            if index == settings.finding:
                for text in (finding.cause, finding.evidence, finding.fix):
                    for line in wrapped(text, max(24, context.region.width // 8)):
                        box.label(text=line)


def wrapped(text, width):
    lines, line = [], ""
    for word in text.split():
        if line and len(line) + len(word) >= width:
            lines.append(line)
            line = ""
        line = f"{line} {word}".strip()
    return [*lines, line] if line else lines


class SINEW_PT_simulate(Side, bpy.types.Panel):
    bl_idname, bl_label = "SINEW_PT_simulate", "Simulate"

    def draw(self, context):
        layout, settings = self.layout, context.scene.sinew
        layout.use_property_split = True
        column = layout.column()
        column.prop(settings, "by")
        if settings.by == "FRAME":
            column.prop(settings, "handover")
        column.prop(settings, "stiffness")
        column.prop(settings, "push_over")
        column.prop(settings, "gets_up")
        column.prop(settings, "use_return")
        if settings.use_return:
            column.prop(settings, "return_frame")
            column.prop(settings, "return_blend")
        column.prop(settings, "use_range")
        if settings.use_range:
            column.prop(settings, "frame_start")
            column.prop(settings, "frame_end")
        column.prop(settings, "keys")
        layout.operator_context = "INVOKE_DEFAULT"
        row = layout.row(align=True)
        row.scale_y = 1.4
        row.operator("sinew.simulate", icon="PHYSICS")
        row.operator("sinew.clear", text="", icon="TRASH")
        arm = active_armature(context)
        row = layout.row(align=True)
        row.operator("sinew.preview", icon="GHOST_ENABLED")
        ghost = preview.of(arm) if arm is not None else None
        if ghost is not None:
            row.operator("sinew.end_preview", text="", icon="X")
            if ghost.stamp != preview.stamp(context.scene, arm):
                layout.label(text="Settings changed since: preview again", icon="ERROR")
        if arm is not None and arm.sinew.report:
            report = json.loads(arm.sinew.report)
            box = layout.column()
            box.label(text=f"{report['verdict']}, {report['frames']} frames from {report['handover']}")
            for reason in [*report.get("notes", ()), *report["reasons"][:3]]:
                for line in wrapped(reason, max(24, context.region.width // 8)):
                    box.label(text=line)
            if arm.sinew.keyed == "PROXY":
                layout.operator("sinew.bake_fk", icon="CON_ARMATURE")


class SINEW_PT_world(Side, bpy.types.Panel):
    bl_idname, bl_label, bl_parent_id = "SINEW_PT_world", "World", "SINEW_PT_simulate"

    def draw(self, context):
        layout, settings, ob = self.layout, context.scene.sinew, context.object
        layout.use_property_split = True
        layout.prop(settings, "ground")
        column = layout.column()
        column.active = settings.ground
        column.prop(settings, "ground_height")
        column.prop(settings, "ground_friction")
        layout.prop(settings, "wind")
        row = layout.row(align=True)
        row.operator("sinew.collide", icon="MOD_PHYSICS", text="Collide").collides = True
        row.operator("sinew.collide", icon="X", text="Pass through").collides = False
        if ob is not None and ob.type == "MESH" and ob.sinew_body.collides:
            layout.prop(ob.sinew_body, "friction")
        layout.operator("sinew.add_hit", icon="EMPTY_SINGLE_ARROW")
        if ob is not None and ob.type == "EMPTY":
            hit = ob.sinew_hit
            layout.prop(hit, "enabled")
            column = layout.column()
            column.active = hit.enabled
            column.prop(hit, "armature")
            if hit.armature is not None:
                column.prop_search(hit, "bone", hit.armature.data, "bones")
            column.prop(hit, "frame")
            column.prop(hit, "impulse")


class SINEW_PT_export(Side, bpy.types.Panel):
    bl_idname, bl_label, bl_options = "SINEW_PT_export", "Export", {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        for name, text in (("SINEW", "Ragdoll"), ("MJCF", "MuJoCo"), ("GLB", "Character"), ("USD", "Fall as USD")):
            layout.operator("sinew.export", text=text, icon="EXPORT").format = name


class SINEW_PT_bone(bpy.types.Panel):
    bl_idname, bl_label = "SINEW_PT_bone", "Sinew"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "bone"

    @classmethod
    def poll(cls, context):
        return context.active_pose_bone is not None

    def draw(self, context):
        layout, settings = self.layout, context.active_pose_bone.sinew
        layout.use_property_split = True
        layout.prop(context.active_pose_bone, "sinew_mode")
        layout.prop(settings, "role")
        layout.prop(settings, "ignored")
        if not settings.has_body:
            layout.label(text="No body: it moves with the bone above it, or build again")
            return
        column = layout.column()
        column.use_property_decorate = False
        column.prop(settings, "mass")
        column.prop(settings, "size")
        if settings.has_swing:
            column.prop(settings, "swing_y")
            column.prop(settings, "swing_z")
        if settings.has_twist:
            column.prop(settings, "twist")
        column.prop(settings, "friction")


class SINEW_MT_pie(bpy.types.Menu):
    bl_idname, bl_label = "SINEW_MT_pie", "Sinew"

    def draw(self, context):
        pie = self.layout.menu_pie()
        pie.operator_context = "INVOKE_DEFAULT"
        pie.operator("sinew.build", icon="ARMATURE_DATA")
        pie.operator("sinew.simulate", icon="PHYSICS")
        pie.operator("sinew.doctor", icon="VIEWZOOM")
        pie.operator("sinew.add_hit", icon="EMPTY_SINGLE_ARROW")
        pie.operator("sinew.clear", icon="TRASH")
        pie.operator("sinew.preview", icon="GHOST_ENABLED")


CLASSES = (
    SINEW_PT_ragdoll,
    SINEW_PT_doctor,
    SINEW_PT_simulate,
    SINEW_PT_world,
    SINEW_PT_export,
    SINEW_PT_bone,
    SINEW_MT_pie,
)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
