"""Writes a wheel around a compiled module: the same bytes on every run."""

from __future__ import annotations

import base64
import hashlib
import os
import subprocess
import time
import tomllib
import zipfile
from pathlib import Path

from platforms import Platform

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
VERSION = PROJECT["project"]["version"]


def source_date() -> tuple[int, int, int, int, int, int]:
    """SOURCE_DATE_EPOCH, or when the commit was made."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH") or subprocess.check_output(
        ["git", "log", "-1", "--format=%ct"], cwd=ROOT, text=True
    )
    return time.gmtime(max(int(epoch), 315532800))[:6]  # zip files begin in 1980


def add(archive: zipfile.ZipFile, name: str, content: bytes) -> None:
    """An entry without a clock of its own and without the umask of who makes it."""
    entry = zipfile.ZipInfo(name, source_date())
    entry.create_system = 3
    entry.external_attr = 0o100644 << 16
    entry.compress_type = zipfile.ZIP_STORED if name.endswith(".whl") else zipfile.ZIP_DEFLATED
    archive.writestr(entry, content)


def package_files() -> dict[str, bytes]:
    """The package's own files by their name in a wheel."""
    folder = ROOT / PROJECT["tool"]["scikit-build"]["wheel"]["packages"][0]
    files = sorted(
        p for p in folder.rglob("*") if p.is_file() and "__pycache__" not in p.parts and not p.name.startswith("_native.")
    )
    return {p.relative_to(folder.parent).as_posix(): p.read_bytes() for p in [*files, folder / "_native.pyi"]}


def metadata() -> bytes:
    """What Python's package index gets to know."""
    import pyproject_metadata

    return bytes(pyproject_metadata.StandardMetadata.from_pyproject(PROJECT, ROOT).as_rfc822())


def write(platform: Platform, python: str, module: Path, opensubdiv: Path, folder: Path) -> Path:
    """The wheel of one platform and Python, in `folder`."""
    tag = f"cp{python}-cp{python}-{platform.wheel_tag}"
    info = f"tripatch-{VERSION}.dist-info"
    scripts = "".join(f"{name} = {target}\n" for name, target in PROJECT["project"]["scripts"].items())
    licences = {name: ROOT / name for name in PROJECT["project"]["license-files"]}
    licences |= {f"OpenSubdiv-{name}": opensubdiv / name for name in ("LICENSE.txt", "NOTICE.txt")}
    files = {
        **package_files(),
        f"tripatch/{module.name}": module.read_bytes(),
        f"{info}/METADATA": metadata(),
        f"{info}/WHEEL": f"Wheel-Version: 1.0\nGenerator: scripts/package\nRoot-Is-Purelib: false\nTag: {tag}\n".encode(),
        f"{info}/entry_points.txt": f"[console_scripts]\n{scripts}".encode(),
        **{f"{info}/licenses/{name}": path.read_bytes() for name, path in licences.items()},
    }
    record = ""
    for name, content in sorted(files.items()):
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(content)}\n"
    wheel = folder / f"tripatch-{VERSION}-{tag}.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for name, content in sorted(files.items()):
            add(archive, name, content)
        add(archive, f"{info}/RECORD", f"{record}{info}/RECORD,,\n".encode())
    return wheel
