"""Quads in the place of a block of quads: rows that continue across the hole."""

import numpy as np
import pytest
import tripatch
from codes import refused


def grid(columns, rows, at):
    """Vertices and quads of a grid; at: arrays i, j -> x, y, z."""
    i, j = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0), indexing="ij")
    index = np.arange((columns + 1) * (rows + 1)).reshape(columns + 1, rows + 1)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    return np.stack(np.broadcast_arrays(*at(i, j)), axis=-1).reshape(-1, 3).astype(float), quads, index


def hole(columns, rows, block, at):
    """Vertices with those inside left, faces without a block (first column, first row, columns, rows), its rim and its inside."""
    vertices, quads, index = grid(columns, rows, at)
    a, b, n, m = block
    gone = np.zeros(quads.shape[:2], bool)
    gone[a : a + n, b : b + m] = True
    low, high, left, right = index[a : a + n, b], index[a + n, b : b + m], index[a + n : a : -1, b + m], index[a, b + m : b : -1]
    return (
        vertices,
        quads[~gone].tolist(),
        np.concatenate([low, high, left, right]).tolist(),
        index[a + 1 : a + n, b + 1 : b + m].ravel(),
    )


def tube(i, j):
    turn = i / 16 * 2 * np.pi
    return np.cos(turn) * (1 + 0.1 * np.sin(j / 3)), np.sin(turn), 0.3 * j


def torus(i, j):
    u, v = 2 * np.pi * i / 24, 2 * np.pi * j / 12
    return (2 + 0.7 * np.cos(v)) * np.cos(u), (2 + 0.7 * np.cos(v)) * np.sin(u), 0.7 * np.sin(v)


def bevel(i, j):
    """A bevelled edge along a wave."""
    across = np.array([0, 1, 2, 2.6, 2.8, 2.9, 2.95, 3, 3, 3, 3])[i.astype(int)]
    down = np.array([0, 0, 0, 0.05, 0.15, 0.3, 0.5, 1, 2, 3, 4])[i.astype(int)]
    return across, 0.7 * j, -down + 0.2 * np.sin(j)


def far(found, points):
    """Root mean square of the distances of points to the nearest ones found."""
    apart = np.linalg.norm(np.asarray(points)[:, None] - np.asarray(found)[None], axis=-1).min(axis=1)
    return np.sqrt((apart**2).mean())


def coons(vertices, rim, n, m):
    """Of the rim alone, as Grid Fill and others blend it."""
    p = vertices[rim]
    low, high, left, right = (
        p[: n + 1],
        p[n : n + m + 1],
        p[n + m : 2 * n + m + 1][::-1],
        np.vstack([p[2 * n + m :], p[:1]])[::-1],
    )
    inside = []
    for i in range(1, n):
        for j in range(1, m):
            u, v = i / n, j / m
            corners = (1 - u) * (1 - v) * low[0] + u * (1 - v) * low[-1] + (1 - u) * v * left[0] + u * v * left[-1]
            inside.append((1 - v) * low[i] + v * left[i] + (1 - u) * right[j] + u * high[j] - corners)
    return np.array(inside)


@pytest.mark.parametrize(
    "at, within",
    [(tube, 1e-3), (torus, 3e-3), (bevel, 1e-12)],
    ids=["tube", "torus", "bevel"],
)
def test_the_quads_that_were_there_come_back(at, within):
    """Ten times nearer than a patch of the rim alone, where that is not exact itself, and than a surface over a plane."""
    vertices, faces, rim, inside = hole(10, 12, (2, 3, 5, 6), at)
    fill = tripatch.fill(vertices, faces, rim=rim, output="quads")
    size = np.linalg.norm(np.ptp(vertices[rim], axis=0))
    assert fill.report.method == "quad_rows" and "rows of quads" in fill.report.method_reason
    assert len(fill.faces) == 30 and {len(f) for f in fill.faces} == {4} and not fill.report.poles
    assert fill.report.triangles_folded == 0 and not fill.report.warnings
    off = far(fill.vertices, vertices[inside]) / size
    assert off < within
    spline = tripatch.fill(vertices, faces, rim=rim, output="quads", method="polyharmonic_spline")
    assert off * 10 < far(spline.vertices, vertices[inside]) / size
    assert off * 10 < max(far(coons(vertices, rim, 5, 6), vertices[inside]) / size, 1e-11)


def test_the_deviation_is_honest():
    """Within two of it lie nine vertices in ten of many blocks, and it is no more than twenty times too large in the mean."""
    within, ratios = [], []
    for at in (tube, torus, bevel):
        for n in range(2, 7):
            for m in range(2, 7):
                vertices, faces, rim, inside = hole(10, 12, (2, 3, n, m), at)
                fill = tripatch.fill(vertices, faces, rim=rim, output="quads", method="quad_rows")
                off = np.linalg.norm(fill.vertices[:, None] - vertices[inside][None], axis=-1).min(axis=1)
                within += (off <= 2 * fill.deviation + 1e-12).tolist()
                ratios.append((fill.deviation[0] + 1e-9) / (np.sqrt((off**2).mean()) + 1e-9))
    assert np.mean(within) >= 0.9
    assert np.exp(np.mean(np.log(ratios))) < 20


def test_in_a_ball_whose_rows_meet_at_angles_the_fill_lies_on_the_ball():
    """A cube made a ball: four smooth sides tell more than rows do."""

    def ball(i, j):
        x, y = np.tan((i - 8) / 16 * 1.2), np.tan((j - 8) / 16 * 1.2)
        length = np.sqrt(x * x + y * y + 1)
        return x / length, y / length, 1 / length

    vertices, faces, rim, _ = hole(16, 16, (4, 4, 8, 8), ball)
    fill = tripatch.fill(vertices, faces, rim=rim, output="quads")
    assert np.abs(np.linalg.norm(fill.vertices, axis=1) - 1).max() < 2e-4


def test_numbering_and_where_the_rim_begins_change_nothing():
    vertices, faces, rim, _ = hole(9, 9, (2, 3, 4, 3), torus)
    plain = tripatch.fill(vertices, faces, rim=rim, output="quads")
    random = np.random.default_rng(5)
    order = random.permutation(len(vertices))
    place = np.argsort(order)
    renamed = [
        place[f].tolist()[k % 4 :] + place[f].tolist()[: k % 4]
        for k, f in enumerate(np.array(faces)[random.permutation(len(faces))])
    ]
    turned = np.roll(place[rim], 5)[::-1].tolist()
    other = tripatch.fill(vertices[order], renamed, rim=turned, output="quads")
    assert far(other.vertices, plain.vertices) < 1e-12
    middles = [
        np.vstack([own, fill.vertices])[np.array(fill.faces)].mean(axis=1)
        for own, fill in ((vertices, plain), (vertices[order], other))
    ]
    assert far(*middles) < 1e-12


def test_a_single_row_joins_what_is_opposite():
    vertices, faces, rim, _ = hole(10, 12, (2, 3, 1, 6), bevel)
    fill = tripatch.fill(vertices, faces, rim=rim, output="quads")
    assert len(fill.vertices) == 0 and len(fill.faces) == 6
    assert fill.report.deviation_max is None


def test_noise_is_not_made_larger():
    vertices, faces, rim, inside = hole(12, 12, (3, 3, 6, 6), torus)
    noise = 0.02 * np.random.default_rng(1).normal(size=vertices.shape)
    fill = tripatch.fill(vertices + noise, faces, rim=rim, output="quads", method="quad_rows")
    assert far(fill.vertices, vertices[inside]) < 3 * 0.02 * np.sqrt(3)


def test_triangles_are_halves_where_it_is_asked_for():
    vertices, faces, rim, _ = hole(10, 12, (2, 3, 5, 6), tube)
    fill = tripatch.fill(vertices, faces, rim=rim, method="quad_rows")
    assert len(fill.faces) == 60 and {len(f) for f in fill.faces} == {3}


def test_many_holes_at_once():
    vertices, quads, index = grid(20, 10, torus)
    gone = np.zeros(quads.shape[:2], bool)
    gone[2:5, 2:6] = gone[10:14, 3:7] = True
    faces = quads[~gone].tolist()
    rims = [r for r in tripatch.find_holes(faces) if len(r) < 20]
    assert len(rims) == 2
    fills = tripatch.fill_all(vertices, faces, rims=rims, output="quads")
    assert [fill.report.method for fill in fills] == ["quad_rows"] * 2


def test_what_rows_cannot_give_is_made_in_another_way():
    vertices, faces, rim, _ = hole(10, 12, (2, 3, 5, 6), tube)
    corners = [rim[k] for k in (0, 5, 11, 16)]
    for options in (
        {"resolution": 2},
        {"corners": corners},
        {"through": [vertices[rim].mean(axis=0) * 1.1]},
    ):
        fill = tripatch.fill(vertices, faces, rim=rim, **{"output": "quads", **options})
        assert fill.report.method != "quad_rows", options


def test_insisted_on_it_says_what_it_needs():
    vertices, faces, rim, _ = hole(10, 12, (2, 3, 5, 6), tube)
    ask = {"rim": rim, "method": "quad_rows"}
    with pytest.raises(ValueError, match="quad_rows does not take fairing"):
        tripatch.fill(vertices, faces, output="quads", fairing=None, **ask)
    with pytest.raises(ValueError, match="no cages"):
        tripatch.fill(vertices, faces, output="cage", **ask)
    with refused("no_rows_of_quads"):
        tripatch.fill(vertices, faces, output="quads", corners=[rim[k] for k in (0, 4, 11, 16)], **ask)
    assert (
        tripatch.fill(vertices, faces, output="quads", corners=[rim[k] for k in (5, 0, 11, 16)], **ask).report.method
        == "quad_rows"
    )
    less = [f for f in faces if rim[2] not in f]
    cut = [half for f in less for half in ([f[:3], [f[0], *f[2:]]] if rim[0] in f else [f])]
    with refused("no_rows_of_quads"):
        tripatch.fill(
            vertices, cut, output="quads", rim=next(r for r in tripatch.find_holes(cut) if rim[0] in r), method="quad_rows"
        )


def test_rows_of_no_size_and_far_away_say_so_or_serve():
    vertices, faces, rim, inside = hole(10, 12, (2, 3, 5, 6), tube)
    far_off = tripatch.fill(vertices + 1e6, faces, rim=rim, output="quads")
    assert far_off.report.method == "quad_rows" and far(far_off.vertices - 1e6, vertices[inside]) < 1e-3
    flat = vertices.copy()
    flat[rim[3]] = flat[rim[4]]
    with pytest.raises(tripatch.Refusal, match="Merge by Distance|length|place"):
        tripatch.fill(flat, faces, rim=rim, output="quads", method="quad_rows")
    broken = vertices.copy()
    row = next(v for f in faces for v in f if rim[2] in f and v not in rim)
    broken[row] = np.nan
    with pytest.raises(tripatch.Refusal, match="finite|number"):
        tripatch.fill(broken, faces, rim=rim, output="quads", method="quad_rows")


@pytest.mark.parametrize("at", [torus, tube, bevel], ids=["torus", "tube", "bevel"])
def test_of_a_cage_the_rows_of_its_points_go_on(at):
    """Then its limit surface is the one that was there: ten times nearer than the fairest cage, which shaping by hand takes."""
    vertices, faces, rim, inside = hole(10, 12, (2, 3, 5, 6), at)
    cage = tripatch.fill(vertices, faces, rim=rim, output="cage")
    assert cage.report.cage_in_rows
    assert len(cage.faces) == 30 and not cage.report.poles and cage.report.triangles_folded == 0
    off = far(cage.vertices, vertices[inside])
    other = tripatch.fill(vertices, faces, rim=rim, output="cage", bulge=1.0001)
    assert not other.report.cage_in_rows
    assert off * 10 < far(other.vertices, vertices[inside])
    assert cage.report.seam_angle_max <= max(other.report.seam_angle_max, 1e-3)


def test_a_cage_of_loops_or_with_an_exact_rim_is_no_matter_of_rows():
    vertices, faces, rim, _ = hole(10, 12, (2, 3, 5, 6), tube)
    for options in ({"cage_rim": "exact"}, {"resolution": 1}):
        cage = tripatch.fill(vertices, faces, rim=rim, output="cage", **options)
        assert not cage.report.cage_in_rows, options


@pytest.mark.parametrize("far", [1e200, 6e224, 1e300, 1e308])
@pytest.mark.parametrize("rows", [1, 2, 3])
def test_rows_with_a_vertex_beyond_all_measure_are_left_to_other_methods(far, rows):
    vertices, faces, rim, _ = hole(12, 12, (4, 5, 3, 2), lambda i, j: (i, j, 0.1 * np.sin(i) * np.cos(j)))
    vertices[(4 - rows) * 13 + 6, 2] = far
    try:
        fill = tripatch.fill(vertices, faces, rim=rim, output="quads")
    except tripatch.Refusal:
        return
    assert np.isfinite(fill.vertices).all() and np.isfinite(fill.normals).all() and np.isfinite(fill.rim_normals).all()


def test_quads_at_a_pole_are_as_even_as_those_around():
    """The corner of a cube of 8 x 8 x 6 squares on the unit sphere, 24 of them gone."""
    n = 8
    at = np.linspace(-1, 1, n + 1)
    points, quads = [], []
    for axis in range(3):
        for sign in (-1, 1):
            u, v = (each.ravel() for each in np.meshgrid(at, at, indexing="ij"))
            face = np.insert(np.column_stack([u, v]), axis, sign, axis=1)
            k = np.arange((n + 1) ** 2).reshape(n + 1, n + 1) + len(points) * (n + 1) ** 2
            q = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
            points.append(face)
            quads.append(q if (sign > 0) == (axis != 1) else q[:, ::-1])
    cube, number = np.unique(np.round(np.concatenate(points), 9), axis=0, return_inverse=True)
    vertices = cube / np.linalg.norm(cube, axis=1)[:, None]
    quads = number.ravel()[np.concatenate(quads)]
    corner = np.array([1, -1, 1]) / np.sqrt(3)
    gone = np.linalg.norm(vertices[quads].mean(axis=1) - corner, axis=1) < 0.45
    faces = quads[~gone].tolist()
    (rim,) = tripatch.find_holes(faces)
    fill = tripatch.fill(vertices, faces, rim=rim, output="quads")

    def areas(points, faces):
        p = points[np.asarray(faces)]
        return np.sort(np.linalg.norm(np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]), axis=1) / 2)

    new = areas(np.vstack([vertices, fill.vertices]), fill.faces)
    np.testing.assert_allclose(new, areas(vertices, quads[gone]), rtol=0.2)
