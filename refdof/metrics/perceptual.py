"""FLIP: how visible a difference is when one flips between two display images.

The only file that imports flip-evaluator. That library ends the interpreter on some inputs, takes NaN for
black and misreads integers and a fourth channel. So only its LDR mode is used, with a fixed viewing
distance, and only what `display_pair` makes gets in: finite float32 (H, W, 3) in C order and [0, 1].

References
----------
.. [1] Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom & Fairchild (2020), FLIP: A Difference
   Evaluator for Alternating Images, Proceedings of the ACM on Computer Graphics and Interactive Techniques
   3(2).
"""

from typing import Any

from refdof.metrics._pair import display_pair

__all__ = ["FLIP_PPD", "flip"]

FLIP_PPD = 67.0206  # pixels per degree: [1]'s display, 0.7 m wide, 3840 px, seen from 0.7 m


def flip(reference: Any, image: Any) -> float:
    """Mean FLIP error of the display images at 67.02 pixels per degree: 0 for identical ones, at most 1.

    Parameters
    ----------
    reference, image : (H, W, 3)
        Linear RGB.

    Raises
    ------
    InputError
        If shapes differ or a value is not finite.
    """
    import flip_evaluator  # slow to import

    first, second = display_pair(reference, image)
    _, mean, _ = flip_evaluator.evaluate(
        first,
        second,
        "LDR",
        inputsRGB=True,
        applyMagma=False,
        computeMeanError=True,
        parameters={"ppd": FLIP_PPD},
    )
    return float(mean)
