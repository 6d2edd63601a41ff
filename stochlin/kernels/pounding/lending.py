"""Named tuples passed between compiled functions by address.

numba passes a named tuple by value: with two dozen arrays these are some two hundred numbers at each
call, and each access to an array changes its reference count. A tuple passed by `borrow` is a single
address, and its arrays are not counted. Without the counting `pound` takes a fourth of the time; with
the address in place of the numbers it takes a third less again, and so does its compilation.
"""

from __future__ import annotations

from typing import Any

import numba as nb
from llvmlite import ir  # type: ignore[import-untyped]
from numba.core.cgutils import alloca_once_value, voidptr_t
from numba.core.datamodel.models import OpaqueModel
from numba.core.imputils import lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import intrinsic, register_model

UNCOUNTED = "meminfo", "parent"  # fields of an array that count references to its memory
OFFSET = ir.IntType(64)


class Lent(nb.types.Type):
    """The numba type of the address of a named tuple; ``owned`` is the type of the tuple."""

    def __init__(self, owned: Any) -> None:
        self.owned = owned
        super().__init__(name=f"Lent({owned.instance_class.__name__})")

    @property
    def key(self) -> Any:
        """The type of the tuple: two types of addresses are equal if these are."""
        return self.owned


register_model(Lent)(OpaqueModel)


@infer_getattr
class _Fields(AttributeTemplate):
    key = Lent

    def generic_resolve(self, lent: Any, name: str) -> Any:  # type: ignore[override]
        """The type of the field ``name`` of the tuple; None if there is none."""
        fields = lent.owned.fields
        return lent.owned.types[fields.index(name)] if name in fields else None


@lower_getattr_generic(Lent)  # type: ignore[no-untyped-call, untyped-decorator]
def _field(target: Any, builder: Any, lent: Any, address: Any, name: str) -> Any:
    """Generate code that reads the field ``name`` of the tuple at ``address``."""
    number = lent.owned.fields.index(name)
    kind, whole = lent.owned.types[number], target.get_value_type(lent.owned)
    if isinstance(whole, ir.ArrayType):  # all fields are of one type
        begin = number * whole.element.get_abi_size(target.target_data)
    else:
        begin = whole.get_element_offset(target.target_data, number)
    layout = target.get_value_type(kind)
    if not isinstance(kind, nb.types.Array):
        return _read(builder, address, begin, layout)
    view = target.make_array(kind)(target, builder)
    for n, part in enumerate(view._datamodel._fields):
        value = ir.Constant(layout.elements[n], None)
        if part not in UNCOUNTED:
            offset = begin + layout.get_element_offset(target.target_data, n)
            value = _read(builder, address, offset, layout.elements[n])
        setattr(view, part, value)
    return view._getvalue()


def _read(builder: Any, address: Any, offset: int, layout: Any) -> Any:
    """Generate code that reads a constant ``offset`` bytes after ``address``.

    The read is marked as of constant memory, so that LLVM does not repeat it after writes to arrays.
    """
    place = builder.gep(address, [ir.Constant(OFFSET, offset)])
    value = builder.load(builder.bitcast(place, layout.as_pointer()))
    value.set_metadata("invariant.load", builder.module.add_metadata([]))
    return value


def _borrow(context: Any, owned: Any) -> Any:
    """The address of a named tuple; the caller has to keep the tuple alive while the address is used."""

    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        place = alloca_once_value(builder, arguments[0])  # type: ignore[no-untyped-call]
        # `_read` declares the memory constant, so that LLVM could drop the write to it as unused. The
        # empty assembler instruction hides from LLVM that its result is the address written to.
        same = ir.FunctionType(voidptr_t, [voidptr_t])
        return builder.asm(same, "", "=r,0,~{memory}", [builder.bitcast(place, voidptr_t)], True)

    return Lent(owned)(owned), generate


uncompiled: Any = nb.config.DISABLE_JIT  # type: ignore[attr-defined]
borrow: Any = (lambda owned: owned) if uncompiled else intrinsic(_borrow)
