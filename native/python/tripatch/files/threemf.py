"""3MF. New vertices and triangles are written into the text of its model; what was there stays as it is, to the byte.

lib3mf leaves out the parts that it does not know, such as the settings of slicers, so that the package is edited here.
"""

from __future__ import annotations

import copy
import dataclasses
import io
import json
import re
import zipfile
import zlib
from array import array
from collections.abc import Hashable, Iterator
from pathlib import Path
from typing import Any
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

import numpy as np

from .. import quality
from .._types import Array
from ..messages import Message
from . import evidence, writing
from .mesh_file import MeshFile
from .scene import Addition, Part, SceneFile
from .writing import FileError, damaged

_ROOT = "3D/3dmodel.model"
_ORIGINAL = b"tripatch original "
_NAMESPACE = "https://github.com/tripatch"  # only has to be ours
_TAG = re.compile(rb"<(?:[^>\"']|\"[^\"]*\"|'[^']*')*>")
_BLENDED = ("colorgroup", "texture2dgroup")
_EMPTY = {
    "[Content_Types].xml": '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
    "_rels/.rels": '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    f'<Relationship Target="/{_ROOT}" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>'
    "</Relationships>",
}


@dataclasses.dataclass
class _Object:
    """A mesh in a model, or objects put together."""

    vertices: list[float] = dataclasses.field(default_factory=list)
    triangles: list[int] = dataclasses.field(default_factory=list)
    looks: dict[int, tuple[str, list[int]]] = dataclasses.field(default_factory=dict)  # of a triangle: property group, entries
    ends: dict[str, int] = dataclasses.field(default_factory=dict)  # bytes of the text where vertices and triangles end
    starts: dict[str, array[int]] = dataclasses.field(default_factory=lambda: {"vertex": array("q"), "triangle": array("q")})
    look: tuple[str, list[int]] | None = None  # of triangles without their own
    components: list[tuple[str, str, Any]] = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class _Group:
    """Colors or texture coordinates that triangles name by number."""

    kind: str
    rows: list[list[float]] = dataclasses.field(default_factory=list)
    tag: str = ""
    end: int = -1
    new: list[bytes] = dataclasses.field(default_factory=list)

    def entry(self, tags: dict[str, str], values: Array, known: dict[bytes, int]) -> int:
        """The number of a new entry. known: those that there are already, which it joins."""
        row = _entry(tags, self.kind, values)
        if row not in known:
            known[row] = len(self.rows) + len(self.new)
            self.new.append(row)
        return known[row]


class _Model:
    """A model of the package, with the places in its text where things may be added."""

    def __init__(self, name: str, text: bytes) -> None:
        self.name, self.text = name, text
        self.objects: dict[str, _Object] = {}
        self.groups: dict[str, _Group] = {}
        self.items: list[tuple[str, str, Any]] = []
        self.tags: dict[str, str] = {}  # as the file writes them
        self.resources = -1
        self.fills: list[list[str]] = []  # what is said of each, in pieces
        self._object, self._group = _Object(), _Group("")
        self._parser = parser = expat.ParserCreate(namespace_separator=" ")
        parser.StartElementHandler, parser.EndElementHandler = self._start, self._end
        parser.Parse(text, True)
        self._parser = None  # type: ignore[assignment]

    def _start(self, name: str, given: dict[str, str]) -> None:
        name = name.rpartition(" ")[2]
        if name == "vertex":
            self._object.starts[name].append(self._parser.CurrentByteIndex)
            self._object.vertices += (float(given["x"]), float(given["y"]), float(given["z"]))
        elif name == "triangle":
            self._object.starts[name].append(self._parser.CurrentByteIndex)
            if len(given) > 3:
                self._looked(given)
            self._object.triangles += (int(given["v1"]), int(given["v2"]), int(given["v3"]))
        elif name == "object":
            self._object = self.objects[given["id"]] = _Object()
            if "pid" in given:
                self._object.look = given["pid"], [int(given.get("pindex", 0))] * 3
        elif name in ("component", "item"):
            path = next((value for key, value in given.items() if key.endswith(" path")), "")
            placed = self._object.components if name == "component" else self.items
            placed.append((path, given["objectid"], given.get("transform")))
        elif name in ("basematerials", "compositematerials", "multiproperties", *_BLENDED):
            self._group = self.groups[given["id"]] = _Group(name)
        elif name == "tex2coord":
            self._group.rows.append([float(given["u"]), float(given["v"])])
        elif name == "color":
            self._group.rows.append([int(given["color"][k : k + 2] or "ff", 16) for k in (1, 3, 5, 7)])
        elif name == "metadata":
            if given.get("name", "").rpartition(":")[2].startswith("fill_") and "tripatch" in given["name"]:
                self.fills.append([])
                self._parser.CharacterDataHandler = self.fills[-1].append
        elif name == "resources":
            self.resources = self._parser.CurrentByteIndex
        if name in ("vertex", "triangle", "tex2coord", "color", "metadata", "resources") and name not in self.tags:
            found = re.compile(rb"<([^\s/>]+)").match(self.text, self._parser.CurrentByteIndex)
            self.tags[name] = found[1].decode() if found else name

    def _looked(self, given: dict[str, str]) -> None:
        pid = given.get("pid") or (self._object.look[0] if self._object.look else "")
        if pid and "p1" in given:
            first = given["p1"]
            entries = [int(first), int(given.get("p2", first)), int(given.get("p3", first))]
            self._object.looks[len(self._object.triangles) // 3] = pid, entries

    def _end(self, name: str) -> None:
        name, at = name.rpartition(" ")[2], self._parser.CurrentByteIndex
        if name in ("vertices", "triangles"):
            self._object.ends[name] = at
        elif name == "metadata":
            self._parser.CharacterDataHandler = None
        elif name in _BLENDED:
            self._group.end = at


class ThreemfFile(SceneFile):
    """3MF: the meshes of all its models, each where the first item of the build has it."""

    def __init__(self, data: bytes, given: tuple[Array, Any] | None = None) -> None:
        self._data = data
        try:
            with zipfile.ZipFile(io.BytesIO(data)) as package:
                names = [name for name in package.namelist() if name.lower().endswith(".model")]
                self._models = {"/" + name: _Model(name, package.read(name)) for name in names}
        except (zipfile.BadZipFile, zlib.error, expat.ExpatError, LookupError, ValueError, RuntimeError, EOFError) as error:
            raise damaged("3MF", error) from None
        if not self._models:
            raise damaged("3MF")
        self._root = f"/{_ROOT}" if f"/{_ROOT}" in self._models else next(iter(self._models))
        self._new: dict[tuple[str, str], list[bytes]] = {}  # triangles of an object
        self._where: list[tuple[_Model, str]] = []
        self._said: list[dict[str, Any]] = []
        super().__init__(list(self._read()), given)

    @classmethod
    def of_mesh(cls, vertices: Array, faces: Any, suffix: str) -> ThreemfFile:
        """A package with one mesh, in millimeters."""
        triangles, _ = quality.triangulated(faces, vertices)
        rows = "\n".join(_vertex("vertex", point).decode() for point in np.asarray(vertices, float))
        faces_text = "\n".join(_triangle("triangle", row, None).decode() for row in triangles.tolist())
        model = (
            '<?xml version="1.0" encoding="UTF-8"?>\n<model unit="millimeter" xml:lang="en-US" '
            'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">\n<resources>\n'
            '<object id="1" type="model"><mesh>\n'
            f"<vertices>\n{rows}\n</vertices>\n<triangles>\n{faces_text}\n</triangles>\n</mesh></object>\n</resources>\n"
            '<build><item objectid="1"/></build>\n</model>\n'
        )
        held = io.BytesIO()
        with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as package:
            for name, text in {**_EMPTY, _ROOT: model}.items():
                package.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)
        return cls(held.getvalue(), (vertices, triangles))

    def _read(self) -> Iterator[Part]:
        found: dict[tuple[str, str], Array] = {}
        todo = [(*item, np.eye(4), self._root) for item in self._models[self._root].items][::-1]
        depth = 0
        while todo and depth < 100_000:
            depth += 1
            path, number, transform, above, here = todo.pop()
            here = path or here
            each = self._models[here].objects.get(number) if here in self._models else None
            if each is None:
                continue
            matrix = above @ _matrix(transform)
            found.setdefault((here, number), matrix)
            todo += [(*component, matrix, here) for component in reversed(each.components)]
        for path, model in self._models.items():
            for number, each in model.objects.items():
                if len(each.ends) == 2 and each.triangles:
                    self._where.append((model, number))
                    corners = np.array(each.triangles, np.int64)
                    points = np.array(each.vertices).reshape(-1, 3)
                    if corners.min() < 0 or corners.max() >= len(points):
                        raise FileError(Message("face_without_vertex", {"name": f"object {number}"}))
                    yield Part(points, np.arange(0, len(corners) + 1, 3), corners, found.get((path, number)))
                    each.vertices = []

    def _entries(self, f: int) -> tuple[str, list[int]] | None:
        """Of a face its property group and, for each of its corners in the file, the entry there."""
        model, number = self._where[int(self._part_of_face[f])]
        each, k = model.objects[number], int(self._number_in_part[f])
        look = each.looks.get(k, each.look)
        if look is None:
            return None
        of = dict(zip(each.triangles[3 * k : 3 * k + 3], look[1], strict=True))
        return look[0], [of.get(v, look[1][0]) for v in self._file_face(f)]

    def _group_of(self, f: int) -> _Group | None:
        """The colors or texture coordinates that a face has by corner."""
        entries, (model, _) = self._entries(f), self._where[int(self._part_of_face[f])]
        group = model.groups.get(entries[0]) if entries else None
        return group if group and group.kind in _BLENDED and group.end >= 0 else None

    def _look(self, f: int) -> Hashable:
        entries = self._entries(f)
        if entries is None:
            return None
        return entries[0], None if self._group_of(f) else tuple(sorted(entries[1]))

    def _by_corner(self, f: int) -> Array | None:
        group, entries = self._group_of(f), self._entries(f)
        try:
            rows = [np.array(group.rows[k], float) for k in entries[1]] if group and entries else None
        except IndexError:
            return None
        return np.array(self._blended_corners(f, rows)) if rows else None

    def _shares(self, number: int) -> bool:
        return True  # its vertices have nothing but their places

    def _add(self, new: Addition) -> None:
        model, number = self._where[new.number]
        triangles = self._new.setdefault((model.name, number), [])
        each, like = model.objects[number], self._entries(new.models[0])
        numbers, _ = new.own_vertices()
        values, group = new.at_corners(self._by_corner), self._group_of(new.models[0])
        entries: dict[bytes, int] = {}
        first = len(each.triangles) // 3 + len(triangles)
        for k, at in new.triangles():
            look = (like[0], [like[1][0]] * 3) if like else None
            if like and group and values:
                look = like[0], [group.entry(model.tags, values[k][c], entries) for c in at]
            triangles.append(_triangle(model.tags["triangle"], [numbers[new.faces[k][c]] for c in at], look))
        here = {"model": model.name, "object": number, "first_face": first}
        self._said.append({**new.said(), **here, "faces_here": len(each.triangles) // 3 + len(triangles) - first})

    def marked(self) -> MeshFile:
        """The same file, whose metadata will say of each fill which triangles are its."""
        super().marked()
        self._number = len(self._models[self._root].fills)
        return self

    @property
    def fill_faces(self) -> Array:
        """(m,) bool: which faces are fills by TriPatch."""
        found = np.zeros(len(self.faces), bool)
        parts = {(model.name, number): n for n, (model, number) in enumerate(self._where)}
        for text in self._models[self._root].fills:
            try:
                said = json.loads("".join(text))
                n, first, end = parts[said["model"], said["object"]], said["first_face"], said["first_face"] + said["faces_here"]
                found |= (self._part_of_face == n) & (first <= self._number_in_part) & (self._number_in_part < end)
            except (LookupError, TypeError, ValueError):  # written by another program
                continue
        return found

    def stripped(self) -> bytes:
        """The file as it was before its fills: what is new stands behind it."""
        with zipfile.ZipFile(io.BytesIO(self._data)) as package:
            found = re.search(rb"^" + _ORIGINAL + rb"(\{.*\})$", package.comment, re.MULTILINE)
        if not found:
            raise FileError(Message("no_fills_in_file"))
        before = json.loads(found[1])
        return evidence.original([self._data[: before["bytes"]]], before["sha256"])

    def _texts(self) -> dict[str, bytes]:
        """The models that have changed."""
        made = {}
        for path, model in self._models.items():
            groups = {k: dataclasses.replace(group, new=list(group.new)) for k, group in model.groups.items()}
            edits: list[tuple[int, int, bytes]] = []
            for n, (of, number) in enumerate(self._where):
                if of is model:
                    edits += self._edits(n, model, number, groups)
            edits += [(group.end, group.end, b"".join(group.new)) for group in groups.values() if group.new]
            if self._marks and path == self._root and model.resources >= 0:
                said = b"".join(self._metadata(model, said) for said in self._said)
                edits += [(model.resources, model.resources, said)] if said else []
            if edits:
                starts, ends, new = zip(*sorted(edits), strict=True)
                kept = [model.text[first:end] for first, end in zip((0, *ends), (*starts, None), strict=True)]
                made[model.name] = b"".join(each for pair in zip(kept, (*new, b""), strict=True) for each in pair)
        return made

    def _edits(self, n: int, model: _Model, number: str, groups: dict[str, _Group]) -> Iterator[tuple[int, int, bytes]]:
        """Of an object what changes in the text: start, end, and what is there then."""
        part, each = self._parts[n], model.objects[number]
        for v in part.moved:
            place = dict(zip("xyz", map(writing.number, part.point(v)), strict=True))
            yield _edited(model.text, each.starts["vertex"][v], place)
        triangles, known = list(self._new.get((model.name, number), ())), dict[bytes, int]()
        for f in (f for f in self._corners if self._part_of_face[f] == n):
            face, entries, values = self._corners_of(f), self._entries(f), self._by_corner(f)
            pid, looks = (entries[0], [entries[1][int(at)] for _, at in face]) if entries else ("", [])
            if values is not None:  # those within edges have colors or texture coordinates of their own
                within = [c for c, (_, at) in enumerate(face) if at % 1]
                looks = [groups[pid].entry(model.tags, values[c], known) if c in within else p for c, p in enumerate(looks)]
            made = [([face[c][0] for c in at], [looks[c] for c in at] if looks else []) for at in self._cut(f).tolist()]
            said = {f"{name}{k}": b"%d" % x for name, row in zip("vp", made[0], strict=True) for k, x in enumerate(row, 1)}
            yield _edited(model.text, each.starts["triangle"][int(self._number_in_part[f])], said)
            triangles += [_triangle(model.tags["triangle"], row, (pid, look) if look else None) for row, look in made[1:]]
        for name, rows in (("vertices", [_vertex(model.tags["vertex"], p) for p in part.added]), ("triangles", triangles)):
            if rows:
                yield each.ends[name], each.ends[name], b"".join(rows)

    def _metadata(self, model: _Model, said: dict[str, Any]) -> bytes:
        tag = model.tags["resources"].rpartition("resources")[0] + "metadata"
        name = quoteattr(f"tripatch:fill_{said['fill']}")
        text = json.dumps(said, separators=(",", ":")).replace("&", "&amp;").replace("<", "&lt;")
        return f'<{tag} xmlns:tripatch={quoteattr(_NAMESPACE)} name={name} type="xs:string">{text}</{tag}>\n'.encode()

    def _save(self, path: Path) -> None:
        texts = self._texts()
        if not texts:
            path.write_bytes(self._data)
            return
        held = io.BytesIO(self._data)
        with zipfile.ZipFile(held, "a") as package:
            package.start_dir = len(self._data)  # behind all that is there
            for name, text in texts.items():
                old = package.NameToInfo.pop(name)
                package.filelist.remove(old)
                made = zipfile.ZipInfo(name, old.date_time)
                made.external_attr = old.external_attr
                package.writestr(made, text, old.compress_type)
            if self._marks and _ORIGINAL not in package.comment:
                said = {"bytes": len(self._data), "sha256": evidence.sha256(self._data)}
                package.comment = b"\n".join([*package.comment.splitlines(), _ORIGINAL + evidence.line(said)])
        path.write_bytes(held.getvalue())

    def __deepcopy__(self, memo: dict[int, Any]) -> ThreemfFile:
        made = memo[id(self)] = object.__new__(type(self))
        vars(made).update(vars(self))
        for name in ("_new", "_said", "_about", "_split_faces", "_parts", "_corners", "_new_points"):
            setattr(made, name, copy.deepcopy(getattr(self, name), memo))
        made._models = {path: copy.copy(model) for path, model in self._models.items()}
        for model in made._models.values():
            model.groups = {k: dataclasses.replace(group, new=list(group.new)) for k, group in model.groups.items()}
        made._where = [(made._models["/" + model.name], number) for model, number in self._where]
        return made


def _edited(text: bytes, start: int, values: dict[str, bytes]) -> tuple[int, int, bytes]:
    """A tag with other values of its attributes, as far as it has them: start, end, and the text between."""
    found = _TAG.match(text, start)
    assert found
    made = found[0]
    for name, value in values.items():
        made = re.sub(rb"(\s%b\s*=\s*)(\"[^\"]*\"|'[^']*')" % name.encode(), rb'\g<1>"%b"' % value, made, count=1)
    return start, found.end(), made


def _vertex(tag: str, point: Array) -> bytes:
    x, y, z = (writing.number(value).decode() for value in point)
    return f'<{tag} x="{x}" y="{y}" z="{z}"/>'.encode()


def _triangle(tag: str, corners: list[int], look: tuple[str, list[int]] | None) -> bytes:
    said = "".join(f' v{k}="{v}"' for k, v in enumerate(corners, 1))
    if look:
        said += f" pid={quoteattr(look[0])}" + "".join(f' p{k}="{p}"' for k, p in enumerate(look[1], 1))
    return f"<{tag}{said}/>".encode()


def _entry(tags: dict[str, str], kind: str, values: Array) -> bytes:
    if kind == "colorgroup":
        color = "".join(f"{round(min(max(x, 0), 255)):02X}" for x in values.tolist())
        return f'<{tags["color"]} color="#{color}"/>'.encode()
    u, v = (writing.number(x).decode() for x in values)
    return f'<{tags["tex2coord"]} u="{u}" v="{v}"/>'.encode()


def _matrix(transform: str | None) -> Array:
    made = np.eye(4)
    if transform:
        try:
            made[:3] = np.array(transform.split(), float).reshape(4, 3).T
        except ValueError:
            raise damaged("3MF", transform[:60]) from None
    return made
