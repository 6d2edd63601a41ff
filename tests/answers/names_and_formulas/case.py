"""Names of grounds, rules and peak factors, and their values; the example of a case file, read."""

from pathlib import Path

import stochlin as sl

print(*sl.ground_names())
for name in sl.ground_names():
    print(sl.named_ground(name))
for name in sl.effective_rule_names(unverified=True):
    rule = sl.effective_rule(name)
    print(name, f"{float(rule.period_ratio(4.0, 0.05)):.9g} {float(rule.damping(4.0, 0.05, 0.05)):.9g}")
for name in sl.code_rule_names():
    rule = sl.code_rule(name)
    level, other = (float(rule.gap(0.12, 0.09, 24.0, 15.0, align, "III")) for align in (True, False))
    print(name, rule.mark, f"{level:.9g} {other:.9g}")
for name, value in (("share_of_sum", 0.8), ("share_of_height", 0.01), ("fixed_distance", 0.05)):
    print(name, value, sl.code_rule(name, value).gap(0.12, 0.09, 24.0, 15.0))
for name in sl.peak_factor_names():
    model = sl.peak_factor_model(name)
    print(name, f"{float(model.mean(40, 0.25)):.9g} {float(model.std(40, 0.25)):.9g}")
print(sl.rho_white_noise(0.5, 0.6, 0.05, 0.02).rho.item())
Path("case.toml").write_text(sl.example_case(), encoding="utf-8")
Path("record.at2").write_text(sl.example_record(), encoding="utf-8")
record = sl.read_record("record.at2")
print(record.attrs["dt"], record.sizes["time"], f"{float(abs(record).max()):.9g}")
case = sl.read_case("case.toml")
print(
    case.first.structure,
    case.second.structure,
    case.ground,
    case.envelope,
    case.gap,
    case.contact,
    sep="\n",
)
