"""Focus: points of a scene that shall be sharp or blurred, and the lens that follows them.

After Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, section 5.
"""
