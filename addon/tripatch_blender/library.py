# SPDX-License-Identifier: GPL-3.0-or-later
"""The geometry: NumPy and the tripatch package, or the sentence that says what is missing."""

import contextlib

with contextlib.suppress(ImportError):
    from . import vendored  # noqa: F401  in the classic zip only; an extension's wheel is installed by Blender

# Two messages of the library's table, which is not there when they are needed.
NEEDS_NUMPY = "TriPatch needs NumPy: install the package python3-numpy (apt install python3-numpy) and restart Blender"
LIBRARY_MISSING = "TriPatch cannot load its library: {error}"
#: One sentence for the user, empty when all is there.
missing = ""
np = tripatch = arguments = charts = constituents = passages = quality = words = index_lists = None
try:
    import numpy as np  # noqa: F401
except ImportError:
    missing = NEEDS_NUMPY
else:
    try:
        import tripatch.borders
        import tripatch.options
        from tripatch import arguments, charts, constituents, passages, quality, words  # noqa: F401
        from tripatch._arrays import index_lists  # noqa: F401
    except ImportError as error:
        missing = LIBRARY_MISSING.replace("{error}", str(error))


def titled(code):
    """A label and its tooltip, of the table of labels. Without the library nothing works, and the code in words will do."""
    if missing:
        return code.replace("_", " ").title(), ""
    return tripatch.messages.label(code), tripatch.messages.text(code)


def label(code):
    return titled(code)[0]


def named(code):
    """The same for a property."""
    return dict(zip(("name", "description"), titled(code), strict=True))


def items(code, *names):
    """The values of an enumeration; the codes of their labels begin with its own."""
    return [(name, *titled(f"{code}_{name.lower()}")) for name in names]


#: Methods that fill holes with any number of corners.
ANY_RIM = ("auto", "polyharmonic_spline", "quad_rows", "multi_sided")


def poll(operator, context, mode, code):
    """Whether an operator can run; Blender shows the reason if not. code: of the message for another mode."""
    if missing or context.mode != mode:
        operator.poll_message_set(missing or str(tripatch.Message(code)))
        return False
    if mode == "EDIT_MESH" and not context.objects_in_mode_unique_data:  # those that are seen
        operator.poll_message_set(str(tripatch.Message("edited_mesh_hidden")))
        return False
    return True
