"""Mesh files: read, add fills, write. Nothing of the user's file is lost.

OBJ, OFF, PLY and STL are read by small passes of our own that keep the file's bytes and add to them: comments, groups, materials,
texture coordinates, colors, other elements and the header stay as they are. So do nodes, materials and all else in glTF and 3MF
files, and in USD layers by usd-core: their meshes are filled where they are in the scene. All other formats (VTK, VTU, ...) go
through meshio, which keeps points, cells, and the data of both, but not what it does not read: comments, the title line, VTK's
POLYDATA.

A vertex that a fill moves keeps its line or row but for the three numbers. A face whose edge a fill splits keeps all that the
file says of it, texture coordinates by corner are interpolated; in OBJ it goes to the end, after its new vertex. In glTF what so
changes of a primitive is written behind the old data, which stays; 3MF triangles and USD faces share the joined vertex. A new
vertex takes what the file says of a vertex beyond its position and normal (colors, say) from the nearest rim vertex, a new face
what the file says of a face (material, group, color) from the faces around the rim.
"""

from __future__ import annotations

import json
import os
import re
import stat
from pathlib import Path
from typing import Any

from .. import _arrays
from ..errors import WrongType
from ..messages import Message
from .gltf import GltfFile
from .mesh_file import MeshFile
from .obj import ObjFile
from .off import OffFile
from .off_binary import BinaryOffFile
from .others import MeshioFile
from .ply import PlyFile
from .stl import StlFile
from .threemf import ThreemfFile
from .usd import UsdFile
from .writing import FileError, damaged, unreadable, unwritable, without_faces, write_over

__all__ = [
    "FileError",
    "MeshFile",
    "check_folder",
    "check_output",
    "converted",
    "read",
    "read_faces",
    "read_report",
    "without_faces",
    "write",
    "write_over",
]

_BINARY = rb"(?:\xef\xbb\xbf)?[A-Zn4]*OFF[ \t]+BINARY\b"
_OWN: dict[str, Any] = {".obj": ObjFile, ".off": OffFile, ".ply": PlyFile, ".stl": StlFile}
_SCENES: dict[str, Any] = {".glb": GltfFile, ".gltf": GltfFile, ".3mf": ThreemfFile}
_SCENES |= dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), UsdFile)


def read(path: str | os.PathLike[str]) -> MeshFile:
    """Reads a mesh file, the format by its suffix: OBJ, OFF, PLY, STL, glTF and 3MF by itself, USD by usd-core, all others
    through meshio.

    Args:
        path: of the file.

    Returns:
        A `MeshFile`, which keeps all that the file has for `write`.

    Raises:
        FileError: says what is wrong.
    """
    path = Path(path)
    try:
        if stat.S_ISDIR(path.stat().st_mode):
            raise FileError(Message("is_a_folder"))
        if not path.suffix:
            raise FileError(Message("no_suffix", {"path": path.name}))
        return _class_for(path).of_path(path)
    except (FileError, OSError) as error:
        raise unreadable(path, error) from error


def read_faces(path: Path) -> MeshFile:
    """The same of a file that has faces."""
    mesh = read(path)
    if not len(mesh.faces):
        raise unreadable(path, without_faces(len(mesh.vertices)))
    return mesh


def read_report(path: Path) -> Any:
    """What a JSON file says."""
    try:
        return json.loads(path.read_bytes())
    except OSError as error:
        raise unreadable(path, error) from error
    except ValueError:
        raise unreadable(path, damaged("JSON")) from None


def _class_for(path: Path) -> type[MeshFile]:
    suffix = path.suffix.lower()
    own: type[MeshFile] = _OWN.get(suffix) or _SCENES.get(suffix, MeshioFile)
    if own is OffFile:
        with path.open("rb") as file:
            return BinaryOffFile if re.match(_BINARY, file.read(100)) else own
    return own


def write(path: str | os.PathLike[str], mesh: Any) -> None:
    """Writes a mesh file, the format by its suffix.

    Args:
        path: of the file; what was there is replaced once all is written.
        mesh: what `read` or `fill_holes` returned: in the format of the file that was read, all that the file had is written too,
            unchanged. Or any object with .vertices and .faces, or a pair of both.

    Raises:
        FileError: the file cannot be written.
    """
    path = Path(path)
    check_output(path)
    if not isinstance(mesh, MeshFile):
        pair = (mesh.vertices, mesh.faces) if hasattr(mesh, "vertices") and hasattr(mesh, "faces") else mesh
        if not isinstance(pair, tuple) or len(pair) != 2:
            raise WrongType(Message("mesh_needed", {"function": "write()", "type": type(mesh).__name__}))
        vertices, offsets, corners = _arrays.mesh(*pair)
        mesh = MeshFile(vertices.copy(), (offsets, corners))
    (mesh if mesh.suffix.lower() == path.suffix.lower() else converted(mesh, path.suffix)).write(path)


def check_output(path: Path) -> None:
    """Whether a mesh can be written there, before the work is done.

    Raises:
        FileError: the format is not known, or the folder is not there.
    """
    if path.is_dir():
        raise unwritable(path, IsADirectoryError(Message("is_a_folder")))
    if not path.suffix:
        raise FileError(Message("no_suffix", {"path": str(path)}))
    if path.suffix.lower() not in _OWN:
        _SCENES.get(path.suffix.lower(), MeshioFile).check_suffix(path.suffix)
    check_folder(path)


def check_folder(path: Path) -> None:
    """Whether the folder of a file is there."""
    if not path.absolute().parent.is_dir():
        raise FileError(Message("folder_missing", {"path": str(path.parent)}))


def converted(mesh: MeshFile, suffix: str, joined: Any = None) -> MeshFile:
    """The same vertices and faces in the format of another suffix; all else stays behind. joined: as `MeshFile.join` takes it."""
    vertices, faces = mesh.vertices, mesh.faces
    if joined:
        vertices = vertices.copy()
        vertices[joined.moved[0]] = joined.moved[1]
        faces = _arrays.Rows(*joined.faces(faces.offsets, faces.corners))
    own = _OWN.get(suffix.lower())
    other = _SCENES.get(suffix.lower(), MeshioFile)
    made: MeshFile = own.of_mesh(vertices, faces) if own else other.of_mesh(vertices, faces, suffix)
    made.suffix, made._joined = suffix, joined
    return made
