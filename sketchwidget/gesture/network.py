"""The network that tells the gestures apart (DeepSketch2Face, section 5.2)."""

from __future__ import annotations

from torch import Tensor, nn

from .names import GESTURES

_STRIDE = (
    4  # of the first convolution, which the paper leaves open: as that of Krizhevsky et al. 2012 with such a window
)


class GestureCNN(nn.Module):
    """Three convolutions, each with pooling, and two fully connected layers; one output a gesture.

    The paper's text has nine outputs for its ten types; there are ten here.
    """

    def __init__(self) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            nn.Conv2d(1, 32, 11, stride=_STRIDE),
            nn.ReLU(inplace=True),
            nn.MaxPool2d(3, stride=2),
            nn.Conv2d(32, 64, 5),
            nn.ReLU(inplace=True),
            nn.MaxPool2d(3, stride=2),
            nn.Conv2d(64, 16, 3),
            nn.ReLU(inplace=True),
            nn.MaxPool2d(3, stride=2),
            nn.Flatten(),
            nn.Linear(16 * 4 * 4, 256),
            nn.ReLU(inplace=True),
            nn.Linear(256, len(GESTURES)),
        )

    def forward(self, images: Tensor) -> Tensor:
        """Logits (b, 10) of images (b, 1, 256, 256) with ink as 1; their softmax is the probability of each gesture."""
        return self.layers(images)
