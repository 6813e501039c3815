"""Samples the user's animation, simulates, and writes keys."""

import json
import math
import threading
from dataclasses import dataclass, field

import bpy
from mathutils import Vector

from . import actions, bodies, bridge, keys, overlap, stage
from . import skeleton as sk
from .skeleton import SinewError

# States in which the user's animation alone sets the pose.
OWN = {"animated"}
# Start of the reason for a fall whose energy grows.
ENERGY = "energy gain"
# Distance of a joint from its place in the rest pose at the hand-over that is worth a warning, metres.
MOST_STRETCH = 0.03


@dataclass
class Fall:
    """Simulated frames from the hand-over until the return, or the end."""

    first: int
    frames: list
    worlds: list
    carriers: list
    # Frame from which the user's animation sets the pose again, or None.
    back: object = None


@dataclass
class Job:
    """A simulation, prepared on Blender's main thread and run on any thread."""

    arms: list
    loaded: list
    takes: list
    actors: list
    stage: dict
    first: int
    last: int
    fps: float
    # Armatures without a ragdoll and those that they got for this run.
    built: list
    # Warnings.
    notes: list
    share: float = 0.0
    cancelled: bool = False
    baked: object = None
    error: object = None
    thread: object = field(default=None, repr=False)

    def run(self):
        try:
            self.baked = bridge.asked(bridge.engine().bake, self.actors, progress=self.told, **self.stage)
        except Exception as error:  # To be reported on Blender's main thread.
            self.error = error

    def told(self, share):
        self.share = share
        return not self.cancelled

    def start(self):
        self.thread = threading.Thread(target=self.run, name="Sinew", daemon=True)
        self.thread.start()


def frames_of(scene):
    """First and last frame of the simulation."""
    settings = scene.sinew
    first, last = (settings.frame_start, settings.frame_end) if settings.use_range else (scene.frame_start, scene.frame_end)
    if last <= first:
        raise SinewError(f"The frame range ends at {last}, before it begins at {first}")
    return first, last


def prepare(context, arms):
    """Reads armatures, animation and world; must run on Blender's main thread."""
    return sk.whole(preparing(context, arms))


def preparing(context, arms):
    """`prepare` step by step: a generator that yields the progress."""
    scene, sinew = context.scene, bridge.engine()
    settings = scene.sinew
    first, last = frames_of(scene)
    fps = scene.render.fps / scene.render.fps_base
    at = settings.handover
    if settings.by == "FRAME" and not first <= at <= last:
        raise SinewError(f"The hand-over, frame {at}, is outside of the range {first} to {last}")
    if settings.use_return and not max(at, first) < settings.return_frame <= last:
        raise SinewError(f"The return, frame {settings.return_frame}, is not between hand-over and end")
    check_pose(scene, arms)
    loaded, takes, actors, units, built, notes = [], [], [], [], [], []
    for arm in arms:
        with own_animation(arm):
            take = yield from sk.sampling(arm, sk.skeleton_of(arm), first, last)
        one = bridge.load(arm, take.frames, fps)
        if arm.sinew.definition:
            ragdoll = bridge.valid(arm)
            notes += bodies.changed(arm)
        else:
            ragdoll = bridge.build(arm)
            built.append((arm, ragdoll))
        one.unit = ragdoll.unit_scale
        falling = None
        if settings.stiffness > 0:
            falling = sinew.Drive("powered", strength=settings.stiffness)
        character = bridge.asked(
            one.file.character, ragdoll, clip=bridge.CLIP, exact=True, gets_up=settings.gets_up, falling=falling
        )
        given = {"hits": stage.hits(scene, arm, json.loads(ragdoll.to_json()), first, fps, notes), "drives": drives(one, take, fps), "topple": settings.push_over}
        if settings.by == "FRAME":
            given["limp_at"] = (at - first) / fps
        if settings.use_return:
            given["return_at"] = (settings.return_frame - first) / fps
            given["return_seconds"] = settings.return_blend / fps
        if not given["hits"] and not given["drives"] and "limp_at" not in given:
            raise SinewError(f"Nothing fells {arm.name}: add a hit, or choose the hand-over by frame")
        if not given["drives"] and "limp_at" not in given and given["hits"][0][0] * fps > last - first:
            when = first + round(given["hits"][0][0] * fps)
            raise SinewError(f"Nothing fells {arm.name}: its first hit, at frame {when}, is after the end, frame {last}")
        check_return(settings, first, fps, given)
        actors.append(bridge.asked(sinew.Actor, character, pose=character.place_in_file, **given))
        loaded.append(one)
        takes.append(take)
        units.append(ragdoll.unit_scale)
    if max(units) > 1.001 * min(units):
        raise SinewError("The armatures are of different units: simulate them one by one, or set their heights")
    world = {
        "seconds": (last - first) / fps,
        "fps": fps,
        "world": stage.world(scene, arms, first, last, fps, units[0]),
        "wind": stage.wind(scene),
        "gravity": gravity(scene),
    }
    return Job(arms, loaded, takes, actors, world, first, last, fps, built, notes)


def check_pose(scene, arms):
    """Raises an error if a setting moves an animation, or its keys, away from their frames."""
    if scene.render.frame_map_old != scene.render.frame_map_new:
        raise SinewError("Time Stretching is on: set Old and New to 100 (Output properties, Frame Range)")
    for arm in arms:
        if arm.data.pose_position == "REST":
            raise SinewError(f"{arm.name} is in Rest Position: choose Pose Position (armature properties, Pose)")
        if arm.sinew.definition:
            bridge.valid(arm)


def check_return(settings, first, fps, given):
    """Raises an error if a blend begins before the character falls: the hand-over would move to the start of the blend."""
    starts = [given["limp_at"]] if "limp_at" in given else []
    starts += [time for time, _, _ in given["hits"]]
    if not settings.use_return or not starts:
        return
    began = first + round(max(min(starts), 0.0) * fps)
    most = settings.return_frame - began - 1
    if most < 1:
        raise SinewError(f"A return at frame {settings.return_frame} leaves no blend after the hand-over at frame {began}: choose at least {began + 2}")
    if settings.return_blend > most:
        raise SinewError(
            f"The blend ({settings.return_blend} frames) begins before the hand-over at frame {began}: choose at most {most}"
        )


def gravity(scene):
    g = sk.TO_Y.to_3x3() @ scene.gravity if scene.use_gravity else (0.0, 0.0, 0.0)
    return tuple(g)


class own_animation:
    """Temporarily restores the user's animation without the results of an earlier simulation, for sampling."""

    def __init__(self, arm):
        self.arm, self.muted, self.tracks, self.is_swapped, self.action = arm, [], [], keys.is_in_place(arm), None

    def __enter__(self):
        arm = self.arm
        for bone in arm.pose.bones:
            for c in bone.constraints:
                if c.name == keys.CONSTRAINT and not c.mute:
                    c.mute = True
                    self.muted.append((bone.name, c.name))
        if self.is_swapped:
            self.action = arm.animation_data.action if arm.animation_data is not None else None
            keys.put_back(arm)
        data = arm.animation_data
        if data is None:
            return self
        for track in data.nla_tracks:
            if track.name == keys.TRACK and not track.mute:
                track.mute = True
                self.tracks.append(track)
        if self.tracks:
            keys.restore_pose(arm)
        return self

    def __exit__(self, *_):
        for bone, name in self.muted:
            self.arm.pose.bones[bone].constraints[name].mute = False
        for track in self.tracks:
            track.mute = False
        if self.is_swapped:
            actions.assign(self.arm, self.action)


def drives(loaded, take, fps):
    """Changes of the bones' modes over time."""
    sinew, out, last = bridge.engine(), [], {}
    for index, modes in enumerate(take.modes):
        for name, mode in modes.items():
            if last.get(name, "KEYED") == mode:
                continue
            last[name] = mode
            # Bodies may lose their drives within a frame; they come back to the animation more slowly, without a jump.
            fades = {} if mode == "KEYED" else {"half_life": 1.0 / fps}
            out.append(sinew.Drive(mode.lower(), time=index / fps, bone=name, **fades))
    return out


def simulated(arm, loaded, take, baked):
    """Matrix of each bone at each frame. Bones above the first body, which Sinew keeps at rest, follow that body as in the user's animation
    if they have skin, and otherwise the user's animation itself."""
    frames, skeleton = bridge.model_matrices(baked, loaded), loaded.skeleton
    first = next((b["bone"] for b in bodies_of(arm) if b["bone"] in skeleton.parent), None)
    above, at = [], skeleton.parent.get(first)
    while at is not None:
        above.append(at)
        at = skeleton.parent[at]
    skinned = sk.skinned(arm, skeleton) if above else set()
    for frame, own in zip(frames, take.frames):
        moved = frame[first] @ own[first].inverted() if above else None
        for name in above:
            frame[name] = moved @ own[name] if name in skinned else own[name].copy()
    return frames


def bodies_of(arm):
    return json.loads(arm.sinew.definition)["bodies"] if arm.sinew.definition else []


def falls_of(job):
    """The simulated part of each bake, as frames of Blender."""
    found = []
    for arm, loaded, take, baked in zip(job.arms, job.loaded, job.takes, job.baked):
        states = baked.states
        began = next((i for i, state in enumerate(states) if state not in OWN), None)
        if began is None:
            raise SinewError("Nothing fell: no hit struck it, and the hand-over is after the end")
        end, back = len(states), None
        if bpy.context.scene.sinew.use_return:
            back = bpy.context.scene.sinew.return_frame
            end = min(back - job.first, len(states))
        frames = simulated(arm, loaded, take, baked)
        found.append(
            Fall(job.first + began, frames[began:end], take.worlds[began:end], take.carriers[began:end], back)
        )
    return found


def overlaps(job):
    """Warnings about characters that are inside of ground or colliders when the bodies take over."""
    found = []
    for arm, loaded, take, baked in zip(job.arms, job.loaded, job.takes, job.baked):
        began = next((i for i, state in enumerate(baked.states) if state not in OWN), None)
        if began is not None:
            definition = json.loads(arm.sinew.definition)
            found += overlap.told(bpy.context.scene, arm, loaded.skeleton, definition, take.frames[began], job.first + began)
    return found


def stretched(job):
    """Warnings about joints that the user's animation moves away from their parents, as scaled and stretched bones do: the bodies have the
    lengths of the rest pose."""
    found = []
    for arm, loaded, take, baked in zip(job.arms, job.loaded, job.takes, job.baked):
        began = next((i for i, state in enumerate(baked.states) if state not in OWN), None)
        bodies = [b["bone"] for b in bodies_of(arm)]
        if began is None:
            continue
        own, off = take.frames[began], {}
        # Parents before children.
        for n in [n for n in loaded.joints if n in bodies[1:]]:
            p = loaded.parents[n]
            if p is not None:
                way = (own[p].inverted() @ own[n]).translation - (loaded.rest[p].inverted() @ loaded.rest[n]).translation
                off[n] = way.length * loaded.unit
        far = [n for n in off if off[n] > MOST_STRETCH]
        if far:
            cause = f"{loaded.parents[far[0]]} or a bone above is scaled or moved. Apply the pose as rest pose, or remove the scale"
            scale = arm.matrix_world.to_scale()
            if max(scale) > (1.0 + bridge.SAME_SCALE) * min(scale):
                cause = "its object's scale differs by axes. Apply it (Ctrl+A), and build again"
            found.append(
                f"{arm.name} is stretched by up to {100 * max(off.values()):.0f} cm when it falls, and changes to the lengths of its rest pose: {cause}"
            )
    return found


def falls_on(job):
    """Warnings about characters that at the end, or before the return, are faster than after a fall by their own height."""
    settings, found = bpy.context.scene.sinew, []
    last = max(settings.return_frame - settings.return_blend, job.first + 1) if settings.use_return else job.last
    for arm, baked in zip(job.arms, job.baked):
        height = json.loads(arm.sinew.definition)["height"]
        before, end = baked.positions[last - job.first - 1 : last - job.first + 1, 0, 1]
        if (before - end) * job.fps > math.sqrt(2.0 * Vector(job.stage["gravity"]).length * height) > 0.0:
            found.append(
                f"{arm.name} still falls at frame {last}: enable Ground, or collide with what is below it."
                " Faces collide on the side of their normals"
            )
    return found


def judged(baked):
    """Verdict and reasons of a fall. Wind adds energy, so a gain of energy is no reason there."""
    if bpy.context.scene.sinew.wind.length == 0 or baked.verdict != "usable":
        return baked.verdict, list(baked.reasons)
    left = [reason for reason in baked.reasons if not reason.startswith(ENERGY)]
    return ("usable" if left else "good"), left


def blown(job):
    """Notes about energy that the verdict leaves out."""
    scored = [(arm, baked) for arm, baked in zip(job.arms, job.baked) if len(judged(baked)[1]) < len(baked.reasons)]
    return [f"{arm.name}: wind adds energy to the fall, which the verdict leaves out" for arm, _ in scored]


def write(job, how):
    """Keys for all characters; returns how each was keyed."""
    done = []
    for arm, loaded, take, baked, fall in zip(job.arms, job.loaded, job.takes, job.baked, falls_of(job)):
        names = loaded.skeleton.names
        keys.clear(arm)
        way = how
        if way == "AUTO":
            data = arm.animation_data
            on_tracks = data is not None and data.action is None and any(not t.mute for t in data.nla_tracks)
            way = "PROXY" if sk.is_driven(arm, names) else "STRIP" if on_tracks else "ACTION"
        if way == "PROXY":
            keys.as_proxy(arm, loaded.skeleton, fall)
        elif way == "STRIP":
            keys.as_strip(arm, names, fall)
        else:
            keys.as_action(arm, names, fall)
        arm.sinew.keyed = way
        arm.sinew.report = json.dumps(report(arm, loaded, take, baked, fall, way) | {"notes": job.notes})
        done.append(way)
    return done


def report(arm, loaded, take, baked, fall, way):
    """Results for the panel and for tests: lengths in mm of Blender's unit in metres."""
    unit = 1e3 * loaded.unit
    off = 0.0
    frames = simulated(arm, loaded, take, baked)
    for i in range(fall.first - take.first):
        for n in loaded.skeleton.names:
            off = max(off, (frames[i][n].translation - take.frames[i][n].translation).length * unit)
    verdict, reasons = judged(baked)
    return {
        "keyed": way,
        "frames": len(fall.frames),
        "handover": fall.first,
        "before_handover_mm": round(off, 4),
        "verdict": verdict,
        "reasons": reasons,
        "joint_gap_mm": 1e3 * baked.quality["joint_gap_max_m"],
        "events": [[round(t, 3), e] for t, e in baked.events],
        "hash": f"{baked.hash:016x}",
    }
