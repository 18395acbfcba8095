"""Finding which drawn points lie on which line of a face."""

import numpy as np
import pytest
from test_shape_code import MODEL  # placeholder
