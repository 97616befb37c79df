"""glTF 2.0, as GLB and as JSON. New faces are primitives next to the old ones; what was there stays as it is, to the byte.

pygltflib and the like leave out what they do not know, so that the JSON is edited here.
"""

from __future__ import annotations

import base64
import copy
import dataclasses
import json
import os
import struct
import urllib.parse
import zlib
from collections.abc import Hashable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .. import quality
from .._types import Array
from ..messages import Message
from . import evidence
from .gltf_buffers import BIN, JSON, KINDS, WIDTHS, Writer, as_uri, dumped, glb
from .mesh_file import MeshFile
from .scene import Addition, Part, SceneFile
from .writing import FileError, damaged, unreadable

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")
#: Of the primitive whose material new faces have: what it says of the primitive as a whole.
_KEPT_EXTENSIONS = ("KHR_materials_variants",)
_OF_JOINTS = ("JOINTS_", "WEIGHTS_")  # what names joints, which numbers between two would not
_ORIGINAL = "tripatch_original"


@dataclasses.dataclass
class _Rows:
    """New faces of one primitive to be: vertices as rows of attributes."""

    attributes: dict[str, list[Array]] = dataclasses.field(default_factory=dict)
    targets: list[dict[str, list[Array]]] = dataclasses.field(default_factory=list)
    triangles: list[list[int]] = dataclasses.field(default_factory=list)
    count: int = 0
    said: list[dict[str, Any]] = dataclasses.field(default_factory=list)


class GltfFile(SceneFile):
    """glTF 2.0: the triangles of all meshes, each where the first node that uses it has it in the scene."""

    def __init__(self, data: bytes, folder: Path | None = None, given: tuple[Array, Any] | None = None) -> None:
        self._data, self._folder = data, folder
        self._bin: bytes | None = None
        self._rest = b""
        self._text = self._chunks() if data[:4] == b"glTF" else data
        try:
            self._json = json.loads(self._text.rstrip(b"\0").decode("utf-8-sig"))
            if not str(self._json["asset"]["version"]).startswith("2."):
                said = {"format": "glTF", "version": str(self._json["asset"]["version"]), "known": "2.0"}
                raise FileError(Message("version_unreadable", said))
        except (ValueError, KeyError, TypeError):
            raise damaged("glTF") from None
        used = json.dumps([self._json.get("meshes"), self._json.get("bufferViews")])
        packed = next((name for name in _COMPRESSED if f'"{name}"' in used), None)
        if packed:
            raise FileError(Message("meshes_compressed", {"extension": packed}))
        self._groups: dict[tuple[int, int], _Rows] = {}
        self._buffers: dict[int, bytes] = {}
        self._primitives: list[Array] = []  # of each part the primitive of each of its faces
        self._bases: list[dict[int, int]] = []  # and of each primitive its first vertex
        self._meshes: list[int] = []
        try:
            parts = list(self._read())
        except (LookupError, TypeError, ValueError, AttributeError, RecursionError) as error:
            if isinstance(error, FileError):
                raise
            raise damaged("glTF", f"{type(error).__name__}: {error}") from None
        self._decoded_cache: dict[int, Array] = {}
        super().__init__(parts, given)

    @classmethod
    def of_path(cls, path: Path) -> GltfFile:
        """Reads the file, and the buffers that it names."""
        made = cls(path.read_bytes(), path.parent.absolute())
        made.suffix = path.suffix
        return made

    @classmethod
    def of_mesh(cls, vertices: Array, faces: Any, suffix: str) -> GltfFile:
        """A scene of one mesh."""
        triangles, _ = quality.triangulated(faces, vertices)
        points, indices = np.asarray(vertices, "<f4"), np.asarray(triangles, "<u4")
        data = points.tobytes() + indices.tobytes()
        views = [{"buffer": 0, "byteLength": points.nbytes, "target": 34962}]
        views.append({"buffer": 0, "byteOffset": points.nbytes, "byteLength": indices.nbytes, "target": 34963})
        accessors: list[dict[str, Any]] = [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"}]
        accessors.append({"bufferView": 1, "componentType": 5125, "count": indices.size, "type": "SCALAR"})
        if len(points):
            accessors[0] |= {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
        said = {"asset": {"version": "2.0", "generator": "TriPatch"}, "scene": 0, "scenes": [{"nodes": [0]}]}
        said |= {"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]}
        said |= {"buffers": [{"byteLength": len(data)}], "bufferViews": views, "accessors": accessors}
        if suffix.lower() == ".gltf":
            said["buffers"][0]["uri"] = as_uri(data)  # type: ignore[index]
            return cls(dumped(said, b"{\n"), None, (vertices, triangles))
        return cls(glb(dumped(said, b"{"), data, b""), None, (vertices, triangles))

    def _chunks(self) -> bytes:
        """The JSON of a GLB; its buffer is kept, and what follows."""
        data = self._data
        if len(data) < 20 or struct.unpack_from("<I", data, 4)[0] != 2:
            raise damaged("GLB")
        length, kind = struct.unpack_from("<II", data, 12)
        if kind != JSON or 20 + length > len(data):
            raise damaged("GLB")
        end = 20 + length
        self._rest = data[end:]
        if len(self._rest) >= 8:
            size, kind = struct.unpack_from("<II", self._rest)
            if kind == BIN:
                if 8 + size > len(self._rest):
                    said = {"format": "GLB", "announced": size, "held": len(self._rest) - 8}
                    raise FileError(Message("file_ends_early", said))
                self._bin, self._rest = self._rest[8 : 8 + size], self._rest[8 + size :]
        return data[20:end]

    # what it holds

    def _read(self) -> Iterator[Part]:
        for mesh, matrix in self._places().items():
            points, corners, owners, bases, count = [], [], [], {}, 0
            for p, primitive in enumerate(self._json["meshes"][mesh]["primitives"]):
                if primitive.get("mode", _TRIANGLES) < _TRIANGLES or "POSITION" not in primitive["attributes"]:
                    continue
                own = self._decoded(primitive["attributes"]["POSITION"])
                triangles = self._triangles(primitive, len(own))
                if triangles.size and triangles.max() >= len(own):
                    raise FileError(Message("face_without_vertex", {"name": f"meshes[{mesh}]"}))
                points.append(own)
                corners.append(triangles.ravel() + count)
                owners.append(np.full(len(triangles), p))
                bases[p] = count
                count += len(own)
            if points:
                whole = np.concatenate(corners)
                self._meshes.append(mesh)
                self._bases.append(bases)
                self._primitives.append(np.concatenate(owners))
                yield Part(np.concatenate(points), np.arange(0, len(whole) + 1, 3), whole, matrix)

    def _places(self) -> dict[int, Array | None]:
        """Each mesh, with the matrix of the first node that uses it."""
        nodes, found = self._json.get("nodes", []), dict[int, Any]()
        scenes = self._json.get("scenes") or [{"nodes": list(range(len(nodes)))}]
        todo = [(k, np.eye(4)) for k in scenes[self._json.get("scene", 0)].get("nodes", [])][::-1]
        seen: set[int] = set()
        while todo:
            k, above = todo.pop()
            if k in seen:
                continue
            seen.add(k)
            own = above @ _matrix(nodes[k])
            if "mesh" in nodes[k]:  # the vertices of a mesh with a skin are where its joints have them
                found.setdefault(nodes[k]["mesh"], None if "skin" in nodes[k] else own)
            todo += [(child, own) for child in reversed(nodes[k].get("children", []))]
        return found | {k: None for k in range(len(self._json.get("meshes", []))) if k not in found}

    def _triangles(self, primitive: dict[str, Any], count: int) -> Array:
        order = self._accessor(primitive["indices"])[:, 0].astype(np.int64) if "indices" in primitive else np.arange(count)
        mode = primitive.get("mode", _TRIANGLES)
        if mode == _TRIANGLES:
            return order[: len(order) // 3 * 3].reshape(-1, 3)
        k = np.arange(max(len(order) - 2, 0))
        if mode == _FAN:
            return np.column_stack([np.broadcast_to(order[:1], len(k)), order[k + 1], order[k + 2]])
        return np.column_stack([order[k], order[k + 1 + k % 2], order[k + 2 - k % 2]])

    def _buffer(self, k: int) -> bytes:
        if k not in self._buffers:
            buffer = self._json["buffers"][k]
            self._buffers[k] = self._content(buffer["uri"]) if "uri" in buffer else self._bin or b""
        return self._buffers[k]

    def _content(self, uri: str) -> bytes:
        if uri.startswith("data:"):
            head, _, data = uri.partition(",")
            return base64.b64decode(data) if head.endswith(";base64") else urllib.parse.unquote_to_bytes(data)
        path = Path(self._folder or ".", urllib.parse.unquote(uri))
        try:
            return path.read_bytes()
        except OSError as error:
            raise unreadable(path, error) from error

    def _accessor(self, k: int) -> Array:
        """(count, width) as it is stored."""
        said = self._json["accessors"][k]
        kind, width = np.dtype(KINDS[said["componentType"]]), WIDTHS[said["type"]]
        shape = (int(said["count"]), width)
        values = np.zeros(shape, kind)
        if "bufferView" in said and shape[0]:
            values = self._viewed(said["bufferView"], said.get("byteOffset", 0), shape, kind)
        if "sparse" in said:
            sparse, values = said["sparse"], values.copy()
            at, of = sparse["indices"], sparse["values"]
            kind_at = np.dtype(KINDS[at["componentType"]])
            rows = self._viewed(at["bufferView"], at.get("byteOffset", 0), (sparse["count"], 1), kind_at)[:, 0]
            values[rows] = self._viewed(of["bufferView"], of.get("byteOffset", 0), (sparse["count"], width), kind)
        return values

    def _viewed(self, k: int, offset: int, shape: tuple[int, int], kind: np.dtype[Any]) -> Array:
        view = self._json["bufferViews"][k]
        stride = view.get("byteStride") or kind.itemsize * shape[1]
        start = view.get("byteOffset", 0) + offset
        return np.ndarray(shape, kind, self._buffer(view["buffer"]), start, (stride, kind.itemsize))

    def _decoded(self, k: int) -> Array:
        """(count, width) of floats, as a program that draws it has them."""
        values = self._accessor(k)
        if values.dtype.kind == "f" or not self._json["accessors"][k].get("normalized"):
            return values.astype(float)
        return np.maximum(values / np.iinfo(values.dtype).max, -1.0)

    # what is added

    def _primitive_of(self, f: int) -> tuple[int, int]:
        """Of a face its part and primitive."""
        part = int(self._part_of_face[f])
        return part, self._primitive_at(part, self._file_face(f)[0])

    def _primitive_at(self, part: int, own: int) -> int:
        own = self._parts[part].between.get(own, (own,))[0]
        return max((p for p, base in self._bases[part].items() if base <= own), key=lambda p: self._bases[part][p])

    def _look(self, f: int) -> Hashable:
        return self._primitive_of(f)

    def _attribute(self, part: int, primitive: int, name: str, target: int = -1) -> Array | None:
        said = self._json["meshes"][self._meshes[part]]["primitives"][primitive]
        of = said["attributes"] if target < 0 else said["targets"][target]
        if name not in of:
            return None
        if of[name] not in self._decoded_cache:
            self._decoded_cache[of[name]] = self._decoded(of[name])
        return self._decoded_cache[of[name]]

    def _value(self, part: int, own: int, name: str, target: int = -1) -> Array | None:
        """Of an own vertex of a part."""
        primitive = self._primitive_at(part, own)
        values, base = self._attribute(part, primitive, name, target), self._bases[part][primitive]
        if values is None:
            return None
        return self._parts[part].value(own, lambda v: np.asarray(values[v - base]), not name.startswith(_OF_JOINTS))

    def _by_corner(self, f: int, name: str) -> Array | None:
        part = int(self._part_of_face[f])
        values = [self._value(part, own, name) for own in self._own_face(f)]
        return None if any(value is None for value in values) else np.array(values)

    def _at_rim(self, v: int, name: str, target: int, like: int, width: int) -> Array:
        """Of a vertex of the scene, preferably of the copy that a primitive like that of face `like` has."""
        kind, found = self._look(like), np.zeros(width)
        copies = sorted(self._copies(v).items(), key=lambda copy: self._look(copy[0]) != kind)
        for f, own in copies:
            part, primitive = self._primitive_of(f)
            said = self._json["meshes"][self._meshes[part]]["primitives"][primitive]
            if target < 0 or target < len(said.get("targets", ())):
                value = self._value(part, own, name, target)
                if value is not None and len(value) == width:
                    return value
        return found

    def _add(self, new: Addition) -> None:
        like = new.models[0]
        part, primitive = self._primitive_of(like)
        group = self._groups.setdefault((part, primitive), _Rows())
        said = self._json["meshes"][self._meshes[part]]["primitives"][primitive]
        names = [name for name in said["attributes"] if name.startswith("TEXCOORD_")]
        textures = {name: new.at_corners(lambda f, name=name: self._by_corner(f, name)) for name in names}
        rows: dict[tuple[int, bytes], int] = {}
        corners: list[tuple[int, int, int]] = []  # of each row its vertex, and a face and place where it is
        places = []
        for k, face in enumerate(new.faces):
            own = []
            for c, v in enumerate(face):
                key = v, b"".join(values[k][c].astype("<f4").tobytes() for values in textures.values() if values)
                if key not in rows:
                    rows[key] = group.count + len(rows)
                    corners.append((v, k, c))
                own.append(rows[key])
            places.append(own)
        first = len(group.triangles)
        group.triangles += [[places[k][c] for c in at] for k, at in new.triangles()]
        vertices = [v for v, _, _ in corners]
        normals = new.normals()
        for name, accessor in said["attributes"].items():
            if name == "POSITION":
                values = np.array([new.place_of(v) for v in vertices])
            elif name == "NORMAL":
                values = np.array([normals.get(v, np.zeros(3)) for v in vertices])
            elif name == "TANGENT":
                continue  # follows from normals and texture coordinates
            elif textures.get(name):
                values = np.array([textures[name][k][c] for _, k, c in corners])  # type: ignore[index]
            else:
                values = self._continued(new, vertices, name, accessor)
            group.attributes.setdefault(name, []).append(values)
        for t, target in enumerate(said.get("targets", ())):
            if len(group.targets) <= t:
                group.targets.append({})
            for name, accessor in target.items():
                if name != "TANGENT":
                    group.targets[t].setdefault(name, []).append(self._continued(new, vertices, name, accessor, t))
        group.count += len(rows)
        group.said.append({**new.said(), "first_face": first, "faces_here": len(group.triangles) - first})

    def _continued(self, new: Addition, vertices: list[int], name: str, accessor: int, target: int = -1) -> Array:
        """An attribute of rows: at the rim as it is there, inside blended; what names joints is that of a rim vertex nearby."""
        like, n, width = new.models[0], new.n, WIDTHS[self._json["accessors"][accessor]["type"]]
        old = {*map(int, new.fill.rim), *(v for v in vertices if v < n)}
        rim = {v: self._at_rim(v, name, target, like, width) for v in old}
        near = new.continued.near
        if name.startswith(_OF_JOINTS) or not len(new.fill.rim):
            return np.array([rim[v] if v < n else rim[int(near[v - n])] for v in vertices])
        inside = new.continued.at_vertices(lambda at: np.array([rim[int(v)] for v in at]))
        return np.array([rim[v] if v < n else inside[v - n] for v in vertices])

    # what is written

    def marked(self) -> MeshFile:
        """The same file, whose new primitives will say in their extras which fills they hold."""
        super().marked()
        self._number = max((said["fill"] for _, extras in self._extras() for said in extras.get(evidence.FILL, ())), default=0)
        return self

    def _extras(self) -> Iterator[tuple[Any, dict[str, Any]]]:
        """Primitives with what their extras say."""
        for mesh in self._json.get("meshes", []):
            for primitive in mesh["primitives"]:
                extras = primitive.get("extras")
                if isinstance(extras, dict) and isinstance(extras.get(evidence.FILL), list):
                    yield primitive, extras

    @property
    def fill_faces(self) -> Array:
        """(m,) bool: which faces are fills by TriPatch."""
        marked = {id(primitive) for primitive, _ in self._extras()}
        found = np.zeros(len(self.faces), bool)
        for n, (mesh, own) in enumerate(zip(self._meshes, self._primitives, strict=True)):
            fills = [p for p, each in enumerate(self._json["meshes"][mesh]["primitives"]) if id(each) in marked]
            mine = self._part_of_face == n
            found[mine] = np.isin(own[self._number_in_part[mine]], fills)
        return found

    def stripped(self) -> bytes:
        """The file as it was before its fills."""
        before = next((extras[_ORIGINAL] for _, extras in self._extras() if _ORIGINAL in extras), None)
        if before is None:
            raise FileError(Message("no_fills_in_file"))
        view = self._json["bufferViews"][before["bufferView"]]
        start = view.get("byteOffset", 0)
        text = zlib.decompress(self._buffer(view["buffer"])[start : start + view["byteLength"]])
        if self._data[:4] != b"glTF":
            return evidence.original([text], before["sha256"])
        data = None if before["bin"] is None or self._bin is None else self._bin[: before["bin"]]
        return evidence.original([glb(text, data, self._rest)], before["sha256"])

    def _save(self, path: Path) -> None:
        said = copy.deepcopy(self._json)
        moved = self._repoint(said, path.parent.absolute())
        if not self._groups and not any(part.moved or part.between for part in self._parts):
            path.write_bytes(self._as_file(said, self._bin) if moved else self._data)
            return
        in_bin = self._bin is not None and "uri" not in said["buffers"][0]
        out = Writer(said, (self._bin or b"") if in_bin else b"", 0 if in_bin else len(said.setdefault("buffers", [])))
        before = None
        if self._marks and self._groups and not any(_ORIGINAL in extras for _, extras in self._extras()):
            before = {"bin": None if self._bin is None else len(self._bin), "sha256": evidence.sha256(self._data)}
            before["bufferView"] = out.view(zlib.compress(self._text, 9))
        self._rewrite(out, said)
        for (part, primitive), group in self._groups.items():
            primitives = said["meshes"][self._meshes[part]]["primitives"]
            primitives.append(self._primitive(out, primitives[primitive], group))
            if before:
                primitives[-1]["extras"][_ORIGINAL], before = before, None
        path.write_bytes(self._as_file(said, out.finish() if in_bin else out.as_uri(self._bin)))

    def _rewrite(self, out: Writer, said: dict[str, Any]) -> None:
        """Of primitives that have changed: positions, and what goes with vertices within edges, are written behind all else."""
        changed: dict[tuple[int, int], list[int]] = {}  # own vertices within edges
        for n, part in enumerate(self._parts):
            for own in part.moved:
                changed.setdefault((n, self._primitive_at(n, own)), [])
            for own in part.between:
                changed.setdefault((n, self._primitive_at(n, own)), []).append(own)
        for (n, p), added in changed.items():
            part, primitive = self._parts[n], said["meshes"][self._meshes[n]]["primitives"][p]
            count, base = said["accessors"][primitive["attributes"]["POSITION"]]["count"], self._bases[n][p]
            for target, attributes in enumerate([primitive["attributes"], *primitive.get("targets", ())], -1):
                for name in attributes:
                    at_first = name == "POSITION" and target < 0
                    if at_first or added:
                        old = np.asarray(part.points[base : base + count] if at_first else self._attribute(n, p, name, target))
                        new: list[Any] = [part.point(v) if at_first else self._value(n, v, name, target) for v in added]
                        rows = np.reshape(new, (len(new), old.shape[1]))
                        attributes[name] = out.attribute(name, np.concatenate([old, rows]))
            if added:
                primitive["indices"] = out.indices(self._triangles_by_now(n, p, added, count), count + len(added))
                primitive.pop("mode", None)

    def _triangles_by_now(self, n: int, p: int, added: list[int], count: int) -> Array:
        """Of a primitive, by its own vertices; added: its vertices within edges, which follow the others."""
        base, mine = self._bases[n][p], np.flatnonzero(self._primitives[n] == p)
        number = dict(zip(added, range(count, count + len(added)), strict=True))
        triangles, more = self._parts[n].corners.reshape(-1, 3)[mine] - base, []
        for f in self._corners:
            if self._primitive_of(f) == (n, p):
                face = np.array([number.get(v, v - base) for v in self._own_face(f)])
                triangles[self._number_in_part[f] - mine[0]], *rest = face[self._cut(f)]
                more += rest
        return np.concatenate([triangles, np.reshape(more, (-1, 3)).astype(np.int64)])

    def _primitive(self, out: Writer, like: dict[str, Any], group: _Rows) -> dict[str, Any]:
        made: dict[str, Any] = {"attributes": {}}
        for name, values in group.attributes.items():
            made["attributes"][name] = out.attribute(name, np.concatenate(values))
        made["indices"] = out.indices(group.triangles, group.count)
        if "material" in like:
            made["material"] = like["material"]
        if group.targets:
            made["targets"] = []
            for each in group.targets:
                made["targets"].append({name: out.attribute(name, np.concatenate(rows)) for name, rows in each.items()})
        kept = {name: value for name, value in like.get("extensions", {}).items() if name in _KEPT_EXTENSIONS}
        if kept:
            made["extensions"] = copy.deepcopy(kept)
        if self._marks:
            made["extras"] = {evidence.FILL: group.said}
        return made

    def _as_file(self, said: dict[str, Any], data: bytes | None) -> bytes:
        text = dumped(said, self._text)
        return glb(text, data, self._rest) if self._data[:4] == b"glTF" else text

    def _repoint(self, said: dict[str, Any], folder: Path) -> bool:
        """Has the file name its buffers and images from another folder; whether one is named so."""
        moved = False
        for each in [*said.get("buffers", ()), *said.get("images", ())]:
            uri = each.get("uri", "data:")
            if self._folder and folder != self._folder and not urllib.parse.urlparse(uri).scheme:
                path = os.path.relpath(Path(self._folder, urllib.parse.unquote(uri)), folder)
                each["uri"] = urllib.parse.quote(Path(path).as_posix())
                moved = True
        return moved


def _matrix(node: dict[str, Any]) -> Array:
    """From a node's own coordinates to those above."""
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    made = np.eye(4)
    made[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), float)
    made[:3, 3] = node.get("translation", (0, 0, 0))
    return made
