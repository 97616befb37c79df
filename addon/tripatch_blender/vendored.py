# SPDX-License-Identifier: GPL-3.0-or-later
"""The package in the classic zip, which carries its wheel unpacked: for Blender before 4.2. scripts/package leaves this file out
of the extension, whose wheels Blender installs."""

import os
import sys

FOLDER = os.path.join(os.path.dirname(__file__), "_vendor")


def remember():
    """Adds the folder to the places where Python looks."""
    if os.path.isdir(FOLDER) and FOLDER not in sys.path:
        sys.path.append(FOLDER)


def forget():
    """Takes the folder out of the places where Python looks."""
    if FOLDER in sys.path:
        sys.path.remove(FOLDER)


remember()
