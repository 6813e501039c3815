"""Operators behind the buttons."""

import json
import os
import time

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from mathutils import Matrix

from . import bodies, bridge, keys, preview, simulation
from . import skeleton as sk
from .skeleton import SinewError

# Seconds between checks of a running simulation.
LOOKS_EVERY = 0.1
# Seconds of sampling between redraws.
SLICE = 0.5


def active_armature(context):
    """The selected armature, or that of the selected mesh."""
    ob = context.object
    if ob is not None and ob.type == "MESH":
        ob = ob.find_armature()
    return ob if ob is not None and ob.type == "ARMATURE" else None


def selected_armatures(context):
    """All selected armatures, the active one first."""
    active = active_armature(context)
    others = [ob for ob in context.selected_objects if ob.type == "ARMATURE" and ob != active]
    if active is None:
        raise SinewError("Select an armature first")
    return [active, *sorted(others, key=lambda ob: ob.name)]


def counted(count, one, many):
    return f"{count} {one if count == 1 else many}"


class Sinew:
    """Base of all operators: shows errors as a line in the status bar."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        cls.poll_message_set("Select an armature or one of its meshes")
        return active_armature(context) is not None

    def execute(self, context):
        try:
            return self.act(context) or {"FINISHED"}
        except SinewError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}


class SINEW_OT_build(Sinew, bpy.types.Operator):
    """Build the ragdoll of the armature: bodies, limits and masses. Resets edits of bones"""

    bl_idname, bl_label = "sinew.build", "Build ragdoll"

    def act(self, context):
        for arm in selected_armatures(context):
            arm.sinew.place, edits = "", bodies.edits(arm)
            ragdoll = bridge.build(arm)
            bodies.store(arm, ragdoll)
            examine(arm, ragdoll)
            self.report({"INFO"}, f"{arm.name}: {counted(len(ragdoll), 'body', 'bodies')}, {ragdoll.total_mass:.1f} kg, {ragdoll.height:.2f} m")
            if edits:
                self.report({"WARNING"}, f"{arm.name}: edits of {counted(edits, 'bone', 'bones')} were reset")


class SINEW_OT_forget(Sinew, bpy.types.Operator):
    """Remove Sinew's ragdoll, keys and settings from the armature; your animation is restored"""

    bl_idname, bl_label = "sinew.forget", "Remove Sinew"

    def act(self, context):
        for arm in selected_armatures(context):
            keys.clear(arm)
            preview.clear(arm)
            for name in ("definition", "fitted", "place", "rest", "report"):
                setattr(arm.sinew, name, "")
            arm.sinew.findings.clear()
            bodies.show(arm)


# Texts of Sinew's commands, and their replacements in Blender.
HERE = (
    ("Give `unit_scale` or `height` in settings (`--unit`, `--height`) if it is another.", "Set Height in the ragdoll panel if it is another, and build again."),
    ("Give what sticks out a body (`--body`), say that it is no part of the body (`--ignore`), or", "Choose No body for bones of what sticks out, or"),
    ("Give the joint that stays behind a body (`--body`), or say what it is (`--role`).", "Say by the bone's Role what the joint is that stays behind."),
    ("Give that part a body (`--body`), leave it out (`--ignore`), or change the shape's `scale` in settings.", "Choose No body for that part's bone, or change Size."),
    ("Say with `--role` which", "Say by the bone's Role which"),
)


def spoken(finding):
    return finding["code"].replace("-", " ")


def examine(arm, ragdoll):
    """Fills in the doctor's findings."""
    arm.sinew.findings.clear()
    for found in bridge.asked(ragdoll.doctor)["findings"]:
        if found["code"] == "unit-inferred" and arm.sinew.height > 0:
            continue
        for text, here in HERE:
            found["fix"] = found["fix"].replace(text, here)
        one = arm.sinew.findings.add()
        for key in ("code", "severity", "cause", "evidence", "fix"):
            setattr(one, key, found[key])
        one.bones = json.dumps(found["bones"])
    return len(arm.sinew.findings)


class SINEW_OT_doctor(Sinew, bpy.types.Operator):
    """Examine the ragdoll for problems"""

    bl_idname, bl_label = "sinew.doctor", "Examine"

    def act(self, context):
        arm = active_armature(context)
        count = examine(arm, bridge.valid(arm))
        for note in bodies.changed(arm):
            self.report({"WARNING"}, note)
        self.report({"INFO"}, counted(count, "finding", "findings"))


class SINEW_OT_select_finding(Sinew, bpy.types.Operator):
    """Select the bones of this finding"""

    bl_idname, bl_label = "sinew.select_finding", "Select bones"
    index: IntProperty()

    def act(self, context):
        arm = active_armature(context)
        if not 0 <= self.index < len(arm.sinew.findings):
            raise SinewError("There is no such finding: examine again")
        names = set(json.loads(arm.sinew.findings[self.index].bones))
        for bone in arm.data.bones:
            select(arm, bone, bone.name in names)
        first = next((b for b in arm.data.bones if b.name in names), None)
        if first is not None:
            arm.data.bones.active = first
        arm.sinew.finding = self.index


def select(arm, bone, chosen):
    """Selects a bone, as Blender before and from 5 has it."""
    if hasattr(bone, "select"):
        bone.select = chosen
    else:
        arm.pose.bones[bone.name].select = chosen


class SINEW_OT_cure(Sinew, bpy.types.Operator):
    """Repair what the doctor can repair"""

    bl_idname, bl_label = "sinew.cure", "Fix"

    def act(self, context):
        arm = active_armature(context)
        cured, report = bridge.asked(bridge.valid(arm).cured)
        arm.sinew.definition = cured.to_json()
        bodies.show(arm)
        left = examine(arm, cured)
        mended = [finding for finding in report["findings"] if finding["fixed"]]
        for finding in mended:
            self.report({"INFO"}, f"{spoken(finding)}: {', '.join(finding['bones'])}")
        kinds = f" ({', '.join(sorted({spoken(finding) for finding in mended}))})" if mended else ""
        self.report({"INFO"}, f"{len(mended)} mended{kinds}, {left} left")


class Simulates(Sinew):
    """Base of the operators that simulate: in a window step by step, with progress, cancelled by Esc."""

    def act(self, context):
        job = simulation.prepare(context, selected_armatures(context))
        job.run()
        return self.finish(context, job)

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self._work = simulation.preparing(context, selected_armatures(context))
        except SinewError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        manager = context.window_manager
        self._job = None
        manager.progress_begin(0, 1)
        self._timer = manager.event_timer_add(LOOKS_EVERY, window=context.window)
        manager.modal_handler_add(self)
        context.workspace.status_text_set("Sinew simulates; Esc cancels")
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        try:
            return self.go_on(context, event)
        except SinewError as error:
            self._end(context)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def go_on(self, context, event):
        """Samples in time slices, then waits for the simulation thread."""
        if event.type == "ESC" and self._job is None:
            self._work.close()
            self._end(context)
            self.report({"INFO"}, "Cancelled: nothing was keyed")
            return {"CANCELLED"}
        if event.type == "ESC":
            self._job.cancelled = True
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        progress = context.window_manager.progress_update
        if self._job is None:
            until = time.monotonic() + SLICE
            try:
                while time.monotonic() < until:
                    progress(0.3 * next(self._work))
            except StopIteration as done:
                self._job = done.value
                self._job.start()
            return {"RUNNING_MODAL"}
        progress(0.3 + 0.7 * self._job.share)
        if self._job.thread.is_alive():
            return {"RUNNING_MODAL"}
        done = self.finish(context, self._job)
        self._end(context)
        return done

    def _end(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def finish(self, context, job):
        if job.cancelled or isinstance(job.error, bridge.engine().Cancelled):
            self.report({"INFO"}, "Cancelled: nothing was keyed")
            return {"CANCELLED"}
        if job.error is not None:
            if isinstance(job.error, SinewError):
                raise job.error
            raise SinewError(f"The simulation failed: {job.error}")
        for arm, ragdoll in job.built:
            bodies.store(arm, ragdoll)
            examine(arm, ragdoll)
        job.notes += simulation.overlaps(job) + simulation.stretched(job) + simulation.falls_on(job) + simulation.blown(job)
        self.done(context, job)
        for note in job.notes:
            self.report({"WARNING"}, note)
        redraw(context)
        return {"FINISHED"}


class SINEW_OT_simulate(Simulates, bpy.types.Operator):
    """Play your animation until the hand-over, simulate from there, and key the result. Esc cancels"""

    bl_idname, bl_label = "sinew.simulate", "Simulate"

    def done(self, context, job):
        at = context.scene.frame_current
        ways = simulation.write(job, context.scene.sinew.keys)
        context.scene.frame_set(at)
        for arm in job.arms:
            preview.clear(arm)
        verdicts = ", ".join(f"{arm.name} {simulation.judged(baked)[0]}" for arm, baked in zip(job.arms, job.baked))
        self.report({"INFO"}, f"Simulated {job.last - job.first + 1} frames, keyed as {', '.join(sorted(set(ways))).lower()}: {verdicts}")


class SINEW_OT_preview(Simulates, bpy.types.Operator):
    """Simulate, and draw the fall over your animation without keys; scrub to see it. Esc cancels"""

    bl_idname, bl_label, bl_options = "sinew.preview", "Preview", {"REGISTER"}

    def done(self, context, job):
        preview.show(job)
        self.report({"INFO"}, f"Preview from frame {min(preview.of(arm).handover for arm in job.arms)} on: scrub to see it")


class SINEW_OT_end_preview(Sinew, bpy.types.Operator):
    """Stop drawing the preview"""

    bl_idname, bl_label, bl_options = "sinew.end_preview", "End preview", {"REGISTER"}

    def act(self, context):
        for arm in selected_armatures(context):
            preview.clear(arm)
        redraw(context)


def redraw(context):
    for area in context.screen.areas if context.screen is not None else ():
        area.tag_redraw()


class SINEW_OT_clear(Sinew, bpy.types.Operator):
    """Remove the keys of the last simulation; your animation is restored"""

    bl_idname, bl_label = "sinew.clear", "Clear keys"

    def act(self, context):
        for arm in selected_armatures(context):
            keys.clear(arm)
        context.scene.frame_set(context.scene.frame_current)


class SINEW_OT_add_hit(Sinew, bpy.types.Operator):
    """Add an arrow that hits the active bone at the current frame"""

    bl_idname, bl_label = "sinew.add_hit", "Add hit"
    impulse: FloatProperty(name="Impulse", default=100, min=0)

    def act(self, context):
        arm = active_armature(context)
        bone = arm.data.bones.active
        if bone is None:
            raise SinewError("Make a bone active first: in pose mode, click it")
        at = arm.matrix_world @ arm.pose.bones[bone.name].matrix @ Matrix.Translation((0, bone.length / 2, 0))
        size = 0.3 / sk.unit_of_scene()
        # The arrow points at the bone, along the world's +Y: from the front of a character that faces -Y.
        empty = bpy.data.objects.new(f"Hit {bone.name}", None)
        context.scene.collection.objects.link(empty)
        empty.empty_display_type, empty.empty_display_size = "SINGLE_ARROW", size
        empty.matrix_world = Matrix.Translation(at.translation) @ Matrix.Rotation(-1.5707963267948966, 4, "X") @ Matrix.Translation((0, 0, -size))
        hit = empty.sinew_hit
        hit.enabled, hit.armature, hit.bone, hit.frame, hit.impulse = True, arm, bone.name, context.scene.frame_current, self.impulse


class SINEW_OT_collide(bpy.types.Operator):
    """Make simulated characters collide with the selected meshes, or stop it"""

    bl_idname, bl_label, bl_options = "sinew.collide", "Collide with selected", {"REGISTER", "UNDO"}
    collides: BoolProperty(default=True)

    def execute(self, context):
        chosen = [ob for ob in context.selected_objects if ob.type == "MESH"]
        for ob in chosen:
            ob.sinew_body.collides = self.collides
        if not chosen:
            self.report({"ERROR"}, "Select the meshes first")
            return {"CANCELLED"}
        return {"FINISHED"}


class SINEW_OT_bake_fk(Sinew, bpy.types.Operator):
    """Transfer the fall from the proxy to the FK controls of a Rigify rig, and remove the proxy"""

    bl_idname, bl_label = "sinew.bake_fk", "Bake to FK controls"

    def act(self, context):
        from . import rigify

        worst = rigify.bake(context, active_armature(context)) * sk.unit_of_scene()
        level = {"INFO"} if worst < rigify.CLOSE else {"WARNING"}
        self.report(level, f"Deform bones are within {1e3 * worst:.1f} mm of the simulation")


class SINEW_OT_export(Sinew, bpy.types.Operator):
    """Write the ragdoll's definition for Sinew's commands and for engines"""

    bl_idname, bl_label, bl_options = "sinew.export", "Export ragdoll", {"REGISTER"}
    filepath: StringProperty(subtype="FILE_PATH")
    format: EnumProperty(
        name="Format",
        items=(
            ("SINEW", "Sinew (.sinew.json)", "Definition that Sinew's commands and engines read"),
            ("MJCF", "MuJoCo (.xml)", "A model for MuJoCo"),
            ("GLB", "Character (.glb)", "Skeleton, skin and the sampled animation as Sinew has them"),
            ("USD", "Fall (.usdc)", "Simulate, and write skeleton, skin, fall and physics as USD; a name with .usda makes text"),
        ),
    )
    ENDS = {"SINEW": ".sinew.json", "MJCF": ".xml", "GLB": ".glb", "USD": ".usdc"}

    def invoke(self, context, event):
        self.filepath = active_armature(context).name + self.ENDS[self.format]
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def act(self, context):
        arm = active_armature(context)
        path = self.path()
        try:
            if self.format == "USD":
                self.write_usd(context, arm, path)
                return
            if self.format == "GLB":
                first, last = simulation.frames_of(context.scene)
                take = sk.sample(arm, sk.skeleton_of(arm), first, last)
                fps = context.scene.render.fps / context.scene.render.fps_base
                data = bridge.asked(bridge.load(arm, take.frames, fps).file.glb)
            elif self.format == "MJCF":
                data = bridge.asked(bridge.valid(arm).to_mjcf, arm.name)[0].encode()
            else:
                data = bridge.valid(arm).to_json().encode()
            with open(path, "wb") as file:
                file.write(data)
        except OSError as error:
            raise SinewError(f"{path}: {error.strerror or error}") from error
        self.report({"INFO"}, f"Wrote {path}")

    def path(self):
        """The path to write, with the ending of the format."""
        if self.filepath.startswith("//") and not bpy.data.filepath:
            raise SinewError("Save the .blend file first, or give a full path: // is the folder of the .blend file")
        path, end = bpy.path.abspath(self.filepath), self.ENDS[self.format]
        if not os.path.basename(path):
            raise SinewError("Give the file a name: filepath has none")
        if path.endswith(end) or self.format == "USD" and path.endswith(".usda"):
            return path
        return (path.removesuffix(".json") if self.format == "SINEW" else path) + end

    def write_usd(self, context, arm, path):
        from sinew import usd

        job = simulation.prepare(context, [arm])
        job.run()
        if job.error is not None:
            raise SinewError(str(job.error))
        try:
            notes = usd.save(job.baked[0], path)
        except ImportError as error:
            raise SinewError(str(error)) from error
        self.report({"INFO"}, f"Wrote {path}: {'; '.join(notes)}")


CLASSES = (
    SINEW_OT_build,
    SINEW_OT_forget,
    SINEW_OT_doctor,
    SINEW_OT_select_finding,
    SINEW_OT_cure,
    SINEW_OT_simulate,
    SINEW_OT_preview,
    SINEW_OT_end_preview,
    SINEW_OT_clear,
    SINEW_OT_add_hit,
    SINEW_OT_collide,
    SINEW_OT_bake_fk,
    SINEW_OT_export,
)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
