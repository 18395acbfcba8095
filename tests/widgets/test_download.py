from __future__ import annotations

import gzip

from sketchwidget.widgets.download import Downloads


def test_a_file_goes_to_the_page_whole(sent):
    downloads = Downloads()
    messages = sent(downloads)
    downloads.save("head.obj", b"v 0 0 0", "model/obj")
    [(message, [content])] = messages
    assert message == {"type": "file", "name": "head.obj", "mime": "model/obj"}
    assert gzip.decompress(content) == b"v 0 0 0"
