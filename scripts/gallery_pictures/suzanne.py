"""Run by Blender: Suzanne as triangles, into the file that GALLERY_SUZANNE names."""

import os

import bmesh
import numpy as np

mesh = bmesh.new()
bmesh.ops.create_monkey(mesh)
bmesh.ops.triangulate(mesh, faces=mesh.faces)
mesh.verts.index_update()
vertices = [tuple(v.co) for v in mesh.verts]
np.savez(os.environ["GALLERY_SUZANNE"], vertices=vertices, faces=[[v.index for v in f.verts] for f in mesh.faces])
