"""TriPatch fills holes in meshes so that the new surface blends smoothly into the old one.

Corners are 0, 1, 2 in rim order, the direction in which the new faces traverse the rim. Of three, side i is opposite corner i and
runs, t from 0 to 1, from corner i + 1 to corner i + 2; of another number, from corner i to corner i + 1. Lengths are in the units
of the input, angles in degrees.
"""

from . import between
from ._native import Option, Patch, Report, Side, SzilvasiNagyPatch
from .attributes import AttributeWeights, CutWeights, angles, attribute_weights, vertex_normals
from .candidates import Candidate
from .errors import FillWarning, Refusal
from .files import FileError, MeshFile, read, write
from .filling import Fill, Fills, fill, fill_all
from .holes import SURROUNDING_RINGS, choose_holes, find_corners, find_holes, is_outer_border, outer_borders
from .merging import HolesReport, fill_holes, merge
from .messages import Message
from .networks import network
from .nurbs import NurbsPatch, nurbs, write_step
from .options import METHODS, OPTIONS
from .patches import blend, patch
from .surfaces import (
    BezierRectangle,
    BezierTriangle,
    NurbsSurface,
    coons_bezier,
    coons_energy,
    coons_rectangle,
    rational_triangle,
    sides_from_normals,
    smits_patch,
    smooth_triangles,
    surface_of,
    triangle_on,
)
from .threads import set_threads

__version__ = "0.1.0"
__all__ = [
    "METHODS",
    "OPTIONS",
    "SURROUNDING_RINGS",
    "AttributeWeights",
    "BezierRectangle",
    "BezierTriangle",
    "Candidate",
    "CutWeights",
    "FileError",
    "Fill",
    "FillWarning",
    "Fills",
    "HolesReport",
    "MeshFile",
    "Message",
    "NurbsPatch",
    "NurbsSurface",
    "Option",
    "Patch",
    "Refusal",
    "Report",
    "Side",
    "SzilvasiNagyPatch",
    "angles",
    "attribute_weights",
    "between",
    "blend",
    "choose_holes",
    "coons_bezier",
    "coons_energy",
    "coons_rectangle",
    "fill",
    "fill_all",
    "fill_holes",
    "find_corners",
    "find_holes",
    "is_outer_border",
    "merge",
    "network",
    "nurbs",
    "outer_borders",
    "patch",
    "rational_triangle",
    "read",
    "set_threads",
    "sides_from_normals",
    "smits_patch",
    "smooth_triangles",
    "surface_of",
    "triangle_on",
    "vertex_normals",
    "write",
    "write_step",
]
