"""Named tuples that compiled functions hand on by their address.

numba hands on a named tuple by value: two dozen arrays are some two hundred numbers at each call, for
LLVM to carry about, and a reference is counted whenever an array is taken out. What is borrowed is one
address, and its arrays are not counted: `pound` takes a fourth of the time without the counting, and a
third less again without the numbers, as long as it takes to compile.
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

UNCOUNTED = "meminfo", "parent"  # of an array: by whom its memory is held
OFFSET = ir.IntType(64)


class Lent(nb.types.Type):
    """The address of a named tuple of this type."""

    def __init__(self, owned: Any) -> None:
        self.owned = owned
        super().__init__(name=f"Lent({owned.instance_class.__name__})")

    @property
    def key(self) -> Any:
        """By which types are told apart."""
        return self.owned


register_model(Lent)(OpaqueModel)


@infer_getattr
class _Fields(AttributeTemplate):
    key = Lent

    def generic_resolve(self, lent: Any, name: str) -> Any:  # type: ignore[override]
        """The type of a field."""
        fields = lent.owned.fields
        return lent.owned.types[fields.index(name)] if name in fields else None


@lower_getattr_generic(Lent)  # type: ignore[no-untyped-call, untyped-decorator]
def _field(target: Any, builder: Any, lent: Any, address: Any, name: str) -> Any:
    """A field as it is read."""
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
    """What nobody writes to: LLVM need not read it again after each number that is written elsewhere."""
    place = builder.gep(address, [ir.Constant(OFFSET, offset)])
    value = builder.load(builder.bitcast(place, layout.as_pointer()))
    value.set_metadata("invariant.load", builder.module.add_metadata([]))
    return value


def _borrow(context: Any, owned: Any) -> Any:
    """The address of a named tuple; who owns its arrays has to keep them while they are used."""

    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        place = alloca_once_value(builder, arguments[0])  # type: ignore[no-untyped-call]
        # An empty instruction, of which LLVM does not know that its result is the place that is written
        # here: it could take what is written for needless, as `_read` says that nothing is.
        same = ir.FunctionType(voidptr_t, [voidptr_t])
        return builder.asm(same, "", "=r,0,~{memory}", [builder.bitcast(place, voidptr_t)], True)

    return Lent(owned)(owned), generate


uncompiled: Any = nb.config.DISABLE_JIT  # type: ignore[attr-defined]
borrow: Any = (lambda owned: owned) if uncompiled else intrinsic(_borrow)
