"""Memory: arrays without reference counts, and foreign functions and raw memory for kernels."""

import ctypes
from typing import Any

import numba
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from refdof._jit.compile import JIT_DISABLED

__all__ = ["borrow", "call_address", "load_int32", "store_int32"]


@intrinsic
def _call_compiled(typingctx: Any, address: Any, first: Any, second: Any, third: Any, fourth: Any) -> Any:
    """Call the C function at `address` with four pointers given as integers."""
    signature = types.void(types.intp, types.intp, types.intp, types.intp, types.intp)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        pointer = ir.PointerType(ir.IntType(8))
        function_type = ir.FunctionType(ir.VoidType(), [pointer] * 4)
        function = builder.inttoptr(arguments[0], function_type.as_pointer())
        builder.call(function, [builder.inttoptr(a, pointer) for a in arguments[1:]])
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def load_int32(typingctx: Any, address: Any) -> Any:
    """The int32 at `address`, an integer. For callbacks, which see raw memory only."""
    signature = types.int32(types.intp)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.load(builder.inttoptr(arguments[0], ir.IntType(32).as_pointer()))

    return signature, generate


@intrinsic
def store_int32(typingctx: Any, address: Any, value: Any) -> Any:
    """Write the int32 `value` to `address`, an integer. For callbacks, which see raw memory only."""
    signature = types.void(types.intp, types.int32)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        builder.store(arguments[1], builder.inttoptr(arguments[0], ir.IntType(32).as_pointer()))
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def _borrow(typingctx: Any, array: Any) -> Any:
    """The same array without its reference count."""
    signature = array(array)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        view = context.make_array(array)(context, builder, arguments[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        view.parent = cgutils.get_null_value(view.parent.type)
        return view._getvalue()

    return signature, generate


def _call_interpreted(address: int, first: int, second: int, third: int, fourth: int) -> None:
    ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 4)(address)(first, second, third, fourth)


def _identity(array: Any) -> Any:
    return array


if JIT_DISABLED:
    call_address, borrow = _call_interpreted, _identity
else:

    @numba.njit(cache=True)
    def call_address(address, first, second, third, fourth):
        """Call the C function at `address` with four pointers, all given as integers."""
        _call_compiled(address, first, second, third, fourth)

    @numba.njit(cache=True)
    def borrow(array):
        """The same array without its reference count, for inner loops of many threads.

        Counting references to a shared array is an atomic write to one memory cell by every thread, for which
        they wait. The caller keeps the array alive.
        """
        return _borrow(array)
