"""Run by Blender: Suzanne as triangles and as the cage that she is, into the file that GALLERY_SUZANNE names."""

import os

import bmesh
import numpy as np

mesh = bmesh.new()
bmesh.ops.create_monkey(mesh)
mesh.verts.index_update()
cage = [[v.index for v in f.verts] for f in mesh.faces]
bmesh.ops.triangulate(mesh, faces=mesh.faces)
mesh.verts.index_update()
vertices = [tuple(v.co) for v in mesh.verts]
np.savez(
    os.environ["GALLERY_SUZANNE"],
    vertices=vertices,
    faces=[[v.index for v in f.verts] for f in mesh.faces],
    cage_sizes=[len(f) for f in cage],
    cage_corners=[v for f in cage for v in f],
)
