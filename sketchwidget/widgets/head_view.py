"""The head: a clay bust, lit so that its form reads from every side, seen in the frame of the pad."""

from __future__ import annotations

import numpy as np
import pythreejs as three

from ..face import Face
from ..face.texture import Texture
from ..geometry import View
from .mesh_stream import MeshStream

CAMERA_DISTANCE = 1000  # mm; an orthographic picture does not depend on it, the lights' directions below do

ZOOM = (0.5, 12.0)
TURNING = ("enableRotate", "enablePan", "enableKeys")  # pythreejs sets `enabled` itself

# Lights, still as seen from the camera: colour, intensity, direction to the light (x right, y up, z to the viewer).
LIGHTS = (
    ("#fff3e4", 0.74, (-0.50, 0.60, 0.72)),  # key, warm, from above left: noses and brows cast their form
    ("#e3ebff", 0.26, (0.85, 0.00, 0.55)),  # fill, cool, so that the far cheek keeps its shape
    ("#ffffff", 0.42, (0.55, 0.50, -0.75)),  # rim, from behind, drawing the outline of the dark side
)
SKY, GROUND, AMBIENT = "#f7f8fc", "#9c8d86", 0.44  # light from all around, paler above

TEXTURED_AMBIENT, TEXTURED = 0.85, 0.35  # a texture has light of its own: more from all around, the others that share


class HeadView:
    """The scene of one head, and the widget that shows it.

    Parameters
    ----------
    face : Face
        The face to begin with; later ones have its topology.
    preset : str
        The view to begin with.
    turnable : bool
        Whether a drag turns it; otherwise it stays in that view.

    Attributes
    ----------
    widget : MeshStream
        What to put on the page.
    """

    def __init__(self, face: Face, preset: str = "front", turnable: bool = True) -> None:
        self._face = face
        self._frame = View()
        geometry = three.BufferGeometry(
            attributes={
                "position": three.BufferAttribute(np.asarray(face.vertices, dtype=np.float32)),
                "color": three.BufferAttribute(np.asarray(face.colors, dtype=np.float32)),
                "index": three.BufferAttribute(np.asarray(face.faces, dtype=np.uint32).ravel(), normalized=False),
            }
        )
        clay = three.MeshLambertMaterial(color="#ffffff", vertexColors="VertexColors", side="DoubleSide")
        mesh = three.Mesh(geometry, clay, frustumCulled=False)
        position = CAMERA_DISTANCE * View.preset(preset).rotation[2]
        camera = three.OrthographicCamera(
            -125, 125, 125, -125, near=1, far=2 * CAMERA_DISTANCE, position=position.tolist(), children=_lights()
        )
        ambient = three.HemisphereLight(SKY, GROUND)
        self._lights = {ambient: (AMBIENT, TEXTURED_AMBIENT)}
        self._lights |= {light: (light.intensity, TEXTURED * light.intensity) for light in camera.children}
        self._light(False)
        low, high = ZOOM if turnable else (1.0, 1.0)
        scene = three.Scene(children=[mesh, camera, ambient], background=None)
        renderer = three.Renderer(
            scene,
            camera,
            [three.OrbitControls(camera, minZoom=low, maxZoom=high, **dict.fromkeys(TURNING, turnable))],
            antialias=True,
            alpha=True,
            clearOpacity=0.0,
            background_opacity=0.0,
        )
        swatch = three.DataTexture(np.full((1, 1, 4), 255, dtype=np.uint8))
        self._skin: Texture | None = None
        self.widget = MeshStream(renderer=renderer, geometry=geometry, material=clay, swatch=swatch)
        self.widget.on_ready(self._send_all)

    @property
    def geometry(self) -> three.BufferGeometry:
        """Of the head on show."""
        return self.widget.geometry

    def dress(self, skin: Texture | None) -> None:
        """Show heads with a texture, or of clay again; nothing is sent if they have it already."""
        if skin is not self._skin:
            self._skin = skin
            self._light(skin is not None)
            self.widget.send_skin(skin)

    def show(self, face: Face, frame: View, passing: bool = False) -> None:
        """Show another face, standing where ``frame`` has it on the canvas; nothing is sent if it does already.

        A passing one is that of a stroke still being drawn: pages leave it out once the pen is up.
        """
        if face is not self._face or frame is not self._frame:
            self._face, self._frame = face, frame
            self._send(passing)

    def look(self, preset: str) -> None:
        """Turn to a view by name: front, left, right or three-quarter."""
        self.look_from(View.preset(preset).rotation[2])

    def look_from(self, direction: np.ndarray) -> None:
        """Turn until it is seen from a direction (3,), upright."""
        self.widget.look(direction)

    def _light(self, textured: bool) -> None:
        for light, intensities in self._lights.items():
            light.intensity = intensities[textured]

    def _send_all(self) -> None:
        if self._skin is not None:
            self.widget.send_skin(self._skin)
        self._send()

    def _send(self, passing: bool = False) -> None:
        self.widget.send_positions(self._face.vertices, self._frame.scale, self._frame.centre, passing)


def _lights() -> list[three.DirectionalLight]:
    """The directional lights as children of the camera; they shine at the head's origin, straight ahead of it."""
    lights = []
    for colour, intensity, direction in LIGHTS:
        position = CAMERA_DISTANCE * np.array(direction) / np.linalg.norm(direction) - (0, 0, CAMERA_DISTANCE)
        lights.append(three.DirectionalLight(colour, position=tuple(position.tolist())))
        lights[-1].intensity = intensity
    return lights
