# SPDX-License-Identifier: GPL-3.0-or-later
"""Which faces came from which fill, and how it was made: the face attribute `tripatch_fill` (0: original) and a record for each
fill in a custom property of the mesh. Both are saved with the file, so that a fill can be edited later, and an invented surface
can be told from a measured one. Without the add-on they are data like any other."""

from __future__ import annotations

import json

from .library import tripatch
from .selection import by_index

#: The face attribute, an integer: the number of the fill that made a face.
FILL = "tripatch_fill"
_RECORDS = "tripatch_fills"

#: {name of a mesh: {number: index of a face}} of fills of this run of Blender. A slider undoes a fill and makes it again, but
#: undo in edit mode leaves custom properties as they are: the number of a fill that is gone is used again.
_made: dict[str, dict[int, int]] = {}


def all_of(mesh):
    """{number: record} of the fills of a mesh."""
    return {int(number): record for number, record in json.loads(mesh.get(_RECORDS, "{}")).items()}


def of_fill(mesh, number):
    """The record of a fill, or None."""
    return all_of(mesh).get(number)


def _free_number(bm, layer, mesh, known):
    bm.faces.ensure_lookup_table()
    for number, index in sorted(_made.get(mesh.name, {}).items()):
        if index >= len(bm.faces) or bm.faces[index][layer] != number:
            return number
    return max(known, default=0) + 1


def keep(bm, mesh, planned, new_faces, record):
    """Marks the faces of a fill as such and keeps how it was made. record: what the operator was asked for."""
    layer = bm.faces.layers.int.get(FILL)
    if layer is None or not new_faces:
        return
    known = all_of(mesh)
    number = planned.rim.fill or _free_number(bm, layer, mesh, known)
    for face in new_faces:
        face[layer] = number
    bm.faces.index_update()
    _made.setdefault(mesh.name, {})[number] = new_faces[0].index
    report, deviation = planned.fill.report, planned.fill.deviation
    known[number] = record | {
        "method": report.method,
        "error": None if deviation is None or not len(deviation) else float(max(deviation)),
        "version": tripatch.__version__,
        "corners": [tuple(v.co) for v in planned.rim.corners],
    }
    mesh[_RECORDS] = json.dumps(known)


def find_again(bm, mesh):
    """After faces that were no fill's are gone: the others have other numbers."""
    layer = bm.faces.layers.int.get(FILL)
    if layer is None or mesh.name not in _made:
        return
    first: dict[int, int] = {}
    for face in bm.faces:
        first.setdefault(face[layer], face.index)
    _made[mesh.name] = {number: first.get(number, len(bm.faces)) for number in _made[mesh.name]}


def of_arguments(arguments):
    """A record of arguments of tripatch.fill, as properties of the operator."""
    found = {}
    for name, value in arguments.items():
        if isinstance(value, (bool, int, float, str)):
            found["rows" if name == "resolution" and arguments.get("output") != "triangles" else name] = value
        elif isinstance(value, (tuple, list)) and name in ("continuity", "bulge"):  # a value for each side
            found |= {"individual": True} | {f"{name}_{i}": each for i, each in enumerate(value)}
        elif isinstance(value, (tuple, list)) and all(isinstance(each, (int, float)) for each in value):
            found[name] = tuple(value)
    return {"properties": found}


def selected(bm):
    """[(number, faces)] of the fills that a selected face is of, the active one first; faces that hang together by edges."""
    layer = bm.faces.layers.int.get(FILL)
    if layer is None:
        return []
    seeds = [f for f in bm.faces if f.select and f[layer]]
    active = bm.faces.active
    found, done = [], set()
    for seed in [active, *seeds] if active in seeds else seeds:
        if seed in done:
            continue
        region, stack = {seed}, [seed]
        while stack:
            near = {f for e in stack.pop().edges for f in e.link_faces if f[layer] == seed[layer]} - region
            region |= near
            stack += near
        done |= region
        found.append((seed[layer], by_index(region)))
    return found
