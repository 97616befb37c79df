"""python trimesh_rival.py IN.obj OUT.obj: a fan of triangles in every hole, as a program for scripts/holebench --rival."""

import sys

import numpy as np
import trimesh

mesh = trimesh.load(sys.argv[1], process=False)
edges = mesh.edges[trimesh.grouping.group_rows(mesh.edges_sorted, require_count=1)]
labels = trimesh.graph.connected_component_labels(edges, node_count=len(mesh.vertices))[edges[:, 0]]
centers = [mesh.vertices[edges[labels == label]].mean((0, 1)) for label in np.unique(labels)]
centers_of = len(mesh.vertices) + np.searchsorted(np.unique(labels), labels)
faces = np.concatenate([mesh.faces, np.column_stack([edges[:, ::-1], centers_of])])
trimesh.Trimesh(np.concatenate([mesh.vertices, centers]), faces, process=False).export(sys.argv[2])
