"""Mesh files: read, add fills, write. Nothing of the user's file is lost.

OBJ, OFF, PLY and STL are read by small passes of our own that keep the file's bytes and add to them: comments, groups, materials,
texture coordinates, colors, other elements and the header stay as they are. All other formats (VTK, VTU, ...) go through meshio,
which keeps points, cells, and the data of both, but not what it does not read: comments, the title line, VTK's POLYDATA.

A vertex that a fill moves keeps its line or row but for the three numbers. A face whose edge a fill splits keeps all that the
file says of it, texture coordinates by corner are interpolated; in OBJ it goes to the end, after its new vertex. A new vertex
takes what the file says of a vertex beyond its position and normal (colors, say) from the nearest rim vertex, a new face what
the file says of a face (material, group, color) from the faces around the rim.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from .mesh_file import MeshFile
from .obj import ObjFile
from .off import OffFile
from .off_binary import BinaryOffFile
from .others import MeshioFile
from .ply import PlyFile
from .stl import StlFile
from .writing import FileError, write_over

__all__ = ["FileError", "MeshFile", "converted", "read", "write_over"]

_BINARY = rb"(?:\xef\xbb\xbf)?[A-Zn4]*OFF[ \t]+BINARY\b"
_OWN: dict[str, Any] = {".obj": ObjFile, ".off": OffFile, ".ply": PlyFile, ".stl": StlFile}


def read(path: Path) -> MeshFile:
    """Reads a mesh file, the format by its suffix.

    Raises:
        FileError: says what is wrong.
    """
    path = Path(path)
    try:
        own = _OWN.get(path.suffix.lower())
        if not own:
            return MeshioFile.of_path(path)
        data = path.read_bytes()
        return BinaryOffFile(data) if own is OffFile and re.match(_BINARY, data) else own(data)
    except FileError as error:
        raise FileError(f"{path} cannot be read. {error}") from error
    except OSError as error:
        raise FileError(f"{path} cannot be read: {error.strerror or error}") from error


def converted(mesh: MeshFile, suffix: str) -> MeshFile:
    """The same vertices and faces in the format of another suffix; all else stays behind."""
    own = _OWN.get(suffix.lower())
    return own.of_mesh(mesh.vertices, mesh.faces) if own else MeshioFile.of_mesh(mesh.vertices, mesh.faces, suffix)
