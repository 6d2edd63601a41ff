"""Arrays that compiled code uses while their owner waits: nobody counts who holds them.

numba counts a reference whenever an array is taken out of a tuple, which in a function of a
microsecond is half of the time.
"""

from __future__ import annotations

from typing import Any

from numba.extending import intrinsic


def _borrow(context: Any, array: Any) -> Any:
    """The same array without its owner, who has to keep it as long as it is used."""

    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        view = target.make_array(array)(target, builder, arguments[0])
        view.meminfo = view.meminfo.type(None)
        view.parent = view.parent.type(None)
        return view._getvalue()

    return array(array), generate


borrow: Any = intrinsic(_borrow)
