"""Packs the add-on for Blender: an extension zip per platform, wheels inside, and the classic zip for Blender 3.4 to 4.1."""

from __future__ import annotations

import argparse
import json
import tomllib
import zipfile
from pathlib import Path

from platforms import PLATFORMS
from wheels import PROJECT, ROOT, VERSION, add

ADDON = ROOT / "addon" / "tripatch_blender"
PLACEHOLDER = "https://tripatch.example"


def platform_of(wheel: Path) -> str:
    """The name of the platform in extension manifests."""
    tag = wheel.stem.split("-", 4)[4]
    system = next(s for s, start in (("Windows", "win"), ("Darwin", "macos"), ("Linux", "")) if tag.startswith(start))
    return next(p.name for p in PLATFORMS.values() if p.system == system and tag.endswith(p.processor.lower()))


def manifest(platform: str, wheels: list[Path]) -> str:
    """The add-on's manifest with what holds for the whole project and for this zip."""
    text = (ADDON / "blender_manifest.toml").read_text(encoding="utf-8")
    added = {
        "website": PROJECT["project"]["urls"]["Homepage"],
        "copyright": PROJECT["tool"]["tripatch"]["copyright"],
        "platforms": [platform],
        "wheels": [f"./wheels/{w.name}" for w in wheels],
    }
    lines = "".join(f"{key} = {json.dumps(value)}\n" for key, value in added.items())
    text = text.replace("\n[permissions]", f"{lines}\n[permissions]")
    read = tomllib.loads(text)
    assert {key: read[key] for key in added} == added
    assert read["version"] == VERSION, "blender_manifest.toml has another version than pyproject.toml"
    return text


def source(path: Path) -> bytes:
    """The content of a file of the add-on, with the project's website."""
    return path.read_bytes().replace(PLACEHOLDER.encode(), PROJECT["project"]["urls"]["Homepage"].rstrip("/").encode())


def files() -> list[Path]:
    found = (p for p in ADDON.rglob("*") if p.is_file() and "__pycache__" not in p.parts)
    return sorted(p for p in found if p.name != "blender_manifest.toml")


def extension(platform: str, wheels: list[Path], folder: Path) -> Path:
    archive_path = folder / f"tripatch-{VERSION}-blender-{platform}.zip"
    with zipfile.ZipFile(archive_path, "w") as archive:
        add(archive, "blender_manifest.toml", manifest(platform, wheels).encode())
        for path in files():
            if path.name != "vendored.py":
                add(archive, path.relative_to(ADDON).as_posix(), source(path))
        add(archive, "LICENSE", (ROOT / "LICENSE").read_bytes())
        for each in wheels:
            add(archive, f"wheels/{each.name}", each.read_bytes())
    return archive_path


def classic(wheel: Path, folder: Path) -> Path:
    archive_path = folder / f"tripatch-{VERSION}-blender-classic.zip"
    with zipfile.ZipFile(archive_path, "w") as archive, zipfile.ZipFile(wheel) as content:
        for path in files():
            add(archive, path.relative_to(ADDON.parent).as_posix(), source(path))
        add(archive, "tripatch_blender/LICENSE", (ROOT / "LICENSE").read_bytes())
        for name in content.namelist():
            add(archive, f"tripatch_blender/_vendor/{name}", content.read(name))
    return archive_path


def main() -> None:
    """One extension per platform of the wheels in a folder, and the classic zip of the first wheel of one platform."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--classic", metavar="PLATFORM", help="the platform of the classic zip")
    arguments = parser.parse_args()
    wheels: dict[str, list[Path]] = {}
    for wheel in sorted(arguments.folder.glob(f"tripatch-{VERSION}-cp*.whl")):
        wheels.setdefault(platform_of(wheel), []).append(wheel)
    for platform, of_platform in wheels.items():
        print(extension(platform, of_platform, arguments.folder))
        if platform == arguments.classic:
            print(classic(of_platform[0], arguments.folder))


if __name__ == "__main__":
    main()
