"""Runs on a local Ray of two workers: each task once, the same bits, failures as rows."""

import json
import os
import signal
import sys
from pathlib import Path

import pytest

ray = pytest.importorskip("ray")
pq = pytest.importorskip("pyarrow.parquet")

import sinew  # noqa: E402
from sinew import distributed  # noqa: E402


@pytest.fixture(scope="module", autouse=True)
def two_workers():
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    # Functions of this file exist only in this process.
    import cloudpickle  # noqa: F401

    ray.cloudpickle.register_pickle_by_value(sys.modules[__name__])
    yield
    ray.shutdown()


def killing_once(flag: Path, at: int):
    """A fall; the first run of task `at` kills its worker in the middle of its chunk."""

    def fall(task: distributed.Task) -> distributed.Row:
        if task.index == at and not flag.exists():
            flag.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return distributed.fall(task)

    return fall


def kills_at_seven(task: distributed.Task) -> distributed.Row:
    if task.seed == 7:
        os.kill(os.getpid(), signal.SIGKILL)
    return {"twice": 2 * (task.seed or 0)}


def check_whole(out: Path, count: int, seconds: float):
    """Checks that every task has one row, and the hash and the file of a single run."""
    table = distributed.read(out)
    assert table["index"].to_pylist() == list(range(count))
    character = sinew.mannequin().character()
    for row in table.to_pylist():
        alone = character.random_fall(row["seed"], seconds=seconds)
        assert row["error"] is None and row["hash"] == f"{alone.hash:016x}"
        assert (out / row["glb"]).read_bytes() == alone.glb(mesh=False)
    assert len(list((out / "glb").glob("*.glb"))) == count
    strays = list((out / "parts").glob("*.tmp"))
    assert not strays, "no part was left half done"


def test_a_killed_worker_loses_no_task(tmp_path):
    out, flag = tmp_path / "falls", tmp_path / "killed"
    function = killing_once(flag, 9)
    settings = [{"seconds": 1.0}]
    progress = distributed.run(function, out=out, seeds=range(18), settings=settings, chunk=6, progress=None)
    assert flag.exists() and progress == distributed.Progress(18, 18, 0, 1)
    check_whole(out, 18, 1.0)


def test_a_stopped_run_continues_with_missing_tasks(tmp_path):
    out = tmp_path / "falls"
    settings = [{"seconds": 1.0}]
    distributed.run(distributed.fall, out=out, seeds=range(8), settings=settings, chunk=2, progress=None)
    kept = {part.name: part.stat().st_mtime_ns for part in (out / "parts").iterdir()}
    lost = out / "parts" / "00000002.parquet"
    lost.unlink()
    kept.pop(lost.name)
    progress = distributed.run(distributed.fall, out=out, seeds=range(8), settings=settings, chunk=2, progress=None)
    assert progress.done == 8
    assert all((out / "parts" / name).stat().st_mtime_ns == at for name, at in kept.items()), "what was there stays"
    check_whole(out, 8, 1.0)
    with pytest.raises(ValueError, match="another run was begun here; different: tasks, digest"):
        distributed.run(distributed.fall, out=out, seeds=range(9), settings=settings, chunk=2, progress=None)


def test_failures_are_rows_with_the_file_and_the_reason(tmp_path):
    out = tmp_path / "builds"
    files = [None, tmp_path / "nothing.glb"]
    settings = [{}, {"mass": 60.0}, {"mass": -1.0}]
    progress = distributed.run(distributed.build, out=out, files=files, settings=settings, chunk=2, progress=None)
    assert progress == distributed.Progress(6, 6, 4, 0)
    rows = distributed.read(out).to_pylist()
    assert [row["error"] is None for row in rows] == [True, True, False, False, False, False]
    assert rows[1]["total_mass_kg"] == pytest.approx(60.0) and rows[0]["verdict"] == "good"
    assert "-1" in rows[2]["error"]
    assert rows[3]["error"].startswith("FileError: ") and "nothing.glb" in rows[3]["error"]
    assert rows[3]["file"].endswith("nothing.glb")


def test_a_task_that_kills_every_worker_is_a_row(tmp_path):
    out = tmp_path / "killers"
    progress = distributed.run(kills_at_seven, out=out, seeds=range(10), chunk=5, deaths=1, progress=None)
    assert (progress.done, progress.failed, progress.deaths) == (10, 1, 2)
    rows = distributed.read(out).to_pylist()
    assert [row["seed"] for row in rows if row["error"]] == [7]
    assert "the worker died" in rows[7]["error"]
    assert [row["twice"] for row in rows if not row["error"]] == [2 * n for n in range(10) if n != 7]


def test_the_doctor_is_mapped_over_ragdolls(tmp_path):
    path = tmp_path / "it.sinew.json"
    sinew.mannequin().build().save(path)
    distributed.run(distributed.doctor, out=tmp_path / "doctor", files=[path, None], progress=None)
    rows = distributed.read(tmp_path / "doctor").to_pylist()
    assert [row["errors"] for row in rows] == [0, 0]
    assert all(isinstance(json.loads(row["findings"]), list) for row in rows)
