"""A face that hangs on the boundary of a hole and sticks out is named, whether the hole is filled or not."""

import numpy as np
import pytest
import tripatch


def sheet_with(*extra, size=12):
    """A bent sheet with a hole, and faces of given vertices (numbers, or places of new ones)."""
    x, y = np.meshgrid(np.linspace(-1, 1, size + 1), np.linspace(-1, 1, size + 1), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), 0.2 * x.ravel() ** 2]).tolist()
    at = np.arange((size + 1) ** 2).reshape(size + 1, size + 1)
    hole = {(i, j) for i in range(4, 8) for j in range(4, 8)}
    cells = [(i, j) for i in range(size) for j in range(size) if (i, j) not in hole]
    faces = [[at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]] for i, j in cells]
    a, b = int(at[4, 5]), int(at[4, 6])
    for places in extra:
        faces.append([b, a, *range(len(vertices), len(vertices) + len(places))])
        vertices += places
    rims = [rim for rim in tripatch.find_holes(faces) if len(rim) < 40]
    return np.array(vertices), faces, rims


@pytest.mark.parametrize(
    "places, where",
    [
        ([[-0.3, -0.08, 0.3]], [57, 58, 169]),
        ([[-0.33, -0.17, 0.3], [-0.33, 0, 0.3]], [57, 58, 169, 170]),
        ([[-0.6, -0.08, 0.1]], [57, 58, 169]),
    ],
)
def test_a_face_that_sticks_out_is_named(places, where):
    vertices, faces, rims = sheet_with(places)
    for turned in (False, True):
        mesh = [*faces[:-1], faces[-1][::-1]] if turned else faces
        for fill in tripatch.fill_all(vertices, mesh, rims):
            said = fill.messages if isinstance(fill, tripatch.Refusal) else fill.report.warnings
            (extra,) = (each for each in said if each.code == "extra_face")
            assert sorted(extra.where) == where


def test_an_ear_that_goes_on_with_the_surface_is_none():
    vertices, faces, rims = sheet_with([[-0.2, -0.08, 0.0]])
    (fill,) = tripatch.fill_all(vertices, faces, rims)
    assert not any(warning.code == "extra_face" for warning in fill.report.warnings)
