"""The API reference: ``sphinx-build -W python/docs OUT``."""

import grainsmooth

project = "grainsmooth"
version = release = grainsmooth.__version__
extensions = ["sphinx.ext.autodoc", "numpydoc"]
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_default_options = {"members": True}
numpydoc_show_class_members = False
html_theme = "alabaster"
nitpicky = False
