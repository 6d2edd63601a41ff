"""A format of records from outside: one function, whose words a case file's errors have."""

import re

import pytest
from cases import FIRM_SITE

import stochlin as sl
from stochlin.applications.records.formats import FORMATS

pytestmark = pytest.mark.cli

RECORDS = '[[site.records]]\npath = "wave.csv"\n[motion]'
CASE = f"""\
{FIRM_SITE.replace("[motion]", RECORDS)}[building_1]
period = "0.7 s"
damping = "5 %"
elastic = true
[separation]
confidence = 0.9
[simulation]
paths = 128
"""
HEADER = "# network: toy\n# dt: 0.02\n# units: g\n# station: A\n"
VALUES = "\n".join(f"{0.1 * (n % 7 - 3):g}" for n in range(100))

REFUSED = [
    (HEADER.replace("# station: A\n", ""), "wave.csv has no line '# station: ...'"),
    (HEADER.replace("units: g", "units: parsec"), "wave.csv has 'parsec'; allowed: units of an"),
    (HEADER.replace("toy", "other"), "the file does not say the unit"),
]


def test_a_case_reads_records_of_the_format_of_the_page(toy, tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    for header, code, says in ((HEADER, 0, "should stand"), (REFUSED[0][0], 2, REFUSED[0][1])):
        (tmp_path / "wave.csv").write_text(header + VALUES)
        done = toy("gap", "case.toml")
        assert says in " ".join((done.stdout + done.stderr).split()), says
        assert done.returncode == code


@pytest.mark.parametrize(("header", "says"), REFUSED)
def test_a_header_that_lacks_something_is_refused(example, tmp_path, header, says):
    example("A record format", FORMATS)
    path = tmp_path / "wave.csv"
    path.write_text(header + VALUES)
    with pytest.raises(ValueError, match=re.escape(says)):
        sl.read_record(path)
