from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Playwright, sync_playwright

sys.path.insert(0, str(Path(__file__).parent))

from jupyter_page import (
    DEADLINE,
    launch_chromium,
    open_in_lab,
    open_in_notebook,
    open_in_voila,
    serve,
    write_notebook,
)
from studio_page import StudioPage

# Said by the front ends themselves, whatever is on the page: pythreejs whenever it shows; pages without a network.
KNOWN_NOISE = ("t.on is not a function", "Failed to load resource")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Browser tests come last: Playwright leaves an event loop running, which others would take for a kernel's."""
    in_browser = [item for item in items if Path(__file__).parent in item.path.parents]
    for item in in_browser:
        item.add_marker(pytest.mark.browser)
    items[:] = [item for item in items if item not in in_browser] + in_browser


@pytest.fixture(scope="session")
def playwright() -> Iterator[Playwright]:
    with sync_playwright() as started:
        yield started


@pytest.fixture(scope="session")
def browser(playwright: Playwright) -> Iterator[Browser]:
    try:
        launched = launch_chromium(playwright)
    except RuntimeError as error:
        pytest.fail(str(error))
    yield launched
    launched.close()


@pytest.fixture(scope="session")
def servers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., tuple[str, Path]]]:
    """Start a server once, on first use: ``servers("lab")`` gives its address and its folder of notebooks."""
    running: dict[tuple[str, ...], tuple[str, Path]] = {}
    with ExitStack() as stack:

        def get(kind: str, *options: str) -> tuple[str, Path]:
            if (kind, *options) not in running:
                folder = tmp_path_factory.mktemp(kind)
                running[kind, *options] = (stack.enter_context(serve(kind, folder, *options)), folder)
            return running[kind, *options]

        yield get


@pytest.fixture(scope="session")
def contexts(browser: Browser) -> Iterator[Callable[..., BrowserContext]]:
    """Make browser contexts that end with the tests."""
    with ExitStack() as stack:

        def make(**options: object) -> BrowserContext:
            context = browser.new_context(**{"viewport": {"width": 1280, "height": 900}, **options})
            stack.callback(context.close)
            return context

        yield make


@pytest.fixture(scope="session")
def open_studio(
    servers: Callable[..., tuple[str, Path]], contexts: Callable[..., BrowserContext]
) -> Callable[..., StudioPage]:
    """Open a notebook of its own with a Studio in it, by the name of a server, and wait until its head is on screen."""
    count = 0

    def open_page(
        kind: str, *options: str, code: str = "sw.Studio()", script: str = "", **context: object
    ) -> StudioPage:
        nonlocal count
        count += 1
        address, folder = servers(kind, *options)
        notebook = write_notebook(folder, f"studio{count}", f"import sketchwidget as sw\n{code}")
        page = contexts(**context).new_page()
        page.set_default_timeout(1000 * DEADLINE)
        page.add_init_script(script)
        studio = StudioPage(page)
        page.on("console", lambda said: studio.errors.append(said.text) if said.type == "error" else None)
        page.on("pageerror", lambda error: studio.errors.append(str(error)))
        {"lab": open_in_lab, "notebook": open_in_notebook, "voila": open_in_voila}[kind](page, address, notebook)
        return studio.wait_until_shown()

    return open_page


@pytest.fixture(scope="session")
def shared_pages(open_studio: Callable[..., StudioPage]) -> Callable[[str], StudioPage]:
    opened: dict[str, StudioPage] = {}

    def get(kind: str) -> StudioPage:
        if kind not in opened:
            opened[kind] = open_studio(kind)
        return opened[kind]

    return get


def _lend(studio: StudioPage) -> Iterator[StudioPage]:
    studio.page.bring_to_front()
    studio.start_afresh()
    studio.errors.clear()
    yield studio
    assert [error for error in studio.errors if not any(noise in error for noise in KNOWN_NOISE)] == []


@pytest.fixture
def studio_lab(shared_pages: Callable[[str], StudioPage]) -> Iterator[StudioPage]:
    """A Studio in JupyterLab, its pad empty."""
    yield from _lend(shared_pages("lab"))


@pytest.fixture
def studio_voila(shared_pages: Callable[[str], StudioPage]) -> Iterator[StudioPage]:
    """A Studio in Voila, its pad empty."""
    yield from _lend(shared_pages("voila"))


@pytest.fixture(params=["lab", "voila"])
def studio(request: pytest.FixtureRequest, shared_pages: Callable[[str], StudioPage]) -> Iterator[StudioPage]:
    """A Studio with an empty pad, in both front ends in turn."""
    yield from _lend(shared_pages(request.param))
