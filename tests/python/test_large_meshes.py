"""`tripatch batch` of one mesh in parts: the same bytes as of the mesh as a whole."""

from __future__ import annotations

import os
import struct

import numpy as np
import pytest
import tripatch
from hypothesis import given, settings
from hypothesis import strategies as st
from systems import WINE
from tripatch import __main__ as cli
from tripatch import files
from tripatch.batch import cutting, job, journal, keeper, large, parts, record
from tripatch.batch.settings import Settings
from tripatch.files.ply_parts import PlyParts


def ply(vertices, faces, *, order="<", extra=(), colors=None, other=b""):
    """A binary PLY file. extra: of each face a whole number; other: bytes of an element behind the faces."""
    name = "little" if order == "<" else "big"
    head = [f"ply\nformat binary_{name}_endian 1.0\ncomment kept\nelement vertex {len(vertices)}"]
    head += [f"property float {c}" for c in "xyz"] + (["property uchar red"] if colors is not None else [])
    head += [
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        *(["property short group"] if len(extra) else []),
    ]
    head += [f"element note {len(other)}\nproperty uchar byte"] if other else []
    body = []
    for k, p in enumerate(vertices):
        body.append(struct.pack(order + "3f", *p) + (struct.pack("B", colors[k]) if colors is not None else b""))
    for k, f in enumerate(faces):
        body.append(struct.pack(f"{order}B{len(f)}i", len(f), *f) + (struct.pack(order + "h", extra[k]) if len(extra) else b""))
    return "\n".join([*head, "end_header\n"]).encode() + b"".join(body) + other


def terrain(n, gone, height=0.5, quads=False, seed=0):
    """A field of n x n cells without those whose numbers are in `gone`."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0))
    z = height * (np.sin(x / 2.1) + np.cos(y / 1.7)) + 0.01 * np.random.default_rng(seed).normal(size=x.shape)
    vertices = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    faces = []
    for cell in range(n * n):
        if cell in gone:
            continue
        a = cell // n * (n + 1) + cell % n
        square = [a, a + 1, a + n + 2, a + n + 1]
        faces += [square] if quads else [square[:3], [square[0], *square[2:]]]
    return vertices, faces


def blocks(n, corners, size):
    return {(r + i) * n + c + j for r, c in corners for i in range(size) for j in range(size)}


def in_parts(path, options, tries):
    """What becomes of a file, all parts of which this process fills."""

    def run(tasks):
        for place, task in enumerate(tasks):
            tries.append(task.holes)
            yield place, parts.fill(task, options)

    return large.work(path, options, {}, run, lambda done, count: None)


def assert_same(folder, data, tries=(), **options):
    """The file and the lines that are made of a file, as a whole and in parts."""
    (folder / "mesh.ply").write_bytes(data)
    made, tries = [], [] if isinstance(tries, tuple) else tries
    for name in ("whole", "parts"):
        own = Settings(str(folder), str(folder / name), options)
        entry = job.work(str(folder / "mesh.ply"), own) if name == "whole" else in_parts(folder / "mesh.ply", own, tries)
        result = folder / name / "mesh.ply"
        made.append((entry["lines"], result.read_bytes() if result.exists() else None))
    assert list(map(record.text, made[1][0])) == list(map(record.text, made[0][0]))
    assert made[1][1] == made[0][1]
    return made[0][1], made[0][0]


@pytest.fixture(autouse=True)
def small_parts(monkeypatch):
    """Parts of one hole, or of some that touch."""
    monkeypatch.setattr(cutting, "PART_FACES", 1)


def test_holes_of_a_field_are_filled_the_same_in_parts(tmp_path):
    vertices, faces = terrain(40, blocks(40, [(5, 5), (5, 30), (30, 5), (28, 28)], 3))
    tries = []
    _, lines = assert_same(tmp_path, ply(vertices, faces), tries)
    assert (lines[0]["filled"], lines[0]["left"]) == (4, 1)
    assert len(tries) == 4


@pytest.mark.parametrize("order", ["<", ">"])
def test_quads_properties_and_other_elements_stay(tmp_path, order):
    vertices, faces = terrain(24, blocks(24, [(4, 4), (15, 14)], 2), quads=True)
    colors = np.arange(len(vertices)) % 250
    data = ply(vertices, faces, order=order, extra=np.arange(len(faces)) // 100, colors=colors, other=b"abc")
    assert_same(tmp_path, data)


def test_faces_of_different_sizes(tmp_path):
    vertices, faces = terrain(24, blocks(24, [(4, 4), (15, 14)], 3), quads=True)
    mixed = [t for k, f in enumerate(faces) for t in ([f] if k % 3 else [f[:3], [f[0], f[2], f[3]]])]
    assert_same(tmp_path, ply(vertices, mixed))


def test_filled_file_is_filled_again(tmp_path):
    vertices, faces = terrain(24, blocks(24, [(4, 4), (15, 14)], 3))
    data, _ = assert_same(tmp_path, ply(vertices, faces), max_edges=12)
    assert files.read(tmp_path / "whole" / "mesh.ply").fill_faces.any()
    (tmp_path / "again").mkdir()
    assert_same(tmp_path / "again", data, outer=True)


def test_touching_holes_have_one_plane(tmp_path):
    vertices, faces = terrain(24, blocks(24, [(8, 8), (11, 11)], 3))
    assert_same(tmp_path, ply(vertices, faces))


def test_holes_that_nobody_wants_and_refused_ones_are_told_alike(tmp_path):
    vertices, faces = terrain(30, blocks(30, [(4, 4), (20, 14)], 3) | {10 * 30 + 20})
    faces = [*faces, faces[0], [0, 1, 400]]
    assert_same(tmp_path, ply(vertices, faces), max_edges=10)


def test_islands_and_parts(tmp_path):
    vertices, faces = terrain(30, blocks(30, [(8, 8)], 9))
    small, own = terrain(3, ())
    small = small + [11, 11, 1.0]  # above: a ring joins it
    faces = [*faces, *([v + len(vertices) for v in f] for f in own)]
    _, lines = assert_same(tmp_path, ply(np.concatenate([vertices, small]), faces))
    assert lines[1]["method"] == "annulus"


def test_borders_at_one_place_are_joined_in_thought(tmp_path):
    vertices, faces = terrain(20, blocks(20, [(8, 8)], 3))
    left = [f for f in faces if max(vertices[f][:, 0]) <= 10]
    right = [f for f in faces if max(vertices[f][:, 0]) > 10]
    doubled = np.concatenate([vertices, vertices])
    assert_same(tmp_path, ply(doubled, [*left, *([v + len(vertices) for v in f] for f in right)]))


def cap(rows=14, around=24):
    """A ball without its top."""
    t, p = np.meshgrid(np.linspace(np.pi, 0.5, rows + 1)[1:], np.arange(around) * 2 * np.pi / around, indexing="ij")
    ball = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1).reshape(-1, 3)
    vertices, faces = np.concatenate([ball, [[0, 0, -1]]]), []
    for k in range(around):
        after = (k + 1) % around
        faces.append([len(ball), after, k])
        for row in range(rows - 1):
            a, b = row * around + k, row * around + after
            faces += [[a, b, b + around], [a, b + around, a + around]]
    return vertices, faces


def test_faces_of_another_part_in_the_way_of_a_fill_come_into_its_part(tmp_path):
    vertices, faces = cap()
    n, tries = len(vertices), []
    sheet = np.array([[-0.1, 0, 0.9], [0.1, 0, 0.9], [0.1, 0, 1.2], [-0.1, 0, 1.2]])
    data = ply(np.concatenate([vertices, sheet]), [*faces, [n, n + 1, n + 2], [n, n + 2, n + 3]])
    assert_same(tmp_path, data, tries)
    assert tries == [[0], [0]]


def test_fills_that_pass_through_each_other_come_into_one_part(tmp_path):
    vertices, faces = cap()
    n, tries = len(vertices), []
    other = [[v + n for v in reversed(f)] for f in faces]
    _, lines = assert_same(
        tmp_path, ply(np.concatenate([vertices, vertices * [1, 1, -1] + [0, 0, 1.9]]), [*faces, *other]), tries
    )
    assert tries == [[0], [1], [0, 1]]
    assert all(line["passes_through"] for line in lines[1:])


def test_far_from_the_origin(tmp_path):
    vertices, faces = terrain(40, blocks(40, [(5, 5), (30, 30)], 3))
    assert_same(tmp_path, ply(vertices + [30000, 20000, 0], faces))


def test_dry_run_lists_the_same(tmp_path, capsys):
    vertices, faces = terrain(24, blocks(24, [(4, 4), (15, 14)], 3))
    path = tmp_path / "mesh.ply"
    path.write_bytes(ply(vertices, [*faces, faces[0]]))
    said = []
    for above in (0, 10**6):
        assert cli.main(["batch", str(path), "--out", str(tmp_path / "out"), "--dry-run", "--cut-above", str(above)]) == 0
        said.append(capsys.readouterr().out)
    assert said[0] == said[1]


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_random_fields(tmp_path_factory, data):
    n = data.draw(st.integers(6, 24))
    cells = st.integers(0, n * n - 1)
    gone = data.draw(st.sets(cells, max_size=20))
    size = data.draw(st.integers(1, 3))
    places = data.draw(st.lists(st.tuples(st.integers(1, n - 4), st.integers(1, n - 4)), max_size=3))
    vertices, faces = terrain(n, gone | blocks(n, places, size), data.draw(st.floats(0, 3)), data.draw(st.booleans()))
    order = data.draw(st.permutations(range(len(faces)))) if data.draw(st.booleans()) else range(len(faces))
    options = data.draw(st.sampled_from([{}, {"outer": True}, {"output": "quads", "odd": "triangle"}, {"continuity": "G0"}]))
    assert_same(tmp_path_factory.mktemp("field"), ply(vertices, [faces[f] for f in order]), **options)


def test_parts_that_a_run_has_left_are_not_filled_again(tmp_path, monkeypatch):
    vertices, faces = terrain(40, blocks(40, [(5, 5), (5, 30), (30, 5), (28, 28)], 3))
    (tmp_path / "mesh.ply").write_bytes(ply(vertices, faces))
    command = ["batch", str(tmp_path / "mesh.ply"), "--out", str(tmp_path / "out"), "--cut-above", "0", "--worst", "0", "--quiet"]
    keep, left = large._keep, 2

    def stop(*given):
        nonlocal left
        if not left:
            raise KeyboardInterrupt
        left -= 1
        keep(*given)

    monkeypatch.setattr(large, "_keep", stop)
    assert cli.main([*command, "--workers", "1"]) == 130
    assert len(list((tmp_path / "out" / journal.FOLDER).glob("parts-*/*"))) == 2
    kept = []
    monkeypatch.setattr(large, "_keep", lambda found, path: kept.append(found))
    assert cli.main([*command, "--workers", "1"]) == 0
    assert len(kept) == 2
    assert not list((tmp_path / "out" / journal.FOLDER).glob("parts-*"))
    whole = tmp_path / "whole"
    assert cli.main(["batch", str(tmp_path / "mesh.ply"), "--out", str(whole), "--worst", "0", "--quiet"]) == 0
    assert (whole / "mesh.ply").read_bytes() == (tmp_path / "out" / "mesh.ply").read_bytes()


def test_what_needs_the_whole_mesh_is_not_cut(tmp_path):
    vertices, faces = terrain(6, {14})
    path = tmp_path / "mesh.ply"
    path.write_bytes(ply(vertices, faces))
    assert large.is_cut(path, Settings("", ""), 0)
    assert not large.is_cut(path, Settings("", ""), 10**6)
    for options in ({"output": "cage"}, {"surroundings": "limit"}, {"output": "quads"}):
        assert not large.is_cut(path, Settings("", "", options), 0)
    files.converted(files.read(path), ".obj").write(tmp_path / "mesh.obj")
    assert not large.is_cut(tmp_path / "mesh.obj", Settings("", ""), 0)


@pytest.mark.parametrize("bad", [0, 7])
def test_damaged_files_are_told(tmp_path, bad):
    vertices, faces = terrain(6, {14})
    data = ply(vertices, faces)
    data = data[:-bad] if bad else ply(vertices, [*faces, [0, 1, 10**6]])
    assert_same(tmp_path, data)


def test_parts_know_where_faces_are_missing():
    vertices, faces = terrain(12, blocks(12, [(5, 5)], 2))
    whole = PlyParts(ply(vertices, faces))
    loops = tripatch.find_holes(faces)
    assert sorted(whole.rows.at_borders().tolist()) == sorted({v for loop in loops for v in loop.tolist()})
    file, numbers, known = whole.part(loops[0], 2)
    part = files.ply.PlyFile(file)
    back = {tuple(numbers[face].tolist()) for face in part.faces}
    assert back <= set(map(tuple, faces))
    at = {v: sum(v in f for f in faces) for v in numbers.tolist()}
    here = {v: sum(v in f for f in back) for v in numbers.tolist()}
    assert [at[v] == here[v] for v in numbers.tolist()] == known.tolist()


def test_a_worker_that_is_killed_costs_a_try(tmp_path, monkeypatch):
    vertices, faces = terrain(40, blocks(40, [(5, 5), (5, 30), (30, 5), (28, 28)], 3))
    (tmp_path / "mesh.ply").write_bytes(ply(vertices, faces))
    call, killed = keeper.Keeper.call, []

    def kill_first(self, *given):
        if not killed:
            killed.append(self._process or self._started())
            os.kill(killed[0].pid, 9)
        return call(self, *given)

    monkeypatch.setattr(keeper.Keeper, "call", kill_first)
    command = ["batch", str(tmp_path / "mesh.ply"), "--out", str(tmp_path / "out"), "--cut-above", "0", "--worst", "0", "--quiet"]
    assert cli.main([*command, "--workers", "1"]) == 0
    assert killed


@pytest.mark.skipif(WINE, reason="Dask's worker processes do not start under wine")
def test_workers_of_a_scheduler_fill_parts(tmp_path):
    distributed = pytest.importorskip("distributed")
    vertices, faces = terrain(30, blocks(30, [(5, 5), (20, 18)], 3))
    (tmp_path / "mesh.ply").write_bytes(ply(vertices, faces))
    command = ["batch", str(tmp_path / "mesh.ply"), "--worst", "0", "--quiet", "--out"]
    settings = {"processes": True, "memory_limit": 0, "dashboard_address": None, "silence_logs": 50}
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, **settings) as cluster:
        given = ["--scheduler", cluster.scheduler_address, "--cut-above", "0"]
        assert cli.main([*command, str(tmp_path / "parts"), *given]) == 0
    assert cli.main([*command, str(tmp_path / "whole"), "--workers", "1"]) == 0
    assert (tmp_path / "parts" / "mesh.ply").read_bytes() == (tmp_path / "whole" / "mesh.ply").read_bytes()
