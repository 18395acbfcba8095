"""A portrait as an animatable cartoon head (*Generating Animatable 3D Cartoon Faces from Single Portraits*).

Examples
--------
>>> portrait = sw.FaceModel.load().face(expression="smile").picture(sw.View(scale=1 / 300), 512)
>>> landmarks = sw.View(scale=1 / 300).project(sw.FaceModel.load().face(expression="smile").landmarks) * 512
>>> avatar = sw.avatar.build(portrait, landmarks, stylize=False)  # landmarks are found where the models are fetched
>>> len(avatar.rig), avatar.pose({"jawOpen": 1.0}).shape[1]
(52, 3)
>>> avatar.export("avatar.glb")
"""

from .avatar import Avatar
from .build import build
from .performance import Performance, performances

__all__ = ["Avatar", "Performance", "build", "performances"]
