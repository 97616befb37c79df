"""The tasks of a modeller, all filled well with no option changed: closed, unfolded, on the surface that was there."""

import bmesh
import bpy
import numpy as np
import pytest
import tasks
from mathutils import Vector

smooth = bpy.ops.mesh.fill_smooth


def angles(edges):
    return [np.degrees(e.calc_face_angle()) for e in edges if len(e.link_faces) == 2]


def is_crossed(face):
    """Whether corners of a face, more than one, turn against the others."""
    corners = [(c.link_loop_next.vert.co - c.vert.co).cross(c.link_loop_prev.vert.co - c.vert.co) for c in face.loops]
    return sum(turn.dot(sum(corners, Vector())) < 0 for turn in corners) > 1


@pytest.mark.parametrize("make", tasks.ALL, ids=lambda make: make.__name__)
def test_it_is_filled_well(make):
    task = make()
    assert smooth(**task.options) == {"FINISHED"}
    bm = bmesh.from_edit_mesh(task.ob.data)
    bm.normal_update()
    assert not [e for e in bm.edges if len(e.link_faces) > 2]
    caged = any(m.type == "SUBSURF" for m in task.ob.modifiers)
    mirrored = any(m.type == "MIRROR" for m in task.ob.modifiers)
    new = [f for f in bm.faces if f.select]
    assert new
    assert sum(map(is_crossed, new)) <= task.crossed
    points = [v.co.copy() for f in new for v in f.verts] + [f.calc_center_median() for f in new]
    if not mirrored:
        assert sum(e.is_boundary for e in bm.edges) == task.left
    worst = max(angles({e for f in new for e in f.edges}))
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not task.ob.data.validate(verbose=True)
    if caged or mirrored:
        surface = tasks.evaluated(task.ob)
        points = [v.co.copy() for v in surface.verts]
        worst = max(angles(surface.edges)) if mirrored else 0
        assert not [e for e in surface.edges if len(e.link_faces) > 2]
    far = task.far(points) / task.size
    print(f"FIGURE {make.__name__}: {far.max():.1e} of its size off at most, bends by {worst:.0f} degrees at most")
    assert far.max() < task.within
    assert worst < task.bend
