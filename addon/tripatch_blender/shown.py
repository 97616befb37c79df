# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay shows of an object, as arrays: nothing here draws, and nothing loops over faces."""

from __future__ import annotations

from dataclasses import dataclass, field

from . import seam, sentences, subdivision, versions
from .library import np, quality, words


@dataclass
class Shown:
    """An object's surface as it is seen, in world space but for the place of the object."""

    positions: np.ndarray  # (3 t, 3) float32, corner by corner of the triangles
    normals: np.ndarray  # (3 t, 3), as the surface is shaded
    colors: np.ndarray | None = None  # (3 t, 4)
    lines: np.ndarray = field(default_factory=lambda: np.zeros((0, 3), np.float32))  # (2 k, 3) ends of the seam's edges
    line_colors: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), np.float32))
    told: list = field(default_factory=list)  # sentences
    worst: tuple | None = None  # where the seam is worst, and the angle there in degrees


def _got(elements, name, width, kind="float32"):
    values = np.empty(len(elements) * width, kind)
    elements.foreach_get(name, values)
    return values.reshape(-1, width) if width > 1 else values


def _of_mesh(mesh, turn, with_normals):
    """Vertices (n, 3), triangles (t, 3) and normals (3 t, 3) of what Blender evaluated, turned and scaled as the object is."""
    mesh.calc_loop_triangles()
    triangles = _got(mesh.loop_triangles, "vertices", 3, np.int32)
    vertices = _got(mesh.vertices, "co", 3) @ turn.T.astype(np.float32)
    normals = None
    if with_normals:
        loops = _got(mesh.loop_triangles, "loops", 3, np.int32).ravel()
        normals = versions.corner_normals(mesh)[loops] @ np.linalg.inv(turn).astype(np.float32)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    if np.linalg.det(turn) < 0:
        triangles = triangles[:, ::-1]
        normals = None if normals is None else normals.reshape(-1, 3, 3)[:, ::-1].reshape(-1, 3)
    return vertices, triangles, normals


def _seam_edges(ob, mesh):
    """The seam's edges in the evaluated mesh."""
    if ob.type != "MESH":
        return np.zeros((0, 2), np.int64)
    modifier = subdivision.modifier_of(ob)
    if modifier and ob.mode == "EDIT":
        ob.update_from_editmode()
    if modifier and len(mesh.vertices) > len(ob.data.vertices):
        level = subdivision.level_of(modifier)
        if not level or not seam.is_subdivided(ob.data, mesh, level):  # other modifiers have added to it
            return np.zeros((0, 2), np.int64)
        return seam.subdivided(seam.edges(ob.data), ob.data, 2**level - 1)
    return seam.edges(ob.data, mesh)


def _deviation(mesh):
    attribute = mesh.attributes.get("deviation")
    if attribute is None or attribute.domain != "POINT" or attribute.data_type != "FLOAT":
        return None
    values = _got(attribute.data, "value", 1)
    return np.where(values < 0, np.nan, values)  # not known


def _surface_colors(made, mesh, vertices, triangles, settings):
    """Colors (n, 3) of the vertices for what is shown of them, or None; says what the scale is."""
    if settings.surface == "CURVATURE":
        mean, _ = quality.curvatures(vertices.astype(np.float64), triangles.astype(np.int64))
        most = settings.curvature if settings.fixed_range else quality.usual(mean)
        made.told.append(sentences.said("curvature_shown", least=f"{-most:.3g}", most=f"{most:.3g}"))
        return quality.signed_colors(mean, most)
    if settings.surface == "DEVIATION":
        values = _deviation(mesh)
        if values is None or not np.nan_to_num(values).any():
            made.told.append(sentences.said("deviation_not_known"))
            return None
        most = settings.deviation if settings.fixed_range else float(np.nan_to_num(values).max(initial=0.0))
        said = {"largest": f"{np.nan_to_num(values).max(initial=0.0):.3g}", "most": f"{most:.3g}"}
        said |= {"unknown": int(np.isnan(values).sum())} if np.isnan(values).any() else {}
        made.told.append(sentences.said("deviation_shown", **said))
        return quality.known_colors(values, most)
    return None


def _add_seam(made, vertices, triangles, edges, reported, settings):
    """reported: the angle that the fills there report, None where it is to be measured."""
    if len(edges):
        edges = edges[edges.max(axis=1) < len(vertices)]
    angles = quality.seam_angles(vertices.astype(np.float64), triangles.astype(np.int64), edges)
    known = np.isfinite(angles)
    if not known.any():
        made.told.append(sentences.said("no_seam_shown"))
        return
    edges, angles = edges[known], angles[known]
    worst = int(angles.argmax())
    made.lines = vertices[edges.ravel()].astype(np.float32)
    colors = quality.scale_colors(angles, settings.seam_most)
    made.line_colors = np.repeat(np.column_stack([colors, np.ones(len(colors))]), 2, axis=0).astype(np.float32)
    angle = float(angles[worst]) if reported is None else reported
    made.worst = (vertices[edges[worst]].mean(axis=0), angle)
    made.told.append(sentences.said("seam_shown", angle=words.degrees(angle), most=words.degrees(settings.seam_most)))


def of_evaluated(ob, mesh, turn, settings):
    """What is shown of an object whose evaluated mesh this is. turn: (3, 3) of its world matrix."""
    stripes = settings.surface in ("ZEBRA", "HIGHLIGHT")
    vertices, triangles, normals = _of_mesh(mesh, turn, stripes)
    flat = triangles.ravel()
    made = Shown(vertices[flat], normals)
    colors = _surface_colors(made, mesh, vertices, triangles, settings)
    bad = np.zeros(len(triangles), bool)
    if settings.folds:
        bad = quality.folded(vertices.astype(np.float64), triangles.astype(np.int64))
        made.told.append(sentences.said("folds_shown", count=int(bad.sum())) if bad.any() else sentences.said("no_folds_shown"))
    if not stripes:
        shown = np.zeros((len(flat), 4), np.float32)
        if colors is not None:
            shown[:, :3], shown[:, 3] = colors[flat], 1
        if settings.folds:
            shown[np.repeat(bad, 3)] = (*quality.FOLD_COLOR, 1)
        made.colors = shown
    elif settings.folds:
        made.colors = np.zeros((len(flat), 4), np.float32)
        made.colors[np.repeat(bad, 3)] = (*quality.FOLD_COLOR, 1)
    if settings.seam:
        reported = seam.reported(ob.data.name, _got(mesh.vertices, "co", 3))
        _add_seam(made, vertices, triangles, _seam_edges(ob, mesh), reported, settings)
    return made


def of_object(ob, depsgraph, settings):
    """`Shown` of an object as the depsgraph has evaluated it; None where it has no surface."""
    evaluated = ob.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        if mesh is None or not len(mesh.polygons):
            return None
        return of_evaluated(ob, mesh, np.array(ob.matrix_world, np.float64)[:3, :3], settings)
    finally:
        evaluated.to_mesh_clear()
