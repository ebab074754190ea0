"""Diagnosis: the cause of a wrong port of the single pass, in a sentence."""

from refdof.oracle.diagnosis.diagnose import Diagnosis, Named, diagnose, diagnose_source

__all__ = ["Diagnosis", "Named", "diagnose", "diagnose_source"]
