"""Where each property of a blur is tested. `refdof.testing` has those of them that hold for any filter of pictures."""

import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.fast

TESTS = Path(__file__).parents[1]

TABLE = {
    "one colour in, the same colour out": [
        "test_promises.py::test_constant",
        "methods/test_contract.py::test_constant",
        "truth/test_invariances.py::test_one_colour_everywhere_stays",
        "properties/test_pictures.py::test_what_is_promised_holds_on_plain_arrays",
    ],
    "the energy of a light is kept": [
        "test_promises.py::test_energy",
        "truth/test_invariances.py::test_the_light_of_a_lamp_does_not_depend_on_focus",
        "methods/scatter/test_scatter.py::test_an_interior_point_keeps_its_energy",
        "properties/test_pictures.py::test_a_spot_is_a_disc",
    ],
    "a radius of 0 is the pinhole": [
        "test_promises.py::test_pinhole",
        "truth/test_invariances.py::test_no_radius_is_a_pinhole",
    ],
    "a plane in focus is unchanged": ["test_promises.py::test_focus", "methods/test_contract.py::test_focus"],
    "scene and lens in other units": [
        "properties/test_scenes.py::test_the_unit_of_length_changes_no_bit",
        "truth/test_invariances.py::test_powers_of_two_change_no_bit",
        "optics/test_lens.py::test_the_unit_of_length_changes_nothing",
    ],
    "circles are linear in the aperture, and finite at infinity": [
        "properties/test_formulas.py::test_circles_are_linear_in_the_aperture",
        "properties/test_formulas.py::test_the_background_has_the_photographers_circle",
        "optics/test_lens.py::test_any_depth_agrees_with_fractions",
    ],
    "whole pixels of translation": ["properties/test_pictures.py::test_what_moves_or_is_cut_is_blurred_as_before"],
    "mirror symmetry": ["test_promises.py::test_symmetry", "methods/test_contract.py::test_symmetry"],
    "linearity in colour": ["properties/test_scenes.py::test_light_adds_up"],
    "no result outside the range of the input": [
        "test_promises.py::test_convexity",
        "methods/test_baselines.py::test_every_pixel_is_a_mean_of_the_picture",
    ],
    "apertures are uniform, with the moments of their shape": [
        "optics/test_aperture.py::test_polygons_are_uniform",
        "optics/test_aperture.py::test_disc_is_uniform",
        "properties/test_formulas.py::test_polygons_have_the_second_moment_of_the_formula",
    ],
    "N-buffers bound every rectangle": [
        "raster/filters/test_n_buffer.py::test_exact_query_is_brute_force",
        "raster/filters/test_n_buffer.py::test_kernels_miss_no_pixel_of_any_rectangle",
    ],
    "umbra culling removes nothing that a lens sees": [
        "raster/rays/test_umbra.py::test_nothing_is_lost_that_a_lens_sees_past_an_isolated_pixel",
        "methods/lensblur/test_scenes.py::test_peeling_stores_the_survivors_of_all_layers",
    ],
    "rays meet what an exhaustive march meets": [
        "methods/lensblur/test_lensblur.py::test_every_ray_meets_what_an_exhaustive_march_meets",
        "methods/multiview/test_multiview.py::test_march_hits_what_the_twin_hits",
    ],
    "more layers or samples are no worse": [
        "properties/test_scenes.py::test_more_samples_are_no_worse",
        "methods/lensblur/test_scenes.py::test_all_layers_and_dense_pixels_converge_to_the_truth",
    ],
    "circles scale with the resolution": ["optics/test_lens.py::test_twice_the_rows_are_twice_the_pixels"],
    "quality keeps the mean radius": ["properties/test_scenes.py::test_a_cheaper_setting_keeps_the_radius"],
    "depths of all kinds give one circle": [
        "frame/test_depth_kinds.py::test_there_and_back_over_a_picture",
        "oracle/test_pack.py::test_circles_come_back_from_device_depth_in_float32",
    ],
    "the same bits for any number of threads": [
        "properties/test_scenes.py::test_threads_change_no_bit",
        "truth/test_invariances.py::test_the_number_of_threads_changes_no_bit",
    ],
    "without dispersion no bit changes; bokeh turns round at the focal plane": [
        "truth/test_lens_colours.py::test_without_dispersion_one_pass_is_enough_and_no_bit_changes",
        "truth/test_expressive_lens.py::test_each_colour_has_the_focus_of_its_index",
        "methods/multiview/test_cones.py::test_bokeh_is_the_aperture_and_not_its_mirror_image",
        "properties/test_scenes.py::test_cut_bokeh_turns_round_at_the_focal_plane",
    ],
}


def test_there_are_twenty():
    assert len(TABLE) == 20


@pytest.mark.parametrize("place", sorted({place for places in TABLE.values() for place in places}))
def test_the_test_exists(place):
    path, name = place.split("::")
    assert re.search(rf"^def {name}\(", (TESTS / path).read_text(), re.MULTILINE)
