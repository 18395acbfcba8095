"""A set of rendered portraits, made once and looked at many times with other light, frame, hair and background."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

import cv2
import numpy as np
from tqdm import tqdm

from ..avatar.coarse import CoarseFit, CoarseFitter
from ..avatar.network import SIDE
from ..avatar.square import square_about
from ..avatar.stylize import drawn
from ..avatar.template import AvatarTemplate
from ..face.model import FaceModel
from ..portrait.landmarks import FaceLandmarks
from .portraits import background, render_portrait

_CARTOONS = 0.5  # share of the portraits that are drawn as cartoons
_TURN, _SIZE, _SHIFT = 6.0, 0.03, 0.012  # standard deviations of degrees, logarithm of the size, shares of the side
_HAIR, _OTHER_BACKGROUND = 0.6, 0.5  # how often
_GAIN, _TINT, _GAMMA = 0.12, 0.05, 0.15  # standard deviations of the logarithms of light, its colour, and contrast


@dataclass(frozen=True, eq=False)
class PortraitSet:
    """Portraits of known heads.

    Parameters
    ----------
    images : (N, 224, 224, 3) uint8 array
    masks : (N, 224, 28) uint8 array
        Where the head is, eight pixels to the number.
    landmarks : (N, 68, 2) float32 array
        Pixels.
    seen : (N, n) bool array
        Which vertices of the skin are visible.
    identity, expression : (N, k) float32 arrays
        In standard deviations, as `CoarseFitter.unknowns` has them.
    """

    images: np.ndarray
    masks: np.ndarray
    landmarks: np.ndarray
    seen: np.ndarray
    identity: np.ndarray
    expression: np.ndarray

    def __len__(self) -> int:
        return len(self.images)

    def varied(self, number: int, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A portrait as it never was: picture (224, 224, 3) uint8, where the skin is (224, 224), landmarks (68, 2).

        In the frame that `build` gives the network, more or less, and turned in its plane; with another exposure; now
        and then before another background and with hair about the face, which no head of the model has.
        """
        image = self.images[number]
        head = np.unpackbits(self.masks[number], axis=1).astype(np.float32)
        points = self.landmarks[number].astype(np.float64)
        turn = cv2.getRotationMatrix2D((SIDE / 2, SIDE / 2), random.normal(0, _TURN), 1.0)
        corner, side = square_about(points @ turn[:, :2].T + turn[:, 2])
        matrix = turn * SIDE / side * np.exp(random.normal(0, _SIZE))
        matrix[:, 2] += random.normal(0, _SHIFT * SIDE, 2) - corner * SIDE / side
        frame = {"M": matrix, "dsize": (SIDE, SIDE)}
        image = cv2.warpAffine(image, **frame, flags=cv2.INTER_AREA, borderMode=cv2.BORDER_REFLECT)
        head = cv2.warpAffine(head, **frame)
        points = (points - 0.5) @ matrix[:, :2].T + matrix[:, 2] + 0.5  # middles of pixels
        picture = image.astype(np.float32) / 255
        if random.random() < _OTHER_BACKGROUND:
            picture = head[..., None] * picture + (1 - head[..., None]) * background(random, SIDE)
        if random.random() < _HAIR:
            hair = _hair(points, random)
            picture += hair[..., None] * (random.uniform(0, 0.8) * random.uniform(0.6, 1.0, 3) - picture)
            head = head * (1 - hair)
        exposure = np.exp(random.normal(0, _GAIN) + random.normal(0, _TINT, 3))
        picture = np.clip(picture * exposure, 0, 1) ** np.exp(random.normal(0, _GAMMA))
        return np.rint(picture * 255).astype(np.uint8), head, points

    def save(self, folder: Path) -> None:
        """Write the set to a new folder, all of it or nothing."""
        unfinished = folder.with_name(f"{folder.name}.part")
        unfinished.mkdir(parents=True, exist_ok=True)
        for name, values in vars(self).items():
            np.save(unfinished / f"{name}.npy", values)
        unfinished.rename(folder)

    @classmethod
    def load(cls, folder: Path) -> PortraitSet:
        """Read a set; pictures stay on the disk until they are looked at. An OSError or ValueError if it is none."""
        return cls(
            **{one.name: np.load(folder / f"{one.name}.npy", "r", allow_pickle=False) for one in fields(PortraitSet)}
        )

    @classmethod
    def rendered(cls, model: FaceModel, template: AvatarTemplate, fitter: CoarseFitter, count: int) -> PortraitSet:
        """Portraits 0 to `count`, some of them as cartoons with large eyes."""
        rows: dict[str, list[np.ndarray]] = {}
        for number in tqdm(range(count), unit="portrait"):
            known = render_portrait(model, template, number, SIDE, oversampling=1)
            image, landmarks = known.image, known.landmarks
            if np.random.default_rng([number, SIDE]).random() < _CARTOONS:
                cartoon = drawn(image, FaceLandmarks(landmarks))
                image, landmarks = cartoon.image, cartoon.marks.points
            truth = CoarseFit(
                known.identity,
                known.expression,
                known.texture,
                known.light,
                known.camera,
                fitter.coarse(known.identity, known.expression),
            )
            unknowns = fitter.unknowns(truth)
            row = {
                "images": image,
                "masks": np.packbits(known.mask, axis=1),
                "landmarks": landmarks.astype(np.float32),
                "seen": fitter.visible(unknowns).numpy(),
                "identity": unknowns["identity"].detach().numpy(),
                "expression": unknowns["expression"].detach().numpy(),
            }
            for name, value in row.items():
                rows.setdefault(name, []).append(value)
        return cls(**{name: np.stack(values) for name, values in rows.items()})


def _hair(points: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A cap of hair about landmarks (68, 2): how much of each pixel it covers, (224, 224)."""
    eyes, chin = points[36:48].mean(axis=0), points[8]
    high = float(np.linalg.norm(chin - eyes))
    up = (eyes - chin) / high
    across = np.array([-up[1], up[0]])
    row, column = np.mgrid[:SIDE, :SIDE] + 0.5
    offset = np.stack([column, row], axis=-1) - eyes
    x, y = offset @ across / high, offset @ up / high
    breadth = float(np.ptp((points[:17] - eyes) @ across)) / high / 2
    length = random.uniform(-1.4, 0.3)  # how far down it hangs
    hairline = random.uniform(0.35, 0.7) + 0.15 * np.sin(random.uniform(1, 6) * x + random.uniform(0, 6))
    face = np.hypot(x / (breadth * random.uniform(0.9, 1.05)), (y + 0.2) / (hairline + 0.2)) < 1
    face |= (y < 0) & (np.abs(x) < breadth * random.uniform(0.9, 1.05))
    cap = np.hypot(x / (breadth * random.uniform(1.15, 1.5)), (y - 0.1) / random.uniform(0.9, 1.2)) < 1
    cap |= (y < 0.1) & (np.abs(x) < breadth * random.uniform(1.1, 1.5))
    hair = (cap & ~face & (y > length)).astype(np.float32)
    return cv2.GaussianBlur(hair, (0, 0), random.uniform(0.5, 2.0))
