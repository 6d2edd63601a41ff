"""What building codes ask for between two buildings with level floors, in zone II of Mexico City.

The first stand on two properties and are of unequal height; the others are alike, on one property.
"""

import stochlin as sl

common = {"height_2": 15.0, "floors_align": True, "zone": "II"}
unlike = sl.code_gaps(0.12, 0.09, height_1=24.0, **common)
alike = sl.code_gaps(0.12, 0.09, height_1=15.0, same_property=True, same_system=True, **common).gap
alike = alike.drop_vars(["family", "assumptions"]).assign_attrs(long_name="gap of alike buildings")
unlike.assign(gap_of_alike_buildings=alike).to_netcdf("answer.nc")
