"""python -m gallery_pictures DOCS [NAME...]: draws all, or the named parts, into DOCS/gallery and DOCS/images."""

import importlib
import pathlib
import sys

PARTS = (
    "szilvasi_nagy",
    "liu_ma_cheng",
    "franke",
    "arnal_lluch",
    "smits",
    "methods",
    "cages",
    "glossary",
    "any_rim",
    "beside_cgal",
    "n_sides",
)
FOLDERS = {
    "methods": "images/methods",
    "cages": "images/cages",
    "glossary": "images",
    "any_rim": "images/any_rim",
    "beside_cgal": "images/any_rim",
    "n_sides": "images/n_sides",
}  # of the others: gallery

docs = pathlib.Path(sys.argv[1])
names = sys.argv[2:] or PARTS
for name in names:
    if name not in PARTS:
        sys.exit(f"no pictures called {name}; there are {', '.join(PARTS)}")
for name in names:
    importlib.import_module(f".{name}", __package__).draw(docs / FOLDERS.get(name, "gallery"))
