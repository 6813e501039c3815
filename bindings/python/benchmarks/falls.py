#!/usr/bin/env python3
"""Makes a data set of falls of the mannequin on Ray workers. Compares the throughput with one process, checks the files, and compares hashes with single runs.

    python falls.py --out falls --count 10000 --workers 2

Ray gives its workers a low priority; on a machine that has other work to do, RAY_worker_niceness=0 gives them that of one process.
"""

import argparse
import json
import random
import struct
import time
from pathlib import Path

import ray

import sinew
from sinew import distributed


def is_valid(path: Path) -> bool:
    """Checks that a GLB has valid chunk lengths and one animation with the expected frames."""
    data = path.read_bytes()
    magic, version, length, size, kind = struct.unpack_from("<4sIII4s", data)
    if (magic, version, kind, length) != (b"glTF", 2, b"JSON", len(data)):
        return False
    document = json.loads(data[20 : 20 + size])
    (binary,) = struct.unpack_from("<I", data, 20 + size)
    whole = 28 + size + binary == len(data) and document["buffers"][0]["byteLength"] <= binary
    channels = document["animations"][0]["channels"]
    return whole and len(document["animations"]) == 1 and len(channels) > 10


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--out", type=Path, required=True)
    arguments.add_argument("--count", type=int, default=10_000)
    arguments.add_argument("--seconds", type=float, default=3.0)
    arguments.add_argument("--workers", type=int, default=2)
    arguments.add_argument("--alone", type=int, default=100, help="falls that one process makes for comparison")
    given = arguments.parse_args()
    ray.init(num_cpus=given.workers, include_dashboard=False, log_to_driver=False)
    settings = [{"seconds": given.seconds}]
    start = time.perf_counter()
    progress = distributed.run(distributed.fall, out=given.out, seeds=range(given.count), settings=settings)
    spread = time.perf_counter() - start
    table = distributed.read(given.out)
    rows = table.to_pylist()
    chosen = sorted(random.Random(1).sample(range(given.count), min(given.alone, given.count)))
    character = sinew.mannequin().character()
    equal, start = 0, time.perf_counter()
    for index in chosen:
        fall = character.random_fall(index, seconds=given.seconds)
        equal += rows[index]["hash"] == f"{fall.hash:016x}" and (given.out / rows[index]["glb"]).read_bytes() == fall.glb(mesh=False)
    alone = (time.perf_counter() - start) / len(chosen)
    print(json.dumps({
        "falls": len(rows), "failed": progress.failed, "workers": given.workers,
        "indices_once": table["index"].to_pylist() == list(range(given.count)),
        "falls_per_s_on_workers": given.count / spread, "falls_per_s_alone": 1 / alone,
        "ratio": given.count / spread * alone,
        "valid_files": sum(is_valid(given.out / row["glb"]) for row in rows),
        "compared_alone": len(chosen), "equal": equal,
        "verdicts": {name: sum(row["verdict"] == name for row in rows) for name in ("good", "usable", "bad")},
        "joint_gap_max_m": max(row["joint_gap_max_m"] for row in rows), "not_finite": sum(row["nan"] for row in rows),
    }, indent=1))


if __name__ == "__main__":
    main()
