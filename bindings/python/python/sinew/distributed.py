"""Maps a function over files × seeds × settings on many machines, by Ray: `pip install sinew[ray]`.

`run` cuts the tasks into chunks. A worker does a chunk, writes the GLBs of its tasks, and then their rows as one Parquet file, each under another
name first and renamed when it is whole. So a chunk is there or it is not: a worker that dies leaves nothing that counts, its chunk is done
again, and a run that was stopped goes on with the chunks that are missing. Workers on other machines write to the same folder, so `out` lies on
a file system that all of them share, and so do the files.

    from sinew import distributed
    distributed.run(distributed.fall, out="falls", seeds=range(10_000))
    table = distributed.read("falls")
"""

from __future__ import annotations

import functools
import hashlib
import itertools
import json
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import ray

import sinew

__all__ = ["Progress", "Task", "bake", "build", "doctor", "fall", "read", "run"]

Row = dict[str, Any]
Settings = Mapping[str, Any]


@dataclass(frozen=True)
class Task:
    """One call of the function: a file (None: the mannequin), a seed and settings, by its number in the run."""

    index: int
    file: str | None
    seed: int | None
    settings: Settings


@dataclass(frozen=True)
class Progress:
    """State of a run: numbers of finished, total and failed tasks, and of dead workers."""

    done: int
    total: int
    failed: int
    deaths: int


Function = Callable[[Task], Row]


@functools.lru_cache(maxsize=8)
def _file(path: str | None) -> sinew.CharacterFile:
    return sinew.mannequin() if path is None else sinew.load(path)


@functools.lru_cache(maxsize=8)
def _character(path: str | None) -> sinew.Character:
    return _file(path).character()


def _baked(fallen: sinew.Bake) -> Row:
    return {
        "hash": f"{fallen.hash:016x}",
        "verdict": fallen.verdict,
        "frames": len(fallen.times),
        "hits": json.dumps(fallen.hits),
        **fallen.quality,
        "glb": fallen.glb(mesh=False),
    }


def fall(task: Task) -> Row:
    """A random fall of the character: pose, hit and ground by the seed. Settings: those of `Character.random_fall`."""
    if task.seed is None:
        raise ValueError("a random fall has a seed")
    return _baked(_character(task.file).random_fall(task.seed, **task.settings))


def bake(task: Task) -> Row:
    """A bake of the character. Settings: those of `Character.bake`."""
    return _baked(_character(task.file).bake(**task.settings))


def build(task: Task) -> Row:
    """The ragdoll of the character: its definition, and metrics of its drops. Settings: those of `CharacterFile.build`."""
    ragdoll = _file(task.file).build(**task.settings)
    tested, report = ragdoll.drop_test(), ragdoll.report
    return {
        "bodies": report["bodies"],
        "total_mass_kg": report["total_mass_kg"],
        "height_m": report["height_m"],
        "skin_error_m": report["skin_error_m"],
        "notes": report["notes"],
        "verdict": tested["verdict"],
        "reasons": tested["reasons"],
        "definition": ragdoll.to_json(),
    }


def doctor(task: Task) -> Row:
    """Findings about the ragdoll of a character, a definition or an MJCF model."""
    ragdoll = _file(None).build() if task.file is None else sinew.load_ragdoll(task.file)
    findings = ragdoll.doctor()["findings"]
    return {"errors": sum(finding["severity"] == "error" for finding in findings), "findings": json.dumps(findings)}


def _row(function: Function, task: Task) -> Row:
    row: Row = {
        "index": task.index,
        "file": task.file,
        "seed": task.seed,
        "settings": json.dumps(dict(task.settings), sort_keys=True),
        "error": None,
    }
    try:
        made = dict(function(task))
    except Exception as error:  # a failure is a row, whatever it is
        row["error"] = f"{type(error).__name__}: {error}"
        return row
    clash = row.keys() & made.keys()
    if clash:
        row["error"] = f"ValueError: the function gives columns of the run's own: {', '.join(sorted(clash))}"
        return row
    return row | made


def _write(path: Path, data: bytes) -> None:
    """Writes atomically. If two processes write the same file, either result is correct."""
    whole = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    with open(whole, "wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    os.replace(whole, path)


def _rows(function: Function, tasks: Sequence[Task], out: Path) -> list[Row]:
    """Runs tasks, writes their GLBs, and returns their rows."""
    rows = []
    for task in tasks:
        row = _row(function, task)
        glb = row.pop("glb", None)
        row["glb"] = None
        if glb is not None:
            row["glb"] = f"glb/{task.index:08d}.glb"
            _write(out / row["glb"], glb)
        rows.append(row)
    return rows


def _write_part(path: Path, rows: list[Row]) -> None:
    columns = list(dict.fromkeys(name for row in rows for name in row))
    table = pa.table({name: pa.array([row.get(name) for row in rows]) for name in columns})
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink)
    _write(path, sink.getvalue().to_pybytes())


def _part(out: Path, chunk: int) -> Path:
    return out / "parts" / f"{chunk:08d}.parquet"


@ray.remote(max_retries=0)
def _chunk(function: Function, tasks: Sequence[Task], out: Path, chunk: int) -> int:
    rows = _rows(function, tasks, out)
    _write_part(_part(out, chunk), rows)
    return sum(row["error"] is not None for row in rows)


@ray.remote(max_retries=0)
def _alone(function: Function, task: Task, out: Path) -> list[Row]:
    return _rows(function, [task], out)


def _survivors(function: Function, tasks: Sequence[Task], out: Path, chunk: int) -> int:
    """Runs a chunk whose workers die repeatedly task by task: a task that kills its worker becomes a row."""
    rows: list[Row] = []
    for task in tasks:
        try:
            done: list[Row] = ray.get(_alone.remote(function, task, out))
            rows += done
        except ray.exceptions.RayError as error:
            dead = _row(lambda _: {}, task)
            first = next(iter(str(error).splitlines()), "")
            dead["error"] = f"{type(error).__name__}: the worker died at {task.file or 'the mannequin'}: {first}"
            rows.append(dead | {"glb": None})
    _write_part(_part(out, chunk), rows)
    return sum(row["error"] is not None for row in rows)


def _spec(function: Function, tasks: Sequence[Task], chunk: int) -> Row:
    """Parameters of a run in a folder; a run continues only with equal ones."""
    named = f"{function.__module__}.{function.__qualname__}"
    listed = json.dumps([(task.file, task.seed, dict(task.settings)) for task in tasks], sort_keys=True)
    return {
        "function": named,
        "tasks": len(tasks),
        "chunk": chunk,
        "sinew": sinew.__version__,
        "digest": hashlib.sha256(listed.encode()).hexdigest(),
    }


def _print(progress: Progress) -> None:
    is_done = progress.done == progress.total
    if not is_done and not sys.stderr.isatty():
        return
    end = "\n" if is_done else "\r"
    failed, deaths = progress.failed, progress.deaths
    print(f"{progress.done} of {progress.total}, {failed} failed, {deaths} workers died", end=end, file=sys.stderr)


def run(
    function: Function,
    *,
    out: str | os.PathLike[str],
    files: Iterable[str | os.PathLike[str] | None] = (None,),
    seeds: Iterable[int | None] = (None,),
    settings: Iterable[Settings] = ({},),
    chunk: int = 50,
    deaths: int = 2,
    progress: Callable[[Progress], None] | None = _print,
) -> Progress:
    """Calls the function for every file × seed × settings, and writes rows and GLBs into the folder `out`.

    A function takes a `Task` and gives a row: a dict of plain values; `glb`, if it is there, is bytes that become a file. What it raises is the
    row's `error`. A chunk whose worker died is done again, `deaths` times; then its tasks are done one by one, and that which kills becomes a
    row too. A folder in which another run was begun is refused with a `ValueError`.

    Runs on the cluster that Ray is connected to (`ray.init(address=...)`), else on the cores of this machine.
    """
    folder = Path(out).absolute()
    names = [None if file is None else str(file) for file in files]
    seed_list, settings_list = list(seeds), list(settings)
    product = [(file, seed, one) for file in names for seed in seed_list for one in settings_list]
    tasks = [Task(index, file, seed, one) for index, (file, seed, one) in enumerate(product)]
    if chunk < 1 or deaths < 0:
        raise ValueError("a chunk must have at least one task, and deaths must be at least 0")
    spec = _spec(function, tasks, chunk)
    for name in ("parts", "glb"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    begun = folder / "run.json"
    if begun.exists():
        before = json.loads(begun.read_text())
        if before != spec:
            changed = ", ".join(name for name in spec if before.get(name) != spec[name])
            raise ValueError(f"{begun}: another run was begun here; different: {changed}")
    else:
        _write(begun, json.dumps(spec, indent=1).encode())
    if not ray.is_initialized():
        ray.init(log_to_driver=False)
    return _drive(function, tasks, folder, chunk, deaths, progress)


def _drive(
    function: Function,
    tasks: Sequence[Task],
    folder: Path,
    size: int,
    deaths: int,
    tell: Callable[[Progress], None] | None,
) -> Progress:
    """Keeps all workers busy until every chunk is done."""
    chunks = [tasks[at : at + size] for at in range(0, len(tasks), size)]
    done = failed = died = 0
    todo: list[int] = []
    for number, part in enumerate(chunks):
        path = _part(folder, number)
        if path.exists():
            done += len(part)
            failed += pq.read_table(path, columns=["error"]).column("error").drop_null().length()
        else:
            todo.append(number)
    waiting: Iterator[int] = iter(todo)
    remote = ray.put(function)
    running: dict[Any, int] = {}
    attempts = dict.fromkeys(todo, 0)

    def start(number: int) -> None:
        attempts[number] += 1
        running[_chunk.remote(remote, chunks[number], folder, number)] = number

    def state() -> Progress:
        return Progress(done, len(tasks), failed, died)

    # Two chunks per core: one runs, one waits.
    resources: dict[str, float] = ray.cluster_resources()  # type: ignore[no-untyped-call]
    for number in itertools.islice(waiting, max(2, 2 * int(resources.get("CPU", 1)))):
        start(number)
    told = 0.0
    while running:
        (ready, *_), _rest = ray.wait(list(running), num_returns=1)
        number = running.pop(ready)
        try:
            failed += ray.get(ready)
        except ray.exceptions.RayTaskError:
            raise  # of our own code or of the disk: to go on would hide it
        except ray.exceptions.RayError:
            died += 1
            if attempts[number] <= deaths:
                start(number)
                continue
            failed += _survivors(function, chunks[number], folder, number)
        done += len(chunks[number])
        following = next(waiting, None)
        if following is not None:
            start(following)
        if tell is not None and time.monotonic() - told > 1.0 and done < len(tasks):
            told = time.monotonic()
            tell(state())
    if tell is not None:
        tell(state())
    return state()


def read(out: str | os.PathLike[str]) -> pa.Table:
    """Returns all rows of a folder, in the order of the tasks."""
    parts = sorted((Path(out) / "parts").glob("*.parquet"))
    tables = [pq.read_table(part) for part in parts]
    table = pa.concat_tables(tables, promote_options="permissive")
    return table.sort_by("index")
