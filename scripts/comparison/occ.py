"""OpenCASCADE's BRepOffsetAPI_MakeFilling with G1 to three B-spline surfaces, which are interpolated in the strips of a hole."""

from __future__ import annotations

import functools

import numpy as np

from .holes import Hole
from .rivals import Filling, filling, membrane, timed

#: arguments of BRepOffsetAPI_MakeFilling for a hole of diameter 1: degree, points on curves, iterations, anisotropic, tolerances
#: in 2D and 3D, of angle and curvature, greatest degree, greatest segments
OPTIONS = {
    "default": (),
    "finer": (3, 30, 2, False, 1e-5, 1e-5, 1e-3, 0.1, 8, 30),
    "finest": (4, 40, 4, False, 1e-6, 1e-6, 1e-4, 0.01, 8, 60),
}
DEPTH = 0.25  # of the strips


def _strip_face(hole: Hole, i):
    """A B-spline surface through points of the strip, as a face, and its edge along the side."""
    from OCP.Approx import Approx_ParametrizationType
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.collections import Array2_gp_Pnt
    from OCP.GeomAPI import GeomAPI_PointsToBSplineSurface
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    s, d = np.linspace(0, 1, 65), np.linspace(0, DEPTH, 9)
    points = hole.strip(i, np.repeat(s, len(d)), np.tile(d, len(s)))[0].reshape(len(s), len(d), 3)
    grid = Array2_gp_Pnt(1, len(s), 1, len(d))
    for a, row in enumerate(points.tolist()):
        for b, p in enumerate(row):
            grid.SetValue(a + 1, b + 1, gp_Pnt(*p))
    through = GeomAPI_PointsToBSplineSurface()
    # with its default, parameters by chord length, these surfaces are off by up to 12 degrees
    through.Interpolate(grid, Approx_ParametrizationType.Approx_IsoParametric)
    face = BRepBuilderAPI_MakeFace(through.Surface(), 1e-7).Face()
    middle, edges = points[len(s) // 2, 0], []
    explorer = TopExp_Explorer(face, TopAbs_EDGE)
    while explorer.More():
        edge = TopoDS.Edge(explorer.Current())
        curve = BRepAdaptor_Curve(edge)
        p = curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2)
        edges.append((np.linalg.norm(middle - [p.X(), p.Y(), p.Z()]), edge))
        explorer.Next()
    return face, min(edges, key=lambda pair: pair[0])[1]


def fill(hole: Hole, other, setting: str) -> Filling:
    """The surface at the vertices of TriPatch's fill: its parameters there are a membrane between those of the rim."""
    if hole.strip is None:
        raise RuntimeError("no smooth surroundings")
    from OCP.BRep import BRep_Tool
    from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeFilling
    from OCP.GeomAbs import GeomAbs_Shape
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    sides = range(len(hole.counts))
    strips = [_strip_face(hole, i) for i in sides]
    options = list(OPTIONS[setting])
    if options:
        options[5] *= hole.diameter

    def build(_):
        made = BRepOffsetAPI_MakeFilling(*options)
        for face, edge in strips:
            made.Add(edge, face, GeomAbs_Shape.GeomAbs_G1)
        made.Build()
        if not made.IsDone():
            raise RuntimeError("not done")
        return BRep_Tool.Surface_s(TopoDS.Face(TopExp_Explorer(made.Shape(), TopAbs_FACE).Current()))

    surface, cpu = timed(build)

    def evaluate(uv):
        points = [surface.Value(u, v) for u, v in uv.tolist()]
        return np.array([(p.X(), p.Y(), p.Z()) for p in points])

    def parameters(points):
        return np.array([GeomAPI_ProjectPointOnSurf(gp_Pnt(*p), surface).LowerDistanceParameters()[-2:] for p in points.tolist()])

    count = len(hole.vertices)
    faces = np.array(other.faces)
    uv = np.zeros((count + len(other.vertices), 2))
    uv[hole.rim] = parameters(hole.vertices[hole.rim])
    uv = membrane(faces, uv, count)
    return filling(hole, np.concatenate([hole.vertices, evaluate(uv[count:])]), faces, cpu)


SETTINGS = {f"OpenCASCADE, {setting}": functools.partial(fill, setting=setting) for setting in OPTIONS}
