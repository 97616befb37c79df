"""The systems that TriPatch is packaged for, and the Pythons of their Blenders."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Platform:
    name: str  # as Blender's extension manifests call it
    target: str  # as zig calls it
    wheel_tag: str
    system: str  # as CMake calls it
    processor: str
    module_suffix: str  # of a compiled module, {python} being 311 or 313


PLATFORMS = {
    p.name: p
    for p in (
        # glibc 2.17 runs everywhere from CentOS 7 on; macOS 11 is what Blender 4.2 to 5.2 ask for
        Platform(
            "linux-x64",
            "x86_64-linux-gnu.2.17",
            "manylinux_2_17_x86_64",
            "Linux",
            "x86_64",
            ".cpython-{python}-x86_64-linux-gnu.so",
        ),
        Platform(
            "linux-arm64",
            "aarch64-linux-gnu.2.17",
            "manylinux_2_17_aarch64",
            "Linux",
            "aarch64",
            ".cpython-{python}-aarch64-linux-gnu.so",
        ),
        Platform("windows-x64", "x86_64-windows-gnu", "win_amd64", "Windows", "AMD64", ".cp{python}-win_amd64.pyd"),
        Platform("macos-arm64", "aarch64-macos.11.0", "macosx_11_0_arm64", "Darwin", "arm64", ".cpython-{python}-darwin.so"),
        Platform("macos-x64", "x86_64-macos.11.0", "macosx_11_0_x86_64", "Darwin", "x86_64", ".cpython-{python}-darwin.so"),
    )
}

# Blender 4.2 to 5.0 bring Python 3.11, 5.1 and newer 3.13. scripts/setup gets their headers from these releases of Debian.
PYTHONS = ("311", "313")
