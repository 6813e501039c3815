"""Rigs of the tests: imported, made in place, scaled."""

import math
import os

import bpy

# Blender's own modules exist only after bpy is imported.
import addon_utils  # isort: skip
import bmesh  # isort: skip
from mathutils import Matrix, Vector

DATA = os.environ.get("SINEW_DATA", "")
FPS, FIRST, LAST = 30, 1, 150


def empty_scene():
    # Not the preferences, so that the extension stays enabled.
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.render.fps, scene.render.fps_base = FPS, 1.0
    scene.frame_start, scene.frame_end = FIRST, LAST
    return scene


def activate(arm):
    for ob in bpy.context.selected_objects:
        ob.select_set(False)
    bpy.context.view_layer.objects.active = arm
    arm.select_set(True)
    return arm


def imported(path, action=None):
    bpy.ops.import_scene.gltf(filepath=path)
    arm = next(ob for ob in bpy.data.objects if ob.type == "ARMATURE")
    data = arm.animation_data
    if action is not None and data is not None:
        for track in list(data.nla_tracks):
            data.nla_tracks.remove(track)
        data.action = bpy.data.actions[action] if action in bpy.data.actions else next(a for a in bpy.data.actions if action in a.name)
        if hasattr(data, "action_slot") and data.action.slots:
            data.action_slot = data.action.slots[0]
    return activate(arm)


def cesium_man():
    return imported(os.path.join(DATA, "rigs/CesiumMan.glb"))


def knight():
    return imported(os.path.join(DATA, "rigs/kaykit_Knight.glb"), "Walking_A")


def fox():
    return imported(os.path.join(DATA, "rigs/Fox.glb"), "Walk")


def robot():
    """Meshes called like bones, and a bone above the hips."""
    return imported(os.path.join(DATA, "rigs/quaternius_Robot.glb"), "Robot_Walking")


def gunner():
    """As `robot`, with skin on that bone."""
    return imported(os.path.join(DATA, "rigs/quaternius_cyberpunk_Character.glb"), "Walk")


def scale_100():
    """The man scaled by a hundred through the armature's parent, rotated and moved, without applying the transforms."""
    arm = cesium_man()
    top = arm
    while top.parent is not None:
        top = top.parent
    top.matrix_world = Matrix.Translation((300, -200, 0)) @ Matrix.Rotation(0.8, 4, "Z") @ Matrix.Scale(100, 4) @ top.matrix_world
    bpy.context.scene.sinew.ground_height = 0.0
    bpy.context.view_layer.update()
    return activate(arm)


def rigify_face():
    """As `rigify_human`, with face and fingers."""
    return rigify_human(bpy.ops.object.armature_human_metarig_add)


def rigify_human(make=bpy.ops.object.armature_basic_human_metarig_add):
    """A Rigify human with active IK controls, and skin made of a box along each deform bone."""
    addon_utils.enable("rigify", default_set=True)
    make()
    meta = bpy.context.object
    bpy.ops.pose.rigify_generate()
    rig = next(ob for ob in bpy.data.objects if ob.type == "ARMATURE" and ob is not meta)
    boxes(rig)
    bpy.data.objects.remove(meta)
    for f in range(FIRST, LAST + 2, 15):
        s = math.sin(f / 15 * math.pi / 2)
        key(rig, "hand_ik.L", f, (0, 0, 0.15 + 0.1 * s))
        key(rig, "hand_ik.R", f, (0, 0, 0.15 - 0.1 * s))
        key(rig, "torso", f, (0.05 * s, 0, -0.06))
        key(rig, "foot_ik.L", f, (0, 0, max(0, 0.12 * s)))
        key(rig, "foot_ik.R", f, (0, 0, max(0, -0.12 * s)))
    return activate(rig)


def key(rig, name, frame, place):
    bone = rig.pose.bones[name]
    bone.location = place
    bone.keyframe_insert("location", frame=frame)


def boxes(rig):
    """A mesh of a box along each deform bone."""
    me = bpy.data.meshes.new("body")
    ob = bpy.data.objects.new("body", me)
    bpy.context.scene.collection.objects.link(ob)
    bm = bmesh.new()
    layer = bm.verts.layers.deform.verify()
    for b in rig.data.bones:
        if not b.use_deform:
            continue
        group = ob.vertex_groups.new(name=b.name).index
        r = 0.10 if "spine" in b.name else min(0.09, max(0.02, b.length * 0.22))
        made = []
        for y in (0, b.length):
            for x, z in ((-r, -r), (r, -r), (r, r), (-r, r)):
                v = bm.verts.new(b.matrix_local @ Vector((x, y, z)))
                v[layer][group] = 1.0
                made.append(v)
        for f in ((0, 1, 2, 3), (7, 6, 5, 4), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)):
            bm.faces.new([made[i] for i in f])
    bm.normal_update()
    bm.to_mesh(me)
    bm.free()
    ob.modifiers.new("Armature", "ARMATURE").object = rig
    ob.parent = rig


# Names of Blender's metarig, and those of other rigs. A side is L or R.
MIXAMO = {
    "spine": "mixamorig:Hips",
    "spine.001": "mixamorig:Spine",
    "spine.002": "mixamorig:Spine1",
    "spine.003": "mixamorig:Spine2",
    "spine.004": "mixamorig:Neck",
    "spine.006": "mixamorig:Head",
    "shoulder": "mixamorig:{long}Shoulder",
    "upper_arm": "mixamorig:{long}Arm",
    "forearm": "mixamorig:{long}ForeArm",
    "hand": "mixamorig:{long}Hand",
    "thigh": "mixamorig:{long}UpLeg",
    "shin": "mixamorig:{long}Leg",
    "foot": "mixamorig:{long}Foot",
    "toe": "mixamorig:{long}ToeBase",
}
AUTO_RIG_PRO = {
    "spine": "root.x",
    "spine.001": "spine_01.x",
    "spine.002": "spine_02.x",
    "spine.003": "spine_03.x",
    "spine.004": "neck.x",
    "spine.006": "head.x",
    "shoulder": "shoulder.{short}",
    "upper_arm": "arm_stretch.{short}",
    "forearm": "forearm_stretch.{short}",
    "hand": "hand.{short}",
    "thigh": "thigh_stretch.{short}",
    "shin": "leg_stretch.{short}",
    "foot": "foot.{short}",
    "toe": "toes_01.{short}",
}


def metarig(names):
    """Blender's basic metarig with the names of another rig, a skin of boxes and a nod of the spine; other bones do not deform."""
    addon_utils.enable("rigify", default_set=True)
    bpy.ops.object.armature_basic_human_metarig_add()
    rig = bpy.context.object
    for bone in rig.data.bones:
        stem, _, side = bone.name.rpartition(".")
        stem, side = (stem, side) if side in {"L", "R"} else (bone.name, "")
        wanted = names.get(stem)
        bone.use_deform = wanted is not None
        if wanted is not None:
            bone.name = wanted.format(long={"L": "Left", "R": "Right"}.get(side), short=side.lower())
    boxes(rig)
    for frame, angle in ((FIRST, 0.0), (30, 0.3), (60, 0.0)):
        bone = rig.pose.bones[names["spine.002"]]
        bone.rotation_mode, bone.rotation_euler = "XYZ", (angle, 0, 0)
        bone.keyframe_insert("rotation_euler", frame=frame)
    return activate(rig)


RIGS = {
    "cesium_man": cesium_man,
    "knight": knight,
    "rigify_human": rigify_human,
    "fox": fox,
    "scale_100": scale_100,
    "gunner": gunner,
}
