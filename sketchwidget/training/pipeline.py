"""From a database of faces to a network, and the faces of it that a network has not seen.

What is costly is kept in a work folder, and goes on from there when it is started again; what belongs to one face model
has its fingerprint in the name.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from ..database.database import FaceDatabase
from ..database.provenance import provenance
from ..face.exaggeration import LEVELS
from ..inference.network import COMPACT, Layout
from ..inference.regressor import save_network
from ..inference.shape_code import ShapeModel
from .drawings import DrawnExamples
from .examples import Examples, Variety
from .face_table import FaceTable, tabulate, vertex_metric
from .network import Schedule, train
from .reshaping import Reshaping
from .shape_model import build_shape_model
from .standard import standardisation, standardised_pose
from .team import Team

SEED = 7


@dataclass(frozen=True)
class Pipeline:
    """The training of networks on one database, in one work folder.

    Parameters
    ----------
    database : FaceDatabase
    work : Path
    """

    database: FaceDatabase
    work: Path

    @cached_property
    def table(self) -> FaceTable:
        """What networks train on, of all people."""
        name = f"table-{self.database.sum[:8]}-{self.database.model.fingerprint[:8]}.npz"
        return tabulate(self.database, self.work / name)

    @cached_property
    def kept(self) -> np.ndarray:
        """Numbers of the faces to train on: neither of the random split nor of the split by identity."""
        return np.intersect1d(self.database.split("random", SEED)[0], self.database.split("identity", SEED)[0])

    def unseen(self, split: str, count: int) -> np.ndarray:
        """Numbers (m,) of faces that networks did not train on: of people that they know ("random") or do not."""
        left_out = self.database.split(split, SEED)[1]
        if split == "random":
            left_out = np.setdiff1d(left_out, self.database.split("identity", SEED)[1])
        return np.sort(np.random.default_rng(SEED).permutation(left_out)[:count])

    @cached_property
    def shape_model(self) -> ShapeModel:
        """The 2D bilinear model of the lines of the people to train on."""
        people = np.unique(self.kept // len(self.database.expressions))
        model = self.database.model
        return build_shape_model(self.table, people, (model.identity_size, model.expression_size))

    def examples(self, variety: Variety, batch: int, people: DrawnExamples | None = None) -> Examples:
        """Training examples without end."""
        model = self.database.model
        return Examples(
            self.table,
            self.kept,
            model.expressions,
            standardised_pose(model, model.bilinear.expressions),
            self.shape_model,
            variety,
            batch,
            SEED,
            reshaping=Reshaping(model),
            people=people,
        )

    def train_network(
        self,
        out: Path,
        command: str,
        schedule: Schedule,
        layout: Layout = COMPACT,
        variety: Variety | None = None,
        people: DrawnExamples | None = None,
        workers: int = 1,
    ) -> None:
        """Train a network, or go on with it, and write it to `out`; one of a team of processes does its part."""
        team, model = Team.join(), self.database.model
        folder = self.work / f"{out.stem}-{model.fingerprint[:8]}"
        with team.leader_first():
            examples = self.examples(variety or Variety(), schedule.batch, people)
        network = train(model, vertex_metric(model), examples, schedule, folder, layout, workers)
        if team.leads:
            made = provenance(command, ("torch", "numpy", "opencv-python-headless")) | self.database.origin
            save_network(out, network, standardisation(model), self.shape_model, model, made)


def person_of(number: int, database: FaceDatabase) -> tuple[int, int]:
    """Row and expression of a face in the table of its database."""
    face = database[number]
    return face.identity * LEVELS + face.level - 1, database.expressions.index(face.expression)
