"""Kit: what the built-in scenes are built with."""
