"""Patches as NURBS surfaces and in STEP files, read back by Open CASCADE where it is installed (`pip install tripatch[step]`)."""

import numpy as np
import pytest
import tripatch
from shapes import octant
from test_papers import cubic_curves, largest, sides_of, slopes_across, three_quadratics


def beside_each_other():
    curves = cubic_curves()
    return sides_of(curves, slopes_across(curves))


def of_octant(**options):
    vertices, faces, rim = octant()
    return tripatch.fill(vertices, faces, rim=rim, corners=[rim[0], rim[8], rim[16]], **options).patch


def square():
    corners = np.array([(0, 0, 0), (1, 0, 0.2), (1, 1, 0), (0, 1, 0.2)], float)
    sides = []
    for i in range(4):
        a, b = corners[i], corners[(i + 1) % 4]
        sides.append(
            tripatch.Side.from_functions(
                lambda t, a=a, b=b: (1 - t)[:, None] * a + t[:, None] * b,
                lambda t, a=a, b=b: np.broadcast_to(b - a, (len(t), 3)),
                lambda t, d=b - a: np.broadcast_to(np.cross(d, [0, 0, 1]), (len(t), 3)),
            )
        )
    return tripatch.patch(sides)


def bowl():
    def ring(t, derivative=0):
        a = 2 * np.pi * t + derivative * np.pi / 2
        return (2 * np.pi) ** derivative * np.column_stack([np.cos(a), np.sin(a), 0 * t])

    return tripatch.patch([tripatch.Side.from_functions(ring, lambda t: ring(t, 1), lambda t: ring(t) - [0, 0, 0.5])])


PATCHES = {
    "side_vertex": lambda: tripatch.patch(beside_each_other(), "side_vertex"),
    "faired": lambda: tripatch.patch(beside_each_other(), fairing="auto"),
    "gregory": lambda: tripatch.patch(beside_each_other(), "gregory"),
    "blend": lambda: tripatch.blend(*map(tripatch.BezierTriangle, three_quadratics())),
    "square": square,
    "bowl": bowl,
    "mesh": of_octant,
}


@pytest.mark.parametrize("name", PATCHES)
def test_patches_are_nurbs_surfaces_to_a_millionth_of_their_size(name):
    patch = PATCHES[name]()
    made = tripatch.nurbs(patch)
    size = max(np.ptp(points.reshape(-1, 3), axis=0).max() for points in made.points)
    assert made.deviation < 1e-6 * size
    assert made.angle < 1e-3
    assert not made.exact
    for surface, points, knots in zip(made.surfaces, made.points, made.knots, strict=True):
        same = tripatch.NurbsSurface(points, None, *knots)
        uv = np.random.default_rng(0).uniform(size=(20, 2))
        assert np.array_equal(surface.evaluate(uv), same.evaluate(uv))


def test_pieces_meet_in_the_same_curves():
    for make in (PATCHES["blend"], PATCHES["square"], PATCHES["bowl"]):
        t = np.linspace(0, 1, 33)
        edges = []
        for surface in tripatch.nurbs(make()).surfaces:
            for uv in ((t, 0 * t), (t, 0 * t + 1), (0 * t, t), (0 * t + 1, t)):
                edges.append(surface.evaluate(np.column_stack(uv)))
        count = [sum(min(largest(e - o), largest(e - o[::-1])) < 1e-12 for o in edges) for e in edges]
        inner = sum(n == 2 for n in count)
        assert inner >= len(edges) / 2  # what is neither a side nor drawn together to a corner


@pytest.mark.parametrize("degree", [1, 2, 5, 12])
def test_polynomials_are_written_exactly(degree):
    net = np.random.default_rng(degree).normal(size=((degree + 1) * (degree + 2) // 2, 3))
    made = tripatch.nurbs(tripatch.BezierTriangle(net))
    assert made.exact and [s.degrees for s in made.surfaces] == [(degree, degree)] * 3
    assert made.deviation < 1e-11
    assert made.angle < 1e-6


def test_what_cannot_be_one_says_so():
    with pytest.raises(ValueError, match="cannot be written as NURBS surfaces"):
        tripatch.nurbs(of_octant(method="polyharmonic_spline"))
    with pytest.raises(TypeError, match="patch must be of type Patch"):
        tripatch.nurbs(3)
    for tolerance, error in ((0, ValueError), (np.nan, ValueError), ("x", TypeError)):
        with pytest.raises(error, match="tolerance"):
            tripatch.nurbs(tripatch.BezierTriangle(np.eye(3)), tolerance)


def faces_read(path):
    """Surfaces and faces in a STEP file, by Open CASCADE."""
    control, explorer = pytest.importorskip("OCP.STEPControl"), pytest.importorskip("OCP.TopExp")
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopoDS import TopoDS

    reader = control.STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    found, faces = explorer.TopExp_Explorer(reader.OneShape(), TopAbs_FACE), []
    cast = getattr(TopoDS, "Face_s", None) or TopoDS.Face  # OCP 7 and OCP 8
    while found.More():
        faces.append(BRep_Tool.Surface_s(cast(found.Current())))
        found.Next()
    return faces


@pytest.mark.parametrize("name", ["side_vertex", "blend", "square", "mesh"])
def test_a_step_file_read_back_is_the_patch(name, tmp_path):
    pytest.importorskip("OCP", reason="cadquery-ocp is not installed")
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
    from OCP.GeomLProp import GeomLProp_SLProps
    from OCP.gp import gp_Pnt

    patch = PATCHES[name]()
    (made,) = tripatch.write_step(tmp_path / "patch.step", patch)
    faces = faces_read(tmp_path / "patch.step")
    assert len(faces) == len(made.surfaces)
    t = np.linspace(0.02, 0.98, 13)
    places = np.vstack([patch.on_side(i, t) for i in range(4 if name == "square" else 3)])
    points, normals = patch.positions_and_normals(places)
    size = np.ptp(points, axis=0).max()
    for point, normal in zip(points, normals, strict=True):
        near = [GeomAPI_ProjectPointOnSurf(gp_Pnt(*point.tolist()), face) for face in faces]
        distance, k = min((p.LowerDistance(), k) for k, p in enumerate(near) if p.NbPoints())
        assert distance < 1e-6 * size
        props = GeomLProp_SLProps(faces[k], *near[k].LowerDistanceParameters(), 1, 1e-12)
        n = props.Normal()
        own = np.array([n.X(), n.Y(), n.Z()])
        angle = tripatch.angles([own * np.sign(own @ normal)], [normal])[0]
        assert angle < 1e-3


def test_without_the_package_the_message_says_what_to_install(tmp_path, monkeypatch):
    import builtins

    real = builtins.__import__

    def without(name, *args, **kwargs):
        if name.startswith("OCP"):
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match=r"pip install tripatch\[step\]"):
        tripatch.write_step(tmp_path / "patch.step", tripatch.BezierTriangle(np.eye(3)))
