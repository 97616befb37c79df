"""Sphinx on the pages of this folder, which also read well as they are: scripts/docs."""

project = "TriPatch"
copyright = "the TriPatch contributors"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
root_doc = "reference/contents"
exclude_patterns = ["examples/fill_hole", "reference/cpp.md"]
myst_heading_anchors = 3
# links to files of the source tree, which are no pages; scripts/docs checks that they exist
suppress_warnings = ["myst.xref_missing"]
napoleon_google_docstring = True
autodoc_typehints = "none"
nitpicky = False
