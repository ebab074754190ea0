"""What some methods do otherwise than all others, by nature: tests over all methods leave them out where they must."""

NONLINEAR = {
    "filament": "halves pictures with weights by colour, and takes medians",
    "halfres": "takes greatest values",
    "ringgather": "takes medians",
}
"""Methods whose picture of a sum of colours is not the sum of their pictures, and why."""

IN_ONE_UNIT = {"ringgather": "has constants in the unit of depth"}
"""Methods whose picture is another in another unit of length, and why."""
