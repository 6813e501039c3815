"""Properties of scenes, armatures, bones and objects."""

import math

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)


RANGE = {"size": 2, "min": -math.pi, "max": math.pi, "subtype": "NONE", "unit": "ROTATION"}
MODES = (
    ("KEYED", "Keyed", "Your animation has it"),
    ("POWERED", "Powered", "Muscles draw it to your animation; it gives way to what it meets"),
    ("LIMP", "Limp", "It hangs"),
)
# True while the add-on itself sets values, which do not count as edits.
_filling = [False]


class Finding(bpy.types.PropertyGroup):
    code: StringProperty()
    severity: StringProperty()
    bones: StringProperty()
    cause: StringProperty()
    evidence: StringProperty()
    fix: StringProperty()


def _edited(bone_settings, context):
    """Applies a change in a bone's panel to the definition."""
    if _filling[0]:
        return
    arm = bone_settings.id_data
    # Blender gives no path from such a value to its bone.
    here = bone_settings.as_pointer()
    name = next(bone.name for bone in arm.pose.bones if bone.sinew.as_pointer() == here)
    from . import bodies

    bodies.edit(arm, name)


class BoneSettings(bpy.types.PropertyGroup):
    role: StringProperty(name="Role", description="Part of the body that this bone is, such as leftUpperArm; empty: recognised")
    ignored: BoolProperty(name="No body", description="This bone and all below it are no part of the body: a cape, a flag")
    has_body: BoolProperty()
    has_swing: BoolProperty()
    has_twist: BoolProperty()
    mass: FloatProperty(name="Mass", unit="MASS", min=1e-4, soft_max=100, default=1, precision=3, update=_edited)
    size: FloatProperty(name="Size", description="Factor on the fitted shape", min=0.05, soft_max=3, default=1, update=_edited)
    swing_y: FloatVectorProperty(name="Swing Y", update=_edited, **RANGE)
    swing_z: FloatVectorProperty(name="Swing Z", update=_edited, **RANGE)
    twist: FloatVectorProperty(name="Twist", update=_edited, **RANGE)
    friction: FloatProperty(name="Friction", description="Torque with which the joint resists, N·m", min=0, update=_edited)


class Ragdoll:
    """Properties of a ragdoll: the definition, and what the add-on has to restore when it is removed."""

    definition: StringProperty()
    fitted: StringProperty()
    # World matrix of the armature at the time of the build: 16 numbers.
    place: StringProperty()
    # The bones with bodies at the time of the build, see `bodies`.
    rest: StringProperty()
    report: StringProperty()
    keyed: StringProperty()
    # Values of the bones' channels before they were keyed.
    own_pose: StringProperty()
    own_action: PointerProperty(type=bpy.types.Action)
    # Name of the track that took the user's Action below a strip.
    own_track: StringProperty()
    made_action: PointerProperty(type=bpy.types.Action)


class ArmatureSettings(Ragdoll, bpy.types.PropertyGroup):
    height: FloatProperty(name="Height", description="Height of the character in metres; 0: read from the armature", min=0, soft_max=4, max=1000)
    mass: FloatProperty(name="Mass", description="Mass of the character in kg; 0: by its height and volume", min=0, soft_max=300)
    springs: BoolProperty(name="Springs", description="What is called hair, ear, tail, skirt or ribbon swings")
    show_bodies: BoolProperty(name="Bodies", default=True, description="Draw the bodies")
    show_limits: BoolProperty(name="Limits", default=True, description="Draw how far the joints of selected bones turn")
    show_masses: BoolProperty(name="Masses", default=False, description="Write the mass at each body")
    findings: CollectionProperty(type=Finding)
    finding: IntProperty()


class Override(Ragdoll, bpy.types.PropertyGroup):
    """The ragdoll of a library override, see `overrides`."""

    armature: PointerProperty(type=bpy.types.Object)


class BodySettings(bpy.types.PropertyGroup):
    collides: BoolProperty(name="Collides", description="Simulated characters collide with this mesh, also while it moves")
    friction: FloatProperty(name="Friction", min=0, max=2, default=0.6)


class HitSettings(bpy.types.PropertyGroup):
    enabled: BoolProperty(name="Hit", description="This empty hits a bone along its arrow")
    armature: PointerProperty(type=bpy.types.Object, name="Armature", poll=lambda self, ob: ob.type == "ARMATURE")
    bone: StringProperty(name="Bone")
    frame: IntProperty(name="Frame", default=45)
    impulse: FloatProperty(name="Impulse", description="N·s: a shove is 50 to 100, a punch 30, a car 1,000 and more; at most 30 m/s times the character's mass, and 4,000 m/s times the bone's", default=100, min=0)


class SceneSettings(bpy.types.PropertyGroup):
    overrides: CollectionProperty(type=Override)
    use_range: BoolProperty(name="Own range", description="Simulate other frames than the scene's")
    frame_start: IntProperty(name="Start", default=1)
    frame_end: IntProperty(name="End", default=150)
    by: EnumProperty(
        name="Hand-over",
        items=(
            ("FRAME", "At a frame", "Your animation plays until that frame, then the bodies take over"),
            ("HITS", "By hits", "Your animation plays until the first hit strikes"),
        ),
    )
    handover: IntProperty(name="Frame", default=45, description="First frame that is simulated")
    use_return: BoolProperty(name="Return", description="Come back to your animation at a frame")
    return_frame: IntProperty(name="Frame", default=120, description="First frame that your animation alone has again")
    return_blend: IntProperty(name="Blend", default=15, min=1, description="Frames before that in which the simulated pose dies away; fewer than between hand-over and return")
    gets_up: BoolProperty(name="Get up", description="Once it lies still it gets up, if it is a humanoid")
    push_over: BoolProperty(
        name="Push over", default=True, description="One that is limp and would stay upright on its broad feet is pushed forward"
    )
    stiffness: FloatProperty(
        name="Stiffness", min=0, max=1, subtype="FACTOR", description="Strength with which muscles hold your animation's pose while it falls"
    )
    ground: BoolProperty(name="Ground", default=True, description="A plane that everything lies on")
    ground_height: FloatProperty(name="Height", unit="LENGTH")
    ground_friction: FloatProperty(name="Friction", min=0, max=2, default=0.6)
    wind: FloatVectorProperty(name="Wind", subtype="VELOCITY", unit="VELOCITY", description="Velocity of the air, m/s")
    keys: EnumProperty(
        name="Keys",
        items=(
            ("AUTO", "Automatic", "An Action, a strip over NLA tracks, or a proxy where constraints move the bones"),
            ("ACTION", "Action", "A copy of your Action with a key a frame from the hand-over on"),
            ("STRIP", "NLA strip", "A strip on a new track over your animation"),
            ("PROXY", "Proxy", "An armature that the rig follows by constraints; your controls stay as they are"),
        ),
    )


CLASSES = (Finding, BoneSettings, ArmatureSettings, Override, BodySettings, HitSettings, SceneSettings)
POINTERS = (
    (bpy.types.Scene, "sinew", SceneSettings),
    (bpy.types.Object, "sinew", ArmatureSettings),
    (bpy.types.Object, "sinew_body", BodySettings),
    (bpy.types.Object, "sinew_hit", HitSettings),
    (bpy.types.PoseBone, "sinew", BoneSettings),
)


class filling:
    """Values assigned within this context do not count as edits of the user."""

    def __enter__(self):
        _filling[0] = True

    def __exit__(self, *_):
        _filling[0] = False


def _make_overridable(cls):
    """Marks all values of a group as values that can change on a library override; `overrides` saves them."""
    for prop in cls.__annotations__.values():
        insertion = {"USE_INSERTION"} if prop.function is CollectionProperty else set()
        prop.keywords["override"] = {"LIBRARY_OVERRIDABLE"} | insertion


def register():
    for cls in CLASSES:
        _make_overridable(cls)
        bpy.utils.register_class(cls)
    for owner, name, cls in POINTERS:
        setattr(owner, name, PointerProperty(type=cls))
    # Separate, since values within a property group of a bone cannot be keyed.
    bpy.types.PoseBone.sinew_mode = EnumProperty(
        items=MODES,
        name="Mode",
        description="What moves this bone; can be keyed over time",
        override={"LIBRARY_OVERRIDABLE"},
    )


def unregister():
    del bpy.types.PoseBone.sinew_mode
    for owner, name, _ in POINTERS:
        delattr(owner, name)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
