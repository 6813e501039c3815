#!/usr/bin/env python3
"""A thousand humanoids in batch: Sinew's `BatchWorlds` against MuJoCo's `mujoco.rollout`, with the same model, start and length.

    pip install sinew mujoco
    python mujoco_rollout.py humanoid.xml

Every humanoid starts turned at random, its lowest point some decimetres above the floor, and falls limp: no actuator of the model is driven. Both
have as many threads. Times are of the processor, all threads together, taken by turns (`--rounds`), the best of each: what else the machine does counts for
neither. Quality is measured in a run of its own, over as many of the humanoids as `--looked-at`.
"""

import argparse
import json
import os
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import numpy as np
from mujoco import rollout

import sinew


def starts(count: int, height: float, seed: int):
    """Rotations (z up, w x y z as in MuJoCo) and positions of the roots."""
    rng = np.random.default_rng(seed)
    turns = rng.normal(size=(count, 4))
    return turns / np.linalg.norm(turns, axis=1, keepdims=True), height


def y_up(quat):
    """Converts a rotation from MuJoCo's axes (w x y z) to ours (x y z w): its z is our y, its y our -z."""
    w, x, y, z = np.moveaxis(quat, -1, 0)
    return np.stack([x, z, -y, w], -1)


class MuJoCo:
    def __init__(self, path: Path, turns, height: float, threads: int):
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.datas = [mujoco.MjData(self.model) for _ in range(threads)]
        data = mujoco.MjData(self.model)
        mujoco.mj_resetData(self.model, data)
        self.size = mujoco.mj_stateSize(self.model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        self.initial = np.zeros((len(turns), self.size))
        for row, turn in zip(self.initial, turns):
            mujoco.mj_resetData(self.model, data)
            data.qpos[2], data.qpos[3:7] = height, turn
            mujoco.mj_getState(self.model, data, row, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        self.rollout = rollout.Rollout(nthread=threads)

    def run(self, seconds: float):
        steps = round(seconds / self.model.opt.timestep)
        before, wall = time.process_time(), time.perf_counter()
        state, _ = self.rollout.rollout(self.model, self.datas, self.initial, nstep=steps)
        self.end = state[:, -1]
        return time.process_time() - before, time.perf_counter() - wall

    def quality(self, seconds: float, looked_at: int):
        data = mujoco.MjData(self.model)
        run = rest = over = 0.0
        hinges = [j for j in range(self.model.njnt) if self.model.jnt_limited[j]]
        at, ranges = self.model.jnt_qposadr[hinges], self.model.jnt_range[hinges]
        for row in self.initial[:looked_at]:
            mujoco.mj_setState(self.model, data, row, mujoco.mjtState.mjSTATE_FULLPHYSICS)
            for _ in range(round(seconds * 60)):
                mujoco.mj_step(self.model, data, round(1 / 60 / self.model.opt.timestep) or 1)
                depth = max([0.0, *(-data.contact.dist[: data.ncon])])
                run = max(run, depth)
                past = np.maximum(ranges[:, 0] - data.qpos[at], data.qpos[at] - ranges[:, 1])
                over = max(over, float(past.max(initial=0.0)))
            rest = max(rest, depth)
        return {"penetration_max_mm": 1e3 * run, "penetration_end_mm": 1e3 * rest, "joint_gap_max_mm": 0.0,
                "past_limits_max_deg": float(np.degrees(over))}


class Sinew:
    def __init__(self, path: Path, turns, height: float, threads: int):
        self.model = sinew.load_model(path)
        self.batch = sinew.BatchWorlds(self.model, len(turns), floor=False, sleeping=False, threads=threads)
        first = self.batch.poses()[0]
        # Rotate about the position of the first body, as MuJoCo rotates its root.
        turn, root = y_up(turns), first[0, :3]
        motions = np.zeros((len(turns), 7), np.float32)
        motions[:, 3:] = turn
        carried = self.batch.carried(motions)
        carried[:, :, :3] += np.float32([0, height, 0]) - carried[:, :1, :3]
        self.starts, self.root = carried, root

    def run(self, seconds: float):
        self.batch.reset(poses=self.starts)
        steps = round(seconds * 60)
        before, wall = time.process_time(), time.perf_counter()
        self.batch.step(steps)
        return time.process_time() - before, time.perf_counter() - wall

    def quality(self, seconds: float, looked_at: int):
        batch = sinew.BatchWorlds(self.model, looked_at, floor=False, sleeping=False, threads=1)
        batch.reset(poses=self.starts[:looked_at])
        run = gap = 0.0
        for _ in range(round(seconds * 60)):
            batch.step()
            depths = batch.depths()
            run, gap = max(run, float(depths.max())), max(gap, float(batch.joint_gaps().max()))
        return {"penetration_max_mm": 1e3 * run, "penetration_end_mm": 1e3 * float(depths.max()),
                "joint_gap_max_mm": 1e3 * gap}


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("model", type=Path, help="an MJCF model with a free root and a floor")
    arguments.add_argument("--count", type=int, default=1000)
    arguments.add_argument("--seconds", type=float, default=2.0)
    arguments.add_argument("--threads", type=int, default=os.cpu_count())
    arguments.add_argument("--rounds", type=int, default=3)
    arguments.add_argument("--looked-at", type=int, default=100)
    arguments.add_argument("--seed", type=int, default=1)
    given = arguments.parse_args()
    root = ET.parse(given.model).getroot().find("worldbody/body")
    height = float(root.get("pos", "0 0 1").split()[2]) + 0.3
    turns, height = starts(given.count, height, given.seed)
    engines = {"sinew": Sinew(given.model, turns, height, given.threads),
               "mujoco": MuJoCo(given.model, turns, height, given.threads)}
    times = {name: [] for name in engines}
    for _ in range(given.rounds):
        for name, engine in engines.items():
            times[name].append(engine.run(given.seconds))
    simulated = given.count * given.seconds
    report = {"humanoids": given.count, "seconds": given.seconds, "threads": given.threads,
              "mujoco_version": mujoco.__version__, "mujoco_step_s": engines["mujoco"].model.opt.timestep}
    for name, engine in engines.items():
        processor = [pair[0] for pair in times[name]]
        report[name] = {
            "simulated_s_per_processor_s": simulated / min(processor),
            "of_each_round": [round(simulated / spent, 1) for spent in processor],
            "simulated_s_per_s_of_the_clock": simulated / min(pair[1] for pair in times[name]),
            **engine.quality(given.seconds, min(given.looked_at, given.count)),
        }
    # Final positions, to check that both did the same.
    engines["sinew"].run(given.seconds)
    report["sinew"]["root_height_end_m"] = float(np.median(engines["sinew"].batch.poses()[:, 0, 1]))
    report["mujoco"]["root_height_end_m"] = float(np.median(engines["mujoco"].end[:, 3]))
    print(json.dumps(report, indent=1))


if __name__ == "__main__":
    main()
