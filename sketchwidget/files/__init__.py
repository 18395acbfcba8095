"""Files: bounded in size, written whole or not at all, nothing unpickled. Knows neither faces nor strokes."""
