"""Runs the whole workflow on one rig: `python job.py RIG`. The extension is installed by then (install.py)."""

import json
import sys

import bpy

import installed
import rigs
from installed import addon
from rigs import FIRST, LAST

HANDOVER, RETURN = 45, 120
# Largest distances: of the simulation from the user's animation before the hand-over, of the keyed rig likewise, of joints, metres.
BEFORE, GAP = 1e-3, 1e-3
# At the return: largest jump of a bone within a frame beyond the user's own motion, metres, and of its speed, m/s.
POP, POP_SPEED = 0.03, 0.15
FALLEN = 0.25


def posed(arm, names, first=FIRST, last=LAST):
    """World matrices of the evaluated bones at every frame."""
    frames = []
    for frame in range(first, last + 1):
        bpy.context.scene.frame_set(frame)
        evaluated = arm.evaluated_get(bpy.context.evaluated_depsgraph_get())
        frames.append({n: evaluated.matrix_world @ evaluated.pose.bones[n].matrix for n in names})
    return frames


def off(a, b, names):
    return max((a[n].translation - b[n].translation).length for n in names)


def counts():
    """Contents of the file, to compare after an undo."""
    kinds = ("objects", "actions", "armatures", "meshes", "collections")
    return {kind: sorted(x.name for x in getattr(bpy.data, kind)) for kind in kinds}


def settings(**wanted):
    scene = bpy.context.scene
    for key, value in wanted.items():
        setattr(scene.sinew, key, value)


def check(holds, what):
    if not holds:
        raise AssertionError(what)


def joint_gap(frames, arm, skeleton, unit, first):
    """Largest change of the distance between a bone's head and its parent's below the first body, metres: such changes tear the skin."""
    worst, below = 0.0, {first}
    for n in skeleton.names:
        p = skeleton.parent[n]
        if p not in below:
            continue
        below.add(n)
        rest = (arm.data.bones[p].matrix_local.inverted() @ arm.data.bones[n].matrix_local).translation
        scale = arm.matrix_world.median_scale
        for frame in frames:
            between = (frame[n].translation - frame[p].translation).length
            worst = max(worst, abs(between - rest.length * scale) * unit)
    return worst


def main(name):
    rigs.empty_scene()
    arm = rigs.RIGS[name]()
    sk = addon().skeleton
    skeleton = sk.skeleton_of(arm)
    names = skeleton.names
    own = posed(arm, names)
    before = counts()

    check(bpy.ops.sinew.build() == {"FINISHED"}, "it is built")
    definition = json.loads(arm.sinew.definition)
    unit, root = definition["unit_scale"], definition["bodies"][0]["bone"]
    check(len(definition["bodies"]) >= 12, "it has bodies")
    check(bpy.ops.sinew.doctor() == {"FINISHED"}, "it is examined")
    check(not [f for f in arm.sinew.findings if f.severity == "error"], "the doctor finds no error")
    lines = addon().overlay.pieces(arm)
    check(len(lines) == len(definition["bodies"]), "each body is drawn")

    settings(by="FRAME", handover=HANDOVER, use_return=False, keys="AUTO")
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    report = json.loads(arm.sinew.report)
    check(report["verdict"] == "good", f"verdict {report['verdict']}: {report['reasons']}")
    check(report["before_handover_mm"] < 1e3 * BEFORE, f"{report['before_handover_mm']} mm before the hand-over")
    check(report["joint_gap_mm"] < 1e3 * GAP, f"joints gape by {report['joint_gap_mm']} mm")
    keyed = posed(arm, names)
    i = HANDOVER - FIRST
    error = max(off(keyed[f], own[f], names) for f in range(i)) * unit
    check(error < BEFORE, f"keys are {1e3 * error} mm from the user's animation before the hand-over")
    own_gap = joint_gap(own[:i], arm, skeleton, unit, root)
    gap = joint_gap(keyed[i:], arm, skeleton, unit, root)
    check(gap < own_gap + GAP, f"bones of the keyed rig are apart by {1e3 * gap} mm, by {1e3 * own_gap} mm in the user's own")
    top = max(names, key=lambda n: own[i][n].translation.z)
    drop = (own[i][top].translation.z - keyed[-1][top].translation.z) * unit
    check(drop > FALLEN * definition["height"], f"{top} fell by {drop} m only")
    jump = max((keyed[i][n].translation - keyed[i - 1][n].translation).length for n in names) * unit
    was = max((own[i][n].translation - own[i - 1][n].translation).length for n in names) * unit
    check(jump < was + POP, f"a bone jumps by {jump} m at the hand-over, {was} m in the user's own")

    # A second run gives the same keys.
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated again")
    again = posed(arm, names)
    check(json.loads(arm.sinew.report)["hash"] == report["hash"], "two runs end in one state")
    check(all(a[n] == b[n] for a, b in zip(keyed, again) for n in names), "two runs give the same keys")

    # Back in the user's animation.
    settings(use_return=True, return_frame=RETURN, return_blend=20)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it returns")
    back = posed(arm, names)
    r = RETURN - FIRST
    after = max(off(back[f], own[f], names) for f in range(r, len(own))) * unit
    check(after < BEFORE, f"after the return it is {1e3 * after} mm from the user's animation")
    fps = rigs.FPS
    pop = pop_speed = 0.0
    for n in names:
        step = lambda frames, f: (frames[f][n].translation - frames[f - 1][n].translation) * unit  # noqa: E731
        pop = max(pop, (step(back, r) - step(own, r)).length)
        pop_speed = max(pop_speed, ((step(back, r + 1) - step(own, r + 1)) * fps).length, ((step(back, r) - step(own, r)) * fps).length)
    check(pop < POP and pop_speed < POP_SPEED, f"the return pops by {pop} m and {pop_speed} m/s")

    # Everything is removed.
    check(bpy.ops.sinew.clear() == {"FINISHED"}, "keys are cleared")
    cleared = posed(arm, names)
    error = max(off(a, b, names) for a, b in zip(cleared, own)) * unit
    check(error == 0.0, f"cleared, it is {error} m from the user's animation")
    left = {kind: sorted(set(now) - set(before[kind])) for kind, now in counts().items()}
    check(not any(left.values()), f"left over: {left}")
    print(
        f"PASS {name}: {report['keyed'].lower()}, {len(definition['bodies'])} bodies, before {report['before_handover_mm']} mm, "
        f"gap {report['joint_gap_mm']:.4f} mm simulated, {1e3 * max(gap - own_gap, 0):.3f} mm in the rig beyond its own animation's, fell {drop:.2f} m, return {1e3 * pop:.2f} mm {100 * pop_speed:.2f} cm/s"
    )


if __name__ == "__main__":
    installed.install()
    main(sys.argv[1])
