"""The buffers and the text of glTF files."""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

import numpy as np

from .._types import Array

JSON, BIN = 0x4E4F534A, 0x004E4942  # of chunks
KINDS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_CODES = {np.dtype(kind): code for code, kind in KINDS.items()}


class Writer:
    """Adds data to a buffer, and what names it to the JSON."""

    def __init__(self, said: dict[str, Any], data: bytes, buffer: int) -> None:
        self._said, self._buffer = said, buffer
        self._pieces, self._length = [data], len(data)

    def view(self, data: bytes, target: int | None = None) -> int:
        pad = bytes(-self._length % 4)
        views = self._said.setdefault("bufferViews", [])
        views.append({"buffer": self._buffer, "byteOffset": self._length + len(pad), "byteLength": len(data)})
        if target:
            views[-1]["target"] = target
        self._pieces += [pad, data]
        self._length += len(pad) + len(data)
        return len(views) - 1

    def accessor(self, values: Array, target: int, bounds: bool = False) -> int:
        accessors = self._said.setdefault("accessors", [])
        kind = next(name for name, width in WIDTHS.items() if width == values.shape[1])
        made: dict[str, Any] = {"bufferView": self.view(values.tobytes(), target), "componentType": _CODES[values.dtype]}
        made |= {"count": len(values), "type": kind}
        if bounds:
            made |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        accessors.append(made)
        return len(accessors) - 1

    def attribute(self, name: str, values: Array) -> int:
        return self.accessor(values.astype("<u2" if name.startswith("JOINTS_") else "<f4"), 34962, name == "POSITION")

    def indices(self, triangles: Any, count: int) -> int:
        """Of triangles of so many vertices."""
        return self.accessor(np.array(triangles, "<u2" if count < 65535 else "<u4").reshape(-1, 1), 34963)

    def finish(self) -> bytes:
        """The whole buffer, which its length in the JSON then fits."""
        data = b"".join(self._pieces)
        data += bytes(-len(data) % 4)
        self._said["buffers"][self._buffer]["byteLength"] = len(data)
        return data

    def as_uri(self, rest: bytes | None) -> bytes | None:
        """Puts the buffer into the JSON; returns what the file holds next to it."""
        data = b"".join(self._pieces)
        self._said["buffers"].append({"byteLength": len(data), "uri": as_uri(data)})
        return rest


def as_uri(data: bytes) -> str:
    return "data:application/octet-stream;base64," + base64.b64encode(data).decode()


def dumped(said: Any, like: bytes) -> bytes:
    """JSON as text, over several lines if another one is."""
    if b"\n" in like.strip():
        return json.dumps(said, ensure_ascii=False, indent=2).encode() + b"\n"
    return json.dumps(said, ensure_ascii=False, separators=(",", ":")).encode()


def glb(text: bytes, data: bytes | None, rest: bytes) -> bytes:
    text += b" " * (-len(text) % 4)
    chunk = b"" if data is None else struct.pack("<II", len(data), BIN) + data
    length = 12 + 8 + len(text) + len(chunk) + len(rest)
    return struct.pack("<4sII", b"glTF", 2, length) + struct.pack("<II", len(text), JSON) + text + chunk + rest
