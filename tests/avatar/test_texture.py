import numpy as np

from sketchwidget.avatar.texture import diffused


def test_diffusion_by_hand():
    """One known pixel in a corner of a row: each next one is the mean of what was reached, so all are the same."""
    image = np.zeros((1, 4, 3), np.uint8)
    image[0, 0], image[0, 3] = 90, 30
    inside = np.array([[True, False, False, True]])
    result = diffused(image, inside)
    assert result[0, :, 0].tolist() == [90, 90, 30, 30]
    one = diffused(image, np.array([[True, False, True, True]]))
    assert one[0, 1, 0] == 45  # between 90 and 0


def test_the_region_stays_and_its_surroundings_take_its_colours():
    random = np.random.default_rng(0)
    image = random.integers(0, 255, (40, 50, 3), dtype=np.uint8)
    image[..., 0] //= 4
    inside = np.zeros((40, 50), bool)
    inside[15:25, 20:30] = True
    result = diffused(image, inside)
    assert np.array_equal(result[inside], image[inside])
    low, high = image[inside].min(axis=0), image[inside].max(axis=0)
    assert ((result >= low) & (result <= high)).all()


def test_an_empty_region_changes_nothing():
    image = np.full((5, 5, 3), 7, np.uint8)
    assert np.array_equal(diffused(image, np.zeros((5, 5), bool)), image)


def test_the_texture_shows_the_portrait(avatar, portrait):
    """Colours of the face's vertices are those where they are in the picture that was projected."""
    model, head = avatar.model, avatar.portrait.vertices
    square = avatar.stages["cartoon"]
    place = avatar.uv * (avatar.texture.shape[1], -avatar.texture.shape[0]) + (0, avatar.texture.shape[0])
    column, row = np.clip(place.astype(int), 0, avatar.texture.shape[0] - 1).T
    cheeks = model.landmarks[[31, 35, 30, 27]]
    skin = np.median(square[180:330, 180:330].reshape(-1, 3), axis=0)
    found = avatar.texture[row[cheeks], column[cheeks]].astype(float)
    assert np.abs(found - skin).max() < 90 and head.shape == (len(column), 3)


def test_no_seam_runs_over_the_head(avatar):
    """Neighbouring vertices of the skin have neighbouring places in the texture, and alike colours at the back."""
    model = avatar.model
    skin = model.template.fine_parts == 0
    faces = model.faces[skin[model.faces].all(axis=1)]
    sides = np.linalg.norm(avatar.uv[faces] - avatar.uv[np.roll(faces, 1, axis=1)], axis=2)
    assert sides.max() < 0.15
    place = np.clip((avatar.uv * (1, -1) + (0, 1)) * avatar.texture.shape[0], 0, avatar.texture.shape[0] - 1).astype(
        int
    )
    colour = avatar.texture[place[:, 1], place[:, 0]].astype(float)
    back = faces[(avatar.face.vertices[faces][..., 2] < -20).all(axis=1)]
    assert np.abs(colour[back] - colour[np.roll(back, 1, axis=1)]).max() < 40
