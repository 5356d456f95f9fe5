"""A report in Chromium: legible at every width, light and dark, and axe finds nothing serious."""

from __future__ import annotations

from dataclasses import replace

import pytest

import terrain_lod as tl
from support.client_page import Page, chromium, library
from support.grounds import rough

pytestmark = pytest.mark.slow

AXE = """
    const found = await axe.run()
    return found.violations.filter(each => ["serious", "critical"].includes(each.impact))
        .map(each => `${each.id}: ${each.nodes[0].html}`)
"""
OVERLAPS = """
    const boxes = [...document.querySelectorAll("h1, h2, p, figcaption, th, td, dt, dd, img")]
        .map(each => [each, each.getBoundingClientRect()]).filter(([, box]) => box.width)
    return boxes.flatMap(([one, a], index) => boxes.slice(index + 1)
        .filter(([other, b]) => !one.contains(other) && a.left < b.right - 1
            && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1)
        .map(([other]) => `${one.textContent} | ${other.textContent}`))
"""


def test_report_is_legible_at_every_width(tmp_path):
    axe = (library("axe-core") / "axe.min.js").read_text("utf-8")
    ground = rough(61, 91, spacing=30.0)
    camera = replace(tl.default_camera(ground), size=(320, 180))
    made = tl.report(ground, tmp_path, camera=camera)
    with chromium() as driver:
        page = Page(driver, made.files["html"].as_uri())
        for scheme in ("light", "dark"):
            feature = {"name": "prefers-color-scheme", "value": scheme}
            driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [feature]})
            for width in (390, 1280, 2560):
                size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
                driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
                driver.get(page.address)
                driver.execute_script(axe)
                assert page.ask(AXE) == [], (scheme, width)
                assert page.ask(OVERLAPS) == [], (scheme, width)
                assert page.ask("return document.documentElement.scrollWidth") <= width
        page.ask("document.querySelector('button.enlarge').click()")
        assert page.ask("return document.querySelector('dialog[open] img').naturalWidth") == 320
        assert page.complaints() == []
        assert page.elsewhere() == []
