"""The oracle: packs of inputs and results, and the check of other implementations against them."""

from refdof.oracle.pack import write_pack

__all__ = ["write_pack"]
