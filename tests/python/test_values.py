"""Fills, reports, patches and sides as values: one line in an interpreter, a picture in a notebook, pickled and copied."""

import copy
import pickle
import re

import numpy as np
import pytest
import tripatch
from shapes import octant
from test_fill_holes import sheet


def sides():
    return tripatch.sides_from_normals(np.eye(3), np.eye(3))


def patches():
    curve = [np.linspace(a, b, 4) for a, b in ((np.eye(3)[1], np.eye(3)[2]), (np.eye(3)[2], np.eye(3)[0]), tuple(np.eye(3)[:2]))]
    flat = tripatch.BezierTriangle(np.eye(3))
    s = sides()
    round_side = tripatch.Side.from_functions(
        lambda t: np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t), 0 * t]),
        lambda t: 2 * np.pi * np.column_stack([-np.sin(2 * np.pi * t), np.cos(2 * np.pi * t), 0 * t]),
        lambda t: np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t), 0 * t - 1]),
    )
    return {
        "patch": tripatch.patch(s),
        "of many sides": tripatch.patch([s[0].part(0, 0.5), s[0].part(0.5, 1), s[1], s[2]]),
        "round": tripatch.patch([round_side]),
        "blend": tripatch.blend(flat, flat, flat),
        "smits": tripatch.smits_patch(np.eye(3), np.eye(3)),
        "coons": tripatch.coons_bezier(curve),
        "bezier": flat,
    }


PATCHES = patches()


def inside(patch):
    return np.full((1, 2), 0.2)


@pytest.mark.parametrize("name", PATCHES)
@pytest.mark.parametrize("again", [copy.deepcopy, copy.copy, lambda each: pickle.loads(pickle.dumps(each))])
def test_patches_are_copied_and_pickled_bit_for_bit(name, again):
    patch = PATCHES[name]
    other = again(patch)
    assert type(other) is type(patch) and np.array_equal(other.evaluate(inside(patch)), patch.evaluate(inside(patch)))
    assert np.array_equal(pickle.loads(pickle.dumps(other)).evaluate(inside(patch)), patch.evaluate(inside(patch)))


def test_surfaces_over_rectangles_are_pickled():
    net = np.random.default_rng(0).random((3, 4, 3))
    surfaces = [tripatch.BezierRectangle(net), tripatch.NurbsSurface(net, None, [0, 0, 0, 1, 1, 1], [0, 0, 0, 0, 1, 1, 1, 1])]
    for surface in surfaces:
        again = pickle.loads(pickle.dumps(surface))
        assert np.array_equal(again.evaluate([[0.3, 0.4]]), surface.evaluate([[0.3, 0.4]]))
        assert np.array_equal(copy.deepcopy(surface).evaluate([[0.3, 0.4]]), surface.evaluate([[0.3, 0.4]]))


def test_sides_are_copied_and_pickled_bit_for_bit():
    for side in (*sides(), *tripatch.fill(*octant(6)[:2], rim=octant(6)[2]).sides):
        for again in (copy.deepcopy(side), pickle.loads(pickle.dumps(side))):
            for one, other in zip(side.evaluate([0, 0.3, 1]), again.evaluate([0, 0.3, 1]), strict=True):
                assert np.array_equal(one, other)
            assert (again.second_derivative([0.3]) is None) == (side.second_derivative([0.3]) is None)


CASES = {
    "exact": (octant(8)[:2], {"rim": octant(8)[2]}),
    "shaped": (octant(8)[:2], {"rim": octant(8)[2], "bulge": 1.3, "center_offset": 0.05}),
    "spline": (octant(8)[:2], {"rim": octant(8)[2], "method": "polyharmonic_spline"}),
    "quads": (octant(8)[:2], {"rim": octant(8)[2], "output": "quads"}),
    "cage": (octant(8)[:2], {"rim": octant(8)[2], "output": "cage"}),
    "sheet": (sheet(), {}),
    "rows": (sheet(triangles=False), {"output": "quads"}),
}


@pytest.mark.parametrize("name", CASES)
def test_fills_are_pickled_with_what_makes_their_patch_again(name):
    mesh, options = CASES[name]
    fill = tripatch.fill(*mesh, **options)
    data = pickle.dumps(fill)
    for again in (pickle.loads(data), pickle.loads(pickle.dumps(pickle.loads(data))), copy.deepcopy(fill)):
        for field in ("vertices", "normals", "rim", "rim_normals"):
            assert np.array_equal(getattr(again, field), getattr(fill, field)), field
        assert [*map(list, again.faces)] == [*map(list, fill.faces)]
        assert again.report.as_dict() == fill.report.as_dict()
        assert (again.patch is None) == (fill.patch is None)
        if fill.patch is not None:
            place = fill.barycentric[:3] if fill.uv is None else fill.uv[:3]
            assert np.array_equal(again.patch.evaluate(place), fill.patch.evaluate(place))
            assert np.array_equal(pickle.loads(pickle.dumps(again.patch)).evaluate(place), fill.patch.evaluate(place))
    if name == "cage":
        assert np.array_equal(pickle.loads(data).limit(2)[0], fill.limit(2)[0])


def test_fills_of_several_holes_are_pickled_together_and_alone():
    vertices, faces, _ = octant(6)
    both = np.concatenate([vertices, vertices + [5, 0, 0]]), [*map(list, faces), *(np.array(f) + len(vertices) for f in faces)]
    for options in ({}, {"output": "cage"}):
        fills = tripatch.fill_all(*both, **options)
        for fill, again in zip(fills, pickle.loads(pickle.dumps(fills)), strict=True):
            assert np.array_equal(fill.vertices, again.vertices)
            b = [[0.2, 0.3, 0.5]]
            assert np.array_equal(again.patch.evaluate(b), fill.patch.evaluate(b))


def test_a_pickled_fill_of_a_large_mesh_holds_what_is_around_it_only():
    x, y = np.meshgrid(np.arange(200.0), np.arange(200.0))
    vertices = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    at = np.arange(199 * 200).reshape(199, 200)[:, :-1]
    at = at[~((np.abs(at // 200 - 20) < 2) & (np.abs(at % 200 - 20) < 2))]
    faces = np.column_stack([at, at + 1, at + 201, at + 200])
    (fill,) = tripatch.fill_all(vertices, faces)
    data = pickle.dumps(fill)
    assert len(data) < vertices.nbytes / 4
    assert pickle.loads(data)._repr_png_() == fill._repr_png_()


def test_a_mesh_that_has_changed_is_noticed_when_its_patch_is_made_again():
    vertices, faces, rim = octant(6)
    vertices = vertices.copy()
    fill = tripatch.fill(vertices, faces, rim=rim)
    vertices *= [1, 1, 2]
    with pytest.raises(ValueError, match="has changed"):
        _ = pickle.loads(pickle.dumps(fill)).patch
    assert fill.patch is not None


def test_each_is_one_line_that_says_what_it_is(tmp_path):
    fill = tripatch.fill(*octant(8)[:2], rim=octant(8)[2])
    said = [repr(each) for each in (fill, fill.report, fill.patch, *fill.sides, *PATCHES.values())]
    assert all(line.startswith("<tripatch.") and "\n" not in line and " at 0x" not in line for line in said)
    assert said[0].startswith(f"<tripatch.Fill: {len(fill.vertices)} new vertices, {len(fill.faces)} faces by side_vertex, seam")
    assert "side_vertex" in said[1]
    assert repr(tripatch.patch(sides())) == "<tripatch.Patch: 3 sides>"
    tripatch.write(tmp_path / "a.obj", octant()[:2])
    assert re.fullmatch(r"<tripatch.MeshFile .obj: \d+ vertices, \d+ faces>", repr(tripatch.read(tmp_path / "a.obj")))
    assert repr(sides()[0]) == "<tripatch.Side: from (0, 1, 0) to (0, 0, 1)>"


@pytest.mark.parametrize("name", ["exact", "spline", "cage", "sheet"])
def test_a_notebook_shows_a_picture_of_a_fill(name):
    mesh, options = CASES[name]
    image = tripatch.fill(*mesh, **options)._repr_png_()
    assert image.startswith(b"\x89PNG") and len(image) > 1000
