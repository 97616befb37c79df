"""Runs inside Blender, which `blender.work` starts for one .blend: fills it, lists its holes, or gathers what pictures need."""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import os
import sys
from typing import Any

import addon_utils
import bpy

NAME, EXTENSION = "tripatch_blender", "tripatch"  # its folder, and its id among extensions
# as record.py names them, which needs the library
UNREADABLE, CRASHED, NOT_WRITTEN, MEMORY_LIMIT = "unreadable", "crashed", "not written", "memory limit"


class Stop(Exception):
    """Nothing becomes of this file. code, parameters: of a message, which this Blender may lack."""

    def __init__(self, status: str, code: str | None, **parameters: str) -> None:
        super().__init__(code)
        self.answer = {"status": status, "code": code, "parameters": parameters}


def command_line(asked: dict[str, Any]) -> Any:
    """The add-on's command line: of the installed add-on, else of the folder that was named."""
    installed = [module.__name__ for module in addon_utils.modules() if module.__name__.split(".")[-1] in (NAME, EXTENSION)]
    if installed and not asked["addon"]:
        addon_utils.enable(installed[0])
        name = installed[0]
    else:
        sys.path.append(asked["package"])  # after what Blender's Python has itself
        sys.path[:0] = [asked["addon"]] if asked["addon"] else []
        name = NAME
    try:
        module = importlib.import_module(name + ".command_line")
    except ImportError as error:
        raise Stop(CRASHED, "addon_missing", reason=str(error)) from None
    if module.library.missing:
        raise Stop(CRASHED, "addon_missing", reason=module.library.missing)
    if module.tripatch.__version__ != asked["version"]:
        raise Stop(CRASHED, "other_version", found=module.tripatch.__version__, wanted=asked["version"])
    return module


def opened(path: str) -> None:
    """Opens a file, if this Blender understands all of it."""
    try:
        bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
    except RuntimeError as error:
        reason = str(error).strip().replace(path, os.path.basename(path))  # the same on every machine
        raise Stop(UNREADABLE, "blender_cannot_open", reason=reason) from None
    if tuple(bpy.data.version[:2]) > tuple(bpy.app.version[:2]):
        saved, running = (".".join(map(str, version[:2])) for version in (bpy.data.version, bpy.app.version))
        raise Stop(UNREADABLE, "blender_too_old", saved=saved, running=running)


def objects() -> list[Any]:
    """The mesh objects of the scene, one for each mesh."""
    first: dict[str, Any] = {}
    for ob in bpy.context.scene.objects:
        if ob.type == "MESH":
            first.setdefault(ob.data, ob)
    return list(first.values())


def arrays(ob: Any, np: Any) -> tuple[Any, ...]:
    """Positions in world space and faces of an object's mesh."""
    mesh = ob.data
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    matrix = np.array(ob.matrix_world)
    return points.reshape(-1, 3).astype(float) @ matrix[:3, :3].T + matrix[:3, 3], [list(p.vertices) for p in mesh.polygons]


def listed(module: Any, options: dict[str, Any]) -> list[dict[str, Any]]:
    """The holes that would be filled."""
    choosing = {k: v for k, v in options.items() if "choose_holes" in module.tripatch.OPTIONS[k].functions}
    np = module.library.np
    holes: list[dict[str, Any]] = []
    for ob in objects():
        points, faces = arrays(ob, np)
        try:
            loops = module.tripatch.choose_holes(points, faces, **choosing) if faces else []
        except module.tripatch.Refusal as refusal:
            holes.append({"object": ob.name, "hole": len(holes), "status": "refused", "reason": refusal.reason})
            holes[-1]["codes"] = [each.code for each in refusal.messages]
            continue
        for loop in loops:
            place = {"object": ob.name, "hole": len(holes), "vertex": int(loop[0]), "edges": len(loop)}
            holes.append({**place, "diameter": float(np.linalg.norm(np.ptp(points[loop], axis=0))), "status": "listed"})
    return holes


def filled(module: Any, asked: dict[str, Any]) -> list[dict[str, Any]]:
    """Fills every hole and saves the file; what became of the holes."""
    from tripatch.batch import record
    from tripatch.batch.in_words import given

    before = {ob.name: len(ob.data.polygons) for ob in objects()}
    report = asked["answer"] + ".report"
    options = {"method": "auto", **asked["options"]}
    said = io.StringIO()
    with contextlib.redirect_stderr(said):
        code = module.main(["--all", *given(options), "--out", asked["output"], "--report", report], prog="tripatch batch")
    if code == module.EXIT_USAGE:
        raise Stop(CRASHED, "blender_refused_options", reason=(said.getvalue().strip().splitlines() or ["?"])[-1])
    holes: list[dict[str, Any]] = []
    with open(report, encoding="utf-8") as file:
        for ob in json.load(file):
            measured = measures(module, ob["object"], before.get(ob["object"]), len(ob["filled"]))
            for values, own in zip(ob["filled"], measured):
                place = {"object": ob["object"], "hole": len(holes), "status": record.FILLED}
                holes.append({**place, **record.reported(values), **own, "corners": None})  # they count in what was cut out
            for reason in ob["refused"]:
                holes.append({"object": ob["object"], "hole": len(holes), "status": record.REFUSED, "reason": reason})
    if code in (module.EXIT_ALL, module.EXIT_SOME) and not os.path.exists(asked["output"]):
        raise Stop(NOT_WRITTEN, "blender_cannot_save")
    return holes


def measures(module: Any, name: str, before: int | None, count: int) -> list[dict[str, Any]]:
    """What lines say of an object's fills beyond their reports; nothing where its new faces are not as many parts as fills."""
    ob, np = bpy.context.scene.objects.get(name), module.library.np
    if ob is None or before is None:
        return [{}] * count
    from tripatch.batch import creases

    points, faces = arrays(ob, np)
    old, fills = faces[:before], together(faces[before:])
    if len(fills) != count:
        return [{}] * count
    of_old, found = {v for face in old for v in face}, []
    rims = [border(fill) for fill in fills]
    sharp = creases.largest(points, old, [(points[:0], fill, np.array(rim)) for fill, rim in zip(fills, rims)])
    for fill, rim, crease in zip(fills, rims, sharp):
        new = {v for face in fill for v in face} - of_old
        found.append(
            {"vertex": min(rim), "edges": len(rim), "new_vertices": len(new), "new_faces": len(fill), "crease_max": crease}
        )
        found[-1]["diameter"] = float(np.linalg.norm(np.ptp(points[rim], axis=0)))
    return found


def border(faces: list[Any]) -> list[int]:
    """The vertices around faces that hang together, in order."""
    after: dict[int, int] = {}
    edges = {(a, b) for face in faces for a, b in zip(face, [*face[1:], face[0]])}
    for a, b in edges:
        if (b, a) not in edges:
            after[a] = b
    loop = [min(after)]
    while after[loop[-1]] != loop[0] and len(loop) < len(after):
        loop.append(after[loop[-1]])
    return loop


def shown(module: Any, asked: dict[str, Any]) -> list[Any]:
    """Pictures' data of fills in the file that was made: an object's new faces come after its old, those of a fill together."""
    np = module.library.np
    from tripatch.batch import crops

    before = {ob.name: len(ob.data.polygons) for ob in objects()}
    opened(asked["filled"])
    pictures: list[dict[str, Any] | None] = []
    for name, _, nth in asked["holes"]:
        ob = bpy.context.scene.objects.get(name)
        if ob is None or ob.name not in before:
            pictures.append(None)
            continue
        points, faces = arrays(ob, np)
        old, new = faces[: before[name]], faces[before[name] :]
        fills = together(new)
        if nth >= len(fills):
            pictures.append(None)
            continue
        rim = sorted({v for face in fills[nth] for v in face} & {v for face in old for v in face})
        crop = crops.of_parts(points, crops.around(old, rim, len(points)), fills[nth])
        pictures.append({**crop, "vertices": crop["vertices"].tolist()})
    return pictures


def together(faces: list[Any]) -> list[list[Any]]:
    """Faces by what hangs together, in the order of the first of each."""
    group: dict[int, int] = {}

    def top(v: int) -> Any:
        while group.setdefault(v, v) != v:
            v = group[v]
        return v

    for face in faces:
        for v in face[1:]:
            group[top(v)] = top(face[0])
    parts: dict[int, list[Any]] = {}
    for face in faces:
        parts.setdefault(top(face[0]), []).append(face)
    return list(parts.values())


def main(path: str) -> None:
    with open(path, encoding="utf-8") as file:
        asked = json.load(file)
    try:
        opened(asked["input"])
        module = command_line(asked)
        meshes = [ob.data for ob in objects()]
        answer: dict[str, Any] = {
            "vertices": sum(len(mesh.vertices) for mesh in meshes),
            "faces": sum(len(mesh.polygons) for mesh in meshes),
        }
        if asked["mode"] == "crop":
            answer = {"crops": shown(module, asked)}
        else:
            answer["holes"] = listed(module, asked["options"]) if asked["mode"] == "list" else filled(module, asked)
    except Stop as stop:
        answer = stop.answer
    except MemoryError:
        answer = {"status": MEMORY_LIMIT, "code": None}
    part = asked["answer"] + ".part"
    with open(part, "w", encoding="utf-8") as file:
        json.dump(answer, file)
    os.replace(part, asked["answer"])


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1])
