"""Errors of the triangular patches over Franke's 33 points."""

import frankes_functions as franke
import numpy as np
import pytest
import tripatch


def errors(f, method, cross_boundary, true_slopes=False):
    """All errors at 231 points a triangle."""
    sides = [franke.sides(f, corners, true_slopes) for corners in franke.triangles()]
    return franke.errors(f, franke.surface(sides, method, cross_boundary))


def rms(e):
    return np.sqrt(np.mean(e**2))


def test_the_triangulation_is_the_papers():
    assert franke.POINTS.shape == (33, 2)
    assert franke.triangles().shape == (56, 3, 2)
    assert len(franke.grid()) == 231


def test_gradients():
    x, y, h = np.array([0.3, 0.62]), np.array([0.41, 0.17]), 1e-6
    for f in franke.FUNCTIONS:
        _, fx, fy = f(x, y)
        assert np.allclose((f(x + h, y)[0] - f(x - h, y)[0]) / (2 * h), fx, atol=1e-7)
        assert np.allclose((f(x, y + h)[0] - f(x, y - h)[0]) / (2 * h), fy, atol=1e-7)


@pytest.mark.parametrize("number, bound", list(enumerate([6e-3, 7e-4, 3e-4, 2.5e-5, 9e-4, 2.5e-5], 1)))
def test_quintic_with_consistent_slopes(number, bound):
    f = franke.FUNCTIONS[number - 1]
    e = errors(f, "quintic", "consistent")
    assert rms(e) <= bound
    # Theorem 2: nothing is lost against the triangle's own derivative
    assert np.abs(e - errors(f, "quintic", "given", true_slopes=True)).max() < 1e-10
    # "good slopes matter": as given and as printed are worse by an order
    assert rms(errors(f, "quintic", "given")) > 3 * rms(e)


def test_printed_slopes_lose_precision():
    f = franke.FUNCTIONS[3]
    assert rms(errors(f, "quintic", "as_printed")) > 100 * rms(errors(f, "quintic", "consistent"))


def test_side_vertex():
    assert rms(errors(franke.FUNCTIONS[0], "side_vertex", "consistent")) <= 1.7e-2


@pytest.mark.parametrize("method", ["coons_bezier", "coons_extremal", "coons_mask"])
def test_bezier_methods_take_interpolated_curves(method):
    f = franke.FUNCTIONS[3]
    a, b = franke.triangles()[0][:2]
    sides = franke.sides(f, franke.triangles()[0])
    patch = tripatch.patch(sides, method)
    at_nodes = np.column_stack([1 - franke.NODES, franke.NODES, 0 * franke.NODES])  # side 2
    expected = a + franke.NODES[:, None] * (b - a)
    assert np.abs(patch.evaluate(at_nodes)[:, :2] - expected).max() < 1e-12
    assert np.abs(franke.errors(f, patch.evaluate(at_nodes))).max() < 1e-12
    inside = patch.evaluate(franke.grid())
    assert np.abs(inside[:, :2] - franke.grid() @ franke.triangles()[0]).max() < 1e-10  # a graph


def test_the_bezier_methods_follow_the_coons_patch_of_the_sides_themselves():
    for f in franke.FUNCTIONS:
        far = np.abs(errors(f, "coons_bezier", "consistent") - errors(f, "triangular_coons", "consistent")).max()
        assert far < 5e-3  # what the curves of degree 8 miss


def test_rim_parameters_are_checked():
    side = franke.sides(franke.FUNCTIONS[0], franke.triangles()[0])[0]
    parts = [lambda t, k=k: side.evaluate(t)[k] for k in range(3)]
    assert isinstance(tripatch.Side.from_functions(*parts), tripatch.Side)
    for rim in ([0], [0, 0.5], [0, 0.6, 0.5, 1], [[0, 1]], [0, np.nan, 1]):
        with pytest.raises(ValueError, match="rim must increase from 0 to 1"):
            tripatch.Side.from_functions(*parts, rim=rim)
