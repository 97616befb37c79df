"""Runs a command with one write failing, for each of its writes, in a process of its own: prints what became of them as JSON.

fill_on_a_full_disk.py FOLDER WORD..., with the library of writes.c preloaded: `tripatch WORD...` in a copy of the folder. It may
leave the files that were there before, or those of a run without a failure.
"""

import ctypes
import json
import os
import shutil
import sys
from pathlib import Path

from tripatch.__main__ import main

folder, words = Path(sys.argv[1]), sys.argv[2:]
fail_at = ctypes.CDLL(None).fail_at
fail_at.restype = ctypes.c_long


def left():
    """The files in the current folder. A journal's name holds the time; its lines and those of a report, how long a fill took."""
    paths = [path for path in Path().rglob("*") if path.is_file() and "journal-" not in path.name]
    return {path.as_posix(): b"" if path.suffix in (".json", ".jsonl") else path.read_bytes() for path in paths}


def tried(k):
    """The exit code with the k-th write failing, what it says, the number of its writes, and what is left."""
    place = folder.with_name(f"{folder.name}-{k}")
    shutil.copytree(folder, place)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.chdir(place)
        said = os.open("../said", os.O_CREAT | os.O_TRUNC | os.O_WRONLY)
        os.dup2(said, 1)
        os.dup2(said, 2)
        fail_at(k)
        try:
            code = main(words)
        except SystemExit as end:
            code = end.code
        except BaseException as error:
            code = f"{type(error).__name__}: {error}"
        writes = fail_at(-1)
        os.write(writing, json.dumps([code, writes]).encode())
        os._exit(0)
    os.close(writing)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    code, writes = json.loads(os.read(reading, 10000)) if status == 0 else (f"ended with {status}", 0)
    os.close(reading)
    os.chdir(place)
    files = left()
    for report in Path().glob("*.json"):
        json.loads(report.read_text())
    os.chdir(folder)
    shutil.rmtree(place)
    return code, Path(folder.parent, "said").read_text(), writes, files


os.chdir(folder)
before = left()
code, said, writes, good = tried(-1)
assert code == 0 and good != before, (code, said)
outcomes, faults = {}, []
for k in range(writes):
    code, said, _, files = tried(k)
    outcomes[str(code)] = outcomes.get(str(code), 0) + 1
    others = [name for name, data in files.items() if data not in (before.get(name), good.get(name))]
    lost = [name for name in before if name not in files]
    if code == 0 and files != good:
        faults.append([k, "said to be done", sorted(set(files) ^ set(good)), said])
    elif others or lost:
        faults.append([k, "spoiled", others, "lost", lost, said])
    elif code != 0 and "No space left" not in said and "cannot be written" not in said:  # NumPy does not tell why
        faults.append([k, code, "not said", said])
    elif "Traceback" in said:
        faults.append([k, "said as a traceback", said])
print(json.dumps({"writes": writes, "outcomes": outcomes, "faults": faults}))
