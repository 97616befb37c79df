"""VTK and what else meshio reads and writes."""

from __future__ import annotations

import contextlib
import io
import re
import warnings
from collections.abc import Hashable
from pathlib import Path
from typing import Any

import numpy as np

from .._types import Array
from ..messages import Message
from .continued import Continued
from .evidence import FILL
from .mesh_file import MeshFile
from .writing import FileError, damaged


def _meshio(suffix: str) -> Any:
    try:
        import meshio
    except ImportError:
        needed = {"what": suffix, "package": "meshio", "install": "tripatch[files]"}
        raise FileError(Message("package_needed", needed)) from None
    return meshio


#: Formats that have a place for any number of a cell.
_WITH_MARKS = (".vtk", ".vtu", ".xdmf")
#: What is read and written without meshio.
_KNOWN = [".obj", ".ply", ".stl", ".off", ".glb", ".gltf", ".3mf", ".usd"]
_SURFACE_CELLS = ("triangle", "quad", "polygon")


class MeshioFile(MeshFile):
    """What meshio reads: points, cells of all kinds, and the data of both."""

    def __init__(self, mesh: Any, suffix: str, options: dict[str, Any]) -> None:
        self._mesh, self._suffix, self._options = mesh, suffix, options
        points = np.asarray(mesh.points, float)
        if points.ndim != 2 or points.shape[1] not in (2, 3):
            raise FileError(Message("file_lacks_mesh", {"format": suffix}))
        if points.shape[1] == 2:
            points = np.column_stack([points, np.zeros(len(points))])
        faces, self._cell_of = [], []
        for b, block in enumerate(mesh.cells):
            if block.type in _SURFACE_CELLS:
                faces += np.asarray(block.data).tolist()
                self._cell_of += [(b, k) for k in range(len(block.data))]
        super().__init__(points, faces)

    @staticmethod
    def check_suffix(suffix: str) -> None:
        """Raises FileError for a format that meshio does not write."""
        if suffix.lower() not in _meshio(suffix).extension_to_filetypes:
            raise FileError(Message("suffix_unwritable", {"suffix": suffix, "suffixes": _KNOWN}))

    @classmethod
    def of_path(cls, path: Path) -> MeshioFile:
        meshio = _meshio(path.suffix)
        endings = ["".join(path.suffixes[k:]).lower() for k in range(len(path.suffixes))]  # some formats have two, .vol.gz
        if not any(each in meshio.extension_to_filetypes for each in endings):
            raise FileError(Message("suffix_unreadable", {"suffix": path.suffix, "suffixes": [*_KNOWN, ".vtk"]}))
        options: dict[str, Any] = {}
        if path.suffix.lower() == ".vtk":
            with path.open("rb") as file:
                head = [file.readline() for _ in range(3)]
            options["binary"] = head[2].strip().upper() == b"BINARY"
            version = re.search(rb"Version\s+(\d+)", head[0])
            options["file_format"] = "vtk42" if version and int(version[1]) < 5 else "vtk"
        said = io.StringIO()  # meshio prints what is wrong, and ends the process
        try:
            with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
                mesh = meshio.read(path)
        except OSError:
            raise
        except ImportError as error:
            raise FileError(Message("package_cannot_read", {"package": "meshio", "reason": str(error)})) from error
        except (Exception, SystemExit) as error:
            raise damaged(path.suffix[1:].upper()) from error
        made = cls(mesh, path.suffix, options)
        made.suffix = path.suffix
        return made

    @classmethod
    def of_mesh(cls, vertices: Array, faces: list[list[int]], suffix: str) -> MeshioFile:
        meshio = _meshio(suffix)
        return cls(meshio.Mesh(np.array(vertices, float), cls._blocks(faces)), suffix, {})

    @staticmethod
    def _blocks(faces: list[list[int]]) -> list[tuple[str, Array]]:
        by_size: dict[int, list[Any]] = {}
        for face in faces:
            by_size.setdefault(len(face), []).append(face)
        return [({3: "triangle", 4: "quad"}.get(k, "polygon"), np.array(rows, np.int64)) for k, rows in sorted(by_size.items())]

    def _move(self, v: int, place: Array) -> None:
        if self._mesh.points.dtype.kind != "f":
            self._mesh.points = self._mesh.points.astype(float)
        self._mesh.points[v] = place[: self._mesh.points.shape[1]]

    def _split(self, f: int, place: int, v: int, t: float) -> None:
        meshio, mesh = _meshio(self._suffix), self._mesh
        (block, row), face = self._cell_of[f], list(self._face_by_now(f))
        face.insert(place + 1, v)
        cells = [(b.type, np.asarray(b.data)) for b in mesh.cells]
        data = {name: [np.asarray(x) for x in values] for name, values in mesh.cell_data.items()}
        cells.append(("polygon" if len(face) > 4 else "quad", np.array([face])))
        cells[block] = cells[block][0], np.delete(cells[block][1], row, axis=0)
        for values in data.values():
            values.append(values[block][row : row + 1])
            values[block] = np.delete(values[block], row, axis=0)
        self._cell_of = [(b, k - (b == block and k > row)) for b, k in self._cell_of]
        self._cell_of[f] = len(cells) - 1, 0
        if not len(cells[block][1]):
            del cells[block]
            for values in data.values():
                del values[block]
            self._cell_of = [(b - (b > block), k) for b, k in self._cell_of]
        self._mesh = meshio.Mesh(mesh.points, cells, point_data=mesh.point_data, cell_data=data, field_data=mesh.field_data)

    def _look(self, f: int) -> Hashable:
        b, k = self._cell_of[f]
        return tuple(np.asarray(values[b])[k].tobytes() for values in self._mesh.cell_data.values())

    def _append(self, fill: Any, faces: list[list[int]], continued: Continued) -> None:
        meshio, mesh = _meshio(self._suffix), self._mesh
        dtype = mesh.points.dtype if mesh.points.dtype.kind == "f" else float
        points = np.concatenate([mesh.points, np.asarray(fill.vertices, dtype)[:, : mesh.points.shape[1]]])
        point_data = {}
        for name, values in mesh.point_data.items():
            new = values[continued.near]
            if values.dtype.kind == "f":
                blended = continued.at_vertices(lambda rim, values=values: values[rim].reshape(len(rim), -1))  # type: ignore[misc]
                new = blended.reshape(new.shape).astype(values.dtype)
            if name.lower() in ("normal", "normals") and new.shape == fill.normals.shape:
                new = fill.normals.astype(values.dtype)
            point_data[name] = np.concatenate([values, new])
        blocks = self._blocks(faces)
        cell_data = {}
        sizes = sorted({len(face) for face in faces})
        for name, values in mesh.cell_data.items():
            like = [np.asarray(values[b])[k] for b, k in (self._cell_of[f] for f in continued.model)]
            like = like or [np.zeros_like(np.asarray(values[0])[0])] * len(faces)
            new_data = [np.array([row for row, face in zip(like, faces) if len(face) == size]) for size in sizes]
            cell_data[name] = [*values, *new_data]
        if self._marks and self._suffix.lower() in _WITH_MARKS:
            old = mesh.cell_data.get(FILL) or [np.zeros(len(block.data), np.int32) for block in mesh.cells]
            cell_data[FILL] = [*old, *(np.full(len(rows), self._number, np.int32) for _, rows in blocks)]
        self._mesh = meshio.Mesh(
            points, [*mesh.cells, *blocks], point_data=point_data, cell_data=cell_data, field_data=mesh.field_data
        )

    def _save(self, path: Path) -> None:
        meshio = _meshio(self._suffix)
        options = dict(self._options)
        form = options.pop("file_format", None) or meshio.extension_to_filetypes.get(self._suffix.lower(), [""])[0]
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                meshio.write(path, self._mesh, file_format=form, **options)
        except OSError:
            raise
        except (Exception, SystemExit) as error:
            said = {"package": "meshio", "suffix": self._suffix, "reason": str(error) or type(error).__name__}
            raise FileError(Message("package_cannot_write", said)) from error
