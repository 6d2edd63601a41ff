"""A hall of one storey beside the extension of the worked case, by the modes of both."""

import stochlin as sl

hall = sl.ShearBuilding(masses=[3e5], stiffnesses=[6.4e7], heights=[7.2], damping=0.05)
extension = sl.ShearBuilding(
    masses=[2.55e5, 2.05e5], stiffnesses=[9.0e7, 1.76e8], heights=[4.0, 3.2], damping=0.05
)
spectrum = sl.eurocode_8(ag=0.25 * 9.80665, soil="B")
table = sl.code_gaps(modes_1=hall, modes_2=extension, spectrum=spectrum)
answer = table[["peak_1", "peak_2", "rho"]].assign(cqc=table.cqc.sel(rule="srss"))
answer = answer.assign(gap=table.gap.sel(rule=["srss", "share_of_sum"]))
answer.drop_vars(["reference", "mark", "assumptions", "missing", "family"]).to_netcdf("answer.nc")
