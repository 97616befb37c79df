"""Fairing through the Python interface: energies by name, patches and fills nearer to the truth than without."""

import numpy as np
import pytest
import tripatch
from codes import says
from frankes_functions import FUNCTIONS


def octant_sides():
    """Great circles of the unit sphere between the axes, with unit conormals and the sphere's curvature."""
    corners = np.eye(3)
    sides = []
    for i in range(3):
        a, b, out = corners[(i + 1) % 3], corners[(i + 2) % 3], -corners[i]
        sides.append(
            tripatch.Side.from_functions(
                lambda t, a=a, b=b: np.outer(np.cos(t * np.pi / 2), a) + np.outer(np.sin(t * np.pi / 2), b),
                lambda t, a=a, b=b: np.pi / 2 * (np.outer(np.cos(t * np.pi / 2), b) - np.outer(np.sin(t * np.pi / 2), a)),
                lambda t, out=out: np.tile(out, (len(t), 1)),
                q=lambda t, a=a, b=b: -np.outer(np.cos(t * np.pi / 2), a) - np.outer(np.sin(t * np.pi / 2), b),
            )
        )
    return sides


@pytest.mark.parametrize("name", ["thin_plate", "third_derivative", "minimum_variation", "quadric_variation", "auto"])
def test_a_fair_patch_has_less_of_its_energy(name):
    sides = octant_sides()
    plain, fair = tripatch.patch(sides), tripatch.patch(sides, fairing=name)
    assert fair.energy(name) < 0.95 * plain.energy(name)


def test_the_default_finds_the_sphere():
    b = np.random.default_rng(1).dirichlet([1, 1, 1], 2000)
    patch = tripatch.patch(octant_sides(), fairing="auto")
    off = np.linalg.norm(patch.evaluate(b), axis=1) - 1
    assert np.sqrt(np.mean(off**2)) / np.sqrt(2) < 5e-5


def curvature_across(patch, i, t):
    """Normal curvature at a right angle to side i, seen from the outside."""
    b = np.zeros((len(t), 3))
    b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
    across, along = [-0.5 * np.ones(3) for _ in range(2)]
    across[i], along[:] = 1, 0
    along[(i + 1) % 3], along[(i + 2) % 3] = -1, 1
    _, first, second = patch.evaluate(b, derivatives=2)

    def derivative(u, v):
        return u[0] * v[0] * second[:, 0] + (u[0] * v[1] + u[1] * v[0]) * second[:, 1] + u[1] * v[1] * second[:, 2]

    x, y = (np.einsum("d,kdx->kx", u[:2], first) for u in (across, along))
    n = patch.normal(b)
    slant = np.sum(x * y, 1) / np.sum(y * y, 1)
    xx, xy, yy = (np.sum(n * derivative(u, v), 1) for u, v in ((across, across), (across, along), (along, along)))
    return (xx - 2 * slant * xy + slant**2 * yy) / np.sum((x - slant[:, None] * y) ** 2, 1)


def test_g2_meets_the_curvature_side_by_side():
    t = np.linspace(0.01, 0.99, 99)
    plain = tripatch.patch(octant_sides(), continuity="G1")
    for fairing in (None, "auto", "thin_plate"):
        patch = tripatch.patch(octant_sides(), continuity=("G2", "G1", "G2"), fairing=fairing)
        jumps = [np.abs(curvature_across(patch, i, t) + 1).max() for i in range(3)]
        assert max(jumps[0], jumps[2]) < 1e-5 < jumps[1]
        assert min(np.abs(curvature_across(plain, i, t) + 1).max() for i in range(3)) > 1e-2


def test_sides_know_their_curvature():
    side = octant_sides()[0]
    assert np.allclose(side.second_derivative([0, 0.5]), -side.evaluate([0, 0.5])[0])
    c, dc = (lambda t, k=k: np.outer(t**k, [1, 0, 0]) for k in (1, 0))
    none = tripatch.Side.from_functions(c, dc, lambda t: np.outer(1 + t, [0, 1, 0]))
    assert none.second_derivative([0.5]) is None


def test_unknown_energies_are_named():
    with pytest.raises(ValueError, match="bending"):
        tripatch.patch(octant_sides(), fairing="bending")
    with pytest.raises(ValueError, match="bending"):
        tripatch.patch(octant_sides()).energy("bending")


def test_corners_that_disagree_get_a_fan_of_normals():
    """A cube's corner cut off: two planes meet at each corner. G1 along the open sides; the normals stay between the planes'."""
    sides = []
    for i in range(3):
        a, b = np.eye(3)[(i + 1) % 3], np.eye(3)[(i + 2) % 3]
        sides.append(
            tripatch.Side.from_functions(
                lambda t, a=a, b=b: np.outer(1 - t, a) + np.outer(t, b),
                lambda t, a=a, b=b: np.tile(b - a, (len(t), 1)),
                lambda t, a=a, b=b: np.tile(a + b, (len(t), 1)),
                q=lambda t: np.zeros((len(t), 3)),
            )
        )
    b = np.random.default_rng(2).dirichlet([0.5, 0.5, 0.5], 4000)
    for fairing in (None, "auto"):
        patch = tripatch.patch(sides, fairing=fairing)
        assert patch.normal(b).min() > -0.1, "between the three planes, without a fold or a wave"
        for i in range(3):
            t = np.linspace(0.01, 0.99, 50)
            on = np.zeros((50, 3))
            on[:, (i + 1) % 3], on[:, (i + 2) % 3] = 1 - t, t
            n = patch.normal(on)
            assert np.degrees(np.arctan2(np.linalg.norm(np.delete(n, i, 1), axis=1), n[:, i])).max() < 1e-5
        # next to a corner they turn from one plane to the other, one way only
        for k in range(3):
            t = np.linspace(0, 1, 30)
            near = np.zeros((30, 3))
            near[:, k], near[:, (k + 1) % 3], near[:, (k + 2) % 3] = 0.999, 0.001 * (1 - t), 0.001 * t
            turn = np.arctan2(*patch.normal(near)[:, [(k + 1) % 3, (k + 2) % 3]].T)
            assert (np.diff(turn) < 1e-9).all() or (np.diff(turn) > -1e-9).all()


def hilly_graph(n=32, rings=4, height=lambda x, y: FUNCTIONS[0](x, y)[0] / 5.2):
    """Franke's first function, as he gave it, or another, over a triangle in a lattice of triangles; and the rim of a hole there.

    A hill stands just inside the first corner, and the rim is too steep for the mesh to tell its curvature.
    """
    lattice = [(p, q) for p in range(-rings, n + 2 * rings + 1) for q in range(-rings, n + rings - p + 1)]
    index = {at: k for k, at in enumerate(lattice)}
    pq = np.array(lattice) / n
    xy = np.array([0.1, 0.1]) + pq[:, :1] * [0.8, 0.05] + pq[:, 1:] * [0.25, 0.8]
    faces = []
    for p, q in lattice:
        for triangle in (((p, q), (p + 1, q), (p, q + 1)), ((p + 1, q), (p + 1, q + 1), (p, q + 1))):
            middle = np.mean(triangle, axis=0)
            inside = middle.min() > 0 and middle.sum() < n
            if not inside and all(at in index for at in triangle):
                faces.append([index[at] for at in triangle])
    rim = [(p, 0) for p in range(n)] + [(n - q, q) for q in range(n)] + [(0, q) for q in range(n, 0, -1)]
    return np.column_stack([xy, height(*xy.T)]), faces, [index[at] for at in rim]


def test_where_surroundings_wave_within_the_hole_the_plain_patch_is_nearer():
    """Three waves within the hole: whatever is fairest between these rims, it is not the truth."""

    def height(x, y):
        return 0.03 * np.sin(20 * x + 1) * np.cos(20 * y)

    vertices, faces, rim = hilly_graph(height=height)
    corners = [rim[0], rim[32], rim[64]]
    plain = tripatch.fill(vertices, faces, rim=rim, corners=corners, fairing=None)
    fair = tripatch.fill(vertices, faces, rim=rim, corners=corners)
    assert np.array_equal(fair.vertices, plain.vertices)
    assert fair.report.energy_after == fair.report.energy_before > 1e4
    assert says(fair.report, "surroundings_vary")
    tight = tripatch.fill(vertices, faces, rim=rim, corners=corners, tension=1)
    assert not np.allclose(tight.vertices, plain.vertices), "what is asked for is done"


@pytest.mark.parametrize(("noise", "share"), [(1e-3, 0.2), (3e-3, 0.4), (1e-2, 0.9)])
def test_fair_patches_of_noisy_meshes_are_nearer_than_plain_ones(noise, share):
    def height(x, y):
        return x**2 - 0.5 * y**2 + 0.3 * x * y

    clean, faces, rim = hilly_graph(height=height)
    shares = []
    for seed in (4, 5, 6):
        vertices = clean + np.random.default_rng(seed).normal(size=clean.shape) * noise / 40
        far = {}
        for fairing in (None, "auto"):
            points = tripatch.fill(vertices, faces, rim=rim, corners=[rim[0], rim[32], rim[64]], fairing=fairing).vertices
            far[fairing] = np.sqrt(np.mean((points[:, 2] - height(*points[:, :2].T)) ** 2))
        shares.append(far["auto"] / far[None])
    assert np.exp(np.mean(np.log(shares))) < share


def test_a_patch_that_folds_is_unfolded():
    vertices, faces, rim = hilly_graph()
    corners = [rim[0], rim[32], rim[64]]
    assert tripatch.fill(vertices, faces, rim=rim, corners=corners, fairing=None, method="side_vertex").report.folds > 0
    fair = tripatch.fill(vertices, faces, rim=rim, corners=corners)
    assert fair.report.folds == 0
    assert fair.report.seam_angle_max < 1e-5
