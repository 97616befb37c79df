"""USD, by usd-core: layers are edited in place. New points and faces are added to the meshes that have the holes."""

from __future__ import annotations

import copy
import dataclasses
import functools
import os
import tempfile
from collections.abc import Hashable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .. import _arrays
from .._types import Array
from ..messages import Message
from . import evidence
from .mesh_file import MeshFile
from .scene import Addition, Part, SceneFile, blended
from .writing import FileError, damaged

_MARK = f"primvars:{evidence.FILL}"
_PER_POINT = ("vertex", "varying")


def _pxr(suffix: str) -> Any:
    try:
        from pxr import Sdf, Tf, Usd, UsdGeom, UsdUtils
    except ImportError:
        needed = {"what": suffix, "package": "usd-core", "install": "tripatch[usd]"}
        raise FileError(Message("package_needed", needed)) from None
    return dataclasses.make_dataclass("Modules", ["Sdf", "Tf", "Usd", "UsdGeom", "UsdUtils"])(Sdf, Tf, Usd, UsdGeom, UsdUtils)


@dataclasses.dataclass
class _Values:
    """What a mesh says of its points, corners or faces.

    Attributes:
        rows: (k, ...) values; at: for each point, corner or face its row; None: as they are.
        size: values of each point, corner or face.
        kind: the array type of USD.
    """

    name: str
    type_name: str
    interpolation: str
    rows: Array
    at: Array | None
    size: int
    kind: Any
    new: list[Any] = dataclasses.field(default_factory=list)

    def with_new(self, within: list[Array], places: list[int]) -> Array:
        """All rows. within: those of corners within edges, which come before the corners `places`."""
        rows, new = self.rows, np.array(self.new, self.rows.dtype).reshape(-1, *self.rows.shape[1:])
        if within and self.at is None:
            rows = np.insert(rows, places, within, axis=0)
        elif within:
            new = np.concatenate([new, np.array(within, rows.dtype)])
        return np.concatenate([rows, new])

    def row(self, k: int) -> Array:
        """Of a point, corner or face."""
        return np.asarray(self.rows[k if self.at is None else self.at[k]])


@dataclasses.dataclass
class _Mesh:
    """A mesh of the stage, and what is added to it."""

    path: str
    values: list[_Values]
    subsets: dict[str, Array]  # of each its faces
    marks: Array | None
    faces: list[list[int]] = dataclasses.field(default_factory=list)
    numbers: list[int] = dataclasses.field(default_factory=list)
    subset_faces: dict[str, list[int]] = dataclasses.field(default_factory=dict)
    said: list[dict[str, Any]] = dataclasses.field(default_factory=list)
    _sets: dict[str, frozenset[int]] = dataclasses.field(default_factory=dict)

    def subsets_of(self, face: int) -> list[str]:
        """The subsets that a face is in."""
        self._sets = self._sets or {name: frozenset(faces.tolist()) for name, faces in self.subsets.items()}
        return [name for name, faces in self._sets.items() if face in faces]


class UsdFile(SceneFile):
    """A USD layer: the meshes of its stage. Opinions about them go into this layer, however many layers the stage has."""

    def __init__(self, layer: Any, suffix: str, folder: Path | None, given: tuple[Array, Any] | None = None) -> None:
        self._pxr = _pxr(suffix)
        self._folder = folder
        self.suffix = suffix
        self._meshes: list[_Mesh] = []
        self._is_text = layer.GetFileFormat().formatId == "usda"
        self._layer = self._copied(layer)
        if folder:  # a layer without a name has no folder that its references could count from
            self._pxr.UsdUtils.ModifyAssetPaths(layer, functools.partial(_absolute, folder))
        parts = list(self._read(self._pxr.Usd.Stage.Open(layer)))
        super().__init__(parts, given)

    @classmethod
    def of_path(cls, path: Path) -> UsdFile:
        """Opens the layer, and those that it refers to."""
        modules = _pxr(path.suffix)
        if path.suffix.lower() == ".usdz":
            raise FileError(Message("package_in_place"))
        with path.open("rb") as file:
            is_text = not file.read(8).startswith(b"PXR-USDC")
        try:
            made = cls(modules.Sdf.Layer.OpenAsAnonymous(str(path.absolute())), path.suffix, path.parent.absolute())
        except (modules.Tf.ErrorException, AttributeError) as error:  # it says where in the code of USD
            raise damaged("USD") from error
        made._is_text = is_text
        return made

    @classmethod
    def of_mesh(cls, vertices: Array, faces: Any, suffix: str) -> UsdFile:
        """A stage of one mesh."""
        modules = _pxr(suffix)
        layer = modules.Sdf.Layer.CreateAnonymous("mesh.usda")
        stage = modules.Usd.Stage.Open(layer)
        mesh = modules.UsdGeom.Mesh.Define(stage, "/mesh")
        offsets, corners = _arrays.faces(faces)
        mesh.CreatePointsAttr(np.asarray(vertices, np.float32))
        mesh.CreateFaceVertexCountsAttr(np.diff(offsets).astype(np.int32))
        mesh.CreateFaceVertexIndicesAttr(corners.astype(np.int32))
        mesh.CreateSubdivisionSchemeAttr("none")
        stage.SetDefaultPrim(mesh.GetPrim())
        made = cls(layer, suffix, None, (vertices, faces))
        made._is_text = suffix.lower() == ".usda"
        return made

    @staticmethod
    def check_suffix(suffix: str) -> None:
        """Raises FileError if usd-core is missing, or for a package."""
        _pxr(suffix)
        if suffix.lower() == ".usdz":
            raise FileError(Message("suffix_unwritable", {"suffix": ".usdz", "suffixes": [".usdc", ".usda"]}))

    def _copied(self, layer: Any) -> Any:
        made = self._pxr.Sdf.Layer.CreateAnonymous("copy.usda")
        made.TransferContent(layer)
        return made

    def __deepcopy__(self, memo: dict[int, Any]) -> UsdFile:
        made = memo[id(self)] = object.__new__(type(self))
        vars(made).update(vars(self))
        for name in ("_about", "_split_faces", "_parts", "_corners", "_new_points"):
            setattr(made, name, copy.deepcopy(getattr(self, name), memo))
        made._meshes = []
        for mesh in self._meshes:
            values = [dataclasses.replace(each, new=list(each.new)) for each in mesh.values]
            lists: dict[str, Any] = {name: list(getattr(mesh, name)) for name in ("faces", "numbers", "said")}
            subsets = {name: list(rows) for name, rows in mesh.subset_faces.items()}
            made._meshes.append(dataclasses.replace(mesh, values=values, subset_faces=subsets, **lists))
        made._layer = self._copied(self._layer)
        return made

    # what it holds

    def _read(self, stage: Any) -> Iterator[Part]:
        geom = self._pxr.UsdGeom
        placed = geom.XformCache()
        for prim in stage.Traverse():
            if not prim.IsA(geom.Mesh):
                continue
            mesh = geom.Mesh(prim)
            shape = mesh.GetPointsAttr(), mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()
            if any(attribute.GetNumTimeSamples() for attribute in shape):
                raise FileError(Message("data_animated", {"path": str(prim.GetPath())}))
            points, counts, corners = (attribute.Get() for attribute in shape)
            if not points or not counts or not corners:
                continue
            points, counts, corners = np.array(points, float), np.array(counts, np.int64), np.array(corners, np.int64)
            if counts.min() < 0 or counts.sum() != len(corners) or corners.min() < 0 or corners.max() >= len(points):
                raise FileError(Message("face_without_vertex", {"name": str(prim.GetPath())}))
            subsets = {}
            for child in geom.Subset.GetAllGeomSubsets(mesh):
                if child.GetElementTypeAttr().Get() == "face" and not child.GetIndicesAttr().GetNumTimeSamples():
                    subsets[str(child.GetPath())] = np.array(child.GetIndicesAttr().Get() or [], np.int64)
            marks = geom.PrimvarsAPI(prim).GetPrimvar(evidence.FILL)
            own = np.array(marks.Get(), np.int64) if marks and marks.Get() is not None else None
            self._meshes.append(_Mesh(str(prim.GetPath()), list(self._values(mesh, len(points), counts)), subsets, own))
            matrix = np.array(placed.GetLocalToWorldTransform(prim)).T
            flipped = mesh.GetOrientationAttr().Get() == geom.Tokens.leftHanded
            yield Part(points, np.concatenate([[0], np.cumsum(counts)]), corners, matrix, flipped)

    def _values(self, mesh: Any, points: int, counts: Array) -> Iterator[_Values]:
        """What a mesh has by point, corner or face."""
        geom = self._pxr.UsdGeom
        wanted = {"vertex": points, "varying": points, "faceVarying": int(counts.sum()), "uniform": len(counts)}
        found = [(mesh.GetNormalsAttr(), mesh.GetNormalsInterpolation(), 1, None)]
        found += [(attribute, "vertex", 1, None) for attribute in (mesh.GetVelocitiesAttr(), mesh.GetAccelerationsAttr())]
        for each in geom.PrimvarsAPI(mesh).GetPrimvars():
            indices = each.GetIndices() if each.IsIndexed() else None
            found.append((each.GetAttr(), each.GetInterpolation(), each.GetElementSize(), indices))
        for attribute, interpolation, size, indices in found:
            values = attribute.Get() if attribute and attribute.HasAuthoredValue() else None
            if values is None or interpolation not in wanted or attribute.GetName() == _MARK:
                continue
            if attribute.GetNumTimeSamples():
                raise FileError(Message("data_animated", {"path": str(attribute.GetPath())}))
            rows = np.array(values)
            if len(rows) % size == 0:
                rows = rows.reshape(-1, size, *rows.shape[1:]) if size > 1 else rows
                at = None if indices is None else np.array(indices, np.int64)
                count = len(rows) if at is None or at.max(initial=0) >= len(rows) else len(at)
                if count == wanted[interpolation]:
                    type_name = str(attribute.GetTypeName())
                    yield _Values(attribute.GetName(), type_name, interpolation, rows, at, size, type(values))

    def _look(self, f: int) -> Hashable:
        mesh, k = self._meshes[int(self._part_of_face[f])], int(self._number_in_part[f])
        by_face = [each for each in mesh.values if each.interpolation == "uniform" and each.name != "normals"]
        return tuple(mesh.subsets_of(k)), tuple(each.row(k).tobytes() for each in by_face)

    def _by_corner(self, f: int, name: str) -> Array | None:
        part, k = int(self._part_of_face[f]), int(self._number_in_part[f])
        each = next((value for value in self._meshes[part].values if value.name == name), None)
        if each is None or each.interpolation != "faceVarying" or each.rows.dtype.kind != "f":
            return None
        first, end = self._parts[part].offsets[k : k + 2]
        rows = [np.ravel(each.row(c)).astype(float) for c in range(first, end)]
        return np.array(self._blended_corners(f, rows[:: -1 if self._parts[part].flipped else 1]))

    def _shares(self, number: int) -> bool:
        return not any(each.interpolation in _PER_POINT for each in self._meshes[number].values)

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        part, mesh = self._parts[int(self._part_of_face[f])], self._meshes[int(self._part_of_face[f])]
        count = len(part.added)
        super()._split(f, place, v, t)
        for own in range(len(part.points) + count, len(part.points) + len(part.added)):
            for each in mesh.values:
                if each.interpolation in _PER_POINT:
                    each.new.append(part.value(own, each.row))

    # what is added

    def _add(self, new: Addition) -> None:
        mesh, part = self._meshes[new.number], new.part
        numbers, added = new.own_vertices()
        first = len(part.offsets) - 1 + len(mesh.faces)
        mesh.faces += [[numbers[v] for v in face] for face in new.faces]
        mesh.numbers += [self._number] * len(new.faces)
        for name in mesh.subsets_of(int(self._number_in_part[new.models[0]])):
            mesh.subset_faces.setdefault(name, []).extend(range(first, first + len(new.faces)))
        normals = new.normals()
        for each in mesh.values:
            each.new += self._continued(new, each, added, normals)
        mesh.said.append({**new.said(), "first_face": first, "faces_here": len(new.faces)})

    def _continued(self, new: Addition, each: _Values, added: list[int], normals: dict[int, Array]) -> list[Any]:
        """Rows of new points, corners or faces."""
        if each.interpolation == "uniform":
            if each.name == "normals":
                return [_unit(np.sum([normals[v] for v in face], axis=0)) for face in new.faces]
            return [each.row(int(self._number_in_part[f])) for f in new.models]
        per_corner = [v for face in new.faces for v in face]
        if each.name in ("normals", "primvars:normals"):
            return [normals.get(v, np.zeros(3)) for v in (added if each.interpolation in _PER_POINT else per_corner)]
        if each.interpolation == "faceVarying":
            values = new.at_corners(lambda f: self._by_corner(f, each.name))
            if values:
                return [np.reshape(row, each.rows.shape[1:]) for face in values for row in face]
            near = self._nearest(new, each)
            return [near[v] for v in per_corner]
        near = self._nearest(new, each)
        if each.rows.dtype.kind != "f" or each.size > 1 or not len(new.fill.rim):
            return [near[v] for v in added]
        inside = new.continued.at_vertices(lambda rim: np.array([np.ravel(near[int(v)]) for v in rim]))
        return [near[v] if v < new.n else np.reshape(inside[v - new.n], each.rows.shape[1:]) for v in added]

    def _nearest(self, new: Addition, each: _Values) -> dict[int, Array]:
        """For every vertex of the fill the value of a rim vertex nearby."""
        at_rim: dict[int, Array] = {}
        for v in {*map(int, new.fill.rim), *(v for face in new.faces for v in face if v < new.n)}:
            own = {f: c for f, c in self._copies(v).items() if self._part_of_face[f] == new.number}
            at_rim[v] = np.zeros(each.rows.shape[1:], each.rows.dtype)
            for f, c in own.items():
                k = int(self._number_in_part[f])
                if each.interpolation in _PER_POINT:
                    at_rim[v] = new.part.value(c, each.row)
                else:
                    first, end = new.part.offsets[k : k + 2]
                    rows = [each.row(k) for k in range(first, end)][:: -1 if new.part.flipped else 1]
                    at_rim[v] = self._blended_corners(f, rows)[self._own_face(f).index(c)]
        near = new.continued.near
        return at_rim | {new.n + k: at_rim[int(near[k])] for k in range(len(new.fill.vertices)) if len(new.fill.rim)}

    # what is written

    def marked(self) -> MeshFile:
        """The same file, whose meshes will say of each face of which fill it is, and the rest in their custom data."""
        super().marked()
        self._number = max((int(mesh.marks.max(initial=0)) for mesh in self._meshes if mesh.marks is not None), default=0)
        return self

    @property
    def fill_faces(self) -> Array:
        """(m,) bool: which faces are fills by TriPatch."""
        found = np.zeros(len(self.faces), bool)
        for n, mesh in enumerate(self._meshes):
            mine = np.flatnonzero(self._part_of_face == n)
            own = self._number_in_part[mine]
            if mesh.marks is not None and len(mesh.marks) > own.max(initial=0):
                found[mine] = mesh.marks[own] > 0
        return found

    def stripped(self) -> bytes:
        """A USD layer does not keep how it was."""
        raise FileError(Message("original_not_kept", {"suffix": self.suffix}))

    def _save(self, path: Path) -> None:
        layer = self._copied(self._layer)
        for mesh, part in zip(self._meshes, self._parts, strict=True):
            if mesh.faces or part.moved or any(self._parts[self._part_of_face[f]] is part for f in self._corners):
                self._write(layer, mesh, part)
        if self._folder and path.parent.absolute() != self._folder:
            self._pxr.UsdUtils.ModifyAssetPaths(layer, lambda asset: _moved(asset, self._folder, path.parent.absolute()))
        suffix = self.suffix.lower() if self.suffix.lower() in (".usda", ".usdc") else ".usda" if self._is_text else ".usdc"
        with tempfile.TemporaryDirectory() as folder:
            made = Path(folder, f"layer{suffix}")
            if not layer.Export(str(made)):
                raise FileError(Message("package_cannot_write", {"package": "usd-core", "suffix": suffix}))
            path.write_bytes(made.read_bytes())

    def _corners_by_now(self, part: Part) -> tuple[Array, Array, list[tuple[int, int, int, float]]]:
        """Of the file's own faces the counts and corners; of corners within edges which corner of the file they come before,
        between which two they are, and which part of the way."""
        counts, corners = np.diff(part.offsets), part.corners.copy()
        found = []
        for f in (f for f in self._corners if self._parts[self._part_of_face[f]] is part):
            k = int(self._number_in_part[f])
            first, size = int(part.offsets[k]), int(counts[k])
            for own, at in self._corners_of(f):
                c = (size - 1 - at) % size if part.flipped else at
                if c % 1:
                    found.append((first + c, own, first + int(c), first + (int(c) + 1) % size))
                else:
                    corners[first + int(c)] = own
            counts[k] = len(self._corners_of(f))
        found.sort()
        corners = np.insert(corners, [a + 1 for _, _, a, _ in found], [own for _, own, _, _ in found]) if found else corners
        return counts, corners, [(a + 1, a, b, c % 1) for c, _, a, b in found]

    def _write(self, layer: Any, mesh: _Mesh, part: Part) -> None:
        sdf = self._pxr.Sdf
        prim = sdf.CreatePrimInLayer(layer, mesh.path)
        points = np.concatenate([part.points, np.reshape(part.added, (-1, 3))])
        own_counts, own_corners, within = self._corners_by_now(part)
        counts = [*own_counts.tolist(), *map(len, mesh.faces)]
        corners = [*own_corners.tolist(), *(v for face in mesh.faces for v in face)]
        _set(sdf, prim, "points", "point3f[]", points.astype(np.float32))
        _set(sdf, prim, "faceVertexCounts", "int[]", np.array(counts, np.int32))
        _set(sdf, prim, "faceVertexIndices", "int[]", np.array(corners, np.int32))
        _set(sdf, prim, "extent", "float3[]", np.array([points.min(axis=0), points.max(axis=0)], np.float32))
        for each in mesh.values:
            more = [blended(each.row(a), each.row(b), t) for _, a, b, t in within] if each.interpolation == "faceVarying" else []
            rows = each.with_new(more, [place for place, *_ in within])
            _set(sdf, prim, each.name, each.type_name, rows.reshape(-1, *each.rows.shape[2:]) if each.size > 1 else rows)
            if each.at is not None:
                count = len(each.rows) + len(each.new)
                at = np.insert(each.at, [place for place, *_ in within][: len(more)], count + np.arange(len(more)))
                at = np.concatenate([at, len(each.rows) + np.arange(len(each.new))])
                _set(sdf, prim, f"{each.name}:indices", "int[]", at.astype(np.int32))
        for name, faces in mesh.subset_faces.items():
            own = np.concatenate([mesh.subsets[name], faces]).astype(np.int32)
            _set(sdf, sdf.CreatePrimInLayer(layer, name), "indices", "int[]", own)
        if self._marks:
            old = np.zeros(len(part.offsets) - 1, np.int64) if mesh.marks is None else mesh.marks
            attribute = _set(sdf, prim, _MARK, "int[]", np.concatenate([old, mesh.numbers]).astype(np.int32))
            attribute.SetInfo("interpolation", "uniform")
            said = dict(prim.customData.get("tripatch", {}))
            for about in mesh.said:
                said[f"fill_{about['fill']}"] = {name: value for name, value in about.items() if value is not None}
            prim.customData["tripatch"] = said


def _set(sdf: Any, prim: Any, name: str, type_name: str, values: Array) -> Any:
    attribute = prim.attributes.get(name) or sdf.AttributeSpec(prim, name, sdf.ValueTypeNames.Find(type_name))
    kind = attribute.typeName.type.pythonClass
    attribute.default = kind.FromNumpy(np.ascontiguousarray(values)) if values.dtype.kind in "fiub" else kind(values.tolist())
    return attribute


def _absolute(folder: Path, asset: str) -> str:
    """The path of a file that is there, by its root."""
    return (folder / asset).as_posix() if asset and (folder / asset).exists() else asset


def _moved(asset: str, before: Path | None, after: Path) -> str:
    """The path of a file from another folder."""
    if before is None or not asset or os.path.isabs(asset) or "://" in asset or not Path(before, asset).exists():
        return asset
    moved = Path(os.path.relpath(Path(before, asset), after)).as_posix()
    return moved if moved.startswith(".") else f"./{moved}"


def _unit(vector: Array) -> Array:
    return np.asarray(vector / max(float(np.linalg.norm(vector)), 1e-300))
