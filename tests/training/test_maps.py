"""Errors as colours on heads."""

import numpy as np

from sketchwidget import FaceModel
from sketchwidget.training.maps import colours, error_maps, skin_of, wrinkle_maps


def test_colours_go_from_blue_to_red_and_stay_there():
    near, middle, far, beyond = colours(np.array([0.2, 1.5, 2.9, 9.0]), 3.0)
    assert near[2] > near[0] and far[0] > far[2] and middle[1] > max(middle[0], middle[2]) - 0.1
    assert beyond[0] > beyond[2] and colours(np.zeros(2), 1.0).max() <= 1


def test_a_map_shows_each_method_where_it_errs():
    model = FaceModel.load()
    skin = model.mean[skin_of(model)]
    left = np.where(skin[:, 0] > 0, 6.0, 0.0)  # the subject's left is the viewer's right
    maps = error_maps(model, {"left": left, "none": np.zeros(len(skin))}, columns=2)
    assert maps.shape[1] == 2 * 2 * 200 and maps.dtype == np.uint8
    cheeks = maps[22 + 120, [85, 115]].astype(int)  # of the front view of the first
    assert cheeks[0, 2] > cheeks[0, 0] and cheeks[1, 0] > cheeks[1, 2]


def test_what_wrinkles_change_is_shown_beside_both_heads():
    model = FaceModel.load()
    calm, cross = model.face(), model.face(expression="anger")
    picture = wrinkle_maps([(cross.sketch(), cross, calm)])
    assert picture.shape[1] == 5 * 200
    grey = np.abs(np.diff(picture[22:222, 200:600].astype(int), axis=2)).max()
    coloured = np.abs(np.diff(picture[22:222, 600:].astype(int), axis=2)).max()
    assert coloured > 2 * grey
