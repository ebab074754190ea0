"""Explanations: every tap, ray, layer and weight that made a pixel, for every method."""

from refdof.explain.explain import EXPLAINERS, explain_pictures, explain_view
from refdof.explain.explanation import Explanation
from refdof.explain.picture import save_picture
from refdof.explain.table import csv_of, text_of

__all__ = ["EXPLAINERS", "Explanation", "csv_of", "explain_pictures", "explain_view", "save_picture", "text_of"]
