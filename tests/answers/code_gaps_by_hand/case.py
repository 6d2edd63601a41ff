"""What building codes ask for between two buildings with level floors, in zone II of Mexico City.

The first stand on two properties and are of unequal height; the others are alike, on one property.
"""

import stochlin as sl

common = {"height_2": 15.0, "storeys_2": 5, "floors_align": True, "zone": "II"}
common |= {"design_pga": 0.25 * 9.80665}
unlike = sl.code_gaps(0.12, 0.09, height_1=24.0, storeys_1=8, **common)
one_property = {"same_property": True, "same_system": True, **common}
alike = sl.code_gaps(0.12, 0.09, height_1=15.0, storeys_1=5, **one_property).gap
alike = alike.drop_vars(["family", "assumptions"]).assign_attrs(long_name="gap of alike buildings")
unlike.assign(gap_of_alike_buildings=alike).to_netcdf("answer.nc")
