"""UV maps that a seam parts at the rim of a hole are continued on both sides without mirrored or stretched faces."""

import numpy as np
import pytest
import tripatch
from tripatch import charts


def sheet(bend=0.0, hole=(3, 7, 2, 6), size=(10, 8)):
    """(positions, faces, hole) of a grid with a hole, bent round an axis along y by so many radians for each unit of x."""
    nx, ny = size
    x, y = np.meshgrid(np.arange(nx + 1.0), np.arange(ny + 1.0), indexing="ij")
    flat = np.column_stack([x.ravel(), y.ravel()])
    if bend:
        angle = bend * (flat[:, 0] - nx / 2)
        places = np.column_stack([np.sin(angle) / bend, flat[:, 1], np.cos(angle) / bend])
    else:
        places = np.column_stack([flat, np.zeros(len(flat))])
    at = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    a, b, c, d = hole
    whole = [(i, j) for i in range(nx) for j in range(ny)]
    faces = [(at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]) for i, j in whole if not (a <= i < b and c <= j < d)]
    own = [(i, j) for i in range(a, b) for j in range(c, d)]
    missing = [(at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]) for i, j in own]
    return places, flat, faces, missing


def continued(uv_of, bend=0.0):
    """The UVs of the faces that close the hole of a sheet, and what they are where the map simply continues. uv_of: (flat (n, 2),
    which side of the seam) -> UVs (n, 2). The seam runs along x = 5."""
    places, flat, faces, missing = sheet(bend)
    (rim,) = [loop.tolist() for loop in tripatch.find_holes(faces) if len(loop) == 16]
    inside = sorted({v for face in missing for v in face} - set(rim))
    place = {v: k for k, v in enumerate([*rim, *inside])}
    side = {tuple(face): flat[list(face)].mean(axis=0)[0] > 5 for face in [*faces, *missing]}
    ends, around = [], []
    for k, a in enumerate(rim):
        b = rim[(k + 1) % len(rim)]
        face = next(face for face in faces if a in face and b in face)
        ends += list(uv_of(flat[[a, b]], side[tuple(face)]))
        around.append((places[list(face)], uv_of(flat[list(face)], side[tuple(face)])))
    blend = tripatch.attribute_weights(flat[rim], flat[inside])
    at = [[place[v] for v in face] for face in missing]
    made = charts.continue_corners(places[[*rim, *inside]], at, np.array(ends), around, blend)
    return made, [uv_of(flat[list(face)], side[tuple(face)]) for face in missing]


def islands(flat, right):
    """Two islands of different scale, one of them turned."""
    return 0.1 * flat if not right else 0.15 * np.column_stack([-flat[:, 1], flat[:, 0]]) + [9, 0]


@pytest.mark.parametrize("bend", [0.0, 0.25, 0.5])
def test_charts_on_both_sides_of_a_seam_stay_as_rigid_as_they_are(bend):
    made, exact = continued(islands, bend)
    for own, wanted in zip(made, exact, strict=True):
        assert own == pytest.approx(wanted, abs=0.02)
    if not bend:
        assert np.vstack(made) == pytest.approx(np.vstack(exact), abs=1e-6)


def test_a_map_that_is_stretched_one_way_stays_so():
    made, exact = continued(lambda flat, right: flat * [0.3, 0.1] + [5 * right, 0])
    assert np.vstack(made) == pytest.approx(np.vstack(exact), abs=1e-6)


def test_a_mirrored_island_stays_mirrored():
    made, exact = continued(lambda flat, right: flat * [-0.1 if right else 0.1, 0.1] + [5 * right, 0], 0.25)
    assert np.vstack(made) == pytest.approx(np.vstack(exact), abs=0.02)


def test_an_island_without_area_is_left_to_blending():
    made, _ = continued(lambda flat, right: flat * [0, 0] + [5 * right, 0])
    assert set(np.vstack(made)[:, 0].round(9)) == {0.0, 5.0}
    made, _ = continued(lambda flat, right: flat * [1, 0] + [50 * right, 0])
    assert np.isfinite(np.vstack(made)).all()


def test_one_chart_is_left_to_blending():
    made, _ = continued(lambda flat, _: 0.1 * flat)
    assert made is None


def test_other_values_than_uvs_are_blended_on_each_side():
    made, _ = continued(lambda flat, right: np.column_stack([0 * flat + right, flat[:, 0]]))
    left, right = np.vstack(made[:4])[:, 0], np.vstack(made[-4:])[:, 0]
    assert (left == 0).all() and (right == 1).all()
