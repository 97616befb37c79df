"""Bad input, from Python and on the command line: a sentence with the place and nothing changed, or a right result."""

import re

import numpy as np
import pytest
import tripatch
from codes import refused
from scipy.spatial import Delaunay
from shapes import cube_sphere, octant
from tripatch import __main__ as cli
from tripatch import arguments, words

OCTAHEDRON = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], float)
EIGHT = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
THREE = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0.9, 0], [0.5, -0.9, 0.3], [1.4, 0.9, 0.3], [-0.4, 0.9, 0.3]])


def polygon(count, edges=4):
    """(count * edges, 2) points round a polygon; two corners: a lens."""
    if count == 2:
        turn = np.linspace(np.pi / 4, 3 * np.pi / 4, 9)[:-1]
        arc = np.column_stack([np.cos(turn), np.sin(turn) - np.sqrt(0.5)])
        return np.vstack([arc, -arc])
    turn = np.arange(count) * 2 * np.pi / count
    corners = np.column_stack([np.cos(turn), np.sin(turn)])
    steps = np.arange(edges)[:, None] / edges
    return np.vstack([a + (b - a) * steps for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)])


def jagged_line():
    """Out and in at every other of 24 points."""
    return polygon(24, 1) * np.where(np.arange(24) % 2, 1.0, 1.1)[:, None]


def around(inner, height=0.2):
    """Rings of quads on a bowl round a closed line, whose points come first."""
    n, following = len(inner), (np.arange(len(inner)) + 1) % len(inner)
    points = np.vstack([inner * s for s in (1, 1.3, 1.7, 2.2)])
    k = np.arange(n)
    quads = np.vstack([np.column_stack([k, k + n, following + n, following]) + r * n for r in range(3)])
    return np.column_stack([points, height * (points**2).sum(axis=1)]), quads.tolist()


def octant_with(change):
    """An open octant whose vertices, faces or rim `change` spoils; `next to` is the face next to the rim's first edge."""
    vertices, faces, rim = octant()
    adjacent = next(f for f, face in enumerate(faces) if {rim[0], rim[1]} <= set(face))
    change(vertices, faces, rim, adjacent)
    return vertices, faces, {"rim": rim}


def put(k, value):
    return octant_with(lambda v, faces, rim, adjacent: v.__setitem__(rim[k], value))


def with_fins():
    """Two more faces at a rim edge: the border goes round them."""
    vertices, faces, rim = octant()
    n, (a, b) = len(vertices), rim[:2]
    tips = vertices[[a, b]] * 1.5
    return np.vstack([vertices, tips]), [*faces, [a, b, n], [b, a, n + 1]], {"rim": rim}


def flip(v, faces, rim, adjacent):
    faces[adjacent] = faces[adjacent][::-1]


def double(v, faces, rim, adjacent):
    faces.append(faces[adjacent])


def merge(a, b, method="auto"):
    def change(v, faces, rim, adjacent):
        v[rim[a]] = v[rim[b]]

    vertices, faces, options = octant_with(change)
    return vertices, faces, options | {"method": method}


def soup():
    vertices, faces, _ = octant(4)
    return vertices[np.array(faces)].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3).tolist(), {}


REFUSED = {
    "no hole": ((OCTAHEDRON, EIGHT, {}), "no_border", False),
    "nothing": ((np.zeros((0, 3)), [], {}), "mesh_without_faces", False),
    "two corners": ((*around(polygon(2)), {"rim": range(16), "method": "side_vertex"}), "not_three_corners", True),
    "four corners": ((*around(polygon(4)), {"method": "side_vertex"}), "not_three_corners", True),
    "five corners": ((*around(polygon(5)), {"method": "side_vertex"}), "not_three_corners", True),
    "no smooth sides": ((*around(jagged_line()), {"method": "multi_sided"}), "patch_needs_sides", True),
    "limit of four corners": ((*around(polygon(4)), {"surroundings": "limit"}), "limit_needs_three_corners", True),
    "limit of no corners": ((*around(polygon(24, 1)), {"surroundings": "limit"}), "limit_needs_three_corners", True),
    "round": ((*around(polygon(24, 1)), {"method": "side_vertex"}), "no_clear_corners", True),
    "a corner elsewhere": ((*around(polygon(24, 1)), {"corners": [0, 8, 30]}), "corner_not_on_rim", True),
    "two holes that touch": (
        (OCTAHEDRON, EIGHT[1:2] + EIGHT[3:], {}),
        "several_holes",
        True,
    ),
    "a vertex twice": (octant_with(lambda v, f, rim, b: rim.insert(3, rim[2])), "rim_passes_twice", True),
    "non-manifold": (with_fins(), "non_manifold_edge", True),
    "non-manifold, rim not given": ((*with_fins()[:2], {}), "non_manifold_edge", True),
    "a face on both sides": (octant_with(double), "faces_on_both_sides", True),
    "flipped": (octant_with(flip), "faces_flipped", True),
    "no length": (merge(4, 5, "side_vertex"), "edge_without_length", True),
    "the same place": (merge(4, 9, "side_vertex"), "vertices_at_one_place", True),
    "nan": (put(3, np.nan), "vertex_not_finite", True),
    "infinity": (put(3, np.inf), "vertex_not_finite", True),
    "no area": (
        (THREE[[0, 1, 2, 0, 1, 2]], [[1, 0, 3], [2, 1, 4], [0, 2, 5]], {"rim": [0, 1, 2], "method": "side_vertex"}),
        "faces_at_vertex_without_area",
        True,
    ),
    "one triangle": ((THREE[:3], [[0, 1, 2]], {}), "loose_face", True),
    "vertices not merged": (soup(), "loose_face", True),
    "one triangle at a rim of three": ((THREE[:4], [[1, 0, 3]], {"rim": [0, 1, 2]}), "no_face_at_edge", True),
}


def far(value):
    vertices, faces, rim = octant()
    n = len(vertices)
    return np.vstack([vertices, [[9, 9, 9], [10, 9, 9], [9, 10, value]]]), [*faces, [n, n + 1, n + 2]], {"rim": rim}


def moved(matrix):
    vertices, faces, rim = octant()
    return vertices @ np.transpose(matrix), faces, {"rim": rim}


FILLED = {
    "three edges": ((OCTAHEDRON, EIGHT[1:], {}), {0, 1, 2}),
    "one of two holes that touch": ((OCTAHEDRON, EIGHT[1:2] + EIGHT[3:], {"rim": [2, 1, 0]}), {0, 1, 2}),
    "round with corners": ((*around(polygon(24, 1)), {"corners": [0, 8, 16]}), {0, 8, 16}),
    "nan far away": (far(np.nan), None),
    "a plane": ((*around(polygon(3), 0), {}), {0, 4, 8}),
    "three triangles": ((THREE, [[1, 0, 3], [2, 1, 4], [0, 2, 5]], {"corners": [0, 1, 2]}), {0, 1, 2}),
    "tiny": (moved(1e-6 * np.eye(3)), None),
    "huge": (moved(1e6 * np.eye(3)), None),
    "shear": (moved([[1, 0.8, 0], [0, 1, 0], [0, 0, 1]]), None),
    "stretched": (moved(np.diag([1, 0.7, 1.5])), None),
    "ten thousand edges": ((*around(polygon(3, 3333)), {"rim": range(9999), "resolution": 8, "fairing": None}), {0, 3333, 6666}),
}


def on_command_line(tmp_path, capsys, vertices, faces, options):
    """Exit status, stdout and stderr, and whether OUT was written; IN must stay."""
    source, out = tmp_path / "in.obj", tmp_path / "out.obj"
    lines = ["v {!r} {!r} {!r}".format(*map(float, p)) for p in vertices]
    lines += ["f " + " ".join(str(v + 1) for v in face) for face in faces]
    source.write_text("\n".join(lines) + "\n")
    before = source.read_bytes()
    given = [f"--{name}={','.join(map(str, v)) if np.ndim(v) else v}" for name, v in options.items()]
    code = cli.main(["fill", str(source), str(out), *given])
    said = capsys.readouterr()
    assert source.read_bytes() == before
    return code, said.out, said.err, out.exists()


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name, tmp_path, capsys):
    (vertices, faces, options), code_of_it, has_place = REFUSED[name]
    options = {key: value if isinstance(value, str) else list(value) for key, value in options.items()}
    before, lists = vertices.tobytes(), [list(face) for face in faces]
    with refused(code_of_it) as caught:
        tripatch.fill(vertices, faces, **options)
    assert bool(caught.value.where) == has_place
    assert vertices.tobytes() == before and [list(face) for face in faces] == lists

    code, out, err, written = on_command_line(tmp_path, capsys, vertices, faces, options)
    if not len(faces):
        assert (code, out, written) == (2, "", False) and "It has no faces" in err
        return
    if code_of_it == "no_border":  # nothing was asked for that could not be done
        assert (code, out, err, written) == (0, "Nothing to fill: the mesh has no border\n", "", True)
        return
    if name == "vertices not merged":  # the command line joins them in thought
        assert (code, written) == (0, True) and out.startswith("Filled 1 hole")
        return
    assert (code, out, written) == (1, "", False)
    assert caught.value.worded(names=arguments.NAMES) in err
    assert not has_place or all(re.search(rf"\b{v}\b", err) for v in caught.value.where[:8])


@pytest.mark.parametrize("name", FILLED)
def test_filled(name, tmp_path, capsys):
    (vertices, faces, options), corners = FILLED[name]
    before = vertices.tobytes()
    fill = tripatch.fill(vertices, faces, **options)
    assert vertices.tobytes() == before
    assert corners is None or set(fill.report.corners) == corners
    assert fill.report.folds == 0
    one_triangle = len(fill.rim) == 3  # it has no patch, and its seam is that of triangles
    assert one_triangle or fill.report.seam_angle_max < 1e-4
    assert np.isfinite(fill.vertices).all() and np.isfinite(fill.normals).all()
    loops = [set(loop) for loop in tripatch.find_holes([*faces, *fill.faces])]
    assert set(fill.rim.tolist()) not in loops
    directed = {(face[k - 1], face[k]) for face in faces for k in range(len(face))}
    new = [(face[k - 1], face[k]) for face in fill.faces for k in range(len(face))]
    assert len(set(new)) == len(new) and not directed & set(new)  # manifold and oriented as the mesh
    if name == "a plane":
        assert np.abs(fill.vertices[:, 2]).max(initial=0) < 1e-12
    if len(vertices) < 1000:
        code, out, _, written = on_command_line(tmp_path, capsys, vertices, faces, options)
        assert (code, written) == (0, True)
        assert out.startswith("Filled 1 hole" if one_triangle else "Filled 1 hole; seam within ")


def test_a_coarse_mesh_is_said_to_be_coarse_and_its_seam_is_not():
    fill = tripatch.fill(OCTAHEDRON, EIGHT[1:], method="side_vertex")
    assert fill.report.seam_angle_max < 1e-4
    seam, accuracy = words.degrees(fill.report.seam_angle_max), f"{fill.report.surroundings_error:.2g}°"
    assert words.filled([fill.report] * 2) == f"Filled 2 holes; seam within {seam} (accuracy of the mesh: {accuracy})"


def test_what_is_wrong_with_faces_is_said():
    with pytest.raises(tripatch.Refusal, match="The mesh has no faces, only 6 vertices") as found:
        tripatch.fill(OCTAHEDRON, [])
    assert found.value.code == "mesh_without_faces"
    with pytest.raises(tripatch.Refusal, match=r"The mesh has no faces\. A hole is a gap between faces"):
        tripatch.fill([], np.zeros((0, 3), int))
    with pytest.raises(ValueError, match=r"faces must have shape \(m, 3\) or \(m, 4\), not \(3, 2\)"):
        tripatch.fill(OCTAHEDRON, np.zeros((3, 2), int))


def flat_with_a_hole(n=14):
    x, y = np.meshgrid(np.arange(n), np.arange(n))
    vertices = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]).astype(float)
    a = np.array([i * n + j for i in range(n - 1) for j in range(n - 1)])
    faces = np.concatenate([np.column_stack([a, a + 1, a + n]), np.column_stack([a + 1, a + n + 1, a + n])])
    middle = vertices[faces].mean(axis=1)
    return vertices, faces[~((middle[:, 0] > 4) & (middle[:, 1] > 4) & (middle[:, 0] + middle[:, 1] < 14))]


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize(
    "options, name",
    [({"center_offset": 1e307}, "center_offset"), ({"center_offset": -1e100}, "center_offset"),
     ({"center": (0, 0, 1e307)}, "center"), ({"center": (1e200, 0, 0)}, "center"), ({"bulge": 1e100}, "bulge"),
     ({"bulge": 1e6}, "bulge")],
)  # fmt: skip
def test_what_no_fill_can_reach_is_refused(options, name, size):
    vertices, faces = flat_with_a_hole()
    rim = min(tripatch.find_holes(faces), key=len)
    with pytest.raises(ValueError, match=name):
        tripatch.fill(size * vertices, faces, rim=rim, method="side_vertex", **options)
    within = {"center_offset": 1e3 * size} if name == "center_offset" else {"bulge": 100} if name == "bulge" else {}
    fill = tripatch.fill(size * vertices, faces, rim=rim, method="side_vertex", **within)
    assert np.isfinite(fill.vertices).all()
    np.testing.assert_allclose(np.linalg.norm(fill.normals, axis=1), 1, atol=1e-12)


def test_a_hole_that_is_too_small_for_an_offset_is_refused_by_itself():
    vertices, faces = flat_with_a_hole()
    n, rim = len(vertices), min(tripatch.find_holes(faces), key=len)
    both, rims = np.concatenate([vertices, 1e-9 * vertices - 5]), [rim, [v + n for v in rim]]
    large, small = tripatch.fill_all(both, np.concatenate([faces, faces + n]), rims=rims, method="side_vertex", center_offset=0.1)
    assert large.report.seam_angle_max < 1e-6
    assert isinstance(small, tripatch.Refusal)
    assert small.code == "center_too_far"


@pytest.mark.parametrize(
    "creases",
    [{"edge_creases": ([[0, 9999]], [1.0])}, {"edge_creases": ([[-1, 5]], [1.0])}, {"vertex_creases": ([9999], [1.0])},
     {"loose_vertices": [196]}, {"loose_vertices": [-1]}],
)  # fmt: skip
def test_creases_are_at_vertices_that_exist(creases):
    vertices, faces = flat_with_a_hole()
    rim = min(tripatch.find_holes(faces), key=len)
    given = {name: (np.array(v[0]), np.array(v[1])) if isinstance(v, tuple) else np.array(v) for name, v in creases.items()}
    with pytest.raises(ValueError, match=next(iter(creases))):
        tripatch.fill(vertices, faces, rim=rim, surroundings="limit", subdivision=given, method="side_vertex")


@pytest.mark.parametrize("options", [{"surroundings": "limit"}, {"output": "cage"}], ids=str)
def test_creases_lie_on_edges_of_the_mesh(options):
    vertices, faces = flat_with_a_hole()
    rim = min(tripatch.find_holes(faces), key=len)
    there, diagonal = sorted(map(int, faces[0][:2])), [0, 15]
    assert not any(set(diagonal) <= set(face) for face in faces.tolist())
    for pairs, fits in (([there], True), ([there[::-1]], True), ([there, diagonal], False)):
        settings = {"edge_creases": (np.array(pairs), np.ones(len(pairs)))}
        for fill in (tripatch.fill, lambda *mesh, rim, **more: tripatch.fill_all(*mesh, [rim], **more)):
            if fits:
                fill(vertices, faces, rim=rim, subdivision=settings, **options)
                continue
            with pytest.raises(ValueError, match="edge_creases names vertices 0 and 15, between which the mesh has no edge"):
                fill(vertices, faces, rim=rim, subdivision=settings, **options)


@pytest.mark.parametrize("options", [{}, {"method": "gregory"}], ids=str)
def test_a_hole_far_from_the_origin_is_filled_as_one_near_it(options):
    """Coordinates as of a map: a hole of unit size, 30 edges a side, 1e6 away, where double precision knows 1e-10."""
    vertices, faces, rim = octant(30, 3)
    away = np.array([1e6, -1e6, 3e5])
    there = vertices + away
    here = there - away  # exactly, with the same last digits lost
    near, far = tripatch.fill(here, faces, rim=rim, **options), tripatch.fill(there, faces, rim=rim, **options)
    assert np.abs(far.vertices - away - near.vertices).max() < 1e-6
    assert [list(face) for face in far.faces] == [list(face) for face in near.faces]
    b = np.array([[0.2, 0.3, 0.5], [0, 0.4, 0.6]])
    assert np.abs(far.patch.evaluate(b) - away - near.patch.evaluate(b)).max() < 1e-6
    assert np.abs(far.sides[0].evaluate([0.3])[0] - away - near.sides[0].evaluate([0.3])[0]).max() < 1e-6
    (other,) = tripatch.fill_all(there, faces, [rim], **options)
    assert np.abs(other.vertices - far.vertices).max() < 1e-6


@pytest.mark.parametrize("seed", [0, 2, 6])
def test_a_cage_some_hundred_sizes_from_the_origin_is_the_one_at_it(seed):
    """A small hole in a part that is modelled where it is used. Its sides met only as well as a share of their distance said."""
    points = np.random.default_rng(seed).uniform(-1, 1, (60, 2))
    faces = Delaunay(points).simplices
    a = points[faces]
    faces = np.where((np.cross(a[:, 1] - a[:, 0], a[:, 2] - a[:, 0]) > 0)[:, None], faces, faces[:, ::-1])
    vertices = np.column_stack([points, 0.3 * np.cos(2 * points[:, 0]) * np.sin(2 * points[:, 1])])
    middle = np.argmin(np.linalg.norm(points[faces].mean(1), axis=1))
    rim, rest = faces[middle].tolist(), np.delete(faces, middle, 0)
    size = np.ptp(vertices[rim], axis=0).max()
    away = size * np.array([300.0, -200.0, 400.0])
    here, there = (tripatch.fill(v, rest, rim=rim, output="cage") for v in (vertices, vertices + away))
    assert len(here.vertices) and len(here.vertices) == len(there.vertices)
    assert np.abs(there.vertices - away - here.vertices).max() < 1e-6 * size


def test_the_patch_far_away_is_of_the_same_kind():
    """Between four sides, in a round rim and of any rim: its domain, and where it lies in it."""
    ring = np.array([(np.cos(a), np.sin(a)) for a in 2 * np.pi * np.arange(24) / 24])
    plane = np.concatenate([r * ring for r in (0.5, 0.6, 0.7, 0.85)])
    vertices = np.column_stack([plane, 1 - 0.3 * plane[:, 0] ** 2 - 0.2 * plane[:, 1] ** 2])
    at = [(24 * j + k, 24 * j + (k + 1) % 24) for j in range(3) for k in range(24)]
    faces = [face for a, b in at for face in ([b, a, a + 24], [b, a + 24, b + 24])]
    away = np.array([1e6, -2e6, 1e6])
    here = vertices + away - away
    for options in (
        {"corners": [0, 6, 12, 18], "method": "multi_sided"},
        {"corners": (), "method": "multi_sided"},
        {"method": "polyharmonic_spline"},
    ):
        near, far = (tripatch.fill(v, faces, rim=range(24), **options) for v in (here, here + away))
        assert type(near.patch) is type(far.patch)
        np.testing.assert_allclose(far.patch.domain, near.patch.domain, atol=1e-9)
        center = near.patch.domain.mean(axis=0)[None]
        assert np.abs(far.patch.evaluate(center) - away - near.patch.evaluate(center)).max() < 1e-6
        if options.get("corners") == ():
            assert far.patch.energy("thin_plate") == pytest.approx(near.patch.energy("thin_plate"), rel=1e-3)


@pytest.mark.parametrize("far", [1e308, -1.7e308])
def test_what_comes_to_no_finite_positions_is_refused(far):
    """A cage next to the limit surface, whose sums of coordinates overflow."""
    vertices, faces = cube_sphere(4)
    left = faces[1:]
    rim = max(tripatch.find_holes(left), key=len)
    near = set(rim)
    for _ in range(2):
        before, near = near, near | {v for face in left if near & set(face) for v in face}
    away = sorted(near - before)
    vertices[away[len(away) // 2], 0] = far
    options = {"output": "cage", "surroundings": "limit", "resolution": 24, "corners": [rim[0], rim[1], rim[2]]}
    with refused("coordinates_out_of_range"):
        tripatch.fill(vertices, left, rim=rim, **options)
    (result,) = tripatch.fill_all(vertices, left, [rim], corners=[options.pop("corners")], **options)
    assert result.code == "coordinates_out_of_range"
