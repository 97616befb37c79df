"""A write that fails as on a full disk, each of a command once: it says so, and no file is lost or half written."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from shapes import cube_sphere
from tripatch import files

FAULTS = Path(__file__).parent / "faults"

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux") or not hasattr(os, "confstr") or not shutil.which("cc"),
    reason="needs glibc and a C compiler",
)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    made = tmp_path_factory.mktemp("library") / "writes.so"
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", FAULTS / "writes.c", "-o", made, "-ldl"], check=True)
    return made


def write_mesh(path):
    points, faces = cube_sphere(4)
    mesh = files.MeshFile(points, [face for k, face in enumerate(faces) if k not in (5, 6, 9, 10)])
    files.converted(mesh, path.suffix).write(path)


def check(library, folder, *words):
    paths = [str(Path(__file__).parent), *filter(None, sys.path)]
    environment = {**os.environ, "LD_PRELOAD": str(library), "PYTHONPATH": os.pathsep.join(paths), "TRIPATCH_THREADS": "1"}
    command = [sys.executable, FAULTS / "fill_on_a_full_disk.py", folder, *words]
    said = json.loads(subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True).stdout)
    assert not said["faults"], said
    assert said["outcomes"].get("2", 0) > 0, said


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl", ".off", ".vtk", ".glb", ".3mf"])
def test_a_fill(library, tmp_path, suffix):
    if suffix == ".3mf":
        pytest.importorskip("lib3mf")
    folder = tmp_path / "in"
    folder.mkdir()
    write_mesh(folder / f"mesh{suffix}")
    check(library, folder, "fill", f"mesh{suffix}", f"mesh{suffix}", "--report", "report.json")


def test_a_batch(library, tmp_path):
    pytest.importorskip("distributed")
    folder = tmp_path / "in"
    (folder / "meshes").mkdir(parents=True)
    for k in range(2):
        write_mesh(folder / "meshes" / f"{k}.obj")
    check(library, folder, "batch", "meshes", "--out", "made", "--workers", "0", "--worst", "0")
