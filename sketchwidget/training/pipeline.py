"""From a database of faces to a network, and the faces of it that a network has not seen.

What is costly is kept in a work folder, and goes on from there when it is started again; what belongs to one face model
has its fingerprint in the name.
"""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass, fields, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import torch

from ..database.database import FaceDatabase
from ..database.provenance import provenance
from ..database.store import WRINKLE_POINTS, WRINKLES
from ..face import Face
from ..files.kept import keep, kept
from ..inference.network import COMPACT, Layout, PixelShapeCNN
from ..inference.network_file import read_weights, save_network
from ..inference.shape_code import ShapeModel
from ..sketch import WRINKLE, resample_each
from .drawings import DrawnExamples
from .examples import Examples, Variety
from .face_table import FaceTable, tabulate, vertex_metric
from .further_people import Further
from .looked_at import Again, LookedAt
from .manners import Manner
from .network import Schedule, train
from .reshaping import Reshaping
from .shape_model import build_shape_model
from .standard import standardisation, standardised_pose
from .tasks import Classes, Faces, Joining, Task, Weights, standardised_identities
from .team import Team

SEED = 7
_AGAIN, _LINES_ALONE = 5, 6  # times that drawings looked at are seen, and how many lines alone there are for each
_SEEN, _ALONE = 48, 208  # drawings looked at and lines alone, in a batch
_FAMILIAR = 1200  # further people whom all layers see, if the last ones are to look at drawings of strangers
_FIRST_STEPS = (5, 8)  # of 18: 500,000 and 800,000 of the paper's 1,800,000 iterations
# Drawings that a training is followed by: the paper's augmentation, of faces as they are.
_TEST = Variety(manners={Manner.AUGMENTED: 1.0}, of_model=0.0, mixed=0.0, blended=0.0)


@dataclass(frozen=True)
class Pipeline:
    """The training of networks on one database, in one work folder.

    Parameters
    ----------
    database : FaceDatabase
    work : Path
    further : Further, optional
        People to train on too whom the database does not hold.
    """

    database: FaceDatabase
    work: Path
    further: Further | None = None

    @cached_property
    def table(self) -> FaceTable:
        """What networks train on, of all people; further ones come last."""
        table = tabulate(self.database, self._file("table"))
        if self.further is None:
            return table
        return self.further.behind(table, self.database, self._file("further").with_suffix(""))

    @cached_property
    def kept(self) -> np.ndarray:
        """Numbers of the database's faces to train on: neither of the random split nor of the split by identity."""
        return np.intersect1d(self.database.split("random", SEED)[0], self.database.split("identity", SEED)[0])

    def unseen(self, split: str, count: int) -> np.ndarray:
        """Numbers (m,) of faces of the database that networks did not train on: of people that they know or do not.

        "identity": of those that they do not know. "random": of those that the model is made of.
        """
        return _some(self._left_out(split), count)

    def faces(self, split: str, count: int) -> list[tuple[Face, np.ndarray]]:
        """Faces to test on, and the wrinkle lines (w, m, 2) of each, NaN where there are no more.

        Those of "random" are of a tenth of what the paper trains and tests on (4.4): of the `unseen`, and of those
        interpolated between the people of the model, if networks know all of these.
        """
        database = self.database
        left_out, between = self._left_out(split), database.interpolated
        if split == "random" and self._left_out("identity").min() >= self._of_model:
            tenth = np.random.default_rng(SEED).permutation(len(between))[: len(between) // 10]
            left_out = np.concatenate([left_out, len(database) + tenth])
        chosen = []
        for number in map(int, _some(left_out, count)):
            if number < len(database):
                of = database[number]
                chosen.append((Face(database.model, of.vertices), database.wrinkles(of)))
            else:
                face = between[number - len(database)]
                lines = face.sketch().lines.get(WRINKLE, [])[:WRINKLES]
                chosen.append((face, resample_each(lines, WRINKLE_POINTS)))
        return chosen

    def _left_out(self, split: str) -> np.ndarray:
        """Numbers of all faces of the database that are left out by a split."""
        database = self.database
        left_out = database.split(split, SEED)[1]
        if split == "random":
            left_out = np.setdiff1d(left_out, database.split("identity", SEED)[1])
            left_out = left_out[left_out < self._of_model]
        return left_out

    @property
    def _of_model(self) -> int:
        """How many faces of the database the model is made of; they are the first."""
        return len(self.database.model.bilinear.identities) * len(self.database.expressions)

    @cached_property
    def shape_model(self) -> ShapeModel:
        """The 2D bilinear model of the lines of the database's people to train on."""
        path = self._file("shape")
        if not path.exists():
            people = np.unique(self.kept // len(self.database.expressions))
            model = self.database.model
            made = build_shape_model(self.table, people, (model.identity_size, model.expression_size))
            keep(path, asdict(made))
        return ShapeModel(**kept(path, (field.name for field in fields(ShapeModel))))

    def _file(self, what: str) -> Path:
        return self.work / f"{what}-{self.database.sum[:8]}-{self.database.model.fingerprint[:8]}.npz"

    def examples(
        self,
        variety: Variety,
        batch: int,
        people: DrawnExamples | None = None,
        of: np.ndarray | None = None,
        reshaped: bool = True,
        pixels: bool = True,
    ) -> Examples:
        """Examples without end, of all faces to train on, or of others of the table, given by their numbers."""
        model = self.database.model
        of = self._everybody if of is None else of
        return Examples(
            self.table,
            of,
            len(model.bilinear.identities),
            model.expressions,
            self._poses,
            self.shape_model,
            variety,
            batch,
            SEED,
            reshaping=Reshaping(model) if reshaped else None,
            people=people,
            pixels=pixels,
        )

    @property
    def _beyond(self) -> np.ndarray:
        """Numbers of the further people's faces: they follow those of the database in the table."""
        rows, expressions = self.table.codes.shape[:2]
        return np.arange(len(self.database), rows * expressions)

    @property
    def _strangers(self) -> np.ndarray:
        """Numbers of the faces of those beyond the first `_FAMILIAR` ones."""
        return self._beyond[_FAMILIAR * len(self.database) // self.database.identities :]

    @property
    def _everybody(self) -> np.ndarray:
        """Numbers of all faces to train on."""
        return np.concatenate([self.kept, self._beyond])

    @property
    def _poses(self) -> np.ndarray:
        model = self.database.model
        return standardised_pose(model, model.bilinear.expressions)

    def train_network(
        self,
        out: Path,
        command: str,
        schedule: Schedule,
        layout: Layout = COMPACT,
        variety: Variety | None = None,
        people: DrawnExamples | None = None,
        workers: int = 1,
        in_three_steps: bool = False,
        start: Path | None = None,
        looked_at: int = 0,
    ) -> None:
        """Train a network, or go on with it, and write it to `out`; one of a team of processes does its part.

        With `start` it begins with the weights of another network, of the same layout, rather than with random ones.

        In three steps it is trained as in the paper's 4.4: of the schedule's steps, so many parts of 18 go to the
        classes and to the weights as of the paper's 1.8 million iterations. Otherwise all go to the vertex loss.

        At last, of `looked_at` batches of drawings the layers in which lines join pixels learn again: what is
        before them stays, and they see each of these drawings `_AGAIN` times, and with `_SEEN` of them at a time
        `_ALONE` of the lines alone of `_LINES_ALONE` times as many others. Features tell more of people whom they were
        learnt from than of others: the drawings are therefore of strangers, the further people beyond the first
        `_FAMILIAR` ones, whom nothing before sees, and of the people of the model, who are to be recognised. Without
        so many people they are of all. Whether a network that this one starts from had so many familiar people too,
        the commands in their headers say.

        Raises
        ------
        ValueError
            If nothing joins lines and pixels in a network that is to end so, or `start` is no network of its layout.
        """
        team, model, variety = Team.join(), self.database.model, variety or Variety()
        torch.manual_seed(SEED)
        network = PixelShapeCNN(model.identity_size, model.expression_size, layout)
        if looked_at and network.shape_layers is None:
            raise ValueError("this network does not see lines beside pixels: it has no layers that learn again")
        if not schedule.steps and (start is None or not looked_at):
            raise ValueError("without steps a training only lets a network that it starts from look at drawings again")
        origin = {} if start is None else _begin_with(start, network)
        folder = self.work / f"{out.stem}-{model.fingerprint[:8]}"
        with team.leader_first():
            strangers = self._strangers if looked_at else self._beyond[:0]
            before = np.setdiff1d(self._everybody, strangers)
            examples = self.examples(variety, schedule.batch, people, of=before)
            unseen = self.examples(_TEST, 8 * schedule.batch, of=self.database.split("identity", SEED)[1])
        beyond, by_people = (0 if some is None else len(some) for some in (self.further, people))
        about = f"{self.database.sum} {beyond} further people {variety} {by_people} drawings {origin} "
        about += f"{len(before)} faces before lines are joined "
        if in_three_steps:
            classes, weights = (schedule.steps * part // 18 for part in _FIRST_STEPS)
            plain = replace(variety, of_model=0.0, mixed=0.0, blended=0.0)
            stored = self.examples(plain, schedule.batch, of=before, reshaped=False)
            task: Task = Classes(network, self._poses, len(self.table.codes))
            network = train(task, stored, replace(schedule, steps=classes), folder / "classes", workers, about)
            task = Weights(network, standardised_identities(self.table, model))
            network = train(task, stored, replace(schedule, steps=weights), folder / "weights", workers, about, unseen)
            network.requires_grad_(True)
            schedule = replace(schedule, steps=schedule.steps - classes - weights)
        task = Faces(network, model, vertex_metric(model))
        if schedule.steps:
            network = train(task, examples, schedule, folder, workers, about, unseen)
        if looked_at:
            # Each of a team looks at drawings of its own.
            about += f"{network.layout.to_json()} {schedule}, then {looked_at} batches of {team.size} {_AGAIN} times "
            about += f"and {_LINES_ALONE} times as many lines alone, {_SEEN} and {_ALONE} at a time "
            share = max(1, looked_at // team.size)
            digest = hashlib.sha256(about.encode()).hexdigest()[:8]
            if len(strangers):
                of_model = self.kept[self.kept < self._of_model]
                examples = self.examples(variety, schedule.batch, people, of=np.concatenate([of_model, strangers]))
            examples.start, examples.stride = schedule.steps * team.size + team.rank, team.size
            alone = self.examples(variety, schedule.batch, pixels=False)
            alone.start, alone.stride = examples.start + share * team.size, team.size
            drawings, lines = (folder / f"{name}-{digest}-{team.rank}.npz" for name in ("looked-at", "lines"))
            folder.mkdir(parents=True, exist_ok=True)
            if not drawings.exists():
                LookedAt.by(network, examples, share, 2 * workers).save(drawings)
            if not lines.exists():
                LookedAt.by(None, alone, _LINES_ALONE * share, 2 * workers).save(lines)
            again = Schedule(max(1, share * schedule.batch * _AGAIN // _SEEN), _SEEN + _ALONE, rate=1e-3)
            joining = Joining(network, model, vertex_metric(model))
            seen = Again(LookedAt.load(drawings), LookedAt.load(lines), _SEEN, _ALONE, SEED)
            network = train(joining, seen, again, folder / f"joining-{digest}", 0, about)
        if team.leads:
            made = provenance(command, ("torch", "numpy", "opencv-python-headless")) | self.database.origin | origin
            save_network(out, network, standardisation(model), self.shape_model, model, made)


def _some(numbers: np.ndarray, count: int) -> np.ndarray:
    """So many of some numbers at random, the same each time, in their order."""
    return np.sort(np.random.default_rng(SEED).permutation(numbers)[:count])


def _begin_with(start: Path, network: PixelShapeCNN) -> dict[str, str]:
    """Give a network the weights of another one in a file; what is to be said of it in the header.

    Where lines are described or join pixels in another way, the layers that join them begin with random weights.

    Raises
    ------
    ValueError
        As `read_weights` does, or if the layout is another one otherwise.
    """
    given, mine = read_weights(start), network.state_dict()
    fitting = {name for name in given.keys() & mine.keys() if given[name].shape == mine[name].shape}
    others = (given.keys() | mine.keys()) - fitting
    if not all(name.startswith("shape_") for name in others):
        raise ValueError(
            f"{start} has another layout than the network to train: name the same --variant, of this version"
        )
    taken = {name: given[name] for name in fitting if not (others and name.startswith("shape_"))}
    network.load_state_dict(taken, strict=False)
    return {"started from": hashlib.sha256(start.read_bytes()).hexdigest()}
