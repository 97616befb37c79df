"""`tripatch batch`: many files, some of them bad, by one process and by a real scheduler with two workers."""

from __future__ import annotations

import json
import os
import re
import signal
import stat
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import tripatch
from shapes import cube_sphere
from systems import WINE
from test_cli import sphere_hole, square, unjoined, write_obj
from test_crossings import trefoil
from tripatch import __main__ as cli
from tripatch import files
from tripatch.batch import command, creases, inputs, job, journal, keeper, local, memory, pictures, record, scheduling
from tripatch.batch.settings import Settings

distributed = pytest.importorskip("distributed")
psutil = pytest.importorskip("psutil")  # distributed needs it


def run(capsys, *args):
    code = cli.main(["batch", *map(str, args)])
    said = capsys.readouterr()
    return code, said.out, said.err


def lines(out):
    return [json.loads(line) for line in (out / journal.LINES).read_text().splitlines()]


def heads(out):
    return {line["input"]: line for line in lines(out) if line["line"] == "file"}


def spheres(folder, count, suffix=".obj", first=0):
    """Files with one hole each, no two alike."""
    folder.mkdir(parents=True, exist_ok=True)
    for k in range(first, first + count):
        vertices, faces = sphere_hole(2 + k % 3, rings=2)
        mesh = files.converted(files.MeshFile(vertices * [1, 1, 1 + 0.01 * k], faces), suffix)
        mesh.write(folder / f"m{k:03}{suffix}")
    return folder


@pytest.fixture(scope="module")
def cluster():
    """A scheduler of Dask with two worker processes, as on another machine."""
    if WINE:
        pytest.skip("Dask's worker processes do not start under wine")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, memory_limit=0, dashboard_address=None, silence_logs=50
    ) as made:
        yield made


COUNT_THREADS = """
import os
import numpy as np
import tripatch
row = 161
k = np.arange(row * row)
x, y = k // row / row, k % row / row
first = k[(k // row < row - 1) & (k % row < row - 1)]
first = first[(first // row % 4 != 1) | (first % row % 4 != 1)]
faces = np.column_stack([first, first + row, first + row + 1, first + 1])
counts = []
def count(*_): counts.append(len(os.listdir("/proc/self/task")))
count()
tripatch.fill_all(np.column_stack([x, y, np.sin(5 * x)]), faces, progress=count)
print(max(counts) - counts[0])
"""


@pytest.mark.skipif(sys.platform != "linux", reason="Linux says which threads there are")
@pytest.mark.parametrize("threads", range(1, 1 + min(2, os.cpu_count() or 1)))
def test_fills_take_the_threads_that_the_environment_says(threads):
    environment = {**os.environ, "TRIPATCH_THREADS": str(threads), "OPENBLAS_NUM_THREADS": "1"}
    said = subprocess.run([sys.executable, "-c", COUNT_THREADS], env=environment, capture_output=True, text=True, check=True)
    assert int(said.stdout) == threads


@pytest.mark.parametrize("given", [None, "3"])
def test_the_processes_of_a_machine_share_its_cores(tmp_path, capsys, monkeypatch, given):
    if given:
        monkeypatch.setenv("TRIPATCH_THREADS", given)
    else:
        monkeypatch.delenv("TRIPATCH_THREADS", raising=False)
    seen = []
    monkeypatch.setattr(local, "Keeper", lambda settings: seen.append(settings) or keeper.Keeper(settings))
    run(capsys, spheres(tmp_path / "in", 2), "--out", tmp_path / "out", "--workers", 9, "--worst", 0)
    assert 1 <= len(seen) <= 2  # no more than there are files
    with keeper.Keeper(seen[0]) as one:
        assert one.call("os", "getenv", "TRIPATCH_THREADS") == (given or str(max(1, (os.cpu_count() or 1) // 2)))


def test_every_format_and_folder(tmp_path, capsys):
    source = tmp_path / "in"
    for suffix in (".obj", ".ply", ".stl", ".off"):
        spheres(source / suffix[1:], 2, suffix)
    (source / "notes.txt").write_text("no mesh")
    code, out, _ = run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--worst", 0)
    assert code == 0
    assert out.startswith("Filled 8 holes in 8 of 8 files\n")
    made = heads(tmp_path / "out")
    assert [h["status"] for h in made.values()] == ["filled"] * 8
    assert sorted(made) == list(made)
    for name, head in made.items():
        mesh = files.read(tmp_path / "out" / name)
        assert len(tripatch.find_holes(mesh.faces)) == 1  # the outer border
        assert len(mesh.faces) == head["faces"] + head["new_faces"]


def test_workers_are_as_many_as_processors_where_nobody_says(tmp_path, capsys):
    code, out, _ = run(capsys, spheres(tmp_path / "in", 2), "--out", tmp_path / "out", "--worst", 0)
    assert code == 0 and out.startswith("Filled 2 holes in 2 of 2 files\n")


def test_the_same_as_fill(tmp_path, capsys):
    source = spheres(tmp_path / "in", 1)
    run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--worst", 0, "--resolution", 3, "--bulge", "1,1.2,0.8")
    cli.main(["fill", str(source / "m000.obj"), str(tmp_path / "one.obj"), "--all", "--resolution=3", "--bulge=1,1.2,0.8"])
    assert (tmp_path / "out" / "m000.obj").read_bytes() == (tmp_path / "one.obj").read_bytes()
    assert heads(tmp_path / "out")["m000.obj"]["options"] == {"resolution": 3, "bulge": [1.0, 1.2, 0.8]}


#: The names of docs/batch.md, in their order: what outside programs rely on.
FILE = (
    "schema line tripatch options input sha256 output status reason vertices faces new_vertices new_faces holes filled refused "
    "left folded unjoined"
).split()
HOLE = (
    "schema line tripatch options input object hole outer vertex edges diameter status reason where new_vertices new_faces "
    "crease_max method method_reason corners continuity fairing seam_angle_max seam_angle_rms surroundings_error deviation_max "
    "cage_deviation_max surroundings_moved_max folds triangles_folded rim_folded is_flawed crosses_itself passes_through "
    "warnings codes"
).split()


def test_every_line_has_every_name(tmp_path, capsys):
    source = spheres(tmp_path / "in", 1)
    (source / "bad.obj").write_text("v 1 2 x\n")
    write_obj(source / "some.obj", sphere_hole(3, rings=2), square())
    code, _, _ = run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--worst", 0, "--method", "side_vertex")
    assert code == 3
    by_kind = {"file": FILE, "hole": HOLE}
    found = lines(tmp_path / "out")
    assert all(list(line) == by_kind[line["line"]] for line in found)
    statuses = sorted(line["status"] for line in found if line["line"] == "hole" and line["input"] == "some.obj")
    assert statuses == ["filled", "left", "left", "refused"]
    some = heads(tmp_path / "out")["some.obj"]
    assert (some["status"], some["filled"], some["refused"], some["left"]) == ("partly", 1, 1, 2)
    documented = (Path(__file__).resolve().parents[2] / "docs" / "batch.md").read_text()
    assert all(f"`{name}`" in documented for name in (*FILE, *HOLE))


def test_a_file_whose_fill_crosses_itself_is_filled_partly(tmp_path, capsys):
    source = tmp_path / "in"
    source.mkdir()
    write_obj(source / "knot.obj", trefoil(25)[:2])
    assert run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--worst", 0)[0] == 3
    (hole,) = (line for line in lines(tmp_path / "out") if line["line"] == "hole" and line["status"] == "filled")
    assert hole["crosses_itself"]
    assert heads(tmp_path / "out")["knot.obj"]["status"] == "partly"


def test_faces_that_are_not_joined_are_filled_as_if_they_were_and_near_duplicates_refused(tmp_path, capsys):
    source = tmp_path / "in"
    source.mkdir()
    write_obj(source / "soup.obj", unjoined(*sphere_hole(3, rings=2)))
    points, quads = cube_sphere(4)
    of_half = [[v + len(points) * bool(points[q].mean(axis=0)[2] > 0) for v in q] for q in quads]
    write_obj(source / "halves.obj", (np.concatenate([points, points]), of_half))
    write_obj(source / "near.obj", (np.concatenate([points, points + [0, 0, 1e-4]]), of_half))
    for more in ([], ["--dry-run"]):
        code, out, _ = run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--worst", 0, *more)
        assert code == (0 if more else 3)
        assert "2 rims in 1 file lie upon other borders" in out
    made = heads(tmp_path / "out")
    assert {name: head["unjoined"] for name, head in made.items()} == {"halves.obj": 0, "near.obj": 2, "soup.obj": 0}
    code, _, _ = run(capsys, source / "near.obj", "--out", tmp_path / "joined", "--workers", 0, "--join", 0.1)
    assert code == 0 and lines(tmp_path / "joined")[0]["unjoined"] == 0
    assert {name: head["status"] for name, head in made.items()} == {
        "halves.obj": "nothing",
        "near.obj": "refused",
        "soup.obj": "filled",
    }


def test_filters_and_reasons_of_a_dry_run(tmp_path, capsys):
    source = tmp_path / "in"
    source.mkdir()
    write_obj(source / "two.obj", sphere_hole(3, rings=2), sphere_hole(5, rings=2, center=5))
    code, out, _ = run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--dry-run", "--max-edges", 10)
    assert code == 0
    assert not (tmp_path / "out").exists()
    told = out.splitlines()
    assert "two.obj: Hole through vertex 0, 9 edges, 1.73 wide: Would be filled" in told
    assert any("15 edges" in line and "Left out by --max-edges 10" in line for line in told)
    assert any("9 edges" in line and "An outer border, not a hole" in line for line in told)
    assert "1 hole in 1 file would be filled" in told
    assert run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--dry-run", "--max-edges", 3)[0] == 1


def test_a_dry_run_does_not_promise_what_is_refused_before_any_fill(tmp_path, capsys):
    source = tmp_path / "in"
    source.mkdir()
    vertices, faces = sphere_hole(3, rings=2)
    broken = vertices.copy()
    broken[12] = np.nan
    write_obj(source / "flipped.obj", (vertices, [faces[0][::-1], *faces[1:]]))
    write_obj(source / "nan.obj", (broken, faces))
    options = ["--out", tmp_path / "out", "--workers", 0, "--worst", 0]
    _, planned, _ = run(capsys, source, *options, "--dry-run")
    assert ", 0 wide" not in planned
    run(capsys, source, *options)
    told = {
        line["input"]: line["reason"] for line in lines(tmp_path / "out") if line["status"] == "refused" and line.get("codes")
    }
    assert len(told) == 2
    for name, reason in told.items():
        assert any(row.startswith(f"{name}: Hole") and row.endswith(f": {reason}") for row in planned.splitlines()), planned


def test_pillow_is_asked_for_only_if_pictures_are(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    source = spheres(tmp_path / "in", 1)
    code, _, err = run(capsys, source, "-o", tmp_path / "out", "--workers", 0)
    assert code == 0 and "tripatch: " not in err.replace("tripatch: 1 of 1 file", "")
    code, _, err = run(capsys, source, "-o", tmp_path / "other", "--workers", 0, "--worst", 3)
    assert code == 0 and "--worst needs Pillow: pip install 'tripatch[batch]'" in err


def test_bad_files_among_good_ones_by_a_scheduler(tmp_path, capsys, cluster):
    """Each costs itself only, and the lines are the same bytes as from one process."""
    source = spheres(tmp_path / "in", 96)
    (source / "broken.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 3\n")
    (source / "empty.obj").touch()
    (source / "empty.stl").touch()
    os.symlink(source / "nowhere", source / "gone.obj")
    read_only = source / "m000.obj"
    read_only.chmod(stat.S_IRUSR)
    blocked = tmp_path / "out" / "m001.obj"
    blocked.mkdir(parents=True)  # a folder where the result belongs
    options = ["--retries", 0, "--worst", 0, "--fairing=none"]
    code, _, err = run(capsys, source, "--out", tmp_path / "out", "--scheduler", cluster.scheduler_address, *options)
    assert code == 3
    assert "tripatch: 100 of 100 files, 95 holes filled, 4 failed" in err
    made = heads(tmp_path / "out")
    assert made["broken.ply"]["status"] == made["gone.obj"]["status"] == made["empty.stl"]["status"] == "unreadable"
    assert "The PLY file is damaged" in made["broken.ply"]["reason"]
    assert f"tripatch: broken.ply: {made['broken.ply']['reason']}\n" in err
    assert (made["empty.obj"]["status"], made["empty.obj"]["reason"]) == ("nothing", "It has no faces")
    assert made["m001.obj"]["status"] == "not written"
    assert made["m000.obj"]["status"] == "filled"
    assert sum(head["status"] == "filled" for head in made.values()) == 95
    other = tmp_path / "other"
    (other / "m001.obj").mkdir(parents=True)
    assert run(capsys, source, "--out", other, "--workers", 0, *options)[0] == 3
    assert (other / journal.LINES).read_bytes() == (tmp_path / "out" / journal.LINES).read_bytes()
    for name, head in made.items():
        if head["output"]:
            assert (other / name).read_bytes() == (tmp_path / "out" / name).read_bytes()


def test_a_worker_killed_half_way_costs_nothing(tmp_path, capsys, cluster):
    source, out = spheres(tmp_path / "in", 80), tmp_path / "out"

    def kill():
        while len(list(out.glob("*.obj"))) < 30:
            time.sleep(0.005)
        os.kill(next(iter(cluster.workers.values())).pid, signal.SIGKILL)

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    code, said, _ = run(capsys, source, "--out", out, "--scheduler", cluster.scheduler_address, "--worst", 0, "--fairing=none")
    killer.join(10)
    assert not killer.is_alive()
    assert code == 0
    assert said.startswith("Filled 80 holes in 80 of 80 files\n")


def test_resumes_by_content_options_and_results(tmp_path, capsys):
    source, out = spheres(tmp_path / "in", 4), tmp_path / "out"
    options = [source, "--out", out, "--workers", 0, "--worst", 0]
    assert "done before" not in run(capsys, *options)[2]
    written = (out / journal.LINES).read_bytes()
    assert "4 of 4 files, 4 holes filled, 4 done before" in run(capsys, *options)[2]
    assert (out / journal.LINES).read_bytes() == written
    spheres(source, 1, first=1)  # the same content, another time
    (source / "m002.obj").write_bytes((source / "m002.obj").read_bytes() + b"# another content\n")
    (out / "m003.obj").write_text("spoiled")
    assert "2 done before" in run(capsys, *options)[2]
    assert (out / "m003.obj").read_text().startswith("v ")
    assert "done before" not in run(capsys, *options, "--bulge", 1.5)[2]


def test_a_journal_that_ends_within_a_line_is_read_up_to_there(tmp_path, capsys):
    source, out = spheres(tmp_path / "in", 3), tmp_path / "out"
    run(capsys, source, "--out", out, "--workers", 0, "--worst", 0)
    (path,) = (out / journal.FOLDER).glob("journal-*")
    path.write_bytes(path.read_bytes()[:-100])
    assert "2 done before" in run(capsys, source, "--out", out, "--workers", 0, "--worst", 0)[2]


def in_child(monkeypatch, tmp_path, text):
    """Has the process that fills run a text when it starts."""
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "sitecustomize.py").write_text(text)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "site"))


#: Replaces the reading of files whose name says what becomes of the process.
_BAD = """
import os, sys
if "tripatch.batch.child" in " ".join(sys.orig_argv):
    import faulthandler, time
    from tripatch import files
    def read(path, own=files.read):
        if "crash" in path.name:
            faulthandler._read_null()
        if "sleep" in path.name:
            time.sleep(100)
        if "huge" in path.name:
            return bytearray(2**33)
        if "once" in path.name and not os.path.exists(str(path) + ".seen"):
            open(str(path) + ".seen", "w").close()
            os._exit(7)
        return own(path)
    files.read = read
"""


_HOG = """
import time
def take_all():
    kept, size = [], 2**20
    while size > 2**12:
        try:
            kept.append(bytearray(size))
        except MemoryError:
            size //= 2
    time.sleep(60)
"""


def test_a_crash_and_limits_cost_that_file_only(tmp_path, capsys, monkeypatch):
    in_child(monkeypatch, tmp_path, _BAD)
    source = spheres(tmp_path / "in", 5)
    for k, name in enumerate(("a-crash", "b-sleep", "c-huge" if memory.LIMITS else "c", "d-once")):
        (source / f"m{k:03}.obj").rename(source / f"{name}.obj")
    options = ["--workers", 0, "--worst", 0, "--time-limit", 6, "--memory-limit", 800]
    code, out, _ = run(capsys, source, "--out", tmp_path / "out", *options)
    assert code == 3
    made = heads(tmp_path / "out")
    crash = "by signal SIGSEGV" if os.name == "posix" else "with code 0xC0000005"
    assert made["a-crash.obj"]["reason"] == f"TriPatch ended {crash}"
    assert made["b-sleep.obj"]["reason"] == "It took more than 6 s"
    if memory.LIMITS:
        assert "3 files failed (1 crashed, 1 memory limit, 1 time limit)" in out
        assert made["c-huge.obj"]["reason"] == "The memory of 800 MB that a file may use was not enough"
    else:
        assert "2 files failed (1 crashed, 1 time limit)" in out
    assert made["d-once.obj"]["status"] == made["m004.obj"]["status"] == "filled"  # tried again
    again = run(capsys, source, "--out", tmp_path / "out", *options)[2]
    assert f"{2 if memory.LIMITS else 3} done before" in again  # what failed is tried again


def test_the_end_of_a_process_is_told_where_there_are_no_signals(tmp_path, capsys, monkeypatch):
    in_child(monkeypatch, tmp_path, _BAD)
    source = spheres(tmp_path / "in", 1)
    (source / "m000.obj").rename(source / "once.obj")
    monkeypatch.delattr(signal, "SIGKILL", raising=False)  # as on Windows
    monkeypatch.setattr(keeper, "_kill_group", lambda process: None)
    assert run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--worst", 0, "--retries", 0)[0] == 1
    assert heads(tmp_path / "out")["once.obj"]["reason"] == "TriPatch ended with code 7"


@pytest.mark.skipif(os.name != "posix", reason="the limit is set by the system's own call")
def test_a_memory_limit_without_effect_is_told(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(memory, "LIMITS", False)
    source = spheres(tmp_path / "in", 1)
    err = run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--worst", 0, "--memory-limit", 800)[2]
    assert "so --memory-limit has no effect" in err


@pytest.mark.skipif(sys.platform != "linux", reason="Linux says how much memory a process has")
def test_a_process_that_stays_without_memory_is_ended(tmp_path, monkeypatch):
    """As CPython does that has none for a MemoryError: it tries again and again, and no other thread of it runs."""
    (tmp_path / "hog.py").write_text(_HOG)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    settings = Settings(str(tmp_path), str(tmp_path), {}, tripatch.__version__, "crop", memory_limit=300, time_limit=30)
    with keeper.Keeper(settings) as one:
        with pytest.raises(keeper.Ended) as caught:
            one.call("hog", "take_all")
        assert caught.value.status == record.MEMORY_LIMIT
        assert one.call("math", "sqrt", 4) == 2


def test_a_process_is_recycled_and_ends_with_the_one_that_asks(tmp_path):
    source = spheres(tmp_path / "in", 3)
    settings = Settings(str(source), str(tmp_path / "out"), {}, tripatch.__version__, recycle=2)
    with keeper.Keeper(settings) as one:
        pids = [(one.work(str(source / f"m{k:03}.obj")), one._process.pid)[1] for k in range(3)]
    assert pids[0] == pids[1] != pids[2]
    ask = f"""
import time
from tripatch.batch import keeper, settings
one = keeper.Keeper(settings.Settings({str(source)!r}, {str(tmp_path / "out")!r}, {{}}, {tripatch.__version__!r}))
one.work({str(source / "m000.obj")!r})
print(one._process.pid, flush=True)
time.sleep(100)
"""
    assert ends_when_killed(subprocess.Popen([sys.executable, "-c", ask], stdout=subprocess.PIPE, text=True))


def is_gone(pid):
    """Within some seconds; a process that nobody has waited for yet counts as gone."""
    for _ in range(200):
        try:
            if psutil.Process(pid).status() == psutil.STATUS_ZOMBIE:
                return True
        except psutil.NoSuchProcess:
            return True
        time.sleep(0.02)
    return False


def ends_when_killed(asking):
    """Whether the process that another asks, and has named on stdout, is gone when that one is killed."""
    pid = int(asking.stdout.readline())
    asking.kill()
    asking.wait()
    asking.stdout.close()
    return is_gone(pid)


_HELD = """
import ctypes
import os
import pathlib
def hold(path):
    pathlib.Path(path).write_text(str(os.getpid()))
    ctypes.PyDLL(None).sleep(60)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere its own code has to end it")
def test_a_process_ends_with_the_one_that_asks_though_no_code_of_python_can_run_in_it(tmp_path, monkeypatch):
    (tmp_path / "held.py").write_text(_HELD)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")]))
    ask = f"""
import pathlib, threading, time
from tripatch.batch import keeper, settings
one = keeper.Keeper(settings.Settings({str(tmp_path)!r}, {str(tmp_path)!r}, {{}}, {tripatch.__version__!r}, "crop"))
seen = pathlib.Path({str(tmp_path / "seen")!r})
threading.Thread(target=one.call, args=("held", "hold", str(seen)), daemon=True).start()
while not seen.exists() or not seen.read_text():
    time.sleep(0.01)
print(seen.read_text(), flush=True)
time.sleep(100)
"""
    assert ends_when_killed(subprocess.Popen([sys.executable, "-c", ask], stdout=subprocess.PIPE, text=True))


def test_a_process_with_nothing_to_do_ends_though_its_worker_stays(tmp_path, monkeypatch):
    source = spheres(tmp_path / "in", 3)
    settings = Settings(str(source), str(tmp_path / "out"), {}, tripatch.__version__)
    made = []
    monkeypatch.setattr(scheduling, "Keeper", lambda given: made.append(keeper.Keeper(given)) or made[-1])

    def do(k):
        ((_, entry),) = scheduling.do_portion([(k, str(source / f"m{k:03}.obj"), None)], settings)
        assert entry["lines"][0]["status"] == "filled"

    do(0)
    pid = made[0]._process.pid
    monkeypatch.setattr(scheduling, "_IDLE", 0.01)
    do(1)
    assert len(made) == 1  # one that is free is asked again
    assert is_gone(pid)
    assert not any(scheduling._keepers.values())
    do(2)
    assert len(made) == 2


_SCHEDULER = """
import time
from distributed import LocalCluster
if __name__ == "__main__":
    given = {"processes": False, "protocol": "tcp", "memory_limit": 0, "dashboard_address": None}
    with LocalCluster(n_workers=1, threads_per_worker=1, **given) as cluster:
        print(cluster.scheduler_address, flush=True)
        time.sleep(100)
"""


def test_a_run_that_is_stopped_leaves_no_process_and_waits_for_none(tmp_path, monkeypatch):
    """A process may be at a file for hours."""
    in_child(monkeypatch, tmp_path, _BAD)
    source = spheres(tmp_path / "in", 2)
    (source / "m000.obj").rename(source / "sleep.obj")
    settings = Settings(str(source), str(tmp_path / "out"), {}, tripatch.__version__)
    made = []
    monkeypatch.setattr(local, "Keeper", lambda given: made.append(keeper.Keeper(given)) or made[-1])

    def stop(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        local.run(sorted(source.iterdir()), settings, [None, None], stop, workers=2)
    assert not (tmp_path / "out" / "sleep.obj").exists()
    for _ in range(200):
        if all(one._process is None or one._process.poll() is not None for one in made):
            break
        time.sleep(0.02)
    else:
        pytest.fail("a process goes on")


def test_a_scheduler_that_goes_away_is_said(tmp_path, capsys):
    source, out = spheres(tmp_path / "in", 40), tmp_path / "out"
    with subprocess.Popen([sys.executable, "-c", _SCHEDULER], stdout=subprocess.PIPE, text=True) as scheduler:
        address = scheduler.stdout.readline().strip()

        def end():
            for _ in range(6000):
                if list(out.glob("*.obj")):
                    break
                time.sleep(0.01)
            scheduler.kill()

        ending = threading.Thread(target=end)
        ending.start()
        code, _, err = run(capsys, source, "--out", out, "--worst", 0, "--scheduler", address)
        ending.join()
    assert code == 2
    assert f"The scheduler at {address} is gone; run the same command to continue with what is left" in err
    assert run(capsys, source, "--out", out, "--workers", 0, "--worst", 0)[0] == 0


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_ctrl_c_ends_it_orderly(tmp_path, capsys):
    """By a cluster of its own; the same command continues from there."""
    source, out = spheres(tmp_path / "in", 80), tmp_path / "out"
    command = [
        sys.executable,
        "-m",
        "tripatch",
        "batch",
        str(source),
        "--out",
        str(out),
        "--workers",
        "2",
        "--worst",
        "0",
        "--fairing=none",
    ]
    running = subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),  # these tests may run in the background
    )
    while len(list(out.glob("*.obj"))) < 20 and running.poll() is None:
        time.sleep(0.005)
    os.killpg(running.pid, signal.SIGINT)  # as a terminal does, to all processes
    said, err = running.communicate(timeout=60)
    assert running.returncode == 130, (said, err)
    assert "run the same command to continue" in err
    assert "Traceback" not in err
    assert not list(out.glob("*.part"))
    done = len(list(out.glob("*.obj")))
    code, _, err = run(capsys, source, "--out", out, "--workers", 0, "--worst", 0, "--fairing=none")
    assert code == 0
    # a file or two may have been written and not recorded
    assert done - 2 <= int(re.findall(r"(\d+) done before", err)[-1]) <= done


def test_quiet_prints_errors_only(tmp_path, capsys):
    source = spheres(tmp_path / "in", 1)
    assert run(capsys, source, "-o", tmp_path / "out", "--workers", 1, "--worst", 0, "-q") == (0, "", "")
    assert heads(tmp_path / "out")["m000.obj"]["status"] == "filled"
    assert run(capsys, source, "-o", tmp_path / "other", "-q", "--max-edges", 2)[2]


def test_only_a_scheduler_needs_dask(tmp_path, capsys, monkeypatch):
    for name in ("dask", "distributed"):
        monkeypatch.setitem(sys.modules, name, None)
    source = spheres(tmp_path / "in", 2)
    code, said, _ = run(capsys, source, "-o", tmp_path / "out", "--workers", 2, "--worst", 0)
    assert code == 0 and said.startswith("Filled 2 holes in 2 of 2 files")
    code, _, err = run(capsys, source, "-o", tmp_path / "other", "--scheduler", "tcp://127.0.0.1:1")
    assert code == 2 and "pip install 'tripatch[dask]'" in err


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ([], "Name files or folders"),
        (["nothing"], "nothing does not exist"),
        (["in", "--files", "list"], "INPUT and --files cannot be used together"),
        (["in", "--range", "1-2"], "--files"),
        (["in", "--workers", "2", "--scheduler", "tcp://127.0.0.1:1"], "--workers"),
        (["in", "--bulge", "-1"], "bulge"),
        (["in", "--root", "elsewhere"], "--root"),
        (["--files", "list", "--range", "5-3"], "5-3"),
        (["--files", "list", "--range", "2-3"], "--range must be from 1 to 1, not 2"),
        (["--files", "no-text"], "no-text is not a text file"),
        (["in", "--max-edges", "2"], "--max-edges must be 3 or more, not 2"),
        (["in", "--max-diameter", "nan"], "--max-diameter is not finite"),
        (["in", "--max-diameter", "inf", "--dry-run"], "--max-diameter is not finite"),
        (["in", "--tolerance", "1e400", "--emit", "slurm"], "--tolerance is not finite"),
        (["in", "--shape", "0.5,nan,0.5"], "shape[1] must be between 0 and 1"),
        (["in", "--alpha=-inf"], "--alpha is not finite"),
        (["in", "--worst", "-1"], "must be 0 or more, not -1"),
        (["in", "--memory-limit", "199"], ", not 199"),
        (["in", "--memory-limit", "9" * 14], ", not 99999999999999"),
        (["in", "--time-limit", "soon"], "--time-limit: 'soon' cannot be read. Write, for example, 0.5"),
        (["in", "--time-limit", "inf"], "SECONDS is not finite"),
    ],
)
def test_bad_usage(tmp_path, capsys, monkeypatch, arguments, word):
    monkeypatch.chdir(tmp_path)
    spheres(tmp_path / "in", 1)
    (tmp_path / "list").write_text("in/m000.obj\n")
    (tmp_path / "no-text").write_bytes(b"solid\0\0")
    code, _, err = run(capsys, *arguments, "--out", "out")
    assert code == 2
    assert word in err
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(WINE, reason="no links")
def test_inputs_are_never_written_over(tmp_path, capsys):
    """Nor by other names that they have."""
    source = spheres(tmp_path / "in", 2)
    before = {path.name: path.read_bytes() for path in source.iterdir()}
    (tmp_path / "folder").symlink_to(source)
    for name in ("link", "hard", "sub"):
        (tmp_path / name).mkdir()
    (tmp_path / "link" / "m001.obj").symlink_to(source / "m001.obj")
    os.link(source / "m001.obj", tmp_path / "hard" / "m001.obj")
    (tmp_path / "sub" / "in").symlink_to(source)
    for out in ("in", "folder", "link", "hard"):
        for given in (source, source / "m001.obj"):
            code, _, err = run(capsys, given, "--out", tmp_path / out, "--workers", 0)
            assert (code, "would be overwritten" in err) == (2, True), out
    assert run(capsys, source, "--root", tmp_path, "--out", tmp_path / "sub", "--workers", 0)[0] == 2
    assert {path.name: path.read_bytes() for path in source.iterdir()} == before


@pytest.mark.skipif(WINE, reason="no links")
def test_results_are_no_inputs_by_whatever_name(tmp_path, capsys):
    source = spheres(tmp_path / "in", 2)
    (tmp_path / "link").symlink_to(source)
    for out in (source / "out", tmp_path / "link" / "out"):
        assert run(capsys, source, "--out", out, "--workers", 0)[1].startswith("Filled 2 holes in 2 of 2 files")


def test_no_file_at_all_is_said(tmp_path, capsys):
    (tmp_path / "in").mkdir()
    code, out, err = run(capsys, tmp_path / "in", "--out", tmp_path / "out")
    assert (code, out) == (1, "")
    searched = ".obj, .ply, .stl, .off, .glb, .gltf, .3mf, .usd, .usda, .usdc, .blend"
    assert f"There is no file to fill. Folders are searched for {searched}" in err
    assert not (tmp_path / "out").exists()


def test_where_nothing_can_be_written_is_said_before_the_first_file(tmp_path, capsys, monkeypatch):
    def full(**_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(journal.tempfile, "TemporaryFile", full)
    monkeypatch.setattr(command.local, "run", lambda *_: pytest.fail("a file was done"))
    code, _, err = run(capsys, spheres(tmp_path / "in", 1), "--out", tmp_path / "out", "--workers", 0)
    assert code == 2
    assert f"{tmp_path / 'out'} cannot be written: No space left on device" in err


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes that have names")
def test_a_pipe_among_files_keeps_nobody_waiting(tmp_path, capsys):
    source = spheres(tmp_path / "in", 1)
    os.mkfifo(source / "pipe.obj")
    options = ["--workers", 0, "--worst", 0, "--time-limit", 20]
    assert run(capsys, source, "--out", tmp_path / "out", *options)[0] == 3
    assert heads(tmp_path / "out")["pipe.obj"]["status"] == "unreadable"


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere names of files are text")
def test_names_that_are_no_text(tmp_path, capsys):
    source = spheres(tmp_path / "in", 1)
    os.rename(source / "m000.obj", os.fsencode(source) + b"/m\xff.obj")
    for before in ("", "1 done before"):
        code, _, err = run(capsys, source, "--out", tmp_path / "out", "--workers", 0)
        assert code == 0
        assert before in err
    assert list(heads(tmp_path / "out")) == [os.fsdecode(b"m\xff.obj")]  # the lines are UTF-8 all the same
    out = run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--dry-run")[1]
    assert "m\\udcff.obj: Hole through vertex" in out


@pytest.mark.skipif(os.name != "posix", reason="no such names")
def test_a_list_has_names_with_whatever_is_no_line_break(tmp_path, capsys):
    source = spheres(tmp_path / "in", 1)
    name = "m\x1c\x85\u2028.obj"
    (source / "m000.obj").rename(source / name)
    (tmp_path / "list").write_text(f"\ufeffin/{name}\n", encoding="utf-8")
    assert inputs.from_list(tmp_path / "list") == [source / name]
    (source / name).rename(source / "a\nb.obj")
    code, out, err = run(capsys, source, "--out", tmp_path / "out", "--emit", "commands")
    assert (code, out) == (2, "")
    assert "has a line break in its name" in err


def test_no_result_stays_of_other_options(tmp_path, capsys):
    """What lies in the folder is what the lines say."""
    source, out = spheres(tmp_path / "in", 3), tmp_path / "out"  # rims of 6, 9 and 12 edges
    for more, left in (([], 3), (["--max-edges", 9], 2), ([], 3), (["--max-edges", 9], 2)):
        run(capsys, source, "--out", out, "--workers", 0, "--worst", 0, *more)
        assert len(list(out.glob("*.obj"))) == left == sum(head["output"] is not None for head in heads(out).values())
    (out / "m002.obj").write_text("of somebody else")
    run(capsys, source, "--out", out, "--workers", 0, "--worst", 0, "--max-edges", 9)
    assert (out / "m002.obj").exists()


def test_portions_are_of_a_size_and_hold_every_file_once(tmp_path):
    sizes = [10, 200_000, 50, 3_000_000, *[5000] * 200, 9_000_000, 70]
    found = [tmp_path / f"{k:03}.obj" for k in range(len(sizes))]
    for path, size in zip(found, sizes, strict=True):
        with path.open("wb") as file:
            file.truncate(size)
    parts = inputs.portions(found, 2)
    assert [k for part in parts for k in part] == list(range(len(sizes)))
    assert all(len(part) == 1 or sum(sizes[k] for k in part) <= 2_000_000 for part in parts)
    assert len(parts) < 30


def test_a_key_says_what_a_result_depends_on():
    one = Settings("/a", "/b", {"bulge": 1.5}, "1.0")
    same = Settings("/a", "/other", {"bulge": 1.5}, "1.0", time_limit=3)
    others = [Settings("/a", "/b", {"bulge": 1.25}, "1.0"), Settings("/a", "/b", {"bulge": 1.5}, "1.1")]
    key = record.key(one, "x.obj", "00")
    assert record.key(same, "x.obj", "00") == key
    assert all(record.key(other, "x.obj", "00") != key for other in others)
    assert record.key(one, "x.obj", "01") != key != record.key(one, "y.obj", "00")


def test_creases_are_the_angles_along_the_rim():
    """A square hole in a plane, filled with a roof of known slope."""
    vertices, faces = square()
    top = np.array([[-7.5, 1.5, 0.5 * np.tan(np.radians(20))]])
    roof = [[4, 5, 8], [5, 6, 8], [6, 7, 8], [7, 4, 8]]
    rim = np.array([4, 5, 6, 7])
    (angle,) = creases.largest(vertices, faces, [(top, roof, rim)])
    assert angle == pytest.approx(20, abs=1e-9)
    (angle,) = creases.largest(vertices, np.array(faces), [(top * [1, 1, 0], roof, rim)])
    assert angle == pytest.approx(0, abs=1e-9)
    assert creases.largest(vertices, faces, [(top, [], rim)]) == [None]


def test_the_sheet_shows_the_worst_first(tmp_path, capsys):
    image = pytest.importorskip("PIL.Image")
    source = spheres(tmp_path / "in", 3)
    write_obj(source / "coarse.obj", sphere_hole(2, rings=1))
    code, out, _ = run(capsys, source, "--out", tmp_path / "out", "--workers", 0, "--worst", 2)
    assert code == 0
    assert "The worst seams: " in out
    picture = np.asarray(image.open(tmp_path / "out" / journal.SHEET))
    assert picture.shape[1] == 600
    blue = (picture[..., 2].astype(int) - picture[..., 0] > 40).reshape(len(picture), 2, 300)
    assert (blue.sum(axis=(0, 2)) > 2000).all()  # a fill on each
    entries = [{"lines": [line]} for line in lines(tmp_path / "out") if line["line"] == "file"]
    for entry in entries:
        entry["lines"] += [h for h in lines(tmp_path / "out") if h["line"] == "hole" and h["input"] == entry["lines"][0]["input"]]
    angles = [line["crease_max"] for line, _ in pictures.worst(entries, 4)]
    assert angles == sorted(angles, reverse=True)


def test_what_fails_in_the_process_is_told_as_what_it_is(tmp_path):
    settings = Settings(str(tmp_path), str(tmp_path), {}, tripatch.__version__, "crop")
    with keeper.Keeper(settings) as one:
        with pytest.raises(keeper.Ended, match="TriPatch failed on this file: ValueError") as caught:
            one.call("math", "sqrt", -1)
        assert caught.value.status == record.CRASHED
        assert one.call("math", "sqrt", 4) == 2  # it continues


def test_memory_of_one_file_is_no_more_than_it_needs(tmp_path):
    """What a journal keeps of a file does not grow with the mesh."""
    source = tmp_path / "in"
    source.mkdir()
    write_obj(source / "large.obj", sphere_hole(24, rings=40))
    entry = job.work(str(source / "large.obj"), Settings(str(source), str(tmp_path / "out"), {}, tripatch.__version__))
    assert len(record.text(entry)) < 4000
