"""Fairing "isometric": fills of bent sheets unroll with them."""

import numpy as np
import pytest
import tripatch
from codes import says

WIDTH, EDGES = 2.0, 24


def flat_sheet(seed):
    """Jittered triangles of a square, their diagonals both ways."""
    rng = np.random.default_rng(seed)
    at = np.linspace(0, WIDTH, EDGES + 1)
    places = np.stack(np.meshgrid(at, at, indexing="ij"), -1).reshape(-1, 2)
    inside = np.all((places > 0) & (places < WIDTH), axis=1)
    places[inside] += rng.uniform(-0.2, 0.2, (inside.sum(), 2)) * WIDTH / EDGES
    faces = []
    for i in range(EDGES):
        for j in range(EDGES):
            a, b = i * (EDGES + 1) + j, (i + 1) * (EDGES + 1) + j
            quad = [a, b, b + 1, a + 1]
            faces += [[quad[k] for k in t] for t in (((0, 1, 2), (0, 2, 3)) if (i + j) % 2 else ((0, 1, 3), (1, 2, 3)))]
    return places, np.array(faces)


def bent(curvature, angle):
    """Rolled about parallel lines, with this curvature by the length across them."""

    def place(p):
        across, along = np.cos(angle) * p[:, 0] + np.sin(angle) * p[:, 1], np.cos(angle) * p[:, 1] - np.sin(angle) * p[:, 0]
        s = np.linspace(across.min(), across.max(), 4001)

        def integral(f):
            return np.concatenate([[0], np.cumsum((f[1:] + f[:-1]) / 2 * np.diff(s))])

        turn = integral(curvature(s))
        x, z = integral(np.cos(turn)), integral(np.sin(turn))
        return np.stack([np.interp(across, s, x), along, np.interp(across, s, z)], 1)

    return place


def cone(p):
    """A sector of a plane around (-1.2, 1), rolled to half an angle of 0.5."""
    q = p - [-1.2, 1.0]
    r, turn = np.hypot(*q.T), np.arctan2(q[:, 1], q[:, 0]) / np.sin(0.5)
    return np.stack([r * np.sin(0.5) * np.cos(turn), r * np.sin(0.5) * np.sin(turn), r * np.cos(0.5)], 1)


def sphere(p):
    q = p - WIDTH / 2
    r = np.maximum(np.hypot(*q.T), 1e-12)
    return np.stack([np.sin(r) * q[:, 0] / r, np.sin(r) * q[:, 1] / r, np.cos(r)], 1)


SHEETS = {
    "cylinder": bent(lambda s: np.ones_like(s), 0.4),
    "cone": cone,
    "rolled ever more": bent(lambda s: 0.3 + 1.2 * s, 0.3),
    "rounded crease": bent(lambda s: 2.5 * np.exp(-(((s - 1.25) / 0.25) ** 2)), 0.4),
    "wave": bent(lambda s: 2.5 * np.sin(3 * s), 0.6),
}


def sheet_with_hole(place, radius=0.8, seed=0):
    flat, faces = flat_sheet(seed)
    middles = flat[faces].mean(axis=1) - WIDTH / 2
    faces = faces[np.hypot(*middles.T) > radius]
    return flat, place(flat), faces


def ring(faces, rim, rings=2):
    """Faces around a rim."""
    near = np.isin(np.arange(faces.max() + 1), rim)
    for _ in range(rings):
        some = near[faces].any(axis=1)
        near[faces[some]] = True
    return faces[some]


def metric_strain(points, faces, around, flat):
    """Root mean square of (stretch - 1) of the faces if they are laid into the plane with those around, as rigidly as possible.

    By local and global steps (Liu and others 2008) from `flat`.
    """
    triangles = np.vstack([faces, around])
    used, triangles = np.unique(triangles, return_inverse=True)
    triangles, points, flat = triangles.reshape(-1, 3), points[used], flat[used].copy()
    a, b, c = (points[triangles[:, k]] for k in range(3))
    length = np.linalg.norm(b - a, axis=1)
    x = np.sum((c - a) * (b - a), axis=1) / length
    y = np.linalg.norm(np.cross(b - a, c - a), axis=1) / length
    zero = np.zeros_like(x)
    own = np.stack([np.stack([zero, zero], 1), np.stack([length, zero], 1), np.stack([x, y], 1)], 1)
    area = length * y / 2
    system = np.zeros((len(points), len(points)))
    edges = []
    for k in range(3):
        i, j = triangles[:, (k + 1) % 3], triangles[:, (k + 2) % 3]
        u, v = own[:, (k + 1) % 3] - own[:, k], own[:, (k + 2) % 3] - own[:, k]
        weight = np.sum(u * v, axis=1) / (4 * area)
        for p, q, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
            np.add.at(system, (p, q), sign * weight)
        edges.append((i, j, weight[:, None], u - v))
    inverse = np.linalg.pinv(system)
    shape = np.linalg.inv(own[:, 1:].transpose(0, 2, 1))
    for _ in range(100):
        placed = flat[triangles]
        left, stretch, right = np.linalg.svd((placed[:, 1:] - placed[:, :1]).transpose(0, 2, 1) @ shape)
        turned = np.linalg.det(left @ right) < 0
        left[turned, :, 1] *= -1
        stretch[turned, 1] *= -1
        rotation = left @ right
        wanted = np.zeros_like(flat)
        for i, j, weight, edge in edges:
            pull = weight * np.einsum("tij,tj->ti", rotation, edge)
            np.add.at(wanted, i, pull)
            np.add.at(wanted, j, -pull)
        flat = inverse @ wanted
    off = np.sum((stretch[: len(faces)] - 1) ** 2, axis=1)
    return np.sqrt(np.average(off, weights=area[: len(faces)]))


def filled(vertices, faces, **options):
    rim = tripatch.find_holes(faces)[0]
    fill = tripatch.fill(vertices, faces, rim=rim, **options)
    return fill, np.vstack([vertices, fill.vertices])


def inside_of(fill, flat):
    """Starting places in the plane of the new vertices."""
    return np.vstack([flat, np.tile(flat[fill.rim].mean(axis=0), (len(fill.vertices), 1))])


def angles_along_rim(points, faces, fill):
    """Degrees between the faces of the mesh and of the fill at each edge of the rim."""

    def normals(some):
        a, b, c = (points[np.asarray(some)[:, k]] for k in range(3))
        n = np.cross(b - a, c - a)
        return n / np.linalg.norm(n, axis=1)[:, None]

    of_edge = {(f[k], f[(k + 1) % 3]): n for f, n in zip(faces, normals(faces), strict=True) for k in range(3)}
    return [
        np.degrees(np.arccos(np.clip(n @ of_edge[f[(k + 1) % 3], f[k]], -1, 1)))
        for f, n in zip(fill.faces, normals(fill.faces), strict=True)
        for k in range(3)
        if (f[(k + 1) % 3], f[k]) in of_edge
    ]


@pytest.mark.parametrize("name", SHEETS)
def test_isometric_fill_of_a_bent_sheet_has_less_than_half_the_strain(name):
    flat, vertices, faces = sheet_with_hole(SHEETS[name])
    strain, seam = {}, {}
    for fairing, method in (("auto", "polyharmonic_spline"), ("isometric", "auto")):  # not the cone itself
        fill, points = filled(vertices, faces, fairing=fairing, method=method)
        assert fill.report.triangles_folded == 0 and not fill.report.crosses_itself
        strain[fairing] = metric_strain(points, np.asarray(fill.faces), ring(faces, fill.rim), inside_of(fill, flat))
        seam[fairing] = np.sqrt(np.mean(np.square(angles_along_rim(points, faces, fill))))
    assert fill.report.fairing == "isometric" and fill.report.energy_after < fill.report.energy_before / 2
    assert strain["isometric"] < strain["auto"] / 2
    assert seam["isometric"] < 1.05 * seam["auto"]


def test_isometric_quads_of_a_crease_move_towards_the_sheet():
    flat, vertices, faces = sheet_with_hole(SHEETS["rounded crease"])
    whole = SHEETS["rounded crease"](np.stack(np.meshgrid(*[np.linspace(0, WIDTH, 400)] * 2), -1).reshape(-1, 2))

    def off(**options):
        fill, _ = filled(vertices, faces, output="quads", **options)
        assert fill.report.triangles_folded == 0
        return np.max([np.linalg.norm(whole - p, axis=1).min() for p in fill.vertices])

    assert off(fairing="isometric") < off() / 2


@pytest.mark.parametrize("method", ["polyharmonic_spline", "multi_sided"])
def test_isometric_moves_the_vertices_of_any_method(method):
    _, vertices, faces = sheet_with_hole(SHEETS["cone"])
    fill, _ = (
        filled(vertices, faces, method=method, corners=(), fairing="isometric")
        if method == "multi_sided"
        else filled(vertices, faces, method=method, fairing="isometric")
    )
    assert fill.report.fairing == "isometric" and fill.report.method == method and fill.patch is None
    assert np.allclose(np.linalg.norm(fill.normals, axis=1), 1)


def test_flat_sheet_stays_flat():
    flat, faces = flat_sheet(0)
    vertices = np.column_stack([flat, np.zeros(len(flat))])
    faces = faces[np.hypot(*(flat[faces].mean(axis=1) - WIDTH / 2).T) > 0.8]
    fill, _ = filled(vertices, faces, fairing="isometric")
    assert np.abs(fill.vertices[:, 2]).max() < 1e-9 and not fill.report.warnings


def test_what_does_not_unroll_is_filled_as_usual():
    _, vertices, faces = sheet_with_hole(sphere)
    fill, _ = filled(vertices, faces, fairing="isometric")
    usual, _ = filled(vertices, faces)
    assert says(fill.report, "surroundings_do_not_unroll")
    assert np.array_equal(fill.vertices, usual.vertices) and fill.report.fairing == usual.report.fairing


def test_several_holes_are_filled_as_each_alone():
    _, vertices, faces = sheet_with_hole(SHEETS["wave"], radius=0.5)
    rim = tripatch.find_holes(faces)[0]
    alone = tripatch.fill(vertices, faces, rim=rim, fairing="isometric")
    (one,) = tripatch.fill_all(vertices, faces, rims=[rim], fairing="isometric")
    assert np.array_equal(alone.vertices, one.vertices)


def test_cages_take_no_isometric_fairing():
    _, vertices, faces = sheet_with_hole(SHEETS["cylinder"], radius=0.3)
    fill, _ = filled(vertices, faces, output="cage", fairing="isometric")
    assert fill.report.not_applied["fairing"] == "output"


def test_sides_alone_and_points_inside_are_refused():
    corners = np.eye(3)

    def side(a, b):
        return tripatch.Side.from_functions(
            lambda t: np.outer(1 - t, a) + np.outer(t, b),
            lambda t: np.tile(b - a, (len(t), 1)),
            lambda t: np.tile(np.cross(b - a, [1, 1, 1]), (len(t), 1)),
        )

    sides = [side(corners[(i + 1) % 3], corners[(i + 2) % 3]) for i in range(3)]
    with pytest.raises(ValueError, match="fairing isometric needs the faces around a hole"):
        tripatch.patch(sides, fairing="isometric")
    _, vertices, faces = sheet_with_hole(SHEETS["cylinder"])
    with pytest.raises(ValueError, match="cannot be used together"):
        filled(vertices, faces, fairing="isometric", through=[[0.0, 0.0, 0.0]])
