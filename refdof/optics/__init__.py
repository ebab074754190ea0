"""Optics: camera, thin lens and aperture, and the points of lens and pixel that rays pass."""
