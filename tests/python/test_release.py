"""What scripts/package and scripts/release make, as far as that needs no other compiler."""

import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "packaging"))

import release  # noqa: E402
import wheels  # noqa: E402
from platforms import PLATFORMS, PYTHONS  # noqa: E402

import addon  # noqa: E402

PROJECT = 'version = "0.1.0"\n[project.urls]\nHomepage = "https://tripatch.org"\n'
CHANGELOG = "# Changelog\n\n## [Unreleased]\n\n- Fill any hole.\n\n## [0.0.1] - 2020-01-01\n"


@pytest.fixture
def packed(tmp_path, monkeypatch):
    """Makes wheels of any bytes for every platform, and the zips of them."""
    monkeypatch.setattr(wheels, "metadata", lambda: b"Metadata-Version: 2.1\nName: tripatch\n")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    opensubdiv = tmp_path / "opensubdiv"
    opensubdiv.mkdir()
    for name in ("LICENSE.txt", "NOTICE.txt"):
        (opensubdiv / name).write_text("text")

    def pack(folder, names=("linux-x64", "windows-x64")):
        folder.mkdir()
        for platform in (PLATFORMS[name] for name in names):
            for python in PYTHONS:
                module = tmp_path / f"_native{platform.module_suffix.format(python=python)}"
                module.write_bytes(b"compiled")
                wheels.write(platform, python, module, opensubdiv, folder)
        monkeypatch.setattr(sys, "argv", ["addon.py", str(folder), "--classic", "linux-x64"])
        addon.main()
        return folder

    return pack


def test_there_is_a_wheel_for_each_python_and_a_zip_for_each_platform(packed, tmp_path):
    folder = packed(tmp_path / "dist", PLATFORMS)
    assert len(list(folder.glob("*.whl"))) == len(PLATFORMS) * len(PYTHONS)
    for name, platform in PLATFORMS.items():
        with zipfile.ZipFile(folder / f"tripatch-{wheels.VERSION}-blender-{name}.zip") as archive:
            manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
            inside = sorted(n.removeprefix("wheels/") for n in archive.namelist() if n.startswith("wheels/"))
        assert manifest["platforms"] == [name]
        assert "blender" not in manifest["id"] + manifest["name"].lower()  # the platform's rule
        assert manifest["wheels"] == [f"./wheels/{w}" for w in inside]
        assert inside == [f"tripatch-{wheels.VERSION}-cp{p}-cp{p}-{platform.wheel_tag}.whl" for p in PYTHONS]
        assert any("Pixar" in holder for holder in manifest["copyright"])
    with zipfile.ZipFile(folder / f"tripatch-{wheels.VERSION}-blender-classic.zip") as archive:
        assert "tripatch_blender/_vendor/tripatch/__init__.py" in archive.namelist()


def test_two_runs_make_the_same_bytes(packed, tmp_path):
    one, other = packed(tmp_path / "one"), packed(tmp_path / "other")
    for path in sorted(one.iterdir()):
        assert path.read_bytes() == (other / path.name).read_bytes(), path.name


def test_a_wheel_lists_all_that_it_holds(packed, tmp_path):
    path = next(packed(tmp_path / "dist").glob("*win_amd64.whl"))
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        info = f"tripatch-{wheels.VERSION}.dist-info"
        record = archive.read(f"{info}/RECORD").decode()
        assert [line.split(",")[0] for line in record.splitlines()] == names
        assert f"Tag: {path.stem.split('-', 2)[2]}" in archive.read(f"{info}/WHEEL").decode()
        assert {f"{info}/licenses/LICENSE", f"{info}/licenses/OpenSubdiv-NOTICE.txt", "tripatch/py.typed"} <= set(names)
        assert "tripatch/_native.pyi" in names and names.count("tripatch/batch/keeper.py") == 1


def test_every_place_of_the_version_is_found():
    for name in release.PLACES:
        text = (ROOT / name).read_text(encoding="utf-8")
        assert release.with_version(text, name, wheels.VERSION) == text
        assert "9.8.7" in release.with_version(text, name, "9.8.7")


@pytest.mark.parametrize(
    "version, project, changelog, told",
    [
        ("1.0", PROJECT, CHANGELOG, "no version"),
        ("1.0.0", PROJECT.replace("tripatch.org", release.PLACEHOLDER), CHANGELOG, "placeholders"),
        ("0.0.1", PROJECT, CHANGELOG, "already"),
    ],
)
def test_what_is_not_ready_is_not_released(version, project, changelog, told):
    with pytest.raises(release.NotReady, match=told):
        release.check(version, project, changelog)


def test_without_news_there_is_no_release():
    release.check_news(CHANGELOG)
    with pytest.raises(release.NotReady, match="nothing under Unreleased"):
        release.check_news(CHANGELOG.replace("- Fill any hole.\n", ""))


@pytest.mark.skipif(not sys.platform.startswith("linux") or not shutil.which("git"), reason="releases are made on Linux")
def test_a_release_that_cannot_be_changes_nothing(tmp_path):
    def git(*words):
        command = ["git", "-c", "user.name=test", "-c", "user.email=test@localhost", *words]
        return subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout

    shutil.copytree(ROOT / "scripts", tmp_path / "scripts", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "changelog.d", tmp_path / "changelog.d")
    for name in ("pyproject.toml", "CHANGELOG.md"):
        shutil.copy(ROOT / name, tmp_path)
    (tmp_path / ".gitignore").write_text("build\n__pycache__\n")
    (tmp_path / "changelog.d" / "+news.fixed.md").write_text("News.\n")
    git("init", "-q")
    git("add", ".")
    git("commit", "-qm", "test")
    done = subprocess.run([tmp_path / "scripts" / "release", "1.0"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode != 0 and "no version such as 1.2.3" in done.stderr
    assert git("status", "--porcelain") == ""


def test_what_was_unreleased_becomes_the_section_of_the_version():
    release.check("1.0.0", PROJECT, CHANGELOG)
    new = release.with_section(CHANGELOG, "1.0.0", "2027-01-01")
    assert re.findall(r"## \[(.*?)\]", new) == ["Unreleased", "1.0.0", "0.0.1"]
    assert new.index("Fill any hole") > new.index("## [1.0.0] - 2027-01-01")
