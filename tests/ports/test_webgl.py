"""The page for WebGL2 in headless Chromium: its results pass the check, no planted fault does, and its words are plain.

REFDOF_REQUIRE_CHROMIUM=1 makes a missing browser a failure.
"""

import base64
import io
import json
import re
import shutil
import time
import zipfile
from pathlib import Path

import pytest

from refdof.oracle import check_results
from refdof.oracle.cases import Case
from tests.packs import pack_of
from tests.ports import chromium
from tests.ports.cases import mutated

FOLDER = Path(__file__).parents[2] / "ports" / "webgl"
CORE = Path(__file__).parents[2] / "data" / "packs" / "core"
CASES = [
    Case("cards", "singlepass", "cards", (24, 18)),
    Case("noise", "singlepass", "noise", (29, 23)),
    Case("noise_up", "singlepass", "noise", (17, 13), {"row_order": "up"}, "up"),
    Case("noise_mirrored", "singlepass", "noise", (17, 13), {"row_order": "up"}),
    Case("coarser", "singlepass", "noise", (24, 18), {"rad_scale": 1.0, "max_blur_size": 6.0, "behind_factor": 1.0}),
    Case("nearest", "singlepass", "cards", (24, 18), {"color_filter": "nearest"}),
]
OWN = re.search(r'<script id="singlepass"[^>]*>(.*?)</script>', (FOLDER / "index.html").read_text(), re.DOTALL)[1]
STATUSES = {case.name: "not supported" if case.name == "nearest" else "pass" for case in CASES}

FAULTS = {
    "the loop ends at half its bound": ("radius < uMaxBlurSize;", "radius < 0.5 * uMaxBlurSize;"),
    "the largest circle is the listing's": ("return abs(coc) * uMaxBlurSize;", "return abs(coc) * 20.0;"),
    "the spiral is mirrored": ("mat2(STEP, -STEP.y, STEP.x) * direction", "direction * mat2(STEP, -STEP.y, STEP.x)"),
    "a wrong digit of the golden angle": ("vec2(-0.73736888, 0.67549029)", "vec2(-0.73717, 0.67571)"),
    "colour at the nearest texel": ("return mix(above, below, part.y);", "return texel(ivec2(floor(place)));"),
    "taps wrap": (
        "clamp(place, ivec2(0), textureSize(uTexture, 0) - 1)",
        "(place + textureSize(uTexture, 0)) % textureSize(uTexture, 0)",
    ),
    "no limit from behind": ("centerSize * uBehindFactor", "uMaxBlurSize"),
    "no number": ("vec4(color / total, 1.0)", "vec4(color / (total - total), 1.0)"),
}  # fmt: skip


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    found = chromium.program()
    opened = chromium.Browser(found, tmp_path_factory.mktemp("chromium"))
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def root(browser, tmp_path_factory):
    """The folder that is served: the page and a pack."""
    folder = tmp_path_factory.mktemp("served")
    shutil.copytree(FOLDER, folder / "webgl")
    pack_of(CASES, folder / "pack")
    return folder


@pytest.fixture(scope="module")
def address(root):
    with chromium.served(root) as found:
        yield found


@pytest.fixture(scope="module")
def page(browser, address):
    """The page with the pack, to run other shaders in."""
    opened = chromium.Tab(browser)
    opened.open(f"{address}/webgl/index.html?pack=../pack")
    assert ended(opened)[0] == "done"
    assert opened.value("element('shader').value") == OWN
    return opened


@pytest.fixture
def tab(browser):
    opened = chromium.Tab(browser)
    yield opened
    opened.close()


def ended(tab):
    """Wait for the end of a run; the state and the words of the page."""
    tab.until("['done', 'failed'].includes(document.body.dataset.state)")
    return tab.value("[document.body.dataset.state, element('message').textContent]")


def rerun(tab, shader):
    tab.value(f"element('shader').value = {json.dumps(shader)}, void element('run').click()")
    return ended(tab)


def rows_of(tab):
    """{case: (status, words)} as the table has them."""
    code = """[...element('rows').rows].map(row =>
        [row.cells[0].textContent, row.querySelector('strong').textContent, row.querySelector('small').textContent])"""
    return {name: (status, words) for name, status, words in tab.value(code)}


def report_of(tab, pack, folder):
    """Unpack the zip that the page offers and check it."""
    code = """fetch(element('download').href).then(answer => answer.arrayBuffer()).then(bytes =>
        btoa(Array.from(new Uint8Array(bytes), byte => String.fromCharCode(byte)).join('')))"""
    unpack(io.BytesIO(base64.b64decode(tab.value(code))), folder)
    return check_results(folder, pack)


def statuses_of(report):
    return {outcome.case: outcome.status for outcome in report.outcomes}


def unpack(file, folder):
    with zipfile.ZipFile(file) as archive:
        assert archive.testzip() is None
        archive.extractall(folder)


def test_the_page_s_own_shader_passes_and_its_zip_is_downloaded(tab, browser, address, root, tmp_path):
    tab.open(f"{address}/webgl/index.html?pack=../pack")
    assert ended(tab)[0] == "done"
    assert {name: status for name, (status, _) in rows_of(tab).items()} == STATUSES
    tab.value("element('download').click()")
    path, end = browser.downloads / "results.zip", time.monotonic() + 20
    while not path.exists():
        assert time.monotonic() < end, "no results.zip"
        time.sleep(0.05)
    unpack(path, tmp_path)
    report = check_results(tmp_path, root / "pack")
    print({outcome.case: outcome.message for outcome in report.outcomes})
    assert report.passed
    assert statuses_of(report) == STATUSES


def test_the_core_pack(tab, address, root, tmp_path):
    if not CORE.is_dir():
        pytest.skip("there is no core pack beside the code")
    shutil.copytree(CORE, root / "core")
    tab.open(f"{address}/webgl/index.html?pack=../core")
    assert ended(tab)[0] == "done"
    found = statuses_of(report_of(tab, CORE, tmp_path))
    assert {name: status for name, (status, _) in rows_of(tab).items()} == found
    assert len(found) == 28
    assert all(
        status == ("pass" if name.startswith("singlepass") else "not supported") for name, status in found.items()
    )


@pytest.mark.parametrize("way", ["chosen", "dropped"])
def test_a_folder_of_this_computer(tab, address, root, tmp_path, way):
    if way == "chosen":
        tab.open((root / "webgl" / "index.html").as_uri())  # from the disk
        tab.choose("#folder", root / "pack")
    else:
        tab.open(f"{address}/webgl/index.html")
        tab.drop(root / "pack")
    assert ended(tab)[0] == "done"
    assert statuses_of(report_of(tab, root / "pack", tmp_path)) == STATUSES


def test_no_planted_fault_passes(page, root, tmp_path):
    """Neither for the page nor for the check of its zip, which agree on every case."""
    for number, (fault, change) in enumerate(FAULTS.items()):
        state, said = rerun(page, mutated(OWN, *change))
        assert state == "done", (fault, said)
        report = report_of(page, root / "pack", tmp_path / str(number))
        print(f"{fault}: {[outcome.case for outcome in report.outcomes if outcome.status == 'fail']}")
        assert not report.passed, fault
        assert statuses_of(report) == {name: status for name, (status, _) in rows_of(page).items()}, fault


def test_parameters_without_a_uniform_are_not_supported(page, root, tmp_path):
    state, said = rerun(page, mutated(OWN, "uniform float uRadScale;", "const float uRadScale = 0.5;"))
    assert (state, said.split(";")[0]) == ("done", "4 pass, 2 not supported")
    report = report_of(page, root / "pack", tmp_path)
    assert report.passed
    assert {outcome.case: outcome.message for outcome in report.outcomes if outcome.status == "not supported"} == {
        "coarser": "rad_scale is 1: the shader has no uniform uRadScale",
        "nearest": "color_filter is nearest: there is no uniform for words",
    }


def test_a_shader_with_texture_and_other_uniforms(page):
    """The page filters and clamps colour where the browser can, knows other names, and tells what it does not set."""
    shader = mutated(
        OWN,
        "    vec2 first = floor(place - 0.5), part = place - 0.5 - first;",
        "    return texture(uTexture, place * uPixelSize).rgb + uNoise; vec2 first, part;",
    )
    shader = mutated(shader, "direction * radius", "direction * vec2(1.0, uRowStep) * radius")
    shader = mutated(
        shader,
        "    float centerSize = getBlurSize(centerDepth);",
        "    float centerSize = min(abs(texture(uCoc, vTexCoord).r), uMaxBlurSize);",
    )
    more = "uniform float uFar, uNoise, uRowStep; uniform vec2 uPixelSize; uniform sampler2D uCoc; in vec2 vTexCoord;"
    shader = mutated(shader, "uniform float uFar; ", more)
    state, said = rerun(page, shader)
    assert (state, said.split(";")[0]) == ("done", "5 pass, 1 not supported")
    assert said.endswith("The shader's uniform uNoise is none that the page sets: it was 0.")


WITHOUT = """const own = WebGL2RenderingContext.prototype, get = own.getExtension;
own.getExtension = function (name) { return name === "%s" ? null : get.call(this, name); };"""


@pytest.mark.parametrize(
    ("before", "state", "words"),
    [
        ("HTMLCanvasElement.prototype.getContext = () => null;", "failed", "no WebGL2"),
        (WITHOUT % "EXT_color_buffer_float", "failed", "cannot draw into float32 textures"),
        (WITHOUT % "OES_texture_float_linear", "done", "texture() reads the nearest texel"),
    ],
    ids=["no WebGL2", "no float targets", "no float filters"],
)
def test_what_a_browser_lacks_is_said(browser, address, before, state, words):
    tab = chromium.Tab(browser, before)
    tab.open(f"{address}/webgl/index.html?pack=../pack")
    found, said = ended(tab)
    tab.close()
    assert found == state
    assert words in said
    assert "Unexpected" not in said


def test_a_shader_that_does_not_compile_is_told_with_its_line(page):
    state, said = rerun(page, mutated(OWN, "    float total = 1.0;", "    float totals = 1.0;"))
    line = OWN.splitlines().index("        color += mix(color / total, tapColor, m);") + 1
    assert state == "failed"
    assert said.startswith("The shader does not compile:\n")
    assert f"line {line}: 'total' : undeclared identifier\n    color += mix(color / total, tapColor, m);" in said
    assert page.value("element('download').hidden")
    assert rerun(page, OWN)[0] == "done"


def test_a_shader_that_never_ends_is_given_up(browser, address, tmp_path):
    """In a browser of its own, whose process for graphics stays busy."""
    alone = chromium.Browser(chromium.program(), tmp_path)
    try:
        tab = chromium.Tab(alone)
        tab.open(f"{address}/webgl/index.html")
        shader = json.dumps(mutated(OWN, "radius += uRadScale / radius", "radius += 0.0 * uRadScale"))
        tab.value(
            f"element('shader').value = {shader}, limits.secondsPerCase = 2, void load(() => packOfUrl('../pack'))"
        )
        state, said = ended(tab)
    finally:
        alone.close()
    assert state == "failed"
    assert said.startswith("Nothing was drawn within 2 s: does the shader end?")


@pytest.mark.parametrize(
    ("path", "content", "words"),
    [
        ("manifest.json", None, "manifest.json: is missing"),
        ("manifest.json", b"[", "manifest.json: is no JSON"),
        ("manifest.json", b"{}", "manifest.json: its schema is not refdof-pack-1"),
        ("conventions.json", None, "conventions.json: is missing"),
        ("conventions.json", b"{}", "conventions.json: byte_order is not little"),
    ],
)
def test_a_folder_that_is_no_pack_is_refused(tab, address, root, path, content, words):
    spoil(root, {path: content})
    tab.open(f"{address}/webgl/index.html?pack=../spoiled")
    state, said = ended(tab)
    assert state == "failed"
    assert said.startswith(words)


SPOILED = {
    "cards/case.json": (b"{}", "cases/cards/case.json: lacks something"),
    "noise/params.txt": (None, "cases/noise/params.txt: is missing"),
    "noise_up/inputs/depth.f32": (None, "cases/noise_up/inputs/depth.f32: is missing"),
    "coarser/inputs/color.f32": (b"12", "cases/coarser/inputs/color.f32: has 2 bytes of numbers; 18 x 24 x 3 float32"),
    "noise_mirrored/expected/low.npy": (b"12", "cases/noise_mirrored/expected/low.npy: is no NPY file of float32"),
}  # fmt: skip


def test_a_spoiled_case_is_an_error_and_no_other(tab, address, root):
    spoil(root, {f"cases/{path}": content for path, (content, _) in SPOILED.items()})
    tab.open(f"{address}/webgl/index.html?pack=../spoiled")
    assert ended(tab)[0] == "done"
    rows = rows_of(tab)
    assert rows["nearest"][0] == "not supported"
    for path, (_, words) in SPOILED.items():
        status, said = rows[path.split("/")[0]]
        assert status == "error"
        assert said.startswith(words)


def spoil(root, changes):
    """A copy of the pack beside it, with files changed, or left out."""
    shutil.rmtree(root / "spoiled", ignore_errors=True)
    shutil.copytree(root / "pack", root / "spoiled")
    for path, content in changes.items():
        (root / "spoiled" / path).unlink() if content is None else (root / "spoiled" / path).write_bytes(content)


def test_folders_that_a_page_from_the_disk_does_not_take(tab, root):
    tab.open((root / "webgl" / "index.html").as_uri())
    tab.choose("#folder", root / "pack" / "cases" / "cards" / "inputs")
    assert ended(tab) == ["failed", "This folder is no pack: it has no manifest.json."]
    tab.open((root / "webgl" / "index.html").as_uri() + "?pack=../pack")
    state, said = ended(tab)
    assert state == "failed"
    assert "Is the page served over http?" in said
    tab.open((root / "webgl" / "index.html").as_uri())
    tab.drop(root / "pack")
    assert ended(tab)[1].startswith("This browser does not let the page read a dropped folder")


def test_a_shader_from_a_file(tab, address, tmp_path):
    (tmp_path / "mine.frag").write_text("no shader\n")
    tab.open(f"{address}/webgl/index.html")
    assert tab.value("document.body.dataset.state") == "empty"
    tab.choose("#file", tmp_path / "mine.frag")
    tab.until("element('shader').value === 'no shader\\n'")
