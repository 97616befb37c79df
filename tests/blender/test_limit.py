"""Limit points of the bundled OpenSubdiv against Blender's own Subdivision modifier, and against Blender's copy of OpenSubdiv."""

import bpy
import numpy as np
import pytest


def mesh_arrays(mesh):
    """Vertices (n, 3), face offsets (m + 1,) and face corners of a Blender mesh."""
    vertices = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", vertices)
    starts, corners = np.empty(len(mesh.polygons), np.int32), np.empty(len(mesh.loops), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    mesh.loops.foreach_get("vertex_index", corners)
    return vertices.reshape(-1, 3).astype(float), np.append(starts, len(corners)).astype(np.int64), corners.astype(np.int64)


@pytest.fixture(params=["cube", "monkey", "cylinder"])
def cage(request):
    """An object with a subdivision surface. The monkey has borders (the eyes); the cylinder has faces with 32 corners."""
    add = {"cube": bpy.ops.mesh.primitive_cube_add, "monkey": bpy.ops.mesh.primitive_monkey_add}
    add.get(request.param, bpy.ops.mesh.primitive_cylinder_add)()
    cage = bpy.context.object
    yield cage
    bpy.data.objects.remove(cage)


def test_limit_points_are_those_of_the_subdivision_modifier(addon, cage):
    from tripatch import _native

    modifier = cage.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.quality, modifier.use_limit_surface, modifier.boundary_smooth = 1, 6, True, "ALL"
    arrays = mesh_arrays(cage.data)
    evaluated = mesh_arrays(cage.evaluated_get(bpy.context.evaluated_depsgraph_get()).data)[0]
    limit = _native.limit_points(*arrays)
    assert np.abs(evaluated[: len(limit)] - arrays[0]).max() > 1e-3, "the modifier did nothing"
    # The monkey has one vertex of two edges inside its surface, where OpenSubdiv's limit masks and its patches disagree.
    edges = np.array([e.vertices for e in cage.data.edges])
    proper = np.bincount(edges.ravel(), minlength=len(limit)) > 2
    assert np.count_nonzero(~proper) <= 1
    single = 1e-6 * np.ptp(arrays[0])  # Blender computes in float32
    np.testing.assert_allclose(limit[proper], evaluated[: len(limit)][proper], atol=single)
