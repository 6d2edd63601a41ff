"""An atlas on disk: a Zarr group that knows its specification, its version and which blocks are done.

It appears whole, empty, under its name; then blocks are written one by one, each array in a chunk of its
own and last a flag. A chunk is whole or absent, so that a process may die at any moment.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import math
import os
import shutil
import tempfile
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from stochlin._version import __version__
from stochlin.analyses.atlases.specification import AtlasSpecification
from stochlin.analyses.correlation.correlation import correlate
from stochlin.models.grounds import GROUNDS

TABLES = ("rho", "status", "bias", "caution")
SIDES = ("ductility_std_1", "ductility_std_2", "bias_1", "bias_2")
DONE = "block_done"
LONG_NAMES = {
    "period": "period over that of the ground",
    "damping": "damping ratio",
    "hardening": "hardening ratio",
    "reduction_factor": "reduction factor",
}
Block = dict[str, slice]


def zarr_module() -> Any:
    """Zarr, or an ImportError that says how to get it."""
    try:
        return importlib.import_module("zarr")
    except ImportError as error:
        raise ImportError("an atlas needs zarr: pip install 'stochlin[scale]'") from error


@cache
def code_version() -> str:
    """Version and digest of the code and data that make the numbers."""
    root = Path(str(files("stochlin")))
    digest = hashlib.sha256()
    for floor in ("kernels", "models", "analyses"):
        for path in sorted([*(root / floor).rglob("*.py"), *(root / floor).rglob("*.nc")]):
            digest.update(path.read_bytes())
    return f"{__version__}+{digest.hexdigest()[:12]}"


def block_shape(specification: AtlasSpecification) -> dict[str, int]:
    """Cells of a block along each axis: planes of the two structures' own axes first, then the rest.

    The structures of a plane are solved once for all its cells.
    """
    sizes = {name: len(values) for name, values in specification.axes.items()}
    shape = dict.fromkeys(sizes, 1)
    own = [name for name in sizes if name[-2:] in ("_1", "_2")]
    shape |= {name: sizes[name] for name in own}
    while math.prod(shape.values()) > specification.block_cells:
        longest = max(shape, key=lambda name: shape[name])
        shape[longest] = -(-shape[longest] // 2)
    for name in reversed([name for name in sizes if name not in own]):
        room = specification.block_cells // math.prod(shape.values())
        shape[name] = min(sizes[name], max(1, room))
    return shape


def compute_block(specification: AtlasSpecification, block: Block) -> xr.Dataset:
    """The variables of one block."""
    first, second, ground = specification.models()
    table = correlate(
        first.isel(block), second.isel(block), ground.isel(block), closure=specification.closure
    )
    return table[[*TABLES, *SIDES]].transpose(*specification.axes)


def write_block(path: str, specification: AtlasSpecification, number: tuple[int, ...]) -> None:
    """Compute a block and write it, its flag last. Side by side with others, in threads or processes."""
    shape = block_shape(specification)
    cells = {
        axis: slice(n * shape[axis], min((n + 1) * shape[axis], len(values)))
        for n, (axis, values) in zip(number, specification.axes.items(), strict=True)
    }
    table = compute_block(specification, cells)
    group = zarr_module().open_group(path, mode="r+", use_consolidated=False)
    at = dict(zip(specification.axes, number, strict=True))
    for name, variable in table.data_vars.items():
        if any(at[axis] for axis in at if axis not in variable.dims):
            continue  # the same numbers as in the first block along this axis
        group[name][tuple(cells[str(dim)] for dim in variable.dims)] = variable.values
    group[DONE][number] = 1


def largest_bytes(specification: AtlasSpecification) -> int:
    """Bytes of the whole atlas, without compression."""
    first, second, _ = specification.models()
    sides = sum(math.prod(a.size for a in model.arrays().values()) for model in (first, second))
    ground = math.prod(len(v) for k, v in specification.axes.items() if k.startswith(("ground", "high")))
    return 18 * specification.cells + 16 * sides * ground


def check_room(specification: AtlasSpecification, path: Path) -> None:
    """Raise a ValueError if the atlas might not fit on its disk."""
    folder = path.absolute().parent
    if not folder.is_dir():
        raise FileNotFoundError(f"{folder} is no folder: the atlas cannot be put there")
    need, free = largest_bytes(specification), shutil.disk_usage(folder).free
    if need > free:
        raise ValueError(
            f"{specification.cells:.3g} cells need up to {need / 1e9:.3g} GB, and {folder} has "
            f"{free / 1e9:.3g} GB free; take shorter axes or another disk"
        )


def create(path: Path, specification: AtlasSpecification) -> None:
    """The empty atlas, under its name when it is complete."""
    zarr = zarr_module()
    axes, shape = specification.axes, block_shape(specification)
    cell = compute_block(specification, {name: slice(0, 1) for name in axes})
    temporary = Path(tempfile.mkdtemp(prefix=f".{path.name}-", dir=path.absolute().parent))
    try:
        group = zarr.open_group(str(temporary), mode="w")
        kept = {k: v for k, v in cell.attrs.items() if k not in ("first", "second", "ground")}
        own = {"title": specification.title, "specification": specification.as_json()}
        group.attrs.update(kept | own | {"code": code_version()})
        for name, values in axes.items():
            array = group.create_array(
                name, shape=(len(values),), dtype="f8", chunks=(len(values),), dimension_names=(name,)
            )
            array[:] = np.array(values)
            array.attrs.update(units="1", long_name=long_name(name, specification.ground))
        for key, variable in cell.data_vars.items():
            name = str(key)
            dims = [str(dim) for dim in variable.dims]
            array = group.create_array(
                name,
                shape=[len(axes[dim]) for dim in dims],
                dtype=variable.dtype,
                chunks=[shape[dim] for dim in dims],
                dimension_names=dims,
                fill_value=np.nan if variable.dtype.kind == "f" else 0,
            )
            plain = {k: v.tolist() if hasattr(v, "tolist") else v for k, v in variable.attrs.items()}
            array.attrs.update(plain)
        counts = [-(-len(axes[dim]) // shape[dim]) for dim in axes]
        done = group.create_array(
            DONE,
            shape=counts,
            dtype="i1",
            chunks=[1] * len(counts),
            dimension_names=[f"{dim}_block" for dim in axes],
            fill_value=0,
        )
        done.attrs.update(units="1", long_name="1 where the block is written")
        temporary.chmod(0o755)
        temporary.rename(path)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def check_same(path: Path, specification: AtlasSpecification) -> None:
    """Raise a ValueError unless what lies there is of this specification and code."""
    found = read_attributes(path)
    cure = "write to another path, or remove what is there"
    wanted = specification.as_json()
    if found["specification"] != wanted:
        old, new = json.loads(found["specification"]), json.loads(wanted)
        old, new = old | old.pop("parameters"), new | new.pop("parameters")
        changed = sorted(key for key in old.keys() | new.keys() if old.get(key) != new.get(key))
        raise ValueError(f"{path} has another specification ({', '.join(changed)} differ); {cure}")
    if found["code"] != code_version():
        raise ValueError(f"{path} was begun by {found['code']}, this is {code_version()}; {cure}")


def read_attributes(path: str | os.PathLike[str]) -> Mapping[str, Any]:
    """Attributes of an atlas; a ValueError where there is none."""
    try:
        group = zarr_module().open_group(str(path), mode="r", use_consolidated=False)
    except (FileNotFoundError, NotADirectoryError) as error:
        raise ValueError(f"{path} is no atlas: no Zarr group is there") from error
    found: Mapping[str, Any] = group.attrs.asdict()
    if "specification" not in found:
        raise ValueError(f"{path} is no atlas: it has no specification")
    return found


def undone(path: Path) -> tuple[list[tuple[int, ...]], int]:
    """Numbers of the blocks that are not yet written, and the number of all."""
    group = zarr_module().open_group(str(path), mode="r", use_consolidated=False)
    flags = np.asarray(group[DONE][...])
    return [tuple(int(n) for n in number) for number in np.argwhere(flags == 0)], flags.size


def long_name(axis: str, ground: str) -> str:
    """Of a coordinate, on this kind of ground."""
    kind = GROUNDS[ground]
    if axis in kind.beside_structures():
        field = kind.__dataclass_fields__[kind.beside_structures()[axis]].metadata
        return f"{field['long_name']}{' over that of the ground' if field['units'] == 's' else ''}"
    stem, _, number = axis.rpartition("_")
    return f"{LONG_NAMES[stem]}, structure {number}" if stem in LONG_NAMES else LONG_NAMES[axis]
