"""`tripatch batch --emit`: every command and job does its part, and all parts together the whole."""

from __future__ import annotations

import ctypes
import json
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from test_batch import heads, lines, run, spheres
from tripatch import __main__ as cli
from tripatch.batch import journal

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def source(tmp_path):
    return spheres(tmp_path / "in put", 7)


def emitted(capsys, source, kind, *more):
    code, out, err = run(capsys, source, "--out", source.parent / "out", "--emit", kind, "--chunk", 3, *more)
    assert code == 0
    return out, err


def words_of(text):
    """As the system's own programs get them."""
    if sys.platform != "win32":
        (program, *words) = shlex.split(text)
    else:
        count = ctypes.c_int()
        split = ctypes.windll.shell32.CommandLineToArgvW
        split.restype = ctypes.POINTER(ctypes.c_wchar_p)
        (program, *words) = split(text.strip(), ctypes.byref(count))[: count.value]
    assert program == "tripatch"
    return words


def test_commands_do_the_whole_in_any_order(source, capsys):
    out, err = emitted(capsys, source, "commands", "--bulge", "1.5", "--worst", "0")
    commands = out.splitlines()
    assert len(commands) == 3
    for command in reversed(commands):
        assert cli.main(words_of(command)) == 0
    capsys.readouterr()
    assert cli.main(words_of(err.partition("gathers their lines: ")[2])) == 0
    assert "7 done before" in capsys.readouterr().err
    alone = source.parent / "alone"
    run(capsys, source, "--out", alone, "--workers", 0, "--worst", 0, "--bulge", "1.5")
    assert (alone / journal.LINES).read_bytes() == (source.parent / "out" / journal.LINES).read_bytes()
    assert heads(alone)["m000.obj"]["options"] == {"bulge": 1.5}


def test_commands_are_quoted_for_the_shell_of_windows(source, capsys, monkeypatch):
    monkeypatch.setattr("sys.platform", "win32")
    out, _ = emitted(capsys, source, "commands")
    assert f'--out "{source.parent / "out"}"' in out or f"--out {source.parent / 'out'}" in out
    assert "in put" in out and "'" not in out
    assert 'root="' in out or '"--root=' in out


def test_what_writes_nothing_and_what_writes_a_list_do_not_go_together(source, capsys):
    out = source.parent / "never"
    code, said, told = run(capsys, source, "--out", out, "--emit", "commands", "--dry-run")
    assert code == 2
    assert not said
    assert "--emit and --dry-run cannot be used together" in told
    assert not out.exists()


def test_a_portion_leaves_the_lines_to_who_gathers(source, capsys):
    out, _ = emitted(capsys, source, "commands")
    assert cli.main(words_of(out.splitlines()[1])) == 0
    folder = source.parent / "out"
    assert sorted(p.name for p in folder.glob("*.obj")) == ["m003.obj", "m004.obj", "m005.obj"]
    assert not (folder / journal.LINES).exists()


def test_a_portion_goes_through_whatever_is_in_it(source, capsys):
    """A manager would give up the job, or try it again and again."""
    (source / "m000.obj").write_text("v x\n")
    out, _ = emitted(capsys, source, "commands", "--worst", "0")
    assert cli.main(words_of(out.splitlines()[0])) == 0


@pytest.mark.skipif(shutil.which("bash") is None, reason="SLURM runs it by bash")
def test_the_sbatch_script(source, capsys, tmp_path):
    out, _ = emitted(capsys, source, "slurm", "--worst", "0", "--memory-limit", "3000")
    script = tmp_path / "fill.sbatch"
    script.write_text(out)
    subprocess.run(["bash", "-n", script], check=True)
    assert "#SBATCH --array=0-2\n" in out
    assert "#SBATCH --mem=3500M\n" in out
    # run as SLURM does, with a program in its place that writes down its arguments
    (tmp_path / "tripatch").write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n')
    (tmp_path / "tripatch").chmod(0o755)
    for task, expected in ((0, "1-3"), (2, "7-9")):
        environment = {"PATH": f"{tmp_path}:/usr/bin:/bin", "SLURM_ARRAY_TASK_ID": str(task)}
        said = subprocess.run(["bash", script], env=environment, capture_output=True, text=True, check=True).stdout.splitlines()
        assert said[said.index("--range") + 1] == expected
        assert said[said.index("--files") + 1] == str(source.parent / "out" / journal.FOLDER / "files.txt")
    assert cli.main(said) == 0  # what lies beyond the end is nothing
    said = subprocess.run(
        ["bash", script, "gather"], env=environment, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert cli.main(said) == 0
    assert len(lines(source.parent / "out")) == 21


def test_the_openjd_template(source, capsys):
    model = pytest.importorskip("openjd.model")
    out, _ = emitted(capsys, source, "openjd", "--worst", "0", "--time-limit", "60")
    template = model.decode_job_template(template=json.loads(out))
    made = model.create_job(
        job_template=template,
        job_parameter_values=model.preprocess_job_parameters(
            job_template=template,
            job_parameter_values={},
            job_template_dir=source,
            current_working_dir=source,
        ),
    )
    fill, gather = made.steps
    assert [dependency.dependsOn for dependency in gather.dependencies] == ["Fill"]
    tasks = list(model.StepParameterSpaceIterator(space=fill.parameterSpace))
    assert [task["Range"].value for task in tasks] == ["1-3", "4-6", "7-7"]
    values = {"{{Task.Param.Range}}": "4-6", "{{Param.Files}}": json.loads(out)["parameterDefinitions"][0]["default"]}
    values["{{Param.Out}}"] = json.loads(out)["parameterDefinitions"][1]["default"]
    action = json.loads(out)["steps"][0]["script"]["actions"]["onRun"]
    assert action["command"] == "tripatch"
    assert cli.main([values.get(word, word) for word in action["args"]]) == 0
    assert len(list((source.parent / "out").glob("*.obj"))) == 3


def test_flamencos_job_type(source, capsys):
    quickjs = pytest.importorskip("quickjs")
    out, _ = emitted(capsys, source, "flamenco", "--worst", "0", "--bulge", "1.5")
    job = json.loads(out)
    script = ROOT / "contrib" / "flamenco" / f"{job['type']}.js"  # the manager finds a type by the name of its script
    engine = quickjs.Context()
    # what Flamenco Manager hands to scripts: author.Task, author.Command, job.addTask
    engine.eval("""
        class Task {
            constructor(name, type) { this.name = name; this.type = type; this.commands = []; this.after = []; }
            addCommand(command) { this.commands.push(command); }
            addDependency(task) { this.after.push(task.name); }
        }
        const author = { Task: (name, type) => new Task(name, type), Command: (name, parameters) => ({ name, parameters }) };
    """)
    engine.eval(script.read_text())
    kinds = json.loads(engine.eval("JSON.stringify(JOB_TYPE)"))["settings"]
    assert {kind["key"] for kind in kinds if kind.get("required") and "default" not in kind} <= set(job["settings"])
    assert set(job["settings"]) <= {kind["key"] for kind in kinds}
    assert {kind["type"] for kind in kinds} <= {"string", "int32", "float", "bool"}
    engine.eval(
        f"const job = {{ settings: {json.dumps(job['settings'])}, tasks: [], addTask(task) {{ this.tasks.push(task); }} }};"
    )
    engine.eval("compileJob(job);")
    tasks = json.loads(engine.eval("JSON.stringify(job.tasks)"))
    assert [task["name"] for task in tasks] == ["fill-1-3", "fill-4-6", "fill-7-7", "gather"]
    assert tasks[-1]["after"] == ["fill-1-3", "fill-4-6", "fill-7-7"]
    for task in tasks:
        (command,) = task["commands"]
        assert (command["name"], command["parameters"]["exe"]) == ("exec", "tripatch")
        assert cli.main(command["parameters"]["args"]) == 0
    assert len(lines(source.parent / "out")) == 21
