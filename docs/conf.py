"""Configuration of the documentation site; `make docs` builds it into build/docs."""

import re
import shutil
from dataclasses import MISSING
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.ext import autosummary

import stochlin
from stochlin.applications.cases.reading.case import forms_of
from stochlin.applications.cases.reading.tables import NO_TABLE, Form

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


# The reference page: its own words, and at the end of each section the public names that stand below the
# same heading in stochlin/__init__.pyi; those of a submodule in its place.
PACKAGE = Path(stochlin.__file__).parent
PASSED_ON = re.compile(r"\bimport (\w+) as \1$|^    (\w+) as \2,$", re.MULTILINE)


def _names(text: str) -> list[str]:
    found = [a or b for a, b in PASSED_ON.findall(text)]
    listed = []
    for name in found:
        file = PACKAGE / f"{name}.py"
        inner = _names(file.read_text(encoding="utf-8")) if file.exists() else []
        listed += [f"{name}.{one}" for one in inner if not one.isupper()] or [name]
    return listed


def _summary(names: list[str], folder: str) -> str:
    options = f".. autosummary::\n   :toctree: {folder}\n   :template: autosummary/base.rst\n\n"
    return options + "".join(f"   {name}\n" for name in names)


STUB = (PACKAGE / "__init__.pyi").read_text(encoding="utf-8")
_, *_parts = re.split(r"^# (.*)\n", STUB, flags=re.MULTILINE)
SECTIONS = dict(zip(_parts[::2], map(_names, _parts[1::2]), strict=True))
# Pages of the single names are made of a list in a file, before any page is read.
LISTED = Path(__file__).parent / "reference" / "generated" / "names.rst"
LISTED.parent.mkdir(exist_ok=True)
LISTED.write_text(
    ".. currentmodule:: stochlin\n\n" + "\n".join(_summary(names, ".") for names in SECTIONS.values()),
    encoding="utf-8",
)
autosummary_generate = ["reference/generated/names.rst"]


def _list_names(app: Any, page: str, source: list[str]) -> None:
    if page == "reference/index":
        before, *parts = re.split(r"^## (.*)\n", source[0], flags=re.MULTILINE)
        for heading, text in zip(parts[::2], parts[1::2], strict=True):
            listed = _summary(SECTIONS[heading], "generated")
            before += f"## {heading}\n{text.rstrip()}\n\n```{{eval-rst}}\n{listed}```\n\n"
        source[0] = before


# The page of case files: its own words, and tables of the keys of the forms.
def _list_keys(app: Any, page: str, source: list[str]) -> None:
    if page == "case_files":
        source[0] = re.sub(r"<!-- keys: ([\w.]+) -->", lambda mark: _keys(mark[1]), source[0])


def _keys(name: str) -> str:
    each = {form: form.keys(NO_TABLE) for form in forms_of(name)}
    keys = {key: known for of_form in reversed(each.values()) for key, known in of_form.items()}
    several = len(each) > 1
    heads = ["key", "what it is", "allowed", "if it is missing"] + ["of"] * several
    rows = [heads, ["---"] * len(heads)]
    for key in dict.fromkeys(key for of_form in each.values() for key in of_form):
        default = keys[key].default
        unset = isinstance(default, Form) or default in (None, MISSING, (), "")
        usual = "" if unset else f"`{str(default).lower()}`"
        having = [form for form in each if key in each[form]]
        of = ["all" if len(having) == len(each) else "; ".join(map(_called, having))] * several
        rows.append([f"`{key}`", keys[key].about, keys[key].kind.words, usual, *of])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _called(form: type) -> str:
    name = re.split("[.,;]", form.__doc__ or "")[0]
    return name[:1].lower() + name[1:]


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
    """List the names, make the formulas."""
    app.connect("source-read", _list_names)
    app.connect("source-read", _list_keys)
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
