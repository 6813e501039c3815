"""The definition stored on the armature, and the bone panels that show it."""

import json
import math

from . import bridge, properties
from . import skeleton as sk
from .skeleton import SinewError


# Smallest change of a bone at rest that counts: of its axes, and of its place as a share of its length.
MOVED = 1e-3


def store(arm, ragdoll):
    """Stores a ragdoll on the armature and fills in the bones' panels."""
    arm.sinew.definition = ragdoll.to_json()
    arm.sinew.fitted = arm.sinew.definition
    arm.sinew.place = sk.text_of(sk.straight(arm.matrix_world))
    arm.sinew.rest = json.dumps(_rest(arm, set(ragdoll.bones)))
    show(arm)


def show(arm):
    """Fills in the bones' panels from the definition."""
    by_bone = {body["bone"]: body for body in json.loads(arm.sinew.definition)["bodies"]} if arm.sinew.definition else {}
    with properties.filling():
        for bone in arm.pose.bones:
            body, settings = by_bone.get(bone.name), bone.sinew
            settings.has_body = body is not None
            settings.has_swing = settings.has_twist = False
            if body is None:
                continue
            settings.mass = body["mass"]["kg"]
            settings.size = _size(arm, body)
            joint = body.get("joint") or {}
            settings.friction = joint.get("friction_torque", 0.0)
            limits = joint.get("limits_deg") or {}
            settings.has_swing = "swing_y" in limits
            settings.has_twist = "twist" in limits
            for key in ("swing_y", "swing_z", "twist"):
                if key in limits:
                    setattr(settings, key, [math.radians(x) for x in limits[key]])


def _rest(arm, names):
    """Returns for each bone its length, the next bone above it that is among these, and its matrix at rest."""
    found = {}
    for name in names:
        bone = arm.data.bones[name]
        above = next((up.name for up in bone.parent_recursive if up.name in names), "")
        found[name] = [bone.length, above, [list(row) for row in bone.matrix_local]]
    return found


def changed(arm):
    """A warning about bones that were moved or got another parent since the build."""
    was = json.loads(arm.sinew.rest or "{}")
    now = _rest(arm, set(was))
    moved = [name for name in was if _differs(was[name], now[name])]
    if not moved:
        return []
    more = f" and {len(moved) - 3} more" if len(moved) > 3 else ""
    return [f"{arm.name} changed since its ragdoll was built ({', '.join(moved[:3])}{more}): build its ragdoll again"]


def _differs(was, now):
    (length, above, matrix), (_, above_now, matrix_now) = was, now
    rows = [[abs(a - b) for a, b in zip(*both)] for both in zip(matrix[:3], matrix_now)]
    return above != above_now or max(max(row[:3]) for row in rows) > MOVED or max(row[3] for row in rows) > MOVED * length


def edits(arm):
    """Number of bones whose bodies differ from those that were built."""
    if not arm.sinew.definition or not arm.sinew.fitted:
        return 0
    fitted = {body["bone"]: body for body in json.loads(arm.sinew.fitted)["bodies"]}
    return sum(body != fitted.get(body["bone"]) for body in json.loads(arm.sinew.definition)["bodies"])


def _size(arm, body):
    """Size of a body's shape relative to the fitted one."""
    fitted = next((b for b in json.loads(arm.sinew.fitted)["bodies"] if b["bone"] == body["bone"]), body)
    own, was = _extent(body["shape"]), _extent(fitted["shape"])
    return own / was if was > 0 else 1.0


def _extent(shape):
    if shape["type"] == "box":
        return shape["half_extents"][0]
    return shape.get("radius", shape.get("radius_bottom", 0.0))


def edit(arm, name):
    """Applies the values of a bone's panel to the definition."""
    if not arm.sinew.definition:
        return
    settings = arm.pose.bones[name].sinew
    ragdoll = bridge.ragdoll(arm)
    if name not in ragdoll.bones:
        return
    body = next(b for b in json.loads(arm.sinew.definition)["bodies"] if b["bone"] == name)
    wanted = {"mass": settings.mass, "scale": settings.size / _size(arm, body)}
    if settings.has_swing:
        # The range of a swing must include zero.
        wanted["swing_y"], wanted["swing_z"] = (
            (min(*v, 0.0), max(*v, 0.0)) for v in (settings.swing_y, settings.swing_z)
        )
    if settings.has_twist:
        low, high = settings.twist
        wanted["twist"] = (min(low, high), max(low, high))
    if body.get("joint"):
        wanted["friction_torque"] = settings.friction
    try:
        changed = bridge.asked(ragdoll.edited, name, **wanted)
    except SinewError:
        # An invalid value is reset to the last valid one.
        return show(arm)
    arm.sinew.definition = changed.to_json()
