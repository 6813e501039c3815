"""Keeps the ragdolls of library overrides: Blender saves an override's own values only where the linked file has them too, so that the
scene holds them in the file."""

import bpy

from . import bodies, properties

# Names of a ragdoll's properties.
KEPT = tuple(properties.Ragdoll.__annotations__)


def armatures():
    return [ob for ob in bpy.data.objects if ob.type == "ARMATURE" and ob.override_library is not None]


@bpy.app.handlers.persistent
def keep(*_):
    for scene in bpy.data.scenes:
        if scene.library is not None:
            continue
        kept = scene.sinew.overrides
        kept.clear()
        for arm in armatures():
            if arm.sinew.definition and arm.name in scene.objects:
                one = kept.add()
                one.armature = arm
                for name in KEPT:
                    setattr(one, name, getattr(arm.sinew, name))


@bpy.app.handlers.persistent
def restore(*_):
    for scene in bpy.data.scenes:
        for one in scene.sinew.overrides:
            arm = one.armature
            if arm is None or arm.sinew.definition or arm.override_library is None:
                continue
            for name in KEPT:
                setattr(arm.sinew, name, getattr(one, name))
            bodies.show(arm)


def register():
    bpy.app.handlers.save_pre.append(keep)
    bpy.app.handlers.load_post.append(restore)


def unregister():
    bpy.app.handlers.save_pre.remove(keep)
    bpy.app.handlers.load_post.remove(restore)
