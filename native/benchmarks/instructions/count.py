"""Counts the instructions of hot paths under callgrind, next to those that are kept in counts.json.

python count.py PROGRAM [keep]
"""

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

KEPT = Path(__file__).with_name("counts.json")
TOLERANCE = 0.05


def compiler() -> str:
    return subprocess.run(["c++", "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]


def count(program: str, path: str) -> int:
    with tempfile.TemporaryDirectory() as folder:
        options = ["--tool=callgrind", "--collect-atstart=no", "--toggle-collect=measured", f"--callgrind-out-file={folder}/out"]
        run = subprocess.run(["valgrind", *options, program, path], capture_output=True, text=True, check=True)
    return int(re.search(r"Collected : (\d+)", run.stderr)[1])


def main() -> int:
    program, keep = sys.argv[1], sys.argv[2:] == ["keep"]
    paths = subprocess.run([program], capture_output=True, text=True, check=True).stdout.splitlines()
    counts = {path: count(program, path) for path in paths}
    if keep:
        KEPT.write_text(json.dumps({"compiler": compiler(), "instructions": counts}, indent=2) + "\n")
    kept = json.loads(KEPT.read_text())
    same_compiler = kept["compiler"] == compiler()
    off = []
    for path, instructions in counts.items():
        before = kept["instructions"].get(path)
        change = instructions / before - 1 if before else float("inf")
        print(f"{path:24} {instructions:14,d}  {change:+7.1%}")
        if abs(change) > TOLERANCE:
            off.append(path)
    if not same_compiler:
        print(f"not compared: kept are those of {kept['compiler']}")
        return 0
    if off:
        print(f"more than {TOLERANCE:.0%} off: {', '.join(off)}; if that is meant, scripts/instructions keep")
    return 1 if off else 0


if __name__ == "__main__":
    sys.exit(main())
