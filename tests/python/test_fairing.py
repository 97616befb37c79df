"""Fairing through the Python interface: energies by name, patches and fills nearer to the truth than without."""

import numpy as np
import pytest
import tripatch


def octant_sides():
    """Great circles of the unit sphere between the axes, with unit conormals."""
    corners = np.eye(3)
    sides = []
    for i in range(3):
        a, b, out = corners[(i + 1) % 3], corners[(i + 2) % 3], -corners[i]
        sides.append(
            tripatch.Side.from_functions(
                lambda t, a=a, b=b: np.outer(np.cos(t * np.pi / 2), a) + np.outer(np.sin(t * np.pi / 2), b),
                lambda t, a=a, b=b: np.pi / 2 * (np.outer(np.cos(t * np.pi / 2), b) - np.outer(np.sin(t * np.pi / 2), a)),
                lambda t, out=out: np.tile(out, (len(t), 1)),
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


def test_unknown_energies_are_named():
    with pytest.raises(ValueError, match="bending"):
        tripatch.patch(octant_sides(), fairing="bending")
    with pytest.raises(ValueError, match="bending"):
        tripatch.patch(octant_sides()).energy("bending")
