"""Lazy: machine code is made only of functions that are called from Python.

Numba optimises every function that a kernel calls, and makes machine code of it, before it links the function into the
kernel, where both happen again. A prange loop goes through it four times. Here a function's library stays as it was
lowered until somebody asks for an address in it. This saves a third of the time that compiling takes. What is made in
the end is the same: LLVM's optimisations change no value.

Numba has no public door for this. Where its insides are not as expected, `lazily` does nothing.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba import njit
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.registry import CPUDispatcher, cpu_target

from refdof._jit.call_types import remembered

__all__ = ["HelperDispatcher", "LazyCompiler", "lazily"]


class _LazyLibrary(JITCodeLibrary):
    """A library of lowered functions: optimised, and made into machine code, when an address in it is asked for."""

    _made = False

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        if self._object_caching_enabled and self._compiled_object:  # read from a cache file
            self._made = True
            super()._finalize_final_module()
        else:
            self._finalize_dynamic_globals()
            self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """The address of a function; 0: it is not here."""
        self._ensure_finalized()
        if not self._made:
            if all(function.name != name for function in self.get_defined_functions()):
                return 0
            self._made = True
            super()._optimize_final_module()
            self._final_module.verify()
            super()._finalize_final_module()
        return int(super().get_pointer_to_function(name))

    def serialize_using_object_code(self) -> Any:
        """What a cache file holds."""
        if self._made:
            return super().serialize_using_object_code()
        return self.name, "bitcode", self._get_module_for_linking().as_bitcode()


@contextmanager
def lazily() -> Iterator[None]:
    """Libraries that Numba makes in this block are lazy. Call with Numba's compiler lock held, as compiling does."""
    codegen = cpu_target.target_context.codegen()
    plain, engine = getattr(codegen, "_library_class", None), getattr(codegen, "_engine", None)
    if plain is not JITCodeLibrary or engine is None:  # within another such block; or another Numba
        yield
        return
    set_env = codegen.set_env

    def set_env_if_made(name: str, env: Any) -> None:
        if engine.get_global_value_address(name):
            set_env(name, env)

    codegen._library_class, codegen.set_env = _LazyLibrary, set_env_if_made
    try:
        yield
    finally:
        codegen._library_class = plain
        del codegen.set_env


class LazyCompiler(Compiler):
    """Numba's compiler, with lazy libraries and call types, and without garbage collection, a quarter of the time."""

    def _compile_core(self) -> Any:
        collects = gc.isenabled()
        gc.disable()
        try:
            with lazily(), remembered():
                return super()._compile_core()
        finally:
            if collects:
                gc.enable()


class HelperDispatcher(CPUDispatcher):
    """A function that is compiled to be linked into kernels, without a door to Python; a call makes one."""

    _door: Any = None

    def __call__(self, *arguments: Any) -> Any:
        """Call from Python, as tests do."""
        if self._door is None:
            helper = self
            self._door = njit(lambda *values: helper(*values))
        return self._door(*arguments)
