"""JSON Schemas of packs and of the check's report; every pack has a copy."""
