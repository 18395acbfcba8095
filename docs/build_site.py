"""Builds a site: the API from the docstrings, the notebooks, a gallery; and checks its links.

python docs/build_site.py [--out build/site]
"""

from __future__ import annotations

import argparse
import re
import shutil
import sys
from html import escape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import nbformat
import pdoc
from nbconvert import HTMLExporter
from nbconvert.filters import markdown2html

ROOT = Path(__file__).resolve().parents[1]
TEXTS = (
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "docs/screens/README.md",
    *(f"benchmarks/{path.name}" for path in ROOT.glob("benchmarks/*.md")),
)
COPIED = (
    *("docs/*.png", "docs/database/*.png", "docs/screens/*.png", "benchmarks/*.png"),
    *("binder/hub/*.py", "LICENSE", "CITATION.cff"),
)
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{title}</title>
<style>
body {{ max-width: 62rem; margin: 2rem auto; padding: 0 1rem; font: 16px/1.5 system-ui, sans-serif; color: #22262b; }}
a {{ color: #0d8377; }} img {{ max-width: 100%; }} code, pre {{ font-size: 0.9em; background: #f4f5f6; }}
pre {{ padding: 0.6rem; overflow: auto; }} td, th {{ padding: 0.2rem 0.6rem; text-align: left; vertical-align: top; }}
figure {{ margin: 2rem 0; }}
</style></head><body>
<nav><a href="{up}index.html">sketchwidget</a> · <a href="{up}api/sketchwidget.html">API</a> ·
<a href="{up}index.html#The-course">course</a> · <a href="{up}gallery.html">gallery</a></nav>
{body}
</body></html>
"""


def build(out: Path) -> None:
    """Write the site into a folder, in place of a former one."""
    if out.exists():
        shutil.rmtree(out)
    for pattern in COPIED:
        for path in ROOT.glob(pattern):
            (copy := out / path.relative_to(ROOT)).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, copy)
    pictures: dict[str, str] = {}
    for name in TEXTS:
        text = (ROOT / name).read_text()
        for said, source in re.findall(r"!\[(.*?)\]\((?!https?:)(.*?)\)", text):
            pictures.setdefault((Path(name).parent / source).as_posix(), said)
        _write(out, name, name.replace("README.md", "index.md"), markdown2html(text))
    figures = (
        f'<figure><img src="{source}" alt=""><figcaption>{said}</figcaption></figure>'
        for source, said in pictures.items()
    )
    _write(out, "gallery", "gallery.md", "<h1>Gallery</h1>" + "".join(figures))
    exporter = HTMLExporter()
    for path in sorted(ROOT.glob("notebooks/*.ipynb")):
        body, _ = exporter.from_notebook_node(nbformat.read(path, as_version=4), {"metadata": {"name": path.stem}})
        (out / "notebooks").mkdir(exist_ok=True)
        (out / "notebooks" / f"{path.stem}.html").write_text(_as_pages(body))
    pdoc.render.configure(docformat="numpy", show_source=False)
    pdoc.pdoc("sketchwidget", output_directory=out / "api")
    for page in (out / "api").rglob("*.html"):
        page.write_text(_without_dead_ends(page.read_text()))


def _write(out: Path, title: str, name: str, body: str) -> None:
    page = (out / name).with_suffix(".html")
    page.parent.mkdir(parents=True, exist_ok=True)
    up = "../" * (len(page.relative_to(out).parts) - 1)
    page.write_text(PAGE.format(title=escape(title), up=up, body=_as_pages(body)))


def _as_pages(body: str) -> str:
    """Links to files of the repository as links to what the site makes of them."""
    body = re.sub(r'(href="(?!https?:)[^"]*?)README\.md', r"\1index.md", body)
    return re.sub(r'(href="(?!https?:)[^"#]*)\.(md|ipynb)(?=["#])', r"\1.html", body)


def _without_dead_ends(page: str) -> str:
    """A page of the API without its links to what it does not show, such as members that are inherited."""
    names = set(re.findall(r'id="([^"]*)"', page))
    return re.sub(r'<a href="#([^"]+)">(.*?)</a>', lambda found: found[0 if found[1] in names else 2], page)


class _Links(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.names: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.links += [link for name in ("href", "src") if (link := given.get(name))]
        self.names |= {name for key in ("id", "name") if (name := given.get(key))}


def broken(out: Path) -> list[str]:
    """Links of the site to pages, pictures and places on pages that are not there."""
    pages: dict[Path, _Links] = {}
    for path in out.rglob("*.html"):
        pages[path] = _Links()
        pages[path].feed(path.read_text())
    found = []
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            names = {parts.fragment, unquote(parts.fragment)}
            if not target.is_file() or (parts.fragment and target in pages and not names & pages[target].names):
                found.append(f"{path.relative_to(out)}: {link}")
    return sorted(set(found))


def main() -> None:
    """Build, and end with what is broken if anything is."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "site")
    out = parser.parse_args().out.resolve()
    build(out)
    if links := broken(out):
        sys.exit("broken links:\n" + "\n".join(links))
    print(f"{out / 'index.html'}: {len(list(out.rglob('*.html')))} pages, no broken links")


if __name__ == "__main__":
    main()
