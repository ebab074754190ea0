"""Memory: arrays without reference counts, and foreign functions and raw memory for kernels."""

import ctypes
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from refdof._jit.compile import JIT_DISABLED

__all__ = ["array_at", "borrow", "call_address", "fetch_row"]

_CACHE_LINE = 64  # bytes


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
def _pointer(typingctx: Any, address: Any) -> Any:
    """The pointer to `address`, an integer."""
    signature = types.voidptr(types.intp)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], ir.IntType(8).as_pointer())

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


@intrinsic
def _fetch(typingctx: Any, address: Any) -> Any:
    """Ask for the cache line at `address`, an integer, without waiting for it."""
    signature = types.void(types.intp)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        pointer, number = ir.IntType(8).as_pointer(), ir.IntType(32)
        function_type = ir.FunctionType(ir.VoidType(), [pointer, number, number, number])
        function = cgutils.get_or_insert_function(builder.module, function_type, "llvm.prefetch.p0i8")
        read, keep, data = (ir.Constant(number, value) for value in (0, 3, 1))
        builder.call(function, [builder.inttoptr(arguments[0], pointer), read, keep, data])
        return context.get_dummy_value()

    return signature, generate


def _call_interpreted(address: int, first: int, second: int, third: int, fourth: int) -> None:
    ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 4)(address)(first, second, third, fourth)


def _array_interpreted(address: int, shape: Any, dtype: Any) -> Any:
    count = int(np.prod(shape))
    memory = (ctypes.c_char * (count * np.dtype(dtype).itemsize)).from_address(int(address)) if count else b""
    return np.frombuffer(memory, dtype=dtype).reshape(shape)


def _identity(array: Any) -> Any:
    return array


def _fetch_nothing(array: Any, row: int) -> None:
    pass


if JIT_DISABLED:
    call_address, borrow, fetch_row, array_at = _call_interpreted, _identity, _fetch_nothing, _array_interpreted
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

    @numba.njit(cache=True)
    def fetch_row(array, row):
        """Fetch a row of a C-ordered array into the nearest cache, without waiting: for rows read a little later."""
        first = array.ctypes.data + row * array.strides[0]
        for line in range(0, array.strides[0], _CACHE_LINE):
            _fetch(first + line)
        _fetch(first + array.strides[0] - 1)

    @numba.njit(cache=True)
    def array_at(address, shape, dtype):
        """The array of this shape and type at `address`, an integer. For callbacks, which see raw memory only."""
        return numba.carray(_pointer(address), shape, dtype)
