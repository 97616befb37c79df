# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of the panels of operators: rows, folded parts, and sentences in lines that are not cut."""

from __future__ import annotations

import textwrap
from contextlib import contextmanager

import bpy

from . import library

# A character is about so many pixels wide in Blender's font at the scale 1; a line is never shorter than so many characters.
_CHARACTER, _SHORTEST = 6.3, 28
#: Pixels of one of Blender's units at the scale 1.
UNIT = 20


class Rows:
    """row(*names, active=True) puts properties of an operator into a layout; without a layout it does nothing."""

    def __init__(self, operator, layout):
        self._operator, self._layout = operator, layout

    def __call__(self, *names, active=True, **given):
        if self._layout is None:
            return
        made = self._layout.row(align=True)
        made.active = active
        for name in names:
            made.prop(self._operator, name, **given)

    def choices(self, name, labels, heading=None, active=True):
        """Buttons for some values of a choice. labels: {value: what the button says}; heading: two in a row, next to it; none:
        each below the other."""
        if self._layout is None:
            return
        made = self._layout
        if heading:  # not that of a row, of which Blender draws each button in two parts
            made = made.split(factor=0.4)
            title = made.row()
            title.active, title.alignment = active, "RIGHT"
            title.label(text=heading)
            made = made.grid_flow(row_major=True, columns=2, even_columns=True, align=True)
        else:
            made = made.column(align=True)
        made.use_property_split = False
        made.active = active
        for value, label in labels.items():
            made.prop_enum(self._operator, name, value, text=label)

    def reasons(self, lines):
        """Why rows are greyed."""
        if self._layout is not None:
            for line in lines:
                sentence(self._layout, bpy.context, line)

    def label(self, text):
        if self._layout is not None:
            self._layout.label(text=text)

    def optional(self, switch, name):
        """A number next to the box that says whether it counts."""
        if self._layout is None:
            return
        prop = self._operator.properties.bl_rna.properties[switch]
        made = self._layout.row(align=True, heading=prop.name)
        made.prop(self._operator, switch, text="")
        number = made.row(align=True)
        number.active = getattr(self._operator, switch)
        number.prop(self._operator, name, text="")


@contextmanager
def folded(operator, name):
    """Rows for a part of the panel that is closed at first: from Blender 4.1 on a panel of its own, else behind an arrow."""
    layout, body, label = operator.layout, None, library.label(f"{name}_section")
    try:
        header, body = layout.panel(f"TRIPATCH_{name}", default_closed=True)
        header.label(text=label)
    except (AttributeError, RuntimeError):  # Blender 3 and 4.0; a place where panels cannot be folded
        shown = f"show_{name}"
        is_open = getattr(operator, shown)
        header = layout.row(align=True)
        header.use_property_split = False
        header.alignment = "LEFT"
        header.prop(operator, shown, text=label, icon="TRIA_DOWN" if is_open else "TRIA_RIGHT", emboss=False)
        if is_open:
            body = layout.column()
    yield Rows(operator, body)


def _lines(context, text, adjacent, width=None):
    """A sentence in lines as wide as the panel. next to: pixels that are taken; width: of a panel that is no region, at the scale
    1."""
    region = context.region
    if width is None:
        width = region.width / (bpy.context.preferences.system.ui_scale or 1) if region else 0
    return textwrap.wrap(text, max(_SHORTEST, int((width - adjacent) / _CHARACTER)))


def reasons(layout, context, text):
    """Why something was not filled."""
    if not text:
        return
    box = layout.box().column(align=True)
    box.scale_y = 0.8
    for reason in text.split("\n")[:4]:
        for k, line in enumerate(_lines(context, reason, 60)):
            box.label(text=line, icon="ERROR" if k == 0 else "BLANK1")


def sentence(layout, context, text, width=None):
    """Text in lines. width: see _lines."""
    column = layout.column(align=True)
    column.scale_y = 0.8
    for line in _lines(context, text, 40, width):
        column.label(text=line)
