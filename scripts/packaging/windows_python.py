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

import lief
from cross import BUILD, PLATFORMS, headers, import_library, run, toolchain

PYTHON = "311"
# Its python311.dll is 3.11.1, the release before Debian's library of 3.11.2. Newer panda3d has 3.11.7 or 3.11.9, whose
# importlib calls functions that 3.11.2 defines in another way.
PANDA3D = "panda3d==1.10.13"
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
# Windows' clock advances 64 times a second, wine's with every reading: Dask waits for five equal readings.
CLOCK = """\
import time

_time = time.time
time.time = lambda: _time() // 0.015625 * 0.015625
"""


def forwarder(library: Path, compiler: Path) -> None:
    """Makes python3.dll next to python3XY.dll: modules of the stable ABI load it, and it hands every name on to that library."""
    parsed = lief.parse(str(library))  # has to outlive what it holds
    names = [entry.name for entry in parsed.get_export().entries if entry.name.startswith(("Py", "_Py"))]
    with tempfile.TemporaryDirectory() as temporary:
        definition, source = Path(temporary, "python3.def"), Path(temporary, "python3.c")
        lines = "".join(f"    {name}={library.stem}.{name}\n" for name in names)
        definition.write_text(f"LIBRARY python3.dll\nEXPORTS\n{lines}")
        source.write_text("int DllMain(void* module, unsigned reason, void* reserved) { return 1; }\n")
        made = Path(temporary, "python3.dll")
        run([compiler, "-shared", "-nostdlib", "-Wl,--entry=DllMain", source, definition, "-o", made])
        shutil.copy(made, library.with_name(made.name))


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
    toolchain(platform)
    library = import_library(PYTHON, headers(PYTHON, platform))
    program = folder / "python.c"
    program.write_text(PROGRAM)
    compiler = BUILD / "cross" / platform.name / "cc"
    run([compiler, "-municode", program, library, "-o", folder / "python.exe"])
    program.unlink()
    forwarder(folder / f"python{PYTHON}.dll", compiler)
    (folder / "Lib" / "sitecustomize.py").write_text(CLOCK)
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
