"""One .blend: opened, filled and saved by a Blender of its own, and renamed when it is whole."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import because
from ..messages import Message
from . import crops, job, memory, record
from .settings import CROP, Settings

_SCRIPT = Path(__file__).with_name("in_blender.py")


def _asked(file: Path, part: Path, settings: Settings, holes: tuple[Any, ...], filled: Path) -> dict[str, Any]:
    root = Path(__file__).resolve().parents[2]
    tree = root.parents[1] / "addon"  # where TriPatch lies as its source tree
    addon = settings.addon or (os.fspath(tree) if (tree / "tripatch_blender").is_dir() else None)
    return {
        "input": os.fspath(file),
        "output": os.fspath(part),
        "mode": settings.mode,
        "options": settings.options,
        "version": settings.version,
        "addon": addon,
        "package": os.fspath(root),
        "filled": os.fspath(filled),
        "holes": list(holes),
    }


def _run(asked: dict[str, Any], program: str, memory_limit: int | None) -> dict[str, Any]:
    """What the script in Blender answers; else a status and a reason, None where the memory is short."""
    with tempfile.TemporaryDirectory(prefix="tripatch-") as folder:
        question, answer = Path(folder, "question.json"), Path(folder, "answer.json")
        question.write_text(json.dumps({**asked, "answer": os.fspath(answer)}), encoding="utf-8")
        command = [program, "--background", "--factory-startup", "--disable-autoexec", "-noaudio", "--python-exit-code", "9"]
        command += ["--python", os.fspath(_SCRIPT), "--", os.fspath(question)]
        streams: dict[str, Any] = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        try:
            ended = subprocess.Popen(command, **streams)
        except OSError:
            return {"status": record.CRASHED, "code": "blender_missing", "parameters": {"program": program}}
        watch = memory.Watch(ended.pid, memory_limit, ended.kill)
        out = ended.communicate()[0]
        watch.over()
        if watch.found:
            return {"status": record.MEMORY_LIMIT, "code": None}
        # a Blender that crashes after its answer has done what it was asked for
        if answer.exists():
            told: dict[str, Any] = json.loads(answer.read_bytes())
            return told
        said = out.decode(errors="replace").strip().splitlines()
    # Blender's own last word, that the script has failed, says nothing of why
    words = [line for line in said if ("Error" in line or "error" in line) and not line.startswith("Error: script failed")]
    how = {"signal": str(-ended.returncode)} if ended.returncode < 0 else {"code": str(ended.returncode)}
    how |= {"reason": words[-1][:200]} if words else {}
    return {"status": record.CRASHED, "code": "process_ended", "parameters": {"program": "Blender", **how}}


def work(file: Path, name: str, sha256: str, settings: Settings, begun: float, holes: tuple[Any, ...]) -> dict[str, Any]:
    """As `job.work`."""
    out = Path(settings.out, name)
    part = out.with_name(f".{out.stem}.part.blend")
    program = shutil.which(settings.blender)

    def told(status: str, reason: str) -> dict[str, Any]:
        line = record.of_file(settings, name, sha256=sha256, status=status, reason=reason)
        return job.entry(settings, name, sha256, [line], begun)

    if program is None:
        return told(record.CRASHED, Message("blender_missing", {"program": settings.blender}))
    try:
        if settings.mode == "fill":
            out.parent.mkdir(parents=True, exist_ok=True)
        answer = _run(_asked(file, part, settings, holes, out), program, settings.memory_limit)
        if settings.mode == CROP:
            parts = answer.get("crops", [])
            return {"crops": [c and crops.of_parts(np.array(c["vertices"]), c["around"], c["fill"]) for c in parts]}
        if "status" in answer:
            code = answer["code"]
            return told(answer["status"], Message(code, answer["parameters"]) if code else job.memory_reason(settings))
        lines = [record.of_hole(settings, name, **hole) for hole in answer["holes"]]
        values = {"sha256": sha256, "vertices": answer["vertices"], "faces": answer["faces"], **record.outcome(lines)}
        if values["filled"] and settings.mode == "fill":
            os.replace(part, out)
            values["output"] = name
        return job.entry(settings, name, sha256, [record.of_file(settings, name, **values), *lines], begun)
    except OSError as error:
        return told(record.NOT_WRITTEN, Message("file_unwritable", {"path": name, "reason": because(error)}))
    finally:
        part.unlink(missing_ok=True)
