"""Readers of mesh files other than glTF: OBJ, PLY and OFF, and what all readers share."""
