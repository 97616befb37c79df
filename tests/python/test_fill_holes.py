"""`tripatch.fill_holes`, `merge`, `read` and `write`: a whole mesh in, a whole mesh of the same kind out."""

from collections import namedtuple
from dataclasses import dataclass

import numpy as np
import pytest
import tripatch
from shapes import octant

N = 8


def sheet(*, triangles=True):
    """A bent sheet of N x N squares, or twice as many triangles, with a square hole of four in its middle."""
    x, y = np.meshgrid(np.arange(N + 1.0), np.arange(N + 1.0))
    vertices = np.column_stack([x.ravel(), y.ravel(), 0.02 * (x * x).ravel()])
    quads = [
        [j * (N + 1) + i, j * (N + 1) + i + 1, (j + 1) * (N + 1) + i + 1, (j + 1) * (N + 1) + i]
        for j in range(N)
        for i in range(N)
        if not {i, j} <= {3, 4}
    ]
    if not triangles:
        return vertices, np.array(quads)
    return vertices, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def inner_loops(faces):
    """Border loops but for the outer one."""
    return [loop for loop in tripatch.find_holes(faces) if len(loop) < 4 * N]


def test_arrays_come_back_as_arrays_with_the_fill_in_place():
    vertices, faces = sheet()
    before = vertices.copy(), faces.copy()
    points, triangles = tripatch.fill_holes(vertices, faces)
    assert np.array_equal(vertices, before[0]) and np.array_equal(faces, before[1])
    assert isinstance(triangles, np.ndarray) and triangles.dtype == faces.dtype and triangles.shape[1] == 3
    assert np.array_equal(points[: len(vertices)], vertices) and np.array_equal(triangles[: len(faces)], faces)
    assert inner_loops(faces) and not inner_loops(triangles)
    (fill,) = tripatch.fill_all(vertices, faces)
    assert np.array_equal(points[len(vertices) :], fill.vertices) and np.array_equal(triangles[len(faces) :], fill.faces)


def test_lists_come_back_as_lists_and_single_precision_stays():
    vertices, faces = sheet(triangles=False)
    points, lists = tripatch.fill_holes(vertices.astype(np.float32), faces.tolist())
    assert points.dtype == np.float32
    assert isinstance(lists, list) and all(isinstance(v, int) for face in lists for v in face)
    assert {len(face) for face in lists} == {3, 4}
    _, quads = tripatch.fill_holes(vertices, faces, output="quads")
    assert isinstance(quads, np.ndarray) and quads.shape[1] == 4


def test_faces_of_a_fill_are_an_array_if_uniform():
    vertices, faces, rim = octant(5)
    fill = tripatch.fill(vertices, faces, rim=rim)
    assert isinstance(fill.faces, np.ndarray) and fill.faces.shape[1] == 3
    quads = {"rim": rim, "method": "side_vertex", "output": "quads", "resolution": 0}
    assert tripatch.fill(vertices, faces, **quads).faces.shape[1] == 4
    mixed = tripatch.fill(vertices, faces, odd="triangle", **quads)
    assert isinstance(mixed.faces, list) and {len(face) for face in mixed.faces} == {3, 4}


def test_merge_numbers_several_fills_one_after_another_and_skips_refusals():
    vertices, faces = sheet()
    second = vertices + [20, 0, 0]
    both = np.concatenate([vertices, second]), np.concatenate([faces, faces + len(vertices)])
    results = tripatch.fill_all(*both)
    points, triangles = tripatch.merge(*both, results)
    assert len(points) == len(both[0]) + sum(len(fill.vertices) for fill in results)
    assert not inner_loops(triangles)
    _, one = tripatch.merge(*both, [tripatch.Refusal("no"), results[0]])
    assert len(inner_loops(one)) == 1
    with pytest.raises(TypeError, match=r"Sequence\[Fill\]"):
        tripatch.merge(*both, [vertices])


def test_merge_splits_edges_and_leaves_replaced_faces_out():
    vertices, faces, rim = octant(5)
    fill = tripatch.fill(vertices, faces, rim=rim, method="side_vertex", output="quads", resolution=0)
    assert len(fill.split_edges[0]) == 1
    points, whole = tripatch.merge(vertices, faces, [fill])
    assert not any(set(loop) & set(rim) for loop in tripatch.find_holes(whole))
    assert len(points) == len(vertices) + len(fill.vertices)

    vertices, faces = sheet()
    (first,) = tripatch.fill_all(vertices, faces)
    points, closed = tripatch.merge(vertices, faces, [first])
    gone = list(range(len(faces), len(closed)))
    again = tripatch.fill(points, closed, rim=first.rim, replaced=gone)
    assert again.replaced.tolist() == gone
    _, replaced = tripatch.merge(points, closed, [again])
    assert len(replaced) == len(faces) + len(again.faces) and not inner_loops(replaced)


def test_a_report_comes_with_the_mesh_if_it_is_asked_for():
    vertices, faces = sheet()
    (points, _), report = tripatch.fill_holes(vertices, faces, return_report=True)
    assert len(report.fills) == 1 and report.refusals == [] and report.warnings == report.fills[0].report.warnings
    assert report.as_dict()["holes"][0]["new_vertices"] == len(points) - len(vertices)
    assert "1 filled" in repr(report) and "\n" not in repr(report)


def test_a_wrong_option_names_the_function_that_was_called():
    with pytest.raises(TypeError, match=r"^fill_holes\(\) has no option quads"):
        tripatch.fill_holes(*sheet(), quads=True)


def test_a_mesh_without_holes_comes_back_as_it_is():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    points, same = tripatch.fill_holes(vertices, faces)
    assert np.array_equal(points, vertices) and np.array_equal(same, faces)


def test_holes_that_are_all_refused_raise_and_some_refused_warn():
    vertices, faces = sheet()
    with pytest.raises(tripatch.Refusal):
        tripatch.fill_holes(vertices, faces, method="side_vertex")  # the square has four corners
    (same, _), report = tripatch.fill_holes(vertices, faces, method="side_vertex", return_report=True)
    assert len(same) == len(vertices) and len(report.refusals) == 1 and report.fills == []
    other, more, rim = octant()
    both = np.concatenate([vertices, other + [20, 0, 0]]), [*faces.tolist(), *(np.array(f) + len(vertices) for f in more)]
    with pytest.warns(tripatch.FillWarning, match="not filled"):
        points, _ = tripatch.fill_holes(*both, method="side_vertex")
    assert len(points) > len(both[0])


Pair = namedtuple("Pair", "vertices faces label")


@dataclass
class Data:
    vertices: np.ndarray
    faces: np.ndarray
    label: str = ""


class Plain:
    def __init__(self, vertices, faces):
        self.vertices, self.faces = vertices, faces


class Other:
    def __init__(self, path):
        self.vertices, self.faces = sheet()


@pytest.mark.parametrize("kind", [Pair, Data])
def test_an_object_comes_back_as_one_of_its_class_with_its_other_fields(kind):
    vertices, faces = sheet()
    made = tripatch.fill_holes(kind(vertices, faces, "mine"))
    assert type(made) is kind and made.label == "mine" and not inner_loops(made.faces)


def test_an_object_is_made_from_vertices_and_faces_or_refused_by_name():
    made = tripatch.fill_holes(Plain(*sheet()))
    assert type(made) is Plain and not inner_loops(made.faces)
    with pytest.raises(TypeError, match="Other cannot be made from vertices and faces"):
        tripatch.fill_holes(Other("a"))
    with pytest.raises(TypeError, match="vertices and faces"):
        tripatch.fill_holes(sheet()[0])


def linear(points):
    """Values that are linear in x and y, as colors and texture coordinates of the sheet."""
    return points[:, :2] @ [[0.1, 0.0], [0.02, 0.1]] + [0.05, 0.1]


@pytest.fixture
def trimesh():
    return pytest.importorskip("trimesh")


def test_texture_coordinates_of_a_trimesh_are_continued_exactly_where_they_are_linear(trimesh):
    vertices, faces = sheet()
    vertices[:, 2] = 0
    uv = linear(vertices)
    visual = trimesh.visual.TextureVisuals(uv=uv, material=trimesh.visual.material.SimpleMaterial(diffuse=[10, 20, 30, 255]))
    given = trimesh.Trimesh(vertices, faces, process=False, visual=visual, metadata={"name": "sheet"})
    made = tripatch.fill_holes(given)
    assert type(made) is trimesh.Trimesh and made.metadata["name"] == "sheet"
    assert len(given.vertices) == len(vertices) and len(given.visual.uv) == len(vertices)
    assert len(made.vertices) > len(vertices) and np.array_equal(made.visual.uv[: len(uv)], uv)
    assert np.abs(made.visual.uv - linear(made.vertices)).max() < 1e-5
    assert made.visual.material.diffuse.tolist() == [10, 20, 30, 255]


def test_vertex_colors_normals_and_attributes_of_a_trimesh_are_blended(trimesh):
    vertices, faces = sheet()
    red = np.rint(25 * vertices[:, 0]).astype(np.uint8)
    colors = np.column_stack([red, 0 * red + 7, 0 * red, 0 * red + 255])
    given = trimesh.Trimesh(vertices, faces, process=False, vertex_colors=colors, vertex_attributes={"heat": vertices[:, 1]})
    normals = np.array(given.vertex_normals)
    made = tripatch.fill_holes(given)
    new = slice(len(vertices), None)
    assert np.array_equal(made.visual.vertex_colors[: len(vertices)], colors)
    assert np.abs(made.visual.vertex_colors[new, 0] - 25 * made.vertices[new, 0]).max() < 8
    assert (made.visual.vertex_colors[new, 1:] == [7, 0, 255]).all()
    assert np.abs(made.vertex_attributes["heat"] - made.vertices[:, 1]).max() < 0.3
    assert np.array_equal(made.vertex_normals[: len(vertices)], normals)
    assert np.allclose(np.linalg.norm(made.vertex_normals[new], axis=1), 1)


def test_face_colors_and_attributes_of_a_trimesh_are_those_of_the_side_that_is_nearest(trimesh):
    vertices, faces = sheet()
    right = vertices[faces].mean(axis=1)[:, 0] > N / 2
    colors = np.where(right[:, None], [255, 0, 0, 255], [0, 0, 255, 255]).astype(np.uint8)
    given = trimesh.Trimesh(vertices, faces, process=False, face_colors=colors, face_attributes={"part": right.astype(int)})
    made = tripatch.fill_holes(given, resolution=6)
    assert np.array_equal(made.visual.face_colors[: len(faces)], colors)
    middle = made.vertices[made.faces].mean(axis=1)[:, 0]
    clear = np.abs(middle - N / 2) > 0.7
    assert (made.face_attributes["part"][clear] == (middle[clear] > N / 2)).all()
    assert (made.visual.face_colors[clear][:, 0] == np.where(middle[clear] > N / 2, 255, 0)).all()


def test_a_trimesh_gets_triangles_whatever_the_fill_is_made_of(trimesh):
    vertices, faces = sheet()
    made = tripatch.fill_holes(trimesh.Trimesh(vertices, faces, process=False), output="quads", odd="triangle")
    assert made.faces.shape[1] == 3 and not inner_loops(np.asarray(made.faces))


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".off", ".stl"])
def test_a_file_that_is_read_and_written_is_the_same_bytes(suffix, tmp_path):
    path, copy = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    tripatch.write(path, sheet())
    mesh = tripatch.read(path)
    tripatch.write(copy, mesh)
    assert copy.read_bytes() == path.read_bytes()
    with pytest.raises(ValueError, match="read-only"):
        mesh.vertices[0] = 1


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".off", ".stl"])
def test_a_file_that_is_filled_keeps_what_it_had(suffix, tmp_path):
    path, out = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    tripatch.write(path, sheet())
    mesh = tripatch.read(path)
    filled, report = tripatch.fill_holes(mesh, return_report=True)
    assert len(mesh.faces) < len(filled.faces) == len(mesh.faces) + len(report.fills[0].faces)
    assert not inner_loops(filled.faces)
    tripatch.write(out, filled)
    assert tripatch.read(out).faces == filled.faces
    if suffix == ".obj":
        assert out.read_bytes().startswith(path.read_bytes())


def test_write_takes_pairs_and_meshes_and_says_what_it_needs(tmp_path, trimesh):
    vertices, faces = sheet()
    for mesh in ((vertices, faces), (vertices, faces.tolist()), trimesh.Trimesh(vertices, faces, process=False)):
        tripatch.write(tmp_path / "a.ply", mesh)
        assert np.array_equal(tripatch.read(str(tmp_path / "a.ply")).vertices, vertices)
    vertices[0] = 1  # what was written is not held on to
    with pytest.raises(TypeError, match="needs vertices and faces"):
        tripatch.write(tmp_path / "a.ply", vertices)
    with pytest.raises(tripatch.FileError, match="cannot be read"):
        tripatch.read(tmp_path / "none.obj")
    with pytest.raises(tripatch.FileError, match=r"^\.none files cannot be written"):
        tripatch.write(tmp_path / "a.none", (vertices, faces))


def test_a_mesh_or_a_pair_may_be_given_in_place_of_vertices_and_faces(trimesh):
    vertices, faces = sheet()
    expected = tripatch.fill(vertices, faces)
    holes = tripatch.choose_holes(vertices, faces)
    for mesh in ((vertices, faces), trimesh.Trimesh(vertices, faces, process=False)):
        assert np.array_equal(tripatch.fill(mesh).vertices, expected.vertices)
        assert np.array_equal(tripatch.fill_all(mesh)[0].vertices, expected.vertices)
        assert all(map(np.array_equal, tripatch.choose_holes(mesh), holes))
        assert len(tripatch.outer_borders(mesh)) == 1
    points, triangles = tripatch.fill_holes((vertices, faces))
    assert np.array_equal(triangles, tripatch.fill_holes(vertices, faces)[1])
    assert isinstance(tripatch.fill_holes((points, triangles)), tuple), "what comes back is taken again"


def test_a_mesh_and_faces_are_too_much(trimesh):
    mesh = trimesh.Trimesh(*sheet(), process=False)
    for function in (tripatch.fill, tripatch.fill_all, tripatch.fill_holes):
        with pytest.raises(TypeError, match="needs vertices and faces, or one mesh that has both.*, not Trimesh and faces"):
            function(mesh, mesh.faces)
        with pytest.raises(TypeError, match=r"or one mesh that has both.*, not ndarray"):
            function(mesh.vertices.view(np.ndarray))


def test_one_fill_may_be_merged_but_none_twice():
    vertices, faces = sheet()
    fill = tripatch.fill(vertices, faces)
    merged = tripatch.merge(vertices, faces, fill)
    assert all(map(np.array_equal, merged, tripatch.merge(vertices, faces, [fill])))
    assert all(map(np.array_equal, merged, tripatch.merge(vertices, faces, (each for each in [fill]))))
    with pytest.raises(ValueError, match=f"Two of the fills close the same hole, at vertex {min(fill.rim)}"):
        tripatch.merge(vertices, faces, [fill, fill])
    with pytest.raises(TypeError, match=r"fills must be of type Fill \| Sequence\[Fill\]"):
        tripatch.merge(vertices, faces, 3)


def cut_by_a_seam():
    """The flat sheet of triangles whose texture coordinates part along x = N / 2, through the hole: vertices there are double."""
    vertices, faces = sheet()
    vertices[:, 2] = 0
    right = vertices[faces].mean(axis=1)[:, 0] > N / 2
    on_seam = np.flatnonzero(vertices[:, 0] == N / 2)
    copies = {int(v): len(vertices) + k for k, v in enumerate(on_seam)}
    faces = np.array([[copies.get(int(v), v) if r else v for v in face] for face, r in zip(faces, right)])
    points = np.concatenate([vertices, vertices[on_seam]])
    of_right = np.zeros(len(points), bool)
    of_right[faces[right].ravel()] = True
    return points, faces, np.where(of_right[:, None], linear(points) + 10, linear(points)), right


def test_texture_coordinates_that_part_at_a_seam_part_in_the_fill_too(trimesh):
    points, faces, uv, right = cut_by_a_seam()
    visual = trimesh.visual.TextureVisuals(uv=uv)
    given = trimesh.Trimesh(points, faces, process=False, visual=visual)
    made, report = tripatch.fill_holes(given, resolution=6, return_report=True)
    assert len(report.fills) == 1 and report.refusals == []
    assert np.array_equal(made.vertices[: len(points)], points) and np.array_equal(made.faces[: len(faces)], faces)
    assert np.array_equal(made.visual.uv[: len(uv)], uv) and len(made.visual.uv) == len(made.vertices)
    of_new = made.visual.uv[made.faces[len(faces) :]]
    expected = linear(np.asarray(made.vertices))[made.faces[len(faces) :]]
    offset = np.rint((of_new - expected).mean(axis=(1, 2)) / 10) * 10
    assert set(offset.tolist()) == {0.0, 10.0}, "each new face lies on one side of the seam"
    assert np.abs(of_new - expected - offset[:, None, None]).max() < 1e-4
    middle = made.vertices[made.faces[len(faces) :]].mean(axis=1)[:, 0]
    clear = np.abs(middle - N / 2) > 1
    assert ((offset[clear] == 10) == (middle[clear] > N / 2)).all()
    merged = made.copy()
    merged.merge_vertices(merge_tex=True, merge_norm=True)
    assert not inner_loops(np.asarray(merged.faces))


def test_a_trimesh_whose_faces_share_no_vertices_is_filled_as_one_that_was_merged(trimesh):
    vertices, faces = sheet()
    loose = trimesh.Trimesh(vertices[faces.ravel()], np.arange(faces.size).reshape(-1, 3), process=False)
    made, report = tripatch.fill_holes(loose, return_report=True)
    assert len(report.fills) == 1 and len(made.faces) == len(faces) + len(report.fills[0].faces)
    made.merge_vertices()
    assert not inner_loops(np.asarray(made.faces))


def test_the_arrays_of_an_open3d_mesh_are_filled():
    o3d = pytest.importorskip("open3d")
    points, triangles = o3d.utility.Vector3dVector, o3d.utility.Vector3iVector
    vertices, faces = sheet()
    mesh = o3d.geometry.TriangleMesh(points(vertices), triangles(faces))
    made, all_faces = tripatch.fill_holes(np.asarray(mesh.vertices), np.asarray(mesh.triangles))
    assert all_faces.dtype == np.asarray(mesh.triangles).dtype
    filled = o3d.geometry.TriangleMesh(points(made), triangles(all_faces))
    assert len(filled.get_non_manifold_edges(allow_boundary_edges=False)) == 4 * N  # the outer border
    with pytest.raises(TypeError, match="needs vertices and faces"):
        tripatch.fill_holes(mesh)


def test_filters_that_leave_every_hole_are_told():
    vertices, faces, _ = octant()
    with pytest.warns(tripatch.FillWarning, match="all holes were excluded by your filters"):
        _, same = tripatch.fill_holes(vertices, faces, max_edges=3)
    assert len(same) == len(faces)
