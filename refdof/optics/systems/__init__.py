"""Lens systems: prescriptions of real lenses, their glass, and rays through them.

Lengths are millimetres. z grows from the scene to the sensor, the first surface's vertex is at z = 0, and the axis is
x = y = 0.
"""
