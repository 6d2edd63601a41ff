"""The pictures of the pages, drawn by the gallery's scripts: `make docs` draws those that moved.

Each picture carries a summary of what it shows, since the bytes of a drawing depend on the machine.
"""

import io
import json
import os
import re
import runpy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo

DOCS = Path(__file__).parents[2] / "docs"
GALLERY, PICTURES = DOCS / "gallery", DOCS / "pictures"
LARGEST = 60_000  # bytes
DOTS, COLOURS = 130, 64
SUMMARY = "summary"
TOLERANCE = 1e-3  # of a summary, relative: what no eye sees


def shown() -> dict[Path, list[Path]]:
    """The pictures that the pages show, by the script that draws them."""
    text = "".join(page.read_text(encoding="utf-8") for page in DOCS.glob("*.md"))
    by_script: dict[Path, list[Path]] = {}
    for name in sorted(set(re.findall(r"\]\(pictures/(\w+)_\d\.png\)", text))):
        scripts = list(GALLERY.glob(f"plot_[0-9][0-9]_{name}.py"))
        assert len(scripts) == 1, f"pictures/{name}_1.png: no script of the gallery draws it"
        numbers = sorted(set(re.findall(rf"\]\(pictures/{name}_(\d)\.png\)", text)))
        by_script[scripts[0]] = [PICTURES / f"{name}_{number}.png" for number in numbers]
    return by_script


def figure_of(picture: Path) -> Any:
    """The open figure that a picture shows, by its number."""
    return plt.figure(int(picture.stem[-1]))


def summary(figure: Any) -> dict[str, Any]:
    """Words of each panel, and number, mean and spread of the coordinates of all drawn in it."""
    panels = {}
    for number, panel in enumerate(figure.axes):
        words = [panel.get_title(), panel.get_xlabel(), panel.get_ylabel()]
        words += [text.get_text() for text in panel.texts]
        panels[str(number)] = {
            "words": words,
            "data": [_moments(each) for each in _coordinates(panel)],
        }
    return panels


def _coordinates(panel: Any) -> Iterator[np.ndarray]:
    yield from (line.get_xydata() for line in panel.lines)
    yield from (patch.get_path().vertices for patch in panel.patches)
    yield from (np.asarray(image.get_array()) for image in panel.images)
    for drawn in panel.collections:
        yield np.asarray(drawn.get_offsets())
        yield from (path.vertices for path in drawn.get_paths()[:1])


def _moments(values: np.ndarray) -> list[float]:
    finite = np.asarray(values, float)[np.isfinite(np.asarray(values, float))]
    moments = (finite.mean(), finite.std()) if finite.size else (0.0, 0.0)
    return [finite.size, *(float(f"{moment:.6g}") for moment in moments)]


def differs(picture: Path, figure: Any) -> bool:
    """Whether a picture is not there, or shows something else than the figure."""
    if not picture.exists():
        return True
    with Image.open(picture) as image:
        before = json.loads(image.info.get(SUMMARY, "{}"))
    now = summary(figure)
    if [_words(panel) for panel in before.values()] != [_words(panel) for panel in now.values()]:
        return True
    pairs = zip(before.values(), now.values(), strict=True)
    return not all(_near(panel["data"], other["data"]) for panel, other in pairs)


def _words(panel: dict[str, Any]) -> tuple[list[str], int]:
    return panel["words"], len(panel["data"])


def _near(before: list[list[float]], now: list[list[float]]) -> bool:
    return np.allclose(
        np.reshape(before, (-1, 3)), np.reshape(now, (-1, 3)), rtol=TOLERANCE, atol=1e-9
    )


def write(picture: Path, figure: Any) -> None:
    """In few colours, so that a page with it is small."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DOTS)
    text = PngInfo()
    text.add_text(SUMMARY, json.dumps(summary(figure)), zip=True)
    with Image.open(stream) as image:
        few = image.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    few.save(picture, optimize=True, pnginfo=text)
    assert picture.stat().st_size <= LARGEST, f"{picture.name} has more than {LARGEST} bytes"


def main() -> None:
    """Draw all, write those that moved."""
    mpl.use("agg")
    os.chdir(GALLERY)
    for script, pictures in shown().items():
        with mpl.rc_context():
            runpy.run_path(str(script))
            for picture in pictures:
                if differs(picture, figure_of(picture)):
                    write(picture, figure_of(picture))
                    print(f"docs/pictures/{picture.name}: written")
            plt.close("all")


if __name__ == "__main__":
    main()
