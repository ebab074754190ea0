"""Scenes: triangles, materials and light, from files or built in."""
