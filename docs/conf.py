"""Sphinx configuration. `make docs` builds the pages into build/docs.

Pages are Markdown (MyST) beside this file. Three folders are written at build time and not kept: `methods/` and `api/`
by `docs/extension`, from docstrings, and `examples/` by sphinx-gallery, from the scripts in `gallery/`.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import refdof

project = "refdof"
author = "The refdof authors"
version = release = refdof.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
    "extension",
]
exclude_patterns = [
    "gallery",
    "extension",
    "**/sg_execution_times.rst",
    "**/*.inc",
    "**/*.py",
    "**/*.ipynb",
    "**/*.json",
]
default_role = "py:obj"  # docstrings name code in single backquotes
suppress_warnings = [
    "ref.footnote",  # numpydoc's references are cited as [1], without the underscore of reStructuredText
    "ref.python",  # every method has a `Params`
    "config.cache",  # the gallery's settings hold a class
]

autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_custom_sections = ["Departures from the paper"]
python_maximum_signature_line_length = 80
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 3

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "examples",
    "within_subsection_order": "FileNameSortKey",
    "filename_pattern": r"/plot_",
    "copyfile_regex": r".*\.inc",  # nothing
    "download_all_examples": False,
    "show_memory": False,
    "min_reported_time": 3600,
    "remove_config_comments": True,
    "show_signature": False,
    "write_computation_times": False,  # a page that loads scripts from elsewhere
}

html_theme = "furo"
html_title = f"refdof {version}"
html_static_path = ["_static"]
html_css_files = ["custom.css"]
html_show_sourcelink = False
html_show_copyright = False
smartquotes = False  # quotes in docstrings are values
html_copy_source = False
