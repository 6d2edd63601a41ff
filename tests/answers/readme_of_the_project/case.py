"""The Python example of the README; changes below 1e-8 have few digits, and are not kept."""

import re
from pathlib import Path

import stochlin as sl

readme = (Path(sl.__file__).parents[1] / "README.md").read_text(encoding="utf-8")
(example,) = re.findall(r"^```python\n(.*?)^```", readme, re.DOTALL | re.MULTILINE)
names = {}
exec(compile(example.replace("print(", "str("), "README.md", "exec"), names)
changes = names["solved"].covariance_change
changes.where(changes > 1e-8, drop=True).to_netcdf("changes.nc", engine="scipy")
names["solved"][["c_eq", "k_eq", "rho"]].to_netcdf("solved.nc")
Path("rho.nc").unlink()
names["table"].rho.to_netcdf("rho.nc")
