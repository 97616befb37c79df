"""Three sides from a CAD kernel: the corner of a box between three rounded edges, filled by TriPatch.

    pip install tripatch-*.whl cadquery-ocp
    python scripts/examples/occt.py [corner.obj]

OpenCASCADE (through cadquery-ocp) rounds three edges of a box that meet, and makes a part of a ball at the corner. That face
is left out here: its edges become the sides of a hole, and the rounded faces beyond them say what the fill has to continue.
"""

import sys

import numpy as np
import tripatch
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.gp import gp_Pnt, gp_Pnt2d, gp_Vec, gp_Vec2d
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_VERTEX
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

SIZE, RADIUS = (2.0, 3.0, 4.0), 0.8


def parts(shape, kind, name):
    """Faces, edges or vertices of a shape."""
    cast = getattr(TopoDS, f"{name}_s", None) or getattr(TopoDS, name)  # OCP 7 and OCP 8
    explorer = TopExp_Explorer(shape, kind)
    found = []
    while explorer.More():
        found.append(cast(explorer.Current()))
        explorer.Next()
    return found


def xyz(v):
    return np.array([v.X(), v.Y(), v.Z()])


def rounded_box():
    """A box whose three edges at the corner SIZE are rounded."""
    box = BRepPrimAPI_MakeBox(*SIZE).Shape()
    rounding = BRepFilletAPI_MakeFillet(box)
    seen = []
    for edge in parts(box, TopAbs_EDGE, "Edge"):
        ends = [xyz(BRep_Tool.Pnt_s(v)) for v in parts(edge, TopAbs_VERTEX, "Vertex")]
        if any(np.allclose(p, SIZE) for p in ends) and not any(edge.IsSame(other) for other in seen):
            rounding.Add(RADIUS, edge)
            seen.append(edge)
    return rounding.Shape()


def corner_face(shape):
    """The face that OpenCASCADE made where the rounded edges meet: the one whose every edge is near the corner."""

    def farthest(face):
        return max(np.linalg.norm(xyz(BRep_Tool.Pnt_s(v)) - SIZE) for v in parts(face, TopAbs_VERTEX, "Vertex"))

    return min(parts(shape, TopAbs_FACE, "Face"), key=farthest)


class Edge:
    """An edge of a face, as three functions of t in [0, 1] for tripatch.Side.from_functions."""

    def __init__(self, edge, face, inside):
        """inside: a point on the hole's side of the edge."""
        self.face, self.surface = face, BRepAdaptor_Surface(face)
        self.curve = BRepAdaptor_Curve2d(edge, face)
        self.range = (self.curve.FirstParameter(), self.curve.LastParameter())
        self.inside = inside
        self.turned = False

    def at(self, t):
        """Position, derivative along the edge and derivative across it, away from the hole: (k, 3) each."""
        first, last = self.range
        rows = []
        for s in np.atleast_1d(t):
            uv, duv, p, du, dv = gp_Pnt2d(), gp_Vec2d(), gp_Pnt(), gp_Vec(), gp_Vec()
            self.curve.D1(last + s * (first - last) if self.turned else first + s * (last - first), uv, duv)
            self.surface.D1(uv.X(), uv.Y(), p, du, dv)
            along = (xyz(du) * duv.X() + xyz(dv) * duv.Y()) * (last - first) * (-1 if self.turned else 1)
            normal = np.cross(xyz(du), xyz(dv))
            across = np.cross(along, normal / np.linalg.norm(normal))
            rows.append((xyz(p), along, across if across @ (xyz(p) - self.inside) > 0 else -across))
        return tuple(np.array(part) for part in zip(*rows))

    def side(self):
        return tripatch.Side.from_functions(lambda t: self.at(t)[0], lambda t: self.at(t)[1], lambda t: self.at(t)[2])


def edges_round(shape, face):
    """The three edges of a face, each in the face beyond it, in order and direction round the hole."""
    own = [edge for edge in parts(face, TopAbs_EDGE, "Edge") if not BRep_Tool.Degenerated_s(edge)]  # a ball's pole is an edge too
    ends = [[xyz(BRep_Tool.Pnt_s(v)) for v in parts(edge, TopAbs_VERTEX, "Vertex")] for edge in own]
    inside = np.mean([p for pair in ends for p in pair], axis=0)
    found = []
    for edge in own:
        beyond = next(
            f
            for f in parts(shape, TopAbs_FACE, "Face")
            if not f.IsSame(face) and any(e.IsSame(edge) for e in parts(f, TopAbs_EDGE, "Edge"))
        )
        found.append(Edge(edge, beyond, inside))
    outwards = np.array(SIZE) - inside
    for edge in found:
        p, along, across = edge.at([0.5])
        edge.turned = bool(np.cross(across[0], along[0]) @ outwards < 0)  # the fill's normal points out of the box
    first, second, third = found
    end, start = first.at([1.0])[0], second.at([0.0])[0]
    return [first, second, third] if np.allclose(end, start) else [first, third, second]


def fill():
    """The patch, its sides, and the face of OpenCASCADE's that it stands for."""
    shape = rounded_box()
    face = corner_face(shape)
    sides = [edge.side() for edge in edges_round(shape, face)]
    # edges of real files meet within the tolerances of their vertices only
    gap = max(BRep_Tool.Tolerance_s(v) for v in parts(face, TopAbs_VERTEX, "Vertex"))
    return tripatch.patch(sides, fairing="auto", tolerance=2 * gap), sides, face


def main():
    patch, sides, face = fill()
    b, faces = patch.triangles(16)
    points = patch.evaluate(b)
    t = np.linspace(0, 1, 200)
    seam = 0.0
    for i, side in enumerate(sides):
        along = np.zeros((len(t), 3))
        along[:, (i + 1) % 3], along[:, (i + 2) % 3] = 1 - t, t
        mine, theirs = patch.normal(along), side.evaluate(t)[3]
        seam = max(seam, np.degrees(np.arctan2(np.linalg.norm(np.cross(mine, theirs), axis=1), (mine * theirs).sum(1)).max()))
    ball = BRepAdaptor_Surface(face).Sphere()
    off = np.linalg.norm(points - xyz(ball.Location()), axis=1) - ball.Radius()
    print(
        f"{len(points)} points; seam within {seam:.1e} deg; off OpenCASCADE's ball by {np.abs(off).max():.1e} at most, "
        f"{np.sqrt(np.mean(off**2)):.1e} rms, of a radius of {ball.Radius()}"
    )
    if len(sys.argv) > 1:
        with open(sys.argv[1], "w") as out:
            out.writelines(f"v {x} {y} {z}\n" for x, y, z in points)
            out.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)


if __name__ == "__main__":
    main()
