"""Double shells with pinholes, as voxels and machine learning make them, are closed without a bridge between the shells."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import tripatch
from tripatch.batch import creases

SCRIPT = Path(__file__).parents[2] / "scripts" / "voxel_meshes.py"


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("voxel_meshes", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def path(script, tmp_path_factory):
    path = tmp_path_factory.mktemp("voxels") / "in.ply"
    tripatch.write(path, script.mesh(6000, 60, 1))
    return path


def test_all_pinholes_are_closed_and_the_shells_stay_apart(script, path):
    said = script.measured(path)
    least, most = said["their edges"]
    assert said["pinholes"] >= 50 and least >= 3 and most <= 12
    assert said["filled"] == said["pinholes"] and said["borders left"] == 0 and said["through the mesh"] == 0
    assert said["parts before and after"] == [2, 2]


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".stl", ".off", ".glb"])
def test_many_fills_are_added_as_one_after_another(path, tmp_path, suffix):
    mesh = tripatch.read(path)
    tripatch.write(tmp_path / f"in{suffix}", (mesh.vertices, mesh.faces))
    one, all_ = (tripatch.read(tmp_path / f"in{suffix}").marked() for _ in range(2))
    fills = tripatch.fill_all(one.vertices, one.faces)
    for fill in fills:
        one.append(fill)
    all_.append_all(fills)
    for mesh, name in ((one, "one"), (all_, "all")):
        mesh.write(tmp_path / f"{name}{suffix}")
    assert (tmp_path / f"one{suffix}").read_bytes() == (tmp_path / f"all{suffix}").read_bytes()


def test_creases_of_many_fills_are_those_of_each(path):
    mesh = tripatch.read(path)
    fills = tripatch.fill_all(mesh.vertices, mesh.faces)
    given = [(fill.vertices, fill.faces, np.asarray(fill.rim)) for fill in fills]
    found = creases.largest(mesh.vertices, mesh.faces, given)
    assert found == pytest.approx([creases.largest(mesh.vertices, mesh.faces, [each])[0] for each in given])
    assert creases.largest(mesh.vertices, mesh.faces, []) == []
