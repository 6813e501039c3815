#!/usr/bin/env python3
"""Runs the whole benchmark on one large machine: scenes in parallel, each on its own core, on which the engines alternate.

Takes minutes where `cargo xtask bench` takes hours. Scenes share memory and the last cache, so times are larger than those
of an idle machine, for all engines; compare engines, not runs. Build the binaries as `cargo xtask bench` does, then

    python3 bench/peers/spread.py --peers target/bench/peers/release/peers \\
        --wide target/bench/peers-x86-64-v3/release/peers --revision "$(git show -s --format='%h of %cs')" --out runs.json
    cargo xtask bench --take runs.json
"""

import argparse
import json
import os
import queue
import subprocess
import sys
import threading
import time
from pathlib import Path

ROUNDS = 3
# Starts of a chaotic scene.
STARTS = 5
MUJOCO = Path(__file__).with_name("mujoco_run.py")
# The longest scenes come first, so that no core is left with one at the end.
LONG = ["humanoid_pile_100", "rain", "crowd_pile", "ragdoll_pile", "boxes_10000", "joint_grid", "cloth", "box_rain",
        "large_pyramid", "humanoid_pile_10"]


def listed(binary):
    return json.loads(subprocess.run([binary, "list"], capture_output=True, text=True, check=True).stdout)


def commands(options, mujoco):
    """Engines for each kind of scene, as (name, command)."""
    by_field = {}
    for binary in filter(None, [options.peers, options.wide]):
        for engine in listed(binary)["engines"]:
            if engine["built"] and (binary == options.peers or engine["name"].startswith("rapier")):
                for field in engine["fields"]:
                    by_field.setdefault(field, []).append((engine["name"], [binary, "run", "--engine", engine["name"]]))
    for engines in by_field.values():
        engines.sort(key=lambda engine: (engine[0] != "sinew", not engine[0].startswith("rapier")))
    if mujoco:
        by_field["figures"].append(("mujoco", [sys.executable, str(MUJOCO), "--peers", options.peers]))
    return by_field


def processor():
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines() if Path("/proc/cpuinfo").exists() else []
    return next((line.split(": ", 1)[1] for line in lines if line.startswith("model name")), "an unknown processor")


def reported(command, core, seconds):
    """Output of a run; `None` after a timeout."""
    if seconds < 1.0:
        return None
    try:
        done = subprocess.run(["taskset", "-c", str(core), *command], capture_output=True, text=True, timeout=seconds)
        return json.loads(done.stdout)
    except subprocess.TimeoutExpired:
        return None
    except json.JSONDecodeError:
        return {"failed": done.stderr.strip()[-300:] or f"exit status {done.returncode}"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peers", required=True, help="the binary with Rapier, Box3D and Jolt")
    parser.add_argument("--wide", help="the binary with Rapier eight lanes wide")
    parser.add_argument("--revision", required=True, help="commit that was built")
    parser.add_argument("--out", required=True, help="file to write, in the form of bench/benchmarks.json")
    parser.add_argument("--scene", action="append", help="only this scene")
    parser.add_argument("--cores", type=int, default=max(1, (os.cpu_count() or 1) - 2), help="scenes at a time")
    parser.add_argument("--seconds", type=float, default=3600.0, help="rounds that are not complete by then are left out")
    options = parser.parse_args()

    end = time.monotonic() + options.seconds
    has_mujoco = subprocess.run([sys.executable, "-c", "import mujoco"], capture_output=True, check=False).returncode == 0
    engines = commands(options, has_mujoco)
    scenes = [s for s in listed(options.peers)["scenes"] if not options.scene or s["name"] in options.scene]
    rank = {name: at for at, name in enumerate(LONG)}
    jobs = [(scene, turn) for scene in scenes for turn in range(1, (STARTS if scene["is_chaotic"] else ROUNDS) + 1)]
    jobs.sort(key=lambda job: (job[1], rank.get(job[0]["name"], len(LONG))))
    waiting = queue.Queue()
    for job in jobs:
        waiting.put(job)
    runs = {scene["name"]: {} for scene in scenes}

    def work(core):
        while True:
            try:
                scene, turn = waiting.get_nowait()
            except queue.Empty:
                return
            more = ["--scene", scene["name"]]
            more += ["--start", str(turn)] if scene["is_chaotic"] else []
            more += ["--quality"] if scene["is_chaotic"] or turn == 1 else []
            race = {name: reported(command + more, core, end - time.monotonic())
                    for name, command in engines.get(scene["field"], [])}
            if None not in race.values():
                runs[scene["name"]][turn] = race
                times = (f"{name} {report.get('cpu_ms', {}).get('median', '–')}" for name, report in race.items())
                print(scene["name"], turn, "of this round, ms:", ", ".join(times), flush=True)

    workers = [threading.Thread(target=work, args=(core,)) for core in range(options.cores)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()

    def result(scene):
        turns = [race for _, race in sorted(runs[scene["name"]].items())]
        by_engine = {name: [race[name] for race in turns] for name in turns[0]}
        beside = f", {options.cores} scenes side by side" if options.cores > 1 else ""
        revision = f"{options.revision}{beside}"
        return {"scene": scene["name"], "about": scene["about"], "revision": revision, "engines": by_engine}

    machine = f"{os.cpu_count()} cores of {processor()}, scenes measured at a time: {options.cores}. Differences under 20 % are none.\n"
    written = {"sinew": "benchmarks", "version": 1, "machine": machine, "scenes": [result(s) for s in scenes if runs[s["name"]]]}
    Path(options.out).write_text(json.dumps(written), encoding="utf-8")


if __name__ == "__main__":
    main()
