"""Blends of three surfaces: what Python gives for drawing is what the blend is made of."""

import numpy as np
import pytest
import tripatch
from test_papers import three_quadratics


def three_patches():
    return list(map(tripatch.BezierTriangle, three_quadratics()))


@pytest.mark.parametrize("method", ["szilvasi_nagy_c0", "szilvasi_nagy_c1"])
def test_the_blend_is_the_sum_of_its_parts(method):
    r = three_patches()
    patch = tripatch.blend(*r, method=method, shape=(0.3, 0.5, 0.8))
    b = np.random.default_rng(0).dirichlet([2, 2, 2], 50)
    mu = patch.mu(b)[:, :, None]
    p = [surface.evaluate(b) for surface in r]
    # 1/2 [sum_i mu_i r_i + (1 - mu_i) r_{i+2} - q] - s, equations (3) and (11) with its bracket mended
    total = sum(mu[:, i] * p[i] + (1 - mu[:, i]) * p[(i + 2) % 3] for i in range(3))
    expected = (total - patch.correction(b)) / 2 - patch.slope_correction(b)
    assert np.abs(patch.evaluate(b) - expected).max() < 1e-13
    assert list(patch.shape) == [0.3, 0.5, 0.8]
    assert patch.path == []


def test_the_correction_fits_the_auxiliary_curves():
    patch = tripatch.blend(*three_patches(), method="szilvasi_nagy_c0")
    t = np.linspace(0.1, 0.9, 9)
    for i in range(3):
        b = np.zeros((9, 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
        assert np.abs(patch.correction(b) - patch.auxiliary_curve(i, t)).max() < 1e-13


def test_the_path_of_the_optimizer_goes_down():
    patch = tripatch.blend(*three_patches(), method="szilvasi_nagy_c1", shape="optimal")
    energies = [energy for _, energy in patch.path]
    assert len(energies) >= 2
    assert energies[-1] == min(energies)
    assert np.allclose(patch.path[-1][0], patch.shape)


def test_lambda_at_its_bound_would_gain_only_beyond_it():
    """A constituent ten thousand times as large inside as the others: the blend would leave it out."""
    rng = np.random.default_rng(3)
    corners = np.array([[0, 0, 0], [1, 0, 0.2], [0.3, 0.9, 0.1]])
    indices = np.array([(i, j, 4 - i - j) for i in range(4, -1, -1) for j in range(4 - i, -1, -1)])
    patches = []
    for size in (500, 0.05, 0.05):
        net = indices @ corners / 4
        net[indices.max(axis=1) < 4] += size * rng.normal(size=(12, 3))
        patches.append(tripatch.BezierTriangle(net))
    patch = tripatch.blend(*patches, method="szilvasi_nagy_c1", shape="optimal")
    bounds = [i for i, s in enumerate(patch.shape) if min(s, 1 - s) < 1.001e-3]
    assert bounds
    least = patch.energy("thin_plate")
    for i in bounds:
        inwards = list(patch.shape)
        inwards[i] += 1e-3 if inwards[i] < 0.5 else -1e-3
        assert tripatch.blend(*patches, method="szilvasi_nagy_c1", shape=tuple(inwards)).energy("thin_plate") > least
    for shape in rng.uniform(0.001, 0.999, (40, 3)):
        assert tripatch.blend(*patches, method="szilvasi_nagy_c1", shape=tuple(shape)).energy("thin_plate") > least * (1 - 1e-6)
