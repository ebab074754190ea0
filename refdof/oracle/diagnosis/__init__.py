"""Diagnosis: the cause of a wrong port of the single pass, in a sentence."""
