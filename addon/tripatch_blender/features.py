# SPDX-License-Identifier: GPL-3.0-or-later
"""Creases that a fill continues across a hole are marked as the edges from which they come: sharp, creased, with bevel weight,
and whatever else an edge has."""

from __future__ import annotations

import heapq
from itertools import count

from .attributes import edge_layers, read, write

#: Cosine between a feature and the edge that it comes from, at most: creases turn by 65 degrees at most (-0.42); where a feature
#: begins at the corner of a wall, the other edges of that wall lie across it.
_GOES_ON = -0.3


def mark(bm, joined, rim, faces):
    """Marks new edges. joined: pairs of BMVert that features of the fill join; rim: BMVert; faces: the new ones."""
    edges = {edge for a, b in joined if (edge := bm.edges.get((a, b))) is not None}
    ends = _ends(edges, rim, set(faces))
    if not ends:
        return
    along = {start: _distances(start, edges) for start in ends}
    for edge in edges:
        own = edge.calc_length() / 2
        reached = [(own + min(far[v] for v in edge.verts), ends[start]) for start, far in along.items() if edge.verts[0] in far]
        if reached:
            _take_over(bm, edge, reached)


def sharpen_rim(bm, joined, rim):
    """Marks edges of the rim at which a lid meets the mesh as sharp, where faces are shaded smooth. joined, rim: as above."""
    around = {frozenset(pair) for pair in zip(rim, rim[1:] + rim[:1], strict=True)}
    for a, b in joined:
        edge = bm.edges.get((a, b))
        if edge and frozenset((a, b)) in around and any(face.smooth for face in edge.link_faces):
            edge.smooth = False


def _ends(edges, rim, new):
    """{vertex of the rim at which a feature ends: the edge outside that it continues as}"""
    around, found = {frozenset(pair) for pair in zip(rim, rim[1:] + rim[:1], strict=True)}, {}
    for vertex in rim:
        own = [edge for edge in vertex.link_edges if edge in edges]
        outside = [
            e for e in vertex.link_edges if e.link_faces and frozenset(e.verts) not in around and not new & set(e.link_faces)
        ]
        if len(own) != 1 or not outside:
            continue
        ahead = (own[0].other_vert(vertex).co - vertex.co).normalized()
        turn, edge = min(
            (((e.other_vert(vertex).co - vertex.co).normalized().dot(ahead), e) for e in outside), key=lambda pair: pair[0]
        )
        if turn < _GOES_ON:
            found[vertex] = edge
    return found


def _distances(start, edges):
    """Along the features, by vertex (Dijkstra)."""
    far, order = {}, count()
    heap = [(0.0, next(order), start)]
    while heap:
        length, _, vertex = heapq.heappop(heap)
        if vertex in far:
            continue
        far[vertex] = length
        for edge in vertex.link_edges:
            if edge in edges:
                heapq.heappush(heap, (length + edge.calc_length(), next(order), edge.other_vert(vertex)))
    return far


def _take_over(bm, edge, reached):
    """reached: (distance, edge outside). Numbers are blended by inverse distances, as along a line; the rest is the nearest's."""
    _, nearest = min(reached, key=lambda pair: pair[0])
    weights = [1 / max(length, 1e-30) for length, _ in reached]
    edge.smooth, edge.seam = nearest.smooth, edge.seam or nearest.seam  # it may part UVs already
    for kind, layer, blended in edge_layers(bm):
        if not blended:
            edge[layer] = nearest[layer]
            continue
        values = [read(other[layer], kind) for _, other in reached]
        mean = [sum(w * x for w, x in zip(weights, column, strict=True)) / sum(weights) for column in zip(*values, strict=True)]
        write(edge, layer, kind, mean)
