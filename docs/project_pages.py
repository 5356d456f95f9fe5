"""The pages that stand at the project's root, where people look for them, as pages of the site."""

from __future__ import annotations

from pathlib import Path

PAGES = {
    "architecture": "ARCHITECTURE.md",
    "contributing": "CONTRIBUTING.md",
    "benchmarks": "benchmarks/README.md",
    "changelog": "CHANGELOG.md",
}


def write_project_pages(project: Path, folder: Path) -> None:
    """Write each into `folder` of the documentation, its links turned to where pages are there."""
    folder.mkdir(exist_ok=True)
    for name, source in PAGES.items():
        text = (project / source).read_text(encoding="utf-8")
        for other, elsewhere in PAGES.items():
            text = text.replace(f"]({elsewhere})", f"]({other}.md)")
        text = text.replace("](docs/", "](../").replace("](../docs/", "](../")
        (folder / f"{name}.md").write_text(text, encoding="utf-8")
