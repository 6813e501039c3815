"""Sinew in Blender: ragdolls of your armature, simulated into keys."""

bl_info = {
    "name": "Sinew",
    "author": "The Sinew developers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Sinew",
    "description": "Ragdolls of your armature, simulated into keys",
    "category": "Animation",
}

from . import handles, operators, overlay, overrides, panels, preview, properties  # noqa: E402

MODULES = (properties, operators, panels, overlay, handles, preview, overrides)


def register():
    for module in MODULES:
        module.register()


def unregister():
    for module in reversed(MODULES):
        module.unregister()
