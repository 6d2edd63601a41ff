"""An atlas on disk: a Zarr group with its specification, its code version and the checks of its blocks.

The empty group is created under a temporary name and then renamed. Blocks are written one by one, each
array in its own chunk, and their `checksums` last. Each chunk is written completely or not at all, so
that the process may be interrupted at any time. A finished atlas has all chunks; Zarr would read a
missing one as NaN with the worst flags.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from stochlin._version import __version__
from stochlin.analyses.atlases.checksums import (
    BLOCKS,
    CHECKS,
    FIXED,
    METADATA,
    Checks,
    DamagedError,
    Number,
    block_key,
    chunk_key,
    facts,
    sealed,
    seed_of,
)
from stochlin.analyses.atlases.specification import AtlasSpecification
from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.tables.optional import needed
from stochlin.analyses.tables.storage import whole_file
from stochlin.analyses.tables.work import check_work
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import cores
from stochlin.models.grounds import GROUNDS

TABLES = ("rho", "status", "bias", "caution")
SIDES = ("ductility_std_1", "ductility_std_2", "bias_1", "bias_2")
BEFORE = ("block_done", "block_checks")  # arrays in place of the checks in atlases of earlier versions
PAGE_BYTES = 4096  # disk space that a file may waste [bytes]
LONG_NAMES = {
    "period": "period over that of the ground",
    "damping": "damping ratio",
    "hardening": "hardening ratio",
    "reduction_factor": "reduction factor",
}
Block = dict[str, slice]


def zarr_module() -> Any:
    """The module zarr; an ImportError with the installation command if it is not installed."""
    return needed("zarr", "an atlas", "scale")


@cache
def code_version() -> str:
    """Version of the package, with a digest of the code and data from which results follow."""
    root = Path(str(files("stochlin")))
    digest = hashlib.sha256()
    for floor in ("kernels", "models", "analyses"):
        for path in sorted([*(root / floor).rglob("*.py"), *(root / floor).rglob("*.nc")]):
            digest.update(path.read_bytes())
    return f"{__version__}+{digest.hexdigest()[:12]}"


def block_shape(specification: AtlasSpecification) -> dict[str, int]:
    """Number of cells of a block along each axis.

    A block extends along axes of a single structure first, such as ``period_1``, and then along the
    others, since each structure is solved once for all cells of the former.
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
    """Dataset with the variables of one block."""
    first, second, ground = specification.models()
    table = correlate(
        first.isel(block), second.isel(block), ground.isel(block), closure=specification.closure
    )
    return table[[*TABLES, *SIDES]].transpose(*specification.axes)


def write_block(path: str, specification: AtlasSpecification, number: Number) -> None:
    """Compute a block and write it, its checks last; may run in several threads or workers at once."""
    shape = block_shape(specification)
    cells = {
        axis: slice(n * shape[axis], min((n + 1) * shape[axis], len(values)))
        for n, (axis, values) in zip(number, specification.axes.items(), strict=True)
    }
    table = compute_block(specification, cells)
    group = zarr_module().open_group(path, mode="r+", use_consolidated=False)
    at = dict(zip(specification.axes, number, strict=True))
    written = {}
    for name, variable in table.data_vars.items():
        if any(at[axis] for axis in at if axis not in variable.dims):
            continue  # already written with the first block along this axis
        array = group[name].with_config({"write_empty_chunks": True})
        array[tuple(cells[str(dim)] for dim in variable.dims)] = variable.values
        key = chunk_key(str(name), [at[str(dim)] for dim in variable.dims])
        written[key] = facts((Path(path) / key).read_bytes())
    key, seed = block_key(number), seed_of(specification.as_json(), code_version())
    with whole_file(Path(path) / key) as file:
        file.write_bytes(sealed(key, seed, written))


def largest_bytes(specification: AtlasSpecification) -> int:
    """Size of the whole atlas without compression [bytes]."""
    first, second, _ = specification.models()
    sides = sum(math.prod(a.size for a in model.arrays().values()) for model in (first, second))
    ground = math.prod(len(v) for k, v in specification.axes.items() if k.startswith(("ground", "high")))
    return 18 * specification.cells + 16 * sides * ground


def check_room(specification: AtlasSpecification, path: Path) -> None:
    """Raise a ValueError if the atlas may need more space than its disk has."""
    folder = path.absolute().parent
    if not folder.is_dir():
        raise FileNotFoundError(f"{folder} is no folder: the atlas cannot be put there")
    files = (len(TABLES) + 1) * math.prod(_counts(specification))
    need = largest_bytes(specification) + PAGE_BYTES * files
    free = shutil.disk_usage(folder).free
    if need > free:
        raise ValueError(
            f"{specification.cells:.3g} cells in {files:.3g} files need up to {need / 1e9:.3g} GB, and "
            f"{folder} has {free / 1e9:.3g} GB free; take shorter axes or another disk"
        )


def check_memory(specification: AtlasSpecification) -> None:
    """Raise a ValueError if the blocks that are computed at the same time need too much memory."""
    at_a_time = min(cores(), math.prod(_counts(specification)))
    block = math.prod(block_shape(specification).values())
    check_work(
        f"block_cells = {specification.block_cells}: {at_a_time} blocks of {block:.3g} cells at a time "
        "need",
        "take smaller blocks",
        {"cells of blocks": block * at_a_time},
    )


def create(path: Path, specification: AtlasSpecification) -> None:
    """Create the empty atlas under its name, unless another process has created it meanwhile."""
    with _empty(path, specification) as made:
        try:
            made.rename(path)
        except OSError:
            if not path.exists():
                raise


@contextmanager
def held(path: Path) -> Iterator[None]:
    """Lock an atlas against other writing processes; the lock ends with the process at the latest.

    Where a folder cannot be locked, as on Windows and some network disks, two processes may write the
    same atlas. They then do the work twice and write the same bits.
    """
    try:
        import fcntl
    except ImportError:
        yield
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        os.close(handle)
        raise RuntimeError(
            f"{path} is being written by another process; wait for its end, or write to another path"
        ) from error
    except OSError:
        pass
    try:
        yield
    finally:
        os.close(handle)


@contextmanager
def _empty(path: Path, specification: AtlasSpecification) -> Iterator[Path]:
    """An atlas without blocks in a temporary folder beside ``path``, which is removed afterwards."""
    temporary = Path(tempfile.mkdtemp(prefix=f".{path.name}-", dir=path.absolute().parent))
    try:
        _fill(temporary, specification)
        temporary.chmod(0o755)
        yield temporary
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _fill(folder: Path, specification: AtlasSpecification) -> None:
    """Write the metadata, axes and empty arrays of an atlas."""
    zarr = zarr_module()
    axes, shape = specification.axes, block_shape(specification)
    cell = compute_block(specification, {name: slice(0, 1) for name in axes})
    group = zarr.open_group(str(folder), mode="w", zarr_format=3)
    kept = {k: v for k, v in cell.attrs.items() if k not in ("first", "second", "ground")}
    own = {"title": specification.title, "specification": specification.as_json()}
    group.attrs.update(kept | own | {"code": code_version(), BLOCKS: _counts(specification)})
    packed = [zarr.codecs.ZstdCodec(level=0), zarr.codecs.Crc32cCodec()]
    for name, values in axes.items():
        array = group.create_array(
            name,
            shape=(len(values),),
            dtype="f8",
            chunks=(len(values),),
            dimension_names=(name,),
            compressors=packed,
        )
        array[:] = np.array(values)
        array.attrs.update(units="1", long_name=long_name(name, specification.ground))
    for key, variable in cell.data_vars.items():
        name = str(key)
        dims = [str(dim) for dim in variable.dims]
        plain = {k: v.tolist() if hasattr(v, "tolist") else v for k, v in variable.attrs.items()}
        group.create_array(
            name,
            shape=[len(axes[dim]) for dim in dims],
            dtype=variable.dtype,
            chunks=[shape[dim] for dim in dims],
            dimension_names=dims,
            fill_value=np.nan if variable.dtype.kind == "f" else max(plain["flag_values"]),
            compressors=packed,
            attributes=plain,
        )
    group.create_group(CHECKS)
    names = sorted(file.relative_to(folder).as_posix() for file in folder.rglob("*") if file.is_file())
    fixed = {name: facts((folder / name).read_bytes()) for name in names}
    (folder / FIXED).write_bytes(sealed(FIXED, 0, fixed))


def _counts(specification: AtlasSpecification) -> Number:
    """Number of blocks along each axis."""
    shape = block_shape(specification)
    return tuple(-(-len(values) // shape[axis]) for axis, values in specification.axes.items())


def check_same(path: Path, specification: AtlasSpecification) -> Mapping[str, Any]:
    """Attributes of an existing atlas; a ValueError unless specification and code version are these."""
    attributes = read_attributes(path)
    cure = "write to another path, or remove what is there"
    wanted = specification.as_json()
    if attributes["specification"] != wanted:
        old, new = json.loads(attributes["specification"]), json.loads(wanted)
        old, new = old | old.pop("parameters"), new | new.pop("parameters")
        changed = sorted(key for key in old.keys() | new.keys() if old.get(key) != new.get(key))
        raise ValueError(f"{path} has another specification ({', '.join(changed)} differ); {cure}")
    if attributes["code"] != code_version():
        raise ValueError(f"{path} was begun by {attributes['code']}, this is {code_version()}; {cure}")
    return attributes


def mend(path: Path, specification: AtlasSpecification) -> Checks:
    """The checks of an atlas, after damaged metadata and axes have been replaced.

    Raises as `check_same`. If the metadata of the group are lost, the specification and code version
    are verified by the checks of any block, whose seed depends on both.
    """
    try:
        return Checks.of(path, check_same(path, specification))
    except DamagedError as error:
        damage = error
    with _empty(path, specification) as fresh:
        checks = replace(Checks.of(fresh, read_attributes(fresh)), root=path)
        if damage.key in (METADATA, FIXED) and not checks.any_block():
            raise ValueError(
                f"{damage.what}, and no block shows that it is an atlas of this specification and "
                "version; write to another path, or remove what is there"
            ) from damage
        for name in [*checks.fixed, FIXED]:
            (path / name).parent.mkdir(parents=True, exist_ok=True)
            (fresh / name).replace(path / name)
    return checks


def read_attributes(path: str | os.PathLike[str]) -> Mapping[str, Any]:
    """Attributes of an atlas; a ValueError if there is no atlas or its metadata are damaged."""
    root, metadata, why = Path(path), {}, ""
    try:
        metadata = json.loads((root / METADATA).read_bytes())
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
        why = "no Zarr group is there"
    except (ValueError, RecursionError):
        why = "it is no JSON"
    attributes = metadata.get("attributes") if isinstance(metadata, dict) else None
    if not isinstance(attributes, dict) or "specification" not in attributes:
        why = why or "it has no specification"
        if (root / CHECKS).is_dir():
            raise DamagedError(root, METADATA, why)
        raise ValueError(f"{path} is no atlas: {why}")
    if not is_unchecked(root):
        checks = Checks(root)
        fixed = checks.sealed_file(FIXED)
        if fixed is None:
            raise DamagedError(root, FIXED, "it is missing")
        checks.check(METADATA, checks.content(METADATA), fixed[METADATA])
    return attributes


def is_unchecked(path: Path) -> bool:
    """Whether the atlas was written by an earlier version, whose checks are not read."""
    return not (path / CHECKS).is_dir() and any((path / name).is_dir() for name in BEFORE)


def checks_of(path: Path) -> Checks | None:
    """The checks of an atlas, or None if it was written by an earlier version.

    Raises as `read_attributes`, and a `DamagedError` if other metadata or an axis are damaged.
    """
    attributes = read_attributes(path)
    return None if is_unchecked(path) else Checks.of(path, attributes)


def done(path: Path, checks: Checks | None) -> Array:
    """Array that tells whether each block is written."""
    if checks is not None:
        return np.array([block is not None for block in checks.blocks])
    group = zarr_module().open_group(str(path), mode="r", use_consolidated=False)
    name = next(name for name in BEFORE if name in group)
    marks = group[name][...]
    return marks != 0 if name == BEFORE[0] else marks[..., -1, 0] >= 0


def long_name(axis: str, ground: str) -> str:
    """Long name of the coordinate of an axis, for this kind of ground."""
    kind = GROUNDS[ground]
    if axis in kind.beside_structures():
        field = kind.__dataclass_fields__[kind.beside_structures()[axis]].metadata
        return f"{field['long_name']}{' over that of the ground' if field['units'] == 's' else ''}"
    stem, _, number = axis.rpartition("_")
    return f"{LONG_NAMES[stem]}, structure {number}" if stem in LONG_NAMES else LONG_NAMES[axis]
