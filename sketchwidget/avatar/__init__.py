"""A portrait as an animatable cartoon head (*Generating Animatable 3D Cartoon Faces from Single Portraits*)."""

from .avatar import Avatar
from .build import build
from .performance import Performance, performances

__all__ = ["Avatar", "Performance", "build", "performances"]
