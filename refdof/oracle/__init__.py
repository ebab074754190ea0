"""The oracle: packs of inputs and results, and the check of other implementations against them."""

from refdof.oracle.checking import check, check_command, check_results, check_shader
from refdof.oracle.diagnosis import diagnose
from refdof.oracle.pack import write_pack

__all__ = ["check", "check_command", "check_results", "check_shader", "diagnose", "write_pack"]
