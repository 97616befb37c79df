"""Checks wheels and zips as they are shipped: names, contents, and what the compiled modules ask of a system."""

from __future__ import annotations

import re
import struct
import sys
import tomllib
import zipfile
from pathlib import Path

import lief
from platforms import PLATFORMS, PYTHONS, Platform
from wheels import VERSION

GLIBC = (2, 17)  # manylinux_2_17
MACOS = (11, 0)
# MB; a module of 4 to 7 that doubles has something in it that does not belong there
MAX_MEGABYTES = 16
LIBRARIES = {
    "Linux": re.compile(r"(libc|libm|libpthread|libdl|librt)\.so\.\d|ld-linux-[\w-]+\.so\.\d"),
    "Windows": re.compile(r"python3\d\d\.dll|KERNEL32\.dll|ntdll\.dll|api-ms-win-crt-[\w-]+\.dll", re.IGNORECASE),
    "Darwin": re.compile(r"/usr/lib/libSystem\.B\.dylib"),
}
FORMATS = {"Linux": lief.ELF.Binary, "Windows": lief.PE.Binary, "Darwin": lief.MachO.Binary}
MACHINES = {
    "x86_64": {lief.ELF.ARCH.X86_64, lief.MachO.Header.CPU_TYPE.X86_64},
    "AMD64": {lief.PE.Header.MACHINE_TYPES.AMD64},
    "aarch64": {lief.ELF.ARCH.AARCH64},
    "arm64": {lief.MachO.Header.CPU_TYPE.ARM64},
}


def _machine(binary: object) -> object:
    header = binary.header  # type: ignore[attr-defined]
    return getattr(header, "machine_type", None) or getattr(header, "machine", None) or header.cpu_type


def stray_frames(binary: lief.MachO.Binary) -> int:
    """How many frames of __eh_frame begin outside the instructions, as those that the linker of LLVM 14 writes: an exception that
    passes through one ends the program."""
    sections = {section.name: section for section in binary.sections}
    code = [sections[name] for name in ("__text", "__lcxx_override") if name in sections]
    ranges = [(section.virtual_address, section.virtual_address + section.size) for section in code]
    if "__eh_frame" not in sections:
        return 0
    content, start = bytes(sections["__eh_frame"].content), sections["__eh_frame"].virtual_address
    stray, at = 0, 0
    while at + 8 <= len(content):
        length, kind = struct.unpack_from("<II", content, at)
        if length and kind:  # else the end, or what several frames have in common
            function = start + at + 8 + struct.unpack_from("<q", content, at + 8)[0]
            stray += not any(first <= function < end for first, end in ranges)
        at += 4 + length
    return stray


def module_faults(platform: Platform, python: str, content: bytes) -> list[str]:
    """What is wrong with a compiled module."""
    faults = []
    parsed = lief.parse(list(content))
    binary = parsed.at(0) if isinstance(parsed, lief.MachO.FatBinary) else parsed
    if not isinstance(binary, FORMATS[platform.system]):
        return [f"is no {platform.system} library"]
    if _machine(binary) not in MACHINES[platform.processor]:
        faults.append(f"is for {_machine(binary)}")
    libraries = [library if isinstance(library, str) else library.name for library in binary.libraries]
    faults += [f"loads {name}" for name in libraries if not LIBRARIES[platform.system].fullmatch(name)]
    exported = {function.name.lstrip("_") for function in binary.exported_functions}
    if "PyInit__native" not in exported:
        faults.append("does not export PyInit__native")
    if len(exported) > 1 and platform.system != "Windows":  # where names of one module never meet those of another
        faults.append(f"exports {len(exported) - 1} more names, such as {min(exported - {'PyInit__native'})}")
    if platform.system == "Linux":
        versions = {v for r in binary.symbols_version_requirement for v in (a.name for a in r.get_auxiliary_symbols())}
        newest = max(tuple(map(int, v[6:].split("."))) for v in versions if re.fullmatch(r"GLIBC_[\d.]+", v))
        if newest[:2] > GLIBC:
            faults.append(f"needs glibc {'.'.join(map(str, newest))}")
    if platform.system == "Windows" and not any(name.lower() == f"python{python}.dll" for name in libraries):
        faults.append(f"does not load python{python}.dll")
    if platform.system == "Darwin":
        stray = stray_frames(binary)
        if stray:
            faults.append(f"has {stray} frames for exceptions that belong to no function")
        least = binary.build_version.minos if binary.has_build_version else binary.version_min.version
        if tuple(least[:2]) != MACOS:
            faults.append(f"runs from macOS {'.'.join(map(str, least))} on")
        shared = {lief.MachO.Header.FLAGS.WEAK_DEFINES, lief.MachO.Header.FLAGS.BINDS_TO_WEAK}
        if shared & set(binary.header.flags_list):
            faults.append("shares C++ functions with other libraries of its process")
        if platform.processor == "arm64" and not binary.has_code_signature:
            faults.append("has no signature, without which arm64 loads nothing")
    return faults


def wheel_faults(path: Path) -> list[str]:
    """What is wrong with a wheel."""
    _, version, python, abi, tag = path.stem.split("-", 4)
    platform = next((p for p in PLATFORMS.values() if p.wheel_tag == tag), None)
    if version != VERSION or python != abi or python[2:] not in PYTHONS or platform is None:
        return ["has a wrong name"]
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        modules = [name for name in names if name.startswith("tripatch/_native.") and not name.endswith(".pyi")]
        if modules != [f"tripatch/_native{platform.module_suffix.format(python=python[2:])}"]:
            return [f"holds {modules}"]
        faults = module_faults(platform, python[2:], archive.read(modules[0]))
        info = f"tripatch-{version}.dist-info"
        if f"Tag: {python}-{abi}-{tag}" not in archive.read(f"{info}/WHEEL").decode().splitlines():
            faults.append("says another tag inside")
        wanted = {
            f"{info}/licenses/{name}"
            for name in ("LICENSE", "THIRD_PARTY.txt", "OpenSubdiv-LICENSE.txt", "OpenSubdiv-NOTICE.txt")
        }
        faults += [f"lacks {name}" for name in sorted((wanted | {"tripatch/__init__.py", "tripatch/py.typed"}) - set(names))]
    if path.stat().st_size > MAX_MEGABYTES * 2**20:
        faults.append(f"is {path.stat().st_size >> 20} MB large")
    return faults


def extension_faults(path: Path) -> list[str]:
    """What is wrong with an extension zip."""
    with zipfile.ZipFile(path) as archive:
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
        inside = sorted(f"./{name}" for name in archive.namelist() if name.startswith("wheels/"))
    faults = []
    if manifest["version"] != VERSION:
        faults.append(f"is of version {manifest['version']}")
    if sorted(manifest["wheels"]) != inside:
        faults.append("names other wheels than it holds")
    (platform,) = manifest["platforms"]
    expected = {f"-cp{python}-{PLATFORMS[platform].wheel_tag}.whl" for python in PYTHONS}
    lacking = [end for end in sorted(expected) if not any(name.endswith(end) for name in inside)]
    return faults + [f"lacks the wheel {end}" for end in lacking]


def main(paths: list[str]) -> int:
    """Prints a line for each file; how many have faults."""
    bad = 0
    for path in map(Path, paths):
        faults = wheel_faults(path) if path.suffix == ".whl" else extension_faults(path)
        bad += bool(faults)
        print(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB: {'; '.join(faults) or 'good'}")
    return bad


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
