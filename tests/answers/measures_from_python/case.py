"""What helps two elastic buildings that stand 3 cm apart."""

import stochlin as sl

pair = [sl.Bilinear(T, 0.05, mass=m) for T, m in ((0.6, 2e5), (1.0, 3e5))]
measures = {
    "dampers": sl.Measure(added_damping_1=0.1, added_damping_2=0.1),
    "link": sl.Measure(link=sl.Link(damping_constant=4e5)),
    "fluid": sl.Measure(
        link=[
            sl.Link(0.0, 2e5, damping_exponent=0.5, structures=(s, s), floors=(1, 0))
            for s in (1, 2)
        ]
    ),
}
firm = sl.named_ground("firm", intensity=0.002)
table = sl.mitigate(*pair, firm, 0.03, measures, duration=10.0, paths=64, confidence=0.8)
table.to_netcdf("measures.nc")
