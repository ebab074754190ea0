"""The page of a sweep, in a browser: what it answers, and that it needs nothing else."""

import pytest

from refdof.sweep import Results, fitted
from refdof.sweep.write import write_report
from tests.sweep.points import point
from tests.sweep.test_cost import swept

POINTS = [
    point("slow", 1.5, 45.0, floor=50.0),
    point("quick", 0.02, 25.0, method="mipmap", params={"delta": 0.5}, varied={}, command="refdof render <fence> & so"),
    point("middle", 0.2, 34.0),
    point("worse", 0.3, 33.0),
    point("other", 0.04, 28.0, scene="town"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("sweep")
    with Results(made / "sweep.duckdb") as results:
        for one in POINTS:
            results.add(one)
        law = fitted(swept(lambda n, q, _r, _k: 1e-8 * n * q))
        write_report(POINTS, [law], results, made, "refdof sweep fence town")
    return made


@pytest.fixture
def page(browser, folder, request):
    width = getattr(request, "param", 1280)
    opened = browser.new_context(viewport={"width": width, "height": 900}, offline=True).new_page()
    faults, fetched = [], []
    opened.on("console", lambda message: faults.append(message.text))
    opened.on("pageerror", lambda error: faults.append(str(error)))
    opened.on("request", lambda asked: fetched.append(asked.url))
    opened.goto((folder / "report.html").as_uri())
    yield opened
    assert faults == []
    assert fetched == [(folder / "report.html").as_uri()]
    opened.context.close()


def answers(page):
    return [one.text_content() for one in page.query_selector_all(".answer")]


def test_a_budget_a_quality_and_both(page):
    assert answers(page) == ["", ""]
    page.fill("#budget", "250")
    assert answers(page) == ["lensblur, samples=16: 34.00 dB in 200 ms", "lensblur, samples=16: 28.00 dB in 40.0 ms"]
    page.fill("#budget", "30")
    assert answers(page) == ["mipmap, defaults: 25.00 dB in 20.0 ms", "Nothing fits."]
    assert page.query_selector(".command").text_content() == "refdof render <fence> & so"
    page.fill("#quality", "33")
    assert answers(page) == ["Nothing fits.", "Nothing fits."]
    assert not page.query_selector(".command").is_visible()
    page.fill("#quality", "60.5")
    assert answers(page) == ["Nothing fits: the reference's noise floor is at 60.0 dB."] * 2
    page.fill("#quality", "33")
    page.fill("#budget", "")
    assert answers(page) == ["lensblur, samples=16: 34.00 dB in 200 ms", "Nothing fits."]


def test_the_points_and_the_front(page):
    page.click("summary")
    rows = page.query_selector_all("section >> nth=0 >> tbody tr")
    shown = [[cell.text_content() for cell in row.query_selector_all("td")][:6] for row in rows]
    assert [row[0] for row in shown] == ["mipmap", "lensblur", "lensblur", "lensblur"]
    assert [row[2] for row in shown] == ["20.0 ms", "200 ms", "300 ms", "1.50 s"]
    assert [row.get_attribute("class") for row in rows] == ["front", "front", None, "front"]
    assert page.query_selector("li").text_content().startswith("lensblur: time grows as pixels^1.00 samples^1.00")


@pytest.mark.parametrize("page", [1280, 390], indirect=True)
def test_it_fits(page):
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    box = page.query_selector(".plot svg").bounding_box()
    assert box["width"] > 300


def test_equal_points_are_equal_bytes(folder, tmp_path):
    with Results(tmp_path / "sweep.duckdb") as results:
        for one in POINTS:
            results.add(one)
        write_report(POINTS, [], results, tmp_path, "refdof sweep fence town")
    for name in ("front-fence-320-x-240.svg", "front-fence-320-x-240.png", "fronts.tex", "sweep.csv"):
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes(), name
