"""Configuration of the documentation site; `make docs` builds it into build/docs."""

import re
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.ext import autosummary

import stochlin

project = "stochlin"
author = "The stochlin developers"
copyright = author
version = release = stochlin.__version__

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["gallery/*"]  # scripts; their pages are made in auto_gallery
nitpicky = True  # a name in backticks that leads nowhere is a warning, and warnings fail the build
default_role = "py:obj"

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

# A summary is the first sentence of a docstring, which these do not end.
autosummary.WELL_KNOWN_ABBREVIATIONS += ("eq.", "eqs.", "Eq.", "Eqs.")

autodoc_typehints = "none"  # the docstrings say them in words
autodoc_default_options = {
    "members": True,
    "inherited-members": True,
    # Of use to the analyses only.
    "exclude-members": "arrays, beside_structures, block, closure, damping_coefficient, filter, filter_of, "
    "isel, kernel_parameters, lone_filter, units, "
    "law_parameters, parameter_names, power, valid",
}
numpydoc_show_class_members = False
numpydoc_validation_checks = {"PR02", "PR03", "PR10", "RT03", "SS01"}

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "auto_gallery",
    "within_subsection_order": "FileNameSortKey",
    "filename_pattern": r"plot_",
    "download_all_examples": False,
    "show_signature": False,
    "min_reported_time": 3600,
    "abort_on_example_error": True,
    "capture_repr": (),
}

linkcheck_timeout = 10
linkcheck_workers = 4

html_math_renderer = "mathml"
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["math.css"]
html_title = f"stochlin {release}"


# Formulas in the browser's own MathML: the pages need no network, and no script.
def _inline(writer: Any, node: nodes.Element) -> None:
    writer.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def _block(writer: Any, node: nodes.Element) -> None:
    tex, *number = re.split(r"\\tag\{(.*?)\}", node.astext())
    tag = f'<span class="eqno">({number[0]})</span>' if number else ""
    writer.body.append(
        f'<div class="math" style="margin: 1.2em 0">{tag}{tex2mathml(tex, as_block=True)}</div>'
    )
    raise nodes.SkipNode


def setup(app: Any) -> None:
    """Make the formulas."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
