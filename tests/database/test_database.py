"""Building a database of faces, going on with one, and reading it."""

import shutil

import dask.distributed
import joblib
import numpy as np
import pytest
from joblib.externals.loky.process_executor import TerminatedWorkerError
from small_database import KEPT, ThreeExpressions

from sketchwidget.database import build as building
from sketchwidget.database.build import MODEL, build, prepare
from sketchwidget.database.contact import Contact
from sketchwidget.database.database import FaceDatabase
from sketchwidget.database.store import Heads, Plan, Store
from sketchwidget.face.bilinear import fit_identity
from sketchwidget.face.exaggeration import LEVELS
from sketchwidget.sketch import FEATURES, SILHOUETTE, WRINKLE


@pytest.fixture(scope="module")
def source(three_expressions):
    return three_expressions


@pytest.fixture(scope="module")
def database(small_folder):
    return FaceDatabase.open(small_folder)


@pytest.fixture(scope="module")
def larger_than_its_model(folder_beyond_its_model):
    return FaceDatabase.open(folder_beyond_its_model)


def test_every_identity_is_there_at_every_level_in_every_expression(database):
    assert len(database) == 3 * LEVELS * 3
    found = {(face.identity, face.level, face.expression) for face in database}
    assert found == {(i, level, name) for i in range(3) for level in (1, 2, 3, 4) for name in KEPT}
    assert all(database.index(face.identity, face.expression, face.level) == n for n, face in enumerate(database))


def test_the_first_level_is_the_source_s_face_mended(database, source):
    maker = prepare(source, 3)
    posed = maker.scale * (source.heads(2)[1] - maker.origin)
    expected = source.template.subdivision @ Contact(source.template, maker.typical).mended(posed)
    np.testing.assert_allclose(database[database.index(2, "smile", 1)].vertices, expected, atol=1e-3)


def test_the_mean_of_the_identities_is_200_mm_high(database):
    faces = [database[database.index(i, "neutral")].vertices for i in range(3)]
    mean = np.mean(faces, axis=0)
    menton = mean[database.model.landmarks[8], 1]
    assert mean[:, 1].max() - menton == pytest.approx(200, abs=0.1)


def test_weights_give_the_face_back(database):
    for number in (0, 17, 35):
        face = database[number]
        error = np.linalg.norm(database.model.face(*face.weights).vertices - face.vertices, axis=1)
        # 12 people and 3 expressions are within the rank; half precision is not exact.
        assert error.mean() < 0.3  # mm


def test_the_model_s_mean_identity_is_that_of_the_people_as_they_are(database):
    identities = database.model.bilinear.identities
    np.testing.assert_allclose(database.model.mean_identity, identities[::LEVELS].mean(axis=0), atol=1e-6)
    assert np.abs(database.model.mean_identity - identities.mean(axis=0)).max() > 0.01


def test_the_model_is_made_of_the_first_identities(larger_than_its_model):
    assert larger_than_its_model.identities == 3
    assert larger_than_its_model.model.bilinear.identities.shape[0] == 2 * LEVELS
    assert larger_than_its_model.model.identity_size == 2 * LEVELS


@pytest.mark.parametrize("level", [1, 4])
def test_weights_of_an_identity_that_the_model_does_not_know_are_fitted(larger_than_its_model, level):
    model = larger_than_its_model.model

    def error(identity):
        found = [model.vertices(identity, face.weights[1]) - face.vertices for face in faces]
        return np.linalg.norm(found, axis=2).mean()

    faces = [larger_than_its_model[larger_than_its_model.index(2, name, level)] for name in KEPT]
    identity = faces[0].weights[0]
    assert all((face.weights[0] == identity).all() for face in faces)
    assert error(identity) < 4  # mm; two people make a poor model
    assert error(identity) < min(error(other) for other in (model.mean_identity, *model.bilinear.identities))


def test_fitting_somebody_whom_the_model_knows_gives_their_weights(database):
    model = database.model.bilinear
    meshes = database.person(1, 3).reshape(3, -1)
    # The basis is kept in half precision.
    np.testing.assert_allclose(fit_identity(model, meshes, model.expressions), model.identities[6], atol=0.02)


def test_the_identity_split_leaves_out_whom_the_model_does_not_know(larger_than_its_model):
    for seed in range(5):
        _, test = larger_than_its_model.split("identity", seed)
        assert {larger_than_its_model[int(number)].identity for number in test} == {2}


def test_a_face_is_drawn_with_all_its_lines(database):
    sketch = database[database.index(1, "laugh", 4)].sketch
    assert {SILHOUETTE, *FEATURES, WRINKLE} == set(sketch.lines)
    assert all(np.isfinite(segment.points).all() for segment in sketch.segments)


def test_no_lips_cross_and_no_lids_enter_the_eyeballs(database):
    assert database.crossing == {"lips": 0.0, "lids": 0.0}


def test_splits_part_all_faces_and_the_identity_split_whole_people(database):
    for kind in ("random", "identity"):
        train, test = database.split(kind)
        assert sorted([*train, *test]) == list(range(len(database))) and len(test)
        np.testing.assert_array_equal(database.split(kind)[1], test)
    people = {database[int(number)].identity for number in test}
    assert people.isdisjoint({database[int(number)].identity for number in train})
    with pytest.raises(ValueError, match="'random' or 'identity'; given 'odd'"):
        database.split("odd")


def test_interpolated_faces_lie_between_two_of_the_database(database):
    assert len(database.interpolated) == 5
    one, again = database.interpolated[3], database.interpolated[-2]
    np.testing.assert_array_equal(one.vertices, again.vertices)
    rows = database.model.bilinear.identities
    spans = [abs(np.linalg.det([(one.identity - a)[:2], (b - a)[:2]])) for a in rows for b in rows if (a != b).any()]
    assert min(spans) < 1e-5
    with pytest.raises(IndexError, match="no number 5"):
        database.interpolated[5]


def test_a_face_that_is_not_there_is_an_error(database):
    with pytest.raises(IndexError, match="no face 36"):
        database[36]
    with pytest.raises(ValueError, match="an identity from 0 to 2, a level from 1 to 4"):
        database.index(1, "smile", 5)


def test_a_build_that_was_stopped_goes_on_and_gives_the_same_faces(source, database, tmp_path, monkeypatch):
    make = building._make

    def stopped(maker, numbers):
        if 2 in numbers:
            raise KeyboardInterrupt
        return make(maker, numbers)

    monkeypatch.setattr(building, "_TOGETHER", 1)
    monkeypatch.setattr(building, "_make", stopped)
    with pytest.raises(KeyboardInterrupt):
        build(source, tmp_path / "faces", identities=3, interpolated=5)
    with pytest.raises(ValueError, match="is unfinished: the command that began it goes on"):
        FaceDatabase.open(tmp_path / "faces")
    made = []
    monkeypatch.setattr(building, "_make", lambda maker, numbers: made.extend(numbers) or make(maker, numbers))
    build(source, tmp_path / "faces", identities=3, interpolated=5)
    assert made == [2]
    assert FaceDatabase.open(tmp_path / "faces").sum == database.sum


def test_what_goes_wrong_with_an_identity_names_it(source, tmp_path, monkeypatch):
    heads = source.heads

    def spiky(number):
        if number == 1:
            raise ValueError("a spike on the nose")
        return heads(number)

    monkeypatch.setattr(source, "heads", spiky)
    with pytest.raises(ValueError, match=r"^identity 1 of the source anny: a spike on the nose$"):
        build(source, tmp_path / "faces", identities=3, interpolated=0)


def test_a_killed_process_tells_to_take_fewer_and_loses_nothing(source, database, tmp_path, monkeypatch):
    class Killed:
        def __init__(self, **_):
            pass

        def __call__(self, goes):
            function, arguments, _ = next(iter(goes))
            yield function(*arguments)
            raise TerminatedWorkerError("SIGKILL(-9)")

    with monkeypatch.context() as patch:
        patch.setattr(building, "_TOGETHER", 1)
        patch.setattr(building, "Parallel", Killed)
        with pytest.raises(OSError, match=r"was killed.*give fewer --jobs; what is built stays"):
            build(source, tmp_path / "faces", identities=3, interpolated=5)
    assert Store.open(tmp_path / "faces").missing() == [1, 2]
    build(source, tmp_path / "faces", identities=3, interpolated=5)
    assert FaceDatabase.open(tmp_path / "faces").sum == database.sum


def test_a_finished_database_is_not_taken_for_that_of_other_heads(small_folder, database):
    class Others(ThreeExpressions):
        def identity(self, number):
            return super().identity(number + 10)

    before = database.sum
    with pytest.raises(ValueError, match="was begun with other heads than those that the source anny gives now"):
        build(Others(), small_folder, identities=3, interpolated=5)
    assert FaceDatabase.open(small_folder).sum == before


def test_damaged_files_are_named_and_mended(source, database, tmp_path):
    out = tmp_path / "faces"
    build(source, out, identities=3, interpolated=5)
    chunk = next(path for path in sorted((out / "vertices").rglob("*")) if path.is_file() and path.name != "zarr.json")
    chunk.write_bytes(b"no codec knows this")
    with pytest.raises(OSError, match="vertices: identity 0 cannot be read; the command that built"):
        _ = FaceDatabase.open(out)[0].vertices
    build(source, out, identities=3, interpolated=5)
    mended = FaceDatabase.open(out)
    assert mended.sum == database.sum
    np.testing.assert_array_equal(mended[0].vertices, database[0].vertices)


def test_what_is_no_database_is_refused(source, small_folder, tmp_path):
    with pytest.raises(FileNotFoundError, match="holds no face database: `sketchwidget database --out"):
        FaceDatabase.open(tmp_path / "nowhere")
    (tmp_path / "letters").mkdir()
    (tmp_path / "letters" / "dear.txt").write_text("reader")
    with pytest.raises(FileExistsError, match="is there and no face database: name a new folder"):
        build(source, tmp_path / "letters", identities=1, interpolated=0)
    assert (tmp_path / "letters" / "dear.txt").read_text() == "reader"
    with pytest.raises(ValueError, match="holds another database, of identities 3, not 4"):
        build(source, small_folder, identities=4, interpolated=5)
    description = tmp_path / "cut"
    description.mkdir()
    (description / "zarr.json").write_text((small_folder / "zarr.json").read_text()[:100])
    with pytest.raises(ValueError, match=r"zarr\.json is damaged"):
        FaceDatabase.open(description)


def test_a_source_with_too_few_identities_is_an_error(source, tmp_path, monkeypatch):
    monkeypatch.setattr(ThreeExpressions, "count", 2)
    with pytest.raises(ValueError, match="has 2 identities; 3 were asked for"):
        build(source, tmp_path / "faces", identities=3, interpolated=0)
    assert not (tmp_path / "faces").exists()


def test_processes_build_the_same_faces(source, database, tmp_path, monkeypatch):
    monkeypatch.setattr(building, "_TOGETHER", 1)
    build(source, tmp_path / "faces", identities=3, interpolated=5, jobs=2)
    together = FaceDatabase.open(tmp_path / "faces")
    assert together.sum == database.sum
    np.testing.assert_array_equal(together.model.mean, database.model.mean)


def test_a_dask_cluster_builds_the_same_faces(source, database, tmp_path, monkeypatch):
    monkeypatch.setattr(building, "_TOGETHER", 1)
    with (
        dask.distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None
        ) as two,
        dask.distributed.Client(two),
        joblib.parallel_config(backend="dask"),
    ):
        build(source, tmp_path / "faces", identities=3, interpolated=5, jobs=None)
    assert FaceDatabase.open(tmp_path / "faces").sum == database.sum
    assert (tmp_path / "faces" / MODEL).exists()


def chunk_of(folder, name):
    """The first file of an array's chunks."""
    return next(path for path in sorted((folder / name / "c").rglob("*")) if path.is_file())


def test_a_build_killed_while_it_began_goes_on(source, database, tmp_path):
    out = tmp_path / "faces"
    build(source, out, identities=3, interpolated=5)
    for name in ("sums", "crossing"):
        shutil.rmtree(out / name)
    build(source, out, identities=3, interpolated=5)
    assert FaceDatabase.open(out).sum == database.sum


@pytest.mark.parametrize("harm", ["flip", "delete"])
def test_a_face_whose_bytes_changed_is_never_handed_out(small_folder, tmp_path, harm):
    out = tmp_path / "faces"
    shutil.copytree(small_folder, out)
    chunk = chunk_of(out, "vertices")
    content = bytearray(chunk.read_bytes())
    content[len(content) // 2] ^= 4
    chunk.write_bytes(content) if harm == "flip" else chunk.unlink()
    with pytest.raises(OSError, match="identity 0 cannot be read"):
        _ = FaceDatabase.open(out)[0].vertices


def test_a_damaged_model_is_made_again(source, small_folder, database, tmp_path):
    out = tmp_path / "faces"
    shutil.copytree(small_folder, out)
    (out / MODEL).write_bytes((out / MODEL).read_bytes()[:5000])
    with pytest.raises(ValueError, match=MODEL):
        FaceDatabase.open(out)
    build(source, out, identities=3, interpolated=5)
    np.testing.assert_array_equal(FaceDatabase.open(out).model.mean, database.model.mean)


def test_a_build_goes_on_only_with_the_heads_it_was_begun_with(tmp_path):
    store = Store.create(tmp_path / "faces", Plan("folder", 1, ("neutral",), 4))
    store.require_frame(2.0, np.zeros(3))
    store.require_frame(2.0, np.zeros(3))
    with pytest.raises(ValueError, match="begun with other heads"):
        store.require_frame(2.5, np.zeros(3))


def test_a_full_disk_is_told_by_the_folder_s_name(tmp_path, monkeypatch):
    store = Store.create(tmp_path / "faces", Plan("folder", 1, ("neutral",), 4))

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(store, "array", full)
    with pytest.raises(OSError, match="faces cannot be written: No space left on device; what is built stays"):
        store.write(0, Heads(*(np.zeros((LEVELS, 1, 4, 3), dtype=np.float32),) * 3))


def test_one_person_cannot_be_split_by_identity(source, tmp_path):
    build(source, tmp_path / "faces", identities=1, interpolated=0)
    with pytest.raises(ValueError, match="needs two of them"):
        FaceDatabase.open(tmp_path / "faces").split("identity")
