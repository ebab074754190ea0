"""Field strip: what a real lens does to a chart in the plane in focus, by the reference and by methods.

In a scene, what stands in focus seldom reaches the corners: the curvature of the field is not seen. On the chart it is.
"""

from collections.abc import Callable, Sequence
from typing import Any

from refdof._check import Float
from refdof.comparison import Chart
from refdof.optics.lens import ThinLens
from refdof.rendering import render_view
from refdof.scene.lens_chart import lens_chart
from refdof.view import View

__all__ = ["field_strip"]


def field_strip(
    view: View, rows: Sequence[tuple[str, str, str, dict[str, Any]]], reference: Callable[[View], Float]
) -> Chart:
    """The chart through the view's lens: by the reference, by it through a thin lens, and by each method.

    `rows` are name, method, preset and parameters; `reference` makes the picture of a view. Pictures are the half from
    the middle to the corner.
    """
    chart = lens_chart(view.camera, view.lens)
    real = View(chart.scene, chart.camera, view.lens)
    thin = real.with_lens(ThinLens(view.lens.radius, view.lens.focus_distance))
    pictures = {"reference": reference(real), "reference, thin lens": reference(thin)}
    for name, method, preset, values in rows:
        pictures[name] = render_view(method, real, preset=preset, **values).image
    return Chart({name: image[:, chart.window] for name, image in pictures.items()})
