# SPDX-License-Identifier: GPL-3.0-or-later
"""What the library and the add-on say, in Blender's words: sides and corners count from 1, options have the panel's labels."""

from __future__ import annotations

import functools

from . import library, properties

#: Codes of what a person can do something about.
_MENDABLE = {
    "edge_without_length",
    "edges_without_length",
    "vertices_at_one_place",
    "edges_on_borders",
    "rim_on_borders",
    "faces_flipped",
    "face_flipped",
    "non_manifold_edge",
    "option_of_other_methods",
    "options_not_taken",
    "options_need_smooth_sides",
    "option_needs_three_sides",
}


@functools.cache
def _labels():
    """Options and methods as the panel has them."""
    methods = {name: properties.METHODS.get(name) or properties.words(name) for name in library.tripatch.METHODS}
    return methods | {name: properties.label(option) for name, option in properties.OPTIONS.items()}


def _worded(said, vertices):
    """said: a message, an error that holds one, or text."""
    said = library.tripatch.errors.because(said) if isinstance(said, Exception) else said
    worded = getattr(said, "worded", None)
    return worded(panel=True, vertices=vertices, names=_labels()) if worded else str(said)


def said(code, **parameters):
    """The sentence of a code, as plain text."""
    return for_people(library.tripatch.Message(code, parameters))


def for_people(said):
    """The sentence, with numbers of vertices."""
    return _worded(said, "numbered")


def of_selected(said):
    """For the window, where a refusal selects the vertices that it is about."""
    return _worded(said, "selected")


def of_filled(said):
    """For the window, of holes that are filled: no vertex is selected, and nobody sees its number."""
    return _worded(said, "unnamed")


def can_be_mended(said):
    """Whether a person can do something about what is said."""
    return not _MENDABLE.isdisjoint(getattr(said, "codes", ()))
