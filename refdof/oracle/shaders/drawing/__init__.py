"""What the process that draws is made of.

It imports nothing else of refdof, and itself relatively: that process starts in a fraction of the time that refdof
takes to import. See `refdof.oracle.shaders.process`.
"""
