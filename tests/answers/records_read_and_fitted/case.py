"""What a file of accelerations says, and what is fitted to it."""

from pathlib import Path

import xarray as xr

import stochlin as sl
from stochlin.applications.records.records import strong_part

record = sl.read_record("wave.txt", dt=0.02, units="g")
values = record.values / 9.80665
Path("two.csv").write_text(
    "time [s],acc [gal]\n"
    + "".join(f"{0.02 * n:.2f},{980.665 * a:.4f}\n" for n, a in enumerate(values[:50])),
    encoding="utf-8",
)
Path("peer.at2").write_text(
    "PEER NGA STRONG MOTION DATABASE RECORD\nmade, 1/1/2000\nACCELERATION IN UNITS OF G\n"
    "NPTS=   50, DT=   .0200 SEC\n" + "\n".join(f"{a:.6E}" for a in values[:50]) + "\n",
    encoding="utf-8",
)
columns = sl.read_record("two.csv")
peer = sl.read_record("peer.at2")
Path("two.csv").unlink()
xr.Dataset({"whole": record, "columns": columns, "peer": peer}).to_netcdf("records.nc")
strong_part(record).rename("strong").to_netcdf("strong.nc")
for estimator in ("psd", "log_psd", "whittle"):
    print(estimator, sl.fit_ground(record, estimator=estimator))
print(sl.fit_ground(record, "clough_penzien", "whittle"))
for model in ("amin_ang", "shinozuka_sato", "gamma"):
    print(sl.fit_envelope(record, model))
