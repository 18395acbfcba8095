"""Training examples without end."""

from dataclasses import replace

import numpy as np
import pytest
from torch.utils.data import DataLoader

from sketchwidget.inference.shape_code import DETAILS
from sketchwidget.sketch import SILHOUETTE
from sketchwidget.sketch.hand import Hand
from sketchwidget.training.examples import Examples, Variety, noisy_view
from sketchwidget.training.manners import Drawn, Manner
from sketchwidget.training.reshaping import Reshaping
from sketchwidget.training.standard import standardised_pose

EXACT = Variety(manners={Manner.EXACT: 1.0}, of_model=0.0, wrinkles=0.0, mixed=0.0, blended=0.0)
FREEHAND = Variety(
    manners={Manner.FREEHAND: 1.0}, wrinkles=0.0, mixed=0.0, blended=0.0, partial=0.0, missing=0.0, view=0.0
)


@pytest.fixture(scope="module")
def poses(database):
    return standardised_pose(database.model, database.model.bilinear.expressions).astype(np.float32)


@pytest.fixture(scope="module")
def make(pipeline, poses):
    """Makes examples of the small database."""

    def make(variety=None, batch=3, seed=5, start=0, stride=1, **others):
        table, kept = others.pop("table", pipeline.table), others.pop("kept", pipeline.kept)
        expressions = others.pop("expressions", pipeline.database.model.expressions)
        variety = variety or Variety()
        of_model = others.pop("of_model", len(pipeline.database.model.bilinear.identities))
        made = Examples(table, kept, of_model, expressions, poses, pipeline.shape_model, variety, batch, seed, **others)
        made.start, made.stride = start, stride
        return made

    return make


def rows_of(codes, table):
    """Number of the face with each code, -1 for one that is none of the table's."""
    known = table.codes.reshape(-1, table.codes.shape[-1])
    off = np.linalg.norm(codes[:, None] - known, axis=2)
    return np.where(off.min(axis=1) < 1e-3, off.argmin(axis=1), -1)


def test_a_batch_has_images_shapes_codes_and_poses(database, pipeline, make):
    images, shapes, codes, poses, people = make().numbered(0)
    assert images.shape == (3, 1, 256, 256) and images.dtype == bool
    assert shapes.shape == (3, pipeline.shape_model.size + DETAILS + 1) and shapes.dtype == np.float32
    assert codes.shape == (3, len(database.model.bilinear.core)) and codes.dtype == np.float32
    assert poses.shape == (3, 3) and poses.dtype == np.float32
    assert people.shape == (3,) and (people >= 0).all()


def test_batches_depend_on_seed_and_number_only(make):
    def differ(one, other):
        return any((ours != theirs).any() for ours, theirs in zip(one, other, strict=True))

    assert not differ(make().numbered(2), make().numbered(2))
    assert differ(make().numbered(2), make().numbered(3))
    assert differ(make(seed=5).numbered(2), make(seed=6).numbered(2))
    from_start = iter(make())
    third = [next(from_start) for _ in range(3)][2]
    assert not differ(third, make().numbered(2))
    assert not differ(third, next(iter(make(start=2))))


@pytest.mark.parametrize(("rank", "size"), [(0, 1), (0, 2), (1, 2), (2, 3)])
def test_processes_share_the_batches(make, rank, size):
    mine = iter(make(start=rank, stride=size))
    for number in (rank, rank + size, rank + 2 * size):
        for ours, theirs in zip(next(mine), make().numbered(number), strict=True):
            np.testing.assert_array_equal(ours, theirs)


def test_workers_of_a_process_share_its_batches(make):
    mine = iter(DataLoader(make(batch=1, start=1, stride=2), batch_size=None, num_workers=2))
    for number in (1, 3, 5, 7):
        for ours, theirs in zip(next(mine), make(batch=1).numbered(number), strict=True):
            np.testing.assert_array_equal(ours.numpy(), theirs)


def test_exact_examples_are_faces_of_the_table(pipeline, make, poses):
    _, shapes, codes, found, people = make(EXACT, batch=20).numbered(0)
    rows = rows_of(codes, pipeline.table)
    assert set(rows) <= set(pipeline.kept) and len(set(rows)) > 5
    np.testing.assert_array_equal(found, poses[rows % 3])
    np.testing.assert_array_equal(people, rows // 3)
    assert np.isfinite(shapes).all()


def test_faces_that_are_left_out_are_not_drawn(pipeline, make):
    only = np.array([4])
    codes = make(FREEHAND, batch=10, kept=only).numbered(0).codes
    assert set(rows_of(codes, pipeline.table)) == {4}


def without_codes(table, kept):
    """The table without the codes of the faces that are not kept."""
    codes = table.codes.copy()
    codes.reshape(-1, codes.shape[-1])[np.setdiff1d(np.arange(codes.shape[0] * codes.shape[1]), kept)] = np.nan
    return replace(table, codes=codes)


@pytest.mark.parametrize("left_out", ["people", "faces"])
def test_who_or_what_is_left_out_has_no_part_in_any_example(pipeline, make, left_out):
    kept = np.arange(24) if left_out == "people" else pipeline.kept
    examples = make(table=without_codes(pipeline.table, kept), kept=kept, batch=40)
    assert all(np.isfinite(examples.numbered(number)[2]).all() for number in range(3))


def test_faces_of_the_model_s_people_are_as_they_are_or_between_two(pipeline, make, poses):
    variety, of_model = replace(EXACT, of_model=1.0, mixed=1.0, blended=1.0), 4
    _, _, codes, found, people = make(variety, batch=120, of_model=of_model).numbered(0)
    table = pipeline.table.codes[:of_model]
    as_they_are = rows_of(codes, pipeline.table) >= 0
    assert 0.5 < as_they_are.mean() < 0.9 and set(people) == set(range(of_model))
    for code, pose, person in zip(codes[~as_they_are], found[~as_they_are], people[~as_they_are], strict=True):
        off = []
        for other, first, second in np.ndindex(of_model, 3, 3):
            for share in np.linspace(0, 0.5, 101):
                near = (1 - share) * poses[first] + share * poses[second]
                if np.abs(near - pose).max() < 0.02:
                    one, two = ((1 - share) * table[who, first] + share * table[who, second] for who in (person, other))
                    off.append(np.linalg.norm((1 - share) * one + share * two - code))
        assert min(off) < 0.02 * np.linalg.norm(code - table.mean(axis=(0, 1)))


@pytest.mark.parametrize("found", [0.0, 1.0])
def test_the_last_number_tells_whether_points_were_found(make, found):
    np.testing.assert_array_equal(make(replace(EXACT, found=found)).numbered(0).shapes[:, -1], found)


def test_a_face_without_a_mouth_is_a_quiet_one(pipeline, make, poses):
    quiet = poses[pipeline.database.model.expressions.index("neutral")]
    for mixed in (0.0, 1.0):
        mouthless = replace(FREEHAND, missing=1.0, mixed=mixed)
        np.testing.assert_array_equal(make(mouthless, batch=20).numbered(0)[3], np.tile(quiet, (20, 1)))
    found = make(FREEHAND, batch=20).numbered(0).poses
    assert (found != quiet).any(axis=1).sum() > 5


def test_mixed_faces_lie_between_others(pipeline, make, poses):
    _, _, codes, found, _ = make(replace(EXACT, mixed=1.0), batch=60).numbered(0)
    assert (rows_of(codes, pipeline.table) == -1).mean() > 0.5
    # Weights of three expressions are the corners of a triangle.
    corners = np.vstack([poses.T, np.ones(3)])
    shares = np.linalg.lstsq(corners, np.vstack([found.T, np.ones(60)]), rcond=None)[0].T
    np.testing.assert_allclose(shares @ poses, found, atol=1e-3)
    assert shares.min() > -1e-3 and ((shares > 0.01).sum(axis=1) == 2).any()
    assert shares.max(axis=1).min() > 0.49


def test_blended_faces_are_nobodys_and_vary_as_people_do(pipeline, make, poses):
    table = pipeline.table
    kept = np.arange(table.codes.shape[0] * 3)
    codes, found = make(replace(EXACT, blended=1.0), batch=400, kept=kept).numbered(0)[2:4]
    assert (rows_of(codes, table) == -1).mean() > 0.8
    expression = np.linalg.norm(found[:, None] - poses, axis=2).argmin(axis=1)
    np.testing.assert_allclose(found, poses[expression], atol=1e-5)
    middles = table.codes.mean(axis=0)
    spread = np.square(codes - middles[expression]).sum(axis=1).mean()
    assert spread == pytest.approx(np.square(table.codes - middles).sum(axis=2).mean(), rel=0.15)


def test_the_lines_of_a_blended_face_are_those_of_its_code(database, pipeline, make):
    model, table = database.model, pipeline.table
    of_the_model = np.arange(24)
    examples = make(replace(EXACT, blended=1.0), kept=of_the_model)
    pick = model.template.subdivision[np.concatenate([model.curves[name] for name in table.lengths])]
    for number in range(8):
        _, face = examples._face(np.random.default_rng(number), quiet=False, freehand=False)
        mesh = (model.bilinear.mean + model.bilinear.basis @ face.code).reshape(-1, 3)
        np.testing.assert_allclose(pick @ mesh, face.points, atol=0.35)


def test_puffed_cheeks_are_rare(make, poses):
    expressions = ["neutral", "blowfish", "laugh"]
    found = make(EXACT, batch=150, kept=np.arange(24), expressions=expressions).numbered(0).poses
    share = [(found == pose).all(axis=1).mean() for pose in poses]
    assert sum(share) == 1 and 0.01 < share[1] < 0.22 and min(share[0], share[2]) > 0.3


@pytest.mark.parametrize(("variety", "often"), [(FREEHAND, [1.0, 0.8, 0.6, 0.4]), (EXACT, [1.0, 1.0, 1.0, 1.0])])
def test_by_hand_exaggerated_people_are_drawn_more_rarely(make, variety, often):
    neutral = np.arange(0, 3 * 4 * 3, 3)  # all levels of three people at rest
    levels = np.bincount(make(variety, batch=300, kept=neutral).numbered(0).people % 4, minlength=4)
    np.testing.assert_allclose(levels / 300, np.divide(often, sum(often)), atol=0.08)


def test_wrinkles_are_drawn_as_often_as_wanted(make):
    bare, folded = (make(replace(EXACT, wrinkles=share), batch=8).numbered(1)[0] for share in (0.0, 1.0))
    more = folded.sum(axis=(1, 2, 3)) - bare.sum(axis=(1, 2, 3))
    assert (more > 50).all()


def test_half_of_the_freehand_faces_are_reshaped(database, pipeline, make):
    reshaping = Reshaping(database.model)
    codes = make(FREEHAND, batch=60, reshaping=reshaping).numbered(0).codes
    assert 0.3 < (rows_of(codes, pipeline.table) == -1).mean() < 0.7
    codes = make(EXACT, batch=20, reshaping=reshaping).numbered(0).codes
    assert (rows_of(codes, pipeline.table) >= 0).all()


def test_a_reshaped_face_is_drawn_as_it_is_reshaped(pipeline, make):
    """Broad and long heads are told by the outline of the drawing and by the code alike."""
    steady = Hand(tremor=0.0, misplacement=0.0, shorthand=0.0, extras=0.0)

    def wider(points, code, amounts):
        return points * np.float32([1.5, 1, 1]), code + 1

    examples = make(replace(FREEHAND, hand=steady), kept=np.array([1]), reshaping=wider)
    table = pipeline.table
    plain = table.lines(table.points[0, 1].astype(np.float32))[SILHOUETTE]
    ratios = {}
    for number in range(20):
        drawn, code, *_ = examples.example(np.random.default_rng(number))
        rows, columns = (np.flatnonzero(drawn.image.any(axis=axis)) for axis in (1, 0))
        is_wider = bool(np.allclose(code, table.codes[0, 1] + 1))
        assert is_wider or np.allclose(code, table.codes[0, 1])
        ratios.setdefault(is_wider, []).append(np.ptp(columns) / np.ptp(rows))
    expected = np.ptp(plain[:, 0]) / np.ptp(plain[:, 1])
    assert np.median(ratios[True]) == pytest.approx(1.5 * np.median(ratios[False]), rel=0.08)
    assert np.median(ratios[False]) > 0.8 * expected


class Person:
    """Stands for drawings by people."""

    def example(self, random):
        nothing = np.zeros(192, dtype=bool)
        drawn = Drawn(np.ones((256, 256), dtype=bool), np.zeros((192, 2)), nothing)
        return drawn, np.full(24, 7.0, dtype=np.float32), np.full(3, 9.0, dtype=np.float32)


def test_drawings_by_people_have_their_share(make, pipeline):
    for share, least, most in ((0.0, 0, 0), (0.3, 8, 30), (1.0, 60, 60)):
        batch = make(replace(Variety(), people=share), batch=60, people=Person()).numbered(0)
        images, shapes, codes, poses, people = batch
        theirs = images.all(axis=(1, 2, 3))
        assert least <= theirs.sum() <= most
        assert (codes[theirs] == 7).all() and (poses[theirs] == 9).all()
        assert not shapes[theirs, : pipeline.shape_model.size].any()
        np.testing.assert_array_equal(people == -1, theirs)


def test_the_noise_of_the_view_is_as_large_as_wanted():
    random = np.random.default_rng(0)
    turned = np.stack([noisy_view(2.5, random).rotation for _ in range(500)])
    np.testing.assert_allclose(turned @ turned.transpose(0, 2, 1), np.tile(np.eye(3), (500, 1, 1)), atol=1e-5)
    angles = np.degrees(turned[:, [2, 0, 1], [1, 2, 0]])
    np.testing.assert_allclose(angles.std(axis=0), 2.5, rtol=0.1)
    np.testing.assert_array_equal(noisy_view(0.0, random).rotation, np.eye(3))
