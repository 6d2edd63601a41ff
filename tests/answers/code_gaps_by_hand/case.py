"""What building codes ask for between two buildings with level floors, in zone II of Mexico City."""

import stochlin as sl

sl.code_gaps(0.12, 0.09, height_1=24.0, height_2=15.0, floors_align=True, zone="II").to_netcdf(
    "answer.nc"
)
