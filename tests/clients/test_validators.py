"""Validators of the formats' own makers read what we write."""

from __future__ import annotations

import json
import shutil
import subprocess

import numpy as np
import pytest

import terrain_lod as tl
from support.client_page import library
from support.tilesets import jacksboro

pytestmark = pytest.mark.slow

VALIDATE = """
const validator = require('gltf-validator'), fs = require('fs')
Promise.all(process.argv.slice(1).map(path =>
    validator.validateBytes(new Uint8Array(fs.readFileSync(path)))))
    .then(reports => console.log(JSON.stringify(reports.map(report => report.issues.messages))))
"""
# every tile that 3d-tiles-tools finds, by way of tileset.json and the subtrees
TRAVERSE = """
const [folder, tools] = process.argv.slice(2)
const { TilesetTraverser, ResourceResolvers } = await import(tools)
const { readFileSync } = await import('fs')
const resolver = ResourceResolvers.createFileResourceResolver(folder)
const traverser = new TilesetTraverser(folder, resolver, { depthFirst: false })
const found = []
await traverser.traverse(JSON.parse(readFileSync(folder + '/tileset.json')), async tile => {
    found.push({ error: tile.asFinalTile().geometricError,
                 path: tile.getFinalContents().map(content => content.uri) })
    return true
})
console.log(JSON.stringify(found))
"""


@pytest.fixture(scope="module", params=["implicit", "explicit"])
def boxes(request, tmp_path_factory):
    mask = np.zeros((90, 110), bool)
    mask[:60, :70] = True
    folder = tmp_path_factory.mktemp(request.param)
    return tl.write_tiles(jacksboro(mask=mask), folder, format="3dtiles", error=8.0, zoom=3,
                          tiling=request.param)  # fmt: skip


def test_khronos_finds_nothing_to_say_about_any_tile(boxes):
    library("gltf-validator")
    paths = [str(boxes.folder / record.path) for record in boxes.records if record.path]
    node = [shutil.which("node"), "-e", VALIDATE, *paths]
    found = json.loads(subprocess.run(node, capture_output=True, check=True).stdout)
    assert found == [[]] * len(paths)


def test_3d_tiles_tools_find_every_tile_with_its_error(boxes, tmp_path):
    tools = library("3d-tiles-tools") / "build/src/index.js"
    script = tmp_path / "traverse.mjs"
    script.write_text(TRAVERSE)
    node = [shutil.which("node"), script, boxes.folder, tools]
    found = json.loads(subprocess.run(node, capture_output=True, check=True).stdout)
    told = {path: tile["error"] for tile in found for path in tile["path"]}
    # the root is told twice, once as the rule that names all of them
    told.pop("{level}/{x}/{y}.glb", None)
    assert told == {record.path: record.error for record in boxes.records if record.path}
