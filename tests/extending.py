"""The examples of the page on extensions, as it has them."""

import re
from pathlib import Path

PAGE = Path(__file__).parents[1] / "docs" / "extending.md"
CODE = re.compile(r"^```py\n(.*?)^```", re.DOTALL | re.MULTILINE)


def examples() -> dict[str, str]:
    """The first example of each section that has code, by the title of the section."""
    sections = re.split(r"^## ", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    code = {section.partition("\n")[0]: CODE.search(section) for section in sections}
    return {title: block[1] for title, block in code.items() if block}
