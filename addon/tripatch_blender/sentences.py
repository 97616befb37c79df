# SPDX-License-Identifier: GPL-3.0-or-later
"""What the library says, as a person in Blender reads it: sides and corners count from 1, and remedies have Blender's names."""

from __future__ import annotations

import re

from . import library, properties

_NUMBERED = re.compile(r"\b([Ss]ides?|[Cc]orners?) (\d+)( and (\d+))?\b")

#: Options by the names that scripts give them.
_OPTIONS = re.compile(r"(?<=^For )[\w, ]+(?= smooth sides are needed)|(?<=does not take )[\w, ]+")
#: Names of options and methods that are no words.
_NAMES = re.compile(r"\b[a-z]+(_[a-z0-9]+)+\b")

_VERTICES = re.compile(r"(\()?\b([Vv])ert(ex|ices) \d+(?:, \d+)*(?: and \d+)?(?:, \.\.\.)?")
_OF_HOLES = re.compile(r"^(Hole|\d+ holes,) through vert(?:ex|ices) [^:]*:")
_PLACE = re.compile(r",? (?:near|at|through) vert(?:ex|ices) \d+(?:, \d+)*(?: and \d+)?(?: of the rim)?")

#: Sentences of the library with what to do about them, and the same with the panel's rows.
_IN_PANEL = (
    (
        re.compile(r"The mesh meets the flat rim of the hole at an angle all around: the fill is flat; continuity G1 [^.;]*"),
        "Filled flat up to the sharp edges; set Continuity: Tangent to round them",
    ),
    (
        re.compile(r"The mesh meets the hole at an angle along (\d+) of its (\d+) sides: the fill is not continued there"),
        r"Filled flat up to the sharp edges along \1 of \2 sides; set Continuity: Tangent to round them",
    ),
    (
        re.compile(r"The mesh meets the hole at an angle of about (\d+) degrees along ([^:]*): the fill is not continued [^.]*"),
        r"Filled flat up to sharp edges of \1° along \2; set Continuity: Tangent to round them",
    ),
)

#: What Blender has against it.
_REMEDIES = (
    (re.compile(r"has no length|at the same place"), "Mesh > Merge > By Distance joins such vertices"),
    (re.compile(r"turned against"), "Mesh > Normals > Recalculate Outside turns them"),
    (re.compile(r"Non-manifold"), "Select > All by Trait > Non Manifold finds such places"),
    (re.compile(r"hidden"), "Mesh > Show/Hide > Reveal Hidden shows it"),
    (re.compile(r"plane of a Mirror"), "apply the modifier, or turn it off in the viewport, to fill it"),
    (re.compile(r"scaled to nothing"), "Sidebar (N) > Item has the scale"),
)


def _one_more(match):
    kind, first, _, second = match.groups()
    return f"{kind} {int(first) + 1}" + (f" and {int(second) + 1}" if second else "")


def _labels(match):
    """Names of options and methods as the panel has them."""

    def label(word):
        option = properties.OPTIONS.get(word)
        if option is None:
            return properties.METHODS.get(word) or (properties.words(word) if word in library.tripatch.METHODS else word)
        return option.label or properties.words(word)

    return re.sub(r"\w+", lambda word: label(word[0]), match[0])


def for_people(sentence):
    """The sentence with sides and corners from 1, options as the panel names them, and with its remedy."""
    for pattern, said in _IN_PANEL:
        sentence = pattern.sub(said, sentence)
    told = _NAMES.sub(_labels, _OPTIONS.sub(_labels, _NUMBERED.sub(_one_more, sentence))).replace("; merge them first", "")
    told = told.replace("set the resolution by hand", "choose the Density")
    for cause, remedy in _REMEDIES:
        if cause.search(told):
            return told if "Merge by Distance" in told and "By Distance" in remedy else f"{told}; {remedy}"
    return told


def of_selected(sentence):
    """For the window, where a refusal selects the vertices that it is about."""

    def named(match):
        bracket, capital, ending = match[1] or "", match[2] == "V", match[3]
        article = "" if bracket else "The " if capital else "the "
        return f"{bracket}{article}selected vert{ending}"

    return _VERTICES.sub(named, for_people(sentence))


def of_filled(sentence):
    """For the window, of holes that are filled: no vertex is selected, and nobody sees its number."""
    counted = _OF_HOLES.sub(lambda match: "1 hole:" if match[1] == "Hole" else f"{match[1].rstrip(',')}:", sentence)
    return _PLACE.sub("", for_people(counted))


def can_be_mended(sentence):
    """Whether a person can do something about what is said."""
    return any(cause.search(sentence) for cause, _ in _REMEDIES) or "not applied" in sentence
