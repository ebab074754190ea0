"""The oracle: packs of inputs and results, and the check of other implementations against them."""

from refdof.oracle.checking import check, check_command, check_results, check_shader, check_source
from refdof.oracle.diagnosis import diagnose
from refdof.oracle.pack import write_pack
from refdof.oracle.selection import Plan

__all__ = ["Plan", "check", "check_command", "check_results", "check_shader", "check_source", "diagnose", "write_pack"]
