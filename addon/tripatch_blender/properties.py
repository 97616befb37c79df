# SPDX-License-Identifier: GPL-3.0-or-later
"""Options of the library's table as properties of operators, with its names, defaults, ranges and sentences."""

import math

from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, IntVectorProperty

from . import library

#: name -> option; nothing where the library is missing: no operator can run then.
OPTIONS = {} if library.missing else library.tripatch.OPTIONS

_CLOSE = 0.001  # to an end that is excluded
_INTEGERS = 2**31 - 1


def words(name):
    return "Automatic" if name == "auto" else name.replace("_", " ").title()


def label(named):
    """What a panel calls an option, or the value of a choice."""
    return named.label or words(named.name)


#: Methods that are no paper's construction, by their names in a panel.
METHODS = {
    name: called
    for name, called, _ in library.items("method", "auto", "multi_sided", "polyharmonic_spline", "quad_rows", "annulus")
}


def method_label(name):
    """A method as a panel names it; those of papers with the continuity that they keep."""
    return METHODS.get(name) or f"{words(name)} ({library.tripatch.METHODS[name].continuity})"


#: Fairing as a panel has it: an energy of a paper, or simply on or off.
FAIRING = {name: called for name, called, _ in library.items("fairing", "auto", "isometric", "none")}


def seen(option):
    """What one will see when an option is changed: its tooltip."""
    return option.seen or option.description


def method_items(usable):
    """Auto and the methods for which `usable` holds."""
    methods = [m for m in library.tripatch.METHODS.values() if usable(m)]
    items = [(m.name, method_label(m.name), m.description) for m in methods]
    return [("auto", *library.titled("method_auto")), *items]


def _items(option):
    if option.name == "method":
        return method_items(lambda method: method.fills_holes)
    items = [(c.name, label(c), c.description) for c in option.choices if not c.misprint]
    if option.none is not None:
        items.append((option.none.name, words(option.none.name), option.none.description))
    if option.name == "fairing":
        items = [(name, FAIRING.get(name, called), about) for name, called, about in items]
    return items


def limits(option, whole=False):
    """The ranges; an infinite end is left to Blender."""
    shift = _CLOSE if option.range.open else 0
    ends = {"min": option.range.least + shift, "max": option.range.most - shift}
    ends |= {"soft_min": max(option.soft.least, ends["min"]), "soft_max": min(option.soft.most, ends["max"])}
    return {name: int(end) if whole else end for name, end in ends.items() if math.isfinite(end)}


def of(option, **given):
    """The property of an option; given: what it has otherwise than the table."""
    common = {"name": label(option), "description": seen(option), "default": option.default}
    if option.selection:
        common["options"] = {"SKIP_SAVE"}
    if option.kind == "flag":
        return BoolProperty(**(common | given))
    if option.kind == "choice":
        return EnumProperty(**({"items": _items(option)} | common | given))
    if option.kind == "whole":
        sized = {"size": option.count} if option.count > 1 else {}
        return (IntVectorProperty if sized else IntProperty)(**(sized | common | limits(option, whole=True) | given))
    if option.unit == "scene units":
        common["precision"] = 4
    if option.count > 1:
        return FloatVectorProperty(**({"size": option.count} | common | limits(option) | given))
    return FloatProperty(**(common | limits(option) | given))


def by_side(option, **given):
    """Three numbers, one a side."""
    common = {"name": label(option), "description": seen(option)}
    return FloatVectorProperty(**({"size": 3, "default": (option.default,) * 3} | common | limits(option) | given))


def declare(cls, properties):
    """Gives a class that Blender will register these properties."""
    cls.__annotations__ = cls.__dict__.get("__annotations__", {}) | properties
