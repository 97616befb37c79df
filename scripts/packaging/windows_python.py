"""Puts a CPython for Windows together, for tests under wine.

Its libraries come from a wheel of panda3d, its standard library from Debian's source.

windows_python.py FOLDER REQUIREMENT... makes FOLDER/python.exe, for Python 3.11, with these packages.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from cross import BUILD, PLATFORMS, headers, import_library, run, toolchain

PYTHON = "311"
PANDA3D = "panda3d==1.10.16"
PIP = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
WINDOWS = [
    "--only-binary",
    ":all:",
    "--platform",
    "win_amd64",
    "--python-version",
    PYTHON,
    "--implementation",
    "cp",
    "--abi",
    "cp311",
]
WINDOWS += ["--abi", "abi3", "--abi", "none"]
PROGRAM = """\
#include <wchar.h>
int Py_Main(int argc, wchar_t** argv);
int wmain(int argc, wchar_t** argv) { return Py_Main(argc, argv); }
"""


def make(folder: Path, requirements: list[str]) -> None:
    platform = PLATFORMS["windows-x64"]
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "DLLs").mkdir(parents=True)
    with tempfile.TemporaryDirectory() as downloads:
        run([*PIP, "download", "-q", "--no-deps", *WINDOWS, "-d", downloads, PANDA3D])
        with zipfile.ZipFile(next(Path(downloads).glob("*.whl"))) as archive:
            for name in archive.namelist():
                part = Path(name)
                if part.parent.name != "deploy_libs" or part.name.lower().startswith("api-ms"):
                    continue
                beside_program = part.name.lower().startswith(("python", "vcruntime"))
                (folder if beside_program else folder / "DLLs").joinpath(part.name).write_bytes(archive.read(name))
    shutil.copytree(BUILD / "python-source" / PYTHON / "Lib", folder / "Lib", ignore=shutil.ignore_patterns("test", "idlelib"))
    # The DLL's importlib is that of 3.11.9, which calls this on the class; in Debian's 3.11.2 it is no class method yet.
    metadata = folder / "Lib" / "importlib" / "metadata" / "__init__.py"
    method = "    def invalidate_caches(cls)"
    metadata.write_text(metadata.read_text().replace(method, f"    @classmethod\n{method}"))
    toolchain(platform)
    library = import_library(PYTHON, headers(PYTHON, platform))
    program = folder / "python.c"
    program.write_text(PROGRAM)
    run([BUILD / "cross" / platform.name / "cc", "-municode", program, library, "-o", folder / "python.exe"])
    program.unlink()
    run(
        [
            *PIP,
            "install",
            "-q",
            "--no-deps",
            "--no-compile",
            *WINDOWS,
            "--target",
            folder / "Lib" / "site-packages",
            *requirements,
        ]
    )


if __name__ == "__main__":
    make(Path(sys.argv[1]), sys.argv[2:])
    print(subprocess.check_output(["file", str(Path(sys.argv[1], "python.exe"))], text=True), end="")
