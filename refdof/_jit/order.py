"""Order: rows dealt out so that every thread has as much to do.

Numba gives each thread one run of a parallel loop's numbers, and what lies together in a picture is blurred alike.
"""

from refdof._jit.compile import inline

__all__ = ["fair_step"]


@inline
def fair_step(count):
    """A step through `count` rows, k step % count, that meets each once and spreads every run of k over all of them.

    Steps of the golden section do: Knuth, The Art of Computer Programming 3, section 6.4, theorem S.
    """
    step = max(int(count * 0.6180339887498949), 1)
    while _share_a_factor(step, count):
        step += 1
    return step


@inline
def _share_a_factor(a, b):
    while b > 0:
        a, b = b, a % b
    return a > 1
