"""Compiles the Python module for another system with zig: the core once, the bindings once per Python."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pybind11
import ziglang
from platforms import PLATFORMS, PYTHONS, Platform

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
EIGEN = Path("/usr/share/eigen3/cmake")  # Debian's, which has headers only
ZIG = Path(ziglang.__file__).with_name("zig")

# Python's configuration where long and pointers have 64 bits: Linux and macOS on x86-64 and arm64.
UNIX_CONFIG = {
    **{
        f"SIZEOF_{name}": 8
        for name in ("LONG", "LONG_LONG", "VOID_P", "SIZE_T", "UINTPTR_T", "TIME_T", "OFF_T", "FPOS_T", "DOUBLE")
    },
    **{f"SIZEOF_{name}": 4 for name in ("INT", "WCHAR_T", "PID_T", "FLOAT")},
    **{
        "SIZEOF_SHORT": 2,
        "SIZEOF__BOOL": 1,
        "SIZEOF_PTHREAD_T": 8,
        "ALIGNOF_LONG": 8,
        "ALIGNOF_SIZE_T": 8,
        "ALIGNOF_MAX_ALIGN_T": 16,
    },
    **{
        f"HAVE_{name}": 1
        for name in (
            *(
                "INTTYPES_H",
                "LANGINFO_H",
                "PTHREAD_H",
                "STDDEF_H",
                "STDINT_H",
                "SYS_SELECT_H",
                "SYS_STAT_H",
                "SYS_TIME_H",
                "SYS_TYPES_H",
            ),
            *("UNISTD_H", "WCHAR_H", "CLOCK_GETTIME", "FORK", "SSIZE_T"),
        )
    },
    **{"DOUBLE_IS_LITTLE_ENDIAN_IEEE754": 1, "WITH_DOC_STRINGS": 1, "WITH_PYMALLOC": 1},
}


def headers(python: str, platform: Platform) -> Path:
    """The folder with Python's headers and their configuration for a platform, made from a source tree of Python."""
    source = BUILD / "python-source" / python
    folder = BUILD / "cross" / "python" / f"{python}-{platform.system}"
    if platform.system == "Windows":
        config = next(p for p in (source / "PC" / "pyconfig.h", source / "PC" / "pyconfig.h.in") if p.exists()).read_text()
    else:
        config = "".join(f"#define {name} {value}\n" for name, value in UNIX_CONFIG.items())
        config = f"#pragma once\n{config}#ifndef _POSIX_THREADS\n#define _POSIX_THREADS 1\n#endif\n"
    file = folder / "pyconfig.h"
    if not file.exists() or file.read_text() != config:  # else nothing is compiled again
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(source / "Include", folder)
        file.write_text(config)
    return folder


def import_library(python: str, include: Path) -> Path:
    """What a module links for Windows: names of all that the headers declare, to be found in pythonXY.dll."""
    names: dict[str, str] = {}
    for header in sorted([*include.glob("*.h"), *include.glob("cpython/*.h")]):
        for kind, name in re.findall(
            r"PyAPI_(FUNC|DATA)\([^()]*(?:\([^()]*\)[^()]*)*\)\s*(\w+)", header.read_text(encoding="utf-8")
        ):
            names[name] = " DATA" if kind == "DATA" else ""
    definition = include / f"python{python}.def"
    lines = "".join(f"    {name}{data}\n" for name, data in sorted(names.items()))
    definition.write_text(f"LIBRARY python{python}.dll\nEXPORTS\n{lines}")
    library = include / f"libpython{python}.a"
    run([ZIG, "dlltool", "-m", "i386:x86-64", "-d", definition, "-l", library])
    return library


def run(command: list[str | Path]) -> str:
    """Runs a program; returns what it printed, and prints it if there are warnings."""
    done = subprocess.run(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"{done.stdout[-6000:]}\nerror: {' '.join(map(str, command))[:300]} failed")
    if "warning: " in done.stdout:
        print(done.stdout)
    return done.stdout


def macos_link(platform: Platform, folder: Path) -> str:
    """CMake's rule to link a module for macOS.

    It calls LLVM's linker with the libraries that zig would link. zig's own linker exports operator new and binds parts of the
    C++ library weakly, so that macOS would replace them by those of another C++ library in the process.
    """
    probe = folder / "probe.cpp"
    probe.write_text("#include <string>\nstd::string made(int value) { return std::to_string(value); }\n")
    said = run([folder / "c++", "-v", "-shared", probe, "-o", folder / "probe.dylib"])
    linked = next(line for line in said.splitlines() if line.startswith("zig ld "))
    libraries = [Path(name).absolute() for name in re.findall(r"\S+\.a\b", linked)]
    # what libSystem exports, written for arm64e, which has the same functions
    system = (ZIG.parent / "lib" / "libc" / "darwin" / "libSystem.tbd").read_text()
    (folder / "libSystem.tbd").write_text(re.sub(r"arm64e(\.x1)?-", "arm64-", system))
    linker = Path("/usr/lib/llvm-19/bin/ld64.lld")
    if not linker.exists():
        sys.exit("error: ld64.lld, of Debian's package lld-19, is not installed")
    oldest = platform.target.partition("macos.")[2]
    system_version = ["-platform_version", "macos", oldest, oldest]
    command = [linker, "-arch", platform.processor, *system_version, "-bundle", "-dead_strip", "-S"]
    inputs = ["<LINK_FLAGS>", "-o", "<TARGET>", "<OBJECTS>", "<LINK_LIBRARIES>", *libraries, folder / "libSystem.tbd"]
    return (
        f'set(CMAKE_CXX_CREATE_SHARED_MODULE "{" ".join(map(str, command + inputs))}")\nunset(CMAKE_CXX_LINKER_WRAPPER_FLAG)\n'
        'set(CMAKE_SHARED_MODULE_CREATE_CXX_FLAGS "-bundle")  # no words for a compiler; CMake 4 has them among LINK_FLAGS\n'
    )


# CMake finds out what compiler this is by linking a program, for which zig would compile a C++ library that no module needs: it
# is only compiled. And with -c zig tries to link a precompiled header: there -c is left out.
COMPILER_CASES = """\
case "$*" in
  *CompilerId.c*) set -- -c "$@";;
  *c++-header*) for word do shift; [ "$word" = -c ] || set -- "$@" "$word"; done;;
esac
"""
# without -emit-pch, which zig adds itself and clang takes only once
PRECOMPILED = "set(CMAKE_CXX_COMPILE_OPTIONS_CREATE_PCH -Xclang -include -Xclang <PCH_HEADER> -x c++-header)\n"


def toolchain(platform: Platform) -> Path:
    """A CMake toolchain file with zig's compilers for a platform."""
    folder = BUILD / "cross" / platform.name
    folder.mkdir(parents=True, exist_ok=True)
    # its runtime compiled in one mode, no checks of debug builds, and the same bytes wherever the source tree lies
    compiled = f"-target {platform.target} -O2 -g0 -fno-sanitize=undefined -ffile-prefix-map={ROOT}=."
    tools = {"cc": f"cc {compiled}", "c++": f"c++ {compiled}", "ar": "ar", "ranlib": "ranlib"}
    caches = f"ZIG_GLOBAL_CACHE_DIR={BUILD}/zig-cache ZIG_LOCAL_CACHE_DIR={BUILD}/zig-cache"
    for name, command in tools.items():
        tool = folder / name
        more = " $TRIPATCH_CROSS_FLAGS" if command.startswith("c") else ""  # -O1, for a trial
        content = f'#!/bin/sh\n{COMPILER_CASES}{caches} exec {ZIG} {command} "$@"{more}\n'
        if not tool.exists() or tool.read_text() != content:
            tool.write_text(content)
            tool.chmod(0o755)
    lines = {
        "CMAKE_SYSTEM_NAME": platform.system,
        "CMAKE_SYSTEM_PROCESSOR": platform.processor,
        "CMAKE_C_COMPILER": folder / "cc",
        "CMAKE_CXX_COMPILER": folder / "c++",
        "CMAKE_AR": folder / "ar",
        "CMAKE_RANLIB": folder / "ranlib",
        "CMAKE_FIND_ROOT_PATH_MODE_PROGRAM": "NEVER",
        "CMAKE_TRY_COMPILE_TARGET_TYPE": "STATIC_LIBRARY",
        "CMAKE_MODULE_LINKER_FLAGS_INIT": "-s",
    }
    if platform.system == "Windows":  # else CMake links uuid and others, which zig would have to compile: minutes for nothing
        lines["CMAKE_CXX_STANDARD_LIBRARIES"] = '"" CACHE STRING "" FORCE'
    if platform.system == "Darwin":
        lines |= {"CMAKE_INSTALL_NAME_TOOL": "/bin/true", "CMAKE_OSX_SYSROOT": '""', "CMAKE_MODULE_LINKER_FLAGS_INIT": '""'}
    rules = folder / "rules.cmake"
    rules.write_text(PRECOMPILED + (macos_link(platform, folder) if platform.system == "Darwin" else ""))
    lines["CMAKE_USER_MAKE_RULES_OVERRIDE"] = rules
    file = folder / "toolchain.cmake"
    file.write_text("".join(f"set({name} {value})\n" for name, value in lines.items()))
    return file


def configure(platform: Platform, opensubdiv: Path, python: str, more: Mapping[str, str | Path]) -> Path:
    """Prepares a platform's build for one Python; returns its folder, where all that is built shares the core's objects."""
    folder = BUILD / "cross" / platform.name / "build"
    include = headers(python, platform)
    options = {
        "CMAKE_BUILD_TYPE": "Release",
        "CMAKE_TOOLCHAIN_FILE": toolchain(platform),
        "CMAKE_INTERPROCEDURAL_OPTIMIZATION": "OFF",  # else pybind11 tries it, and zig compiles a C++ library for the trial
        "TRIPATCH_CCACHE": "OFF",  # zig has a cache of its own
        "TRIPATCH_PYTHON": "ON",
        "TRIPATCH_UNITY": "ON",
        "TRIPATCH_OPENSUBDIV": "static",
        "TRIPATCH_OPENSUBDIV_SOURCE": opensubdiv.resolve(),
        "Eigen3_DIR": EIGEN,
        "pybind11_DIR": pybind11.get_cmake_dir(),
        "PYBIND11_USE_CROSSCOMPILING": "ON",
        "PYTHON_MODULE_EXTENSION": platform.module_suffix.format(python=python),
        "Python_INCLUDE_DIR": include,
        **more,
    }
    if platform.system == "Windows":
        options["Python_LIBRARY"] = import_library(python, include)
    run(["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", *(f"-D{name}={value}" for name, value in options.items())])
    return folder


def build(folder: Path, target: str) -> None:
    run(["cmake", "--build", folder, "--target", target, *os.environ.get("TRIPATCH_BUILD_OPTIONS", "").split()])


def modules(platform: Platform, opensubdiv: Path) -> dict[str, Path]:
    """The compiled module for each Python."""
    made = {}
    for python in PYTHONS:
        folder = configure(platform, opensubdiv, python, {"TRIPATCH_TESTS": "OFF"})
        build(folder, "_native")
        made[python] = folder / f"_native{platform.module_suffix.format(python=python)}"
    return made


def tests(platform: Platform, opensubdiv: Path, files: list[str]) -> Path:
    """The program of some C++ tests, linked with the library that the module contains."""
    catch = BUILD / "cross" / "catch2"
    single = Path("/usr/include/catch2/catch.hpp")
    if not single.exists():
        sys.exit("error: C++ tests for another system need Catch2 2, which is headers only, as Debian 12 has it")
    (catch / "catch2").mkdir(parents=True, exist_ok=True)  # a copy: in /usr/include are this system's headers too
    shutil.copy(single, catch / "catch2")
    (catch / "Catch2Config.cmake").write_text(
        "set(Catch2_VERSION 2)\nadd_library(Catch2::Catch2 INTERFACE IMPORTED)\n"
        f"target_include_directories(Catch2::Catch2 INTERFACE {catch})\n"
    )
    more: dict[str, str | Path] = {"TRIPATCH_TESTS": "ON", "TRIPATCH_TEST_FILES": ";".join(files), "Catch2_DIR": catch}
    folder = configure(platform, opensubdiv, PYTHONS[0], more)
    build(folder, "tripatch_tests")
    return folder / ("tripatch_tests.exe" if platform.system == "Windows" else "tripatch_tests")


if __name__ == "__main__":  # cross.py OPENSUBDIV PLATFORM FILE...: compiles files of tests/native, prints the program's path
    print(tests(PLATFORMS[sys.argv[2]], Path(sys.argv[1]), sys.argv[3:]))
