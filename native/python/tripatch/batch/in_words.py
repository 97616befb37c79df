"""Options as words of a command line: for Blender, and for the commands of a render farm."""

from __future__ import annotations

import json
from typing import Any


def given(options: dict[str, Any]) -> list[str]:
    """Words that `arguments.add` reads back to the same options."""
    words = []
    for name, value in options.items():
        flag = f"--{name.replace('_', '-')}"
        if value is True:
            words.append(flag)
        elif value is not False:
            if isinstance(value, dict):
                value = json.dumps(value)
            elif isinstance(value, list):
                value = ",".join(map(str, value))
            words.append(f"{flag}={'none' if value is None else value}")  # with =: the value may start with a minus
    return words
