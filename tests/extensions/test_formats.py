"""A format of records from outside: one function, whose words a case file's errors have."""

import pytest
from cases import FIRM_SITE

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


def test_a_case_reads_records_of_the_format_of_the_page(toy, tmp_path):
    values = "\n".join(f"{0.1 * (n % 7 - 3):g}" for n in range(100))
    (tmp_path / "case.toml").write_text(CASE)
    for header, expected in (
        (HEADER, "should stand"),
        (HEADER.replace("# station: A\n", ""), "wave.csv has no line '# station: ...'"),
        (HEADER.replace("units: g", "units: parsec"), "wave.csv has 'parsec'; allowed: units of an"),
        (HEADER.replace("toy", "other"), "the file does not say the unit"),
    ):
        (tmp_path / "wave.csv").write_text(header + values)
        done = toy("gap", "case.toml")
        assert expected in " ".join((done.stdout + done.stderr).split()), expected
        assert done.returncode == (0 if header == HEADER else 2)
