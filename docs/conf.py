"""Configuration of the documentation site; `make docs` builds it into build/docs."""

import re
import shutil
from pathlib import Path
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
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = [
    "gallery/*",
    "auto_gallery/*.ipynb",  # for download
    "reference/generated/names.rst",
]  # scripts and lists; pages are made of them
nitpicky = True  # a name in backticks that leads nowhere is a warning, and warnings fail the build
default_role = "py:obj"

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

# The tests run the notebooks and keep their outputs; the site shows them as they are.
nb_execution_mode = "off"
NOTEBOOKS = Path(__file__).parent / "notebooks"
shutil.copytree(Path(__file__).parents[1] / "notebooks", NOTEBOOKS, dirs_exist_ok=True)

# A summary is the first sentence of a docstring, which these do not end.
autosummary.WELL_KNOWN_ABBREVIATIONS += ("eq.", "eqs.", "Eq.", "Eqs.")

autodoc_typehints = "none"  # the docstrings say them in words
autodoc_default_options = {
    "members": True,
    "inherited-members": True,
    # Of use to the analyses only.
    "exclude-members": "arrays, block, closure, closures, damping_coefficient, "
    "filter, filter_of, force_law, forcing, isel, kinds, law, law_parameters, lone_filter, "
    "own_parameters, parameter_names, power, symbolic, units, valid",
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
    "image_srcset": ["3x"],  # for print, beside those of the page
}

linkcheck_timeout = 10
linkcheck_workers = 4

html_math_renderer = "mathml"
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["math.css"]
html_title = f"stochlin {release}"


# The pages are plain Markdown, whose links lead to files of the repository. The site has pages in
# place of some of these, and lists of contents: a page lists those that it links to.
CHANGES = Path(__file__).parents[1] / "CHANGELOG.md"
REPLACED = {"](../notebooks/": "](notebooks/", "](gallery)": "](auto_gallery/index.rst)"}
LISTS = ("index", "notebooks")
CONTENTS = "\n\n```{{toctree}}\n:hidden:\n:maxdepth: 1\n{}\n```\n"

# The reference leads to a page of each name, which is made of a list in a file, before any page is
# read.
GENERATED = Path(__file__).parent / "reference" / "generated"
HEADING = re.compile(r"^### (.+)$", re.MULTILINE)
_listed = HEADING.findall((GENERATED.parent / "index.md").read_text(encoding="utf-8"))
GENERATED.mkdir(exist_ok=True)
(GENERATED / "names.rst").write_text(
    ".. currentmodule:: stochlin\n\n"
    ".. autosummary::\n   :toctree: .\n   :template: autosummary/base.rst\n\n"
    + "".join(f"   {name}\n" for name in _listed),
    encoding="utf-8",
)
autosummary_generate = ["reference/generated/names.rst"]


def _as_of_the_site(app: Any, page: str, source: list[str]) -> None:
    text = source[0]
    if page == "changelog":
        text = CHANGES.read_text(encoding="utf-8").replace("](docs/", "](")
    for link, of_site in REPLACED.items():
        text = text.replace(link, of_site)
    if page in LISTS:
        linked = re.findall(r"\]\(([\w/]+)\.(?:md|ipynb|rst)[#)]", text)
        text += CONTENTS.format("\n".join(dict.fromkeys(linked)))
    if page == "reference/index":
        text = HEADING.sub(
            r"\g<0>\n\n{py:obj}`Parameters, units, errors and examples <stochlin.\1>`", text
        )
        text += CONTENTS.format(":glob:\n\ngenerated/*")
    source[0] = text


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
    """Turn the pages into those of the site, make the formulas."""
    app.connect("source-read", _as_of_the_site)
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
