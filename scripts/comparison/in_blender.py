"""Times of Smooth Fill next to Grid Fill, and of its sliders, in a Blender; run inside of one by speed.py, prints JSON.

blender --background --factory-startup --python scripts/comparison/in_blender.py -- PACKAGES OCTANT REPETITIONS

OCTANT: .npz of a mesh whose hole has sides of 32 edges: vertices, faces, rim.
"""

import json
import sys
import time
from pathlib import Path

import bpy  # isort: skip  # makes Blender's own modules importable
import bmesh
import numpy as np

#: (faces along the mesh, faces along the hole or the radius of a round one)
HOLES = {
    "10 edges in 1,000,000 faces": (1000, (2, 3)),
    "10 edges in 100,000 faces": (316, (2, 3)),
    "100 edges in 100,000 faces": (316, (25, 25)),
    "100 edges, a jagged circle, in 100,000 faces": (316, 13.2),
}
#: a slider's values one after the other, in 100,000 faces and 48 edges
SLIDERS = {
    "bulge": [{"bulge": 1 + k / 40} for k in range(9)],
    "density": [{"resolution": 8 + k} for k in range(9)],
    "rows of quads": [{"output": "quads", "rows": k} for k in range(9)],
    "center": [{"center_offset": k / 500} for k in range(9)],
}
SLIDER_HOLE = (316, (12, 12))


def enable(packages: str) -> None:
    """The add-on of the source tree with the tripatch among these packages; Blender's own modules come first."""
    sys.path.append(str(Path(__file__).resolve().parents[2] / "addon"))
    sys.path.append(packages)
    import addon_utils

    addon_utils.enable("tripatch_blender")


def hole(along: int, size: tuple[int, int] | float) -> int:
    """A wavy mesh in edit mode, its rim selected. Returns the edges of the rim."""
    x, y = np.meshgrid(np.linspace(-1, 1, along + 1), np.linspace(-1, 1, along + 1), indexing="ij")
    z = 0.2 * np.sin(3 * x) * np.cos(2 * y)
    index = np.arange((along + 1) ** 2).reshape(along + 1, -1)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    row, column = np.meshgrid(np.arange(along) - along // 2, np.arange(along) - along // 2, indexing="ij")
    if isinstance(size, tuple):
        gone = (-size[0] <= 2 * row) & (2 * row < size[0]) & (-size[1] <= 2 * column) & (2 * column < size[1])
    else:
        gone = np.hypot(row + 0.5, column + 0.5) < size
    places = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    return edit(places, quads[~gone], set(np.flatnonzero(np.abs(places[:, :2]).max(axis=1) < 0.999).tolist()))


def edit(vertices: np.ndarray, faces: np.ndarray, at_rim: set[int]) -> int:
    """A mesh in edit mode, the border edges between some of its vertices selected. Returns how many."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    enable(sys.argv[-3])
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    thing = bpy.data.objects.new("mesh", mesh)
    bpy.context.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="EDGE")
    bpy.ops.mesh.select_all(action="DESELECT")
    bm = bmesh.from_edit_mesh(mesh)
    rim = [e for e in bm.edges if e.is_boundary and all(v.index in at_rim for v in e.verts)]
    bmesh.ops.delete(bm, geom=[v for v in bm.verts if not v.link_faces], context="VERTS")
    for edge in rim:
        edge.select = True
    bmesh.update_edit_mesh(mesh)
    return len(rim)


def time_spent(thing, name: str) -> list[float]:
    """Will hold the seconds that each call of a function of something takes."""
    seconds, function = [], getattr(thing, name)

    def measured(*arguments, **given):
        start = time.perf_counter()
        try:
            return function(*arguments, **given)
        finally:
            seconds.append(time.perf_counter() - start)

    setattr(thing, name, measured)
    return seconds


def own_time() -> list[float]:
    """Will hold the seconds that each Smooth Fill spends in the add-on, the library and what they ask of Blender."""
    from tripatch_blender.operators import MESH_OT_fill_smooth as operator

    seconds, measured = time_spent(operator, "execute"), operator.execute
    operator.execute = lambda self, context: measured(self, context)  # Blender gives a function as many as it names
    return seconds


def timed(step) -> float:
    """Seconds of a step, which is undone."""
    bpy.ops.ed.undo_push(message="before")
    start = time.perf_counter()
    assert step() == {"FINISHED"}
    taken = time.perf_counter() - start
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    return taken


def shown_and_updated() -> set[str]:
    """What Blender does for any operator in Python that looks at one vertex, edge and face, and gives the mesh back."""
    mesh = bpy.context.object.data
    bm = bmesh.from_edit_mesh(mesh)
    bm.verts.index_update()
    bm.faces.index_update()
    for elements in (bm.verts, bm.edges, bm.faces):
        next(iter(elements))
    bmesh.update_edit_mesh(mesh)
    return {"FINISHED"}


def main() -> None:
    repetitions = int(sys.argv[-1])
    beside, sliders = {}, {}
    for name, (along, size) in HOLES.items():
        edges = hole(along, size)
        grid = lambda span=edges // 4: bpy.ops.mesh.fill_grid(span=span)  # noqa: E731
        smooth = lambda: bpy.ops.mesh.fill_smooth()  # noqa: E731
        timed(smooth)
        pairs = [(timed(grid), timed(smooth)) for _ in range(repetitions)]
        beside[name] = {"grid": [p[0] for p in pairs], "smooth": [p[1] for p in pairs]}
    hole(*SLIDER_HOLE)
    own = own_time()
    for name, values in SLIDERS.items():
        own.clear()
        blender = []
        for value in values:  # one after the other, so that both find memory and caches alike
            timed(lambda value=value: bpy.ops.mesh.fill_smooth(**value))
            blender.append(timed(shown_and_updated))
        sliders[name] = {"all": own[1:], "blender": blender[1:]}
    import tripatch

    octant = np.load(sys.argv[-2])
    edit(octant["vertices"], octant["faces"], set(octant["rim"].tolist()))
    timed(bpy.ops.mesh.fill_smooth)
    own, library = own_time(), time_spent(tripatch, "fill_all")
    for _ in range(2 * repetitions):
        timed(lambda: bpy.ops.mesh.fill_smooth(output="triangles"))
    part = {"operator": own, "library": library}
    print("MEASURED " + json.dumps({"version": bpy.app.version_string, "beside": beside, "sliders": sliders, "part": part}))


main()
