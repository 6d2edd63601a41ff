"""Parts of compiled code: functions that only compiled code calls.

By default numba prepares every function to be called from Python, with the code of all functions that
it calls. In a chain of calls the innermost function is optimized and translated to machine code again at
each level. A part is passed on as LLVM code, and optimized once, inside the `compiled.entry` that calls
it. This saves four fifths of the time to compile `pound`.
"""

from __future__ import annotations

import ctypes
from typing import Any, ClassVar

from numba import _dynfunc  # type: ignore[attr-defined]
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import AnalysisPass, PassManager, register_pass
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import NativeLowering
from numba.core.types import Function, unliteral

from stochlin.messages import WHEN_COMPILING

# The C function behind a part that is called from Python: it returns NULL, which raises a TypeError.
REFUSAL = ctypes.cast(ctypes.pythonapi.PyErr_SetFromErrno, ctypes.c_void_p).value


class _Library(JITCodeLibrary):
    """LLVM code of a part, which is neither optimized nor translated to machine code."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()  # type: ignore[no-untyped-call]
        self._finalized = True


@register_pass(mutates_CFG=False, analysis_only=True)  # type: ignore[no-untyped-call]
class _Naming(AnalysisPass):
    """The compiler pass that registers the code of a part, so that calls to the part find it."""

    _name = "naming_of_parts"

    def __init__(self) -> None:
        pass

    def run_pass(self, state: Any) -> bool:
        done, library = state["cr"], state.library
        about, doc = done.fndesc, "called from compiled code only"
        name = _dynfunc.make_function(
            about.lookup_module(), about.qualname, doc, REFUSAL, done.env, (library,)
        )
        state.targetctx.insert_user_function(name, about, [library])
        state["cr"] = done._replace(cfunc=name)
        return False


class _Typing:
    """numba's context of types, with a memory of the operators and functions that it knows by itself.

    Of every addition numba asks dozens of templates, and again in each round of its inference.
    """

    _known: ClassVar[dict[Any, Any]] = {}

    def __init__(self, context: Any) -> None:
        self._context = context

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def resolve_function_type(self, func: Any, args: Any, kws: Any) -> Any:
        """The signature of a function of arguments of these types; None where it has none."""
        key = func, tuple(args)
        if type(func) is not Function or kws:
            return self._context.resolve_function_type(func, args, kws)
        if self._known.get(key) is None:
            self._known[key] = self._context.resolve_function_type(func, args, kws)
        return self._known[key]


class Parts(CompilerBase):
    """The compiler pipeline (numba's ``pipeline_class``) of parts."""

    def define_pipelines(self) -> list[PassManager]:
        """Numba's pipeline without machine code and Python wrappers, which registers the code last."""
        for call in tuple(WHEN_COMPILING):
            call(False)
        state = self.state
        state.typingctx = _Typing(state.typingctx)
        state.flags.no_compile = state.flags.no_cpython_wrapper = state.flags.no_cfunc_wrapper = True
        codegen, name = state.targetctx.codegen(), state.func_id.func_qualname
        state.library = _Library(codegen, name)  # type: ignore[no-untyped-call]
        passes: Any = DefaultPassBuilder.define_nopython_pipeline(state)  # type: ignore[no-untyped-call]
        passes.add_pass_after(_Naming, NativeLowering)
        passes.finalize()
        return [passes]


class Part(CPUDispatcher):
    """The dispatcher of parts, which compiles a part once for all integer arguments.

    By default numba compiles a function again for each integer literal in the code of a caller.
    """

    def __call__(self, *args: Any) -> Any:
        """From Python, for the few numbers that are not worth compiling: as plain Python."""
        return self.py_func(*args)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Numba's method, with literal types replaced by the types of their values."""
        plain: Any = unliteral
        known = {name: plain(one) for name, one in kws.items()}
        return super().get_call_template([plain(one) for one in args], known)
