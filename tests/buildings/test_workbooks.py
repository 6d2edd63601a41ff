"""Workbooks, written here part by part: what they show is read, or refused in a sentence."""

import re
import sys
import time
import zipfile
from pathlib import Path

import pytest
from commands import invoke, process

import stochlin as sl
from stochlin.applications.sheets.sheets import sheets_of

SHEET, OTHER = "xl/worksheets/sheet1.xml", "xl/worksheets/sheet2.xml"
BOOK, RELATIONS, TEXTS = "xl/workbook.xml", "xl/_rels/workbook.xml.rels", "xl/sharedStrings.xml"
TYPES = "application/vnd.openxmlformats-officedocument.spreadsheetml."
MAIN = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
ROWS = (("roof [mm]", "shear [kN]"), (0, 0), (10, 500), (30, 700), (60, 750))
EMPTY = f"<worksheet {MAIN}><sheetData></sheetData></worksheet>"


def cells(rows: tuple[tuple[object, ...], ...]) -> str:
    texts = "<c t='inlineStr'><is><t>{}</t></is></c>"
    marked = [
        [texts.format(x) if isinstance(x, str) else f"<c><v>{x}</v></c>" for x in row]
        for row in rows
    ]
    return "".join(f"<row>{''.join(row)}</row>" for row in marked)


TABLE = EMPTY.replace("</sheetData>", f"{cells(ROWS)}</sheetData>")
PARTS = {
    "[Content_Types].xml": f'<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    f'<Override PartName="/{BOOK}" ContentType="{TYPES}sheet.main+xml"/>'
    f'<Override PartName="/{TEXTS}" ContentType="{TYPES}sharedStrings+xml"/></Types>',
    BOOK: f'<workbook {MAIN} xmlns:r="{OFFICE}"><sheets><sheet name="Old" sheetId="1" r:id="a"/>'
    '<sheet name="Push" sheetId="2" r:id="b"/></sheets></workbook>',
    RELATIONS: f'<Relationships xmlns="{OFFICE.replace("officeDocument", "package")}">'
    f'<Relationship Id="a" Type="{OFFICE}/worksheet" Target="worksheets/sheet1.xml"/>'
    f'<Relationship Id="b" Type="{OFFICE}/worksheet" Target="/{OTHER}"/></Relationships>',
    "_rels/.rels": f'<Relationships xmlns="{OFFICE.replace("officeDocument", "package")}">'
    f'<Relationship Id="a" Type="{OFFICE}/officeDocument" Target="{BOOK}"/></Relationships>',
    TEXTS: f"<sst {MAIN}><si><t>n</t></si></sst>",
    SHEET: EMPTY,
    OTHER: TABLE,
}


def written(folder: Path, **changed: object) -> Path:
    path = folder / "push.xlsx"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (PARTS | changed).items():
            archive.writestr(name, str(text))
    return path


def with_rows(more: str) -> dict[str, str]:
    return {OTHER: TABLE.replace("</sheetData>", f"{more}</sheetData>")}


MANY = 10**6
HIDDEN = PARTS[BOOK].replace('name="Old"', 'name="Old" state="{}"')
READ = {
    "as it is": {},
    "hidden": {SHEET: TABLE.replace("500", "5"), BOOK: HIDDEN.format("hidden")},
    "results of formulas": {OTHER: TABLE.replace("<c><v>750", '<c r="B5"><f>250*3</f><v>750')},
    "an entity": {OTHER: f'<!DOCTYPE x [<!ENTITY a "{MANY * "a"}">]>{TABLE}'},
    "an empty text": with_rows('<row><c t="str"><f>""</f><v></v></c></row>'),
    "a prefix": {OTHER: re.sub(r"<(/?)(?=\w)", r"<\1x:", TABLE).replace("xmlns=", "xmlns:x=")},
}
REFUSED = {
    "has formulas without results": with_rows("<row><c><f>A5+9</f><v/></c><c><f>B5</f></c></row>"),
    "sheet Old and push.xlsx, sheet Push both have lines of numbers; allowed: one": {SHEET: TABLE},
    "is empty: it holds no visible table": {
        BOOK: HIDDEN.format("hidden").replace('"Push"', '"Push" state="hidden"')
    },
    "string index not found in shared strings table; save it again": with_rows(
        "<row><c t='s'><v>7</v></c></row>"
    ),
    "Cannot detect file format": {BOOK: ""},
    "it has 2090095 cells; allowed: 1048576": with_rows(
        "<row>"
        + 55000 * ("<c><v>1</v></c>" + "</row><row>" + 18 * "<c/>" + "<c><v>1</v></c></row><row>")
    ),
    "has control characters in its texts": with_rows(
        "<row><c t='str'><v>1\x1f2</v></c><c><v>3</v></c></row>"
    ),
    "its tables have 17": {"xl/styles.xml": 17_000_000 * " "},
    "it has two sheets of the same title": {
        SHEET: TABLE.replace("500", "5"),
        BOOK: HIDDEN.format("hidden").replace('"Old"', '"Push"'),
    },
    "both have lines of numbers; allowed: one": {
        SHEET: TABLE,
        BOOK: PARTS[BOOK].replace("Old", 100 * "x" + "1").replace("Push", 100 * "x" + "2"),
    },
    "signs; allowed: 16777216": {
        TEXTS: f"<sst {MAIN}><si><t>{MANY * 'x'}</t></si></sst>",
        **with_rows("<row>" + 20 * "<c t='s'><v>0</v></c>" + "</row>"),
    },
    "it has more than 2000 parts": {f"xl/{n}": "" for n in range(2001)},
}


def named(count: int) -> str:
    """The book with so many more names of its second sheet."""
    more = "".join(f'<sheet name="{n}" sheetId="{n + 3}" r:id="b"/>' for n in range(count))
    return PARTS[BOOK].replace("</sheets>", f"{more}</sheets>")


def with_far(start: str, row: int = 2**20) -> dict[str, str]:
    """A sheet with a cell in its last column and a row."""
    return with_rows(f'{start}<c t="n" r="XFD{row}"><v>1</v></c></row>')


SHARED = "".join(f'<row r="{n}"><c r="A{n}" t="s"><v>0</v></c></row>' for n in range(1, 100_001))
LAUGHS = "".join(f'<!ENTITY a{n} "{10 * f"&a{n - 1};"}">' for n in range(1, 10))
LAUGHED = with_rows("<row><c t='str'><v>&a9;</v></c></row>")[OTHER]
ATTRIBUTES = " ".join(f"a{n}=''" for n in range(MANY))
NAMES = 300_000 * "<definedName name='a'>A1</definedName>"
MERGED = '<mergeCells><mergeCell ref="A1:XFD1048576"/></mergeCells></worksheet>'
# What needs much more time or memory than its bytes.
BOMBS: dict[str, dict[str, str]] = {
    "a long text in many cells": {
        TEXTS: f"<sst {MAIN}><si><t>{MANY * 'x'}</t></si></sst>",
        **with_rows(SHARED),
    },
    "a cell far away": with_far("<row>"),
    "a cell far away without white space": with_rows(
        '<row s="1"r="1048576"><c t="n"r="XFD1048576"><v>1</v></c></row>'
    ),
    "a cell far away in a row with a number": with_far('<row r="1048576">'),
    "many sheets with a cell far away": {BOOK: named(200), **with_far("<row>", 500)},
    "the same sheet many times": {BOOK: named(100_000)},
    "a dimension": {
        OTHER: TABLE.replace("<sheetData>", '<dimension ref="A1:XFD1048576"/><sheetData>')
    },
    "a merged range": {OTHER: TABLE.replace("</worksheet>", MERGED)},
    "entities of entities": {OTHER: f"<!DOCTYPE x [<!ENTITY a0 'aaaaaaaaaa'>{LAUGHS}]>{LAUGHED}"},
    "elements in elements": with_rows(MANY * "<a>" + MANY * "</a>"),
    "texts without end": {TEXTS: f"<sst {MAIN}>{2 * MANY * '<si/>'}</sst>"},
    "a formula without end": with_rows(f"<row><c{5 * MANY * ' '}<c{5 * MANY * ' '}><f></row>"),
    "attributes without end": with_rows(f"<row><c {ATTRIBUTES}/></row>"),
    "names without end": {
        BOOK: PARTS[BOOK].replace("</workbook>", f"<definedNames>{NAMES}</definedNames></workbook>")
    },
}
READ_ALL = """
import pathlib, resource, sys
from stochlin.applications.sheets.sheets import sheets_of
me, children = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN
for path in sorted(pathlib.Path().glob("*.xlsx")):
    before = resource.getrusage(me).ru_maxrss
    try:
        what = f"{len(sheets_of(path))} sheets"
    except ValueError as error:
        what = f"refused: {error}"
    kilobytes = resource.getrusage(me).ru_maxrss - before, resource.getrusage(children).ru_maxrss
    print(*kilobytes, path.name, what.replace("\\n", " "), sep="|")
"""


@pytest.fixture(autouse=True)
def _library() -> None:
    pytest.importorskip("python_calamine", reason="python-calamine is in the extra 'tables'")


@pytest.mark.parametrize("case", READ)
def test_what_a_workbook_shows_is_read(tmp_path: Path, case: str) -> None:
    curve = sl.read_pushover(written(tmp_path, **READ[case]))
    assert curve.values.tolist() == [0, 5e5, 7e5, 7.5e5]


@pytest.mark.parametrize("message", REFUSED)
def test_other_workbooks_are_refused_in_a_sentence(tmp_path: Path, message: str) -> None:
    with pytest.raises(ValueError, match=rf"^push\.xlsx.*{re.escape(message)}"):
        sl.read_pushover(written(tmp_path, **REFUSED[message]))


@pytest.mark.slow
def test_no_workbook_takes_more_than_300_megabytes(tmp_path: Path) -> None:
    """Neither of this process nor of the one that reads it, which the system ends after 2 s."""
    resource = pytest.importorskip("resource", reason="Windows has no limits of a process")
    assert resource.RLIMIT_AS
    for name, parts in BOMBS.items():
        written(tmp_path, **parts).rename(tmp_path / f"{name}.xlsx")
    done = process(tmp_path, {}, "-c", READ_ALL)
    assert done.returncode == 0, done.stderr
    rows = [line.split("|") for line in done.stdout.splitlines()]
    assert len(rows) == len(BOMBS)
    most = {name: max(int(here), int(apart)) for here, apart, name, _ in rows}
    assert {name: size for name, size in most.items() if size > 300_000} == {}
    assert sum("refused" in what for *_, what in rows) >= 7


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_parts_are_compressed_as_in_a_workbook(tmp_path: Path, method: int) -> None:
    """Other methods take memory that the size of a part does not show."""
    path = tmp_path / "push.xlsx"
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, text in PARTS.items():
            archive.writestr(name, text)
    with pytest.raises(ValueError, match="is not compressed as in a workbook"):
        sl.read_pushover(path)


def test_what_is_no_workbook_of_today_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "push.xlsx"
    for content, message in (
        (b"PK\x03\x04 xl/", "is not a zip file"),
        (b"\xd0\xcf\x11\xe0", "save it again as .xlsx without"),
    ):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=rf"push\.xlsx .*{message}"):
            sl.read_modes(path)


def test_without_the_library_the_message_names_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "python_calamine", None)
    with pytest.raises(ImportError, match=r"pip install 'stochlin\[tables\]'"):
        sl.read_pushover(written(tmp_path))


def test_of_two_tables_of_modes_neither_is_taken(tmp_path: Path) -> None:
    """Nor of two files, and a file is no folder."""
    plain = "mode,,1\nperiod [s],,0.5\nlevel [m],mass [t],shape\n3,200,1\n"
    ratios = (
        "TABLE:  Modal Participating Mass Ratios\nCase,Mode,Period,UX\n,,sec,\nModal,1,0.5,0.9\n"
    )
    for name, text in {"a.csv": plain, "b.csv": plain}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    for text in (plain, ratios):
        (tmp_path / "b.csv").write_text(text, encoding="utf-8")
        with pytest.raises(ValueError, match=r"^a\.csv and b\.csv both have modes; allowed: one"):
            sl.read_modes(tmp_path)
    (tmp_path / "a.csv").write_text(ratios, encoding="utf-8")
    with pytest.raises(ValueError, match=r"a\.csv, line 2: table .* is also at b\.csv, line 2"):
        sl.read_modes(tmp_path)
    done = invoke("building", tmp_path / "a.csv" / "a.csv")
    assert done.exit_code == 2
    assert "a.csv: there is no such file; check its name and its folder" in " ".join(
        done.output.split()
    )


def test_whole_numbers_have_no_decimals(tmp_path: Path) -> None:
    """As a workbook shows them: names of storeys and points are read as they look."""
    rows = with_rows("<row><c><v>7.0</v></c><c><v>7.5</v></c></row>")
    (sheet,) = sheets_of(written(tmp_path, **rows))
    assert sheet.row(6) == ("7", "7.5")


def test_a_workbook_without_numbers_is_read_in_seconds(tmp_path: Path) -> None:
    """All its lines are searched for numbers, in this process."""
    texts = 100_000 * "<row><c t='s'><v>0</v></c></row>"
    path = written(tmp_path, **{OTHER: EMPTY.replace("</sheetData>", f"{texts}</sheetData>")})
    before = time.process_time()
    with pytest.raises(ValueError, match="has no line of numbers"):
        sl.read_pushover(path)
    assert time.process_time() - before < 8.0
