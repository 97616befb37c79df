"""Sides from OpenCASCADE, and its own evaluation as the independent truth. Runs where cadquery-ocp is installed:
pip install cadquery-ocp (a gigabyte on disk with what it needs, so that scripts/test does without)."""

import sys
from pathlib import Path

import numpy as np
import pytest
import tripatch

pytest.importorskip("OCP", reason="cadquery-ocp is not installed")

from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Pnt, gp_Vec

try:  # OCP 8
    from OCP.collections import Array1_double, Array1_int, Array2_double, Array2_gp_Pnt
except ImportError:
    from OCP.TColgp import TColgp_Array2OfPnt as Array2_gp_Pnt
    from OCP.TColStd import TColStd_Array1OfInteger as Array1_int
    from OCP.TColStd import TColStd_Array1OfReal as Array1_double
    from OCP.TColStd import TColStd_Array2OfReal as Array2_double

sys.path.append(str(Path(__file__).parents[2] / "scripts" / "examples"))
occt = pytest.importorskip("occt")


def xyz(v):
    return np.array([v.X(), v.Y(), v.Z()])


def kernel_surface(points, weights, knots, degrees):
    """The same NURBS surface in OpenCASCADE."""
    m, n = weights.shape
    poles, w = Array2_gp_Pnt(1, m, 1, n), Array2_double(1, m, 1, n)
    for i in range(m):
        for j in range(n):
            poles.SetValue(i + 1, j + 1, gp_Pnt(*points[i, j]))
            w.SetValue(i + 1, j + 1, weights[i, j])
    axes = []
    for values in knots:
        distinct, repeats = np.unique(values, return_counts=True)
        k, r = Array1_double(1, len(distinct)), Array1_int(1, len(distinct))
        for a, (value, count) in enumerate(zip(distinct.tolist(), repeats.tolist())):
            k.SetValue(a + 1, value)
            r.SetValue(a + 1, count)
        axes.append((k, r))
    return Geom_BSplineSurface(poles, w, axes[0][0], axes[1][0], axes[0][1], axes[1][1], *degrees, False, False)


@pytest.mark.parametrize("degrees", [(1, 2), (3, 3), (5, 4)])
def test_nurbs_surfaces_are_those_of_the_kernel(degrees):
    """Position and all derivatives to the third."""
    rng = np.random.default_rng(3)
    p, q = degrees
    knots = [[0] * (d + 1) + inner + [1] * (d + 1) for d, inner in ((p, [0.3, 0.7]), (q, [0.5, 0.5] if q > 1 else [0.5]))]
    m, n = (len(k) - d - 1 for k, d in zip(knots, degrees))
    points, weights = rng.normal(size=(m, n, 3)), rng.uniform(0.5, 2, size=(m, n))
    mine, theirs = tripatch.NurbsSurface(points, weights, *knots), kernel_surface(points, weights, knots, degrees)
    uv = rng.uniform(0, 1, size=(20, 2))
    values = mine.evaluate(uv, derivatives=3)
    for k, (u, v) in enumerate(uv):
        point = gp_Pnt()
        theirs.D0(u, v, point)
        assert np.abs(values[0][k] - xyz(point)).max() < 1e-12
        for order, found in enumerate(values[1:], 1):
            for j in range(order + 1):
                exact = xyz(theirs.DN(u, v, order - j, j))
                assert np.abs(found[k, j] - exact).max() < 1e-10 * max(1, np.abs(exact).max())


def test_the_example_meets_the_kernels_surfaces():
    """Border and normals against the faces next to the hole, found by projection, and the inside against the kernel's ball."""
    from OCP.BRep import BRep_Tool
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf

    patch, _, ball = occt.fill()
    shape = occt.rounded_box()
    edges = occt.edges_round(shape, occt.corner_face(shape))
    t = np.linspace(0, 1, 101)
    for i, edge in enumerate(edges):
        b = np.zeros((len(t), 3))
        b[:, (i + 1) % 3], b[:, (i + 2) % 3] = 1 - t, t
        points, normals = patch.evaluate(b), patch.normal(b)
        surface = BRep_Tool.Surface_s(edge.face)
        for point, normal in zip(points, normals):
            nearest = GeomAPI_ProjectPointOnSurf(gp_Pnt(*point), surface)
            assert nearest.LowerDistance() < 1e-9
            u, v = nearest.LowerDistanceParameters()
            p, du, dv = gp_Pnt(), gp_Vec(), gp_Vec()
            surface.D1(u, v, p, du, dv)
            exact = np.cross(xyz(du), xyz(dv))
            assert np.degrees(np.arctan2(np.linalg.norm(np.cross(normal, exact)), abs(normal @ exact))) < 1e-5
    sphere = BRepAdaptor_Surface(ball).Sphere()
    inside = patch.evaluate(patch.triangles(16)[0])
    off = np.linalg.norm(inside - xyz(sphere.Location()), axis=1) - sphere.Radius()
    assert np.abs(off).max() < 1e-3 * sphere.Radius()
    assert (patch.normal(np.full((1, 3), 1 / 3)) @ (np.array(occt.SIZE) - xyz(sphere.Location()))).item() > 0  # outwards
