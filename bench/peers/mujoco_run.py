#!/usr/bin/env python3
"""Runs a scene of our own ragdolls on MuJoCo and prints the same report as `peers run`.

Needs `pip install mujoco`. The figures come from `peers mjcf`, so that both engines run the same bodies, masses, joints,
limits, friction and pairs that do not collide. MuJoCo runs at its own default step of 2 ms, single-threaded. Its times are
given for 1/60 s of the scene, as those of the others.
"""

import argparse
import json
import subprocess
import sys
import time
import xml.etree.ElementTree as ET

STEP = 1.0 / 60.0
# Steps of MuJoCo in one timed batch: 50 ms of the scene, three steps of the others.
BATCH_SECONDS = 3 * STEP
# Batches between two measurements of depth, as often as for the other engines.
LOOK_EVERY = 5
EXCEEDED = 0.1


def numbers(values):
    return " ".join(repr(float(value)) for value in values)


def renamed(element, suffix):
    copy = ET.fromstring(ET.tostring(element))
    for part in copy.iter():
        if "name" in part.attrib:
            part.attrib["name"] += suffix
    return copy


def model_text(scene):
    """A MuJoCo model with all figures, walls and friction of the scene."""
    root = ET.fromstring(scene["mjcf"])
    default = ET.SubElement(root, "default")
    # Sliding friction; the other coefficients act only if a contact has more directions than MuJoCo's default.
    ET.SubElement(default, "geom", friction=numbers([scene["friction"], 0.005, 0.0001]))
    world = root.find("worldbody")
    figure = world.find("body")
    world.remove(figure)
    for wall in scene["walls"]:
        ET.SubElement(world, "geom", type="box", size=numbers(wall["size"]), pos=numbers(wall["pos"]),
                      quat=numbers(wall["quat"]))
    contact = root.find("contact")
    excludes = list(contact) if contact is not None else []
    for exclude in excludes:
        contact.remove(exclude)
    for number, place in enumerate(scene["figures"]):
        copy = renamed(figure, f"/{number}")
        copy.attrib.update(pos=numbers(place["pos"]), quat=numbers(place["quat"]))
        world.append(copy)
        for exclude in excludes:
            pair = {side: f"{exclude.attrib[side]}/{number}" for side in ("body1", "body2")}
            ET.SubElement(contact, "exclude", **pair)
    return ET.tostring(root, encoding="unicode")


def quantile(values, share):
    values = sorted(values)
    return values[max(0, -int(-share * len(values) // 1) - 1)]


class Meter:
    """Penetration depths reported by MuJoCo, and overshoots of hinge ranges."""

    def __init__(self, mujoco, model):
        self.np = __import__("numpy")
        hinges = [j for j in range(model.njnt) if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_HINGE
                  and model.jnt_limited[j]]
        self.address = model.jnt_qposadr[hinges]
        self.range = model.jnt_range[hinges]
        self.run_depth, self.worst, self.end = 0.0, self.np.zeros(len(hinges)), None

    def observe(self, data):
        angles = data.qpos[self.address]
        over = self.np.maximum(self.range[:, 0] - angles, angles - self.range[:, 1]).clip(min=0.0)
        self.worst, self.end = self.np.maximum(self.worst, over), over
        depths = self.depths(data)
        self.run_depth = max([self.run_depth, *depths])

    @staticmethod
    def depths(data):
        return [float(-dist) for dist in data.contact.dist[: data.ncon] if dist < 0.0]

    def to_json(self, data):
        depths = self.depths(data)
        hinge = {
            "joints": len(self.worst),
            "exceeded_end": int((self.end > EXCEEDED).sum()),
            "exceeded_run": int((self.worst > EXCEEDED).sum()),
            "worst_end_rad": float(self.end.max()),
            "worst_run_rad": float(self.worst.max()),
        }
        return {
            # Joints are coordinates: they cannot come apart.
            "joint_gap_peak_m": 0.0,
            "joint_gap_end_max_m": 0.0,
            "limits": {"hinge": hinge},
            "penetration_run_max_m": self.run_depth,
            "penetration_end_max_m": max(depths, default=0.0),
            "penetration_end_p99_m": quantile(depths, 0.99) if depths else 0.0,
            "lost_bodies": int((data.xipos[1:, 2] < -1.0).sum()),
        }


def run(mujoco, scene, steps, quality):
    model = mujoco.MjModel.from_xml_string(model_text(scene))
    # Memory for a heap; only the used part is touched.
    data = mujoco.MjData(model)
    batch = round(BATCH_SECONDS / model.opt.timestep)
    per_step = STEP / (batch * model.opt.timestep)
    batches = max(1, round(steps * STEP / (batch * model.opt.timestep)))
    times = []
    for _ in range(batches):
        start = time.process_time()
        mujoco.mj_step(model, data, batch)
        times.append((time.process_time() - start) * 1e3 * per_step)
    report = {
        "engine": "mujoco",
        "version": mujoco.__version__,
        "flags": "as its wheel",
        "settings": f"defaults: steps of {model.opt.timestep * 1e3:g} ms, Newton's method, 64 bits, one thread; "
        "times are for 1/60 s",
        "scene": scene["scene"],
        "steps": steps,
        "bodies": scene["bodies"],
        "joints": scene["joints"],
        "cpu_ms": {
            "median": quantile(times, 0.5),
            "p99": quantile(times, 0.99),
            "mean": sum(times) / len(times),
            "last_third": quantile(times[len(times) * 2 // 3:], 0.5),
            "best": min(times),
        },
        "contacts_end": int(data.ncon),
        "warnings": {str(mujoco.mjtWarning(i).name): int(w.number) for i, w in enumerate(data.warning)
                     if w.number},
    }
    if quality:
        data = mujoco.MjData(model)
        meter = Meter(mujoco, model)
        for _ in range(batches * LOOK_EVERY):
            mujoco.mj_step(model, data, max(1, batch // LOOK_EVERY))
            meter.observe(data)
        report["quality"] = meter.to_json(data)
    return report


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--peers", required=True, help="the binary that says what the scene is")
    parser.add_argument("--engine", choices=["mujoco"], default="mujoco")
    parser.add_argument("--scene", required=True)
    parser.add_argument("--steps", type=int)
    parser.add_argument("--start")
    parser.add_argument("--quality", action="store_true")
    arguments = parser.parse_args()
    try:
        import mujoco
    except ImportError:
        print("error: MuJoCo is missing: `pip install mujoco`", file=sys.stderr)
        return 2
    command = [arguments.peers, "mjcf", "--scene", arguments.scene]
    if arguments.start is not None:
        command += ["--start", arguments.start]
    scene = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    # The name in the command.
    scene["scene"] = arguments.scene
    print(json.dumps(run(mujoco, scene, arguments.steps or scene["steps"], arguments.quality)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
