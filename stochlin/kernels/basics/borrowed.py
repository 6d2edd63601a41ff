"""Arrays that compiled functions borrow: fields of named tuples, and columns of blocks of memory.

Of an array in a tuple numba counts the references in each function and loop that the tuple comes
to, which takes most of the time of a short step, and of the compiler. In compiled code a field or
column of this module is its address and shape, and no references are counted: who calls a compiled
function holds the memory until it returns.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Self, TypeVar

import numba as nb
from numba.extending import (
    NativeValue,
    lower_getattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)

from stochlin.kernels.basics.arrays import Array, zeros_on_a_line

Tuple = TypeVar("Tuple", bound=type)


def borrowed(fields: Tuple) -> Tuple:
    """A class of named tuples that compiled functions borrow; their arrays are contiguous."""
    typeof_impl.register(fields, _type_of_tuple)
    return fields


class Columns:
    """A block of numbers (columns, ..., lanes); each annotation of a subclass names a column."""

    _fields: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        cls._fields = tuple(cls.__annotations__)
        for number, name in enumerate(cls._fields):
            setattr(cls, name, property(_column_of(number)))

    def __init__(self, block: Array) -> None:
        self.block = block

    @classmethod
    def shape(cls, *column: int) -> tuple[int, ...]:
        """The shape of a block with columns of this shape."""
        return len(cls._fields), *column

    @classmethod
    def zeros(cls, *column: int) -> Self:
        """Columns of this shape."""
        return cls(zeros_on_a_line(*cls.shape(*column)))

    def of_lane(self, lane: int) -> Self:
        """The columns of one lane."""
        return type(self)(self.block[..., lane])


def _column_of(number: int) -> Callable[[Columns], Array]:
    """The function that takes a column from its block."""
    return lambda columns: columns.block[number]


class BorrowedType(nb.types.NamedTuple):
    """The type of a tuple in compiled code with the fields of a named tuple, but not its memory."""


class ColumnsType(nb.types.NamedTuple):
    """The type of a `Columns` in compiled code, whose fields are its columns."""

    def __init__(self, columns: type[Columns], dimensions: int) -> None:
        self.block = nb.types.Array(nb.types.float64, dimensions, "C")
        column = nb.types.Array(nb.types.float64, dimensions - 1, "C")
        super().__init__([column] * len(columns._fields), columns)


def _type_of_tuple(value: Any, context: Any) -> BorrowedType:
    kinds = [typeof_impl(field, context) for field in value]
    for name, kind in zip(value._fields, kinds, strict=True):
        if _is_array(kind) and kind.layout != "C":
            raise TypeError(f"{type(value).__name__}.{name} is not contiguous")
    return BorrowedType(kinds, type(value))


@typeof_impl.register(Columns)
def _type_of_columns(value: Columns, _context: Any) -> ColumnsType:
    if not value.block.flags.c_contiguous:
        raise TypeError(f"the block of {type(value).__name__} is not contiguous")
    return ColumnsType(type(value), value.block.ndim)


def _fields_of(kind: BorrowedType) -> dict[str, Any]:
    """The types of the fields of a tuple."""
    return dict(zip(kind.fields, kind.types, strict=True))


def _is_array(kind: Any) -> bool:
    return isinstance(kind, nb.types.Array)


def _shape_of(field: str) -> str:
    """The name of the member with the shape of an array."""
    return f"{field}_shape"


def _members(field: str, kind: Any) -> list[tuple[str, Any]]:
    """What stands for a field in the structure of its tuple."""
    if not _is_array(kind):
        return [(field, kind)]
    address = nb.types.CPointer(kind.dtype)
    shape = nb.types.UniTuple(nb.types.intp, kind.ndim)
    return [(field, address), (_shape_of(field), shape)]


@register_model(BorrowedType)
class _TupleModel(models.StructModel):
    def __init__(self, manager, kind):
        members = [member for item in _fields_of(kind).items() for member in _members(*item)]
        super().__init__(manager, kind, members)


@register_model(ColumnsType)
class _ColumnsModel(models.StructModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _members("block", kind.block))


@unbox(BorrowedType)
def _unbox_tuple(kind, value, c):
    return _unbox(kind, _fields_of(kind), value, c)


@unbox(ColumnsType)
def _unbox_columns(kind, value, c):
    return _unbox(kind, {"block": kind.block}, value, c)


def _unbox(kind, fields, value, c):
    """The fields of a Python object, of which arrays stay its own."""
    structure = c.context.make_helper(c.builder, kind)
    failed = c.context.get_constant(nb.types.boolean, False)
    for field, kind_of_field in fields.items():
        item = c.pyapi.object_getattr_string(value, field)
        native = c.unbox(kind_of_field, item)
        failed = c.builder.or_(failed, native.is_error)
        if _is_array(kind_of_field):
            array = c.context.make_helper(c.builder, kind_of_field, native.value)
            setattr(structure, field, array.data)
            setattr(structure, _shape_of(field), array.shape)
            c.context.nrt.decref(c.builder, kind_of_field, native.value)
        else:
            setattr(structure, field, native.value)
        c.pyapi.decref(item)
    return NativeValue(structure._getvalue(), is_error=failed)


@lower_getattr_generic(BorrowedType)
def _field(context, builder, kind, value, name):
    """A field of a tuple."""
    structure = context.make_helper(builder, kind, value)
    item = getattr(structure, name)
    kind_of_field = _fields_of(kind)[name]
    if not _is_array(kind_of_field):
        return item
    shape = _sizes(builder, getattr(structure, _shape_of(name)), kind_of_field.ndim)
    return _array(context, builder, kind_of_field, item, shape)


@lower_getattr_generic(ColumnsType)
def _column(context, builder, kind, value, name):
    """A column of a block."""
    structure = context.make_helper(builder, kind, value)
    shape = _sizes(builder, structure.block_shape, kind.block.ndim)[1:]
    distance = context.get_constant(nb.types.intp, kind.fields.index(name))
    for size in shape:
        distance = builder.mul(distance, size)
    begin = builder.gep(structure.block, [distance])
    return _array(context, builder, kind.types[0], begin, shape)


def _sizes(builder, shape, dimensions):
    """The sizes in a shape."""
    return [builder.extract_value(shape, axis) for axis in range(dimensions)]


def _array(context, builder, kind, data, shape):
    """A contiguous array at an address; it has no counter of references."""
    item = context.get_abi_sizeof(context.get_data_type(kind.dtype))
    steps = [context.get_constant(nb.types.intp, item)]
    for size in reversed(shape):
        steps.insert(0, builder.mul(size, steps[0]))
    total, *strides = steps
    sizes = nb.types.UniTuple(nb.types.intp, kind.ndim)
    array = context.make_helper(builder, kind)
    array.data = data
    array.shape = context.make_tuple(builder, sizes, shape)
    array.strides = context.make_tuple(builder, sizes, strides)
    array.itemsize = strides[-1]
    array.nitems = builder.udiv(total, strides[-1])
    return array._getvalue()
