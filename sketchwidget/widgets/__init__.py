"""The Studio and the widgets it is made of: an ipycanvas pad and a pythreejs head, each half in the browser."""

from .studio import Studio

__all__ = ["Studio"]
