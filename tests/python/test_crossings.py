"""Fills that go through themselves: none that need not, and those that must say so."""

import json
from pathlib import Path

import numpy as np
import pytest
import tripatch
from codes import refused, says
from test_cli import run, write_obj
from test_invariance import uneven_hole

#: Holes cut at random in real meshes, with the faces at their rims, in thousandths of the hole: rims that come close to
#: themselves, where triangles of the least worst angle cross.
REAL = json.loads((Path(__file__).parents[1] / "data" / "crossing_rims.json").read_text())
TOUCHING = 1e-6  # of an edge: what passes by less is not looked at


def crosses(points, faces):
    """Whether an edge of some faces, cut into fans, goes through another of them that it has no vertex in common with."""
    triangles = np.array([[f[0], a, b] for f in faces for a, b in zip(f[1:], f[2:], strict=False)])
    for a, b, c in triangles:
        normal = np.cross(points[b] - points[a], points[c] - points[a])
        normal /= max(np.linalg.norm(normal), 1e-300)
        for k in range(3):
            for p, q in triangles[:, [k, (k + 1) % 3]]:
                over, under = (points[p] - points[a]) @ normal, (points[q] - points[a]) @ normal
                near = TOUCHING * np.linalg.norm(points[q] - points[p])
                if {p, q} & {a, b, c} or over * under >= 0 or min(abs(over), abs(under)) < near:
                    continue
                at = points[p] + over / (over - under) * (points[q] - points[p])
                ways = [(points[j] - points[i], at - points[i]) for i, j in ((a, b), (b, c), (c, a))]
                if all(np.cross(way, to) @ normal > near * np.linalg.norm(way) for way, to in ways):
                    return True
    return False


def ribbon(loop, adjacent):
    """A strip of quads along a closed loop: vertices, faces, the loop as the rim that new faces take."""
    n = len(loop)
    return (
        np.concatenate([loop, adjacent]),
        [[(k + 1) % n, k, n + k, n + (k + 1) % n] for k in range(n)],
        list(range(n)),
    )


def jagged(seed, n=None):
    """A rim of 6 to 20 vertices, or so many, around a middle, and a strip outside."""
    rng = np.random.default_rng(seed)
    n = n or int(rng.integers(6, 21))
    turn, radius, height = np.sort(rng.uniform(0, 2 * np.pi, n)), rng.uniform(0.3, 1, n), rng.normal(0, 0.6, n)
    out = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
    loop = radius[:, None] * out + height[:, None] * [0, 0, 1]
    return ribbon(loop, loop + 0.5 * out)


def trefoil(n):
    """A knot, which no disc fills without going through itself; of 3 k vertices a fan would only touch itself."""
    t = 2 * np.pi * np.arange(n) / n
    loop = np.column_stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)])
    return ribbon(loop, loop * [1.1, 1.1, 1])


@pytest.mark.parametrize("output", ["triangles", "quads"])
@pytest.mark.parametrize("seed", range(24))
def test_a_jagged_rim_is_filled_without_crossings(seed, output):
    vertices, faces, rim = jagged(seed)
    fill = tripatch.fill(vertices, faces, rim=rim, output=output)
    assert crosses(np.concatenate([vertices, fill.vertices]), fill.faces) == fill.report.crosses_itself
    assert not fill.report.crosses_itself and not says(fill.report, "crosses_itself")


@pytest.mark.parametrize("n", [50, 80, 110])
@pytest.mark.parametrize("seed", range(4))
def test_a_very_jagged_rim_is_filled_without_crossings(seed, n):
    """Of nearly all of these rims the triangles of the least worst angle cross."""
    vertices, faces, rim = jagged(seed, n)
    fill = tripatch.fill(vertices, faces, rim=rim)
    assert not fill.report.crosses_itself
    assert not crosses(np.concatenate([vertices, fill.vertices]), fill.faces)


@pytest.mark.parametrize("name", REAL)
def test_a_rim_close_to_itself_is_filled_without_crossings(name):
    mesh = REAL[name]
    vertices = np.array(mesh["vertices"], float)
    fill = tripatch.fill(vertices, mesh["faces"], rim=range(mesh["rim"]))
    assert not fill.report.crosses_itself
    assert not crosses(np.concatenate([vertices, fill.vertices]), fill.faces)


@pytest.mark.parametrize("n", [16, 31])
def test_a_knot_is_filled_with_crossings_and_the_report_says_so(n):
    vertices, faces, rim = trefoil(n)
    fill = tripatch.fill(vertices, faces, rim=rim)
    assert fill.report.crosses_itself
    assert crosses(np.concatenate([vertices, fill.vertices]), fill.faces)
    said = [warning for warning in fill.report.warnings if warning.code == "crosses_itself"]
    assert len(said) == 1 and int(said[0].split("vertex ")[1].split()[0]) in rim


@pytest.mark.parametrize("corners", [[0, 4, 8, 12], [0, 5, 10], [0, 8]])
def test_a_cage_in_a_knot_says_that_its_limit_surface_crosses_itself(corners):
    vertices, faces, rim = trefoil(16)
    fill = tripatch.fill(vertices, faces, rim=rim, corners=corners, output="cage")
    assert fill.report.crosses_itself
    assert crosses(*fill.limit(1))
    said = [warning for warning in fill.report.warnings if warning.code == "crosses_itself"]
    assert len(said) == 1 and int(said[0].split("vertex ")[1].split()[0]) in rim


def test_a_cage_whose_corners_were_guessed_does_not_cross_itself():
    vertices, faces, rim = trefoil(16)
    with refused("cornerless_cage_crosses"):
        tripatch.fill(vertices, faces, rim=rim, output="cage")


@pytest.mark.parametrize("seed", range(8))
def test_what_a_cage_says_of_crossings_is_so(seed):
    vertices, faces, rim = jagged(seed)
    try:
        fill = tripatch.fill(vertices, faces, rim=rim, corners=[0, len(rim) // 3, 2 * len(rim) // 3], output="cage", resolution=0)
    except tripatch.Refusal:
        return
    said = says(fill.report, "crosses_itself")
    assert said == fill.report.crosses_itself
    if not said:
        assert not crosses(*fill.limit(1))


def test_a_fill_that_crosses_itself_is_no_success_on_the_command_line(tmp_path, capsys):
    vertices, faces, _ = trefoil(25)
    code, _, err = run(capsys, "fill", write_obj(tmp_path / "in.obj", (vertices, faces)), tmp_path / "out.obj")
    assert code == 3
    assert "crosses itself near vertex" in err
    code, _, err = run(
        capsys,
        "fill",
        write_obj(tmp_path / "in.obj", (vertices, faces)),
        tmp_path / "out.obj",
        "--output",
        "cage",
        "--corners",
        "0,8,16",
    )
    assert code == 3
    assert "crosses itself near vertex" in err


def test_a_rim_is_joined_to_its_middle_only_where_that_folds_no_more():
    """A cube without an eighth, of which faces at four corners are left: from its middle the rim is seen from behind."""
    vertices = [
        [1, 1, -1],
        [1, -1, -1],
        [-1, -1, -1],
        [-1, 1, -1],
        [0, 1, 0],
        [1, 1, 0],
        [-1, 1, 1],
        [0, 1, 1],
        [1, 0, 0],
        [1, 0, 1],
    ]
    vertices = np.array([*vertices, [1, -1, 1], [-1, -1, 1], [0, 0, 1], [0, 0, 0]], float)
    faces = [[0, 1, 2], [2, 3, 0], [4, 5, 0], [4, 0, 3], [3, 7, 4], [1, 0, 5], [1, 5, 8], [4, 7, 12], [12, 13, 4], [13, 8, 5]]
    faces += [[5, 4, 13], [12, 9, 8], [8, 13, 12]]
    fill = tripatch.fill(vertices, faces, rim=[1, 8, 9, 12, 7, 3, 2])
    assert fill.report.triangles_folded <= fill.report.rim_folded


@pytest.mark.parametrize("edges", [24, 25])
def test_a_tube_slit_along_a_seam_is_not_lined_with_its_own_back(edges):
    """Triangles on the back of the band would not cross; they would cover it, folded over at nearly every edge of the rim."""
    turn = np.linspace(0, 2 * np.pi, edges + 1)
    vertices = np.array([[np.cos(t), np.sin(t), height] for height in (0, 0.2) for t in turn])
    faces = [[k, k + 1, edges + 2 + k, edges + 1 + k] for k in range(edges)]
    fill = tripatch.fill(vertices, faces, rim=tripatch.find_holes(faces)[0])
    assert fill.report.triangles_folded == 0
    assert not crosses(np.concatenate([vertices, fill.vertices]), fill.faces)


@pytest.mark.parametrize("seed", [0, 2, 66, 236, 284, 382])
def test_a_cage_whose_own_faces_cross_says_so_where_its_limit_surface_does_not(seed):
    points, left, rim = uneven_hole(seed)
    fill = tripatch.fill(points, left, rim=rim, output="cage")
    points = np.concatenate([points, fill.vertices])
    cut = [
        f if np.linalg.norm(points[f[0]] - points[f[2]]) <= np.linalg.norm(points[f[1]] - points[f[3]]) else [*f[1:], f[0]]
        for f in fill.faces
    ]
    told = [warning for warning in fill.report.warnings if warning.code == "cage_faces_cross"]
    assert not fill.report.crosses_itself
    assert crosses(points, cut) == bool(told) == (seed > 2)
