"""Runs every operator on some rig: `python operators.py`."""

import ctypes
import importlib.util
import json
import os
import tempfile

import bpy
import numpy as np
from mathutils import Matrix, Vector

import installed
import rigs
from installed import addon
from job import check, counts, off, posed, settings
from rigs import FIRST, LAST

CHECKS = []


def case(function):
    CHECKS.append(function)
    return function


def fresh(make=rigs.cesium_man):
    rigs.empty_scene()
    arm = make()
    check(bpy.ops.sinew.build() == {"FINISHED"}, "it is built")
    return arm, addon().skeleton.skeleton_of(arm).names


def report(arm):
    return json.loads(arm.sinew.report)


def refused(operator, words, **arguments):
    try:
        done = operator(**arguments)
    except RuntimeError as error:
        check(words in str(error), f"it says '{words}', not: {error}")
        check("Traceback" not in str(error) and str(error).count("\n") <= 1, f"one line: {error}")
        return
    raise AssertionError(f"{operator} is refused, not {done}")


def said(operator, **arguments):
    """What an operator reports: Blender prints it."""
    flush = ctypes.CDLL(None).fflush
    with tempfile.TemporaryFile() as file:
        flush(None)
        kept = os.dup(1)
        os.dup2(file.fileno(), 1)
        try:
            operator(**arguments)
        finally:
            flush(None)
            os.dup2(kept, 1)
            os.close(kept)
        file.seek(0)
        return file.read().decode()


def box(name, at, size):
    bpy.ops.mesh.primitive_cube_add(size=1, location=at)
    made = bpy.context.object
    made.name, made.scale = name, size
    return made


@case
def hits_of_empties_fell_it_where_they_strike():
    arm, names = fresh()
    arm.data.bones.active = arm.data.bones["torso_joint_3"]
    bpy.context.scene.frame_set(50)
    check(bpy.ops.sinew.add_hit(impulse=120) == {"FINISHED"}, "a hit is added")
    settings(by="HITS", use_return=False)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    check(abs(report(arm)["handover"] - 50) <= 1, f"it fell at {report(arm)['handover']}")
    keyed = posed(arm, names)
    chest = [frame["torso_joint_3"].translation.y for frame in keyed]
    check(chest[60 - FIRST] > chest[50 - FIRST] + 0.05, "it went along the arrow, +Y")
    bpy.data.objects["Hit torso_joint_3"].sinew_hit.bone = "wing"
    refused(bpy.ops.sinew.simulate, "no bone wing")


@case
def a_hit_is_limited_to_what_a_body_takes():
    arm, names = fresh()
    masses = {b["bone"]: b["mass"]["kg"] for b in json.loads(arm.sinew.definition)["bodies"]}
    settings(by="HITS", use_return=False)
    own = posed(arm, names, 53, 53)[0]
    hand, chest = "Skeleton_arm_joint_L__2_", "torso_joint_3"
    for bone, most in ((hand, 4000.0 * masses[hand]), (chest, 30.0 * sum(masses.values()))):
        bpy.context.scene.frame_set(50)
        arm.data.bones.active = arm.data.bones[bone]
        bpy.ops.sinew.add_hit(impulse=20000)
        check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
        notes = report(arm)["notes"]
        check(len(notes) == 1 and f"Hit {bone}: 20,000 N·s" in notes[0] and f"{most:,.0f} N·s" in notes[0], f"{notes}")
        moved = posed(arm, names, 53, 53)[0][names[0]].translation.y - own[names[0]].translation.y
        check(moved > 0.5, f"it is thrown along the arrow: {moved}")
        bpy.data.objects.remove(bpy.data.objects[f"Hit {bone}"])


@case
def an_overlap_at_the_hand_over_is_told():
    arm, _ = fresh()
    settings(by="FRAME", handover=45, use_return=False)
    check(bpy.ops.sinew.simulate() == {"FINISHED"} and report(arm)["notes"] == [], f"{report(arm)['notes']}")
    settings(ground_height=0.19)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated in the ground")
    notes = report(arm)["notes"]
    check(len(notes) == 1 and "Armature is 0.22 m" in notes[0] and "inside the ground" in notes[0], f"{notes}")
    settings(ground_height=0.0)
    crate = box("crate", (0, 0, 0), (4, 4, 0.38))
    beside = box("beside", (0, 3, 0), (1, 1, 4))
    crate.sinew_body.collides = beside.sinew_body.collides = True
    rigs.activate(arm)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated in the crate")
    notes = report(arm)["notes"]
    check(len(notes) == 1 and "inside crate: move it" in notes[0], f"{notes}")


@case
def a_scaled_bone_is_told():
    arm, _ = fresh()
    arm.animation_data_clear()
    arm.pose.bones["torso_joint_3"].scale = (1.3, 1.3, 1.3)
    settings(by="FRAME", handover=45, use_return=False)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    notes = report(arm)["notes"]
    check(len(notes) == 1 and "stretched by up to 7 cm" in notes[0], f"{notes}")
    rigs.empty_scene()
    arm = rigs.cesium_man()
    arm.scale = (1.0, 1.3, 0.8)
    bpy.context.view_layer.update()
    settings(by="FRAME", handover=45, use_return=False)
    check(bpy.ops.sinew.build() == {"FINISHED"} and bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    notes = report(arm)["notes"]
    check(len(notes) == 1 and "object's scale differs by axes" in notes[0], f"{notes}")


@case
def a_run_without_a_build_keeps_its_ragdoll():
    for run in (bpy.ops.sinew.preview, bpy.ops.sinew.simulate):
        rigs.empty_scene()
        arm = rigs.cesium_man()
        settings(by="FRAME", handover=45, use_return=False)
        check(run() == {"FINISHED"} and arm.sinew.definition, "it has a ragdoll")
        check(bpy.ops.sinew.doctor() == {"FINISHED"}, "which the doctor examines")


@case
def it_lies_on_what_it_collides_with_and_is_moved_by_what_moves():
    arm, names = fresh()
    table = box("table", (0, 0, -0.55), (6, 6, 1))
    table.select_set(True)
    bpy.ops.sinew.collide(collides=True)
    rigs.activate(arm)
    settings(by="FRAME", handover=30, ground=False)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    lowest = min(m.translation.z for m in posed(arm, names)[-1].values())
    check(-0.12 < lowest < 0.3, f"it lies on the table at -0.05: {lowest}")
    still = posed(arm, names)[-1]
    plough = box("plough", (0, 4, 0.5), (8, 0.5, 2))
    for frame, y in ((90, 4.0), (140, -2.0)):
        plough.location.y = y
        plough.keyframe_insert("location", frame=frame)
    plough.sinew_body.collides = True
    rigs.activate(arm)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated with the plough")
    moved = posed(arm, names)[-1]
    hips = names[0]
    check(moved[hips].translation.y < still[hips].translation.y - 0.5, "the plough shoves it")


@case
def wind_and_stiffness_change_the_fall():
    arm, _ = fresh()
    settings(by="FRAME", handover=30)
    hashes = set()
    for wanted in ({}, {"wind": (0, 60, 0)}, {"wind": (0, 0, 0), "stiffness": 0.6}):
        settings(**wanted)
        check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
        hashes.add(report(arm)["hash"])
    check(len(hashes) == 3, "three falls differ")


@case
def nla_tracks_stay_below_a_strip():
    arm, names = fresh()
    own = posed(arm, names)
    data = arm.animation_data
    action, slot = data.action, getattr(data, "action_slot", None)
    if action is not None:
        track = data.nla_tracks.new()
        strip = track.strips.new("mine", 1, action)
        if slot is not None:
            strip.action_slot = slot
        data.action = None
        own = posed(arm, names)
    settings(by="FRAME", handover=40, keys="AUTO", use_return=True, return_frame=100, return_blend=15)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    check(report(arm)["keyed"] == "STRIP", report(arm)["keyed"])
    keyed = posed(arm, names)
    before = max(off(keyed[f], own[f], names) for f in range(39))
    after = max(off(keyed[f], own[f], names) for f in range(100 - FIRST, LAST - FIRST + 1))
    check(before < 1e-5 and after < 1e-5, f"before {before}, after {after}")
    check(off(keyed[60], own[60], names) > 0.1, "and between it falls")


@case
def clearing_a_strip_makes_the_action_active_again():
    arm, names = fresh()
    own, data = posed(arm, names), arm.animation_data
    if data.action is None:
        strip = data.nla_tracks[0].strips[0]
        action, slot = strip.action, getattr(strip, "action_slot", None)
        data.nla_tracks.remove(data.nla_tracks[0])
        data.action = action
        if slot is not None:
            data.action_slot = slot
        own = posed(arm, names)
    action, tracks = data.action, len(data.nla_tracks)
    settings(by="FRAME", handover=40, keys="STRIP", use_return=False)
    for _ in range(2):
        check(bpy.ops.sinew.simulate() == {"FINISHED"} and data.action is None, "the strip is over a track of the Action")
    check(bpy.ops.sinew.clear() == {"FINISHED"}, "it is cleared")
    check(data.action == action and len(data.nla_tracks) == tracks, f"{data.action}, {len(data.nla_tracks)} tracks")
    check(max(off(a, b, names) for a, b in zip(posed(arm, names), own)) == 0.0, "it moves as before")


@case
def a_bone_can_be_limp_or_powered_over_time():
    arm, names = fresh()
    hand, elbow = "Skeleton_arm_joint_L__2_", "Skeleton_arm_joint_L__3_"
    bone = arm.pose.bones[elbow]
    for frame, mode in ((1, "KEYED"), (20, "LIMP"), (70, "KEYED")):
        bone.sinew_mode = mode
        bone.keyframe_insert("sinew_mode", frame=frame)
    own = posed(arm, names)
    settings(by="HITS", use_return=False)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    keyed = posed(arm, names)
    away = [(a[hand].translation - b[hand].translation).length for a, b in zip(keyed, own)]
    check(max(away[:19]) < 1e-3, "before, the animation has it")
    check(max(away[25:65]) > 0.015, f"limp, it hangs: {max(away[25:65])}")
    feet = max((a["leg_joint_L_3"].translation - b["leg_joint_L_3"].translation).length for a, b in zip(keyed, own))
    check(feet < 0.02, f"all else goes on: {feet}")
    check(away[-1] < 0.02, f"and it comes back: {away[-1]}")


@case
def a_mode_without_keys_is_taken():
    arm, names = fresh()
    own = posed(arm, names)
    for joint in ("Skeleton_arm_joint_L__4_", "Skeleton_arm_joint_L__3_", "Skeleton_arm_joint_L__2_"):
        arm.pose.bones[joint].sinew_mode = "LIMP"
    settings(by="FRAME", handover=140, use_return=False)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    away = off(posed(arm, names, 100, 100)[0], own[100 - FIRST], ["Skeleton_arm_joint_L__2_"])
    check(away > 0.05, f"the arm hangs: {away}")


@case
def values_of_a_bone_go_into_the_definition():
    arm, _ = fresh()
    bone = next(b for b in arm.pose.bones if b.sinew.has_swing)
    was = json.loads(arm.sinew.definition)
    bone.sinew.mass = 2.5
    bone.sinew.swing_y = (-0.3, 0.4)
    bone.sinew.size = 1.2
    now = json.loads(arm.sinew.definition)
    pick = lambda d: next(b for b in d["bodies"] if b["bone"] == bone.name)  # noqa: E731
    check(abs(pick(now)["mass"]["kg"] - 2.5) < 1e-4, "mass")
    check([round(x, 1) for x in pick(now)["joint"]["limits_deg"]["swing_y"]] == [-17.2, 22.9], "limits")
    check(pick(now)["shape"] != pick(was)["shape"], "size")
    check(abs(bone.sinew.size - 1.2) < 1e-3, "which the panel shows")
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "and it falls with them")
    bone.sinew.swing_y = (0.4, -0.3)
    now = json.loads(arm.sinew.definition)
    check([round(x, 1) for x in pick(now)["joint"]["limits_deg"]["swing_y"]] == [-17.2, 22.9], "inverted limits are sorted")


@case
def the_doctor_selects_and_mends():
    arm, _ = fresh()
    bone = next(b for b in arm.pose.bones if b.sinew.has_body and b.parent is not None and b.parent.sinew.has_body)
    bone.sinew.mass = 900.0
    bpy.ops.sinew.doctor()
    found = [i for i, f in enumerate(arm.sinew.findings) if bone.name in json.loads(f.bones)]
    check(found, "a bone of 900 kg is found")
    check(bpy.ops.sinew.select_finding(index=found[0]) == {"FINISHED"}, "and selected")
    chosen = {b.name for b in (*arm.data.bones, *arm.pose.bones) if getattr(b, "select", False)}
    check(bone.name in chosen, f"it is among {chosen}")
    check(bpy.ops.sinew.cure() == {"FINISHED"}, "and mended")
    check(bone.sinew.mass < 100, f"it weighs {bone.sinew.mass} kg")


@case
def a_build_tells_what_it_resets_and_a_fix_what_it_changes():
    arm, _ = fresh()
    for name in ("torso_joint_3", "leg_joint_L_1"):
        arm.pose.bones[name].sinew.mass = 90.0
    words = said(bpy.ops.sinew.cure)
    check("mass ratio: Skeleton_neck_joint_1, torso_joint_3" in words and "mended (limits not mirrored, " in words, words)
    bpy.ops.sinew.build()
    check("edits of" not in said(bpy.ops.sinew.build), "nothing was edited")
    arm.pose.bones["torso_joint_3"].sinew.mass = 9.0
    words = said(bpy.ops.sinew.build)
    check("edits of 1 bone were reset" in words and "17 bodies" in words, words)


@case
def the_doctor_speaks_of_the_panel():
    rigs.empty_scene()
    arm = rigs.cesium_man()
    arm.scale = (20, 20, 20)
    bpy.context.view_layer.update()
    bpy.ops.sinew.build()
    fixes = {f.code: f.fix for f in arm.sinew.findings}
    check("Set Height" in fixes["unit-inferred"] and "--" not in "".join(fixes.values()), f"{fixes}")
    arm.sinew.height = 1.8
    bpy.ops.sinew.build()
    check("unit-inferred" not in {f.code for f in arm.sinew.findings}, "a height was given")


@case
def an_undo_leaves_nothing():
    arm, names = fresh()
    name = arm.name
    bpy.ops.ed.undo_push(message="before")
    before = counts()
    own = posed(arm, names)
    settings(by="FRAME", handover=45)
    bpy.ops.ed.undo_push(message="set")
    check(bpy.ops.sinew.simulate("EXEC_DEFAULT", True) == {"FINISHED"}, "it is simulated")
    check(counts() != before, "an action is there")
    check(bpy.ops.ed.undo() == {"FINISHED"}, "undone once")
    arm = bpy.data.objects[name]
    check(counts() == before, f"{counts()} is not {before}")
    check(max(off(a, b, names) for a, b in zip(posed(arm, names), own)) == 0.0, "it moves as before")


@case
def a_cancelled_simulation_leaves_nothing():
    arm, names = fresh()
    before = counts()
    job = addon().simulation.prepare(bpy.context, [arm])
    job.stage["seconds"] = 3000.0
    job.cancelled = True
    job.start()
    job.thread.join(60)
    check(not job.thread.is_alive() and job.baked is None, "it ends")
    check(isinstance(job.error, addon().bridge.engine().Cancelled), f"as cancelled, not {job.error}")
    check(counts() == before, "and leaves nothing")


def skin_of(arm):
    """Vertices of the evaluated skin in the world."""
    ob = next(ob for ob in bpy.data.objects if ob.type == "MESH" and ob.find_armature() == arm)
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    me = evaluated.to_mesh()
    points = np.empty(len(me.vertices) * 3, np.float32)
    me.vertices.foreach_get("co", points)
    evaluated.to_mesh_clear()
    m = np.array(ob.matrix_world)
    return points.reshape(-1, 3) @ m[:3, :3].T + m[:3, 3]


@case
def a_preview_shows_the_fall_and_changes_nothing():
    arm, names = fresh()
    before, own = counts(), posed(arm, names)
    settings(by="FRAME", handover=45)
    check(bpy.ops.sinew.preview() == {"FINISHED"}, "it is previewed")
    check(counts() == before and arm.sinew.report == "", "nothing is added")
    check(max(off(a, b, names) for a, b in zip(posed(arm, names), own)) == 0.0, "and nothing moves")
    ghost, frames = addon().preview.of(arm), (10, 44, 60, 100, LAST)
    drawn = {f: ghost.vertices(f).copy() for f in frames}
    colors = ghost.colors(60)
    check(colors.shape == (len(drawn[60]), 4) and 0 < colors.min() and colors.max() <= 1, "it is shaded")
    check(ghost.stamp == addon().preview.stamp(bpy.context.scene, arm), "it is up to date")
    settings(stiffness=0.1)
    check(ghost.stamp != addon().preview.stamp(bpy.context.scene, arm), "another setting makes it out of date")
    settings(stiffness=0.0)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    check(addon().preview.of(arm) is None, "the keys take its place")
    for f in frames:
        bpy.context.scene.frame_set(f)
        apart = np.abs(skin_of(arm) - drawn[f]).max()
        check(apart < 1e-3, f"at {f} the keyed skin is {1e3 * apart:.2f} mm from the preview")
    bpy.ops.sinew.preview()
    check(bpy.ops.sinew.end_preview() == {"FINISHED"} and addon().preview.of(arm) is None, "it ends")


@case
def limits_have_handles_where_they_are_drawn():
    for make in (rigs.cesium_man, rigs.scale_100):
        arm, _ = fresh(make)
        handles, overlay = addon().handles, addon().overlay
        bone = next(b for b in arm.pose.bones if b.sinew.has_swing and b.sinew.has_twist)
        arm.data.bones.active = arm.data.bones[bone.name]
        check(handles.limits_of(bone) == ["swing_y", "swing_z", "twist"], "it has all limits")
        frame, reach = handles.frame_of(arm, bone.name)
        drawn = overlay.lines_of(arm, {bone.name})
        for key, lines in (("swing_y", overlay.LIMIT), ("swing_z", overlay.LIMIT), ("twist", overlay.TWIST)):
            for end in (0, 1):
                angle = getattr(bone.sinew, key)[end]
                offset = handles.offset_of(key, angle, reach)
                flat = lambda place: place.xz  # noqa: E731
                found = handles.angle_on_screen(key, frame, reach, frame @ offset, angle + 0.2, flat)
                check((flat(frame @ handles.offset_of(key, found, reach)) - flat(frame @ offset)).length < 0.02 * reach, "it is found on the screen")
                nearest = min((p - frame @ offset).length for p in drawn[lines])
                check(nearest < 0.02 * reach, f"{key}: the handle is {nearest / reach:.3f} cones from its line")
        handles.drag(bone, "swing_y", 1, 0.3)
        handles.drag(bone, "swing_z", 0, 0.4)
        handles.drag(bone, "twist", 1, 0.2)
        limits = next(b for b in json.loads(arm.sinew.definition)["bodies"] if b["bone"] == bone.name)["joint"]["limits_deg"]
        got = [limits["swing_y"][1], limits["swing_z"][0], limits["twist"][1]]
        check([round(x, 2) for x in got] == [17.19, 0.0, 11.46], f"the definition has {got}")


@case
def two_characters_meet():
    rigs.empty_scene()
    one = rigs.cesium_man()
    two = one.copy()
    two.data = one.data
    bpy.context.scene.collection.objects.link(two)
    skin = next(ob for ob in bpy.data.objects if ob.type == "MESH" and ob.find_armature() == one)
    other = skin.copy()
    bpy.context.scene.collection.objects.link(other)
    other.parent = two
    next(m for m in other.modifiers if m.type == "ARMATURE").object = two
    two.matrix_world = Matrix.Translation((0.0, -0.5, 0.0)) @ one.matrix_world
    bpy.context.view_layer.update()
    for arm in (one, two):
        rigs.activate(arm)
        check(bpy.ops.sinew.build() == {"FINISHED"}, "it is built")
    rigs.activate(one)
    two.select_set(True)
    settings(by="FRAME", handover=30)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "both are simulated")
    for arm in (one, two):
        check(report(arm)["before_handover_mm"] < 1.0 and report(arm)["frames"] > 100, f"{report(arm)}")
    check(one.animation_data.action != two.animation_data.action, "each has its own keys")


@case
def fk_controls_of_rigify_take_the_fall():
    arm, names = fresh(rigs.rigify_human)
    settings(by="FRAME", handover=45, use_range=True, frame_start=1, frame_end=90)
    for frame, value in ((1, 1.0), (20, 0.0)):
        arm.pose.bones["thigh_parent.L"]["IK_FK"] = value
        arm.keyframe_insert('pose.bones["thigh_parent.L"]["IK_FK"]', frame=frame)
    user = posed(arm, names, 40, 50)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    own = posed(arm, names)
    check(bpy.ops.sinew.bake_fk() == {"FINISHED"}, "it is baked")
    keyed = posed(arm, names)
    check(not any(c.name == "Sinew" for b in arm.pose.bones for c in b.constraints), "no constraint is left")
    before = max(off(a, b, names) for a, b in zip(keyed[:43], own[:43]))
    limbs = [n for n in names if any(part in n for part in ("arm", "hand", "thigh", "shin", "foot", "head")) and ".001" not in n]
    after = max(off(a, b, limbs) for a, b in zip(keyed[44:90], own[44:90]))
    check(before < 1e-3, f"{1e3 * before} mm before")
    check(after < 0.05, f"{1e3 * after} mm after")
    print(f"  FK controls: limbs within {1e3 * after:.1f} mm")
    check(bpy.ops.sinew.clear() == {"FINISHED"}, "it is cleared")
    left = max(off(a, b, names) for a, b in zip(posed(arm, names, 40, 50), user))
    check(left == 0.0, f"cleared, it is {left} m from the user's animation")


@case
def fk_controls_of_a_rig_with_a_face_take_the_fall():
    arm, names = fresh(rigs.rigify_face)
    first, last, back = 25, 56, 50
    settings(by="FRAME", handover=30, use_return=True, return_frame=back, return_blend=8, use_range=True, frame_start=first, frame_end=last)
    own = posed(arm, names, first, last)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    proxy = posed(arm, names, first, last)
    words = said(bpy.ops.sinew.bake_fk)
    keyed = posed(arm, names, first, last)
    error = max(off(a, b, names) for a, b in zip(keyed, proxy))
    check(error < 0.05, f"a bone is {error} m from the proxy")
    sizes = [abs(length - 1.0) for frame in keyed for n in names for length in frame[n].to_scale()]
    check(max(sizes) < 0.5, f"a bone is scaled by {max(sizes)}")
    after = max(off(keyed[f - first], own[f - first], names) for f in range(back, last + 1))
    check(after < 1e-4, f"after the return it is {after} m from its animation")
    check("Info: Deform bones are within" in words, words)
    print(f"  FK controls with a face: within {1e3 * error:.1f} mm")


@case
def a_bake_that_is_far_off_is_a_warning():
    arm, names = fresh(rigs.rigify_human)
    settings(by="FRAME", handover=10, use_return=False, use_range=True, frame_start=5, frame_end=14)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    # A control that a constraint holds cannot follow.
    held = arm.pose.bones["upper_arm_fk.L"].constraints.new("LIMIT_LOCATION")
    held.use_min_x = held.use_max_x = True
    held.min_x = held.max_x = 0.5
    held.owner_space = "LOCAL"
    words = said(bpy.ops.sinew.bake_fk)
    check("Warning: Deform bones are within" in words, words)


@case
def files_are_written():
    arm, _ = fresh()
    with tempfile.TemporaryDirectory() as folder:
        settings(by="FRAME", handover=45)
        for kind, end in (("SINEW", ".sinew.json"), ("MJCF", ".xml"), ("GLB", ".glb"), ("USD", ".usda")):
            path = os.path.join(folder, "it" + end)
            check(bpy.ops.sinew.export(filepath=path, format=kind) == {"FINISHED"}, kind)
            check(os.path.getsize(path) > 1000, f"{path} is written")
        path = os.path.join(folder, "it.usdc")
        if importlib.util.find_spec("pxr") is None:
            refused(bpy.ops.sinew.export, "needs pxr", filepath=path, format="USD")
        else:
            check(bpy.ops.sinew.export(filepath=path, format="USD") == {"FINISHED"}, "USD")
        refused(bpy.ops.sinew.export, "No such file", filepath=os.path.join(folder, "no", "it"), format="SINEW")


@case
def names_of_mixamo_and_auto_rig_pro_are_recognised():
    parts = {"hips", "spine", "upperChest", "neck", "head"} | {s + p for s in ("left", "right") for p in ("UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot")}
    for wanted in (rigs.MIXAMO, rigs.AUTO_RIG_PRO):
        arm, names = fresh(lambda wanted=wanted: rigs.metarig(wanted))
        by_role = {b["role"]: b["bone"] for b in json.loads(arm.sinew.definition)["bodies"]}
        check(parts <= set(by_role), f"roles {sorted(parts - set(by_role))} are missing")
        left = wanted["shin"].format(long="Left", short="l")
        check(by_role["leftLowerLeg"] == left, f"the left shin is {by_role['leftLowerLeg']}")
        own = posed(arm, names, LAST, LAST)[0]
        settings(by="FRAME", handover=45, keys="AUTO", use_return=False)
        check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
        check(report(arm)["verdict"] == "good" and report(arm)["before_handover_mm"] < 1.0, f"{report(arm)}")
        head = wanted["spine.006"]
        check(own[head].translation.z - posed(arm, names, LAST, LAST)[0][head].translation.z > 0.8, "and it falls")


@case
def meshes_may_be_called_like_bones():
    arm, names = fresh(rigs.knight)
    own = posed(arm, names)
    skins = [ob for ob in bpy.data.objects if ob.type == "MESH" and ob.find_armature() == arm]
    check(len(skins) > 3, "it has several meshes")
    for ob, name in zip(skins, ("head", "chest", "upperarm.l", "hips")):
        check(name in arm.data.bones, f"{name} is a bone")
        ob.name = name
    settings(by="FRAME", handover=45, use_return=False)
    check(bpy.ops.sinew.build() == {"FINISHED"} and bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    check(report(arm)["before_handover_mm"] < 1.0, f"{report(arm)['before_handover_mm']} mm before the hand-over")
    keyed = posed(arm, names)
    jump = max((keyed[44][n].translation - keyed[43][n].translation).length for n in names)
    check(jump < 0.05, f"a bone jumps by {jump} m at the hand-over, {max((own[44][n].translation - own[43][n].translation).length for n in names)} m in the user's own")


@case
def bones_above_the_hips_stay_with_the_animation():
    arm, names = fresh(rigs.robot)
    own = posed(arm, names)
    settings(by="FRAME", handover=45, use_return=True, return_frame=120, return_blend=20)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    check(report(arm)["before_handover_mm"] < 1.0 and report(arm)["verdict"] == "good", f"{report(arm)}")
    keyed = posed(arm, names)
    check(max(off(keyed[f], own[f], ["Bone", "Body"]) for f in range(LAST - FIRST + 1)) < 1e-3, "they have no skin, and do not follow the fall")
    check(off(keyed[70], own[70], ["Hips"]) > 0.3, "the hips fall")
    for f in (44, 119):
        jump = max(((keyed[f][n].translation - keyed[f - 1][n].translation) - (own[f][n].translation - own[f - 1][n].translation)).length for n in names)
        check(jump < 0.03, f"a bone jumps by {jump} m at {f + 1}")


@case
def shape_keys_and_loose_parts_do_not_change_the_body():
    arm, names = fresh()
    before = json.loads(arm.sinew.definition)
    skin = next(ob for ob in bpy.data.objects if ob.type == "MESH" and ob.find_armature() == arm)
    skin.shape_key_add(name="Basis")
    smile = skin.shape_key_add(name="Smile")
    for point in smile.data[:200]:
        point.co.x += 0.3
    smile.value = 1.0
    check(bpy.ops.sinew.build() == {"FINISHED"}, "it is built with shape keys")
    check(json.loads(arm.sinew.definition)["bodies"] == before["bodies"], "with the same bodies")
    settings(by="FRAME", handover=45, use_return=False)
    check(bpy.ops.sinew.simulate() == {"FINISHED"} and report(arm)["verdict"] == "good", "and falls")
    check(smile.value == 1.0, "the shape stays")


@case
def a_blend_begins_after_the_hand_over():
    arm, _ = fresh()
    settings(by="FRAME", handover=20, use_return=True)
    for back, blend, words in ((50, 100, "choose at most 29"), (25, 15, "choose at most 4"), (21, 15, "choose at least 22")):
        settings(return_frame=back, return_blend=blend)
        refused(bpy.ops.sinew.simulate, words)
    settings(return_frame=50, return_blend=29)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "the largest blend is simulated")
    check(report(arm)["handover"] == 20, f"it falls at {report(arm)['handover']}")


def returns(arm, names, handover, blend):
    """From frame 80 on the keyed rig has its own animation again."""
    own = posed(arm, names)
    settings(by="FRAME", handover=handover, use_return=True, return_frame=80, return_blend=blend, keys="ACTION")
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it falls and returns")
    back = posed(arm, names)
    error = max(off(back[f], own[f], names) for f in range(80 - FIRST, len(own)))
    check(error < 1e-4, f"after the return it is {error} m from its animation")


@case
def bones_without_keys_return():
    arm, names = fresh()
    arm.animation_data_clear()
    bone = arm.pose.bones[5]
    bone.rotation_mode = "XYZ"
    for frame, angle in ((1, 0.0), (60, 0.5)):
        bone.rotation_euler.x = angle
        bone.keyframe_insert("rotation_euler", frame=frame)
    returns(arm, names, 20, 1)


def in_edit_mode(arm, change):
    bpy.ops.object.mode_set(mode="EDIT")
    change(arm.data.edit_bones)
    bpy.ops.object.mode_set(mode="OBJECT")


@case
def a_scale_by_axes_returns():
    rigs.empty_scene()
    arm = rigs.cesium_man()
    arm.animation_data_clear()
    arm.scale = (1.0, 1.3, 0.8)
    bpy.context.view_layer.update()
    check(bpy.ops.sinew.build() == {"FINISHED"}, "it is built")
    names = addon().skeleton.skeleton_of(arm).names
    returns(arm, names, 30, 15)


@case
def a_clear_restores_an_unlinked_action():
    arm, names = fresh()
    own, action = posed(arm, names), arm.animation_data.action
    settings(by="FRAME", handover=45, use_return=False, keys="ACTION")
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    arm.animation_data.action = None
    check(bpy.ops.sinew.clear() == {"FINISHED"}, "it is cleared")
    check(arm.animation_data.action == action, f"the Action is {arm.animation_data.action}")
    check(max(off(a, b, names) for a, b in zip(posed(arm, names), own)) == 0.0, "it moves as before")
    bpy.ops.sinew.simulate()
    keyed = posed(arm, names)
    arm.animation_data.action = None
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated from its own Action")
    check(max(off(a, b, names) for a, b in zip(posed(arm, names), keyed)) == 0.0, "and falls as before")
    other = bpy.data.actions.new("Other")
    arm.animation_data.action = other
    check(bpy.ops.sinew.clear() == {"FINISHED"} and arm.animation_data.action == other, "another Action stays")


@case
def a_bone_that_is_gone_asks_for_a_build():
    for change in (lambda bones: bones.remove(bones["leg_joint_L_3"]), lambda bones: setattr(bones["leg_joint_L_3"], "name", "shin")):
        arm, _ = fresh()
        settings(by="FRAME", handover=45, use_return=False)
        addon().overlay.lines_of(arm, set())
        in_edit_mode(arm, change)
        check(addon().overlay.lines_of(arm, {"torso_joint_3"}), "the other bodies are drawn")
        for run in (bpy.ops.sinew.simulate, bpy.ops.sinew.doctor, bpy.ops.sinew.cure):
            refused(run, "no bone leg_joint_L_3 any more: build its ragdoll again")
        with tempfile.TemporaryDirectory() as folder:
            refused(bpy.ops.sinew.export, "build its ragdoll again", filepath=os.path.join(folder, "it"), format="SINEW")
        arm.pose.bones["torso_joint_3"].sinew.mass = 9.0
        check(bpy.ops.sinew.build() == {"FINISHED"} and bpy.ops.sinew.simulate() == {"FINISHED"}, "built again, it falls")


@case
def bones_that_moved_ask_for_a_build():
    def move(bones):
        bones["Skeleton_arm_joint_L__2_"].head.x += 0.1

    def reparent(bones):
        bones["leg_joint_L_3"].parent = bones["leg_joint_L_1"]

    for change, bone in ((move, "Skeleton_arm_joint_L__2_"), (reparent, "leg_joint_L_3")):
        arm, _ = fresh()
        settings(by="FRAME", handover=45, use_return=False)
        check(bpy.ops.sinew.simulate() == {"FINISHED"} and report(arm)["notes"] == [], f"{report(arm)['notes']}")
        in_edit_mode(arm, change)
        check("build its ragdoll again" in said(bpy.ops.sinew.doctor), "the doctor tells")
        check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
        notes = report(arm)["notes"]
        check(any(bone in note and "build its ragdoll again" in note for note in notes), f"{notes}")
        bpy.ops.sinew.clear()
        bpy.ops.sinew.build()
        check(bpy.ops.sinew.simulate() == {"FINISHED"} and not any("build its" in note for note in report(arm)["notes"]), "built again")


@case
def mistakes_in_settings_are_named():
    arm, _ = fresh()
    settings(by="FRAME", handover=45, use_return=False)
    arm.data.pose_position = "REST"
    refused(bpy.ops.sinew.simulate, "is in Rest Position")
    arm.data.pose_position = "POSE"
    bpy.context.scene.render.frame_map_new = 200
    refused(bpy.ops.sinew.simulate, "Time Stretching")
    bpy.context.scene.render.frame_map_new = 100
    arm.data.bones.active = arm.data.bones["torso_joint_3"]
    bpy.ops.sinew.add_hit(impulse=0)
    refused(bpy.ops.sinew.simulate, "Error: Hit torso_joint_3 has an impulse of 0")
    hit = bpy.data.objects["Hit torso_joint_3"]
    hit.sinew_hit.bone = ""
    refused(bpy.ops.sinew.simulate, "Error: Hit torso_joint_3 has no bone")
    bpy.data.objects.remove(hit)
    arm.pose.bones["leg_joint_L_1"].sinew.role = "nonsense"
    refused(bpy.ops.sinew.build, "leg_joint_L_1: no role `nonsense`")
    arm.pose.bones["leg_joint_L_1"].sinew.role = ""
    arm.sinew.height = 1e9
    check(arm.sinew.height == 1000, f"the height is {arm.sinew.height}")
    check(bpy.ops.sinew.build() == {"FINISHED"}, "it is built at that height")


@case
def files_have_the_names_that_were_given():
    arm, _ = fresh()
    refused(bpy.ops.sinew.export, "Save the .blend file first", filepath="//it.xml", format="MJCF")
    with tempfile.TemporaryDirectory() as folder:
        check(bpy.ops.sinew.export(filepath=os.path.join(folder, "x.json"), format="SINEW") == {"FINISHED"}, "it is written")
        check(os.listdir(folder) == ["x.sinew.json"], f"{os.listdir(folder)}")


@case
def wind_is_no_reason_for_a_worse_verdict():
    arm, _ = fresh()
    settings(by="FRAME", handover=45, use_return=False, wind=(0, 30, 0))
    words = said(bpy.ops.sinew.simulate)
    told = report(arm)
    check(told["verdict"] == "good" and told["reasons"] == [], f"{told['verdict']}: {told['reasons']}")
    check("Armature good" in words and any("wind adds energy" in note for note in told["notes"]), f"{words} {told['notes']}")


@case
def a_fall_into_the_void_is_told():
    arm, _ = fresh()
    settings(by="FRAME", handover=45, use_return=False, ground=False)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    notes = report(arm)["notes"]
    check(len(notes) == 1 and "Armature still falls at frame 150" in notes[0], f"{notes}")
    # A floor seen from below, which the feet touch.
    bpy.ops.mesh.primitive_plane_add(size=10)
    floor = bpy.context.object
    floor.data.flip_normals()
    floor.sinew_body.collides = True
    rigs.activate(arm)
    settings(use_return=True, return_frame=130, return_blend=20)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "it is simulated")
    notes = report(arm)["notes"]
    check(any("Armature still falls at frame 110" in note for note in notes), f"{notes}")
    floor.data.flip_normals()
    settings(ground=True)
    check(bpy.ops.sinew.simulate() == {"FINISHED"} and report(arm)["notes"] == [], f"{report(arm)['notes']}")


@case
def a_hit_is_drawn_and_findings_are_counted():
    arm, _ = fresh()
    arm.data.bones.active = arm.data.bones["torso_joint_3"]
    bpy.ops.sinew.add_hit()
    hit = bpy.data.objects["Hit torso_joint_3"]
    bpy.context.view_layer.update()
    lines = addon().overlay.hit_lines(hit)
    tip = hit.matrix_world @ Vector((0, 0, hit.empty_display_size))
    check((lines[0] - hit.matrix_world.translation).length < 1e-6 and (lines[1] - tip).length < 1e-6, f"its shaft is {lines[:2]}")
    check(all((p - tip).length <= hit.empty_display_size + 1e-6 for p in lines), "and no line is longer than it")
    hit.sinew_hit.enabled = False
    check(addon().overlay.hit_lines(hit) == [], "disabled, it is Blender's own arrow")
    arm.pose.bones["torso_joint_3"].sinew.mass = 900.0
    bpy.ops.sinew.doctor()
    counted = addon().panels.findings_of(bpy.context)
    check(counted == str(len(arm.sinew.findings)) != "0", f"the header has {counted}")


@case
def what_cannot_be_is_one_line():
    rigs.empty_scene()
    arm = rigs.cesium_man()
    refused(bpy.ops.sinew.doctor, "Build the ragdoll first")
    bpy.ops.sinew.build()
    settings(by="HITS")
    refused(bpy.ops.sinew.simulate, "Nothing fells")
    arm.data.bones.active = arm.data.bones["torso_joint_3"]
    bpy.ops.sinew.add_hit()
    hit = bpy.data.objects["Hit torso_joint_3"]
    hit.sinew_hit.frame = LAST + 50
    refused(bpy.ops.sinew.simulate, "is after the end, frame 150")
    hit.sinew_hit.frame, hit.scale = 50, (0, 0, 0)
    bpy.context.view_layer.update()
    refused(bpy.ops.sinew.simulate, "has no direction")
    bpy.data.objects.remove(hit)
    refused(bpy.ops.sinew.export, "Give the file a name", format="SINEW")
    bpy.context.view_layer.objects.active = None
    refused(bpy.ops.sinew.build, "Select an armature or one of its meshes")
    rigs.activate(arm)
    settings(by="FRAME", handover=500)
    refused(bpy.ops.sinew.simulate, "outside of the range")
    settings(handover=45)
    arm.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    refused(bpy.ops.sinew.simulate, "another scale")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "linked.blend")
        arm.scale, name = (1, 1, 1), arm.name
        bpy.ops.wm.save_as_mainfile(filepath=path)
        rigs.empty_scene()
        with bpy.data.libraries.load(path, link=True) as (source, into):
            into.objects = [name]
        linked = bpy.data.objects[name]
        bpy.context.scene.collection.objects.link(linked)
        rigs.activate(linked)
        refused(bpy.ops.sinew.build, "library override")


@case
def a_library_override_falls():
    rigs.empty_scene()
    arm = rigs.cesium_man()
    with tempfile.TemporaryDirectory() as folder:
        path, name = os.path.join(folder, "linked.blend"), arm.name
        skin = next(ob.name for ob in bpy.data.objects if ob.type == "MESH" and ob.find_armature() == arm)
        bpy.ops.wm.save_as_mainfile(filepath=path)
        rigs.empty_scene()
        with bpy.data.libraries.load(path, link=True) as (_, into):
            into.objects = [name, skin]
        scene = bpy.context.scene
        for ob in into.objects:
            scene.collection.objects.link(ob)
        made = bpy.data.objects[name].override_hierarchy_create(scene, bpy.context.view_layer)
        arm = made if made.type == "ARMATURE" else next(ob for ob in bpy.data.objects if ob.type == "ARMATURE" and ob.override_library)
        rigs.activate(arm)
        settings(by="FRAME", handover=45, use_return=False)
        check(bpy.ops.sinew.build() == {"FINISHED"}, "it is built")
        check(bpy.ops.sinew.simulate() == {"FINISHED"} and report(arm)["verdict"] == "good", "and falls")
        check(report(arm)["before_handover_mm"] < 1.0, f"{report(arm)}")
        bodies = len(json.loads(arm.sinew.definition)["bodies"])
        copy = os.path.join(folder, "overriding.blend")
        bpy.ops.wm.save_as_mainfile(filepath=copy)
        bpy.ops.wm.open_mainfile(filepath=copy)
        arm = next(ob for ob in bpy.data.objects if ob.type == "ARMATURE" and ob.override_library)
        check(len(json.loads(arm.sinew.definition)["bodies"]) == bodies, "the ragdoll is in the saved file")
        rigs.activate(arm)
        check(arm.animation_data.action == arm.sinew.made_action is not None, "with its keys")
        check(bpy.ops.sinew.clear() == {"FINISHED"} and arm.animation_data.action != arm.sinew.made_action, "and is cleared")
        rigs.empty_scene()


@case
def an_armature_without_skin_has_tubes():
    rigs.empty_scene()
    addon_utils = __import__("addon_utils")
    addon_utils.enable("rigify", default_set=False)
    bpy.ops.object.armature_basic_human_metarig_add()
    arm = rigs.activate(bpy.context.object)
    check(bpy.ops.sinew.build() == {"FINISHED"}, "it is built")
    settings(by="FRAME", handover=10, use_range=True, frame_start=1, frame_end=60)
    check(bpy.ops.sinew.simulate() == {"FINISHED"}, "and falls")
    check(report(arm)["verdict"] == "good", str(report(arm)["reasons"]))


if __name__ == "__main__":
    installed.install()
    failed = []
    for one in CHECKS:
        try:
            one()
            print(f"PASS {one.__name__}")
        except Exception as error:  # All are told.
            failed.append(one.__name__)
            print(f"FAIL {one.__name__}: {type(error).__name__}: {error}")
    raise SystemExit(bool(failed))
