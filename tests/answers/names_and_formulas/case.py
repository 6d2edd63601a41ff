"""Names of grounds, rules and peak factors, and their values; the example of a case file, read."""

from pathlib import Path

import stochlin as sl
from stochlin.applications.cases.examples import example_record, short_example
from stochlin.applications.cases.rows import gap_of
from stochlin.models.grounds import ground_names

print(*ground_names())
for name in ground_names():
    print(sl.named_ground(name))
for name in sl.rules.effective_rule_names(unverified=True):
    rule = sl.rules.effective_rule(name)
    print(
        name,
        f"{float(rule.period_ratio(4.0, 0.05)):.9g} {float(rule.damping(4.0, 0.05, 0.05)):.9g}",
    )
of_site = {"storeys_1": 8, "storeys_2": 5, "design_pga": 2.5}
for name in sl.rules.code_rule_names():
    rule = sl.rules.code_rule(name)
    # One property and two, on each with floors that are level and not; one and the same system.
    told = [(align, "III", one, True) for one in (True, False) for align in (True, False)]
    gaps = (float(rule.gap(0.12, 0.09, 24.0, 15.0, *facts, **of_site)) for facts in told)
    print(name, rule.mark, *(f"{gap:.9g}" for gap in gaps))
    if rule.line:
        alone = rule.gap(0.12, None, 24.0, zone="III", storeys_1=8, design_pga=2.5)
        print(name, f"{float(alone):.9g}")
for name, value in (("share_of_sum", 0.8), ("share_of_height", 0.01), ("fixed_distance", 0.05)):
    print(name, value, sl.rules.code_rule(name, value).gap(0.12, 0.09, 24.0, 15.0))
for name in sl.rules.peak_factor_names():
    model = sl.rules.peak_factor_model(name)
    print(name, f"{float(model.mean(40, 0.25)):.9g} {float(model.std(40, 0.25)):.9g}")
print(sl.rho_white_noise(0.5, 0.6, 0.05, 0.02).rho.item())
Path("case.toml").write_text(short_example(), encoding="utf-8")
Path("record.at2").write_text(example_record(), encoding="utf-8")
record = sl.read_record("record.at2")
print(record.attrs["dt"], record.sizes["time"], f"{float(abs(record).max()):.9g}")
case = sl.read_case("case.toml")
structures = [building.structure for building in case.buildings]
print(
    *structures, case.site.ground, case.site.course.envelope, gap_of(case), case.contact, sep="\n"
)
